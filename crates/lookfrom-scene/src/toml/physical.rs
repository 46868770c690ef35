//! Physically based materials: all types except "whitted".
//!
//! Roughness is perceptual, from 0 to 1: the α of the microfacet distribution is its square (Burley 2012). It is converted
//! to α here, also if it is a texture.

use std::sync::Arc;

use glam::Vec3;

use super::Reader;
use super::table::Table;
use super::value::{Value, unit};
use crate::error::Result;
use crate::material::{Coat, CoatEstimate, Color, Energy, Ior, MaterialKind, Metal, Roughness, Scalar};
use crate::measured::Measured;

/// Reflectance of a diffuse surface, or base, where a scene does not set it: that of white paint, as of Whitted's `diffuse`.
pub(super) const REFLECTANCE: f32 = 0.8;

/// The words for what becomes of light between microfacets.
pub(super) const ENERGIES: &[(&str, Energy)] =
    &[("conserved", Energy::Conserved), ("single_scattering", Energy::SingleScattering)];

/// The words for estimates of coats.
pub(super) const ESTIMATES: &[(&str, CoatEstimate)] =
    &[("unbiased", CoatEstimate::Unbiased), ("pbrt", CoatEstimate::Pbrt)];

/// The keys of a roughness that is not perceptual.
pub(super) const ROUGHNESS: &[&str] = &["alpha", "alpha_squared"];

fn energy(table: &Table<'_>) -> Energy {
    table.or("energy", Energy::default(), |value| value.choice(ENERGIES))
}

impl Reader<'_, '_> {
    /// A material of a type other than "whitted".
    pub(super) fn physical(&mut self, word: &str, table: &Table<'_>) -> MaterialKind {
        match word {
            "diffuse" => {
                MaterialKind::Diffuse { reflectance: self.color_or(table, "reflectance", REFLECTANCE) }
            }
            "diffuse_transmission" => MaterialKind::DiffuseTransmission {
                reflectance: self.color_or(table, "reflectance", MaterialKind::DIFFUSE_SHEET),
                transmittance: self.color_or(table, "transmittance", MaterialKind::DIFFUSE_SHEET),
                scale: table.or("scale", 1.0, |value| {
                    value.single_where("a number of at least 0", |scale| scale >= 0.0)
                }),
            },
            "conductor" => MaterialKind::Conductor {
                metal: self.metal_of(table),
                roughness: self.roughness(table, "roughness"),
                energy: energy(table),
            },
            "dielectric" => MaterialKind::Dielectric {
                eta: self.ior_of(table),
                roughness: self.roughness(table, "roughness"),
                energy: energy(table),
            },
            "thin_dielectric" => MaterialKind::ThinDielectric { eta: self.ior_of(table) },
            "coated_diffuse" => MaterialKind::CoatedDiffuse {
                reflectance: self.color_or(table, "reflectance", REFLECTANCE),
                coat: self.coat(table),
            },
            "coated_conductor" => MaterialKind::CoatedConductor {
                metal: self.metal_of(table),
                roughness: self.roughness(table, "base_roughness"),
                coat: self.coat(table),
            },
            "subsurface" => MaterialKind::Subsurface(Box::new(self.subsurface(table))),
            "hair" => MaterialKind::Hair(Box::new(self.hair(table))),
            "measured" => {
                let read = table.need("file", "\"satin.bsdf\"", None, |value| self.measured(value).map(Some));
                read.map_or(MaterialKind::Interface, MaterialKind::Measured)
            }
            "principled" => MaterialKind::Principled(Box::new(self.principled(table))),
            "disney" => MaterialKind::Disney(Box::new(self.disney(table))),
            "unlit" => MaterialKind::Unlit { color: self.color_or(table, "color", 1.0) },
            "mix" => {
                let amount = self.share_or(table, "amount", MaterialKind::MIX_AMOUNT);
                let materials = table.need("materials", "[\"red\", \"gold\"]", None, |value| {
                    let names = value.list_of::<2>("the names of two materials")?;
                    let [first, second] =
                        names.map(|name| name.noting(self.material_named(name).map(Some), None));
                    Ok(first.zip(second))
                });
                match materials {
                    Some((first, second)) => MaterialKind::Mix { materials: [first, second], amount },
                    None => MaterialKind::Interface,
                }
            }
            "shadow_catcher" => MaterialKind::ShadowCatcher {
                normal: table.or("normal", Vec3::Y, |value| Ok(unit(value)?.as_vec3())),
            },
            _ => MaterialKind::Interface,
        }
    }

