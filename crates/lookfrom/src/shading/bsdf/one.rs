//! Any BSDF as a class of its own, at width one: for those that are not computed in lanes, and where lanes are not filled.

use glam::Vec3;

use super::lanes::{Kind, LaneBsdf};
use super::lobes::Lobes;
use super::principled::LocalScattering;
use super::{Bsdf, BsdfSample, DirectionSample, Mode};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;

/// A BSDF seen from the outgoing direction ω_o.
pub struct View {
    wo: Vec3,
    /// The view of glTF's layers.
    principled: Option<LocalScattering>,
}

impl LaneBsdf<f32> for Bsdf {
    type View = View;

    fn kind(&self) -> Kind {
        match self {
            Self::CoatedDiffuse(bsdf) => bsdf.kind(),
            Self::CoatedConductor(bsdf) => bsdf.kind(),
            Self::Principled(_) => Kind { needs_agreement: true, ..Kind::PLAIN },
            _ => Kind::PLAIN,
        }
    }

    fn view(&self, wo: Vector<f32>) -> View {
        let wo = wo.into();
        let principled = match self {
            Self::Principled(look) => Some(look.scattering(wo, Lobes::ALL)),
            _ => None,
        };
        View { wo, principled }
    }

    fn f(&self, view: &View, wi: Vector<f32>) -> Spectrum {
        match &view.principled {
            Some(principled) => principled.f(wi, Mode::Radiance),
            None => self.f(view.wo, wi.into(), Mode::Radiance),
        }
    }

    fn pdf(&self, view: &View, wi: Vector<f32>) -> f32 {
        match &view.principled {
            Some(principled) => principled.pdf(wi),
            None => self.pdf(view.wo, wi.into(), Mode::Radiance, Lobes::ALL),
        }
    }

    fn f_and_pdf(&self, view: &View, wi: Vector<f32>) -> (Spectrum, f32) {
        if let Some(principled) = &view.principled {
            return principled.f_and_pdf(wi, Mode::Radiance);
        }
        let f = LaneBsdf::f(self, view, wi);
        (f, if f.is_black() { 0.0 } else { LaneBsdf::pdf(self, view, wi) })
    }

    fn sample(&self, view: &View, uc: f32, u: [f32; 2]) -> DirectionSample<f32> {
        match &view.principled {
            Some(principled) => principled.sample(uc, u, Mode::Radiance),
            None => self.sample(view.wo, uc, u, Mode::Radiance, Lobes::ALL).into(),
        }
    }

    fn has_density(&self) -> bool {
        self.lobes().is_non_specular()
    }

    fn diffuse_share(&self, view: &View, wi: Vector<f32>, f: Spectrum) -> Spectrum {
        match &view.principled {
            Some(principled) => principled.diffuse_f(wi).share_of(f),
            None => self.class().diffuse_share(view.wo, wi.into(), f),
        }
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
    type View = View;

    fn kind(&self) -> Kind {
        Kind { pdf_is_proportional: false, ..self.bsdf.kind() }
    }

    fn view(&self, wo: Vector<f32>) -> View {
        self.bsdf.view(wo)
    }

    fn f(&self, view: &View, wi: Vector<f32>) -> Spectrum {
        LaneBsdf::f(self.bsdf, view, wi)
    }

    fn pdf(&self, _: &View, _: Vector<f32>) -> f32 {
        warp::UNIFORM_SPHERE_PDF
    }

    fn sample(&self, view: &View, _: f32, u: [f32; 2]) -> DirectionSample<f32> {
        let direction = warp::uniform_sphere(u);
        let wi = Vec3::from(self.axes.map(|axis| direction.dot(axis.into())));
        let lobe = Lobes::REFLECTION.union(Lobes::DIFFUSE);
        let f = LaneBsdf::f(self.bsdf, view, wi.into());
        Some(BsdfSample::new(wi, f, warp::UNIFORM_SPHERE_PDF, lobe)).into()
    }

    fn has_density(&self) -> bool {
        self.bsdf.has_density()
    }
}
