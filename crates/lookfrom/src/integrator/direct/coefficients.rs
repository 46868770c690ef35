//! Whitted's coefficients at eight plain hits side by side. The bits are those of [`Coefficients`].
//!
//! [`Coefficients`]: crate::shading::material::Coefficients

use glam::{DVec3, Vec3};
use lookfrom_bvh::Hit;
use lookfrom_simd::{Float, Simd, f32x8, f64x8, mask32x8, prelude::*};

use super::plain::{PlainHit, PlainShape};
use crate::core::lanes::{LANES, by_lane, gather_spectrum, scatter, scatter_f64};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::material::Whitted;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint, sphere_uv};
use crate::world::World;

/// The spectral modes of eight paths.
pub(super) struct Modes<'a> {
    by_lane: [&'a SpectralMode; LANES],
    /// Whether all are RGB: the modes of a picture are of one kind.
    are_rgb: bool,
}

/// Whitted's coefficients.
pub(super) struct CoefficientColumns<S: Simd> {
    pub(super) ambient: Spectrum<f32x8<S>>,
    pub(super) diffuse: Spectrum<f32x8<S>>,
    pub(super) specular: Spectrum<f32x8<S>>,
    pub(super) shininess: f32x8<S>,
    pub(super) mirror: Spectrum<f32x8<S>>,
    pub(super) transmission: Spectrum<f32x8<S>>,
    pub(super) ior: f32x8<S>,
    pub(super) is_fresnel: mask32x8<S>,
}

impl<'a> Modes<'a> {
    #[inline(always)]
    pub(super) fn of(eight: &[PlainHit<'_>; LANES], modes: &'a [SpectralMode]) -> Self {
        let first = &modes[eight[0].path.slot as usize];
        if matches!(first, SpectralMode::Rgb) {
            return Self { by_lane: [first; LANES], are_rgb: true };
        }
        let by_lane = by_lane!(lane => &modes[eight[lane].path.slot as usize]);
        Self { by_lane, are_rgb: false }
    }

    /// The mode of a lane.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> &'a SpectralMode {
        self.by_lane[lane]
    }

    /// Spectra that depend on nothing but the mode.
    #[inline(always)]
    pub(super) fn even<S: Simd>(
        &self,
        simd: S,
        at: impl Fn(&SpectralMode) -> Spectrum,
    ) -> Spectrum<f32x8<S>> {
        match self.are_rgb {
            true => splat_spectrum(simd, at(self.by_lane[0])),
            false => gather_spectrum(simd, &by_lane!(lane => at(self.by_lane[lane]))),
        }
    }

    /// The spectra of a texture that does not vary.
    #[inline(always)]
    fn of_constant<S: Simd>(&self, simd: S, world: &World, texture: &SpectrumTexture) -> Spectrum<f32x8<S>> {
        self.even(simd, |mode| world.textures.spectrum(texture, &TexturePoint::NOWHERE, mode))
    }
}

/// The same spectrum in each lane.
#[inline(always)]
fn splat_spectrum<S: Simd>(simd: S, Spectrum([a, b, c, d]): Spectrum) -> Spectrum<f32x8<S>> {
    Spectrum([f32x8::splat(simd, a), f32x8::splat(simd, b), f32x8::splat(simd, c), f32x8::splat(simd, d)])
}

