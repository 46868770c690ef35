//! The material "openpbr": the parameters of OpenPBR 1.1, by the specification's names.

use super::Reader;
use super::color::plain_color;
use super::table::Table;
use super::value::Value;
use crate::light::Power;
use crate::material::{
    BumpMapping, Color, Material, MaterialKind, OpenPbr, Roughness, Scalar, Subsurface, SubsurfaceMedium,
    Tangent,
};
use crate::medium::{Extinction, Medium};
use crate::scene::{MaterialId, MediumId, TextureId};
use crate::shape::Emission;
use crate::texture::TextureKind;

/// The keys of the type.
pub(super) const KEYS: &[&str] = &[
    "base_weight",
    "base_color",
    "base_diffuse_roughness",
    "base_metalness",
    "specular_weight",
    "specular_color",
    "specular_roughness",
    "specular_roughness_anisotropy",
    "specular_ior",
    "transmission_weight",
    "transmission_color",
    "transmission_depth",
    "transmission_scatter",
    "transmission_scatter_anisotropy",
    "transmission_dispersion_scale",
    "transmission_dispersion_abbe_number",
    "dispersion",
    "subsurface_weight",
    "subsurface_color",
    "subsurface_radius",
    "subsurface_radius_scale",
    "subsurface_scatter_anisotropy",
    "coat_weight",
    "coat_color",
    "coat_roughness",
    "coat_roughness_anisotropy",
    "coat_ior",
    "coat_darkening",
    "fuzz_weight",
    "fuzz_color",
    "fuzz_roughness",
    "emission_luminance",
    "emission_color",
    "thin_film_weight",
    "thin_film_thickness",
    "thin_film_ior",
    "geometry_opacity",
    "geometry_thin_walled",
    "geometry_normal",
    "geometry_coat_normal",
    "geometry_tangent",
    "geometry_coat_tangent",
];

/// The largest asymmetry of a medium: at 1 light would not be scattered.
const GREATEST_G: f32 = 0.99;

/// The parts of a material's table, but emission and opacity.
pub(super) struct Read {
    pub(super) kind: MaterialKind,
    /// The medium inside.
    pub(super) medium: Option<MediumId>,
    /// The normals of the base.
    pub(super) normals: Option<BumpMapping>,
}

impl Reader<'_, '_> {
    pub(super) fn open_pbr(&mut self, table: &Table<'_>, id: MaterialId) -> Read {
        table.one_of(&["geometry_normal", "normal_map", "bump"]);
        table.one_of(&["emission_luminance", "emission"]);
        let mut look = self.surface(table);
        let medium = self.medium_inside(table, &mut look);
        self.emission_of(table, id);
        if table.has("geometry_opacity") {
            let opacity = self.share_or(table, "geometry_opacity", 1.0);
            self.opacities.insert(id, opacity);
        }
        let normals =
            table.maybe("geometry_normal", |value| self.normals(value)).map(BumpMapping::NormalTexture);
        let kind = self.with_subsurface(table, look, id, normals);
        Read { kind, medium, normals }
    }

