//! The step of Whitted's model at any width, from the surfaces on: ambient light, the light of every source, and the branches
//! of the tree.

use lookfrom_simd::{Float, Kernel, Mask, Real, Simd};

use super::Whitted;
use super::arriving::{Arriving, Destination, Targets};
use super::coefficients::Modes;
use super::groups::{BranchRays, Groups};
use super::plain::PlainHits;
use super::surfaces::Surfaces;
use super::told::Told;
use crate::aov::FirstSurfaceColumns;
use crate::core::lanes::width::{One, Width};
use crate::core::lanes::{LANES, by_lane, gather_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::sample_streams::SampleStreams;
use crate::integrator::{BatchStreams, Path, SampleStream, SpectralModes};
use crate::light::Light;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::{Coefficients, albedo_of_coefficients};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Results of a step that are wanted beside the light.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// The tree of rays, if one grows.
    pub(super) tree: Option<&'a Whitted>,
    /// Whether layers of light-path expressions need the shares of diffuse reflection.
    pub(super) shares: bool,
    /// Whether a probe listens.
    pub(super) is_watched: bool,
}

/// Surfaces that paths have met.
pub(super) struct Step<'a, W: Width> {
    width: W,
    world: &'a World,
    surfaces: &'a Surfaces<W::Real>,
    coefficients: &'a Coefficients<W::Real>,
    paths: [&'a Path; LANES],
    /// Path throughputs, after absorption on the way.
    beta: Spectrum<W::Real>,
    /// Indices into the world's materials.
    materials: [u32; LANES],
    wanted: Wanted<'a>,
}

impl<W: Width> Step<'_, W> {
    /// Computes the next group. `arriving` is the light of a source.
    #[inline(always)]
    fn shade(
        &self,
        i_a: Spectrum<W::Real>,
        mut arriving: impl FnMut(&Destination<'_, W::Real>, &Light, u32) -> Option<Arriving<W::Real>>,
        groups: &mut Groups,
    ) {
        let Self { width, world, surfaces, coefficients, paths, beta, materials, wanted } = *self;
        let mut told = wanted.is_watched.then(|| Told::new(width, coefficients));
        let (group, mut lights) = groups.next();
        group.ambient = width.spectra(beta * coefficients.ambient * i_a);
        (group.materials, group.front) = (materials, width.bits(surfaces.front));

        // Add the light of each source.
        group.lights = [lights.count(); 2];
        let zero = width.splat(0.0);
        let exits = surfaces.exits();
        let at = Destination { world, points: surfaces.points.position, n: surfaces.ns_facing };
        let is_lit = coefficients.is_lit();
        for (index, source) in (0..).zip(&world.lights).filter(|_| is_lit.any()) {
            let Some(light) = arriving(&at, source, index) else {
                if let Some(told) = &mut told {
                    told.add_light(width, (&paths, is_lit), index, None, [Spectrum::splat(zero); 2]);
                }
                continue;
            };
            let wi = light.wi;
            let n_dot_l = surfaces.ns_facing.dot(wi);
            // Light from behind the surface does not reach its front, whatever the interpolated normal says.
            let exists = light.exists & !surfaces.cross(wi);
            let mut lit = exists & !(n_dot_l.lt(zero) | Float::eq(n_dot_l, zero));
            if !lit.any() && told.is_none() {
                continue;
            }
            let (diffuse, specular) = coefficients.lit(surfaces.ns_facing, surfaces.wo, wi);
            if let Some(told) = &mut told {
                let reflected =
                    [diffuse, specular].map(|part| Spectrum::select(lit, part, Spectrum::splat(zero)));
                told.add_light(width, (&paths, is_lit), index, Some((&light, width.bits(exists))), reflected);
            }
            let contribution = beta * (diffuse + specular) * light.intensity();
            lit = lit & !contribution.is_black();
            let origin = exits.toward(wi);
            let (direction, t_max) = match light.target {
                Targets::Infinity => (wi, f32::INFINITY),
                Targets::Points(position) => (Vector::narrow(position - origin.widen()), 1.0),
                Targets::Surfaces(points, normal) => (points.just_before(normal, wi, origin), 1.0),
            };
            let from = lights.add();
            from.light = index;
            from.lit = width.bits(lit);
            from.contribution = width.spectra(contribution);
            if wanted.shares {
                from.diffuse = width.spectra(diffuse.share_of(diffuse + specular));
            }
            from.rays = width.rays(origin, direction, t_max);
            group.lights[1] = lights.count();
        }

        // Grow the tree: k_r S and k_t T.
        for branch in &mut group.branches {
            branch.exist = 0;
        }
        let Surfaces { ns_facing, wo, front, .. } = *surfaces;
        let exist = coefficients.has_branches();
        if let Some(tree) = wanted.tree
            && exist.any()
        {
            let branches = coefficients.branches(ns_facing, wo, front);
            let is_refracted = exist & branches.is_refracted;
            if let Some(told) = &mut told {
                told.add_branches(width, (&paths, tree), beta, &branches, [exist, is_refracted]);
            }
            let [mirrored, refracted] = &mut group.branches;
            self.set_rays(mirrored, exist, branches.mirrored, 1.0);
            if is_refracted.any() {
                self.set_rays(refracted, is_refracted, branches.refracted, -1.0);
            }
        }
        if let Some(told) = told {
            groups.tell(told);
        }
    }

    /// Sets the rays of a branch, which leave to the side of `wo` (1) or to the other (−1).
    #[inline(always)]
    fn set_rays(
        &self,
        rays: &mut BranchRays,
        exist: <W::Real as Float>::Mask,
        (direction, weight): (Vector<W::Real>, Spectrum<W::Real>),
        side: f32,
    ) {
        let direction = same_side(direction, self.surfaces.ng_facing, self.width.splat(side));
        rays.exist = self.width.bits(exist);
        rays.beta = self.width.spectra(self.beta * weight);
        rays.rays = self.width.rays(self.surfaces.exits().toward(direction), direction, f32::INFINITY);
    }
}

