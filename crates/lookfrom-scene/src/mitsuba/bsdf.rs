//! BSDFs, with their opacity.

use std::rc::Rc;

use super::Reader;
use super::plugin::{Plugin, Property, Value};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{
    Anisotropy, BumpMapping, Color, Distribution, Energy, Ior, Masking, Material, MaterialKind, Metal,
    Microfacets, NormalTexture, Plastic, Principled, Roughness, Scalar,
};
use crate::scene::MaterialId;
use crate::spectrum;
use crate::texture::TextureKind;

const KINDS: &[&str] = &[
    "blendbsdf",
    "bumpmap",
    "conductor",
    "dielectric",
    "diffuse",
    "mask",
    "normalmap",
    "null",
    "plastic",
    "principled",
    "roughconductor",
    "roughdielectric",
    "roughplastic",
    "thindielectric",
    "twosided",
];

/// Indices of refraction by Mitsuba's names of materials (CRC Handbook of Chemistry and Physics; data sheets of glasses).
const INDICES: &[(&str, f64)] = &[
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water ice", 1.31),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("fused quartz", 1.458),
    ("carbon tetrachloride", 1.461),
    ("pyrex", 1.47),
    ("glycerol", 1.4729),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("benzene", 1.501),
    ("bk7", 1.5046),
    ("silicone oil", 1.520_45),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("bromine", 1.661),
    ("diamond", 2.419),
];

/// A material with what belongs to shapes here.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    pub(super) material: MaterialId,
    pub(super) alpha: Option<Scalar>,
    /// Whether it is black from behind in Mitsuba.
    pub(super) is_one_sided: bool,
}

impl Surface {
    pub(super) fn opaque(material: MaterialId) -> Self {
        Self { material, alpha: None, is_one_sided: true }
    }
}

impl Reader<'_, '_> {
    /// The surface of a BSDF.
    pub(super) fn surface(&mut self, plugin: &Rc<Plugin>) -> Result<Surface> {
        if let Some(&surface) = self.surfaces.get(&Rc::as_ptr(plugin)) {
            return Ok(surface);
        }
        let surface = self.within(plugin, |reader| match &*plugin.kind {
            "twosided" => {
                let surface = reader.nested(plugin)?;
                Ok(Surface { is_one_sided: false, ..surface })
            }
            "mask" => {
                let surface = reader.nested(plugin)?;
                if surface.alpha.is_some() {
                    let message = "a mask in a mask is not supported";
                    return Err(Error::new(ErrorKind::Unsupported, &plugin.at, message));
                }
                Ok(Surface { alpha: Some(reader.scalar(plugin, "opacity", 0.5)?), ..surface })
            }
            "bumpmap" | "normalmap" => reader.mapped(plugin),
            _ => {
                let kind = reader.kind(plugin)?;
                let transmits = matches!(
                    kind,
                    MaterialKind::Dielectric { .. }
                        | MaterialKind::ThinDielectric { .. }
                        | MaterialKind::Interface
                );
                let material = reader.push_material(plugin, kind);
                Ok(Surface { is_one_sided: !transmits, ..Surface::opaque(material) })
            }
        })?;
        self.surfaces.insert(Rc::as_ptr(plugin), surface);
        Ok(surface)
    }

    fn push_material(&mut self, plugin: &Plugin, kind: MaterialKind) -> MaterialId {
        let id = MaterialId(self.scene.materials.len() as u32);
        let name = plugin.id.clone().unwrap_or_else(|| format!("{} {}", plugin.kind, id.0));
        self.scene.materials.push(Material::new(name, plugin.at.clone(), kind));
        id
    }

    /// The surface of the only BSDF in another one.
    fn nested(&mut self, plugin: &Plugin) -> Result<Surface> {
        let parts = plugin.parts("bsdf", &self.ids)?;
        match &parts[..] {
            [(_, inner)] => self.surface(&inner.clone()),
            [] => Err(Error::invalid(&plugin.at, format!("the {} has no bsdf in it", plugin.title()))),
            _ => {
                let message = format!("a {} with several bsdfs is not supported", plugin.title());
                Err(Error::new(ErrorKind::Unsupported, &plugin.at, message))
            }
        }
    }

    /// A BSDF under a bump map or a normal map.
    fn mapped(&mut self, plugin: &Plugin) -> Result<Surface> {
        let bump_mapping = if plugin.kind == "normalmap" {
            let property = plugin.find("normalmap").ok_or_else(|| plugin.refuse("normalmap", "a texture"))?;
            let map = property.plugin(&self.ids)?.ok_or_else(|| property.wrong("a texture"))?;
            if is_straight(&map) {
                BumpMapping::None
            } else {
                BumpMapping::NormalTexture(NormalTexture { texture: self.texture(&map)?, scale: 1.0 })
            }
        } else {
            let texture = plugin.part("texture", &self.ids)?;
            let texture = texture.ok_or_else(|| Error::invalid(&plugin.at, "this bumpmap has no texture"))?;
            let texture = self.texture(&texture)?;
            let scale = plugin.float("scale", 1.0)? as f32;
            let kind = TextureKind::Scale { color: Color::Texture(texture), by: Scalar::Value(scale) };
            BumpMapping::Bump(Scalar::Texture(self.push_texture(plugin, kind)))
        };
        let inner = self.nested(plugin)?;
        let material = self.scene.materials[inner.material.index()].clone();
        if material.bump_mapping != BumpMapping::None || matches!(material.kind, MaterialKind::Mix { .. }) {
            let message = format!("a {} over another map or a blendbsdf is not supported", plugin.title());
            return Err(Error::new(ErrorKind::Unsupported, &plugin.at, message));
        }
        let id = self.push_material(plugin, material.kind);
        self.scene.materials[id.index()].bump_mapping = bump_mapping;
        Ok(Surface { material: id, ..inner })
    }

