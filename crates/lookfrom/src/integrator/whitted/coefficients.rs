//! Whitted's coefficients at eight plain hits side by side. The bits are those of [`Coefficients::at`].

use glam::{DVec3, Vec2};
use lookfrom_bvh::Hit;
use lookfrom_simd::{Float, Simd, f32x8, f64x8, mask32x8, prelude::*};

use super::plain;
use super::step::Eight;
use super::surfaces::Surfaces;
use crate::core::lanes::{LANES, by_lane, gather_spectrum, scatter, scatter_f64, splat_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::SpectralModes;
use crate::light::EmissionSpectrum;
use crate::shading::material::{Coefficients, Whitted};
use crate::shading::texture::lanes::TexturePoints;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint};
use crate::world::World;

/// The spectral modes of eight paths.
pub(super) struct Modes<'a> {
    by_lane: [&'a SpectralMode; LANES],
    /// Whether all are RGB: the modes of a picture are of one kind.
    are_rgb: bool,
}

impl<'a> Modes<'a> {
    #[inline(always)]
    pub(super) fn of(eight: &Eight<'_>, modes: &'a SpectralModes) -> Self {
        let first = &modes[eight.paths[0].slot as usize];
        if matches!(first, SpectralMode::Rgb) {
            return Self { by_lane: [first; LANES], are_rgb: true };
        }
        let by_lane = by_lane!(lane => &modes[eight.paths[lane].slot as usize]);
        Self { by_lane, are_rgb: false }
    }

    /// The mode of a lane.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> &'a SpectralMode {
        self.by_lane[lane]
    }

    /// The spectra of a colour that does not vary.
    #[inline(always)]
    pub(super) fn constant<S: Simd>(
        &self,
        simd: S,
        world: &World,
        color: &SpectrumTexture,
    ) -> Spectrum<f32x8<S>> {
        let textures = &world.textures;
        match self.are_rgb {
            true => splat_spectrum(simd, textures.spectrum(color, &TexturePoint::NOWHERE, self.by_lane[0])),
            false => textures.constants(simd, &[color; LANES], &self.by_lane),
        }
    }

    /// The emission of a light whose colour does not vary.
    #[inline(always)]
    pub(super) fn emission<S: Simd>(
        &self,
        simd: S,
        world: &World,
        light: &EmissionSpectrum,
    ) -> Spectrum<f32x8<S>> {
        self.constant(simd, world, &light.color) * f32x8::splat(simd, light.scale)
    }

    /// The spectra of a texture that is evaluated side by side.
    #[inline(always)]
    fn spectra<S: Simd>(
        &self,
        simd: S,
        world: &World,
        texture: &SpectrumTexture,
        surfaces: &Surfaces<f32x8<S>>,
    ) -> Option<Spectrum<f32x8<S>>> {
        if !self.are_rgb {
            return None;
        }
        let position = surfaces.points.position;
        let origin = Vector::splat(f64x8::splat(simd, 0.0), world.origin.to_array());
        let at = TexturePoints { uv: surfaces.uv, world: origin + position };
        world.textures.spectra(simd, texture, &at)
    }
}

impl<S: Simd> Coefficients<f32x8<S>> {
    /// The coefficients at eight surfaces.
    #[inline(always)]
    pub(super) fn at_eight(
        simd: S,
        world: &World,
        eight: &Eight<'_>,
        surfaces: &Surfaces<f32x8<S>>,
        modes: &Modes<'_>,
    ) -> Self {
        let (mut is_one, mut lane) = (true, 0);
        while lane < LANES {
            is_one &= eight.materials[lane] == eight.materials[0];
            lane += 1;
        }
        match is_one {
            true => Self::of_one(simd, world, eight, surfaces, modes),
            false => Self::of_each(simd, world, eight, surfaces, modes),
        }
    }

