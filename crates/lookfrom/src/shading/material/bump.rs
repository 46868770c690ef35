//! Bump and normal maps: the shading frame.
//!
//! pbrt's materials take the perturbed normal as it is. glTF's take one that is [`valid`], so that reflected
//! directions leave the surface: the surface neither turns black where a reflection would point inside nor is lit
//! through itself.
//!
//! Blinn 1978 (bumps).

use glam::Vec3;
use lookfrom_scene::texture::{TexelFilter, Wrap};
use lookfrom_simd::{Mask, Real};

use super::{BumpMapping, Frame, NormalTexture};
use crate::core::vector::Vector;
use crate::core::warp;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::{self, FloatTexture, TexturePoint, Textures};

/// Offset in u and v for the finite differences of heights, as in pbrt-v4 without a footprint.
const STEP: f32 = 0.0005;

/// The frame of the shading normal without bump mapping.
pub(super) fn plain(surface: &ShadingGeometry) -> Frame {
    around(surface.ns, surface.dpdu)
}

/// The shading frame at a surface: its normal on the side of the geometric one, its first axis along ∂p/∂u.
pub(super) fn frame(
    bump_mapping: &BumpMapping,
    textures: &Textures,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Frame {
    let bent = bent(bump_mapping, textures, surface, at);
    let side = if bent.dot(surface.ng) < 0.0 { -bent } else { bent };
    around(side, surface.dpdu)
}

/// The same for glTF's material, with a normal that is [`valid`].
pub(super) fn valid_frame(
    bump_mapping: &BumpMapping,
    textures: &Textures,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Frame {
    around(valid(bent(bump_mapping, textures, surface, at), surface), surface.dpdu)
}

/// The perturbed normal, of unit length.
fn bent(
    bump_mapping: &BumpMapping,
    textures: &Textures,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Vec3 {
    let plain = || plain(surface);
    let bent = match bump_mapping {
        BumpMapping::None => return surface.ns,
        BumpMapping::NormalMap(image) => {
            let st = [at.uv.x, 1.0 - at.uv.y];
            let texel =
                texture::look_up(textures.image(*image), st, [Wrap::Repeat; 2], TexelFilter::Bilinear);
            let local = Vec3::from_array(texel.map(|c| 2.0 * c - 1.0)).normalize_or(Vec3::Z);
            plain().render(local)
        }
        BumpMapping::NormalTexture(map) => return mapped(map, textures, surface, at),
        BumpMapping::Bump(height) => bumped(*height, textures, surface, at),
    };
    bent.normalize_or(surface.ns)
}

/// The directions of u and v at a surface, perpendicular to its shading normal and to each other, of
/// unit length.
pub(super) fn tangents(surface: &ShadingGeometry) -> [Vec3; 2] {
    let Frame { s, t, .. } = around(surface.ns, surface.dpdu);
    [s, if t.dot(surface.dpdv) < 0.0 { -t } else { t }]
}

/// The normal of a normal map, of unit length.
pub(super) fn mapped(
    map: &NormalTexture,
    textures: &Textures,
    surface: &ShadingGeometry,
    at: &TexturePoint,
) -> Vec3 {
    let texel = textures.rgb(&map.texture, at);
    let [x, y, z] = texel.map(|c| 2.0 * c - 1.0);
    let [s, t] = tangents(surface);
    (map.scale * x * s + map.scale * y * t + z * surface.ns).normalize_or(surface.ns)
}

/// The nearest normal to `n`, turned toward the geometric one, that reflects `wo` to the outside of the surface.
///
/// Let the geometric normal on the side of `wo` be g, and t the direction perpendicular to it toward which `n`
/// leans by an angle θ. The reflected direction then has the height `x sin 2θ + z cos 2θ` over the surface, where
/// `wo` has x along t and z along g: a sinusoid in 2θ of amplitude `A = √(x² + z²)`, which begins at z and falls to
/// a height h at `2θ = atan2(x, z) + acos(h / A)`. This is the largest lean allowed.
pub(super) fn valid(n: Vec3, surface: &ShadingGeometry) -> Vec3 {
    let facing = if surface.front { 1.0 } else { -1.0 };
    let (n, g, wo) = (facing * n, surface.ng_facing(), surface.wo);
    let z = wo.dot(g);
    // For a grazing `wo` the reflected direction stays nearly grazing.
    let least = (0.9 * z).min(0.01);
    let leans = n.dot(g);
    if leans > 0.0 && 2.0 * n.dot(wo) * leans - z >= least {
        return facing * n;
    }
    let Some(t) = (n - leans * g).try_normalize() else { return facing * g };
    let x = wo.dot(t);
    let amplitude = (x * x + z * z).sqrt();
    if !(amplitude > 0.0) {
        return facing * g;
    }
    let (height, wave) = (least / amplitude, [x / amplitude, z / amplitude]);
    let rest = (1.0 - height * height).max(0.0).sqrt();
    let cos_twice = height * wave[1] - rest * wave[0];
    let sin_twice = height * wave[0] + rest * wave[1];
    // The half angle, by the root that does not cancel.
    let greater = (0.5 * (1.0 + cos_twice.abs())).sqrt();
    let smaller = 0.5 * sin_twice / greater;
    let (cos, sin) = if cos_twice > 0.0 { (greater, smaller) } else { (smaller, greater) };
    facing * (cos * g + sin * t).normalize_or(g)
}

/// The normal of the surface displaced along its shading normal; not of unit length.
fn bumped(height: FloatTexture, textures: &Textures, surface: &ShadingGeometry, at: &TexturePoint) -> Vec3 {
    let n = surface.ns;
    let here = textures.float(height, at);
    let [dpdu, dpdv] = [(surface.dpdu, Vec3::X), (surface.dpdv, Vec3::Y)].map(|(along, uv)| {
        let moved = TexturePoint {
            uv: at.uv + STEP * uv.truncate(),
            world: at.world + (STEP * along).as_dvec3(),
            looked_up: None,
            ..*at
        };
        // In the tangent plane of the shading normal.
        let tangent = along - n * n.dot(along);
        tangent + n * ((textures.float(height, &moved) - here) / STEP)
    });
    let across = dpdu.cross(dpdv);
    if surface.dpdu.cross(surface.dpdv).dot(n) < 0.0 { -across } else { across }
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