/// The direction, reflected at the tangent plane if it points to the wrong side of it: an interpolated normal can send
/// a reflected ray into the surface or a refracted one out of it. `side` is 1 for the side of `ng`, −1 for the other.
#[inline(always)]
fn same_side<R: Real>(direction: Vector<R>, ng: Vector<R>, side: R) -> Vector<R> {
    let cos = direction.dot(ng);
    let (on_side, zero) = (cos * side, side.like(0.0));
    Vector::select(on_side.gt(zero) | Float::eq(on_side, zero), direction, direction - ng * (cos * 2.0))
}

/// Computes the next group, of one path.
pub(super) fn shade_one(
    world: &World,
    (path, stream, mode): (&Path, &SampleStream, &SpectralMode),
    surface: &SurfaceInteraction,
    coefficients: &Coefficients,
    wanted: Wanted<'_>,
    groups: &mut Groups,
) {
    let surfaces = &Surfaces::of_one(surface);
    let materials = [surface.material; LANES];
    let (paths, beta) = ([path; LANES], path.beta);
    let step = Step { width: One, world, surfaces, coefficients, paths, beta, materials, wanted };
    let arriving = |at: &Destination<'_, f32>, source: &Light, index| {
        let u = if super::arriving::is_random(source) { stream.two_with_pixel(index) } else { [0.0; 2] };
        Arriving::at_one(at, source, u, mode)
    };
    step.shade(world.ambient(mode), arriving, groups);
}

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
        self.paths[lane].absorbed(world, self.plain.hits[lane], mode).beta
    }
}

/// Computes the next group, of eight paths.
pub(super) struct PlainKernel<'a> {
    pub(super) world: &'a World,
    pub(super) eight: &'a Eight<'a>,
    pub(super) streams: &'a BatchStreams<'a>,
    /// By slot.
    pub(super) modes: &'a SpectralModes,
    pub(super) wanted: Wanted<'a>,
    pub(super) groups: &'a mut Groups,
    /// Receives the surfaces for AOVs, with the albedo of Whitted's coefficients.
    pub(super) first: Option<&'a mut FirstSurfaceColumns>,
}

impl Kernel for PlainKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, eight, streams, modes, wanted, groups, first } = self;
        let modes = Modes::of(eight, modes);
        // Of spheres they are costly.
        let wants_uvs = first.is_some() || !eight.plain.are_on_spheres;
        let surfaces = &Surfaces::of_eight(simd, world, &eight.plain, wants_uvs);
        let coefficients = &Coefficients::at_eight(simd, world, eight, surfaces, &modes);
        if let Some(first) = first {
            surfaces.leave(first);
            let Coefficients { diffuse, mirror, transmission, .. } = *coefficients;
            let [r, g, b] = albedo_of_coefficients([diffuse, mirror, transmission]);
            first.albedo = [r.into(), g.into(), b.into()];
        }
        let beta = gather_spectrum(simd, &by_lane!(lane => eight.throughput(world, lane, modes.lane(lane))));
        let (paths, materials) = (eight.paths, eight.materials);
        let step = Step { width: simd, world, surfaces, coefficients, paths, beta, materials, wanted };
        let i_a = modes.constant(simd, world, &world.ambient);
        step.shade(
            i_a,
            #[inline(always)]
            |at, source, index| {
                Arriving::at_eight(
                    simd,
                    at,
                    source,
                    #[inline(always)]
                    || {
                        let alone = by_lane!(lane => streams.of(eight.paths[lane]));
                        SampleStreams::new(simd, &by_lane!(lane => &alone[lane])).two_with_pixel(index)
                    },
                    &modes,
                )
            },
            groups,
        );
    }
}
