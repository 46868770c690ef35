//! `Material "hair"`.

use super::Reader;
use super::params::Parameters;
use super::spectra::Meaning::{Reflectance, Unbounded};
use crate::error::Result;
use crate::material::{Hair, MaterialKind, Pigment, Scalar};

impl Reader<'_, '_> {
    pub(super) fn hair(&mut self, p: &Parameters) -> Result<MaterialKind> {
        Ok(MaterialKind::Hair(Box::new(Hair {
            pigment: self.pigment(p)?,
            eta: self.scalar(p, "eta", Hair::ETA)?,
            beta_m: self.scalar(p, "beta_m", Hair::ROUGHNESS)?,
            beta_n: self.scalar(p, "beta_n", Hair::ROUGHNESS)?,
            alpha: self.scalar(p, "alpha", Hair::ALPHA)?,
        })))
    }

    /// The pigment by its absorption, else by the colour, else by its concentrations, as pbrt prefers them.
    fn pigment(&mut self, p: &Parameters) -> Result<Pigment> {
        const WAYS: [&[&str]; 3] = [&["sigma_a"], &["reflectance", "color"], &["eumelanin", "pheomelanin"]];
        let mut given = WAYS.iter().filter(|names| names.iter().any(|name| p.has(name)));
        if let (Some(first), Some(_)) = (given.next(), given.next()) {
            let message =
                format!("the colour of hair is given in more than one way: only {:?} is used", first[0]);
            self.context.warn(&p.place.location(), message);
            WAYS.iter().filter(|names| *names != first).for_each(|names| p.ignore(names));
        }
        if let Some(absorption) = self.color_or_none(p, "sigma_a", Unbounded)? {
            return Ok(Pigment::Absorption(absorption));
        }
        for name in ["reflectance", "color"] {
            if let Some(reflectance) = self.color_or_none(p, name, Reflectance)? {
                return Ok(Pigment::Reflectance(reflectance));
            }
        }
        let eumelanin = self.scalar_or_none(p, "eumelanin")?;
        let pheomelanin = self.scalar_or_none(p, "pheomelanin")?;
        if eumelanin.is_none() && pheomelanin.is_none() {
            return Ok(Pigment::BROWN);
        }
        let none = Scalar::Value(0.0);
        Ok(Pigment::Melanin {
            eumelanin: eumelanin.unwrap_or(none),
            pheomelanin: pheomelanin.unwrap_or(none),
        })
    }
}
