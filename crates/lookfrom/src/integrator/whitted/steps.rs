//! The steps of Whitted's model for the paths of a batch: plain hits are shaded eight side by side, others one by one; the
//! results become events, shadow rays and further paths one by one.

use glam::Vec3;
use lookfrom_bvh::{Hit, OriginPrimitive};

use super::Whitted;
use super::bins::{Bins, Chosen};
use super::groups::{FromLight, Group, Groups};
use super::plain::PlainHits;
use super::step::{Eight, PlainKernel, Wanted, shade_one};
use super::told::Told;
use crate::core::lanes::{LANES, by_lane, filled, shade_together};
use crate::integrator::{
    BatchStreams, Branch, Event, Path, Probe, Queues, SampleStream, Shadow, StepOutput, Term,
};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::material::Coefficients;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The steps of the paths of a batch: memory that is reused.
#[derive(Debug, Default)]
pub(in crate::integrator) struct Steps {
    groups: Groups,
    /// For each path the number of its group times eight and its lane there; [`NOT_PLAIN`] for others.
    places: Vec<u32>,
    bins: Bins,
    /// Slots that occurred, 64 in each number.
    slots: Vec<u64>,
}

/// The place of a path whose hit is not plain.
const NOT_PLAIN: u32 = u32::MAX;

/// The step of one path.
pub(super) struct Shaded<'a> {
    group: &'a Group,
    lights: &'a [FromLight],
    told: Option<&'a Told>,
    lane: usize,
}

impl Steps {
    /// Prepares for a number of other paths, of which none has a plain hit yet.
    pub(super) fn clear(&mut self, path_count: usize) {
        self.groups.clear();
        self.places.clear();
        self.places.resize(path_count, NOT_PLAIN);
    }

    /// Whether no two paths belong to one sample, so that their results may be used in any order.
    pub(super) fn are_of_different_samples(&mut self, paths: &[Path]) -> bool {
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
    pub(super) fn compute<'a, P: Probe>(
        &mut self,
        world: &World,
        streams: &BatchStreams<'_>,
        (paths, hits): (&[Path], &[Hit]),
        wanted: Wanted<'_>,
        output: &mut StepOutput<'a, P>,
        mut finish: impl FnMut(&mut Self, &[u32], &mut StepOutput<'a, P>),
    ) {
        let mut bins = std::mem::take(&mut self.bins);
        let mut shade = |chosen: &Chosen<'_>| {
            self.shade(world, streams, (paths, hits), chosen, wanted, &mut output.queues);
            finish(self, chosen.paths, output);
        };
        for (index, hit) in hits.iter().enumerate() {
            if let Some(plain) = world.plain(hit) {
                bins.push(plain, index as u32, &mut shade);
            }
        }
        bins.flush(&mut shade);
        self.bins = bins;
    }

    /// Adds the steps of up to eight paths.
    #[inline(never)]
    fn shade(
        &mut self,
        world: &World,
        streams: &BatchStreams<'_>,
        (paths, hits): (&[Path], &[Hit]),
        chosen: &Chosen<'_>,
        wanted: Wanted<'_>,
        Queues { modes, first_surfaces, .. }: &mut Queues,
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
        let mut target = eight.aov_target(world, chosen.paths.len(), first_surfaces);
        let (groups, first) = (&mut self.groups, target.as_deref_mut());
        shade_together(PlainKernel { world, eight: &eight, streams, modes, wanted, groups, first });
        if let Some(target) = target {
            eight.set_other_albedos(world, modes, target);
            first_surfaces.leave_block();
        }
    }

    /// Computes the step of one path, whatever it has hit, and calls `finish` with it.
    pub(super) fn shade_one(
        &mut self,
        world: &World,
        path: (&Path, &SampleStream, &SpectralMode),
        surface: &SurfaceInteraction,
        coefficients: &Coefficients,
        wanted: Wanted<'_>,
        finish: impl FnOnce(&Shaded<'_>),
    ) {
        let end = self.groups.end();
        shade_one(world, path, surface, coefficients, wanted, &mut self.groups);
        if let Some(shaded) = self.shaded(end.groups * LANES) {
            finish(&shaded);
        }
        self.groups.rewind(end);
    }

    /// The step of a path, if its hit is plain.
    #[inline(always)]
    pub(super) fn of(&self, path: usize) -> Option<Shaded<'_>> {
        self.shaded(self.places[path] as usize)
    }

    #[inline(always)]
    fn shaded(&self, place: usize) -> Option<Shaded<'_>> {
        let (group, lights, told) = self.groups.get(place / LANES)?;
        Some(Shaded { group, lights, told, lane: place % LANES })
    }

    /// Whether the hit of a path is plain.
    #[inline(always)]
    pub(super) fn is_plain(&self, path: usize) -> bool {
        self.places[path] != NOT_PLAIN
    }

    /// Makes room for other groups.
    #[inline(always)]
    pub(super) fn remove_groups(&mut self) {
        self.groups.clear();
    }
}

