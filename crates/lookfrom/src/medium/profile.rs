//! The density of a medium that varies, along a ray: for the inspector, whose collisions are points of it.

use super::grid::Lookup;
use super::{Coefficients, Medium, Way};
use crate::core::lanes::LANES;
use crate::core::lanes::width::One;
use crate::core::spectrum::Spectrum;
use crate::shading::texture::{SpectralMode, Textures};

/// Extinction and majorants at the middles of equal parts of a way.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// The distance from which on there is something of the medium …
    pub start: f32,
    /// … and that up to which.
    pub end: f32,
    /// σ_t.
    pub extinction: Vec<Spectrum>,
    /// The majorants of the cells there.
    pub majorant: Vec<f32>,
}

/// Number of parts.
const PARTS: usize = 32;

impl Medium {
    /// The profile along a way; `None` in a homogeneous medium, or where the way does not meet it.
    pub(crate) fn profile(
        &self,
        way: &Way,
        (textures, mode): (&Textures, &SpectralMode),
    ) -> Option<Box<Profile>> {
        let varying = self.varying.as_deref()?;
        let even = self.coefficients(textures, mode);
        let (origin, direction) = (varying.point(way.origin), varying.direction(way.direction));
        let (start, mut walk) = varying.majorants.walk(origin, direction, way.length)?;
        let mut profile = Profile { start, end: walk.last, ..Profile::default() };
        let mut bound = 0.0;
        for part in 0..PARTS {
            let t = start + (walk.last - start) * ((part as f32 + 0.5) / PARTS as f32);
            while walk.end <= t {
                bound = walk.advance(&varying.majorants, direction.into(), true);
            }
            let point = (origin + direction * t).into();
            let here = varying.at(One, point, Lookup::Interpolated, &even, 0.0, (textures, &[mode; LANES]));
            profile.extinction.push(here.extinction());
            profile.majorant.push((bound * even.most()).min(Coefficients::MOST));
        }
        Some(Box::new(profile))
    }
}