    /// The coefficients of one material.
    #[inline(always)]
    fn of_one(
        simd: S,
        world: &World,
        eight: &Eight<'_>,
        surfaces: &Surfaces<f32x8<S>>,
        modes: &Modes<'_>,
    ) -> Self {
        let material = &world.materials[eight.materials[0] as usize].whitted;
        let mut points = None;
        macro_rules! spectra {
            ($texture:expr) => {{
                let texture: &SpectrumTexture = $texture;
                if !texture.varies() {
                    modes.constant(simd, world, texture)
                } else if let Some(spectra) = modes.spectra(simd, world, texture, surfaces) {
                    spectra
                } else {
                    let points = points.get_or_insert_with(|| texture_points(world, eight, surfaces));
                    gather_spectrum(simd, &by_lane!(lane =>
                        world.textures.spectrum(texture, &points[lane], modes.by_lane[lane])))
                }
            }};
        }
        let diffuse = spectra!(&material.diffuse);
        Self {
            ambient: match &material.ambient {
                Some(ambient) => spectra!(ambient),
                None => diffuse,
            },
            diffuse,
            specular: spectra!(&material.specular),
            shininess: f32x8::splat(simd, material.shininess),
            mirror: spectra!(&material.mirror),
            transmission: spectra!(&material.transmission),
            ior: f32x8::splat(simd, material.ior),
            fresnel: mask32x8::splat(simd, material.fresnel),
        }
    }

    /// The coefficients of several materials, one by one.
    #[inline(always)]
    fn of_each(
        simd: S,
        world: &World,
        eight: &Eight<'_>,
        surfaces: &Surfaces<f32x8<S>>,
        modes: &Modes<'_>,
    ) -> Self {
        let points = texture_points(world, eight, surfaces);
        let rows = by_lane!(lane => {
            let material = &world.materials[eight.materials[lane] as usize].whitted;
            Coefficients::at(material, &world.textures, &points[lane], modes.by_lane[lane])
        });
        let is_fresnel = by_lane!(lane => if rows[lane].fresnel { 1.0 } else { 0.0 });
        Self {
            ambient: gather_spectrum(simd, &by_lane!(lane => rows[lane].ambient)),
            diffuse: gather_spectrum(simd, &by_lane!(lane => rows[lane].diffuse)),
            specular: gather_spectrum(simd, &by_lane!(lane => rows[lane].specular)),
            shininess: f32x8::load_array(simd, by_lane!(lane => rows[lane].shininess)),
            mirror: gather_spectrum(simd, &by_lane!(lane => rows[lane].mirror)),
            transmission: gather_spectrum(simd, &by_lane!(lane => rows[lane].transmission)),
            ior: f32x8::load_array(simd, by_lane!(lane => rows[lane].ior)),
            fresnel: f32x8::load_array(simd, is_fresnel).gt(f32x8::splat(simd, 0.0)),
        }
    }
}

/// The texture points of eight surfaces.
#[inline(always)]
fn texture_points<'a, S: Simd>(
    world: &World,
    eight: &Eight<'_>,
    surfaces: &Surfaces<f32x8<S>>,
) -> [TexturePoint<'a>; LANES] {
    let positions = scatter_f64(surfaces.points.position);
    let normals = scatter(Vector::<f32x8<S>>::narrow(surfaces.ng));
    let mut points = [TexturePoint::NOWHERE; LANES];
    for (lane, point) in points.iter_mut().enumerate() {
        if varies(&world.materials[eight.materials[lane] as usize].whitted) {
            *point = texture_point(world, eight.plain.hits[lane], positions[lane], normals[lane]);
        }
    }
    points
}

/// Whether any of the coefficients varies over a surface.
#[inline]
fn varies(material: &Whitted) -> bool {
    let Whitted { ambient, diffuse, specular, mirror, transmission, .. } = material;
    [diffuse, specular, mirror, transmission].into_iter().chain(ambient).any(SpectrumTexture::varies)
}

#[inline(never)]
pub(super) fn texture_point<'a>(
    world: &World,
    hit: &Hit,
    position: [f64; 3],
    ng: [f32; 3],
) -> TexturePoint<'a> {
    let (mut uv, mut color) = (Vec2::ZERO, [1.0; 3]);
    if let Some(mesh) = plain::mesh(world, hit) {
        let Hit { u, v, primitive, .. } = *hit;
        let [uv0, uv1, uv2] = mesh.corner_uvs(primitive as usize);
        uv = (1.0 - u - v) * uv0 + u * uv1 + v * uv2;
        color = mesh.color(primitive as usize, u, v);
    } else if let Some((_, binding)) = plain::sphere(world, hit) {
        uv = binding.uv(ng.into());
    }
    let world = world.origin + DVec3::from_array(position);
    TexturePoint { uv, world, color, n: ng.into(), ..TexturePoint::NOWHERE }
}
