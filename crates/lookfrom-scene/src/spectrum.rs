//! Spectral distributions.
//!
//! A [`Curve`] is a spectrum as a file states it: a constant, a table, a blackbody. Measured ones have names ([`named()`]),
//! or are read from `.spd` files ([`read_spd`]). Besides: the colour matching functions of the standard observer, the
//! sensors of digital cameras, daylight of any temperature, and the RGB colour spaces. Sampling of wavelengths and spectral
//! uplifting of RGB are left to the crate `lookfrom`.

mod camera;
pub mod daylight;
mod dispersion;
mod named;
pub mod observer;
mod read;
pub mod space;

pub use camera::{CameraSensor, swatches};
pub use dispersion::Dispersion;
pub use named::{d50, named, names};
pub use read::read_spd;

/// Shortest wavelength that is rendered, in nm.
pub const SHORTEST: u32 = 360;
/// Longest wavelength that is rendered, in nm.
pub const LONGEST: u32 = 830;

/// A spectrum: a function of wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// One value at all wavelengths.
    Constant(f32),
    /// Linear between entries, 0 outside.
    Tabulated {
        /// In nm, strictly increasing, as many as there are values.
        wavelengths: Vec<f32>,
        /// The value at each wavelength.
        values: Vec<f32>,
    },
    /// Blackbody radiation (Planck 1900), scaled so that its maximum over all wavelengths is 1.
    Blackbody {
        /// The temperature in kelvin; black if it is not above 0.
        kelvin: f32,
    },
}

impl Curve {
    /// The value at a wavelength in nm.
    pub fn at(&self, nm: f32) -> f32 {
        match self {
            Self::Constant(value) => *value,
            Self::Tabulated { wavelengths, values } => tabulated(wavelengths, values, nm),
            Self::Blackbody { kelvin } => blackbody(f64::from(nm), f64::from(*kelvin)) as f32,
        }
    }

    /// The wavelengths in nm from which and to which it may be above 0: those of a table, or all.
    #[cfg(feature = "mitsuba")]
    pub(crate) fn support(&self) -> [f32; 2] {
        match self {
            Self::Tabulated { wavelengths, values } => {
                let is_lit = |value: &f32| *value > 0.0;
                let first = values.iter().position(is_lit).map_or(0, |index| index.saturating_sub(1));
                let last = values.iter().rposition(is_lit).map_or(0, |index| index + 1).min(values.len() - 1);
                [wavelengths[first], wavelengths[last]]
            }
            Self::Constant(_) | Self::Blackbody { .. } => [SHORTEST as f32, LONGEST as f32],
        }
    }

    /// The spectrum with its first and last values extended to the ends of the visible range.
    pub(crate) fn extended(self) -> Self {
        let Self::Tabulated { mut wavelengths, mut values } = self else { return self };
        if wavelengths[0] > SHORTEST as f32 {
            wavelengths.insert(0, SHORTEST as f32 - 1.0);
            values.insert(0, values[0]);
        }
        let last = wavelengths.len() - 1;
        if wavelengths[last] < LONGEST as f32 {
            wavelengths.push(LONGEST as f32 + 1.0);
            values.push(values[last]);
        }
        Self::Tabulated { wavelengths, values }
    }

    /// The spectrum times a factor; `None` for a blackbody, whose scale is fixed.
    fn scaled(self, factor: f32) -> Option<Self> {
        match self {
            Self::Constant(value) => Some(Self::Constant(value * factor)),
            Self::Tabulated { wavelengths, values } => {
                let values = values.into_iter().map(|value| value * factor).collect();
                Some(Self::Tabulated { wavelengths, values })
            }
            Self::Blackbody { .. } => None,
        }
    }
}

fn tabulated(wavelengths: &[f32], values: &[f32], nm: f32) -> f32 {
    // The first entry beyond nm, so that nm lies between it and the previous one.
    let beyond = wavelengths.partition_point(|&wavelength| wavelength <= nm);
    match (wavelengths.get(beyond.wrapping_sub(1)), wavelengths.get(beyond)) {
        (Some(&below), Some(&above)) => {
            let t = (nm - below) / (above - below);
            values[beyond - 1] * (1.0 - t) + values[beyond] * t
        }
        (Some(&last), None) if last == nm => values[beyond - 1],
        _ => 0.0,
    }
}

/// Wien's displacement constant b in m K.
const WIEN: f64 = 2.897_772_1e-3;
/// h c in J m.
const PLANCK_LIGHT: f64 = 6.626_069_57e-34 * SPEED_OF_LIGHT;
/// c in m/s.
const SPEED_OF_LIGHT: f64 = 299_792_458.0;
/// h c / k in m K.
const SECOND_RADIATION: f64 = PLANCK_LIGHT / 1.380_648_8e-23;

/// The spectral radiance of a blackbody (Planck 1900) in W/(m² sr nm), at a wavelength in nm.
#[cfg(feature = "mitsuba")]
pub(crate) fn spectral_radiance(nm: f64, kelvin: f64) -> f64 {
    let peak = WIEN / kelvin;
    let fifth = peak * peak * peak * peak * peak;
    let of_peak = 2.0 * PLANCK_LIGHT * SPEED_OF_LIGHT / (fifth * libm::expm1(SECOND_RADIATION / WIEN));
    // Per metre to per nanometre.
    1e-9 * of_peak * blackbody(nm, kelvin)
}

/// Planck's law relative to its maximum, which is at b / T (Wien's displacement law).
fn blackbody(nm: f64, kelvin: f64) -> f64 {
    if !(kelvin > 0.0 && nm > 0.0) {
        return 0.0;
    }
    // In units of the peak wavelength, only the ratio of the wavelengths and a constant remain.
    let ratio = nm * 1e-9 * kelvin / WIEN;
    let peak = SECOND_RADIATION / WIEN;
    let fifth = ratio * ratio * ratio * ratio * ratio;
    (libm::expm1(peak) / (fifth * libm::expm1(peak / ratio))).min(1.0)
}

#[cfg(test)]
mod tests;
