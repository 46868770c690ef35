//! Parser for MTL files.
//!
//! Materials as they are written (Wavefront, "MTL material format", Advanced Visualizer manual, appendix B2, and Clara.io's
//! extensions for physically based materials). `look` interprets them. Nothing in a material library is an error:
//! statements that are not understood are ignored with a warning.

use std::collections::BTreeMap;
use std::path::Path;

pub use super::map::Map;
use crate::error::Location;
use crate::files::LoadContext;
use crate::model::number::parse_f32;
use crate::model::scan::{Scanner, shown};
use crate::model::tally::Tally;
use crate::model::text;
use crate::texture::Channel;

/// A material as it is written; `None` for absent statements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlMaterial {
    /// The bytes after `newmtl`, trimmed.
    pub name: Vec<u8>,
    /// The location of its first byte.
    pub at: Location,
    /// `Kd`, finite and not negative, as are `Ks`, `Ke` and `Tf`.
    pub diffuse: Option<[f32; 3]>,
    /// `Ks`.
    pub specular: Option<[f32; 3]>,
    /// `Ke`.
    pub emission: Option<[f32; 3]>,
    /// `Tf`: the transmission filter.
    pub filter: Option<[f32; 3]>,
    /// `Ns`: the sharpness of the highlight.
    pub shininess: Option<f32>,
    /// `Ni`: the index of refraction.
    pub ior: Option<f32>,
    /// `d`, or what [`parse`] makes of `Tr`: 1 is opaque.
    pub opacity: Option<f32>,
    /// `Tr`, in [0, 1], on whose meaning programs disagree.
    pub transparency: Option<f32>,
    /// `illum`: the number of the illumination model.
    pub illumination: Option<u32>,
    /// `Pm`: 1 is metal.
    pub metallic: Option<f32>,
    /// `Pr`: 0 is a perfect mirror.
    pub roughness: Option<f32>,
    /// `map_Kd`.
    pub diffuse_map: Option<Map>,
    /// `map_Ks`.
    pub specular_map: Option<Map>,
    /// `map_Ke`.
    pub emission_map: Option<Map>,
    /// `map_d`: multiplies the opacity.
    pub opacity_map: Option<Map>,
    /// `map_Ns`: multiplies the sharpness of the highlight.
    pub shininess_map: Option<Map>,
    /// `map_Bump` or `bump`: heights.
    pub bump_map: Option<Map>,
    /// `norm` or `map_Kn`: normals.
    pub normal_map: Option<Map>,
    /// `map_Pm`, or a channel of `map_RMA` or `map_ORM`: replaces `Pm`.
    pub metallic_map: Option<Map>,
    /// `map_Pr`, or a channel of `map_RMA` or `map_ORM`: replaces `Pr`.
    pub roughness_map: Option<Map>,
    /// `Ps`: the strength of the sheen.
    pub sheen: Option<f32>,
    /// `map_Ps`: replaces `Ps`.
    pub sheen_map: Option<Map>,
    /// `Pc`: the strength of a clear coat.
    pub clearcoat: Option<f32>,
    /// `Pcr`: its roughness.
    pub clearcoat_roughness: Option<f32>,
    /// `aniso`: the elongation of the highlight.
    pub anisotropy: Option<f32>,
    /// `anisor`: its rotation; 1 is a full turn.
    pub anisotropy_rotation: Option<f32>,
}

/// Parses a library's materials in the order of the file; `path` is for messages.
pub fn parse(bytes: &[u8], path: &Path, context: &mut LoadContext<'_>) -> Vec<MtlMaterial> {
    let file = Location::file(path);
    let text = text::utf8(bytes);
    let mut scanner = Scanner::joining_lines(&text);
    let mut materials: Vec<MtlMaterial> = Vec::new();
    let mut unreadable = Tally::default();
    let mut orphans = Tally::default();
    let mut ignored: BTreeMap<&str, Tally> = BTreeMap::new();
    loop {
        let keyword = scanner.word();
        let at_keyword = scanner.clone();
        if keyword == b"newmtl" {
            let name = scanner.rest_of_line().to_vec();
            materials.push(MtlMaterial { name, at: at_keyword.at(&file), ..MtlMaterial::default() });
        } else if !keyword.is_empty() && keyword[0] != b'#' {
            match materials.last_mut().map(|material| material.set(keyword, &mut scanner, &file)) {
                Some(Outcome::Done) => {}
                Some(Outcome::Unreadable) => unreadable.add(scanner.line()),
                Some(Outcome::Ignored(name)) => ignored.entry(name).or_default().add(scanner.line()),
                None => orphans.add(scanner.line()),
            }
        }
        if !scanner.next_line() {
            break;
        }
    }
    resolve_transparency(&mut materials, is_of_meshlab(&text), &file, context);
    unreadable.warn("line", "ignored: the values are not what the keyword expects", &file, context);
    orphans.warn("line", "before the first `newmtl` ignored", &file, context);
    for (name, tally) in ignored {
        let noun = format!("`{name}` statement");
        let what = "ignored: not supported";
        match name {
            // A parameter of `refl`, which has its own warning.
            "sharpness" => tally.notice(&noun, what, &file, context),
            _ => tally.warn(&noun, what, &file, context),
        }
    }
    materials
}

