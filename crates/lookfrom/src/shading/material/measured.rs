//! Measured materials: their spectra as colours, and their BSDF for a sample.

use lookfrom_scene::measured::{Measured as Written, Tables};

use super::Evaluator;
use crate::core::color::{DenselySampledSpectrum, standard_illuminant};
use crate::shading::bsdf::measured::{Measured, MeasuredTables};
use crate::shading::texture::SpectralMode;

/// The least wavelength of densely sampled spectra, in nm.
const SHORTEST: f32 = 360.0;

/// The compiled tables of a material.
pub(super) fn tables(written: &Written) -> &'static MeasuredTables {
    let wavelengths: &[f32] = match &written.tables {
        Tables::Adaptive(tables) => &tables.wavelengths,
        Tables::HalfAngle(_) => &[],
    };
    let of_wavelengths: Vec<_> = (0..wavelengths.len()).map(|index| color(wavelengths, index)).collect();
    MeasuredTables::kept(written, &of_wavelengths)
}

/// The colour under daylight of what is 1 at one of the wavelengths, 0 at its neighbours and linear between; beyond the ends it stays.
fn color(wavelengths: &[f32], index: usize) -> [f32; 3] {
    let at = |nm: f32| {
        let here = wavelengths[index];
        let neighbour = if nm < here { index.checked_sub(1) } else { Some(index + 1) };
        match neighbour.and_then(|neighbour| wavelengths.get(neighbour)) {
            Some(neighbour) => (1.0 - (nm - here) / (neighbour - here)).max(0.0),
            None => 1.0,
        }
    };
    let daylight = standard_illuminant().samples();
    let lit = std::array::from_fn(|nm| at(SHORTEST + nm as f32) * daylight[nm]);
    DenselySampledSpectrum::from_samples(lit).to_rgb()
}

impl Evaluator<'_> {
    /// The BSDF for the wavelengths of the sample.
    pub(super) fn measured(&self, tables: &'static MeasuredTables) -> Measured {
        let wavelengths = match &*self.mode {
            SpectralMode::Rgb => None,
            SpectralMode::Spectral(wavelengths) => Some(wavelengths.lambda()),
        };
        Measured::new(tables, wavelengths)
    }
}
