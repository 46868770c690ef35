//! Environments sampled by a guide: a mixture of its density with that of the environment alone, as one sample with one density
//! (Veach & Guibas 1995, "one-sample model"; Müller, Gross & Novák 2017).

use glam::Vec3;

use super::{Environment, Sky};
use crate::core::sampler::ONE_MINUS_EPSILON;
use crate::light::guide::{Guide, Histogram};
use crate::light::{IncompletePdf, LightSample, LightSampleContext, Target};
use crate::shading::texture::{SpectralMode, Textures};

/// The largest part of the samples that a guide to an environment map chooses: the rest finds what is too small for its cells, as the
/// sun.
const MOST_OF_MAP: f32 = 0.75;

/// The density that a direction is sampled with, and its random numbers there.
#[derive(Clone, Copy)]
pub(super) enum Chosen<'a> {
    /// That of a guide.
    Guide(&'a Histogram, [f32; 2]),
    /// That of the environment alone.
    Environment([f32; 2]),
}

impl Environment {
    /// The histogram of the guide at a point, if there is one.
    #[inline]
    pub(crate) fn histogram(&self, at: &LightSampleContext) -> Option<&Histogram> {
        self.guide.as_ref()?.histogram(at.point.as_vec3(), at.n)
    }

    /// The largest part of the samples that a guide may choose: all where they are sampled by nothing else.
    pub(crate) fn most_guided(&self) -> f32 {
        if matches!(self.sky, Sky::Image(_)) { MOST_OF_MAP } else { 1.0 }
    }

    /// Chooses the density of a sample.
    #[inline]
    pub(super) fn choose<'a>(&self, histogram: Option<&'a Histogram>, [u, v]: [f32; 2]) -> Chosen<'a> {
        let Some(histogram) = histogram else { return Chosen::Environment([u, v]) };
        let share = histogram.share;
        if u < share {
            Chosen::Guide(histogram, [(u / share).min(ONE_MINUS_EPSILON), v])
        } else {
            Chosen::Environment([((u - share) / (1.0 - share)).min(ONE_MINUS_EPSILON), v])
        }
    }

    /// The solid angle density of a unit direction without a guide, where BSDFs are sampled as well.
    pub(super) fn unguided_pdf(&self, wi: Vec3) -> f32 {
        match &self.sky {
            Sky::Image(sky) => sky.pdf(wi, IncompletePdf::Allowed),
            _ => 0.0,
        }
    }

    /// The solid angle density of a unit direction, by that which it has without a guide.
    #[inline]
    pub(crate) fn mixed_pdf(&self, histogram: Option<&Histogram>, wi: Vec3, unguided: f32) -> f32 {
        match histogram {
            None => unguided,
            Some(histogram) => {
                let share = histogram.share;
                share * histogram.pdf(wi) + (1.0 - share) * unguided
            }
        }
    }

    /// A sampled direction with the density of [`Environment::pdf`].
    pub(super) fn sample_guided(
        &self,
        guide: &Guide,
        textures: &Textures,
        at: &LightSampleContext,
        u: [f32; 2],
        mode: &SpectralMode,
    ) -> Option<LightSample> {
        let histogram = guide.histogram(at.point.as_vec3(), at.n);
        let wi = match (self.choose(histogram, u), &self.sky) {
            (Chosen::Guide(histogram, u), _) => histogram.sample(u),
            (Chosen::Environment(u), Sky::Image(sky)) => {
                let (uv, _) = sky.choice(IncompletePdf::Allowed).sample(u);
                sky.direction(uv).0.into()
            }
            (Chosen::Environment(_), _) => return None,
        };
        let pdf = self.mixed_pdf(histogram, wi, self.unguided_pdf(wi));
        let li = self.color(textures, wi, mode);
        let usable = pdf > 0.0 && pdf.is_finite() && !li.is_black();
        usable.then_some(LightSample { wi, li, pdf, target: Target::Infinity })
    }
}
