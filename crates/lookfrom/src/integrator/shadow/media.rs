//! Transmittances of shadow rays through media that vary, which are estimated side by side.

use lookfrom_bvh::Ray;

use super::ShadowLight;
use super::queue::length;
use crate::core::spectrum::Spectrum;
use crate::integrator::SpectralModes;
use crate::medium::{Estimate, TrackedRay, Way};
use crate::world::World;

/// Transmittances by the places of rays, where their media vary.
#[derive(Default)]
pub(super) struct Transmittances(Vec<Option<Spectrum>>);

impl Transmittances {
    /// The transmittances of so many rays. `of` tells of a place the ray, its light, and the distance as far as which media count; `None` of a ray that
    /// is blocked.
    pub(super) fn estimate<'a>(
        world: &World,
        modes: &SpectralModes,
        count: usize,
        of: impl Fn(usize) -> Option<(&'a Ray, &'a ShadowLight, f32)>,
    ) -> Self {
        let mut all = Self::default();
        let varies = |number: &u32| world.media[*number as usize].varying.is_some();
        if !(0..world.media.len() as u32).any(|number| varies(&number)) {
            return all;
        }
        // The rays in each medium, whose places ascend.
        let mut waiting: Vec<(u32, usize, TrackedRay<'_>)> = Vec::new();
        for place in 0..count {
            let Some((ray, light, t)) = of(place) else { continue };
            if light.interior.is_empty() {
                continue;
            }
            let Some(number) = light.interior.medium(&world.materials).filter(varies) else { continue };
            let length = length(world, ray, t, light.interior);
            // A body must end somewhere: where a ray in it hits nothing, it is in none.
            if length.is_finite() || light.interior.space().is_some() {
                let ray = TrackedRay::of_shadow(&Way::new(ray, length), &modes[light.slot as usize]);
                waiting.push((number, place, ray));
            }
        }
        waiting.sort_by_key(|(number, ..)| *number);
        all.0.resize(count, None);
        for together in waiting.chunk_by(|(a, ..), (b, ..)| a == b) {
            let rays: Vec<TrackedRay<'_>> = together.iter().map(|(.., ray)| *ray).collect();
            let medium = &world.media[together[0].0 as usize];
            let tracked = medium.track(&world.textures, Estimate::Transmittance, &rays, false);
            for ((_, place, _), tracking) in together.iter().zip(tracked.into_iter().flatten()) {
                all.0[*place] = Some(tracking.after);
            }
        }
        all
    }

    /// The transmittance of the ray at a place; `None` where no medium varies.
    #[inline]
    pub(super) fn at(&self, place: usize) -> Option<Spectrum> {
        self.0.get(place).copied().flatten()
    }
}
