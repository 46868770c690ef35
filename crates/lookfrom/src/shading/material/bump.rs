//! Bump and normal maps: the shading frame.
//!
//! Materials of pbrt's scenes take the perturbed normal as it is, those of Mitsuba's one that is [guarded](Guard). Others take
//! one that is [`valid`](Bending::valid), so that reflected directions leave the surface: the surface neither turns black where a reflection would point inside, as at
//! the silhouettes of coarse meshes with smooth normals, nor is lit through itself.
//!
//! Blinn 1978 (bumps).

mod guard;
mod heights;

use glam::Vec3;
use lookfrom_scene::material::BumpGuard;
use lookfrom_scene::texture::{TexelFilter, Wrap};
use lookfrom_simd::{Float, Mask, Real};

pub(crate) use guard::Guard;
pub(crate) use heights::{Neighbours, displaced_normal};

use super::{BumpMapping, Frame, NormalTexture};
use crate::core::vector::Vector;
use crate::core::warp;
use crate::shading::footprint::PixelFootprint;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::{self, TexturePoint, Textures};

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

/// The limit of the normals that a map bends.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum NormalLimit {
    /// The side of the geometric normal, as in pbrt-v4.
    #[default]
    Outward,
    /// The same, where normals may be [turned](Bending::limited), with a [guard](Guard), as in Mitsuba.
    Guarded(BumpGuard),
    /// [Valid](Bending::valid) normals.
    Valid,
}

impl NormalLimit {
    /// Whether it is [`Self::Valid`].
    #[inline]
    pub(crate) fn keeps_valid(self) -> bool {
        matches!(self, Self::Valid)
    }

    /// Whether normals are [turned](Bending::limited).
    #[inline]
    pub(crate) fn turns(self) -> bool {
        matches!(self, Self::Guarded(BumpGuard { turns: true, .. }))
    }
}

/// The shading frame at a surface: its first axis along ∂p/∂u.
pub(super) fn frame(
    (bump_mapping, limit): (&BumpMapping, NormalLimit),
    relief: Relief<'_>,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Frame {
    let bending = Bending::from(surface);
    let bent = match bump_mapping {
        BumpMapping::Bump(heights) => heights::displaced((heights, limit), relief, surface, at),
        map => LocalNormal::at(map, relief.textures, at)
            .map_or(bending.ns, |local| bending.mapped(local.n.into(), local.follows_dpdv)),
    };
    let n = bending.limited(bent, limit.keeps_valid(), limit.turns());
    around(n.into(), surface.dpdu)
}

/// The normal of a normal map along the tangents and the shading normal of a surface; not of unit length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalNormal {
    pub(crate) n: [f32; 3],
    /// Whether the second tangent is on the side of ∂p/∂v; else the tangents and the normal are right-handed.
    pub(crate) follows_dpdv: bool,
}

impl LocalNormal {
    /// At a point, of bump mapping that is a normal map.
    pub(super) fn at(bump_mapping: &BumpMapping, textures: &Textures, at: &TexturePoint) -> Option<Self> {
        match bump_mapping {
            BumpMapping::NormalMap(image) => {
                let st = [at.uv.x, 1.0 - at.uv.y];
                let texel =
                    texture::look_up(textures.image(*image), st, [Wrap::Repeat; 2], TexelFilter::Bilinear);
                let n = Vec3::from_array(texel.map(|c| 2.0 * c - 1.0)).normalize_or(Vec3::Z);
                Some(Self { n: n.into(), follows_dpdv: false })
            }
            BumpMapping::NormalTexture(map) => Some(Self::of_texture(map, textures, at)),
            BumpMapping::Bump(_) | BumpMapping::None => None,
        }
    }

    fn of_texture(map: &NormalTexture, textures: &Textures, at: &TexturePoint) -> Self {
        let [x, y, z] = textures.rgb(&map.texture, at).map(|c| 2.0 * c - 1.0);
        Self { n: [map.scale * x, map.scale * y, z], follows_dpdv: true }
    }
}

/// The directions of u and v at a surface, perpendicular to its shading normal and to each other, of
/// unit length.
pub(super) fn tangents(surface: &ShadingGeometry) -> [Vec3; 2] {
    Bending::from(surface).tangents(true).map(Vec3::from)
}

/// The normal of a normal map, of unit length.
pub(super) fn mapped(
    map: &NormalTexture,
    textures: &Textures,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Vec3 {
    let local = LocalNormal::of_texture(map, textures, at);
    Bending::from(surface).mapped(local.n.into(), local.follows_dpdv).into()
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
    fn tangents(&self, follows_dpdv: R::Mask) -> [Vector<R>; 2] {
        let (s, t) = frame_about(self.ns, self.dpdu);
        [s, t.negate_where(follows_dpdv & t.dot(self.dpdv).lt(self.facing.like(0.0)))]
    }

    /// The normal of a normal map, of unit length, by its [`LocalNormal`].
    #[inline(always)]
    pub(crate) fn mapped(&self, local: Vector<R>, follows_dpdv: R::Mask) -> Vector<R> {
        let [s, t] = self.tangents(follows_dpdv);
        normalized_or(s * local.x + t * local.y + self.ns * local.z, self.ns)
    }

    /// The normal `n`, by its [`NormalLimit`]: [valid](Self::valid), or on the side of the geometric normal, and, where it `turns` and is
    /// seen from another side than the normal without the map, turned by half a turn about that (Schüßler et al. 2017).
    #[inline(always)]
    pub(crate) fn limited(&self, n: Vector<R>, is_valid: R::Mask, turns: R::Mask) -> Vector<R> {
        if is_valid.all() {
            return self.valid(n);
        }
        let zero = self.facing.like(0.0);
        let outward = n.negate_where((n.dot(self.ng_facing) * self.facing).lt(zero));
        let is_beside = (self.wo.dot(self.ns) * self.wo.dot(outward)).gt(zero);
        let turned = self.ns * (outward.dot(self.ns) * 2.0) - outward;
        let limited = Vector::select(turns & !is_beside, turned, outward);
        match (!is_valid).all() {
            true => limited,
            false => Vector::select(is_valid, self.valid(n), limited),
        }
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
