//! Any BSDF as a class of its own, at width one: for those that are not computed in lanes, and where lanes are not filled.

use glam::Vec3;

use super::lanes::{ClassTraits, LaneBsdf};
use super::lobes::Lobes;
use super::principled::LocalScattering;
use super::principled::open_pbr::OpenPbr;
use super::{Bsdf, BsdfSample, DirectionSample, Mode};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;

/// A BSDF seen from the outgoing direction ω_o.
pub struct PreparedBsdf {
    wo: Vec3,
    layers: Layers,
}

/// The layers of a principled surface, prepared.
enum Layers {
    None,
    Gltf(LocalScattering),
    OpenPbr(LocalScattering<f32, OpenPbr>),
}

/// An expression of the prepared layers, or one without them.
macro_rules! by_layers {
    ($prepared:expr, $layers:ident => $with:expr, $without:expr) => {
        match &$prepared.layers {
            Layers::Gltf($layers) => $with,
            Layers::OpenPbr($layers) => $with,
            Layers::None => $without,
        }
    };
}

impl LaneBsdf<f32> for Bsdf {
    type Prepared = PreparedBsdf;

    fn traits(&self) -> ClassTraits {
        match self {
            Self::CoatedDiffuse(bsdf) => bsdf.traits(),
            Self::CoatedConductor(bsdf) => bsdf.traits(),
            Self::Principled(_) | Self::OpenPbr(_) => {
                ClassTraits { needs_agreement: true, ..ClassTraits::PLAIN }
            }
            _ => ClassTraits::PLAIN,
        }
    }

    fn prepare(&self, wo: Vector<f32>) -> PreparedBsdf {
        let wo = wo.into();
        let layers = match self {
            Self::Principled(look) => Layers::Gltf(look.scattering(wo, Lobes::ALL)),
            Self::OpenPbr(look) => Layers::OpenPbr(look.layers().scattering(wo, Lobes::ALL)),
            _ => Layers::None,
        };
        PreparedBsdf { wo, layers }
    }

    fn f(&self, prepared: &PreparedBsdf, wi: Vector<f32>) -> Spectrum {
        let without = || self.f(prepared.wo, wi.into(), Mode::Radiance);
        by_layers!(prepared, layers => layers.f(wi, Mode::Radiance), without())
    }

    fn pdf(&self, prepared: &PreparedBsdf, wi: Vector<f32>) -> f32 {
        let without = || self.pdf(prepared.wo, wi.into(), Mode::Radiance, Lobes::ALL);
        by_layers!(prepared, layers => layers.pdf(wi), without())
    }

    fn f_and_pdf(&self, prepared: &PreparedBsdf, wi: Vector<f32>) -> (Spectrum, f32) {
        let without = || {
            let f = LaneBsdf::f(self, prepared, wi);
            (f, if f.is_black() { 0.0 } else { LaneBsdf::pdf(self, prepared, wi) })
        };
        by_layers!(prepared, layers => layers.f_and_pdf(wi, Mode::Radiance), without())
    }

    fn sample(&self, prepared: &PreparedBsdf, uc: f32, u: [f32; 2]) -> DirectionSample<f32> {
        let without = || self.sample(prepared.wo, uc, u, Mode::Radiance, Lobes::ALL).into();
        by_layers!(prepared, layers => layers.sample(uc, u, Mode::Radiance), without())
    }

    fn has_density(&self) -> bool {
        self.lobes().is_non_specular()
    }

    fn diffuse_share(&self, prepared: &PreparedBsdf, wi: Vector<f32>, f: Spectrum) -> Spectrum {
        let without = || self.class().diffuse_share(prepared.wo, wi.into(), f);
        by_layers!(prepared, layers => layers.diffuse_f(wi).share_of(f), without())
    }
}

impl From<Option<BsdfSample>> for DirectionSample<f32> {
    fn from(sample: Option<BsdfSample>) -> Self {
        let is_valid = sample.is_some();
        let none = BsdfSample::new(Vec3::Z, Spectrum::BLACK, 1.0, Lobes::NONE);
        let BsdfSample { wi, f, pdf, lobe, eta, .. } = sample.unwrap_or(none);
        Self {
            wi: wi.into(),
            f,
            pdf,
            eta,
            is_specular: lobe.is_specular(),
            is_diffuse: lobe.intersects(Lobes::DIFFUSE),
            is_transmission: lobe.is_transmission(),
            is_valid,
        }
    }
}

/// A BSDF whose directions are sampled uniformly over the sphere, whatever it is: to verify importance sampling.
pub(crate) struct Uniform<'a> {
    pub(crate) bsdf: &'a Bsdf,
    /// The axes of its frame, in the space where the numbers of samples make directions.
    pub(crate) axes: [[f32; 3]; 3],
}

impl LaneBsdf<f32> for Uniform<'_> {
    type Prepared = PreparedBsdf;

    fn traits(&self) -> ClassTraits {
        ClassTraits { pdf_is_proportional: false, ..self.bsdf.traits() }
    }

    fn prepare(&self, wo: Vector<f32>) -> PreparedBsdf {
        self.bsdf.prepare(wo)
    }

    fn f(&self, prepared: &PreparedBsdf, wi: Vector<f32>) -> Spectrum {
        LaneBsdf::f(self.bsdf, prepared, wi)
    }

    fn pdf(&self, _: &PreparedBsdf, _: Vector<f32>) -> f32 {
        warp::UNIFORM_SPHERE_PDF
    }

    fn sample(&self, prepared: &PreparedBsdf, _: f32, u: [f32; 2]) -> DirectionSample<f32> {
        let direction = warp::uniform_sphere(u);
        let wi = Vec3::from(self.axes.map(|axis| direction.dot(axis.into())));
        let lobe = Lobes::REFLECTION.union(Lobes::DIFFUSE);
        let f = LaneBsdf::f(self.bsdf, prepared, wi.into());
        Some(BsdfSample::new(wi, f, warp::UNIFORM_SPHERE_PDF, lobe)).into()
    }

    fn has_density(&self) -> bool {
        self.bsdf.has_density()
    }
}
