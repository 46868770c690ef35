//! `[materials]`: how surfaces look, and the light they give off.

use super::Reader;
use super::color::plain_color;
use super::value::{Table, Value};
use crate::error::Result;
use crate::material::{Color, Material, MaterialKind, Whitted};
use crate::scene::MaterialId;
use crate::shape::Emission;

/// The keys of a material.
pub(super) const KEYS: &[&str] = &[
    "type",
    "ambient",
    "diffuse",
    "specular",
    "shininess",
    "mirror",
    "transmission",
    "ior",
    "fresnel",
    "absorption",
    "emission",
    "two_sided",
];

/// What a shape without a material wears.
const DEFAULT: &str = "default";

impl Reader<'_, '_> {
    /// `[materials]`.
    pub(super) fn read_materials(&mut self, value: Value<'_>) -> Result<()> {
        for entry in value.table("[materials]")?.entries() {
            let name = entry.key();
            let table = entry.table(format!("[materials.{name}]"))?;
            table.allow(&[KEYS])?;
            let material = Material::new(name, entry.at(), self.material_kind(&table)?);
            let glow = self.emission(&table)?;
            // The default may have been needed before it was written.
            let id = match self.materials.get(name) {
                Some(&id) if Some(id) == self.unwritten_default => {
                    self.scene.materials[id.index()] = material;
                    self.unwritten_default = None;
                    id
                }
                Some(id) => {
                    return Err(super::twice(entry, "material", &self.scene.materials[id.index()].at));
                }
                None => self.add_material(material),
            };
            if let Some(glow) = glow {
                self.glows.insert(id, glow);
            }
        }
        Ok(())
    }

    fn material_kind(&mut self, table: &Table<'_>) -> Result<MaterialKind> {
        table.or("type", (), |value| value.choice(&[("whitted", ())]))?;
        let default = Whitted::default();
        Ok(MaterialKind::Whitted(Whitted {
            ambient: table.find("ambient").map(|value| self.color(value)).transpose()?,
            diffuse: self.color_or(table, "diffuse", 0.8)?,
            specular: self.color_or(table, "specular", 0.0)?,
            shininess: table.or("shininess", default.shininess, |value| {
                value.single_where("a number of at least 0", |n| n >= 0.0)
            })?,
            mirror: self.color_or(table, "mirror", 0.0)?,
            transmission: self.color_or(table, "transmission", 0.0)?,
            ior: table
                .or("ior", default.ior, |value| value.single_where("a number greater than 0", |n| n > 0.0))?,
            fresnel: table.or("fresnel", default.fresnel, Value::boolean)?,
            absorption: table.or("absorption", default.absorption, plain_color)?,
        }))
    }

    /// `emission` and `two_sided` of a material, shape or light.
    pub(super) fn emission(&mut self, table: &Table<'_>) -> Result<Option<Emission>> {
        let two_sided = table.find("two_sided");
        match (table.find("emission"), two_sided) {
            (Some(value), _) => {
                Ok(Some(Emission::new(self.color(value)?, two_sided.map_or(Ok(false), Value::boolean)?)))
            }
            (None, Some(value)) => Err(value
                .error("`two_sided` says which sides shine, but there is no `emission`")
                .hint("surfaces are seen from both sides anyway: leave it out, or add `emission`")),
            (None, None) => Ok(None),
        }
    }

    pub(super) fn add_material(&mut self, material: Material) -> MaterialId {
        let id = MaterialId(self.scene.materials.len() as u32);
        self.materials.insert(material.name.clone(), id);
        self.scene.materials.push(material);
        id
    }

    /// A material of a name that the file gives.
    pub(super) fn material_named(&self, value: Value<'_>) -> Result<MaterialId> {
        let name = value.text("the name of a material")?;
        super::named(&self.materials, "material", value, name)
    }

    /// What a shape without a material wears: grey with a slight highlight, unless a file says otherwise.
    pub(super) fn default_material(&mut self) -> MaterialId {
        if let Some(&id) = self.materials.get(DEFAULT) {
            return id;
        }
        let id = self.add_material(default_material());
        self.unwritten_default = Some(id);
        id
    }

    /// What a lamp wears: it only shines.
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

/// Grey, with a slight highlight.
pub(crate) fn default_material() -> Material {
    let whitted = Whitted { specular: Color::gray(0.1), ..Whitted::default() };
    Material::new(DEFAULT, crate::Location::default(), MaterialKind::Whitted(whitted))
}
