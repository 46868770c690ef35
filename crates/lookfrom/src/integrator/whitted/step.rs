//! The step of Whitted's model at any width, from the surfaces on: ambient light, the light of every source, and the branches
//! of the tree.

use lookfrom_simd::{Float, Kernel, Mask, Real, Simd};

use super::RayTree;
use super::shaded::{BranchRays, FromLight, Shaded};
use super::told::Told;
use crate::aov::FirstSurfaceColumns;
use crate::core::lanes::width::{One, Width};
use crate::core::lanes::{LANES, by_lane, filled, gather_spectrum, load, load_spectrum, shade_together};
use crate::core::math::both;
use crate::core::spectrum::Spectrum;
use crate::core::times::Times;
use crate::core::vector::Vector;
use crate::integrator::sample_streams::SampleStreams;
use crate::integrator::wavefront::{BareHits, Eight, HitBatch, LightSamples, Modes, Receivers, Surfaces};
use crate::integrator::{BatchStreams, Path, SampleStream, SpectralModes};
use crate::light::IncompletePdf;
use crate::shading::bsdf::whitted::WhittedCoefficients;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::albedo_of_coefficients;
use crate::shading::texture::SpectralMode;
use crate::world::{ShapeClass, World};

/// Results of a step that are wanted beside the light.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// The tree of rays, if one grows.
    pub(super) tree: Option<&'a RayTree>,
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
    coefficients: &'a WhittedCoefficients<W::Real>,
    paths: [&'a Path; LANES],
    /// Path throughputs, after absorption on the way.
    beta: Spectrum<W::Real>,
    wanted: Wanted<'a>,
}

