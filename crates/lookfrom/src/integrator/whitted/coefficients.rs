//! Whitted's coefficients at eight bare surfaces side by side. The bits are those of [`WhittedCoefficients::at`].

use glam::{Vec2, Vec3};
use lookfrom_bvh::Hit;
use lookfrom_simd::{Simd, f32x8, f64x8, mask32x8, prelude::*};

use super::step::BareEight;
use crate::core::lanes::{LANES, by_lane, gather_spectrum, scatter, scatter_f64};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::wavefront::bare_hits::{self, BareHits};
use crate::integrator::wavefront::{Modes, Surfaces};
use crate::shading::bsdf::lanes::RowBsdf;
use crate::shading::bsdf::whitted::WhittedCoefficients;
use crate::shading::material::WhittedMaterial;
use crate::shading::texture::lanes::TexturePoints;
use crate::shading::texture::{SpectrumTexture, TexturePoint};
use crate::world::{ShapeClass, World};

/// The spectra of a texture that is evaluated side by side.
#[inline(always)]
fn side_by_side<S: Simd>(
    simd: S,
    world: &World,
    texture: &SpectrumTexture,
    surfaces: &Surfaces<f32x8<S>>,
    modes: &Modes<'_>,
) -> Option<Spectrum<f32x8<S>>> {
    if !modes.are_rgb() {
        return None;
    }
    let position = surfaces.points.position;
    let origin = Vector::splat(f64x8::splat(simd, 0.0), world.origin.to_array());
    let at = TexturePoints { uv: surfaces.uv, world: origin + position };
    world.textures.spectra(simd, texture, &at)
}

impl<S: Simd> WhittedCoefficients<f32x8<S>> {
    /// The coefficients at eight surfaces.
    #[inline(always)]
    pub(super) fn at_eight(
        simd: S,
        world: &World,
        eight: &BareEight<'_>,
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
        eight: &BareEight<'_>,
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
                } else if let Some(spectra) = side_by_side(simd, world, texture, surfaces, modes) {
                    spectra
                } else {
                    let at = match &mut points {
                        Some(points) => points,
                        none => none.insert(texture_points(world, eight, surfaces)),
                    };
                    gather_spectrum(simd, &by_lane!(lane =>
                        world.textures.spectrum(texture, &at[lane], modes.lane(lane))))
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
        eight: &BareEight<'_>,
        surfaces: &Surfaces<f32x8<S>>,
        modes: &Modes<'_>,
    ) -> Self {
        let points = texture_points(world, eight, surfaces);
        let rows = by_lane!(lane => {
            let material = &world.materials[eight.materials[lane] as usize].whitted;
            WhittedCoefficients::at(material, &world.textures, &points[lane], modes.lane(lane))
        });
        WhittedCoefficients::gather(simd, &by_lane!(lane => &rows[lane]))
    }
}

/// The texture points of eight surfaces.
#[inline(always)]
fn texture_points<'a, S: Simd>(
    world: &'a World,
    eight: &BareEight<'_>,
    surfaces: &Surfaces<f32x8<S>>,
) -> [TexturePoint<'a>; LANES] {
    let positions = scatter_f64(surfaces.points.position);
    let normals = scatter(Vector::<f32x8<S>>::narrow(surfaces.ng));
    let mut points = [TexturePoint::NOWHERE; LANES];
    for (lane, point) in points.iter_mut().enumerate() {
        if varies(&world.materials[eight.materials[lane] as usize].whitted) {
            *point = texture_point(world, &eight.bare, lane, (positions[lane], normals[lane]));
        }
    }
    points
}

/// Whether any of the coefficients varies over a surface.
#[inline]
fn varies(material: &WhittedMaterial) -> bool {
    let WhittedMaterial { ambient, diffuse, specular, mirror, transmission, .. } = material;
    [diffuse, specular, mirror, transmission].into_iter().chain(ambient).any(SpectrumTexture::varies)
}

/// The texture point of one of eight hits, by its position and geometric normal.
#[inline(never)]
pub(super) fn texture_point<'a>(
    world: &'a World,
    bare: &BareHits<'_>,
    lane: usize,
    (position, ng): ([f64; 3], [f32; 3]),
) -> TexturePoint<'a> {
    let (ray, hit) = (bare.rays[lane], bare.hits[lane]);
    let is_inside = Vec3::from(ng).dot(ray.direction.into()) > 0.0;
    let is_filtered = |material: u32| world.materials[material as usize].needs_footprint;
    if bare.shape == ShapeClass::Other
        || world.footprint.is_some() && world.bare_surface(hit).is_some_and(|bare| is_filtered(bare.material))
    {
        return world.shading_point(&world.surface(ray, hit));
    }
    if let Some(mesh) = bare_hits::mesh(world, hit) {
        let Hit { u, v, primitive, .. } = *hit;
        let [uv0, uv1, uv2] = mesh.corner_uvs(primitive as usize);
        let uv = (1.0 - u - v) * uv0 + u * uv1 + v * uv2;
        let on_outside = world.texture_point_on_mesh(mesh, hit, (position, ng.into()), uv.into());
        return TexturePoint { is_inside, ..on_outside };
    }
    let uv = world.sphere(hit).map_or(Vec2::ZERO, |(_, binding)| binding.uv(ng.into()));
    TexturePoint { is_inside, ..world.texture_point_at((position, ng.into()), uv.into()) }
}
