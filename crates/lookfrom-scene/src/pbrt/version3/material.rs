//! Materials of version 3: with their own parameters, as the nearest of ours.
//!
//! Diffuse bases of version 3 shine through glossy surfaces undimmed; ours lose a little of what the surfaces reflect. Its `roughness` is
//! mapped to α by another function than that of version 4, which is used where it is a number.

use crate::error::Result;
use crate::material::{
    BumpMapping, Color, Disney, Energy, Illuminant, Ior, Material, MaterialKind, Metal, Plastic, Roughness,
    Scalar, Subsurface, SubsurfaceMedium, Tint,
};
use crate::pbrt::Reader;
use crate::pbrt::params::{ParameterType, Parameters};
use crate::pbrt::spectra::Meaning::{Reflectance, Unbounded};
use crate::scene::{MaterialId, TextureId};
use crate::texture::{Texture, TextureKind};

impl Reader<'_, '_> {
    /// A material that version 4 has under another name, or not at all; `None` for others.
    ///
    /// # Errors
    /// Those of its parameters.
    pub(in crate::pbrt) fn old_material(
        &mut self,
        kind: &str,
        p: &Parameters,
    ) -> Result<Option<MaterialKind>> {
        Ok(Some(match kind {
            "matte" => {
                if p.has("sigma") && self.scalar(p, "sigma", 0.0)? != Scalar::Value(0.0) {
                    self.leave_out(
                        &p.place,
                        "the \"sigma\" of matte materials is left out: they are Lambertian",
                    );
                }
                MaterialKind::Diffuse { reflectance: self.color(p, "Kd", Color::gray(0.5), Reflectance)? }
            }
            "plastic" => {
                let [diffuse, glossy] = self.base_and_gloss(p, 0.25)?;
                let alpha = self.mean_alpha(p, ["", "", "roughness"], 0.1)?;
                plastic(diffuse, glossy, Ior::GLASS, alpha)
            }
            "substrate" => {
                let [diffuse, glossy] = self.base_and_gloss(p, 0.5)?;
                let alpha = self.mean_alpha(p, ["uroughness", "vroughness", ""], 0.1)?;
                // The gloss is what is reflected straight on.
                let (eta, factor) = match glossy {
                    Color::Value(rgb) => {
                        let mean = (rgb.iter().sum::<f32>() / 3.0).clamp(1e-4, 0.9);
                        let root = mean.sqrt();
                        ((1.0 + root) / (1.0 - root), Color::Value(rgb.map(|part| part / mean)))
                    }
                    other => (Ior::GLASS, other),
                };
                plastic(diffuse, factor, eta, alpha)
            }
            "uber" => self.uber(p)?,
            "metal" => {
                let metal = Metal::Indices {
                    eta: self.color_or_copper(p, "eta", "metal-Cu-eta")?,
                    k: self.color_or_copper(p, "k", "metal-Cu-k")?,
                    illuminant: Illuminant::D65,
                };
                let names = ["uroughness", "vroughness", "roughness"];
                conductor(metal, self.old_roughness(p, names, 0.01)?, Color::gray(1.0))
            }
            "mirror" => {
                let reflected = self.color(p, "Kr", Color::gray(0.9), Reflectance)?;
                conductor(Metal::Reflectance(Color::gray(1.0)), Roughness::SMOOTH, reflected)
            }
            "glass" => MaterialKind::Dielectric {
                eta: Ior::Value(self.old_index(p)?),
                roughness: self.old_roughness(p, ["uroughness", "vroughness", ""], 0.0)?,
                energy: Energy::SingleScattering,
                tint: Tint {
                    reflectance: self.color(p, "Kr", Color::gray(1.0), Reflectance)?,
                    transmittance: self.color(p, "Kt", Color::gray(1.0), Reflectance)?,
                },
            },
            "translucent" => {
                p.ignore(&["Ks", "roughness", "remaproughness"]);
                let diffuse = self.color(p, "Kd", Color::gray(0.25), Reflectance)?;
                let reflected = self.color(p, "reflect", Color::gray(0.5), Reflectance)?;
                let transmitted = self.color(p, "transmit", Color::gray(0.5), Reflectance)?;
                MaterialKind::DiffuseTransmission {
                    reflectance: self.product(diffuse, reflected),
                    transmittance: self.product(diffuse, transmitted),
                    scale: 1.0,
                }
            }
            "disney" => self.disney(p)?,
            "kdsubsurface" => {
                p.ignore(&["Kr", "Kt"]);
                MaterialKind::Subsurface(Box::new(Subsurface {
                    medium: SubsurfaceMedium::Reflectance {
                        reflectance: self.color(p, "Kd", Color::gray(0.5), Reflectance)?,
                        mean_free_path: self.color(p, "mfp", Color::gray(1.0), Unbounded)?,
                    },
                    scale: p.float("scale", 1.0)?,
                    g: p.float("g", 0.0)?,
                    eta: p.positive("eta", Subsurface::ETA)?,
                    roughness: self.old_roughness(p, ["uroughness", "vroughness", "roughness"], 0.0)?,
                }))
            }
            "fourier" => {
                self.leave_out(
                    &p.place,
                    "materials of the type \"fourier\" are grey: their files are not read",
                );
                p.ignore(&["bsdffile"]);
                MaterialKind::Diffuse { reflectance: Color::gray(0.5) }
            }
            "mix" if p.has("namedmaterial1") => self.old_mix(p)?,
            _ => return Ok(None),
        }))
    }

