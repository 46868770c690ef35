//! Bump and normal maps: the shading frame.
//!
//! Materials of pbrt's scenes take the perturbed normal as it is, those of Mitsuba's one that is [guarded](Guard). Others take
//! one that is [`valid`](Bending::valid), so that reflected directions leave the surface: the surface neither turns black where a reflection would point inside, as at
//! the silhouettes of coarse meshes with smooth normals, nor is lit through itself.
//!
//! Blinn 1978 (bumps).

mod guard;

use glam::{Vec2, Vec3};
use lookfrom_scene::material::BumpGuard;
use lookfrom_scene::texture::{TexelFilter, Wrap};
use lookfrom_simd::{Float, Mask, Real};

pub(crate) use guard::Guard;

use super::{BumpMapping, Frame, NormalTexture};
use crate::core::vector::Vector;
use crate::core::warp;
use crate::shading::footprint::PixelFootprint;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::{self, FloatTexture, TexturePoint, Textures};

/// An offset in u and v that is much smaller than texels.
const FINE_STEP: f32 = 0.000_02;
/// The smallest offset, in parts of u and v: differences of numbers of single precision need one.
const LEAST_STEP: f32 = 4e-6;

/// Data that shading frames are bent by.
#[derive(Clone, Copy, Debug)]
pub struct Relief<'a> {
    /// Pictures and formulas of heights and normals.
    pub textures: &'a Textures,
    /// The pixels of the camera: heights are compared at half their footprint, so that a bump map is as rough as it is where
    /// it can be seen, as in pbrt-v4.
    pub footprint: Option<&'a PixelFootprint>,
    /// Offset in u and v for the finite differences of heights where there is no footprint.
    pub step: f32,
}

impl Relief<'_> {
    /// The usual step, as in pbrt-v4.
    pub const STEP: f32 = 0.0005;
}

/// The frame of the shading normal without bump mapping.
pub(super) fn plain(surface: &ShadingGeometry) -> Frame {
    around(surface.ns, surface.dpdu)
}

/// The shading frame at a surface as in pbrt-v4, where the smoothed ∂p/∂v of meshes is as long as ∂p/∂u: its normal on the side of
/// the geometric one, its first axis along ∂p/∂u.
pub(super) fn frame(
    bump_mapping: &BumpMapping,
    relief: Relief<'_>,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Frame {
    let bent = bent(bump_mapping, relief, surface, [surface.dpdu, surface.dpdv], at);
    around(outward(bent, surface), surface.dpdu)
}

/// The shading frame with a normal that is [`valid`](Bending::valid).
pub(super) fn valid_frame(
    bump_mapping: &BumpMapping,
    relief: Relief<'_>,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Frame {
    let bent = bent(bump_mapping, relief, surface, surface.derivatives, at);
    around(valid(bent, surface), surface.dpdu)
}

/// The shading frame with a normal that is guarded as Mitsuba's.
pub(super) fn guarded_frame(
    guard: BumpGuard,
    bump_mapping: &BumpMapping,
    relief: Relief<'_>,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Frame {
    // Mitsuba differentiates pictures between their texels, whatever is seen of them.
    let fine = Relief { step: FINE_STEP, footprint: None, ..relief };
    let n = outward(bent(bump_mapping, fine, surface, surface.derivatives, at), surface);
    around(if guard.turns { guard::turned(n, surface.ns, surface.wo) } else { n }, surface.dpdu)
}

/// A normal on the side of the geometric one.
fn outward(n: Vec3, surface: &ShadingGeometry) -> Vec3 {
    if n.dot(surface.ng) < 0.0 { -n } else { n }
}