impl<W: Width> Step<'_, W> {
    /// Shades them. `numbers` are two random ones for a light, and `sample` samples it.
    #[inline(always)]
    fn shade(
        &self,
        i_a: Spectrum<W::Real>,
        modes: &Modes<'_>,
        numbers: impl Fn(u32) -> [W::Real; 2],
        mut sample: impl FnMut(&mut LightSamples, &Receivers<'_, W::Real>, [W::Real; 2]),
        shaded: &mut Shaded,
    ) {
        let Self { width, world, surfaces, coefficients, paths, beta, wanted } = *self;
        let mut told = wanted.is_watched.then(|| Told::new(width, coefficients));
        shaded.ambient = width.spectra(beta * coefficients.ambient * i_a);
        shaded.front = width.bits(surfaces.front);

        // Add the light of each source: I_j, its radiance over π and over the density of the direction.
        shaded.light_count = 0;
        let zero = width.splat(0.0);
        let exits = surfaces.exits();
        let at = Receivers {
            points: surfaces.points.position,
            n: surfaces.ns_facing,
            modes,
            incomplete_pdf: IncompletePdf::Forbidden,
        };
        let is_lit = coefficients.is_lit();
        let Shaded { samples, lights, light_count, .. } = shaded;
        for (index, light) in (0..).zip(&world.lights).filter(|_| is_lit.any()) {
            if !light.illuminates() && told.is_none() {
                continue;
            }
            let is_random = light.illuminates() && !light.is_delta();
            samples.choose_all(index);
            sample(samples, &at, if is_random { numbers(index) } else { [zero; 2] });
            let li = load_spectrum(width, &samples.li);
            let exists = width.mask(samples.is_valid) & !li.is_black();
            if !exists.any() && told.is_none() {
                continue;
            }
            let wi = load(width, &samples.wi);
            let n_dot_l = surfaces.ns_facing.dot(wi);
            // Light from behind the surface does not reach its front, whatever the interpolated normal says.
            let faces = exists & !surfaces.cross(wi);
            let mut lit = faces & !(n_dot_l.lt(zero) | Float::eq(n_dot_l, zero));
            if !lit.any() && told.is_none() {
                continue;
            }
            let (diffuse, specular) = coefficients.lit(surfaces.ns_facing, surfaces.wo, wi);
            if let Some(told) = &mut told {
                let reflected = both(
                    [diffuse, specular],
                    #[inline(always)]
                    |part| Spectrum::select(lit, part, Spectrum::splat(zero)),
                );
                told.add_light(width, (&paths, is_lit), samples, faces, reflected);
            }
            let intensity = li / (width.load_f32(&samples.pdf) * std::f32::consts::PI);
            let contribution = beta * (diffuse + specular) * intensity;
            lit = lit & !contribution.is_black();
            if !lit.any() {
                continue;
            }
            let origin = exits.toward(wi);
            let (way, t_max) = samples.ways(width, origin);
            if *light_count == lights.len() {
                lights.push(FromLight::NONE);
            }
            let from = &mut lights[*light_count];
            *light_count += 1;
            (from.light, from.lit) = (index, width.bits(lit));
            from.contribution = width.spectra(contribution);
            if wanted.shares {
                from.diffuse = width.spectra(diffuse.share_of(diffuse + specular));
            }
            from.rays = width.rays(origin, way, t_max);
        }

        // Grow the tree: k_r S and k_t T.
        for branch in &mut shaded.branches {
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
            let [mirrored, refracted] = &mut shaded.branches;
            self.set_rays(mirrored, exist, branches.mirrored, 1.0);
            if is_refracted.any() {
                self.set_rays(refracted, is_refracted, branches.refracted, -1.0);
            }
        }
        shaded.told = told;
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
        rays.rays = self.width.rays(
            self.surfaces.exits().toward(direction),
            direction,
            self.width.splat(f32::INFINITY),
        );
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

/// Shades the surface that one path has met.
pub(super) fn shade_one(
    world: &World,
    (path, stream): (&Path, &SampleStream),
    (mode, time): (&SpectralMode, f32),
    surface: &SurfaceInteraction,
    coefficients: &WhittedCoefficients,
    wanted: Wanted<'_>,
    shaded: &mut Shaded,
) {
    let surfaces = &Surfaces::of_one(surface);
    let (paths, beta) = ([path; LANES], path.beta);
    let step = Step { width: One, world, surfaces, coefficients, paths, beta, wanted };
    step.shade(
        world.ambient(mode),
        &Modes::of_one(mode, time),
        |light| stream.two_with_pixel(light),
        |samples, at, u| samples.sample_one(world, at, u),
        shaded,
    );
}

/// Eight paths that met bare surfaces of one kind of shape.
pub(super) struct BareEight<'a> {
    pub(super) paths: [&'a Path; LANES],
    pub(super) bare: BareHits<'a>,
    /// Indices into the world's materials.
    pub(super) materials: [u32; LANES],
}

impl<'a> BareEight<'a> {
    /// Eight paths of a batch, and what they have met. Unused lanes repeat the last.
    #[inline(always)]
    pub(super) fn of(batch: &HitBatch<'a>, eight: &Eight<'_>, shape: ShapeClass) -> Self {
        let &Eight { paths: indices, materials } = eight;
        let mut memory = [None; 2];
        let [first, second] = &mut memory;
        let (indices, materials) = (filled(indices, first), *filled(materials, second));
        let hits = by_lane!(lane => &batch.hits[indices[lane] as usize]);
        let paths = by_lane!(lane => &batch.paths[indices[lane] as usize]);
        let rays = by_lane!(lane => &paths[lane].ray);
        Self { paths, bare: BareHits { rays, hits, shape }, materials }
    }

    /// The throughput of a path, attenuated by the medium on the way.
    #[inline(always)]
    fn throughput(&self, world: &World, lane: usize, mode: &SpectralMode) -> Spectrum {
        self.paths[lane].absorbed(world, self.bare.hits[lane], mode).beta
    }
}

/// Shades the surfaces that eight paths have met.
pub(super) struct BareKernel<'a> {
    pub(super) world: &'a World,
    pub(super) eight: &'a BareEight<'a>,
    pub(super) streams: &'a BatchStreams<'a>,
    /// By slot.
    pub(super) modes: &'a SpectralModes,
    /// By slot.
    pub(super) times: &'a Times,
    pub(super) wanted: Wanted<'a>,
    pub(super) shaded: &'a mut Shaded,
    /// Receives the surfaces for AOVs, with the albedo of Whitted's coefficients.
    pub(super) first: Option<&'a mut FirstSurfaceColumns>,
}

impl BareKernel<'_> {
    /// Apart from what listens, so that it is compiled once.
    #[inline(never)]
    pub(super) fn shade(self) {
        shade_together(self);
    }
}

impl Kernel for BareKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, eight, streams, modes, times, wanted, shaded, first } = self;
        let modes = &Modes::of(&eight.paths, modes, times);
        // Of all but meshes they are costly.
        let wants_uvs = first.is_some() || eight.bare.shape == ShapeClass::Mesh;
        let surfaces = &Surfaces::of_eight(simd, world, &eight.bare, wants_uvs);
        let coefficients = &WhittedCoefficients::at_eight(simd, world, eight, surfaces, modes);
        if let Some(first) = first {
            surfaces.leave(first);
            let WhittedCoefficients { diffuse, mirror, transmission, .. } = *coefficients;
            let [r, g, b] = albedo_of_coefficients([diffuse, mirror, transmission]);
            first.albedo = [r.into(), g.into(), b.into()];
        }
        let beta = gather_spectrum(simd, &by_lane!(lane => eight.throughput(world, lane, modes.lane(lane))));
        let paths = eight.paths;
        let step = Step { width: simd, world, surfaces, coefficients, paths, beta, wanted };
        let i_a = modes.constant(simd, world, &world.ambient);
        step.shade(
            i_a,
            modes,
            #[inline(always)]
            |light| {
                let alone = by_lane!(lane => streams.of(eight.paths[lane]));
                SampleStreams::new(simd, &by_lane!(lane => &alone[lane])).two_with_pixel(light)
            },
            #[inline(always)]
            |samples, at, u| samples.sample(simd, world, at, u, (1 << LANES) - 1),
            shaded,
        );
    }
}