    /// The tables of a file.
    fn measured(&mut self, value: Value<'_>) -> Result<Arc<Measured>> {
        let path = self.resolve(value, "the name of a .bsdf or .binary file")?;
        Measured::read(&path, self.context).map(Arc::new).map_err(|error| value.blame(error))
    }

    /// A metal given by its name, its colour, or its optical constants.
    fn metal_of(&mut self, table: &Table<'_>) -> Metal {
        table.one_of(&["metal", "reflectance", "k"]);
        table.one_of(&["metal", "reflectance", "eta"]);
        let stand_in = Metal::Reflectance(Color::gray(1.0));
        if table.has("metal") {
            return table
                .or("metal", stand_in, |value| self.metal(value).map(|[eta, k]| Metal::Indices { eta, k }));
        }
        if table.has("reflectance") {
            return table.or("reflectance", stand_in, |value| self.color(value).map(Metal::Reflectance));
        }
        if !table.has("eta") && !table.has("k") {
            let error = table.error("no metal is given");
            let error = error.hint("add `metal = \"gold\"`, or a `reflectance`, or `eta` and `k`");
            table.lacks(&["metal", "reflectance", "eta", "k"], error);
            return stand_in;
        }
        if !table.has("eta") {
            table.lacks(&["eta"], table.error("`eta` is missing").hint("`k` needs `eta`"));
        }
        Metal::Indices {
            eta: table.or("eta", Color::gray(1.0), |value| self.optical_color(value)),
            k: table.need("k", "[3, 2.5, 2]", Color::gray(1.0), |value| self.optical_color(value)),
        }
    }

    fn ior_of(&mut self, table: &Table<'_>) -> Ior {
        table.or("ior", Ior::default(), |value| self.ior(value))
    }

    fn coat(&mut self, table: &Table<'_>) -> Coat {
        let usual = Coat::default();
        let thickness = table.or("thickness", usual.thickness, |value| {
            self.scalar_where(value, "a number of at least 0", |thickness| thickness >= 0.0)
        });
        let g = table.or("g", usual.g, |value| {
            self.scalar_where(value, "a number between -1 and 1", |g| g > -1.0 && g < 1.0)
        });
        let whole = |value: Value<'_>| Ok(value.integer(1, u32::MAX.into())? as u32);
        Coat {
            max_depth: table.or("coat_depth", usual.max_depth, whole),
            samples: table.or("coat_samples", usual.samples, whole),
            estimate: table.or("coat_estimate", usual.estimate, |value| value.choice(ESTIMATES)),
            eta: self.ior_of(table),
            roughness: self.roughness(table, "roughness"),
            thickness,
            albedo: table.or("coat_albedo", usual.albedo, |value| self.color(value)),
            g,
        }
    }

    /// One roughness for all directions, or a list of two along u and v; smooth by default.
    pub(super) fn roughness(&mut self, table: &Table<'_>, key: &str) -> Roughness {
        table.or(key, Roughness { remap: false, ..Roughness::SMOOTH }, |value| {
            if value.is_table() && !value.table("a roughness")?.has("type") {
                return self.microfacets(value);
            }
            let [u, v] = if value.is_list() {
                let [u, v] = value.list_of("a number from 0 to 1, a texture, or two of them, [u, v]")?;
                [self.alpha_of(u)?, self.alpha_of(v)?]
            } else {
                [self.alpha_of(value)?; 2]
            };
            Ok(Roughness { u, v, remap: false })
        })
    }

    /// A roughness as the microfacet model has it, α, or its square, as pbrt's scenes have.
    fn microfacets(&mut self, value: Value<'_>) -> Result<Roughness> {
        let table = value.table("a roughness")?;
        table.allow(&[ROUGHNESS]);
        let one = table.one_of(ROUGHNESS).ok_or_else(|| {
            value.wrong("a number from 0 to 1, a texture, or a table such as { alpha = 0.04 }")
        })?;
        let mut scalar = |value| self.scalar_where(value, "a number of at least 0", |alpha| alpha >= 0.0);
        let [u, v] = if one.is_list() {
            let [u, v] = one.list_of("a number of at least 0, a texture, or two of them, [u, v]")?;
            [scalar(u)?, scalar(v)?]
        } else {
            [scalar(one)?; 2]
        };
        Ok(Roughness { u, v, remap: one.key() == "alpha_squared" })
    }

    fn alpha_of(&mut self, value: Value<'_>) -> Result<Scalar> {
        let is_share = |roughness: f32| (0.0..=1.0).contains(&roughness);
        Ok(match self.scalar_where(value, "a number from 0 to 1", is_share)? {
            Scalar::Value(roughness) => Scalar::Value(roughness * roughness),
            Scalar::Texture(id) => self.squared(value, id),
        })
    }
}
