//! `[materials]`: materials and their emission.

use super::color::plain_color;
use super::light::power;
use super::table::{Groups, Kinds, Table};
use super::value::Value;
use super::{Reader, disney, hair, open_pbr, principled, subsurface};
use crate::chain;
use crate::error::{Location, Result};
use crate::material::{BackFace, BumpGuard, BumpMapping, Color, Material, MaterialKind, Whitted};
use crate::scene::MaterialId;
use crate::shape::Emission;

/// The keys of materials, by type, in addition to those in [`common`].
pub(super) const KEYS: Kinds = &[
    (
        "whitted",
        &[
            "ambient",
            "diffuse",
            "specular",
            "shininess",
            "mirror",
            "transmission",
            "ior",
            "fresnel",
            "absorption",
        ],
    ),
    ("diffuse", &["reflectance"]),
    ("diffuse_transmission", &["reflectance", "transmittance", "scale"]),
    (
        "conductor",
        &[
            "metal",
            "eta",
            "k",
            "illuminant",
            "reflectance",
            "specular_reflectance",
            "roughness",
            "distribution",
            "masking",
            "energy",
        ],
    ),
    (
        "dielectric",
        &[
            "ior",
            "roughness",
            "distribution",
            "masking",
            "energy",
            "specular_reflectance",
            "specular_transmittance",
        ],
    ),
    ("thin_dielectric", &["ior", "specular_reflectance", "specular_transmittance"]),
    ("coated_diffuse", &["reflectance", "roughness", "ior"]),
    (
        "coated_conductor",
        &["metal", "eta", "k", "illuminant", "reflectance", "base_roughness", "roughness", "ior"],
    ),
    (
        "plastic",
        &["reflectance", "specular_reflectance", "nonlinear", "ior", "roughness", "distribution", "masking"],
    ),
    ("subsurface", subsurface::KEYS),
    ("hair", hair::KEYS),
    ("measured", &["file"]),
    ("principled", principled::KEYS),
    ("openpbr", open_pbr::KEYS),
    ("disney", disney::KEYS),
    ("unlit", &["color"]),
    ("mix", &["materials", "amount"]),
    ("shadow_catcher", &["normal"]),
    ("interface", &[]),
];
/// Keys of all materials.
pub(super) const COMMON: &[&str] =
    &["type", "medium", "emission", "power", "two_sided", "back_face", "bump_guard"];
/// Keys of all materials with a surface of their own.
const BUMPS: &[&str] = &["normal_map", "bump"];
/// Keys of materials under a coat with light between its interfaces.
const COAT: &[&str] = &["thickness", "coat_albedo", "g", "coat_depth", "coat_samples", "coat_estimate"];

/// The keys of a type that others have, too.
pub(super) fn common(kind: &str) -> Groups {
    match kind {
        "unlit" | "mix" | "shadow_catcher" | "interface" => &[COMMON],
        "coated_diffuse" | "coated_conductor" => &[COMMON, COAT, BUMPS],
        _ => &[COMMON, BUMPS],
    }
}

/// Looks from behind.
pub(super) const BACK_FACES: &[(&str, BackFace)] = &[("black", BackFace::Black)];

/// The default material of shapes.
pub(super) const DEFAULT: &str = "default";

impl Reader<'_, '_> {
    /// Reads `[materials]`: all names first, so that a mix may use materials that are defined later.
    pub(super) fn read_materials(&mut self, value: Value<'_>) {
        self.knows_all_names &= value.is_table();
        let mut read = Vec::new();
        for entry in value.named("[materials]") {
            let name = entry.key();
            let kind = MaterialKind::Whitted(Whitted::default());
            let material = Material::new(name, entry.at(), kind);
            // The default may have been used before its definition.
            let id = match self.materials.get(name) {
                Some(&id) if Some(id) == self.unwritten_default => {
                    self.scene.materials[id.index()] = material;
                    self.unwritten_default = None;
                    id
                }
                Some(id) => {
                    entry.note(super::twice(entry, "material", &self.scene.materials[id.index()].at));
                    continue;
                }
                None => self.add_material(material),
            };
            read.push((entry, id));
        }
        for &(entry, id) in &read {
            let table = entry.table(format!("[materials.{}]", entry.key()));
            if let Some(table) = entry.noting(table.map(Some), None) {
                self.read_material(&table, id);
            }
        }
        for error in chain::check(&self.scene.materials, read.iter().map(|(_, id)| id.index())) {
            value.note(error);
        }
    }

    fn read_material(&mut self, table: &Table<'_>, id: MaterialId) {
        let Some(word) = table.kind(KEYS, Some("whitted"), common) else { return };
        let of = |kind| open_pbr::Read { kind, medium: None, normals: None };
        let read = match word {
            "whitted" => of(MaterialKind::Whitted(self.whitted(table))),
            "openpbr" => self.open_pbr(table, id),
            _ => of(self.physical(word, table)),
        };
        self.scene.materials[id.index()].kind = read.kind;
        self.scene.materials[id.index()].bump_mapping =
            read.normals.unwrap_or_else(|| self.bump_mapping(table));
        self.scene.materials[id.index()].medium =
            table.maybe("medium", |value| self.medium_named(value)).or(read.medium);
        self.scene.materials[id.index()].back_face =
            table.or("back_face", BackFace::Own, |value| value.choice(BACK_FACES));
        self.scene.materials[id.index()].bump_guard = table.maybe("bump_guard", bump_guard);
        if let Some(glow) = self.emission(table) {
            self.glows.insert(id, glow);
        }
    }