impl<S: Simd> CoefficientColumns<S> {
    /// The coefficients at positions in render space, with their geometric normals.
    #[inline(always)]
    pub(super) fn of(
        simd: S,
        world: &World,
        eight: &[PlainHit<'_>; LANES],
        points: (Vector<f64x8<S>>, Vector<f64x8<S>>),
        modes: &Modes<'_>,
    ) -> Self {
        let (mut is_one, mut lane) = (true, 0);
        while lane < LANES {
            is_one &= eight[lane].material == eight[0].material;
            lane += 1;
        }
        let first = &world.materials[eight[0].material as usize].whitted;
        match is_one && !varies(first) {
            true => Self::of_one(simd, world, first, modes),
            false => Self::of_each(simd, world, (eight, is_one), points, modes),
        }
    }

    /// The coefficients of a material that has the same everywhere.
    #[inline(always)]
    fn of_one(simd: S, world: &World, material: &Whitted, modes: &Modes<'_>) -> Self {
        let spectrum = |texture: &SpectrumTexture| modes.of_constant(simd, world, texture);
        let diffuse = spectrum(&material.diffuse);
        Self {
            ambient: material.ambient.as_ref().map_or(diffuse, spectrum),
            diffuse,
            specular: spectrum(&material.specular),
            shininess: f32x8::splat(simd, material.shininess),
            mirror: spectrum(&material.mirror),
            transmission: spectrum(&material.transmission),
            ior: f32x8::splat(simd, material.ior),
            is_fresnel: mask32x8::splat(simd, material.fresnel),
        }
    }

    /// The coefficients of materials, which may be one, point by point where they vary.
    #[inline(always)]
    fn of_each(
        simd: S,
        world: &World,
        (eight, is_one): (&[PlainHit<'_>; LANES], bool),
        (position, ng): (Vector<f64x8<S>>, Vector<f64x8<S>>),
        modes: &Modes<'_>,
    ) -> Self {
        let materials = by_lane!(lane => &world.materials[eight[lane].material as usize].whitted);
        let positions = scatter_f64(position);
        let normals = scatter(Vector::<f32x8<S>>::narrow(ng));
        let points = by_lane!(lane => match varies(materials[lane]) {
            true => texture_point(world, &eight[lane], positions[lane], normals[lane]),
            false => TexturePoint::NOWHERE,
        });
        macro_rules! spectra {
            ($material:ident => $texture:expr) => {{
                let $material = materials[0];
                match is_one && !$texture.varies() {
                    true => modes.of_constant(simd, world, $texture),
                    false => gather_spectrum(simd, &by_lane!(lane => {
                        let $material = materials[lane];
                        world.textures.spectrum($texture, &points[lane], modes.by_lane[lane])
                    })),
                }
            }};
        }
        let diffuse = spectra!(material => &material.diffuse);
        let ambient = match materials.iter().all(|material| material.ambient.is_none()) {
            true => diffuse,
            false => spectra!(material => material.ambient.as_ref().unwrap_or(&material.diffuse)),
        };
        let is_fresnel = by_lane!(lane => if materials[lane].fresnel { 1.0 } else { 0.0 });
        Self {
            ambient,
            diffuse,
            specular: spectra!(material => &material.specular),
            shininess: f32x8::load_array(simd, by_lane!(lane => materials[lane].shininess)),
            mirror: spectra!(material => &material.mirror),
            transmission: spectra!(material => &material.transmission),
            ior: f32x8::load_array(simd, by_lane!(lane => materials[lane].ior)),
            is_fresnel: f32x8::load_array(simd, is_fresnel).gt(f32x8::splat(simd, 0.0)),
        }
    }
}

/// Whether any of the coefficients varies over a surface.
#[inline]
fn varies(material: &Whitted) -> bool {
    let Whitted { ambient, diffuse, specular, mirror, transmission, .. } = material;
    [diffuse, specular, mirror, transmission].into_iter().chain(ambient).any(SpectrumTexture::varies)
}

#[inline(never)]
fn texture_point<'a>(
    world: &World,
    plain: &PlainHit<'_>,
    position: [f64; 3],
    ng: [f32; 3],
) -> TexturePoint<'a> {
    let (uv, color) = match plain.shape {
        PlainShape::Triangle(mesh) => {
            let Hit { u, v, primitive, .. } = *plain.hit;
            let [uv0, uv1, uv2] = mesh.corner_uvs(primitive as usize);
            ((1.0 - u - v) * uv0 + u * uv1 + v * uv2, mesh.color(primitive as usize, u, v))
        }
        PlainShape::Sphere(_, binding) => {
            let outward = if binding.flip { ng.map(|x| -x) } else { ng };
            (sphere_uv(binding.object_from_sphere * Vec3::from(outward)), [1.0; 3])
        }
    };
    let world = world.origin + DVec3::from_array(position);
    TexturePoint { uv, world, color, n: ng.into(), ..TexturePoint::NOWHERE }
}
