//! The kernel of Whitted's model for plain hits, eight side by side, from the hit on: direct light and branches. The bits are
//! those of [`super::local_light`] and of Whitted's step.

use lookfrom_simd::{Float, Kernel, Mask, Real, Simd, f32x8, prelude::*};

use super::arriving::{Arriving, Ends};
use super::coefficients::{CoefficientColumns, Modes};
use super::groups::Groups;
use super::plain::PlainHits;
use super::surfaces::{SurfacePoints, Surfaces};
use crate::core::lanes::{LANES, by_lane, gather_spectrum, scatter_rays, scatter_spectrum};
use crate::core::math;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::sample_streams::SampleStreams;
use crate::integrator::{BatchStreams, FirstSurfaceColumns, Path, SpectralModes};
use crate::shading::material::albedo_of_coefficients;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Eight paths with plain hits on one kind of shape.
pub(super) struct Eight<'a> {
    pub(super) paths: [&'a Path; LANES],
    pub(super) plain: PlainHits<'a>,
    /// Indices into the world's materials.
    pub(super) materials: [u32; LANES],
}

impl Eight<'_> {
    /// The throughput of a path, attenuated by the medium on the way.
    #[inline(always)]
    fn throughput(&self, world: &World, lane: usize, mode: &SpectralMode) -> Spectrum {
        let path = self.paths[lane];
        match path.interior.is_empty() {
            true => path.beta,
            false => {
                let length = path.length_to(self.plain.hits[lane]);
                path.beta * world.transmittance(path.interior, length, mode)
            }
        }
    }
}

/// Computes the next group.
pub(super) struct PlainKernel<'a> {
    pub(super) world: &'a World,
    pub(super) eight: &'a Eight<'a>,
    pub(super) streams: &'a BatchStreams<'a>,
    /// By slot.
    pub(super) modes: &'a SpectralModes,
    pub(super) groups: &'a mut Groups,
    /// Receives the surfaces for AOVs, with the albedo of Whitted's coefficients.
    pub(super) first: Option<&'a mut FirstSurfaceColumns>,
}

impl Kernel for PlainKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, eight, streams, modes, groups, first } = self;
        let (group, mut lights) = groups.next();
        let modes = Modes::of(eight, modes);
        // Of spheres they are costly.
        let wants_uvs = first.is_some() || !eight.plain.are_on_spheres;
        let at = SurfacePoints::of(simd, world, &eight.plain, wants_uvs);
        let surfaces = Surfaces::at(simd, &at);
        let Surfaces { points, ns_facing, wo, front, .. } = surfaces;
        let exits = surfaces.exits();
        let coefficients = CoefficientColumns::of(simd, world, eight, &surfaces, &modes);
        if let Some(first) = first {
            at.leave(first);
            let CoefficientColumns { diffuse, mirror, transmission, .. } = coefficients;
            let [r, g, b] = albedo_of_coefficients([diffuse, mirror, transmission]);
            first.albedo = [r.into(), g.into(), b.into()];
        }
        let beta = gather_spectrum(simd, &by_lane!(lane => eight.throughput(world, lane, modes.lane(lane))));
        let ambient = beta * coefficients.ambient * modes.constant(simd, world, &world.ambient);
        group.ambient = scatter_spectrum(ambient);
        group.materials = eight.materials;
        group.front = front.to_bitmask() as u32;
        group.branches.set(simd, &coefficients, &surfaces, beta);
        let CoefficientColumns { diffuse, specular, shininess, .. } = coefficients;
        let has_highlights = !specular.is_black().all();
        let zero = f32x8::splat(simd, 0.0);

        group.lights = [lights.count(); 2];
        for (index, source) in world.lights.iter().enumerate() {
            let streams = || {
                let alone = by_lane!(lane => streams.of(eight.paths[lane]));
                SampleStreams::new(simd, &by_lane!(lane => &alone[lane]))
            };
            let Some(Arriving { wi, li, exists, target }) =
                Arriving::from(simd, (source, index as u32), world, streams, points.position, &modes)
            else {
                continue;
            };
            let n_dot_l = ns_facing.dot(wi);
            // Light from behind the surface does not reach its front, whatever the interpolated normal says.
            let crosses = surfaces.is_outside(wi) ^ front;
            let mut lit =
                exists & !zero.narrow_mask(crosses) & !(n_dot_l.lt(zero) | Float::eq(n_dot_l, zero));
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
            let origin = exits.toward(wi);
            let (direction, t_max) = match target {
                Ends::Nowhere => (wi, f32::INFINITY),
                Ends::Points(position) => (Vector::narrow(position - origin.widen()), 1.0),
                Ends::Surfaces(points, normal) => (points.just_before(normal, wi, origin), 1.0),
            };
            let from = lights.add();
            from.light = index as u32;
            from.lit = lit.to_bitmask() as u32;
            from.crosses = crosses.to_bitmask() as u32;
            from.contribution = scatter_spectrum(contribution);
            from.rays = scatter_rays(simd, origin, direction, t_max);
            group.lights[1] = lights.count();
        }
    }
}
