//! Conversion of MTL materials: to the Whitted model, or by `physical` to glTF's if they are physically based.
//!
//! Colours are taken to be linear. Only materials that are used are converted, and only their images are read. Ambient
//! light is reflected by the diffuse colour: `Ka` is rarely meaningful.
//!
//! | MTL | here |
//! | --- | --- |
//! | `Kd`, `map_Kd` | diffuse; their product, or the image alone if `Kd` is black |
//! | `Ks`, `Ns`, if `illum` is 2 or more (or absent) and `Ns` > 0 | highlight |
//! | `illum` 3, 5 | mirror reflection with the colour `Ks` (5: by Fresnel) |
//! | `d` < 1 | weight of the diffuse colour; the rest is transmitted, tinted by `Tf`, and refracted by `Ni` if `illum` is 4 … 9 |
//! | `illum` 6, 7 with `Ni`, `Tf` or a black `Kd`, without `map_Kd` | glass: all is transmitted as if `d` were 0 |
//! | `illum` 4, 6, 7 of what transmits light | mirror reflection with the colour `Ks` (7: by Fresnel) |
//! | `Pm`, `Pr` | a metal: mirror reflection `Kd · Pm · (1 − Pr)²`, the rest a highlight |
//! | `map_Ns` | its mean multiplies `Ns` |
//! | `map_d` | alpha of the surface, which `d` does not change in the Whitted model: that is light let through |
//! | `map_Bump`, `norm` | bump or normal map |
//! | `Ke`, `map_Ke` | emission, from the front side |

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::maps::{Images, Maps};
use super::mtl::{self, Map, MtlMaterial, shown_name};
use super::physical;
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::material::{BumpMapping, Color, Ior, Material, MaterialKind, Scalar, Whitted};
use crate::model::surface::{base_name, beside, push_texture, push_vertex_colors};
use crate::model::tally::Tally;
use crate::packed;
use crate::scene::{MaterialId, Scene};
use crate::shape::Emission;
use crate::texture::TextureKind;
use crate::warning::Warning;

/// The material libraries of a file, and what is converted of them.
pub(super) struct MaterialLibraries {
    materials: Vec<(MtlMaterial, PathBuf)>,
    by_name: HashMap<Vec<u8>, usize>,
    /// The libraries that have been read.
    read: HashSet<PathBuf>,
    images: Images,
    names_libraries: bool,
    /// The library beside the file with the same stem, until it has been looked for.
    same_stem: Option<PathBuf>,
    missing: Tally,
    missing_name: String,
}

/// The material, emission and alpha of one part.
#[derive(Default)]
pub(super) struct MaterialBinding {
    pub(super) material: Option<MaterialId>,
    pub(super) emission: Option<Emission>,
    pub(super) alpha: Option<Scalar>,
}

/// Properties of the geometry that its material depends on.
#[derive(Clone, Copy)]
pub(super) struct MeshTraits {
    /// Whether vertices have colours.
    pub(super) is_colored: bool,
    /// The length of a unit of texture coordinates.
    pub(super) unit_of_uv: Option<f32>,
}

/// Limits on the number of libraries and on the length of each, against hostile files.
pub(super) const MOST_LIBRARIES: usize = 64;
const LIBRARY_BYTES: u64 = 1 << 26;

const BLACK: [f32; 3] = [0.0; 3];
const WHITE: [f32; 3] = [1.0; 3];

