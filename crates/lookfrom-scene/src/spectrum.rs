//! Values by wavelength: what a colour is before an eye or a sensor meets it.

/// A value for each wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// The same for all.
    Constant(f32),
    /// Linear between entries, 0 outside.
    Tabulated {
        /// In nm, rising.
        wavelengths: Vec<f32>,
        /// One a wavelength.
        values: Vec<f32>,
    },
    /// Planck's law, scaled so that its greatest value is 1.
    Blackbody {
        /// In kelvin: > 0.
        kelvin: f32,
    },
}
