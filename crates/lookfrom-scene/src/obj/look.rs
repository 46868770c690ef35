//! Conversion of MTL materials to the Whitted model.
//!
//! Colours are taken to be linear. Only materials that are used are converted, and only their images are read. Ambient
//! light is reflected by the diffuse colour: `Ka` is rarely meaningful.
//!
//! | MTL | here |
//! | --- | --- |
//! | `Kd`, `map_Kd` | diffuse; their product, or the image alone if `Kd` is black |
//! | `Ks`, `Ns`, if `illum` is 2 or more (or absent) and `Ns` > 0 | highlight |
//! | `illum` 3, 5 | mirror reflection with the colour `Ks` (5: by Fresnel) |
//! | `d` < 1 | weight of the diffuse colour; the rest is transmitted, tinted by `Tf`, and refracted by `illum` |
//! | `illum` 4, 6, 7, 9 | glass: mirror reflection `Ks`, refraction by `Ni` (7: by Fresnel) |
//! | `Pm`, `Pr` | a metal: mirror reflection `Kd · Pm · (1 − Pr)²`, the rest a highlight |
//! | `Ke`, `map_Ke` | emission, from both sides |

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use super::mtl::{self, Map, MtlMaterial, shown_name};
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::image::Image;
use crate::material::{Color, Whitted};
use crate::model::surface::{
    base_name, beside, picture, push_image, push_material, push_texture, push_vertex_colors, read_image,
};
use crate::model::tally::Tally;
use crate::packed;
use crate::scene::{ImageId, MaterialId, Scene};
use crate::shape::Emission;
use crate::texture::{TextureKind, Wrap};

/// The material libraries of a file, and what is converted of them.
pub(super) struct Looks {
    materials: Vec<(MtlMaterial, PathBuf)>,
    by_name: HashMap<Vec<u8>, usize>,
    /// Images by file and tint, so that each is read once; `None` if it cannot be read.
    images: HashMap<(PathBuf, [u32; 3]), Option<ImageId>>,
    /// Total number of texels of the images read so far.
    texels: u64,
    names_libraries: bool,
    missing: Tally,
    missing_name: String,
}

/// The material and emission of one part.
pub(super) struct Look {
    pub(super) material: Option<MaterialId>,
    pub(super) emission: Option<Emission>,
}

/// Limits on the number of libraries and on the length of each, against hostile files.
const MOST_LIBRARIES: usize = 64;
const LIBRARY_BYTES: u64 = 1 << 26;

const BLACK: [f32; 3] = [0.0; 3];
const WHITE: [f32; 3] = [1.0; 3];

