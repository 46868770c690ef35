//! The table of BSDFs, and what each class of them has: a new one is a file and a row.

use glam::Vec3;

use super::lanes::{ClassTraits, LaneBsdf};
use super::lobes::Lobes;
use super::one::{PreparedBsdf, scattering_functions};
use super::{DirectionSample, MicrofacetFactors, is_grazing};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// The types in the table's rows.
pub(crate) mod types {
    pub(crate) use crate::shading::bsdf::conductor::Conductor;
    pub(crate) use crate::shading::bsdf::dielectric::Dielectric;
    pub(crate) use crate::shading::bsdf::diffuse::{Diffuse, DiffuseTransmission};
    pub(crate) use crate::shading::bsdf::disney::Disney;
    pub(crate) use crate::shading::bsdf::hair::Hair;
    pub(crate) use crate::shading::bsdf::layered::Layered;
    pub(crate) use crate::shading::bsdf::measured::Measured;
    pub(crate) use crate::shading::bsdf::normalized_fresnel::NormalizedFresnel;
    pub(crate) use crate::shading::bsdf::open_pbr::OpenPbrSurface;
    pub(crate) use crate::shading::bsdf::plastic::Plastic;
    pub(crate) use crate::shading::bsdf::principled::Principled;
    pub(crate) use crate::shading::bsdf::subsurface::Subsurface;
    pub(crate) use crate::shading::bsdf::thin_dielectric::ThinDielectric;
    pub(crate) use crate::shading::bsdf::tinted::TintedDielectric;
    pub(crate) use crate::shading::bsdf::whitted::WhittedCoefficients;
}

use types::*;

/// A scattering function of one class, as the integrators and the inspector know it besides its values
/// ([`LaneBsdf`]). Directions are those of [`Bsdf`].
pub trait ScatteringFunction {
    /// The set of lobes that it has.
    fn lobes(&self) -> Lobes;

    /// Increases the roughness of nearly specular lobes, for the later bounces of a path.
    fn regularize(&mut self) {}

    /// The factors of its microfacets for light from `wi` to `wo`; `is_specular` asks for those of a direction that was
    /// sampled from a smooth boundary.
    fn factors(&self, _wo: Vec3, _wi: Vec3, _is_specular: bool) -> Vec<MicrofacetFactors> {
        Vec::new()
    }

    /// Its name, what it does, and its numbers.
    fn description(&self) -> Description;
}

/// A description of a BSDF for the inspector.
#[derive(Clone, Debug)]
pub struct Description {
    /// The kind of BSDF.
    pub kind: &'static str,
    /// Its effect on light.
    pub does: &'static str,
    /// Parameters by name.
    pub numbers: Vec<(&'static str, Parameter)>,
}

/// A parameter of a BSDF.
#[derive(Clone, Debug)]
pub enum Parameter {
    /// One number, or one per axis.
    Numbers(Vec<f32>),
    /// One number per lane of spectra.
    Spectrum(Spectrum),
}

impl From<f32> for Parameter {
    fn from(number: f32) -> Self {
        Self::Numbers(vec![number])
    }
}

impl From<Spectrum> for Parameter {
    fn from(spectrum: Spectrum) -> Self {
        Self::Spectrum(spectrum)
    }
}

impl From<super::microfacet::TrowbridgeReitz> for Parameter {
    fn from(roughness: super::microfacet::TrowbridgeReitz) -> Self {
        Self::Numbers(vec![roughness.alpha_x, roughness.alpha_y])
    }
}

impl From<super::microfacet::Microfacets> for Parameter {
    fn from(microfacets: super::microfacet::Microfacets) -> Self {
        microfacets.alpha.into()
    }
}

/// Calls a macro with the table: first the classes that are computed in lanes, by the names of their variants and types; after a bar those
/// variants that are computed as one of their fields.
macro_rules! bsdf_classes {
    ($callback:ident $($context:tt)*) => {
        $callback! {
            $($context)*
            lanes {
                /// Lambertian reflection.
                Diffuse(Diffuse),
                /// Metal.
                Conductor(Conductor),
                /// The boundary of a dielectric.
                Dielectric(Dielectric | Subsurface.boundary),
                /// Lambertian reflection under a dielectric coat.
                CoatedDiffuse(Layered<Diffuse>),
                /// A metal under a dielectric coat.
                CoatedConductor(Layered<Conductor>),
                /// Lambertian reflection under a dielectric surface, in closed form.
                Plastic(Plastic),
                /// glTF's metallic-roughness material with its extensions.
                Principled(Principled),
                /// OpenPBR's surface.
                OpenPbr(OpenPbrSurface),
                /// A fibre of hair.
                Hair(Hair),
                /// A measured material.
                Measured(Measured),
                /// Whitted's model.
                Whitted(WhittedCoefficients),
                /// Lambertian reflection and transmission.
                DiffuseTransmission(DiffuseTransmission),
                /// Disney's principled surface.
                Disney(Disney),
                /// The boundary of a dielectric with colours of its own.
                TintedDielectric(TintedDielectric),
                /// A thin dielectric sheet.
                ThinDielectric(ThinDielectric),
                /// Light that leaves a medium in which it has diffused.
                NormalizedFresnel(NormalizedFresnel),
            }
            wholes {
                /// The boundary of a medium in which light diffuses.
                Subsurface(Subsurface),
            }
            one_by_one {}
        }
    };
}

pub(crate) use bsdf_classes;

bsdf_classes! {
    scattering_functions
    /// A scattering function at a point.
    Bsdf
}

/// The classes that are computed in lanes.
macro_rules! lane_classes {
    (
        lanes { $($(#[$doc:meta])* $lane:ident($type:ty $(| $whole:ident.$part:ident)?),)* }
        wholes { $($_wholes:tt)* }
        one_by_one { $($_rest:tt)* }
    ) => {
        /// The classes of BSDFs that are computed in lanes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum BsdfClass {
            $($(#[$doc])* $lane,)*
        }

        impl BsdfClass {
            /// All of them, in their order.
            pub(crate) const ALL: &[Self] = &[$(Self::$lane),*];

            /// Number of classes.
            pub(crate) const COUNT: usize = Self::ALL.len();

            /// The class of a BSDF, if it is computed in lanes.
            #[inline]
            pub(crate) fn of(bsdf: &Bsdf) -> Option<Self> {
                match bsdf {
                    $(Bsdf::$lane(_) $(| Bsdf::$whole(_))? => Some(Self::$lane),)*
                    #[allow(unreachable_patterns, reason = "the table may have classes that are computed one by one")]
                    _ => None,
                }
            }
        }

        $(
            impl Variant for $type {
                #[inline]
                fn of(bsdf: &Bsdf) -> Option<&Self> {
                    match bsdf {
                        Bsdf::$lane(bsdf) => Some(bsdf),
                        $(Bsdf::$whole(bsdf) => Some(&bsdf.$part),)?
                        _ => None,
                    }
                }

                fn bsdf(self) -> Bsdf {
                    Bsdf::$lane(self)
                }
            }
        )*
    };
}

bsdf_classes!(lane_classes);

/// The type of a variant of [`Bsdf`].
pub(crate) trait Variant: Copy {
    /// The BSDF, or the part of it by which it is computed, if it is of this class.
    fn of(bsdf: &Bsdf) -> Option<&Self>;

    /// The variant.
    fn bsdf(self) -> Bsdf;
}
