//! The `Material` and `MakeNamedMaterial` directives.

use super::lexer::Lexer;
use super::params::{ParameterType, Parameters};
use super::spectra::Meaning::{Reflectance, Unbounded};
use super::text::Place;
use super::{NamedMaterial, Reader};
use crate::error::Result;
use crate::material::{
    BumpMapping, Coat, CoatEstimate, Color, Energy, Illuminant, Ior, Material, MaterialKind, Metal,
    Roughness, Tint,
};
use crate::scene::{ImageId, MaterialId};

/// pbrt's own bound of the bounces in a coat, on which its pictures depend.
const COAT_DEPTH: u32 = 10;

/// pbrt's own reflectance of a diffuse surface, or base.
const REFLECTANCE: Color = Color::gray(0.5);

const KINDS: &[&str] = &[
    "coatedconductor",
    "coateddiffuse",
    "conductor",
    "dielectric",
    "diffuse",
    "diffusetransmission",
    "hair",
    "interface",
    "measured",
    "mix",
    "subsurface",
    "thindielectric",
];

impl Reader<'_, '_> {
    /// An unnamed material.
    pub(super) fn material(&mut self, kind: &str, parameters: &Parameters) -> Result<MaterialId> {
        let material = self.look(kind, kind, parameters)?;
        self.context.keep(Material::BYTES, "the material", &material.at)?;
        self.scene.materials.push(material);
        Ok(MaterialId(self.scene.materials.len() as u32 - 1))
    }

    /// Reserves a material that is referred to before its definition.
    pub(super) fn reserve_material(&mut self, name: &str, place: &Place) -> MaterialId {
        let id = MaterialId(self.scene.materials.len() as u32);
        self.scene.materials.push(Material::new(name, place.location(), MaterialKind::Interface));
        let named = NamedMaterial { id, first: place.clone(), is_made: false };
        self.materials.insert(name.to_owned(), named);
        id
    }

    pub(super) fn make_named_material(&mut self, place: &Place, lexer: &mut Lexer<'_>) -> Result<()> {
        let start = lexer.here();
        let (name, mut parameters) = self.entity(b"MakeNamedMaterial", place, lexer, Some(2))?;
        let kind = parameters.string("type")?.map(str::to_owned);
        let kind = kind.ok_or_else(|| {
            let error = place.invalid(format!("the material {name:?} has no type"));
            error.hint("add \"string type\" \"diffuse\", or whichever kind it is")
        })?;
        let name_place = lexer.place(start);
        self.note_word("Material", &kind, &name_place)?;
        if self.is_old() && self.materials.get(&name).is_some_and(|named| named.is_made) {
            // It is defined again, for what comes after.
            self.materials.remove(&name);
        }
        if let Some(named) = self.materials.get(&name).filter(|named| named.is_made) {
            let before = &self.scene.materials[named.id.index()].at;
            let error = name_place.invalid(format!("material {name:?} is already defined, at {before}"));
            return Err(error.hint("give one of them another name"));
        }
        parameters.title = format!("Material {kind:?}");
        // Converted before the name is defined, so that no mix can contain itself.
        let material = self.look(&name, &kind, &parameters)?;
        let id = self.material_named(&name, &name_place);
        self.scene.materials[id.index()] = material;
        if let Some(named) = self.materials.get_mut(&name) {
            named.is_made = true;
        }
        parameters.finish(self.context);
        Ok(())
    }

    fn look(&mut self, name: &str, kind: &str, parameters: &Parameters) -> Result<Material> {
        let p = parameters;
        if self.is_old()
            && let Some(old) = self.old_material(kind, p)?
        {
            let bump_mapping = self.old_bump_mapping(p)?;
            return Ok(Material { bump_mapping, ..Material::new(name, p.place.location(), old) });
        }
        let kind = match kind {
            "diffuse" => {
                MaterialKind::Diffuse { reflectance: self.color(p, "reflectance", REFLECTANCE, Reflectance)? }
            }
            "diffusetransmission" => {
                let quarter = Color::gray(MaterialKind::DIFFUSE_SHEET);
                MaterialKind::DiffuseTransmission {
                    reflectance: self.color(p, "reflectance", quarter, Reflectance)?,
                    transmittance: self.color(p, "transmittance", quarter, Reflectance)?,
                    scale: p.float("scale", 1.0)?,
                }
            }
            "conductor" => MaterialKind::Conductor {
                metal: self.metal(p, ["eta", "k", "reflectance"])?,
                roughness: self.roughness(p, ["uroughness", "vroughness", "roughness"], 0.0)?,
                energy: Energy::SingleScattering,
                specular_reflectance: Color::gray(1.0),
            },
            "dielectric" => MaterialKind::Dielectric {
                eta: self.index_of_refraction(p, "eta", Ior::GLASS)?,
                roughness: self.roughness(p, ["uroughness", "vroughness", "roughness"], 0.0)?,
                energy: Energy::SingleScattering,
                tint: Tint::default(),
            },
            "thindielectric" => MaterialKind::ThinDielectric {
                eta: self.index_of_refraction(p, "eta", Ior::GLASS)?,
                tint: Tint::default(),
            },
            "coateddiffuse" => MaterialKind::CoatedDiffuse {
                reflectance: self.color(p, "reflectance", REFLECTANCE, Reflectance)?,
                coat: self.coat(p, "eta", ["uroughness", "vroughness", "roughness"])?,
            },
            "coatedconductor" => {
                let conductor = ["conductor.uroughness", "conductor.vroughness", "conductor.roughness"];
                let interface = ["interface.uroughness", "interface.vroughness", "interface.roughness"];
                MaterialKind::CoatedConductor {
                    metal: self.metal(p, ["conductor.eta", "conductor.k", "reflectance"])?,
                    roughness: self.roughness(p, conductor, 0.0)?,
                    coat: self.coat(p, "interface.eta", interface)?,
                }
            }
            "mix" => self.mix(p)?,
            "interface" => MaterialKind::Interface,
            "" | "none" => {
                if !self.is_old() {
                    let message = "a material without a surface is called \"interface\"";
                    self.context.notice(&p.place.location(), message);
                }
                MaterialKind::Interface
            }
            "subsurface" => self.subsurface(p)?,
            "hair" => self.hair(p)?,
            "measured" => self.measured(p)?,
            _ => return Err(Self::unknown(&p.place, "material", kind, KINDS.iter().copied())),
        };
        let bump_mapping = match kind {
            MaterialKind::Interface | MaterialKind::Mix { .. } => BumpMapping::None,
            _ => self.bump_mapping(p)?,
        };
        Ok(Material { bump_mapping, ..Material::new(name, p.place.location(), kind) })
    }

