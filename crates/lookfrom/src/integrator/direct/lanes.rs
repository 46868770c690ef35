//! Steps of Whitted's model for plain hits, eight side by side, from the hit on: direct light and branches. The bits are
//! those of [`super::local_light`] and of Whitted's step.

use lookfrom_bvh::{Hit, OriginPrimitive, Ray};
use lookfrom_simd::{Float, Kernel, Mask, Simd, dispatch, f32x8, f64x8, level, prelude::*};

use super::arriving::{Arriving, Ends};
use super::branches::Branches;
use super::coefficients::{CoefficientColumns, Modes};
use super::plain::PlainHit;
use super::surfaces::Surfaces;
use super::waiting::Waiting;
use crate::core::lanes::{Columns, LANES, by_lane, filled, gather_spectrum, row, store, store_spectrum};
use crate::core::math;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::sample_streams::SampleStreams;
use crate::integrator::{Branch, Path, Probe, SampleStream, Shadow, StepOutput, Term};
use crate::light::Light;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The steps of the paths of a batch that have plain hits: memory that is reused.
#[derive(Default)]
pub(in crate::integrator) struct PlainSteps {
    groups: Vec<Group>,
    /// Number of groups that count.
    group_count: usize,
    lights: Vec<FromLight>,
    /// Number of those that count.
    light_count: usize,
    /// For each path the number of its group times eight and its lane there; [`NOT_PLAIN`] for others.
    places: Vec<u32>,
}

/// The place of a path whose hit is not plain.
const NOT_PLAIN: u32 = u32::MAX;

/// The steps of eight paths.
#[derive(Clone, Copy)]
struct Group {
    /// `k_a I_a` times the throughput.
    ambient: Columns<4>,
    /// The first of the lights that illuminate any of them, and the end.
    lights: [usize; 2],
    branches: Branches,
    materials: [u32; LANES],
    /// Bit i for lane i: whether the ray hit the outside.
    front: u32,
}

/// The light of one source on eight surfaces.
#[derive(Clone, Copy)]
struct FromLight {
    light: u32,
    /// Bit i for lane i: whether it contributes light, unless it is occluded.
    lit: u32,
    /// Whether the way to it crosses the surface.
    crosses: u32,
    contribution: Columns<4>,
    origin: Columns<3>,
    /// To the light, where `t` is `t_max`.
    direction: Columns<3>,
    t_max: f32,
}

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
        (self.group_count, self.light_count) = (0, 0);
        self.places.clear();
        self.places.resize(path_count, NOT_PLAIN);
    }

    /// Computes the steps of plain hits; `modes` by slot. `waiting` is memory.
    #[inline]
    pub(in crate::integrator) fn compute<'a>(
        &mut self,
        world: &'a World,
        stream: &impl Fn(&Path) -> SampleStream,
        (paths, hits): (&'a [Path], &'a [Hit]),
        modes: &[SpectralMode],
        waiting: &mut Waiting<'a>,
    ) {
        // Beside full groups there is one of each kind of shape at most.
        let most_groups = paths.len() / LANES + 2;
        self.groups.reserve(most_groups.saturating_sub(self.groups.len()));
        self.lights.reserve(most_groups.saturating_sub(self.lights.len()));
        for (index, (path, hit)) in paths.iter().zip(hits).enumerate() {
            if let Some(plain) = PlainHit::of(world, index, path, hit) {
                waiting.push(plain, |plain| self.shade(world, stream, plain, modes));
            }
        }
        waiting.flush(|plain| self.shade(world, stream, plain, modes));
    }

    /// Adds the steps of up to eight hits on one kind of shape.
    #[inline(never)]
    fn shade(
        &mut self,
        world: &World,
        stream: &impl Fn(&Path) -> SampleStream,
        plain: &[PlainHit<'_>],
        modes: &[SpectralMode],
    ) {
        let mut memory = None;
        let eight = filled(plain, &mut memory);
        for (lane, plain) in plain.iter().enumerate() {
            self.places[plain.index as usize] = (self.group_count * LANES + lane) as u32;
        }
        dispatch(level(), PlainKernel { world, eight, stream, modes, steps: self });
    }

    /// The step of each path, in their order, if its hit is plain.
    #[inline(always)]
    pub(in crate::integrator) fn of_each(&self) -> impl Iterator<Item = Option<PlainStep<'_>>> {
        self.places.iter().map(|&place| {
            let group = self.groups.get(place as usize / LANES)?;
            let [first, end] = group.lights;
            Some(PlainStep { group, lights: &self.lights[first..end], lane: place as usize % LANES })
        })
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
        output.add(path, Term::Ambient, Spectrum(row(&self.group.ambient, lane)));
        for from in self.lights.iter().filter(|from| from.lit & bit != 0) {
            let direction = row(&from.direction, lane);
            let mut interior = path.interior;
            if from.crosses & bit != 0 {
                let surface = world.surface(&path.ray, hit);
                interior = interior.leaving(&world.materials, &surface, direction.into(), true);
            }
            output.queues.shadows.push(Shadow {
                ray: Ray { t_max: from.t_max, ..Ray::new(row(&from.origin, lane), direction) },
                origin_primitive: OriginPrimitive::of(hit),
                contribution: Spectrum(row(&from.contribution, lane)),
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
        let Group { branches: Branches { mirrored, refracted }, materials, front, .. } = self.group;
        for (branch, rays) in [(Branch::Mirrored, mirrored), (Branch::Refracted, refracted)] {
            if rays.exist & bit != 0 {
                grow(PlainBranch {
                    branch,
                    beta: Spectrum(row(&rays.beta, lane)),
                    ray: Ray::new(row(&rays.origin, lane), row(&rays.direction, lane)),
                    material: materials[lane],
                    front: front & bit != 0,
                });
            }
        }
    }
}

/// The next of the values of a memory that is reused.
#[inline(always)]
fn next<'a, T: Copy>(memory: &'a mut Vec<T>, count: &mut usize, empty: T) -> &'a mut T {
    if *count == memory.len() {
        memory.push(empty);
    }
    *count += 1;
    &mut memory[*count - 1]
}