    /// `bumpmap`.
    pub(in crate::pbrt) fn old_bump_mapping(&mut self, p: &Parameters) -> Result<BumpMapping> {
        Ok(self.scalar_or_none(p, "bumpmap")?.map_or(BumpMapping::None, BumpMapping::Bump))
    }

    fn color_or_copper(&mut self, p: &Parameters, name: &'static str, copper: &str) -> Result<Color> {
        match self.color_or_none(p, name, Unbounded)? {
            Some(color) => Ok(color),
            None => self.named_curve(copper, &p.place).map(Color::Curve),
        }
    }

    /// `Kd` and `Ks`.
    fn base_and_gloss(&mut self, p: &Parameters, default: f32) -> Result<[Color; 2]> {
        Ok([
            self.color(p, "Kd", Color::gray(default), Reflectance)?,
            self.color(p, "Ks", Color::gray(default), Reflectance)?,
        ])
    }

    /// The index of refraction, `eta` or `index`.
    fn old_index(&mut self, p: &Parameters) -> Result<f32> {
        for name in ["eta", "index"] {
            match self.scalar_or_none(p, name)? {
                Some(Scalar::Value(eta)) if eta > 0.0 => return Ok(eta),
                Some(Scalar::Value(_)) => return Err(p.refuse(name, "an index of refraction greater than 0")),
                Some(_) => self.leave_out(&p.place, "an index of refraction by a texture is 1.5"),
                None => {}
            }
        }
        Ok(Ior::GLASS)
    }