/// The perturbed normal, of unit length, by the derivatives that heights have their slopes along.
fn bent(
    bump_mapping: &BumpMapping,
    relief: Relief<'_>,
    surface: &ShadingGeometry,
    derivatives: [Vec3; 2],
    at: &TexturePoint,
) -> Vec3 {
    let plain = || plain(surface);
    let bent = match bump_mapping {
        BumpMapping::None => return surface.ns,
        BumpMapping::NormalMap(image) => {
            let st = [at.uv.x, 1.0 - at.uv.y];
            let texel =
                texture::look_up(relief.textures.image(*image), st, [Wrap::Repeat; 2], TexelFilter::Bilinear);
            let local = Vec3::from_array(texel.map(|c| 2.0 * c - 1.0)).normalize_or(Vec3::Z);
            plain().render(local)
        }
        BumpMapping::NormalTexture(map) => return mapped(map, relief.textures, surface, at),
        BumpMapping::Bump(height) => bumped(*height, relief, surface, derivatives, at),
    };
    bent.normalize_or(surface.ns)
}

/// The directions of u and v at a surface, perpendicular to its shading normal and to each other, of
/// unit length.
pub(super) fn tangents(surface: &ShadingGeometry) -> [Vec3; 2] {
    Bending::from(surface).tangents().map(Vec3::from)
}

/// The normal of a normal map, of unit length.
pub(super) fn mapped(
    map: &NormalTexture,
    textures: &Textures,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Vec3 {
    Bending::from(surface).mapped(local_normal(map, textures, at).into()).into()
}

/// The normal of a normal map along the tangents and the shading normal; not of unit length.
pub(super) fn local_normal(map: &NormalTexture, textures: &Textures, at: &TexturePoint) -> [f32; 3] {
    let [x, y, z] = textures.rgb(&map.texture, at).map(|c| 2.0 * c - 1.0);
    [map.scale * x, map.scale * y, z]
}

/// [`Bending::valid`].
pub(super) fn valid(n: Vec3, surface: &ShadingGeometry) -> Vec3 {
    Bending::from(surface).valid(n.into()).into()
}

/// The directions at a surface by which a normal map bends its shading frame, at any width. Of unit length but for the
/// derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bending<R> {
    /// The geometric normal on the side of `wo`.
    pub(crate) ng_facing: Vector<R>,
    /// 1 where that is the outside, −1 elsewhere.
    pub(crate) facing: R,
    /// The shading normal of the surface without the map, to the outside.
    pub(crate) ns: Vector<R>,
    pub(crate) dpdu: Vector<R>,
    pub(crate) dpdv: Vector<R>,
    pub(crate) wo: Vector<R>,
}

impl From<&ShadingGeometry> for Bending<f32> {
    fn from(surface: &ShadingGeometry) -> Self {
        Self {
            ng_facing: surface.ng_facing().into(),
            facing: if surface.front { 1.0 } else { -1.0 },
            ns: surface.ns.into(),
            dpdu: surface.dpdu.into(),
            dpdv: surface.dpdv.into(),
            wo: surface.wo.into(),
        }
    }
}

impl<R: Real> Bending<R> {
    /// The directions of u and v, perpendicular to the shading normal and to each other, of unit length.
    #[inline(always)]
    fn tangents(&self) -> [Vector<R>; 2] {
        let (s, t) = frame_about(self.ns, self.dpdu);
        [s, t.negate_where(t.dot(self.dpdv).lt(self.facing.like(0.0)))]
    }

    /// The normal of a normal map, of unit length, by its [`local_normal`].
    #[inline(always)]
    pub(crate) fn mapped(&self, local: Vector<R>) -> Vector<R> {
        let [s, t] = self.tangents();
        normalized_or(s * local.x + t * local.y + self.ns * local.z, self.ns)
    }