    fn bump_mapping(&mut self, p: &Parameters) -> Result<BumpMapping> {
        let bump = self.scalar_or_none(p, "displacement")?;
        let Some(name) = p.string("normalmap")? else {
            return Ok(bump.map_or(BumpMapping::None, BumpMapping::Bump));
        };
        if bump.is_some() {
            let message = "the material has a \"normalmap\" and a \"displacement\": only the first is used";
            self.context.warn(&p.place.location(), message);
        }
        let place =
            p.find("normalmap", &[ParameterType::String])?.map_or(&p.place, |parameter| &parameter.place);
        let image: ImageId = self.picture(name, "linear", place)?;
        Ok(BumpMapping::NormalMap(image))
    }

    fn metal(&mut self, p: &Parameters, [eta, k, reflectance]: [&'static str; 3]) -> Result<Metal> {
        if let Some(color) = self.color_or_none(p, reflectance, Reflectance)? {
            if p.has(eta) || p.has(k) {
                let error = p.refuse(reflectance, &format!("it without {eta:?} and {k:?}"));
                return Err(error.hint("a metal is given by its reflectance or by its indices"));
            }
            p.ignore(&[eta, k]);
            return Ok(Metal::Reflectance(color));
        }
        let eta = match self.color_or_none(p, eta, Unbounded)? {
            Some(eta) => eta,
            None => Color::Curve(self.named_curve("metal-Cu-eta", &p.place)?),
        };
        let k = match self.color_or_none(p, k, Unbounded)? {
            Some(k) => k,
            None => Color::Curve(self.named_curve("metal-Cu-k", &p.place)?),
        };
        Ok(Metal::Indices { eta, k, illuminant: Illuminant::D65 })
    }

    pub(super) fn roughness(
        &mut self,
        p: &Parameters,
        [u, v, both]: [&'static str; 3],
        default: f32,
    ) -> Result<Roughness> {
        let both = self.scalar(p, both, default)?;
        Ok(Roughness {
            u: self.scalar_or_none(p, u)?.unwrap_or(both),
            v: self.scalar_or_none(p, v)?.unwrap_or(both),
            remap: p.boolean("remaproughness", true)?,
            ..Roughness::SMOOTH
        })
    }

    fn index_of_refraction(&mut self, p: &Parameters, name: &'static str, default: f32) -> Result<Ior> {
        // pbrt prefers the spectrum if both are given.
        if p.of_kind(name, ParameterType::Spectrum)?.is_none() {
            let value = p.float_or_none(name)?.unwrap_or(default);
            if !(value > 0.0) {
                return Err(p.refuse(name, &format!("an index of refraction greater than 0, found {value}")));
            }
            return Ok(Ior::Value(value));
        }
        p.ignore(&[name]);
        match self.color(p, name, Color::gray(default), Unbounded)? {
            Color::Curve(curve) => Ok(Ior::Curve(curve)),
            Color::Value(_) | Color::Texture(_) => Ok(Ior::Value(default)),
        }
    }

    fn coat(&mut self, p: &Parameters, eta: &'static str, names: [&'static str; 3]) -> Result<Coat> {
        Ok(Coat {
            eta: self.index_of_refraction(p, eta, Ior::GLASS)?,
            roughness: self.roughness(p, names, 0.0)?,
            thickness: self.scalar(p, "thickness", Coat::THICKNESS)?,
            albedo: self.color(p, "albedo", Color::BLACK, Reflectance)?,
            g: self.scalar(p, "g", 0.0)?,
            max_depth: p.integer("maxdepth", COAT_DEPTH as i32, 1, 1 << 20)? as u32,
            samples: p.integer("nsamples", 1, 1, 1 << 16)? as u32,
            estimate: CoatEstimate::Pbrt,
        })
    }

    /// A mix of two named materials, which may be defined later.
    fn mix(&mut self, p: &Parameters) -> Result<MaterialKind> {
        let amount = self.scalar(p, "amount", MaterialKind::MIX_AMOUNT)?;
        let parameter = p.find("materials", &[ParameterType::String])?;
        let Some(parameter) = parameter else {
            let error = p.place.invalid(format!("{} has no \"string materials\"", p.title));
            return Err(error.hint("name two materials: \"string materials\" [ \"A\" \"B\" ]"));
        };
        let [first, second] = parameter.strings() else {
            return Err(parameter.wrong(format!("two names, found {}", parameter.strings().len())));
        };
        let materials = [first, second].map(|name| self.material_named(name, &parameter.place));
        Ok(MaterialKind::Mix { materials, amount })
    }
}