    /// The roughness along u and v, or both by one number; an empty name is none.
    fn old_roughness(
        &mut self,
        p: &Parameters,
        [u, v, both]: [&'static str; 3],
        default: f32,
    ) -> Result<Roughness> {
        let remap = p.boolean("remaproughness", true)?;
        let mut find =
            |name: &'static str| if name.is_empty() { Ok(None) } else { self.scalar_or_none(p, name) };
        let both = find(both)?.unwrap_or(Scalar::Value(default));
        let [u, v] = [find(u)?.unwrap_or(both), find(v)?.unwrap_or(both)];
        Ok(match (u, v) {
            (Scalar::Value(u), Scalar::Value(v)) => {
                let alpha = |roughness: f32| Scalar::Value(if remap { alpha(roughness) } else { roughness });
                Roughness { u: alpha(u), v: alpha(v), remap: false, ..Roughness::SMOOTH }
            }
            _ => Roughness { u, v, remap, ..Roughness::SMOOTH },
        })
    }

    /// The geometric mean of α along u and v.
    fn mean_alpha(&mut self, p: &Parameters, names: [&'static str; 3], default: f32) -> Result<f32> {
        let Roughness { u, v, .. } = self.old_roughness(p, names, default)?;
        Ok(match (u, v) {
            (Scalar::Value(u), Scalar::Value(v)) => (u * v).max(0.0).sqrt(),
            _ => {
                self.leave_out(&p.place, "a roughness by a texture is that of the default here");
                alpha(default)
            }
        })
    }

    /// A product of colours.
    fn product(&mut self, a: Color, b: Color) -> Color {
        match (a, b) {
            (Color::Value(a), Color::Value(b)) => Color::Value(std::array::from_fn(|c| a[c] * b[c])),
            (Color::Value([1.0, 1.0, 1.0]), other) | (other, Color::Value([1.0, 1.0, 1.0])) => other,
            _ => {
                let kind = TextureKind::Product { a, b };
                let at = self.scene.materials[0].at.clone();
                self.scene.textures.push(Texture { name: "product".to_owned(), at, kind });
                Color::Texture(TextureId(self.scene.textures.len() as u32 - 1))
            }
        }
    }

    /// The surface of many layers: a glossy one on a diffuse one, or a smooth one that reflects by `Kr`, of which `opacity` lets light through.
    fn uber(&mut self, p: &Parameters) -> Result<MaterialKind> {
        let [diffuse, glossy] = self.base_and_gloss(p, 0.25)?;
        let mirrored = self.color(p, "Kr", Color::BLACK, Reflectance)?;
        let through = self.color(p, "Kt", Color::BLACK, Reflectance)?;
        let opacity = self.color(p, "opacity", Color::gray(1.0), Reflectance)?;
        let eta = self.old_index(p)?;
        let alpha = self.mean_alpha(p, ["uroughness", "vroughness", "roughness"], 0.1)?;
        let base = match (mirrored, glossy) {
            (Color::BLACK, _) => plastic(diffuse, glossy, eta, alpha),
            (_, Color::BLACK) => plastic(diffuse, mirrored, eta, 0.0),
            _ => {
                self.leave_out(&p.place, "the \"Kr\" of uber materials that have a \"Ks\" is left out");
                plastic(diffuse, glossy, eta, alpha)
            }
        };
        let glass = MaterialKind::Dielectric {
            eta: Ior::Value(eta),
            roughness: Roughness::SMOOTH,
            energy: Energy::SingleScattering,
            tint: Tint { reflectance: mirrored, transmittance: Color::gray(1.0) },
        };
        let base = match through {
            Color::BLACK => base,
            _ => self.mixed(p, [base, glass], through),
        };
        Ok(match opacity {
            Color::Value([1.0, 1.0, 1.0]) => base,
            _ => self.mixed(p, [MaterialKind::Interface, base], opacity),
        })
    }

    /// Two materials: the part `amount` is the second.
    fn mixed(&mut self, p: &Parameters, kinds: [MaterialKind; 2], amount: Color) -> MaterialKind {
        let materials = kinds.map(|kind| {
            self.scene.materials.push(Material::new(p.title.clone(), p.place.location(), kind));
            MaterialId(self.scene.materials.len() as u32 - 1)
        });
        MaterialKind::Mix { materials, amount: number(amount) }
    }

    /// A mix of two named materials: the part `amount` is the first.
    fn old_mix(&mut self, p: &Parameters) -> Result<MaterialKind> {
        let amount = match p.of_kind("amount", ParameterType::Float)? {
            Some(_) => Scalar::Value(p.float("amount", MaterialKind::MIX_AMOUNT)?),
            None => number(self.color(p, "amount", Color::gray(MaterialKind::MIX_AMOUNT), Unbounded)?),
        };
        let mut named = |name: &'static str| {
            let found = p.string(name)?.unwrap_or_default().to_owned();
            let place =
                p.find(name, &[ParameterType::String])?.map_or(&p.place, |parameter| &parameter.place);
            match found.is_empty() {
                true => Err(p.refuse(name, "the name of a material")),
                false => Ok(self.material_named(&found, place)),
            }
        };
        let (first, second) = (named("namedmaterial1")?, named("namedmaterial2")?);
        Ok(MaterialKind::Mix { materials: [second, first], amount })
    }

    fn disney(&mut self, p: &Parameters) -> Result<MaterialKind> {
        p.ignore(&["scatterdistance"]);
        let is_thin = p.boolean("thin", false)?;
        let mut scalar = |name, default| self.scalar(p, name, default);
        let disney = Disney {
            roughness: scalar("roughness", 0.5)?,
            anisotropic: scalar("anisotropic", 0.0)?,
            metallic: scalar("metallic", 0.0)?,
            spec_trans: scalar("spectrans", 0.0)?,
            eta: scalar("eta", 1.5)?,
            spec_tint: scalar("speculartint", 0.0)?,
            sheen: scalar("sheen", 0.0)?,
            sheen_tint: scalar("sheentint", 0.5)?,
            flatness: scalar("flatness", 0.0)?,
            clearcoat: scalar("clearcoat", 0.0)?,
            clearcoat_gloss: scalar("clearcoatgloss", 1.0)?,
            diff_trans: scalar("difftrans", 1.0)?,
            is_thin,
            base_color: self.color(p, "color", Color::gray(0.5), Reflectance)?,
        };
        Ok(MaterialKind::Disney(Box::new(disney)))
    }
}

fn conductor(metal: Metal, roughness: Roughness, specular_reflectance: Color) -> MaterialKind {
    MaterialKind::Conductor { metal, roughness, energy: Energy::SingleScattering, specular_reflectance }
}

/// A glossy surface, which reflects `glossy` times as much as one with the index 1.5, on a diffuse one.
fn plastic(diffuse: Color, glossy: Color, eta: f32, alpha: f32) -> MaterialKind {
    if glossy == Color::BLACK {
        return MaterialKind::Diffuse { reflectance: diffuse };
    }
    MaterialKind::Plastic(Box::new(Plastic {
        reflectance: diffuse,
        specular_reflectance: glossy,
        eta,
        alpha,
        microfacets: Roughness::SMOOTH.microfacets,
        is_nonlinear: false,
    }))
}

/// α by version 3's mapping of a roughness in [0, 1].
fn alpha(roughness: f32) -> f32 {
    if roughness <= 0.0 {
        return 0.0;
    }
    let x = libm::logf(roughness.max(1e-3));
    1.62142 + x * (0.819_955 + x * (0.1734 + x * (0.017_120_1 + x * 0.000_640_711)))
}

/// The mean of a colour.
fn number(color: Color) -> Scalar {
    match color {
        Color::Value(rgb) => Scalar::Value(rgb.iter().sum::<f32>() / 3.0),
        Color::Texture(id) => Scalar::Texture(id),
        Color::Curve(_) => Scalar::Value(MaterialKind::MIX_AMOUNT),
    }
}
