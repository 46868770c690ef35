//! BSDFs, with their opacity.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use super::Reader;
use super::plugin::{Plugin, Property, Value};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{
    BackFace, BumpGuard, BumpMapping, Color, Disney, Distribution, Energy, Hair, Illuminant, Ior, Masking,
    Material, MaterialKind, Metal, Microfacets, NormalTexture, Pigment, Plastic, Roughness, Scalar, Tint,
};
use crate::measured::Measured;
use crate::scene::MaterialId;
use crate::spectrum;
use crate::texture::TextureKind;

const KINDS: &[&str] = &[
    "blendbsdf",
    "bumpmap",
    "conductor",
    "dielectric",
    "diffuse",
    "hair",
    "mask",
    "measured",
    "normalmap",
    "null",
    "plastic",
    "principled",
    "principledthin",
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
}

impl Surface {
    pub(super) fn opaque(material: MaterialId) -> Self {
        Self { material, alpha: None }
    }
}

impl Reader<'_, '_> {
    /// The surface of a BSDF.
    pub(super) fn surface(&mut self, plugin: &Rc<Plugin>) -> Result<Surface> {
        let key = (Rc::as_ptr(plugin), self.is_two_sided);
        if let Some(&surface) = self.surfaces.get(&key) {
            return Ok(surface);
        }
        let surface = self.within(plugin, |reader| match &*plugin.kind {
            "twosided" => {
                let outside = std::mem::replace(&mut reader.is_two_sided, true);
                let surface = reader.two_sided(plugin);
                reader.is_two_sided = outside;
                surface
            }
            "mask" => {
                let surface = reader.nested(plugin)?;
                let opacity = reader.scalar(plugin, "opacity", 0.5)?;
                let alpha = match surface.alpha {
                    None => opacity,
                    Some(inner) => reader.number(plugin, TextureKind::product(opacity, inner)),
                };
                Ok(Surface { alpha: Some(alpha), ..surface })
            }
            "bumpmap" | "normalmap" => reader.mapped(plugin),
            "blendbsdf" => {
                let amount = reader.scalar(plugin, "weight", 0.5)?;
                let [first, second] = plugin.two_parts("bsdf", &reader.ids)?;
                reader.blend(plugin, [&first, &second], amount)
            }
            _ => {
                let kind = reader.kind(plugin)?;
                let back_face = reader.back_face_of(&kind);
                let id = reader.push_material(plugin, kind);
                reader.scene.materials[id.index()].back_face = back_face;
                Ok(Surface::opaque(id))
            }
        })?;
        self.surfaces.insert(key, surface);
        Ok(surface)
    }

    /// The look from behind of a material here: opaque ones are black without `twosided`.
    fn back_face_of(&self, kind: &MaterialKind) -> BackFace {
        let is_opaque = match kind {
            MaterialKind::Diffuse { .. }
            | MaterialKind::Conductor { .. }
            | MaterialKind::Plastic(_)
            | MaterialKind::Measured(_) => true,
            MaterialKind::Disney(look) => !look.is_thin && look.spec_trans == Scalar::Value(0.0),
            _ => false,
        };
        if is_opaque && !self.is_two_sided { BackFace::Black } else { BackFace::Own }
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
        self.only(plugin, &parts)
    }

    /// The surface of the BSDF in another one, if these are one.
    fn only(&mut self, plugin: &Plugin, parts: &[(&Property, Rc<Plugin>)]) -> Result<Surface> {
        match parts {
            [(_, inner)] => self.surface(inner),
            [] => Err(Error::invalid(&plugin.at, format!("the {} has no bsdf in it", plugin.title()))),
            _ => {
                let message = format!("a {} with several bsdfs is not supported", plugin.title());
                Err(Error::new(ErrorKind::Unsupported, &plugin.at, message))
            }
        }
    }

    /// A BSDF for both sides, or two: that of the outside and that of the inside.
    fn two_sided(&mut self, plugin: &Plugin) -> Result<Surface> {
        let parts = plugin.parts("bsdf", &self.ids)?;
        let [(_, front), (_, back)] = &parts[..] else { return self.only(plugin, &parts) };
        let sides = TextureKind::Sides { outside: Color::gray(0.0), inside: Color::gray(1.0) };
        let amount = self.number(plugin, sides);
        self.blend(plugin, [front, back], amount)
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
        let guard = BumpGuard {
            turns: plugin.boolean("flip_invalid_normals", true)?,
            shadows: plugin.boolean("use_shadowing_function", true)?,
        };
        let inner = self.nested(plugin)?;
        let material = match bump_mapping {
            BumpMapping::None => inner.material,
            _ => self.under_map(plugin, inner.material, (bump_mapping, guard), &mut HashMap::new())?,
        };
        Ok(Surface { material, ..inner })
    }