    fn whitted(&mut self, table: &Table<'_>) -> Whitted {
        let default = Whitted::default();
        let mut color = |key, default| table.or(key, default, |value| self.color(value));
        let diffuse = color("diffuse", default.diffuse);
        let specular = color("specular", default.specular);
        let mirror = color("mirror", default.mirror);
        let transmission = color("transmission", default.transmission);
        let absorption = table.or("absorption", default.absorption, plain_color);
        if absorption != [0.0; 3] && transmission == Color::BLACK {
            self.ineffective(table, "absorption", "`transmission`: no light gets inside");
        }
        Whitted {
            ambient: table.maybe("ambient", |value| self.color(value)),
            diffuse,
            specular,
            shininess: table.or("shininess", default.shininess, |value| {
                value.single_where("a number of at least 0", |n| n >= 0.0)
            }),
            mirror,
            transmission,
            ior: table
                .or("ior", default.ior, |value| value.single_where("a number greater than 0", |n| n > 0.0)),
            fresnel: table.or("fresnel", default.fresnel, Value::boolean),
            absorption,
        }
    }

    /// Warns of a key that has no effect without another.
    pub(super) fn ineffective(&mut self, table: &Table<'_>, key: &str, without: &str) {
        let at = table.find(key).map_or_else(|| table.at(), Value::at);
        self.context.warn(&at, format!("`{key}` has no effect without {without}"));
    }

    pub(super) fn bump_mapping(&mut self, table: &Table<'_>) -> BumpMapping {
        table.one_of(&["normal_map", "bump"]);
        let normal_map = table.maybe("normal_map", |value| self.normal_map(value));
        let bump = table.maybe("bump", |value| self.scalar_where(value, "a number", |_| true));
        match (normal_map, bump) {
            (Some(map), _) => map,
            (None, Some(height)) => BumpMapping::Bump(height),
            (None, None) => BumpMapping::None,
        }
    }

    /// A picture of normals, or a table of a texture of them and a scale.
    fn normal_map(&mut self, value: Value<'_>) -> Result<BumpMapping> {
        if value.is_table() && value.table("normals")?.has("texture") {
            return self.normals(value).map(BumpMapping::NormalTexture);
        }
        self.image_as(value, None, true).map(BumpMapping::NormalMap)
    }

    /// `emission`, `power` and `two_sided` of a material or shape.
    pub(super) fn emission(&mut self, table: &Table<'_>) -> Option<Emission> {
        if !table.has("emission") && !table.has("power") {
            if let Some(value) = table.find("two_sided").filter(|_| !table.means(&["emission", "power"])) {
                let error =
                    value.error("`two_sided` selects the sides that emit light, but there is no `emission`");
                let remedy = "surfaces are visible from both sides anyway: leave it out, or add `emission`";
                value.note(error.hint(remedy));
            }
            return None;
        }
        let radiance = table.or("emission", (Color::gray(1.0), 1.0), |value| self.light_color(value, true));
        let power = power(table, "power", radiance.1);
        let two_sided = table.or("two_sided", false, Value::boolean);
        Some(Emission { radiance: radiance.0, power, two_sided })
    }

    pub(super) fn add_material(&mut self, material: Material) -> MaterialId {
        let id = MaterialId(self.scene.materials.len() as u32);
        self.materials.insert(material.name.clone(), id);
        self.scene.materials.push(material);
        id
    }

    /// The material with the name in `value`.
    pub(super) fn material_named(&self, value: Value<'_>) -> Result<MaterialId> {
        let name = value.text("the name of a material")?;
        self.named(&self.materials, "material", value, name)
    }

    /// The material of shapes that name none: grey with a slight highlight, unless a file defines `default`.
    pub(super) fn default_material(&mut self) -> MaterialId {
        if let Some(&id) = self.materials.get(DEFAULT) {
            return id;
        }
        let id = self.add_material(default_material());
        self.unwritten_default = Some(id);
        id
    }

    /// The black material of area lights, which reflect nothing.
    pub(super) fn black_material(&mut self) -> MaterialId {
        if let Some(id) = self.black {
            return id;
        }
        let kind = MaterialKind::Whitted(Whitted { diffuse: Color::BLACK, ..Whitted::default() });
        let id = MaterialId(self.scene.materials.len() as u32);
        self.scene.materials.push(Material::new("lamp", self.scene_file.clone(), kind));
        self.black = Some(id);
        id
    }
}

/// A table of what is done about bent normals.
fn bump_guard(value: Value<'_>) -> Result<BumpGuard> {
    let table = value.table("bump_guard")?;
    table.allow(&[&["turns", "shadows"]]);
    Ok(BumpGuard {
        turns: table.or("turns", true, Value::boolean),
        shadows: table.or("shadows", true, Value::boolean),
    })
}

/// Grey, with a slight highlight.
fn default_material() -> Material {
    let whitted = Whitted { specular: Color::gray(0.1), ..Whitted::default() };
    Material::new(DEFAULT, Location::default(), MaterialKind::Whitted(whitted))
}
