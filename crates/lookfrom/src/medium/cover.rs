//! Cover of a camera ray's way by a medium, for the features of the denoiser: that of a surface of a fractional alpha.
//!
//! Features should have no noise that light does not have. So optical depths are not estimated by random collisions: a medium that varies
//! is looked up at points at equal optical depths of its majorant, the first of them anywhere (systematic sampling).

use glam::Vec3;

use super::grid::Lookup;
use super::majorants::Approach;
use super::{Coefficients, Medium, Way};
use crate::core::lanes::LANES;
use crate::core::lanes::width::One;
use crate::shading::texture::{SpectralMode, Textures};

/// The look of a medium along a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cover {
    /// The part of the light behind that it scatters or absorbs, in the mean of R, G and B: 0 … 1.
    pub(crate) part: f32,
    /// The albedo of that part, in linear Rec. 709; white where the medium emits.
    pub(crate) albedo: Vec3,
    /// The distance before which half of the part is covered.
    pub(crate) distance: f32,
}

/// The optical depth of the majorant between two points.
const STEP: f32 = 0.25;

/// The optical depth behind which nothing is seen.
const DEEPEST: f32 = 8.0;

impl Medium {
    /// The cover of a way; `None` in a medium that only absorbs.
    pub(crate) fn cover(&self, textures: &Textures, way: &Way) -> Option<Cover> {
        if self.phase.is_none() && self.emission.is_none() {
            return None;
        }
        let mode = SpectralMode::Rgb;
        let even = self.coefficients(textures, &mode);
        let Some(varying) = self.varying.as_deref() else {
            let sigma = extinction(&even);
            if sigma == 0.0 {
                return None;
            }
            let part = -libm::expm1f(-sigma * way.length);
            let distance = -libm::log1pf(-0.5 * part) / sigma;
            return Some(Cover { part, albedo: self.albedo(&even), distance });
        };
        let (origin, direction) = (varying.point(way.origin), varying.direction(way.direction));
        let (start, walk) = varying.majorants.walk(origin, direction, way.length)?;
        let mut approach = Approach { walk, t: start, majorant: 0.0, left: way.number() * STEP };
        let (mut depth, mut albedo) = (0.0, Vec3::ZERO);
        // The distances of the points, with the parts up to there.
        let mut parts: Vec<[f32; 2]> = Vec::new();
        while depth < DEEPEST && approach.arrive(&varying.majorants, (direction.into(), even.most()), true) {
            let Approach { t, majorant, .. } = approach;
            approach.left = STEP;
            let point = (origin + direction * t).into();
            let here = varying.at(One, point, Lookup::Interpolated, &even, 0.0, (textures, &[&mode; LANES]));
            let before = parts.last().map_or(0.0, |[_, part]| *part);
            depth += STEP * extinction(&here) / majorant;
            let part = -libm::expm1f(-depth);
            albedo += (part - before) * self.albedo(&here);
            parts.push([t, part]);
        }
        let part = parts.last().map_or(0.0, |[_, part]| *part);
        let [distance, _] = *parts.iter().find(|[_, up_to]| *up_to >= 0.5 * part)?;
        (part > 0.0).then(|| Cover { part, albedo: albedo / part, distance })
    }

    /// σ_s / σ_t.
    fn albedo(&self, here: &Coefficients) -> Vec3 {
        if self.emission.is_some() {
            return Vec3::ONE;
        }
        let [scattering, extinction] = [here.scattering, here.extinction()].map(|of| Vec3::from(of.rgb()));
        let albedo = scattering / extinction;
        Vec3::select(extinction.cmpgt(Vec3::ZERO), albedo, Vec3::ONE)
    }
}

/// σ_t, in the mean of R, G and B.
fn extinction(here: &Coefficients) -> f32 {
    here.extinction().rgb().into_iter().sum::<f32>() / 3.0
}
