//! The first surfaces of a batch of camera rays: those that steps leave, and those that are found again after it.
//!
//! No probe is needed, so that rendering is not slowed down: steps leave the surfaces that they have at hand; first hits
//! are noted besides as they are traced, and evaluated after the batch where no step has left a surface. Where a ray
//! passes a surface as if it were not there, the hit behind it counts; but where chance decides that, by an alpha between
//! 0 and 1, or where a medium scatters light before, all along the ray counts by what it covers, so that features have no noise that light
//! does not have.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};
use lookfrom_simd::LaneMask;

use super::{AovColumns, Aovs, CameraSpace, Cover, FirstSurfaceColumns};
use crate::core::lanes::LANES;
use crate::core::times::Times;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::world::World;

/// The first surfaces of a batch, by slot, in memory that is reused.
#[derive(Debug, Default)]
pub struct FirstSurfaces {
    /// The space of AOVs; `None` where none are wanted.
    space: Option<CameraSpace>,
    /// By slot.
    aovs: Vec<AovColumns>,
    /// The surfaces that a step is about to leave.
    block: FirstSurfaceColumns,
    /// The hits of the camera's rays, by slot.
    outermost: Vec<Hit>,
    /// Further hits of rays that have passed surfaces, with their slots, in the order in which they were found.
    behind: Vec<(u32, RayHit)>,
    /// Whether rays may pass surfaces yet.
    go_on: bool,
}

/// A ray and what it has hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayHit {
    pub(crate) ray: Ray,
    pub(crate) hit: Hit,
}

impl FirstSurfaces {
    /// Sets the space of the AOVs of batches to come; `None` where none are wanted.
    pub(crate) fn set_space(&mut self, space: Option<CameraSpace>) {
        self.space = space;
    }

    /// Whether there are to be any.
    #[inline]
    pub(crate) fn are_wanted(&self) -> bool {
        self.space.is_some()
    }

    /// Whether steps are to leave surfaces that rays from the camera meet in a medium.
    #[inline]
    pub(crate) fn are_left_in(&self, interior: InteriorStack) -> bool {
        self.space.as_ref().is_some_and(|space| space.media.is_none() || interior.is_empty())
    }

    /// Removes all, for a batch of `count` camera rays.
    pub(crate) fn start(&mut self, count: usize) {
        if self.are_wanted() {
            self.aovs.resize(count.div_ceil(LANES), AovColumns::default());
            self.aovs.iter_mut().for_each(|eight| eight.hits = 0);
        }
        self.outermost.clear();
        self.behind.clear();
        self.go_on = true;
    }

    /// Notes the hits of the camera's rays, by slot.
    pub(crate) fn note_outermost(&mut self, hits: &[Hit]) {
        if self.are_wanted() {
            self.outermost.extend_from_slice(hits);
        }
    }

    /// Notes the hits of some of `count` rays of the camera, with their slots; the others hit nothing.
    pub(crate) fn note_outermost_of(&mut self, slots: impl Iterator<Item = u32>, hits: &[Hit], count: usize) {
        if self.are_wanted() {
            self.outermost.resize(count, Hit::MISS);
            slots.zip(hits).for_each(|(slot, hit)| self.outermost[slot as usize] = *hit);
        }
    }

    /// Notes the hits of those that have passed the surfaces so far, with their slots.
    pub(crate) fn note_behind(&mut self, hits: impl Iterator<Item = (u32, RayHit)>) {
        if self.are_wanted() && self.go_on {
            let count = self.behind.len();
            self.behind.extend(hits);
            self.go_on = self.behind.len() > count;
        }
    }

    /// Eight surfaces, to be replaced by a step and left by [`Self::leave_block`].
    #[inline]
    pub(crate) fn block(&mut self) -> &mut FirstSurfaceColumns {
        &mut self.block
    }

    /// Leaves the surfaces of [`Self::block`].
    pub(crate) fn leave_block(&mut self) {
        if let Some(space) = &self.space {
            space.set_aovs(&self.block, &mut self.aovs);
        }
    }

    /// Leaves the surface of a slot; with its albedo, where that is known.
    pub(crate) fn leave(
        &mut self,
        world: &World,
        slot: u32,
        surface: &SurfaceInteraction,
        albedo: Option<[f32; 3]>,
    ) {
        if let Some(space) = &self.space {
            let slot = slot as usize;
            self.aovs[slot / LANES].set(slot % LANES, &space.aovs(world, surface, albedo));
        }
    }

