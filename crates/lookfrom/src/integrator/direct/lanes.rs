//! Steps of Whitted's model for eight plain hits side by side, from the hit on: direct light and branches. The bits are
//! those of [`super::local_light`] and of Whitted's step.

use lookfrom_bvh::{Hit, OriginPrimitive, Ray};
use lookfrom_simd::{Float, Kernel, Mask, Simd, dispatch, f32x8, f64x8, level, prelude::*};

use super::arriving::{Arriving, Ends};
use super::branches::Branches;
use super::plain::PlainHit;
use super::surfaces::Surfaces;
use crate::core::lanes::{LANES, by_lane, gather_spectrum, scatter, scatter_f64, scatter_spectrum};
use crate::core::math;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::{Branch, Path, Probe, SampleStream, Shadow, StepOutput, Term};
use crate::light::Light;
use crate::shading::material::Coefficients;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The steps of eight paths, of which only those with plain hits count: memory that is reused.
#[derive(Default)]
pub(in crate::integrator) struct PlainSteps {
    /// Bit i for lane i: whether its hit is plain.
    plain: u32,
    /// `k_a I_a` times the throughput.
    ambient: [Spectrum; LANES],
    /// For each light that illuminates any of them.
    lights: Vec<FromLight>,
    branches: Option<Branches>,
    materials: [u32; LANES],
    /// Whether the ray hit the outside.
    front: u32,
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

/// The light of one source on eight surfaces.
struct FromLight {
    light: u32,
    /// Bit i for lane i: whether it contributes light, unless it is occluded.
    lit: u32,
    /// Whether the way to it crosses the surface.
    crosses: u32,
    contribution: [Spectrum; LANES],
    origin: [[f32; 3]; LANES],
    /// To the light, where `t` is `t_max`.
    direction: [[f32; 3]; LANES],
    t_max: f32,
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

    /// Computes the steps of up to eight paths; `modes` by slot.
    #[inline]
    pub(in crate::integrator) fn compute(
        &mut self,
        world: &World,
        stream: &impl Fn(&Path) -> SampleStream,
        paths: &[Path],
        hits: &[Hit],
        modes: &[SpectralMode],
    ) {
        self.plain = 0;
        self.lights.clear();
        let mut found = [None; LANES];
        for (lane, (path, hit)) in paths.iter().zip(hits).enumerate() {
            found[lane] = PlainHit::of(world, path, hit, &modes[path.slot as usize]);
            self.plain |= u32::from(found[lane].is_some()) << lane;
        }
        let Some(any) = found.iter().flatten().next() else { return };
        // Other lanes repeat one that is plain.
        let eight = by_lane!(lane => found[lane].unwrap_or(*any));
        let streams = by_lane!(lane => stream(eight[lane].path));
        PlainKernel { world, eight: &eight, streams: &streams, modes, steps: self }.run_at_level();
    }

    /// Adds the light of a lane to the sample of its path; false if its hit is not plain.
    #[inline]
    pub(in crate::integrator) fn add_light<P: Probe>(
        &self,
        world: &World,
        lane: usize,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) -> bool {
        let bit = 1 << lane;
        if self.plain & bit == 0 {
            return false;
        }
        output.add(path, Term::Ambient, self.ambient[lane]);
        for from in self.lights.iter().filter(|from| from.lit & bit != 0) {
            let mut interior = path.interior;
            if from.crosses & bit != 0 {
                let surface = world.surface(&path.ray, hit);
                interior = interior.leaving(&world.materials, &surface, from.direction[lane].into(), true);
            }
            output.queues.shadows.push(Shadow {
                ray: Ray { t_max: from.t_max, ..Ray::new(from.origin[lane], from.direction[lane]) },
                origin_primitive: OriginPrimitive::of(hit),
                contribution: from.contribution[lane],
                slot: path.slot,
                address: path.address,
                term: Term::Light(from.light),
                interior,
                last_scattering: Shadow::NO_SCATTERING,
            });
        }
        true
    }

