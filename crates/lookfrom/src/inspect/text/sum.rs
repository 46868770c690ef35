//! The sum of a sample as text, and what the camera's sensor and the picture make of it.

use std::fmt::{self, Write};

use super::{amount, full, lanes};
use crate::inspect::{DevelopmentReport, Inspection, SensorReport};

impl Inspection {
    pub(super) fn write_sum(&self, f: &mut String) -> fmt::Result {
        writeln!(f, "The sum, in the order in which the film's sample was added up")?;
        for addition in &self.additions {
            writeln!(f, "  {}   ray {} {}", amount(&addition.value), addition.address, addition.term)?;
        }
        let of = match self.camera.projection {
            "lens system" => "and the lens's ",
            "irradiance" => "and the surface's ",
            _ => "",
        };
        writeln!(f, "  = {}   times the filter's {of}weight {}", amount(&self.radiance), self.weight)?;
        let verdict = if self.adds_up { "the same, bit for bit" } else { "NOT the same: please report this" };
        self.write_sensor(f)?;
        writeln!(f, "  = {}   what the film received: {verdict}", lanes(&self.film))
    }

    /// The steps of the sensor, where it changes a sample.
    fn write_sensor(&self, f: &mut String) -> fmt::Result {
        if self.wavelengths.is_some() {
            writeln!(f, "  measured by the camera's sensor")?;
        }
        let SensorReport { camera, imaging_ratio, white_balance, matrix, max_component, scaled_by } =
            &self.sensor;
        if let Some(camera) = camera {
            writeln!(f, "  by the responses of {camera}")?;
        }
        if *imaging_ratio != 1.0 {
            writeln!(f, "  times the imaging ratio {}", full(*imaging_ratio))?;
        }
        if let Some(kelvin) = white_balance {
            writeln!(f, "  white-balanced for light of {} K", full(*kelvin))?;
        }
        if let Some(rows) = matrix {
            writeln!(f, "  together the matrix, by rows, {}", rows.map(|row| lanes(&row)).join(" "))?;
        }
        if *scaled_by != 1.0 {
            let (limit, scale) = (full(*max_component), full(*scaled_by));
            writeln!(f, "  limited: a channel is above max_component {limit}; all are scaled by {scale}")?;
        }
        Ok(())
    }

    /// From the film to the picture.
    pub(super) fn write_development(&self, f: &mut String) -> fmt::Result {
        let DevelopmentReport { exposure, tonemap, denoise } = &self.development;
        let [red, green, blue] = self.color8;
        writeln!(
            f,
            "  then: × 2^{} (exposure), tone map {tonemap}, sRGB: {red} {green} {blue}",
            full(*exposure)
        )?;
        match denoise {
            true => {
                writeln!(f, "  then: denoising mixes the mean of all samples with those of its neighbours")
            }
            false => Ok(()),
        }
    }
}
