//! Bumps and normal maps: the frame in which a material is shaded.
//!
//! Blinn 1978 (bumps).

use glam::Vec3;
use lookfrom_scene::material::{Relief, Scalar};
use lookfrom_scene::texture::{TexelFilter, Wrap};

use super::Frame;
use crate::surface::Surface;
use crate::texture::{self, TexturePoint, Textures};
use crate::warp;

/// How far in u and v heights are compared, as pbrt-v4 does it where it knows no footprint.
const STEP: f32 = 0.0005;

/// The frame of the shading normal as it is.
pub(super) fn plain(surface: &Surface) -> Frame {
    around(surface.ns, surface.shading_dpdu)
}

/// The shading frame at a surface: its normal on the side of the geometric one, its first axis along ∂p/∂u.
pub(super) fn frame(relief: &Relief, textures: &Textures, surface: &Surface, at: &TexturePoint) -> Frame {
    let plain = plain(surface);
    let bent = match relief {
        Relief::None => return plain,
        Relief::NormalMap(image) => {
            let st = [at.uv.x, 1.0 - at.uv.y];
            let texel =
                texture::look_up(textures.image(image.index()), st, [Wrap::Repeat; 2], TexelFilter::Bilinear);
            let local = Vec3::from_array(texel.map(|c| 2.0 * c - 1.0)).normalize_or(Vec3::Z);
            plain.render(local)
        }
        Relief::NormalTexture(_) => plain.n,
        Relief::Bump(height) => bumped(*height, textures, surface, at),
    };
    let bent = bent.normalize_or(surface.ns);
    let side = if bent.dot(surface.ng.as_vec3()) < 0.0 { -bent } else { bent };
    around(side, surface.shading_dpdu)
}

/// The normal of the surface moved along its shading normal; not of unit length.
fn bumped(height: Scalar, textures: &Textures, surface: &Surface, at: &TexturePoint) -> Vec3 {
    let n = surface.ns;
    let here = textures.scalar(height, at);
    let [dpdu, dpdv] =
        [(surface.shading_dpdu, Vec3::X), (surface.shading_dpdv, Vec3::Y)].map(|(along, uv)| {
            let moved = TexturePoint {
                uv: at.uv + STEP * uv.truncate(),
                world: at.world + (STEP * along).as_dvec3(),
                ..*at
            };
            // in the tangent plane of the shading normal
            let tangent = along - n * n.dot(along);
            tangent + n * ((textures.scalar(height, &moved) - here) / STEP)
        });
    let across = dpdu.cross(dpdv);
    if surface.shading_dpdu.cross(surface.shading_dpdv).dot(n) < 0.0 { -across } else { across }
}

fn around(n: Vec3, dpdu: Vec3) -> Frame {
    let across = dpdu - n * n.dot(dpdu);
    match across.try_normalize() {
        Some(s) => Frame { s, t: n.cross(s), n },
        None => {
            let (s, t) = warp::orthonormal_basis(n);
            Frame { s, t, n }
        }
    }
}
