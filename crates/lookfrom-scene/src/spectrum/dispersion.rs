//! Formulas of dispersion: indices of refraction by wavelength, from the numbers that makers of glass publish.

use super::{Curve, LONGEST, SHORTEST};

/// The Fraunhofer lines F, d and C, in nm: blue, yellow and red.
const LINES: [f64; 3] = [486.132_7, 587.561_8, 656.272_5];

/// A formula of an index n. Wavelengths λ are in µm.
#[derive(Clone, Debug, PartialEq)]
pub enum Dispersion {
    /// n = A + B / λ² + C / λ⁴ + … (Cauchy 1836): A, B, C, ….
    Cauchy(Vec<f64>),
    /// n² = 1 + Σ B λ² / (λ² − C) (Sellmeier 1872): pairs of B and C, in µm².
    Sellmeier(Vec<[f64; 2]>),
}

impl Dispersion {
    /// Cauchy's formula of two terms by the index at the yellow line d, and Abbe's number (n_d − 1) / (n_F − n_C).
    pub fn of_abbe(n_d: f64, abbe: f64) -> Self {
        let [f, d, c] = LINES.map(|nm| 1e6 / (nm * nm));
        let b = (n_d - 1.0) / (abbe * (f - c));
        Self::Cauchy(vec![n_d - b * d, b])
    }

    /// The index at a wavelength in nm; not a number, or none above 0, where the formula has none.
    pub fn at(&self, nm: f64) -> f64 {
        let square = nm * nm * 1e-6;
        match self {
            Self::Cauchy(terms) => terms.iter().rev().fold(0.0, |sum, term| sum / square + term),
            Self::Sellmeier(terms) => {
                let sum: f64 = terms.iter().map(|[b, c]| b * square / (square - c)).sum();
                (1.0 + sum).sqrt()
            }
        }
    }

    /// The indices at all whole nm that are rendered.
    ///
    /// # Errors
    /// A wavelength in nm at which there is no index above 0.
    pub fn curve(&self) -> Result<Curve, u32> {
        let value = |nm: u32| {
            let index = self.at(f64::from(nm)) as f32;
            if index > 0.0 && index.is_finite() { Ok(index) } else { Err(nm) }
        };
        let values = (SHORTEST..=LONGEST).map(value).collect::<Result<_, _>>()?;
        Ok(Curve::Tabulated { wavelengths: (SHORTEST..=LONGEST).map(|nm| nm as f32).collect(), values })
    }
}