    fn kind(&mut self, plugin: &Plugin) -> Result<MaterialKind> {
        Ok(match &*plugin.kind {
            "diffuse" => MaterialKind::Diffuse { reflectance: self.reflectance(plugin, "reflectance", 0.5)? },
            "null" => MaterialKind::Interface,
            "conductor" => MaterialKind::Conductor {
                metal: self.metal(plugin)?,
                roughness: SMOOTH,
                energy: Energy::SingleScattering,
            },
            "roughconductor" => MaterialKind::Conductor {
                metal: self.metal(plugin)?,
                roughness: self.roughness(plugin)?,
                energy: Energy::SingleScattering,
            },
            "dielectric" => MaterialKind::Dielectric {
                eta: index(plugin, "bk7")?,
                roughness: SMOOTH,
                energy: Energy::SingleScattering,
            },
            "roughdielectric" => MaterialKind::Dielectric {
                eta: index(plugin, "bk7")?,
                roughness: self.roughness(plugin)?,
                energy: Energy::SingleScattering,
            },
            "thindielectric" => MaterialKind::ThinDielectric { eta: index(plugin, "bk7")? },
            "plastic" | "roughplastic" => MaterialKind::Plastic(Box::new(self.plastic(plugin)?)),
            "blendbsdf" => {
                let amount = self.scalar(plugin, "weight", 0.5)?;
                let parts = plugin.parts("bsdf", &self.ids)?;
                let [(_, first), (_, second)] = &parts[..] else {
                    let message = format!("a blendbsdf has two bsdfs in it, this one has {}", parts.len());
                    return Err(Error::invalid(&plugin.at, message));
                };
                let surfaces = [self.surface(first)?, self.surface(second)?];
                if surfaces.iter().any(|surface| surface.alpha.is_some()) {
                    let message = "a mask in a blendbsdf is not supported";
                    return Err(Error::new(ErrorKind::Unsupported, &plugin.at, message)
                        .hint("write the mask around it"));
                }
                MaterialKind::Mix { materials: surfaces.map(|surface| surface.material), amount }
            }
            "principled" => self.principled(plugin)?,
            _ => return Err(plugin.unsupported(KINDS)),
        })
    }

    fn metal(&mut self, plugin: &Plugin) -> Result<Metal> {
        let name = plugin.string("material")?;
        match name {
            Some("none") => return Ok(Metal::Reflectance(Color::gray(1.0))),
            None if plugin.find("eta").is_none() && plugin.find("k").is_none() => {
                return Ok(Metal::Reflectance(Color::gray(1.0)));
            }
            None => {
                return Ok(Metal::Indices {
                    eta: self.color(plugin, "eta", 0.0)?,
                    k: self.color(plugin, "k", 1.0)?,
                });
            }
            Some(_) => {}
        }
        let name = name.unwrap_or_default();
        let curves = ["eta", "k"].map(|part| spectrum::named(&format!("metal-{name}-{part}")));
        let [Some(eta), Some(k)] = curves else {
            let at = plugin.find("material").map_or(&plugin.at, |property| &property.at);
            let message = format!("the metal {name:?} is not supported");
            let known: Vec<&str> = spectrum::names()
                .filter_map(|name| name.strip_prefix("metal-")?.strip_suffix("-eta"))
                .collect();
            let hint = format!("there are: {}, or give `eta` and `k`", known.join(", "));
            return Err(Error::new(ErrorKind::Unsupported, at, message).hint(hint));
        };
        Ok(Metal::Indices { eta: Color::Curve(self.push_curve(eta)), k: Color::Curve(self.push_curve(k)) })
    }

    /// The roughness α of a BSDF.
    fn roughness(&mut self, plugin: &Plugin) -> Result<Roughness> {
        let microfacets = microfacets(plugin)?;
        let both = self.scalar(plugin, "alpha", 0.1)?;
        let mut along = |name: &str| match plugin.find(name) {
            Some(_) => self.scalar(plugin, name, 0.1),
            None => Ok(both),
        };
        Ok(Roughness { microfacets, ..Roughness::of_alphas(along("alpha_u")?, along("alpha_v")?) })
    }

