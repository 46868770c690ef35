//! Shadow rays continued through bare surfaces ([`World::bare_surface`](crate::world::World::bare_surface)) of materials that transmit the same
//! everywhere, eight at a time. The bits are those of `passing`.

use lookfrom_bvh::{Hit, Ray};
use lookfrom_simd::{Kernel, Simd, prelude::*};

use super::ShadowLight;
use crate::core::lanes::{LANES, are_shaded_together, by_lane, filled, gather_rays, scatter, shade_together};
use crate::core::spectrum::Spectrum;
use crate::integrator::SpectralModes;
use crate::integrator::wavefront::{BareHits, Surfaces};
use crate::shading::material::MaterialKind;
use crate::shading::texture::{SpectralMode, TexturePoint};
use crate::world::{ShapeClass, World};

/// The rays of a round that pass such surfaces, by their places in it.
#[derive(Default)]
pub(super) struct Crossings {
    /// By kind of shape.
    on_shapes: [Vec<u32>; ShapeClass::ALL.len()],
    /// The light that passed, as a factor, by places: for a probe.
    pub(super) passed: Option<Vec<Spectrum>>,
}

impl Crossings {
    /// None yet; for a probe or not.
    pub(super) fn new(is_watched: bool) -> Self {
        Self { passed: is_watched.then(Vec::new), ..Self::default() }
    }

    /// Takes a ray that a surface lets pass, with its hit, unless that is of another kind.
    #[inline(always)]
    pub(super) fn take(&mut self, world: &World, place: u32, hit: &Hit) -> bool {
        let Some(bare) = world.bare_surface(hit).filter(|_| are_shaded_together()) else { return false };
        let material = &world.materials[bare.material as usize];
        if material.whitted.transmission.varies() || matches!(material.kind, MaterialKind::Interface) {
            return false;
        }
        self.on_shapes[bare.shape as usize].push(place);
        true
    }

    /// Continues the rays behind their surfaces, and removes them. `modes` are by slot; `chosen` are the lights of the
    /// round's rays. Returns whether light is left of all rays.
    #[inline]
    pub(super) fn go_on(
        &mut self,
        world: &World,
        modes: &SpectralModes,
        (rays, hits): (&mut [Ray], &[Hit]),
        lights: &mut [ShadowLight],
        chosen: &[u32],
    ) -> bool {
        let mut are_all_lit = true;
        if let Some(passed) = &mut self.passed {
            passed.resize(rays.len(), Spectrum::BLACK);
        }
        for (places, shape) in self.on_shapes.iter_mut().zip(ShapeClass::ALL) {
            if !places.is_empty() {
                let passed = self.passed.as_deref_mut();
                let kernel = GoOn { world, places, shape, rays, hits, modes, lights, chosen, passed };
                are_all_lit &= shade_together(kernel);
                places.clear();
            }
        }
        are_all_lit
    }
}

struct GoOn<'a> {
    world: &'a World,
    places: &'a [u32],
    shape: ShapeClass,
    rays: &'a mut [Ray],
    hits: &'a [Hit],
    modes: &'a SpectralModes,
    lights: &'a mut [ShadowLight],
    chosen: &'a [u32],
    passed: Option<&'a mut [Spectrum]>,
}

impl Kernel for GoOn<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { world, places, shape, rays, hits, modes, lights, chosen, mut passed } = self;
        let mut are_all_lit = true;
        for places in places.chunks(LANES) {
            let mut memory = None;
            let eight = filled(places, &mut memory);
            let hits = by_lane!(lane => &hits[eight[lane] as usize]);
            let bare = BareHits { rays: by_lane!(lane => &rays[eight[lane] as usize]), hits, shape };
            let surfaces = Surfaces::of_eight(simd, world, &bare, false);
            let [_, directions] = gather_rays(simd, &bare.rays);
            let origins = scatter(surfaces.exits().toward(directions));
            let front = surfaces.front.to_bitmask();
            for (lane, &place) in places.iter().enumerate() {
                let (ray, hit) = (&mut rays[place as usize], hits[lane]);
                let light = &mut lights[chosen[place as usize] as usize];
                let factor =
                    light.cross(world, ray, hit, front & 1 << lane != 0, &modes[light.slot as usize]);
                if let Some(passed) = &mut passed {
                    passed[place as usize] = factor;
                }
                ray.origin = origins[lane];
                ray.t_max -= hit.t;
                are_all_lit &= !light.contribution.is_black();
            }
        }
        are_all_lit
    }
}

impl ShadowLight {
    /// Attenuates the light by a bare surface and by the medium up to it, of which the ray met the outside or the inside,
    /// and continues in what is behind. Returns the factor.
    #[inline(always)]
    fn cross(
        &mut self,
        world: &World,
        ray: &Ray,
        hit: &Hit,
        is_outside: bool,
        mode: &SpectralMode,
    ) -> Spectrum {
        let Some(bare) = world.bare_surface(hit) else { return Spectrum::BLACK };
        let material = &world.materials[bare.material as usize];
        let transmission = &material.whitted.transmission;
        let transmission = world.textures.spectrum(transmission, &TexturePoint::NOWHERE, mode);
        let passed = transmission * self.transmittance(world, ray, hit.t, mode);
        self.contribution *= passed;
        if material.is_body() {
            self.interior = match is_outside {
                true => self.interior.entered(bare.material),
                false => self.interior.left(bare.material),
            };
        }
        passed
    }
}
