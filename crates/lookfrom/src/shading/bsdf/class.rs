//! The table of BSDFs, and what each class of them has: a new one is a file and a row.

use glam::Vec3;

use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::diffuse::{Diffuse, DiffuseTransmission};
use super::disney::Disney;
use super::hair::Hair;
use super::layered::Layered;
use super::lobes::Lobes;
use super::measured::Measured;
use super::normalized_fresnel::NormalizedFresnel;
use super::open_pbr::OpenPbrSurface;
use super::plastic::Plastic;
use super::principled::Principled;
use super::subsurface::Subsurface;
use super::thin_dielectric::ThinDielectric;
use super::tinted::TintedDielectric;
use super::whitted::WhittedCoefficients;
use super::{BsdfSample, MicrofacetFactors, Mode};
use crate::core::spectrum::Spectrum;

/// A scattering function of one class, one at a time. Directions are those of [`Bsdf`].
pub trait ScatteringFunction {
    /// The fraction of light from `wi` that leaves along `wo`, per solid angle and without the cosine of `wi`: black for
    /// specular lobes and grazing directions.
    fn f(&self, wo: Vec3, wi: Vec3, mode: Mode) -> Spectrum;

    /// The density over solid angle with which [`Self::sample`] chooses `wi`, without specular lobes.
    fn pdf(&self, wo: Vec3, wi: Vec3, mode: Mode, lobes: Lobes) -> f32;

    /// A direction, by three numbers in [0, 1), from the sides of `lobes`; `wo` is not grazing.
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2], mode: Mode, lobes: Lobes) -> Option<BsdfSample>;

    /// The set of lobes that it has.
    fn lobes(&self) -> Lobes;

    /// Increases the roughness of nearly specular lobes, for the later bounces of a path.
    fn regularize(&mut self) {}

    /// The share of diffuse lobes in the value `f` for light from `wi`, 0 … 1 by lane: see
    /// [`LaneBsdf::diffuse_share`](super::lanes::LaneBsdf::diffuse_share).
    fn diffuse_share(&self, _wo: Vec3, _wi: Vec3, _f: Spectrum) -> Spectrum {
        Spectrum::BLACK
    }

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

/// An enum of the classes in a table.
macro_rules! scattering_functions {
    (
        $(#[$meta:meta])* $name:ident
        lanes { $($(#[$lane_doc:meta])* $lane:ident($lane_type:ty $(| $_whole:ident.$_part:ident)?),)* }
        wholes { $($(#[$whole_doc:meta])* $whole:ident($whole_type:ty),)* }
        one_by_one { $($(#[$doc:meta])* $one:ident($type:ty),)* }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum $name {
            $($(#[$lane_doc])* $lane($lane_type),)*
            $($(#[$whole_doc])* $whole($whole_type),)*
            $($(#[$doc])* $one($type),)*
        }

        impl $name {
            /// The scattering function.
            #[inline]
            pub(crate) fn class(&self) -> &dyn ScatteringFunction {
                match self {
                    $(Self::$lane(bsdf) => bsdf,)*
                    $(Self::$whole(bsdf) => bsdf,)*
                    $(Self::$one(bsdf) => bsdf,)*
                }
            }

            #[inline]
            pub(crate) fn class_mut(&mut self) -> &mut dyn ScatteringFunction {
                match self {
                    $(Self::$lane(bsdf) => bsdf,)*
                    $(Self::$whole(bsdf) => bsdf,)*
                    $(Self::$one(bsdf) => bsdf,)*
                }
            }
        }
    };
}

#[cfg(test)]
pub(crate) use scattering_functions;

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