    /// The nearest normal to `n`, turned toward the geometric one, that reflects `wo` to the outside of the surface.
    ///
    /// Let the geometric normal on the side of `wo` be g, and t the direction perpendicular to it toward which `n`
    /// leans by an angle θ. The reflected direction then has the height `x sin 2θ + z cos 2θ` over the surface, where
    /// `wo` has x along t and z along g: a sinusoid in 2θ of amplitude `A = √(x² + z²)`, which begins at z and falls to
    /// a height h at `2θ = atan2(x, z) + acos(h / A)`. This is the largest lean allowed.
    #[inline(always)]
    pub(crate) fn valid(&self, n: Vector<R>) -> Vector<R> {
        let (n, g, wo) = (n * self.facing, self.ng_facing, self.wo);
        let (zero, one) = (self.facing.like(0.0), self.facing.like(1.0));
        let z = wo.dot(g);
        // For a grazing `wo` the reflected direction stays nearly grazing.
        let least = Float::min(z * 0.9, zero.like(0.01));
        let leans = n.dot(g);
        let height = n.dot(wo) * 2.0 * leans - z;
        let is_valid = leans.gt(zero) & (height.gt(least) | Float::eq(height, least));
        if is_valid.all() {
            return n * self.facing;
        }
        let (t, has_lean) = (n - g * leans).try_normalize();
        let x = wo.dot(t);
        let amplitude = Float::sqrt(x * x + z * z);
        let leans = has_lean & amplitude.gt(zero);
        let (height, wave) = (least / amplitude, [x / amplitude, z / amplitude]);
        let rest = Float::sqrt(Float::max(one - height * height, zero));
        let cos_twice = height * wave[1] - rest * wave[0];
        let sin_twice = height * wave[0] + rest * wave[1];
        // The half angle, by the root that does not cancel.
        let greater = Float::sqrt((one + Float::abs(cos_twice)) * 0.5);
        let smaller = sin_twice * 0.5 / greater;
        let is_acute = cos_twice.gt(zero);
        let (cos, sin) = (R::select(is_acute, greater, smaller), R::select(is_acute, smaller, greater));
        let turned = Vector::select(leans, normalized_or(g * cos + t * sin, g), g);
        Vector::select(is_valid, n, turned) * self.facing
    }
}

/// A vector of unit length, or another where there is none.
#[inline(always)]
fn normalized_or<R: Real>(v: Vector<R>, other: Vector<R>) -> Vector<R> {
    let (unit, exists) = v.try_normalize();
    Vector::select(exists, unit, other)
}

/// The normal of the surface displaced along its shading normal; not of unit length.
fn bumped(
    height: FloatTexture,
    relief: Relief<'_>,
    surface: &ShadingGeometry,
    derivatives: [Vec3; 2],
    at: &TexturePoint,
) -> Vec3 {
    let Relief { textures, footprint, step: usual } = relief;
    let n = surface.ns;
    let here = textures.float(height, at);
    let half = footprint.and_then(|pixels| pixels.half(at.world, surface.ng, derivatives));
    let half = half.unwrap_or_default();
    let [along_u, along_v] = derivatives;
    let [dpdu, dpdv] = [(along_u, Vec2::X, half.x), (along_v, Vec2::Y, half.y)].map(|(along, axis, half)| {
        let step = if half > 0.0 { half } else { usual };
        let step = step.max(LEAST_STEP * at.uv.abs().dot(axis));
        let uv = at.uv + step * axis;
        // As far as u or v moves in single precision.
        let step = (uv - at.uv).dot(axis);
        let world = at.world + (step * along).as_dvec3();
        let moved = TexturePoint { uv, world, looked_up: None, values: None, ..*at };
        // In the tangent plane of the shading normal.
        let tangent = along - n * n.dot(along);
        tangent + n * ((textures.float(height, &moved) - here) / step)
    });
    let across = dpdu.cross(dpdv);
    if along_u.cross(along_v).dot(n) < 0.0 { -across } else { across }
}

/// The frame about a normal with the first axis along ∂p/∂u.
pub(super) fn around(n: Vec3, dpdu: Vec3) -> Frame {
    let (s, t) = frame_about(n.into(), dpdu.into());
    Frame { s: s.into(), t: t.into(), n }
}

/// The other axes of the frame about a unit normal: the first along a direction, or any where that has no part
/// perpendicular to the normal.
#[inline(always)]
pub(crate) fn frame_about<R: Real>(n: Vector<R>, direction: Vector<R>) -> (Vector<R>, Vector<R>) {
    let (along, has_length) = (direction - n * n.dot(direction)).try_normalize();
    let across = n.cross(along);
    if has_length.all() {
        return (along, across);
    }
    let (s, t) = warp::basis_about(n);
    (Vector::select(has_length, along, s), Vector::select(has_length, across, t))
}

#[cfg(test)]
mod tests;
