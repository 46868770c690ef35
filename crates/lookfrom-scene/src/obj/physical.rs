//! Conversion of physically based MTL materials to glTF's metallic-roughness material.
//!
//! Materials are physically based if they have a map of metal or roughness, a sheen, a clear coat or anisotropy; `Pm` and
//! `Pr` alone are parameters of the Whitted model (see `look`). Maps replace constants, as the programs that write them mean it.
//!
//! | MTL | glTF |
//! | --- | --- |
//! | `Kd`, `map_Kd` | base colour |
//! | `Pm`, `Pr` and their maps | metallic, roughness; roughness from `Ns` if there is none |
//! | `Ni` > 1 | index of refraction |
//! | `illum` 6, 7 of glass (see `look`) | transmission into a solid |
//! | `d`, `map_d` | alpha: their product |
//! | `Ps`, `map_Ps` | a white sheen |
//! | `Pc`, `Pcr` | clear coat and its roughness |
//! | `aniso`, `anisor` | anisotropy; 1 is a full turn |

use super::look::{MeshTraits, diffuse, is_glass, own_opacity, shininess};
use super::maps::Maps;
use super::mtl::{Map, MtlMaterial};
use crate::material::{Anisotropy, Color, Ior, Principled, Scalar};
use crate::model::surface::add_texture;
use crate::texture::TextureKind;

/// Roughness where neither `Pr` nor `Ns` gives any, and that of sheen, which MTL does not have.
const ROUGHNESS: f32 = 0.5;

/// Whether a material has any statement that only physically based materials have.
pub(super) fn is_physical(written: &MtlMaterial) -> bool {
    let maps = [&written.metallic_map, &written.roughness_map, &written.sheen_map];
    let numbers = [written.sheen, written.clearcoat, written.clearcoat_roughness, written.anisotropy];
    maps.iter().any(|map| map.is_some()) || numbers.iter().any(Option::is_some)
}

/// The material without its alpha and emission.
pub(super) fn principled(written: &MtlMaterial, traits: MeshTraits, maps: &mut Maps<'_, '_>) -> Principled {
    let base_color = diffuse(written, traits, 1.0, maps);
    let metallic = number(written.metallic_map.as_ref(), unit(written.metallic), maps);
    let roughness = written.roughness.map_or_else(|| rough(shininess(written, maps)), |r| r.min(1.0));
    let roughness = number(written.roughness_map.as_ref(), roughness, maps);
    let is_glass = is_glass(written);
    let sheen = number(written.sheen_map.as_ref(), unit(written.sheen), maps);
    let strength = written.anisotropy.unwrap_or(0.0).clamp(0.0, 1.0);
    let turns = written.anisotropy_rotation.unwrap_or(0.0);
    Principled {
        base_color,
        metallic,
        roughness,
        ior: written.ior.filter(|&ior| ior > 1.0).unwrap_or(Ior::GLASS),
        transmission: Scalar::Value(if is_glass { 1.0 } else { 0.0 }),
        is_solid: is_glass,
        sheen_color: match sheen {
            Scalar::Value(value) => Color::gray(value),
            Scalar::Texture(id) => Color::Texture(id),
        },
        sheen_roughness: Scalar::Value(ROUGHNESS),
        clearcoat: Scalar::Value(unit(written.clearcoat)),
        clearcoat_roughness: Scalar::Value(unit(written.clearcoat_roughness)),
        anisotropy: (strength > 0.0).then_some(Anisotropy {
            strength,
            rotation: turns * std::f32::consts::TAU,
            texture: None,
        }),
        ..Principled::default()
    }
}

/// Alpha: `d` times what its map gives.
pub(super) fn alpha(written: &MtlMaterial, map: Option<Scalar>, maps: &mut Maps<'_, '_>) -> Option<Scalar> {
    match (map, own_opacity(written)) {
        (map, 1.0) => map,
        (Some(Scalar::Texture(id)), d) => {
            let kind = TextureKind::Scale { color: Color::Texture(id), by: Scalar::Value(d) };
            let name = written.opacity_map.as_ref().map_or("", |map| &map.file);
            Some(Scalar::Texture(add_texture(maps.scene, name, &written.at, kind)))
        }
        (_, d) => Some(Scalar::Value(d)),
    }
}

/// A map, or a constant without one that can be read.
fn number(map: Option<&Map>, constant: f32, maps: &mut Maps<'_, '_>) -> Scalar {
    map.and_then(|map| maps.number(map)).unwrap_or(Scalar::Value(constant))
}

fn unit(value: Option<f32>) -> f32 {
    value.unwrap_or(0.0).min(1.0)
}

/// The perceptual roughness with a highlight as wide as that of Blinn's exponent (Walter et al. 2007: α = roughness²).
fn rough(shininess: f32) -> f32 {
    if shininess > 0.0 { (2.0 / (shininess + 2.0)).sqrt().sqrt() } else { ROUGHNESS }
}