impl MaterialLibraries {
    /// Reads the material libraries of the file at `path`, with warnings for those that cannot be read.
    pub(super) fn read(
        libraries: &[(Location, Vec<u8>)],
        path: &Path,
        context: &mut LoadContext<'_>,
    ) -> Self {
        let mut looks = Self {
            materials: Vec::new(),
            by_name: HashMap::new(),
            read: HashSet::new(),
            images: Images::default(),
            names_libraries: !libraries.is_empty(),
            same_stem: Some(packed::unpacked_name(path).with_extension("mtl")),
            missing: Tally::default(),
            missing_name: String::new(),
        };
        if let Some((at, _)) = libraries.get(MOST_LIBRARIES) {
            context.warn(at, format!("only the first {MOST_LIBRARIES} material libraries are read"));
        }
        for (at, names) in libraries.iter().take(MOST_LIBRARIES) {
            let names = String::from_utf8_lossy(names).replace('\\', "/");
            let whole = names.trim_matches('"');
            // The line is one name with spaces, or several names.
            let Err(error) = looks.read_library(whole, path, context) else { continue };
            let words: Vec<&str> = names.split_whitespace().take(MOST_LIBRARIES).collect();
            let mut missing = vec![(whole, error)];
            if words.len() > 1 {
                let tried = words.iter().map(|name| (*name, looks.read_library(name, path, context)));
                missing = tried.filter_map(|(name, result)| Some((name, result.err()?))).collect();
            }
            // Libraries are often renamed along with the model, but not in the model's text.
            let replacement = match missing.len() == words.len() {
                true => looks.read_same_stem(context),
                false => None,
            };
            for (name, error) in missing {
                let instead = match &replacement {
                    Some(same_stem) => format!("; {} is used instead", same_stem.display()),
                    None => String::new(),
                };
                context.warn(at, format!("material library `{name}`: {}{instead}", error.message));
            }
        }
        looks
    }

    fn read_library(&mut self, name: &str, path: &Path, context: &mut LoadContext<'_>) -> Result<()> {
        self.read_at(&beside(path, name), context)
            .or_else(|error| self.read_at(&beside(path, base_name(name)), context).map_err(|_| error))
    }

    /// Reads the library beside the file with the same stem, once; its name if there is one.
    fn read_same_stem(&mut self, context: &mut LoadContext<'_>) -> Option<PathBuf> {
        let library = self.same_stem.take()?;
        self.read_at(&library, context).is_ok().then_some(library)
    }

    fn read_at(&mut self, library: &Path, context: &mut LoadContext<'_>) -> Result<()> {
        if self.read.contains(library) {
            return Ok(());
        }
        let bytes = context.files.read(library, LIBRARY_BYTES.min(context.limits.file_bytes))?;
        for material in mtl::parse(&bytes, library, context) {
            // The first material with a name counts.
            if let Entry::Vacant(entry) = self.by_name.entry(material.name.clone()) {
                entry.insert(self.materials.len());
                self.materials.push((material, library.to_owned()));
            }
        }
        self.read.insert(library.to_owned());
        Ok(())
    }

    /// Converts the material with this name and adds it to the scene.
    pub(super) fn binding(
        &mut self,
        name: Option<&[u8]>,
        traits: MeshTraits,
        file: &Location,
        context: &mut LoadContext<'_>,
        scene: &mut Scene,
    ) -> MaterialBinding {
        if let Some(name) = name
            && !self.by_name.contains_key(name)
            && let Some(library) = self.read_same_stem(context)
        {
            let message = format!(
                "the material `{}` is in no library that is named: {} is read, too",
                shown_name(name),
                library.display()
            );
            context.warnings.push(Warning::notice(file, message));
        }
        let index = name.and_then(|name| self.by_name.get(name).copied());
        if let (Some(name), None) = (name, index) {
            if self.missing.count() == 0 {
                self.missing_name = shown_name(name);
            }
            self.missing.add(0);
        }
        let Some(index) = index else {
            let material = traits.is_colored.then(|| push_vertex_colors(scene, file));
            return MaterialBinding { material, ..MaterialBinding::default() };
        };
        let (written, library) = &self.materials[index];
        translate(written, traits, Maps { images: &mut self.images, library, context, scene })
    }

    /// Warns of materials that no library defines. Files without libraries use names freely.
    pub(super) fn warn(&self, file: &Location, context: &mut LoadContext<'_>) {
        if !self.names_libraries {
            return;
        }
        let what =
            format!("not defined in any library, such as `{}`: the default is used", self.missing_name);
        self.missing.warn("material", &what, file, context);
    }
}

