//! `Material "subsurface"`.

use super::Reader;
use super::params::{ParameterType, Parameters};
use super::spectra::Meaning::{Reflectance, Unbounded};
use crate::error::Result;
use crate::material::{Color, MaterialKind, Subsurface, SubsurfaceMedium};

impl Reader<'_, '_> {
    pub(super) fn subsurface(&mut self, p: &Parameters) -> Result<MaterialKind> {
        let g = p.float_where("g", 0.0, "a number between -1 and 1", |g| g.abs() < 1.0)?;
        if p.has("name") && g != 0.0 {
            let message = "\"g\" has no effect on a medium by \"name\": its coefficients are those for 0";
            self.context.warn(&p.place.location(), message);
        }
        Ok(MaterialKind::Subsurface(Box::new(Subsurface {
            medium: self.medium_below(p)?,
            scale: p.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)?,
            g: if p.has("name") { 0.0 } else { g },
            eta: p.positive("eta", Subsurface::ETA)?,
            roughness: self.roughness(p, ["uroughness", "vroughness", "roughness"], 0.0)?,
        })))
    }

    /// The medium by its name, else by its coefficients, else by its effect.
    fn medium_below(&mut self, p: &Parameters) -> Result<SubsurfaceMedium> {
        if let Some(parameter) = p.find("name", &[ParameterType::String])?
            && let Some(name) = p.string("name")?
        {
            return Ok(Self::preset_named(name, "medium", &parameter.place)?.into());
        }
        let absorption = self.color_or_none(p, "sigma_a", Unbounded)?;
        let scattering = self.color_or_none(p, "sigma_s", Unbounded)?;
        let (found, missing) = match (absorption, scattering) {
            (Some(absorption), Some(scattering)) => {
                return Ok(SubsurfaceMedium::Coefficients { absorption, scattering });
            }
            (None, None) => {
                let Some(reflectance) = self.color_or_none(p, "reflectance", Reflectance)? else {
                    return Ok(SubsurfaceMedium::MILK);
                };
                let mean_free_path = self.color(p, "mfp", Color::gray(1.0), Unbounded)?;
                return Ok(SubsurfaceMedium::Reflectance { reflectance, mean_free_path });
            }
            (Some(_), None) => ("sigma_a", "sigma_s"),
            (None, Some(_)) => ("sigma_s", "sigma_a"),
        };
        let error = p.place.invalid(format!("{} has {found:?} without {missing:?}", p.title));
        Err(error.hint("a medium scatters light by \"sigma_s\" and absorbs it by \"sigma_a\": give both"))
    }
}