impl Group {
    const EMPTY: Self = Self {
        ambient: [[0.0; LANES]; 4],
        lights: [0; 2],
        branches: Branches::NONE,
        materials: [0; LANES],
        front: 0,
    };
}

impl FromLight {
    const NONE: Self = Self {
        light: 0,
        lit: 0,
        crosses: 0,
        contribution: [[0.0; LANES]; 4],
        origin: [[0.0; LANES]; 3],
        direction: [[0.0; LANES]; 3],
        t_max: 0.0,
    };
}

struct PlainKernel<'a, F> {
    world: &'a World,
    eight: &'a [PlainHit<'a>; LANES],
    stream: &'a F,
    /// By slot.
    modes: &'a [SpectralMode],
    steps: &'a mut PlainSteps,
}

impl<F: Fn(&Path) -> SampleStream> Kernel for PlainKernel<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, eight, stream, modes, steps } = self;
        let PlainSteps { groups, group_count, lights, light_count, .. } = steps;
        let group = next(groups, group_count, Group::EMPTY);
        let modes = Modes::of(eight, modes);
        let surfaces = Surfaces::of(simd, eight);
        let Surfaces { points, ng, ng_facing, ns_facing, wo, front, .. } = surfaces;
        let coefficients = CoefficientColumns::of(simd, world, eight, &surfaces, &modes);
        let beta = gather_spectrum(simd, &by_lane!(lane => eight[lane].throughput(world, modes.lane(lane))));
        let ambient = beta * coefficients.ambient * modes.constant(simd, world, &world.ambient);
        group.ambient = store_spectrum(ambient);
        group.materials = by_lane!(lane => eight[lane].material);
        group.front = front.to_bitmask() as u32;
        group.branches.set(simd, &coefficients, &surfaces, beta);
        let CoefficientColumns { diffuse, specular, shininess, .. } = coefficients;
        let has_highlights = !specular.is_black().all();
        let zero = f32x8::splat(simd, 0.0);

        group.lights = [*light_count; 2];
        for (index, source) in world.lights.iter().enumerate() {
            let streams = || {
                let streams = by_lane!(lane => stream(eight[lane].path));
                SampleStreams::new(simd, &by_lane!(lane => &streams[lane]))
            };
            let Some(Arriving { wi, li, exists, target }) =
                Arriving::from(simd, (source, index as u32), world, streams, points.position, &modes)
            else {
                continue;
            };
            let n_dot_l = ns_facing.dot(wi);
            let mut lit =
                exists & ng_facing.dot(wi).gt(zero) & !(n_dot_l.lt(zero) | Float::eq(n_dot_l, zero));
            if !lit.any() {
                continue;
            }
            let mut reflected = diffuse * n_dot_l;
            if has_highlights {
                let (half, has_half) = (wo + wi).try_normalize();
                let cos = f32x8::select(has_half, Float::max(ns_facing.dot(half), zero), zero);
                reflected += specular * math::power(cos, shininess);
            }
            let contribution = beta * reflected * li;
            lit &= !contribution.is_black();
            let wide = wi.widen();
            let origin = points.leave(ng, wi);
            let (direction, t_max) = match target {
                Ends::Nowhere => (wi, f32::INFINITY),
                Ends::Points(position) => (Vector::narrow(position - origin.widen()), 1.0),
                Ends::Surfaces(points, normal) => (points.just_before(normal, wi, origin), 1.0),
            };
            let is_outside = ng.dot(wide).gt(f64x8::splat(simd, 0.0));
            let from = next(lights, light_count, FromLight::NONE);
            from.light = index as u32;
            from.lit = lit.to_bitmask() as u32;
            from.crosses = (is_outside.to_bitmask() ^ front.to_bitmask()) as u32;
            from.contribution = store_spectrum(contribution);
            from.origin = store(origin);
            from.direction = store(direction);
            from.t_max = t_max;
            group.lights[1] = *light_count;
        }
    }
}