impl Looks {
    /// Reads the material libraries of the file at `path`, with warnings for those that cannot be read.
    pub(super) fn read(
        libraries: &[(Location, Vec<u8>)],
        path: &Path,
        context: &mut LoadContext<'_>,
    ) -> Self {
        let mut looks = Self {
            materials: Vec::new(),
            by_name: HashMap::new(),
            images: HashMap::new(),
            texels: 0,
            names_libraries: !libraries.is_empty(),
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
            let same_stem = packed::unpacked_name(path).with_extension("mtl");
            let is_replaced = missing.len() == words.len() && looks.read_at(&same_stem, context).is_ok();
            for (name, error) in missing {
                let instead = if is_replaced {
                    format!("; {} is used instead", same_stem.display())
                } else {
                    String::new()
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

    fn read_at(&mut self, library: &Path, context: &mut LoadContext<'_>) -> Result<()> {
        let bytes = context.files.read(library, LIBRARY_BYTES.min(context.limits.file_bytes))?;
        for material in mtl::parse(&bytes, library, context) {
            // The first material with a name counts.
            if let Entry::Vacant(entry) = self.by_name.entry(material.name.clone()) {
                entry.insert(self.materials.len());
                self.materials.push((material, library.to_owned()));
            }
        }
        Ok(())
    }

    /// Converts the material with this name and adds it to the scene. `colored` tells whether vertices have colours.
    pub(super) fn look(
        &mut self,
        name: Option<&[u8]>,
        colored: bool,
        file: &Location,
        context: &mut LoadContext<'_>,
        scene: &mut Scene,
    ) -> Look {
        let index = name.and_then(|name| self.by_name.get(name).copied());
        if let (Some(name), None) = (name, index) {
            if self.missing.count() == 0 {
                self.missing_name = shown_name(name);
            }
            self.missing.add(0);
        }
        let Some(index) = index else {
            let material = colored.then(|| push_vertex_colors(scene, file));
            return Look { material, emission: None };
        };
        let (written, library) = self.materials[index].clone();
        self.translate(&written, &library, colored, context, scene)
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

    fn translate(
        &mut self,
        written: &MtlMaterial,
        library: &Path,
        colored: bool,
        context: &mut LoadContext<'_>,
        scene: &mut Scene,
    ) -> Look {
        let name = shown_name(&written.name);
        let illumination = written.illumination.unwrap_or(2);
        let opacity = written.opacity.unwrap_or(1.0);
        let kd = written.diffuse.unwrap_or(if written.diffuse_map.is_some() { WHITE } else { [0.8; 3] });
        let metallic = written.metallic.unwrap_or(0.0).min(1.0);
        // The transmitted fraction: given by opacity, or 1 if the illumination model is glass.
        let is_glass = matches!(illumination, 6 | 7);
        let passing = if is_glass && opacity == 1.0 { 1.0 } else { 1.0 - opacity };
        let covering = (1.0 - passing) * (1.0 - metallic);

        // A colour without an image is checked when the scene is built.
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
                context.warn(&written.at, message);
            }
        }
        let mut color = |constant: [f32; 3], map: Option<&Map>, scale: f32, scene: &mut Scene| {
            let constant = constant.map(|value| value * scale);
            let picture = map.filter(|_| scale > 0.0).and_then(|map| {
                let tint = if constant == BLACK { [scale; 3] } else { constant };
                self.texture(map, tint, library, context, scene)
            });
            picture.unwrap_or(Color::Value(constant))
        };
        let mut diffuse = color(kd, written.diffuse_map.as_ref(), covering, scene);
        if let (true, Color::Value(_)) = (colored && written.diffuse_map.is_none(), diffuse) {
            let tint = if kd == BLACK { WHITE } else { kd }.map(|value| value * covering);
            diffuse = push_texture(scene, &name, &written.at, TextureKind::VertexColor { tint });
        }
        let ks = written.specular.unwrap_or(BLACK);
        let shininess = written.shininess.unwrap_or(0.0);
        let has_highlight = illumination >= 2 && shininess > 0.0;
        let specular_map = written.specular_map.as_ref();
        let mut specular = if has_highlight { color(ks, specular_map, 1.0, scene) } else { Color::BLACK };
        let mut mirror = match illumination {
            3..=7 => color(ks, specular_map, 1.0, scene),
            _ => Color::BLACK,
        };
        let filter = written.filter.filter(|&filter| filter != BLACK).unwrap_or(WHITE);
        let mut whitted = Whitted {
            diffuse,
            shininess,
            transmission: Color::Value(filter.map(|value| value.min(1.0) * passing)),
            ior: match (written.ior, illumination) {
                (Some(ior), 4..=9) if ior > 0.0 => ior,
                (_, 4 | 5 | 6 | 7 | 9) => 1.5,
                _ => 1.0,
            },
            ..Whitted::default()
        };
        // Many programs write `Ni 1` everywhere, which would leave no reflection.
        whitted.fresnel = illumination == 7 || (illumination == 5 && whitted.ior != 1.0);
        if whitted.fresnel && passing > 0.0 {
            // Fresnel's equations distribute all light between reflection and transmission.
            mirror = Color::Value(if ks == BLACK { WHITE } else { ks });
        }
        if metallic > 0.0 {
            let roughness = written.roughness.unwrap_or(0.5).clamp(0.0, 1.0);
            let clear = (1.0 - roughness) * (1.0 - roughness);
            mirror = color(kd, written.diffuse_map.as_ref(), metallic * clear, scene);
            specular = color(kd, written.diffuse_map.as_ref(), metallic * (1.0 - clear), scene);
            // The exponent with a highlight as wide as this roughness (Walter et al. 2007: α = roughness²).
            let alpha = (roughness * roughness).max(0.01);
            whitted.shininess = (2.0 / (alpha * alpha) - 2.0).max(1.0);
        }
        whitted.mirror = mirror;
        whitted.specular = specular;

        let ke = written.emission.unwrap_or(BLACK);
        let shines = ke != BLACK || (written.emission_map.is_some() && written.emission.is_none());
        let emission = shines.then(|| {
            let radiance = color(ke, written.emission_map.as_ref(), 1.0, scene);
            Emission::new(radiance, true)
        });
        let emission = emission.filter(|emission| emission.radiance != Color::BLACK);
        Look { material: Some(push_material(scene, &name, &written.at, whitted)), emission }
    }

    /// The texture of a map with its texels multiplied by `tint`; `None`, with a warning, if it cannot be read.
    fn texture(
        &mut self,
        map: &Map,
        tint: [f32; 3],
        library: &Path,
        context: &mut LoadContext<'_>,
        scene: &mut Scene,
    ) -> Option<Color> {
        let key = (beside(library, &map.file), tint.map(f32::to_bits));
        let image = match self.images.get(&key) {
            Some(image) => *image,
            None => {
                let image = match self.read_tinted(&map.file, tint, library, context) {
                    Ok(image) => Some(push_image(scene, image)),
                    Err(why) => {
                        let message = format!("texture `{}`: {why}; the constant colour is used", map.file);
                        context.warn(&map.at, message);
                        None
                    }
                };
                self.images.insert(key, image);
                image
            }
        }?;
        let wrap = if map.clamp { Wrap::Black } else { Wrap::Repeat };
        let kind = picture(image, map.scale, map.offset, wrap);
        Some(push_texture(scene, &map.file, &map.at, kind))
    }

    /// Reads an image and multiplies its texels by `tint`. One image with many tints must not exhaust the memory: all images
    /// together have at most as many texels as one image may have.
    fn read_tinted(
        &mut self,
        name: &str,
        tint: [f32; 3],
        library: &Path,
        context: &mut LoadContext<'_>,
    ) -> std::result::Result<Image, String> {
        let left = context.limits.texels.saturating_sub(self.texels);
        let limit = context.limits.texels;
        let too_many = || format!("the pictures of this model have more than {limit} texels");
        if left == 0 {
            return Err(too_many());
        }
        let image = read_image(library, name, context).map_err(|error| error.message)?;
        if image.len() as u64 > left {
            return Err(too_many());
        }
        self.texels += image.len() as u64;
        Ok(if tint == WHITE { image } else { image.tinted(tint) })
    }
}
