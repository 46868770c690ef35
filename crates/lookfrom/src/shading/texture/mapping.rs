//! Texture mappings.

use std::f32::consts::PI;
use std::f64::consts::PI as PI_F64;

use glam::{DMat4, DVec2, DVec3, Vec2};
use lookfrom_scene::texture::Mapping;
use lookfrom_simd::{Float, Real};

use super::TexturePoint;
use crate::core::vector::Vector;

/// Coordinates are clamped to this; single-precision numbers of this size have long lost their fraction.
const FARTHEST: f32 = 1_073_741_824.0;

/// The shift of patterns in space, along each axis.
pub(super) const OFF_BORDER: f64 = 1.0 / 8192.0;

/// The coordinates in the pattern: (s, t, 0), or x, y and z for [`Mapping::World`]. Always finite.
pub(super) fn coordinates(mapping: &Mapping, at: &TexturePoint) -> DVec3 {
    let p = match mapping {
        Mapping::Uv { scale, offset } => {
            (at.uv * Vec2::from_array(*scale) + Vec2::from_array(*offset)).as_dvec2().extend(0.0)
        }
        Mapping::Affine { set, matrix } => {
            let uv = match *set {
                0 => at.uv,
                set => at.more_uvs.get(set as usize - 1).copied().unwrap_or_default(),
            };
            let [s, t] = matrix.map(|[of_u, of_v, offset]| of_u * uv.x + of_v * uv.y + offset);
            DVec3::new(s.into(), t.into(), 0.0)
        }
        Mapping::Spherical { texture_from_world } => {
            spherical(texture_from_world.transform_point3(at.world)).as_dvec2().extend(0.0)
        }
        Mapping::Cylindrical { texture_from_world } => {
            let p = texture_from_world.transform_point3(at.world);
            let around = libm::atan2f(p.y as f32, p.x as f32);
            DVec3::new(f64::from((PI + around) / (2.0 * PI)), p.z, 0.0)
        }
        Mapping::Planar { texture_from_world, axes, offset } => {
            let p = texture_from_world.transform_point3(at.world);
            let along = DVec2::from_array(axes.map(|axis| p.dot(axis.as_dvec3())));
            (along + Vec2::from_array(*offset).as_dvec2()).extend(0.0)
        }
        Mapping::World { texture_from_world } => texture_from_world.transform_point3(at.world),
    };
    p.to_array().map(bounded).into()
}

/// Change of [`coordinates`] from one pixel to the next, in x and in y: always finite. `None` without a footprint, and of
/// further sets of texture coordinates.
pub(super) fn changes(mapping: &Mapping, at: &TexturePoint) -> Option<[DVec3; 2]> {
    let footprint = at.footprint?;
    // By the position in texture space, and its changes.
    let by_position = |matrix: &DMat4, change: &dyn Fn(DVec3, DVec3) -> DVec3| {
        let p = matrix.transform_point3(at.world);
        footprint.p.map(|step| change(p, matrix.transform_vector3(step.as_dvec3())))
    };
    // Of the azimuth, in turns.
    let around = |p: DVec3, d: DVec3| (p.x * d.y - p.y * d.x) / (p.x * p.x + p.y * p.y) / (2.0 * PI_F64);
    let changes = match mapping {
        Mapping::Uv { scale, .. } => {
            footprint.uv.map(|step| (step * Vec2::from_array(*scale)).as_dvec2().extend(0.0))
        }
        Mapping::Affine { set: 0, matrix } => footprint.uv.map(|step| {
            let [s, t] = matrix.map(|[of_u, of_v, _]| of_u * step.x + of_v * step.y);
            DVec3::new(s.into(), t.into(), 0.0)
        }),
        Mapping::Affine { .. } => return None,
        Mapping::Spherical { texture_from_world } => by_position(texture_from_world, &|p, d| {
            let squared = p.x * p.x + p.y * p.y;
            let down = p.z * (p.x * d.x + p.y * d.y) - squared * d.z;
            DVec3::new(down / ((squared + p.z * p.z) * squared.sqrt()) / PI_F64, around(p, d), 0.0)
        }),
        Mapping::Cylindrical { texture_from_world } => {
            by_position(texture_from_world, &|p, d| DVec3::new(around(p, d), d.z, 0.0))
        }
        Mapping::Planar { texture_from_world, axes, .. } => by_position(texture_from_world, &|_, d| {
            DVec2::from_array(axes.map(|axis| d.dot(axis.as_dvec3()))).extend(0.0)
        }),
        Mapping::World { texture_from_world } => by_position(texture_from_world, &|_, d| d),
    };
    Some(changes.map(|change| change.to_array().map(bounded).into()))
}

/// A coordinate within the bounds of [`coordinates`]; 0 for NaN.
#[inline(always)]
pub(super) fn bounded<F: Float<Scalar: From<f32>>>(x: F) -> F {
    let number = F::select(Float::eq(x, x), x, x.like(0.0.into()));
    Float::clamp(number, (-FARTHEST).into(), FARTHEST.into())
}

/// [`coordinates`], with patterns in space shifted by a small irregular offset, so that surfaces exactly on the
/// border of two cells (a floor at y = 0) do not flicker between them.
pub(super) fn off_border(mapping: &Mapping, at: &TexturePoint) -> DVec3 {
    let p = coordinates(mapping, at);
    if matches!(mapping, Mapping::World { .. }) { p + DVec3::splat(OFF_BORDER) } else { p }
}

/// (θ/π, φ/2π), both 0 to 1.
fn spherical(p: DVec3) -> Vec2 {
    let p = p.normalize_or(DVec3::Z).as_vec3();
    let theta = libm::atan2f((p.x * p.x + p.y * p.y).sqrt(), p.z);
    let phi = libm::atan2f(p.y, p.x);
    Vec2::new(theta / PI, (if phi < 0.0 { phi + 2.0 * PI } else { phi }) / (2.0 * PI))
}

/// The coordinates on a unit sphere whose poles lie on the y axis: u around from +x toward −z by `atan2(−z, x)`, v from the
/// south pole.
#[inline(always)]
pub(crate) fn sphere_uv<R: Real>(n: Vector<R>) -> [R; 2] {
    let u = (-n.z).zip(n.x, libm::atan2f) / (2.0 * PI);
    let v = Float::clamp(-n.y, -1.0, 1.0).map(libm::acosf) / PI;
    [R::select(u.lt(u.like(0.0)), u + 1.0, u), v]
}