/// A path, absorbed by media on its way, and what it has hit.
pub(super) struct Vertex<'a> {
    pub(super) path: &'a Path,
    pub(super) hit: &'a Hit,
    /// The surface, where that is not plain.
    pub(super) surface: Option<&'a SurfaceInteraction>,
}

impl Vertex<'_> {
    /// The media of a ray that leaves through the surface in a direction, or to the side of the path.
    #[inline(always)]
    fn interior(&self, world: &World, shaded: &Shaded<'_>, through: Option<[f32; 3]>) -> InteriorStack {
        let interior = self.path.interior;
        if let Some(surface) = self.surface {
            let direction = through.map_or(surface.wo, Vec3::from);
            return interior.leaving(&world.materials, surface, direction, through.is_some());
        }
        let material = shaded.group.materials[shaded.lane];
        match through.is_some() && world.materials[material as usize].is_body() {
            true if shaded.group.front & 1 << shaded.lane != 0 => interior.entered(material),
            true => interior.left(material),
            false => interior,
        }
    }
}

impl Shaded<'_> {
    /// Tells the probe of the surface and adds its emission, where it may have any.
    #[cold]
    fn tell_surface<P: Probe>(&self, world: &World, vertex: &Vertex<'_>, output: &mut StepOutput<'_, P>) {
        let Vertex { path, hit, surface } = *vertex;
        output.probe.notice_some(|| {
            self.told.map(|told| Event::Surface {
                address: path.address,
                surface: Box::new(surface.copied().unwrap_or_else(|| world.surface(&path.ray, hit))),
                coefficients: Some(Box::new(told.coefficients[self.lane])),
            })
        });
        if let Some(surface) = surface {
            let mode = output.mode(path);
            let emits = world.emitted(surface, &mode) + world.unlit(surface, &mode).unwrap_or_default();
            output.add(path, Term::Emission, path.beta * emits);
        }
    }

    /// Adds the light of the surface to the sample of its path, and the paths that go on in the tree, if there is one.
    #[inline(always)]
    pub(super) fn finish<P: Probe>(
        &self,
        world: &World,
        vertex: &Vertex<'_>,
        tree: Option<&Whitted>,
        output: &mut StepOutput<'_, P>,
    ) {
        let path = vertex.path;
        if P::LISTENS || vertex.surface.is_some() {
            self.tell_surface(world, vertex, output);
        }
        output.add(path, Term::Ambient, self.group.ambient[self.lane]);
        if P::LISTENS
            && let Some(told) = self.told
        {
            told.events[self.lane].iter().for_each(|event| output.probe.notice(|| event.clone()));
        }
        self.add_lights(world, vertex, output);
        if let Some(tree) = tree {
            for branch in [Branch::Mirrored, Branch::Refracted] {
                self.grow(world, vertex, (tree, branch), output);
            }
        }
    }

    #[inline(always)]
    fn add_lights<P: Probe>(&self, world: &World, vertex: &Vertex<'_>, output: &mut StepOutput<'_, P>) {
        let (path, lane) = (vertex.path, self.lane);
        for from in self.lights.iter().filter(|from| from.lit & 1 << lane != 0) {
            let ray = from.rays[lane];
            let last_scattering = output.last_scattering(path, false, || from.diffuse[lane]);
            output.queues.shadows.push(Shadow {
                ray,
                origin_primitive: OriginPrimitive::of(vertex.hit),
                contribution: from.contribution[lane],
                slot: path.slot,
                address: path.address,
                term: Term::Light(from.light),
                interior: vertex.interior(world, self, None),
                last_scattering,
            });
        }
    }

    #[inline(always)]
    fn grow<P: Probe>(
        &self,
        world: &World,
        vertex: &Vertex<'_>,
        (tree, branch): (&Whitted, Branch),
        output: &mut StepOutput<'_, P>,
    ) {
        let (path, lane) = (vertex.path, self.lane);
        let crosses = branch == Branch::Refracted;
        let rays = &self.group.branches[usize::from(crosses)];
        if rays.exist & 1 << lane == 0 {
            return;
        }
        let (ray, beta) = (rays.rays[lane], rays.beta[lane]);
        if tree.cut(path, beta).is_none() {
            let light_path = output.scattered(path, [true, false, crosses]);
            output.queues.paths.push(Path {
                ray,
                beta,
                depth: path.depth + 1,
                address: path.address << 1 | u64::from(crosses),
                interior: vertex.interior(world, self, crosses.then_some(ray.direction)),
                light_path,
                ..*path
            });
        }
    }
}