fn translate(written: &MtlMaterial, traits: MeshTraits, mut maps: Maps<'_, '_>) -> MaterialBinding {
    let name = shown_name(&written.name);
    warn_of_gain(written, &name, &mut maps);
    if let Some(illumination @ (6 | 7)) = written.illumination
        && own_opacity(written) == 1.0
        && !is_glass(written)
    {
        let message = format!(
            "material `{name}` is opaque: its `illum {illumination}` means glass, but its colour, `d` and `Ni` do not; for glass write \
             `Ni 1.5`, without `map_Kd`"
        );
        maps.context.warnings.push(Warning::notice(&written.at, message));
    }
    let kind = match physical::is_physical(written) {
        true => MaterialKind::Principled(Box::new(physical::principled(written, traits, &mut maps))),
        false => MaterialKind::Whitted(whitted(written, traits, &mut maps)),
    };
    let is_physical = matches!(kind, MaterialKind::Principled(_));
    let ke = written.emission.unwrap_or(BLACK);
    let shines = ke != BLACK || written.emission_map.is_some();
    let emission = shines.then(|| {
        let radiance = color(ke, written.emission_map.as_ref(), 1.0, &mut maps);
        Emission::new(radiance, false)
    });
    let emission = emission.filter(|emission| emission.radiance != Color::BLACK);
    let cut = written.opacity_map.as_ref();
    let cut = cut.and_then(|map| maps.opacity(map, written.diffuse_map.as_ref()));
    let alpha = if is_physical { physical::alpha(written, cut, &mut maps) } else { cut };
    let bump_mapping = bump_mapping(written, traits, &mut maps);
    let material = Material { bump_mapping, ..Material::new(name, written.at.clone(), kind) };
    maps.scene.materials.push(material);
    MaterialBinding { material: Some(MaterialId(maps.scene.materials.len() as u32 - 1)), emission, alpha }
}

/// Warns of colours that are multiplied by more than 1. One without an image is checked when the scene is built.
fn warn_of_gain(written: &MtlMaterial, name: &str, maps: &mut Maps<'_, '_>) {
    let tinted = [(written.diffuse, &written.diffuse_map), (written.specular, &written.specular_map)];
    for (tint, map) in tinted {
        if let (Some([r, g, b]), Some(map)) = (tint, map)
            && r.max(g).max(b) > 1.0
        {
            let file = &map.file;
            let message = format!(
                "material `{name}` multiplies `{file}` by [{r}, {g}, {b}], and colours of surfaces go from 0 to 1: \
                 the surface gives off more light than arrives"
            );
            maps.context.warn(&written.at, message);
        }
    }
}

/// A constant times a map, times `scale`; the map alone if the constant is black, as sloppy exporters write it.
fn color(constant: [f32; 3], map: Option<&Map>, scale: f32, maps: &mut Maps<'_, '_>) -> Color {
    let constant = constant.map(|value| value * scale);
    let picture = map.filter(|_| scale > 0.0).and_then(|map| {
        let tint = if constant == BLACK { [scale; 3] } else { constant };
        maps.color(map, tint)
    });
    picture.unwrap_or(Color::Value(constant))
}

/// The diffuse colour times `covering`, with the colours of the vertices where there is no map.
pub(super) fn diffuse(
    written: &MtlMaterial,
    traits: MeshTraits,
    covering: f32,
    maps: &mut Maps<'_, '_>,
) -> Color {
    let kd = diffuse_constant(written);
    let diffuse = color(kd, written.diffuse_map.as_ref(), covering, maps);
    if let (true, Color::Value(_)) = (traits.is_colored && written.diffuse_map.is_none(), diffuse) {
        let tint = if kd == BLACK { WHITE } else { kd }.map(|value| value * covering);
        let kind = TextureKind::VertexColor { tint };
        return push_texture(maps.scene, &shown_name(&written.name), &written.at, kind);
    }
    diffuse
}

fn diffuse_constant(written: &MtlMaterial) -> [f32; 3] {
    written.diffuse.unwrap_or(if written.diffuse_map.is_some() { WHITE } else { [0.8; 3] })
}

/// `Ns` times the mean of its map.
pub(super) fn shininess(written: &MtlMaterial, maps: &mut Maps<'_, '_>) -> f32 {
    let mean = written.shininess_map.as_ref().and_then(|map| maps.mean(map));
    written.shininess.unwrap_or(0.0) * mean.map_or(1.0, |mean| mean.max(0.0))
}