/// Whether MeshLab wrote the library; it says so in a comment.
fn is_of_meshlab(text: &[u8]) -> bool {
    let comments = text.split(|byte| *byte == b'\n').filter(|line| line.trim_ascii_start().starts_with(b"#"));
    comments.take(64).any(|line| line.to_ascii_lowercase().windows(7).any(|word| word == b"meshlab"))
}

/// Decides what `Tr` means where there is no `d`: 1 − opacity, but opacity itself in libraries of MeshLab. A material that
/// would be invisible by `Tr 1` alone is opaque: exporters on MeshLab's library (VCGlib) write it for opaque ones.
fn resolve_transparency(
    materials: &mut [MtlMaterial],
    is_of_meshlab: bool,
    file: &Location,
    context: &mut LoadContext<'_>,
) {
    let mut invisible = Tally::default();
    for material in &mut *materials {
        material.opacity =
            material.opacity.or(material.transparency.map(|tr| match is_of_meshlab || tr == 1.0 {
                true => tr,
                false => 1.0 - tr,
            }));
        if material.transparency == Some(1.0) && material.opacity == Some(1.0) && !is_of_meshlab {
            invisible.add(material.at.line);
        }
    }
    invisible.notice(
        "material",
        "with `Tr 1`, taken to be opaque as VCGlib means it: write `d 0` for invisible",
        file,
        context,
    );
    let is_invisible =
        |material: &MtlMaterial| material.opacity == Some(0.0) && material.opacity_map.is_none();
    if !materials.is_empty() && materials.iter().all(is_invisible) {
        context.warn(
            file,
            "every material is fully transparent (`d 0`): nothing of the model is visible, but reflections",
        );
    }
}