    /// A material, or all that it is mixed of, under a map; `known` are those that have been put there already.
    fn under_map(
        &mut self,
        plugin: &Plugin,
        inner: MaterialId,
        map: (BumpMapping, BumpGuard),
        known: &mut HashMap<MaterialId, MaterialId>,
    ) -> Result<MaterialId> {
        if let Some(&id) = known.get(&inner) {
            return Ok(id);
        }
        let mut material = self.scene.materials[inner.index()].clone();
        if let MaterialKind::Mix { materials: [first, second], .. } = &mut material.kind {
            *first = self.under_map(plugin, *first, map, known)?;
            *second = self.under_map(plugin, *second, map, known)?;
        } else if material.bump_mapping == BumpMapping::None {
            (material.bump_mapping, material.bump_guard) = (map.0, Some(map.1));
        } else {
            let message = format!("a {} over another map is not supported", plugin.title());
            return Err(Error::new(ErrorKind::Unsupported, &plugin.at, message));
        }
        let id = self.push_material(plugin, material.kind);
        let Material { bump_mapping, bump_guard, back_face, .. } = material;
        let mapped = &mut self.scene.materials[id.index()];
        (mapped.bump_mapping, mapped.bump_guard, mapped.back_face) = (bump_mapping, bump_guard, back_face);
        known.insert(inner, id);
        Ok(id)
    }

    fn kind(&mut self, plugin: &Plugin) -> Result<MaterialKind> {
        Ok(match &*plugin.kind {
            "diffuse" => MaterialKind::Diffuse { reflectance: self.reflectance(plugin, "reflectance", 0.5)? },
            "null" => MaterialKind::Interface,
            "conductor" => self.conductor(plugin, SMOOTH)?,
            "roughconductor" => {
                let roughness = self.roughness(plugin)?;
                self.conductor(plugin, roughness)?
            }
            "dielectric" => MaterialKind::Dielectric {
                eta: index(plugin, "bk7")?,
                roughness: SMOOTH,
                energy: Energy::SingleScattering,
                tint: self.tint(plugin)?,
            },
            "roughdielectric" => MaterialKind::Dielectric {
                eta: index(plugin, "bk7")?,
                roughness: self.roughness(plugin)?,
                energy: Energy::SingleScattering,
                tint: self.tint(plugin)?,
            },
            "thindielectric" => {
                MaterialKind::ThinDielectric { eta: index(plugin, "bk7")?, tint: self.tint(plugin)? }
            }
            "plastic" | "roughplastic" => MaterialKind::Plastic(Box::new(self.plastic(plugin)?)),
            "hair" => self.hair(plugin)?,
            "measured" => {
                let (path, at) = self.file(plugin)?;
                let read =
                    Measured::read(&path, self.context).map_err(|error| super::xml::blame(error, &at))?;
                MaterialKind::Measured(Arc::new(read))
            }
            "principled" | "principledthin" => self.principled(plugin, plugin.kind == "principledthin")?,
            _ => return Err(plugin.unsupported(KINDS)),
        })
    }

    /// A blend of two BSDFs: of diffuse ones another diffuse one, which has less noise.
    fn blend(
        &mut self,
        plugin: &Plugin,
        [first, second]: [&Rc<Plugin>; 2],
        amount: Scalar,
    ) -> Result<Surface> {
        let surfaces = [self.surface(first)?, self.surface(second)?];
        let surfaces = self.without_null(surfaces);
        let (alpha, amount) = self.blended_alphas(plugin, surfaces.map(|surface| surface.alpha), amount);
        let materials = surfaces.map(|surface| surface.material);
        let [first, second] = materials.map(|id| &self.scene.materials[id.index()]);
        let back_face = first.back_face;
        let (kind, back_face) = match (&first.kind, &second.kind) {
            (&MaterialKind::Diffuse { reflectance: low }, &MaterialKind::Diffuse { reflectance: high })
                if first.bump_mapping == BumpMapping::None
                    && second.bump_mapping == BumpMapping::None
                    && back_face == second.back_face =>
            {
                let mix = self.push_texture(plugin, TextureKind::Mix { low, high, amount });
                (MaterialKind::Diffuse { reflectance: Color::Texture(mix) }, back_face)
            }
            _ => (MaterialKind::Mix { materials, amount }, BackFace::Own),
        };
        let material = self.push_material(plugin, kind);
        self.scene.materials[material.index()].back_face = back_face;
        Ok(Surface { material, alpha })
    }

    /// The opacity of a blend of two surfaces, and the part of the second in what is opaque.
    fn blended_alphas(
        &mut self,
        plugin: &Plugin,
        alphas: [Option<Scalar>; 2],
        amount: Scalar,
    ) -> (Option<Scalar>, Scalar) {
        let [first, second] = alphas.map(|alpha| alpha.unwrap_or(Scalar::Value(1.0)));
        if first == second {
            return (alphas[0], amount);
        }
        let alpha = TextureKind::Mix { low: first.into(), high: second.into(), amount };
        let alpha = self.number(plugin, alpha);
        let part = self.number(plugin, TextureKind::product(amount, second));
        (Some(alpha), self.number(plugin, TextureKind::Quotient { a: part, b: alpha }))
    }