fn bump_mapping(written: &MtlMaterial, traits: MeshTraits, maps: &mut Maps<'_, '_>) -> BumpMapping {
    let Some(unit_of_uv) = traits.unit_of_uv else { return BumpMapping::None };
    let normals = written.normal_map.as_ref().and_then(|map| maps.normals(map));
    let heights = || written.bump_map.as_ref().and_then(|map| maps.heights(map, unit_of_uv));
    normals.or_else(heights).unwrap_or_default()
}

/// `d`; 1 if it is 0 and there is a map, for which sloppy exporters write it.
pub(super) fn own_opacity(written: &MtlMaterial) -> f32 {
    written.opacity.filter(|&d| d > 0.0 || written.opacity_map.is_none()).unwrap_or(1.0)
}

/// Whether what is opaque by `d` is glass all the same, by its illumination model. Many programs write 6 or 7 for anything: glass has
/// an index of refraction, a filter or no colour of its own.
pub(super) fn is_glass(written: &MtlMaterial) -> bool {
    let is_meant = written.ior.is_some_and(|ior| ior > 0.0 && ior != 1.0)
        || written.filter.is_some_and(|filter| filter != BLACK && filter != WHITE)
        || written.diffuse == Some(BLACK);
    matches!(written.illumination, Some(6 | 7))
        && own_opacity(written) == 1.0
        && is_meant
        && written.diffuse_map.is_none()
}

fn whitted(written: &MtlMaterial, traits: MeshTraits, maps: &mut Maps<'_, '_>) -> Whitted {
    let illumination = written.illumination.unwrap_or(2);
    let opacity = own_opacity(written);
    let kd = diffuse_constant(written);
    let metallic = written.metallic.unwrap_or(0.0).min(1.0);
    // The transmitted fraction.
    let passing = if is_glass(written) { 1.0 } else { 1.0 - opacity };
    let covering = (1.0 - passing) * (1.0 - metallic);

    let diffuse = diffuse(written, traits, covering, maps);
    let ks = written.specular.unwrap_or(BLACK);
    let shininess = shininess(written, maps);
    let has_highlight = illumination >= 2 && shininess > 0.0;
    let specular_map = written.specular_map.as_ref();
    let mut specular = if has_highlight { color(ks, specular_map, 1.0, maps) } else { Color::BLACK };
    let mut mirror = match illumination {
        3 | 5 => color(ks, specular_map, 1.0, maps),
        4 | 6 | 7 if passing > 0.0 => color(ks, specular_map, 1.0, maps),
        _ => Color::BLACK,
    };
    let filter = written.filter.filter(|&filter| filter != BLACK).unwrap_or(WHITE);
    let mut whitted = Whitted {
        diffuse,
        shininess,
        transmission: Color::Value(filter.map(|value| value.min(1.0) * passing)),
        ior: match (written.ior, illumination) {
            (Some(ior), 4..=9) if ior > 0.0 => ior,
            (_, 4 | 5 | 6 | 7 | 9) => Ior::GLASS,
            _ => 1.0,
        },
        ..Whitted::default()
    };
    // Many programs write `Ni 1` everywhere, which would leave no reflection.
    whitted.fresnel = (illumination == 7 && passing > 0.0) || (illumination == 5 && whitted.ior != 1.0);
    if whitted.fresnel && passing > 0.0 {
        // Fresnel's equations distribute all light between reflection and transmission.
        mirror = Color::Value(if ks == BLACK { WHITE } else { ks });
    }
    if metallic > 0.0 {
        let roughness = written.roughness.unwrap_or(0.5).clamp(0.0, 1.0);
        let clear = (1.0 - roughness) * (1.0 - roughness);
        mirror = color(kd, written.diffuse_map.as_ref(), metallic * clear, maps);
        specular = color(kd, written.diffuse_map.as_ref(), metallic * (1.0 - clear), maps);
        // The exponent with a highlight as wide as this roughness (Walter et al. 2007: α = roughness²).
        let alpha = (roughness * roughness).max(0.01);
        whitted.shininess = (2.0 / (alpha * alpha) - 2.0).max(1.0);
    }
    whitted.mirror = mirror;
    whitted.specular = specular;
    whitted
}