    /// The AOVs by slot, at the end of a batch of camera rays with their times, where they are wanted. Of few hits no step has left a surface, as of those
    /// that light may pass as if they were not there.
    pub(crate) fn aovs(&mut self, world: &World, (rays, times): (&[Ray], &Times)) -> Option<&[AovColumns]> {
        let space = self.space?;
        // Of the hits of a slot, the last one counts.
        self.behind.sort_by_key(|&(slot, _)| slot);
        for (block, hits) in self.outermost.chunks(LANES).enumerate() {
            let left = !self.aovs[block].hits & ((1 << hits.len()) - 1);
            for lane in LaneMask(left).filter(|lane| hits[*lane].is_hit() || fills_space(&space)) {
                let slot = block * LANES + lane;
                if let Some(aovs) = self.found_again(world, &space, slot, (rays[slot], times.of(slot))) {
                    self.aovs[block].set(lane, &aovs);
                }
            }
        }
        Some(&self.aovs)
    }

    /// The hit of a slot that has AOVs, after [`Self::aovs`].
    pub(crate) fn met(&self, slot: usize, ray: Ray) -> Option<RayHit> {
        let has_aovs = self.aovs[slot / LANES].hits >> (slot % LANES) & 1 != 0;
        has_aovs.then(|| self.seen(slot, ray))
    }

    /// The hit of a slot that counts: behind what its ray from the camera passes as if it were not there.
    fn seen(&self, slot: usize, ray: Ray) -> RayHit {
        let end = self.behind.partition_point(|(of, _)| *of as usize <= slot);
        let behind = self.behind[..end].last().filter(|(of, _)| *of as usize == slot);
        behind.map_or(RayHit { ray, hit: self.outermost[slot] }, |(_, seen)| *seen)
    }

    /// The AOVs of a slot by its noted hits; `None` for a miss.
    pub(crate) fn found_again(
        &self,
        world: &World,
        space: &CameraSpace,
        slot: usize,
        (ray, time): (Ray, f32),
    ) -> Option<Aovs> {
        let outermost = RayHit { ray, hit: self.outermost[slot] };
        let is_blended = world.has_gaps() || space.media.is_some();
        let blended = if is_blended { space.blended_aovs(world, outermost, time) } else { None };
        blended.or_else(|| {
            let RayHit { ray, hit } = self.seen(slot, ray);
            hit.is_hit().then(|| space.aovs(world, &world.surface_at(&ray, &hit, time), None))
        })
    }
}

/// Whether rays from the camera are in a medium without an end, which is seen where they hit nothing.
fn fills_space(space: &CameraSpace) -> bool {
    space.media.is_some_and(|interior| interior.space().is_some())
}

impl CameraSpace {
    /// The mean albedo and shading normal of all surfaces and media along a camera ray by what each covers, and the place of
    /// what covers most; `None` where no surface has an alpha between 0 and 1, and no medium covers anything. What nothing covers is
    /// white, as a miss is. Where there are media, the normal is as long as the part that is covered.
    fn blended_aovs(&self, world: &World, outermost: RayHit, time: f32) -> Option<Aovs> {
        let (mut is_blended, mut has_medium) = (false, false);
        let (mut albedo, mut ns) = (Vec3::ZERO, Vec3::ZERO);
        let mut most: Option<(f32, Aovs)> = None;
        let left = world.covers(self.media, outermost, time, |part, cover| {
            let aovs = match cover {
                Cover::Medium { cover, way } => {
                    (is_blended, has_medium) = (true, true);
                    self.aovs_of_medium(cover, way)
                }
                Cover::Surface { surface, opacity, .. } => {
                    is_blended |= opacity < 1.0;
                    self.aovs(world, surface, None)
                }
            };
            albedo += part * Vec3::from(aovs.albedo);
            ns += part * Vec3::from(aovs.ns);
            if most.is_none_or(|(greatest, _)| part > greatest) {
                most = Some((part, aovs));
            }
        });
        let (_, aovs) = most.filter(|_| is_blended)?;
        let length = if has_medium { 1.0 - left } else { 1.0 };
        let ns = ns.normalize_or_zero() * length;
        Some(Aovs { albedo: (albedo + left).to_array(), ns: ns.to_array(), ..aovs })
    }
}
