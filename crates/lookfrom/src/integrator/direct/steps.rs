//! The steps of Whitted's model for the paths of a batch: those with plain hits are computed eight side by side, and their
//! results become shadow rays and further paths one by one.

use lookfrom_bvh::{Hit, OriginPrimitive, Ray};

use super::groups::{FromLight, Group, Groups};
use super::lanes::{Eight, PlainKernel};
use super::plain::PlainHits;
use super::waiting::{Chosen, Waiting};
use crate::core::lanes::{LANES, by_lane, filled, shade_together};
use crate::core::spectrum::Spectrum;
use crate::integrator::{
    BatchStreams, Branch, FirstSurfaces, Path, Probe, Queues, Shadow, SpectralModes, StepOutput, Term,
};
use crate::light::Light;
use crate::shading::interior_stack::InteriorStack;
use crate::world::World;

/// The steps of the paths of a batch that have plain hits: memory that is reused.
#[derive(Debug, Default)]
pub(in crate::integrator) struct PlainSteps {
    groups: Groups,
    /// For each path the number of its group times eight and its lane there; [`NOT_PLAIN`] for others.
    places: Vec<u32>,
    waiting: Waiting,
    /// Slots that occurred, 64 in each number.
    slots: Vec<u64>,
}

/// The place of a path whose hit is not plain.
const NOT_PLAIN: u32 = u32::MAX;

/// The step of one path with a plain hit.
pub(in crate::integrator) struct PlainStep<'a> {
    group: &'a Group,
    lights: &'a [FromLight],
    lane: usize,
}

/// A path that may go on from a plain surface.
pub(in crate::integrator) struct PlainBranch {
    /// Its kind.
    pub(in crate::integrator) branch: Branch,
    /// The path throughput.
    pub(in crate::integrator) beta: Spectrum,
    /// The ray.
    pub(in crate::integrator) ray: Ray,
    /// Index of the surface's material.
    pub(in crate::integrator) material: u32,
    /// Whether the path met the surface's outside.
    pub(in crate::integrator) front: bool,
}

impl PlainSteps {
    /// Whether steps are computed in lanes at all: if all lights are of kinds that are sampled there.
    pub(in crate::integrator) fn are_for(world: &World) -> bool {
        world.lights.iter().all(|light| match light {
            Light::Point { .. } | Light::Distant { .. } => true,
            Light::Area(light) => light.is_in_lanes(),
            _ => !light.illuminates(),
        })
    }

    /// Prepares for a number of other paths, of which none has a plain hit yet.
    pub(in crate::integrator) fn clear(&mut self, path_count: usize) {
        self.groups.clear();
        self.places.clear();
        self.places.resize(path_count, NOT_PLAIN);
    }

    /// Whether no two paths belong to one sample, so that their results may be used in any order.
    pub(in crate::integrator) fn are_of_different_samples(&mut self, paths: &[Path]) -> bool {
        self.slots.clear();
        paths.iter().all(|path| {
            let (number, bit) = (path.slot as usize / 64, 1 << (path.slot % 64));
            if number >= self.slots.len() {
                self.slots.resize(number + 1, 0);
            }
            let is_new = self.slots[number] & bit == 0;
            self.slots[number] |= bit;
            is_new
        })
    }

