//! Which wavelengths does a sample follow?

use crate::spectrum::Spectrum;

/// Four wavelengths of one sample with their densities. After dispersion only the first counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    /// In nm, between 360 and 830.
    pub lambda: [f32; 4],
    /// With which density each was chosen, per nm; 0 for those that no longer count.
    pub pdf: [f32; 4],
}

impl Wavelengths {
    /// Wavelengths by how well the eye sees them, with a density ∝ 1 / cosh²(0.0072 (λ − 538)) on 360 … 830 nm (Radziszewski,
    /// Boryczko, Alda 2009). `u` is in [0, 1); the lanes are at u, u + ¼, u + ½, u + ¾ modulo 1.
    pub fn sample_visible(u: f32) -> Self {
        let tangents = [0.0, 0.25, 0.5, 0.75].map(|shift| {
            let lane = u + shift;
            let lane = if lane > 1.0 { lane - 1.0 } else { lane };
            0.856_910_6 - 1.827_501_9 * lane
        });
        Self {
            lambda: tangents.map(|tangent| 538.0 - 138.888_89 * libm::atanhf(tangent)),
            // cosh² of the inverse of tanh is algebraic.
            pdf: tangents.map(|tangent| 0.003_939_804 * (1.0 - tangent * tangent)),
        }
    }

    /// Lets only the first wavelength count from here on, at four times its weight. Doing so twice is doing so once.
    pub fn terminate_secondary(&mut self) {
        if !self.secondary_terminated() {
            self.pdf = [self.pdf[0] / 4.0, 0.0, 0.0, 0.0];
        }
    }

    /// Whether only the first wavelength counts.
    pub fn secondary_terminated(&self) -> bool {
        self.pdf[1..] == [0.0; 3]
    }

    /// Each lane divided by its density; 0 where that is 0.
    pub(super) fn weighted(&self, radiance: Spectrum) -> Spectrum {
        radiance.zip(Spectrum(self.pdf), |l, pdf| if pdf > 0.0 { l / pdf } else { 0.0 })
    }
}
