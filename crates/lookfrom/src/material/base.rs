//! The one colour of a surface that its light is multiplied by, more or less: for the denoiser, which sets it aside so that
//! textures are not taken for noise. A look-up, not an integral over directions: what a coat mirrors on top is left out.

use lookfrom_scene::material::{Color, MaterialKind, Metal};

use super::Material;
use crate::surface::Surface;
use crate::texture::{TexturePoint, Textures, Usage};

/// Linear Rec. 709, at least 0; white where a surface has no colour of its own.
pub fn base_color(
    materials: &[Material],
    textures: &Textures,
    surface: &Surface,
    point: &TexturePoint,
) -> [f32; 3] {
    of_kind(&materials[surface.material as usize].kind, materials, textures, point).map(|c| c.max(0.0))
}

fn of_kind(
    kind: &MaterialKind,
    materials: &[Material],
    textures: &Textures,
    point: &TexturePoint,
) -> [f32; 3] {
    let color = |color: Color| textures.rgb(color, Usage::Albedo, point);
    let sum = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|c| a[c] + b[c]);
    match kind {
        MaterialKind::Whitted(k) => sum(sum(color(k.diffuse), color(k.mirror)), color(k.transmission)),
        MaterialKind::Diffuse { reflectance } | MaterialKind::CoatedDiffuse { reflectance, .. } => {
            color(*reflectance)
        }
        MaterialKind::DiffuseTransmission { reflectance, transmittance, scale } => {
            sum(color(*reflectance), color(*transmittance)).map(|c| c * scale)
        }
        MaterialKind::Conductor { metal, .. } | MaterialKind::CoatedConductor { metal, .. } => match metal {
            Metal::Reflectance(reflectance) => color(*reflectance),
            Metal::Indices { .. } => [1.0; 3],
        },
        MaterialKind::Mix { materials: parts, amount } => {
            let [first, second] =
                parts.map(|part| of_kind(&materials[part.index()].kind, materials, textures, point));
            let amount = textures.scalar(*amount, point).clamp(0.0, 1.0);
            [0, 1, 2].map(|c| (1.0 - amount) * first[c] + amount * second[c])
        }
        MaterialKind::Principled(look) => color(look.base_color),
        MaterialKind::Unlit { color: seen } => color(*seen),
        MaterialKind::Dielectric { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::ShadowCatcher { .. }
        | MaterialKind::Interface => [1.0; 3],
    }
}