    /// Computes the steps of plain hits. `finish` is called with groups as they are ready.
    #[inline]
    pub(in crate::integrator) fn compute<'a, P: Probe>(
        &mut self,
        world: &World,
        streams: &BatchStreams<'_>,
        (paths, hits): (&[Path], &[Hit]),
        output: &mut StepOutput<'a, P>,
        mut finish: impl FnMut(&mut Self, &[u32], &mut StepOutput<'a, P>),
    ) {
        let mut waiting = std::mem::take(&mut self.waiting);
        let mut shade = |chosen: &Chosen<'_>| {
            let Queues { modes, first_surfaces, .. } = &mut output.queues;
            self.shade(world, streams, (paths, hits), chosen, modes, first_surfaces);
            finish(self, chosen.paths, output);
        };
        for (index, hit) in hits.iter().enumerate() {
            if let Some(plain) = world.plain(hit) {
                waiting.push(plain, index as u32, &mut shade);
            }
        }
        waiting.flush(&mut shade);
        self.waiting = waiting;
    }

    /// Adds the steps of up to eight paths.
    #[inline(never)]
    fn shade(
        &mut self,
        world: &World,
        streams: &BatchStreams<'_>,
        (paths, hits): (&[Path], &[Hit]),
        chosen: &Chosen<'_>,
        modes: &SpectralModes,
        first_surfaces: &mut FirstSurfaces,
    ) {
        let &Chosen { paths: indices, materials, are_on_spheres } = chosen;
        for (lane, &index) in indices.iter().enumerate() {
            self.places[index as usize] = (self.groups.count() * LANES + lane) as u32;
        }
        let mut memory = [None; 2];
        let [first, second] = &mut memory;
        let (indices, materials) = (filled(indices, first), *filled(materials, second));
        let hits = by_lane!(lane => &hits[indices[lane] as usize]);
        let paths = by_lane!(lane => &paths[indices[lane] as usize]);
        let rays = by_lane!(lane => &paths[lane].ray);
        let eight = Eight { paths, plain: PlainHits { rays, hits, are_on_spheres }, materials };
        let mut left = eight.left(world, chosen.paths.len(), modes, first_surfaces);
        let (groups, first) = (&mut self.groups, left.as_mut().map(|left| &mut *left.first));
        shade_together(PlainKernel { world, eight: &eight, streams, modes, groups, first });
        if let Some(left) = left {
            left.set_other_albedos(world, &eight);
        }
    }

    /// The step of a path, if its hit is plain.
    #[inline(always)]
    pub(in crate::integrator) fn of(&self, path: usize) -> Option<PlainStep<'_>> {
        let place = self.places[path] as usize;
        let (group, lights) = self.groups.get(place / LANES)?;
        Some(PlainStep { group, lights, lane: place % LANES })
    }

    /// Whether the hit of a path is plain.
    #[inline(always)]
    pub(in crate::integrator) fn is_plain(&self, path: usize) -> bool {
        self.places[path] != NOT_PLAIN
    }

    /// Makes room for other groups.
    #[inline(always)]
    pub(in crate::integrator) fn remove_groups(&mut self) {
        self.groups.clear();
    }
}

impl PlainStep<'_> {
    /// Adds the light to the sample of its path.
    #[inline(always)]
    pub(in crate::integrator) fn add_light<P: Probe>(
        &self,
        world: &World,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        let (lane, bit) = (self.lane, 1 << self.lane);
        output.add(path, Term::Ambient, self.group.ambient[lane]);
        for from in self.lights.iter().filter(|from| from.lit & bit != 0) {
            let ray = from.rays[lane];
            let interior = match from.crosses & bit {
                0 => path.interior,
                _ => interior_behind(world, path, hit, &ray),
            };
            output.queues.shadows.push(Shadow {
                ray,
                origin_primitive: OriginPrimitive::of(hit),
                contribution: from.contribution[lane],
                slot: path.slot,
                address: path.address,
                term: Term::Light(from.light),
                interior,
                last_scattering: Shadow::NO_SCATTERING,
            });
        }
    }

    /// Calls `grow` with the paths that may go on: first the reflected one.
    #[inline(always)]
    pub(in crate::integrator) fn for_each_branch(&self, mut grow: impl FnMut(PlainBranch)) {
        let (lane, bit) = (self.lane, 1 << self.lane);
        let Group { branches, materials, front, .. } = self.group;
        let (mirrored, refracted) = (&branches.mirrored, &branches.refracted);
        for (branch, rays) in [(Branch::Mirrored, mirrored), (Branch::Refracted, refracted)] {
            if rays.exist & bit != 0 {
                grow(PlainBranch {
                    branch,
                    beta: rays.beta[lane],
                    ray: rays.rays[lane],
                    material: materials[lane],
                    front: front & bit != 0,
                });
            }
        }
    }
}

/// The media behind a surface, where a shadow ray goes on.
#[cold]
#[inline(never)]
fn interior_behind(world: &World, path: &Path, hit: &Hit, ray: &Ray) -> InteriorStack {
    let surface = world.surface(&path.ray, hit);
    path.interior.leaving(&world.materials, &surface, ray.direction.into(), true)
}