    /// The surface, its textures and numbers.
    fn surface(&mut self, table: &Table<'_>) -> OpenPbr {
        let usual = OpenPbr::default();
        let index = |key, default| {
            table.or(key, default, |value| value.single_where("a number greater than 0", |ior| ior > 0.0))
        };
        let scale = table.or("transmission_dispersion_scale", 0.0, |value| {
            value.single_where("a number from 0 to 1", |share| (0.0..=1.0).contains(&share))
        });
        let abbe = table.or("transmission_dispersion_abbe_number", OpenPbr::ABBE_NUMBER, |value| {
            value.single_where("a number greater than 0", |number| number > 0.0)
        });
        for key in ["transmission_dispersion_scale", "transmission_dispersion_abbe_number"] {
            table.one_of(&["dispersion", key]);
        }
        let dispersion = table.maybe("dispersion", |value| {
            value.single_where("a number of at least 0", |dispersion| dispersion >= 0.0)
        });
        let (specular_ior, coat_ior, thin_film_ior) = (
            index("specular_ior", usual.specular_ior),
            index("coat_ior", usual.coat_ior),
            index("thin_film_ior", usual.thin_film_ior),
        );
        let specular_weight = table.or("specular_weight", usual.specular_weight, |value| {
            self.scalar_where(value, "a number of at least 0", |weight| weight >= 0.0)
        });
        let thin_film_thickness = table.or("thin_film_thickness", usual.thin_film_thickness, |value| {
            self.scalar_where(value, "a thickness in micrometres", |thickness| thickness >= 0.0)
        });
        OpenPbr {
            base_weight: self.share_or(table, "base_weight", 1.0),
            base_color: self.color_or(table, "base_color", 0.8),
            base_diffuse_roughness: self.share_or(table, "base_diffuse_roughness", 0.0),
            base_metalness: self.share_or(table, "base_metalness", 0.0),
            specular_weight,
            specular_color: self.color_or(table, "specular_color", 1.0),
            specular_roughness: self.share_or(table, "specular_roughness", 0.3),
            specular_roughness_anisotropy: self.share_or(table, "specular_roughness_anisotropy", 0.0),
            specular_ior,
            transmission_weight: self.share_or(table, "transmission_weight", 0.0),
            transmission_color: self.color_or(table, "transmission_color", 1.0),
            dispersion: dispersion.unwrap_or(20.0 * scale / abbe),
            subsurface_weight: self.share_or(table, "subsurface_weight", 0.0),
            subsurface_color: self.color_or(table, "subsurface_color", 0.8),
            subsurface_scatter_anisotropy: asymmetry(table, "subsurface_scatter_anisotropy"),
            coat_weight: self.share_or(table, "coat_weight", 0.0),
            coat_color: self.color_or(table, "coat_color", 1.0),
            coat_roughness: self.share_or(table, "coat_roughness", 0.0),
            coat_roughness_anisotropy: self.share_or(table, "coat_roughness_anisotropy", 0.0),
            coat_ior,
            coat_darkening: self.share_or(table, "coat_darkening", 1.0),
            fuzz_weight: self.share_or(table, "fuzz_weight", 0.0),
            fuzz_color: self.color_or(table, "fuzz_color", 1.0),
            fuzz_roughness: self.share_or(table, "fuzz_roughness", 0.5),
            thin_film_weight: self.share_or(table, "thin_film_weight", 0.0),
            thin_film_thickness,
            thin_film_ior,
            geometry_thin_walled: table.or("geometry_thin_walled", false, Value::boolean),
            geometry_coat_normal: table.maybe("geometry_coat_normal", |value| self.normals(value)),
            geometry_tangent: self.tangent(table, "geometry_tangent"),
            geometry_coat_tangent: self.tangent(table, "geometry_coat_tangent"),
        }
    }

    /// A direction along u and v, or a texture of such.
    fn tangent(&mut self, table: &Table<'_>, key: &str) -> Tangent {
        table.or(key, Tangent::U, |value| {
            if !value.is_list() {
                return match self.color(value)? {
                    Color::Texture(id) => Ok(Tangent::Texture(id)),
                    _ => Err(value.wrong("a direction [u, v], or a texture of directions")),
                };
            }
            let direction: [f32; 2] = value.singles("a direction [u, v]")?;
            match direction == [0.0; 2] {
                true => Err(value.wrong("a direction [u, v] other than [0, 0]")),
                false => Ok(Tangent::Value(direction)),
            }
        })
    }

    /// The medium of `transmission_depth`, which then has the colour of transmitted light.
    fn medium_inside(&mut self, table: &Table<'_>, look: &mut OpenPbr) -> Option<MediumId> {
        let depth = table.or("transmission_depth", 0.0, |value| {
            value.single_where("a length of at least 0", |depth| depth >= 0.0)
        });
        let scatter = table.or("transmission_scatter", [0.0; 3], plain_color);
        let g = asymmetry(table, "transmission_scatter_anisotropy");
        if !look.is_body() && table.has("transmission_depth") {
            self.ineffective(table, "transmission_depth", "`transmission_weight`, and a body");
        }
        if !(depth > 0.0) {
            if scatter != [0.0; 3] {
                self.ineffective(table, "transmission_scatter", "`transmission_depth`");
            }
            return None;
        }
        if table.has("medium") {
            table.one_of(&["transmission_depth", "medium"]);
            return None;
        }
        let Color::Value(color) = look.transmission_color else {
            let message =
                "`transmission_color` varies; with a `transmission_depth` it is the colour of a medium";
            let error = table.error_at("transmission_color", message);
            table.note(error.hint("give it a constant colour, or leave out `transmission_depth`"));
            return None;
        };
        if !look.is_body() {
            return None;
        }
        look.transmission_color = Color::gray(1.0);
        let [absorption, scattering] = OpenPbr::medium(color, depth, scatter);
        if absorption == [0.0; 3] && scattering == [0.0; 3] {
            return None;
        }
        let id = MediumId(self.scene.media.len() as u32);
        self.scene.media.push(Medium {
            extinction: Extinction::Parts {
                absorption: Color::Value(absorption),
                scattering: Color::Value(scattering),
            },
            g: g.clamp(-GREATEST_G, GREATEST_G),
            ..Medium::clear(format!("inside of the material at {}", table.at()), table.at())
        });
        Some(id)
    }