    /// The paths that may go on from a lane with a plain hit: first the reflected one.
    #[inline]
    pub(in crate::integrator) fn branches(&self, lane: usize) -> impl Iterator<Item = PlainBranch> {
        let kinds = self.branches.iter().flat_map(|branches| {
            [(Branch::Mirrored, &branches.mirrored), (Branch::Refracted, &branches.refracted)]
        });
        kinds.filter(move |(_, rays)| rays.exist & 1 << lane != 0).map(move |(branch, rays)| PlainBranch {
            branch,
            beta: rays.beta[lane],
            ray: Ray::new(rays.origin[lane], rays.direction[lane]),
            material: self.materials[lane],
            front: self.front & 1 << lane != 0,
        })
    }
}

struct PlainKernel<'a> {
    world: &'a World,
    eight: &'a [PlainHit<'a>; LANES],
    streams: &'a [SampleStream; LANES],
    /// By slot.
    modes: &'a [SpectralMode],
    steps: &'a mut PlainSteps,
}

impl PlainKernel<'_> {
    #[inline(never)]
    fn run_at_level(self) {
        dispatch(level(), self);
    }
}

impl Kernel for PlainKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, eight, streams, modes, steps } = self;
        let modes = by_lane!(lane => &modes[eight[lane].path.slot as usize]);
        let surfaces = Surfaces::of(simd, eight);
        let Surfaces { points, ng, ng_facing, ns_facing, wo, front } = surfaces;
        steps.materials = by_lane!(lane => eight[lane].material);
        steps.front = front.to_bitmask() as u32;
        let (positions, normals) = (scatter_f64(points.position), scatter(Vector::<f32x8<S>>::narrow(ng)));
        // Groups of one material whose coefficients are the same everywhere are common.
        let is_even = matches!(modes[0], SpectralMode::Rgb) && PlainHit::are_even(world, eight);
        let coefficients = match is_even {
            true => [eight[0].coefficients(world, positions[0], normals[0], modes[0]); LANES],
            false => {
                by_lane!(lane => eight[lane].coefficients(world, positions[lane], normals[lane], modes[lane]))
            }
        };
        steps.ambient = by_lane!(lane =>
            eight[lane].beta * coefficients[lane].ambient * world.ambient(modes[lane]));
        let beta = gather_spectrum(simd, &by_lane!(lane => eight[lane].beta));
        steps.branches = Branches::of(simd, &coefficients, &surfaces, beta);
        let (diffuse, specular) = match is_even {
            true => {
                let Coefficients { diffuse, specular, .. } = coefficients[0];
                (splat_spectrum(simd, diffuse), splat_spectrum(simd, specular))
            }
            false => (
                gather_spectrum(simd, &by_lane!(lane => coefficients[lane].diffuse)),
                gather_spectrum(simd, &by_lane!(lane => coefficients[lane].specular)),
            ),
        };
        let has_highlights = !specular.is_black().all();
        let shininess = f32x8::load_array(simd, by_lane!(lane => coefficients[lane].shininess));
        let zero = f32x8::splat(simd, 0.0);

        for (index, source) in world.lights.iter().enumerate() {
            let Some(Arriving { wi, li, exists, target }) =
                Arriving::from(simd, (source, index as u32), world, streams, points.position, &modes)
            else {
                continue;
            };
            let n_dot_l = ns_facing.dot(wi);
            let mut lit =
                exists & ng_facing.dot(wi).gt(zero) & !(n_dot_l.lt(zero) | Float::eq(n_dot_l, zero));
            let (half, has_half) = (wo + wi).try_normalize();
            let cos = f32x8::select(has_half, Float::max(ns_facing.dot(half), zero), zero);
            if !lit.any() {
                continue;
            }
            let mut reflected = diffuse * n_dot_l;
            if has_highlights {
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
            steps.lights.push(FromLight {
                light: index as u32,
                lit: lit.to_bitmask() as u32,
                crosses: (is_outside.to_bitmask() ^ front.to_bitmask()) as u32,
                contribution: scatter_spectrum(contribution),
                origin: scatter(origin),
                direction: scatter(direction),
                t_max,
            });
        }
    }
}

/// The same spectrum in each lane.
#[inline(always)]
fn splat_spectrum<S: Simd>(simd: S, Spectrum([a, b, c, d]): Spectrum) -> Spectrum<f32x8<S>> {
    Spectrum([f32x8::splat(simd, a), f32x8::splat(simd, b), f32x8::splat(simd, c), f32x8::splat(simd, d)])
}
