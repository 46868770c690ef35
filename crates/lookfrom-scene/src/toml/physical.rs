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
use crate::material::{
    Coat, CoatEstimate, Color, Distribution, Energy, Illuminant, Ior, Masking, MaterialKind, Metal,
    Microfacets, Plastic, Roughness, Scalar, Tint,
};
use crate::measured::Measured;

/// Reflectance of a diffuse surface, or base, where a scene does not set it: that of white paint, as of Whitted's `diffuse`.
pub(super) const REFLECTANCE: f32 = 0.8;

/// The words for what becomes of light between microfacets.
pub(super) const ENERGIES: &[(&str, Energy)] =
    &[("conserved", Energy::Conserved), ("single_scattering", Energy::SingleScattering)];

/// The words for distributions of microfacet normals.
pub(super) const DISTRIBUTIONS: &[(&str, Distribution)] =
    &[("trowbridge_reitz", Distribution::TrowbridgeReitz), ("beckmann", Distribution::Beckmann)];

/// The words for the light under which curves of metals have their colours.
pub(super) const ILLUMINANTS: &[(&str, Illuminant)] =
    &[("D65", Illuminant::D65), ("E", Illuminant::EqualEnergy)];

/// The words for masking-shadowing functions.
pub(super) const MASKINGS: &[(&str, Masking)] =
    &[("correlated", Masking::Correlated), ("separable", Masking::Separable)];

/// The words for estimates of coats.
pub(super) const ESTIMATES: &[(&str, CoatEstimate)] =
    &[("unbiased", CoatEstimate::Unbiased), ("pbrt", CoatEstimate::Pbrt)];

/// The keys of a roughness that is not perceptual.
pub(super) const ROUGHNESS: &[&str] = &["alpha", "alpha_squared"];

fn energy(table: &Table<'_>) -> Energy {
    table.or("energy", Energy::default(), |value| value.choice(ENERGIES))
}

/// The energy of a metal, which is conserved only for the microfacets whose albedo is in a table.
fn energy_of_metal(table: &Table<'_>, microfacets: Microfacets) -> Energy {
    let energy = energy(table);
    if energy == Energy::Conserved && microfacets != Microfacets::default() {
        let key = if table.has("distribution") { "distribution" } else { "masking" };
        if let Some(value) = table.find(key) {
            let message = format!("`{key}` is for metals that do not conserve energy");
            value.note(value.error(message).hint("add `energy = \"single_scattering\"`"));
        }
    }
    energy
}

fn microfacets(table: &Table<'_>) -> Microfacets {
    let usual = Microfacets::default();
    Microfacets {
        distribution: table.or("distribution", usual.distribution, |value| value.choice(DISTRIBUTIONS)),
        masking: table.or("masking", usual.masking, |value| value.choice(MASKINGS)),
    }
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
            "conductor" => {
                let roughness = self.rough_microfacets(table);
                MaterialKind::Conductor {
                    metal: self.metal_of(table),
                    roughness,
                    energy: energy_of_metal(table, roughness.microfacets),
                    specular_reflectance: self.color_or(table, "specular_reflectance", 1.0),
                }
            }
            "dielectric" => MaterialKind::Dielectric {
                eta: self.ior_of(table),
                roughness: self.rough_microfacets(table),
                energy: energy(table),
                tint: self.tint(table),
            },
            "thin_dielectric" => {
                MaterialKind::ThinDielectric { eta: self.ior_of(table), tint: self.tint(table) }
            }
            "coated_diffuse" => MaterialKind::CoatedDiffuse {
                reflectance: self.color_or(table, "reflectance", REFLECTANCE),
                coat: self.coat(table),
            },
            "coated_conductor" => MaterialKind::CoatedConductor {
                metal: self.metal_of(table),
                roughness: self.roughness(table, "base_roughness"),
                coat: self.coat(table),
            },
            "plastic" => MaterialKind::Plastic(Box::new(self.plastic(table))),
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
        let illuminant = table.or("illuminant", Illuminant::default(), |value| value.choice(ILLUMINANTS));
        if table.has("metal") {
            return table.or("metal", stand_in, |value| {
                self.metal(value).map(|[eta, k]| Metal::Indices { eta, k, illuminant })
            });
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
            illuminant,
        }
    }

    fn ior_of(&mut self, table: &Table<'_>) -> Ior {
        table.or("ior", Ior::default(), |value| self.ior(value))
    }

    fn tint(&mut self, table: &Table<'_>) -> Tint {
        Tint {
            reflectance: self.color_or(table, "specular_reflectance", 1.0),
            transmittance: self.color_or(table, "specular_transmittance", 1.0),
        }
    }

    fn plastic(&mut self, table: &Table<'_>) -> Plastic {
        let alpha = table.or("roughness", 0.0, |value| {
            let expected = "a number from 0 to 1, or a table such as { alpha = 0.04 }";
            if !value.is_table() {
                let is_share = |roughness: f32| (0.0..=1.0).contains(&roughness);
                return value.single_where(expected, is_share).map(|roughness| roughness * roughness);
            }
            if value.table("a roughness")?.has("type") {
                return Err(value.wrong(expected));
            }
            match self.microfacets(value)? {
                Roughness { u: Scalar::Value(alpha), v, remap: false, .. } if v == Scalar::Value(alpha) => {
                    Ok(alpha)
                }
                _ => Err(value.wrong(expected)),
            }
        });
        Plastic {
            reflectance: self.color_or(table, "reflectance", REFLECTANCE),
            specular_reflectance: self.color_or(table, "specular_reflectance", 1.0),
            eta: table
                .or("ior", Plastic::ETA, |value| value.single_where("a number greater than 0", |n| n > 0.0)),
            alpha,
            microfacets: microfacets(table),
            is_nonlinear: table.or("nonlinear", true, Value::boolean),
        }
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

    /// As [`Self::roughness`], of microfacets of a kind.
    fn rough_microfacets(&mut self, table: &Table<'_>) -> Roughness {
        Roughness { microfacets: microfacets(table), ..self.roughness(table, "roughness") }
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
            Ok(Roughness::of_alphas(u, v))
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
        Ok(Roughness { remap: one.key() == "alpha_squared", ..Roughness::of_alphas(u, v) })
    }

    fn alpha_of(&mut self, value: Value<'_>) -> Result<Scalar> {
        let is_share = |roughness: f32| (0.0..=1.0).contains(&roughness);
        Ok(match self.scalar_where(value, "a number from 0 to 1", is_share)? {
            Scalar::Value(roughness) => Scalar::Value(roughness * roughness),
            Scalar::Texture(id) => self.squared(value, id),
        })
    }
}