enum Outcome {
    Done,
    Unreadable,
    Ignored(&'static str),
}

impl MtlMaterial {
    fn set(&mut self, keyword: &[u8], scanner: &mut Scanner<'_>, file: &Location) -> Outcome {
        let done = |is: bool| if is { Outcome::Done } else { Outcome::Unreadable };
        let mut color = |to: &mut Option<[f32; 3]>| {
            let value = read_color(scanner);
            *to = value.or(*to);
            done(value.is_some())
        };
        match keyword {
            b"Kd" => return color(&mut self.diffuse),
            b"Ks" => return color(&mut self.specular),
            b"Ke" => return color(&mut self.emission),
            b"Tf" => return color(&mut self.filter),
            _ => {}
        }
        let mut number = |to: &mut Option<f32>| {
            let value = read_number(scanner);
            *to = value.or(*to);
            done(value.is_some())
        };
        match keyword {
            b"Ns" => return number(&mut self.shininess),
            b"Ni" => return number(&mut self.ior),
            b"Pm" | b"metallic" => return number(&mut self.metallic),
            b"Pr" | b"roughness" => return number(&mut self.roughness),
            b"Ps" => return number(&mut self.sheen),
            b"Pc" => return number(&mut self.clearcoat),
            b"Pcr" => return number(&mut self.clearcoat_roughness),
            b"aniso" | b"anisor" => {
                let value = parse_f32(scanner.word()).filter(|value| value.is_finite());
                let to = match keyword {
                    b"aniso" => &mut self.anisotropy,
                    _ => &mut self.anisotropy_rotation,
                };
                *to = value.or(*to);
                return done(value.is_some());
            }
            b"d" | b"Tr" => {
                let mut word = scanner.word();
                if word == b"-halo" {
                    word = scanner.word();
                }
                let value = parse_f32(word).filter(|value| value.is_finite());
                let to = if keyword == b"d" { &mut self.opacity } else { &mut self.transparency };
                *to = value.map(|value| value.clamp(0.0, 1.0)).or(*to);
                return done(value.is_some());
            }
            b"illum" => {
                let value = read_number(scanner);
                self.illumination = value.map(|value| value as u32).or(self.illumination);
                return done(value.is_some());
            }
            _ => {}
        }
        let keyword = keyword.to_ascii_lowercase();
        if let b"map_rma" | b"map_orm" = keyword.as_slice() {
            let [roughness, metallic] = match keyword.as_slice() {
                b"map_rma" => [Channel::Red, Channel::Green],
                _ => [Channel::Green, Channel::Blue],
            };
            let Some(map) = Map::read(scanner, file) else { return Outcome::Unreadable };
            let channel_of = |channel| Some(Map { channel: Some(channel), ..map.clone() });
            (self.roughness_map, self.metallic_map) = (channel_of(roughness), channel_of(metallic));
            return Outcome::Done;
        }
        let mut map = |to: &mut Option<Map>| {
            let value = Map::read(scanner, file);
            let is = value.is_some();
            *to = value.or(to.take());
            done(is)
        };
        match keyword.as_slice() {
            b"map_kd" => map(&mut self.diffuse_map),
            b"map_ks" => map(&mut self.specular_map),
            b"map_ke" => map(&mut self.emission_map),
            b"map_d" | b"map_opacity" | b"map_tr" => map(&mut self.opacity_map),
            b"map_ns" => map(&mut self.shininess_map),
            b"map_bump" | b"bump" => map(&mut self.bump_map),
            // The longer names are those of Apple's Model I/O, and so of what is scanned by telephones.
            b"norm" | b"map_kn" | b"map_normal" | b"map_tangentspacenormal" => map(&mut self.normal_map),
            b"map_pr" | b"map_roughness" => map(&mut self.roughness_map),
            b"map_pm" | b"map_metallic" => map(&mut self.metallic_map),
            b"map_ps" => map(&mut self.sheen_map),
            // Ambient colours are rarely meaningful: most programs write black, white or the diffuse colour.
            b"ka" | b"map_ka" => Outcome::Done,
            // Light that does not reach corners is not left out of what is traced.
            b"ao" | b"map_ao" => Outcome::Done,
            b"disp" | b"map_disp" | b"decal" => Outcome::Ignored("disp, decal"),
            b"refl" | b"map_refl" => Outcome::Ignored("refl"),
            b"km" => Outcome::Ignored("Km"),
            b"sharpness" => Outcome::Ignored("sharpness"),
            _ => Outcome::Ignored("(unknown)"),
        }
    }
}

fn read_number(scanner: &mut Scanner<'_>) -> Option<f32> {
    parse_f32(scanner.word()).filter(|value| value.is_finite() && *value >= 0.0)
}

/// `r [g b]` or `xyz x [y z]`; a single number stands for all three.
fn read_color(scanner: &mut Scanner<'_>) -> Option<[f32; 3]> {
    let mut word = scanner.word();
    let is_xyz = word == b"xyz";
    if is_xyz {
        word = scanner.word();
    }
    let mut values = [0.0; 3];
    let mut count = 0;
    while count < 3 && !word.is_empty() && word[0] != b'#' {
        values[count] = parse_f32(word).filter(|value| value.is_finite())?;
        (count, word) = (count + 1, scanner.word());
    }
    let [x, y, z] = match count {
        1 => [values[0]; 3],
        3 => values,
        _ => return None,
    };
    // To linear Rec. 709 (ITU-R BT.709-6, its primaries and white).
    let rgb = if is_xyz {
        [
            3.240_97 * x - 1.537_383_2 * y - 0.498_610_8 * z,
            -0.969_243_65 * x + 1.875_967_5 * y + 0.041_555_06 * z,
            0.055_630_08 * x - 0.203_976_96 * y + 1.056_971_5 * z,
        ]
    } else {
        [x, y, z]
    };
    Some(rgb.map(|value| value.max(0.0)))
}

/// The name of a material, for messages.
pub(super) fn shown_name(name: &[u8]) -> String {
    if name.is_empty() { "(no name)".to_owned() } else { shown(name) }
}