    /// Emission: a luminance of 1 is the radiance of white.
    fn emission_of(&mut self, table: &Table<'_>, id: MaterialId) {
        let luminance = table.or("emission_luminance", 0.0, |value| {
            value.single_where("a luminance of at least 0", |luminance| luminance >= 0.0)
        });
        let (radiance, scale) =
            table.or("emission_color", (Color::gray(1.0), 1.0), |value| self.light_color(value, true));
        if table.has("emission_color") && !table.has("emission_luminance") {
            self.ineffective(table, "emission_color", "`emission_luminance`");
        }
        if luminance > 0.0 && table.has("coat_color") {
            let at = table.find("coat_color").map_or_else(|| table.at(), Value::at);
            self.context.warn(&at, "the coat does not colour the light that the surface emits");
        }
        if luminance > 0.0 {
            let power = Power { scale: scale * luminance, ..Power::AS_WRITTEN };
            self.glows.insert(id, Emission { radiance, power, two_sided: false });
        }
    }

    /// The surface, or where light is scattered below it the material that does so, or a mix of both.
    fn with_subsurface(
        &mut self,
        table: &Table<'_>,
        look: OpenPbr,
        id: MaterialId,
        normals: Option<BumpMapping>,
    ) -> MaterialKind {
        let radius = table.or("subsurface_radius", 1.0, |value| {
            value.single_where("a length of at least 0", |radius| radius >= 0.0)
        });
        let [r, g, b] = OpenPbr::RADIUS_SCALE;
        let scale = table.or("subsurface_radius_scale", Color::Value([r, g, b]), |value| self.color(value));
        let none = Scalar::Value(0.0);
        let surface = |look: OpenPbr| MaterialKind::OpenPbr(Box::new(look));
        if look.subsurface_weight == none || look.geometry_thin_walled || radius == 0.0 {
            return surface(look);
        }
        let above = [
            ("base_metalness", look.base_metalness),
            ("transmission_weight", look.transmission_weight),
            ("coat_weight", look.coat_weight),
            ("fuzz_weight", look.fuzz_weight),
            ("thin_film_weight", look.thin_film_weight),
        ];
        if let Some((key, _)) = above.into_iter().find(|(_, weight)| *weight != none) {
            let at = table.find(key).map_or_else(|| table.at(), Value::at);
            let message = format!(
                "with `{key}`, `subsurface_weight` has the colour of light scattered below the surface, not its depth: it is taken for diffuse"
            );
            self.context.warn(&at, message);
            return surface(look);
        }
        let mean_free_path = match scale {
            Color::Value(scale) => Color::Value(scale.map(|lane| lane * radius)),
            color => Color::Texture(self.scaled(table, color, radius)),
        };
        let roughness = self.alphas(table, &look);
        let below = MaterialKind::Subsurface(Box::new(Subsurface {
            medium: SubsurfaceMedium::Reflectance { reflectance: look.subsurface_color, mean_free_path },
            scale: 1.0,
            g: look.subsurface_scatter_anisotropy.clamp(-GREATEST_G, GREATEST_G),
            eta: look.specular_ior,
            roughness,
        }));
        if look.subsurface_weight == Scalar::Value(1.0) {
            return below;
        }
        let amount = look.subsurface_weight;
        let above = surface(OpenPbr { subsurface_weight: none, ..look });
        let materials = [(above, "surface"), (below, "inside")].map(|(kind, part)| {
            let name = format!("{} ({part})", self.scene.materials[id.index()].name);
            let bump_mapping = normals.unwrap_or_else(|| self.bump_mapping(table));
            let part = MaterialId(self.scene.materials.len() as u32);
            self.scene.materials.push(Material { bump_mapping, ..Material::new(name, table.at(), kind) });
            part
        });
        MaterialKind::Mix { materials, amount }
    }

    /// A texture times a number.
    fn scaled(&mut self, table: &Table<'_>, color: Color, by: f32) -> TextureId {
        let name = format!("mean free path at {}", table.at());
        let kind = TextureKind::Scale { color, by: Scalar::Value(by) };
        self.scene.textures.push(crate::texture::Texture { name, at: table.at(), kind });
        TextureId(self.scene.textures.len() as u32 - 1)
    }

    /// α along and across the grain; a roughness that varies is the same in all directions.
    fn alphas(&mut self, table: &Table<'_>, look: &OpenPbr) -> Roughness {
        let [u, v] = match (look.specular_roughness, look.specular_roughness_anisotropy) {
            (Scalar::Value(roughness), Scalar::Value(anisotropy)) => {
                OpenPbr::alphas(roughness, anisotropy).map(Scalar::Value)
            }
            (Scalar::Value(roughness), Scalar::Texture(_)) => [Scalar::Value(roughness * roughness); 2],
            (Scalar::Texture(id), _) => match table.find("specular_roughness") {
                Some(value) => [self.squared(value, id); 2],
                None => [Scalar::Texture(id); 2],
            },
        };
        Roughness::of_alphas(u, v)
    }
}

/// A mean cosine of scattering.
fn asymmetry(table: &Table<'_>, key: &str) -> f32 {
    table.or(key, 0.0, |value| value.single_where("a number from -1 to 1", |g| (-1.0..=1.0).contains(&g)))
}