    fn plastic(&mut self, plugin: &Plugin) -> Result<Plastic> {
        let is_rough = plugin.kind == "roughplastic";
        let alpha = match is_rough {
            true => plugin.float_where("alpha", 0.1, "a number of at least 0", |alpha| alpha >= 0.0)?,
            false => 0.0,
        };
        Ok(Plastic {
            reflectance: self.reflectance(plugin, "diffuse_reflectance", 0.5)?,
            specular_reflectance: self.reflectance(plugin, "specular_reflectance", 1.0)?,
            eta: eta(plugin, "polypropylene")? as f32,
            alpha: alpha as f32,
            microfacets: if is_rough { microfacets(plugin)? } else { Microfacets::default() },
            is_nonlinear: plugin.boolean("nonlinear", false)?,
        })
    }

    fn principled(&mut self, plugin: &Plugin) -> Result<MaterialKind> {
        let message =
            "principled is approximated by the layers of glTF's materials, which are not quite Disney's";
        self.warn_once(&plugin.at, message);
        let share = |name: &str, default: f64| {
            plugin.float_where(name, default, "a number from 0 to 1", |value| (0.0..=1.0).contains(&value))
        };
        let ior = match plugin.float_or_none("eta")? {
            Some(_) => plugin.positive("eta", 1.5)?,
            None => {
                // The index of refraction whose reflectance at normal incidence is 8 % of `specular`.
                let root = (0.08 * share("specular", 0.5)?).sqrt();
                (1.0 + root) / (1.0 - root)
            }
        };
        let base_color = self.reflectance(plugin, "base_color", 0.5)?;
        let sheen_color = match self.scalar(plugin, "sheen", 0.0)? {
            Scalar::Value(value) => Color::gray(value),
            Scalar::Texture(id) => Color::Texture(id),
        };
        // α of the coat from 0.1 to 0.001; its square root is the roughness.
        let gloss = share("clearcoat_gloss", 0.0)?;
        let clearcoat_roughness = (0.1 + (0.001 - 0.1) * gloss).sqrt() as f32;
        let strength = match plugin.find("anisotropic") {
            None => 0.0,
            Some(Property { value: Value::Float(_) | Value::Integer(_), .. }) => share("anisotropic", 0.0)?,
            Some(_) => {
                self.warn_once(
                    &plugin.at,
                    "a texture of `anisotropic` is not supported: the highlight is round",
                );
                0.0
            }
        };
        let anisotropy = Anisotropy { strength: strength as f32, rotation: 0.0, texture: None };
        Ok(MaterialKind::Principled(Box::new(Principled {
            base_color,
            metallic: self.scalar(plugin, "metallic", 0.0)?,
            roughness: self.scalar(plugin, "roughness", 0.5)?,
            anisotropy: (strength > 0.0).then_some(anisotropy),
            ior: ior as f32,
            transmission: self.scalar(plugin, "spec_trans", 0.0)?,
            is_solid: plugin.find("spec_trans").is_some(),
            clearcoat: self.scalar(plugin, "clearcoat", 0.0)?,
            clearcoat_roughness: Scalar::Value(clearcoat_roughness),
            sheen_color,
            sheen_roughness: Scalar::Value(0.5),
            ..Principled::default()
        })))
    }
}

const SMOOTH: Roughness = Roughness::SMOOTH;

/// Whether a normal map leaves normals as they are.
fn is_straight(map: &Plugin) -> bool {
    let value = map.find("value").map(|property| &property.value);
    map.kind == "rawconstant"
        && match value {
            Some(Value::Vector(vector)) => vector.to_array() == [0.5, 0.5, 1.0],
            Some(Value::Color(rgb)) => *rgb == [0.5, 0.5, 1.0],
            _ => false,
        }
}

/// The kind of microfacets of a BSDF.
fn microfacets(plugin: &Plugin) -> Result<Microfacets> {
    plugin.ignore(&["sample_visible"]);
    let distributions = [("beckmann", Distribution::Beckmann), ("ggx", Distribution::TrowbridgeReitz)];
    let distribution = plugin.choice("distribution", Distribution::Beckmann, &distributions)?;
    Ok(Microfacets { distribution, masking: Masking::Separable })
}

/// The index of refraction of the inside relative to the outside.
fn index(plugin: &Plugin, inside: &str) -> Result<Ior> {
    eta(plugin, inside).map(|eta| Ior::Value(eta as f32))
}

/// As [`index`], as a number.
fn eta(plugin: &Plugin, inside: &str) -> Result<f64> {
    let index = |name: &str, default: &str| -> Result<f64> {
        let named = |name: &str| INDICES.iter().find(|(known, _)| *known == name).map(|(_, index)| *index);
        match plugin.find(name) {
            None => Ok(named(default).unwrap_or(1.0)),
            Some(Property { value: Value::String(text), at, .. }) => named(text).ok_or_else(|| {
                super::plugin::unknown(at, "material", text, INDICES.iter().map(|(name, _)| *name))
            }),
            Some(_) => plugin.positive(name, 1.0),
        }
    };
    Ok(index("int_ior", inside)? / index("ext_ior", "air")?)
}