    /// Two surfaces, one of which, if it is nothing, is the other one with an opacity of 0.
    fn without_null(&self, surfaces: [Surface; 2]) -> [Surface; 2] {
        let is_null = surfaces
            .map(|of| matches!(self.scene.materials[of.material.index()].kind, MaterialKind::Interface));
        let nothing = |like: Surface| Surface { alpha: Some(Scalar::Value(0.0)), ..like };
        match (surfaces, is_null) {
            ([_, second], [true, false]) => [nothing(second), second],
            ([first, _], [false, true]) => [first, nothing(first)],
            _ => surfaces,
        }
    }

    /// A number that a texture computes.
    fn number(&mut self, plugin: &Plugin, kind: TextureKind) -> Scalar {
        Scalar::Texture(self.push_texture(plugin, kind))
    }

    fn conductor(&mut self, plugin: &Plugin, roughness: Roughness) -> Result<MaterialKind> {
        Ok(MaterialKind::Conductor {
            metal: self.metal(plugin)?,
            roughness,
            energy: Energy::SingleScattering,
            specular_reflectance: self.reflectance(plugin, "specular_reflectance", 1.0)?,
        })
    }

    fn tint(&mut self, plugin: &Plugin) -> Result<Tint> {
        Ok(Tint {
            reflectance: self.reflectance(plugin, "specular_reflectance", 1.0)?,
            transmittance: self.reflectance(plugin, "specular_transmittance", 1.0)?,
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
                    illuminant: Illuminant::D65,
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
        let [eta, k] = [eta, k].map(|curve| Color::Curve(self.push_curve(curve)));
        Ok(Metal::Indices { eta, k, illuminant: Illuminant::EqualEnergy })
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

    /// Chiang et al.'s hair.
    fn hair(&mut self, plugin: &Plugin) -> Result<MaterialKind> {
        plugin.ignore(&["ext_ior"]);
        let roughness = |name: &str| {
            plugin
                .float_where(name, 0.3, "a number from 0 to 1", |share| (0.0..=1.0).contains(&share))
                .map(|share| Scalar::Value(share as f32))
        };
        let pigment = match plugin.find("sigma_a") {
            Some(_) => Pigment::Absorption(self.color(plugin, "sigma_a", 0.0)?),
            None => {
                let eumelanin = self.scalar(plugin, "eumelanin", 1.3)?;
                let pheomelanin = self.scalar(plugin, "pheomelanin", 0.2)?;
                Pigment::Melanin { eumelanin, pheomelanin }
            }
        };
        Ok(MaterialKind::Hair(Box::new(Hair {
            pigment,
            eta: Scalar::Value(eta(plugin, "amber")? as f32),
            beta_m: roughness("longitudinal_roughness")?,
            beta_n: roughness("azimuthal_roughness")?,
            alpha: Scalar::Value(plugin.float("scale_tilt", 2.0)? as f32),
        })))
    }

    fn principled(&mut self, plugin: &Plugin, is_thin: bool) -> Result<MaterialKind> {
        plugin.ignore(&[
            "diffuse_reflectance_sampling_rate",
            "diffuse_transmittance_sampling_rate",
            "main_specular_sampling_rate",
            "specular_reflectance_sampling_rate",
            "specular_transmittance_sampling_rate",
            "clearcoat_sampling_rate",
        ]);
        let eta = match (is_thin, plugin.find("eta").is_some()) {
            (true, _) => self.scalar(plugin, "eta", 1.5)?,
            (false, true) => Scalar::Value(plugin.positive("eta", 1.5)? as f32),
            (false, false) => {
                // The index of refraction whose reflectance at normal incidence is 8 % of `specular`, which is not 0 in Mitsuba.
                let specular = plugin.float_where("specular", 0.5, "a number from 0 to 1", |share| {
                    (0.0..=1.0).contains(&share)
                })?;
                let root = (0.08 * if specular == 0.0 { 1e-3 } else { specular }).sqrt();
                Scalar::Value(((1.0 + root) / (1.0 - root)) as f32)
            }
        };
        let of_solid = |reader: &mut Self, name| match is_thin {
            true => Ok(Scalar::Value(0.0)),
            false => reader.scalar(plugin, name, 0.0),
        };
        Ok(MaterialKind::Disney(Box::new(Disney {
            base_color: self.reflectance(plugin, "base_color", 0.5)?,
            roughness: self.scalar(plugin, "roughness", 0.5)?,
            anisotropic: self.scalar(plugin, "anisotropic", 0.0)?,
            metallic: of_solid(self, "metallic")?,
            spec_trans: self.scalar(plugin, "spec_trans", 0.0)?,
            eta,
            spec_tint: self.scalar(plugin, "spec_tint", 0.0)?,
            sheen: self.scalar(plugin, "sheen", 0.0)?,
            sheen_tint: self.scalar(plugin, "sheen_tint", 0.0)?,
            flatness: self.scalar(plugin, "flatness", 0.0)?,
            clearcoat: of_solid(self, "clearcoat")?,
            clearcoat_gloss: of_solid(self, "clearcoat_gloss")?,
            diff_trans: if is_thin { self.scalar(plugin, "diff_trans", 0.0)? } else { Scalar::Value(0.0) },
            is_thin,
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
