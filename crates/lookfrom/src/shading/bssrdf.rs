//! Subsurface scattering: separable BSSRDFs whose radial profiles are tabulated (photon beam diffusion).
//!
//! Light that enters at p_i along ω_i leaves at p_o along ω_o by S = (1 − F(ω_o)) · S_p(|p_o − p_i|) · S_w(ω_i): Fresnel's
//! transmission at both ends, and between them a profile that depends on the distance alone, as if the surface were flat. `table` has
//! the profiles, [`probe`] samples the other point, and `bsdf::normalized_fresnel` is S_w.
//!
//! Habel, Christensen & Jarosz 2013, Photon Beam Diffusion; the tables are those of pbrt-v4.

mod beam_diffusion;
pub mod probe;
mod spline;
pub(crate) mod table;

use crate::core::spectrum::Spectrum;
pub(crate) use beam_diffusion::fresnel_moment;
use table::{Profile, ProfileTable};

/// The medium below a point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MediumBelow {
    /// σ_t, per unit of length.
    pub extinction: Spectrum,
    /// σ_s / σ_t: 0 … 1.
    pub albedo: Spectrum,
}

impl MediumBelow {
    /// By σ_a and σ_s.
    pub(crate) fn of_coefficients(absorption: Spectrum, scattering: Spectrum) -> Self {
        let extinction = absorption + scattering;
        let share = |lane: usize| {
            if extinction.0[lane] > 0.0 { scattering.0[lane] / extinction.0[lane] } else { 0.0 }
        };
        Self { extinction, albedo: Spectrum([0, 1, 2, 3].map(share)) }
    }

    /// By the effective albedo and the mean free path 1 / σ_t.
    pub(crate) fn of_reflectance(
        table: &ProfileTable,
        reflectance: Spectrum,
        mean_free_path: Spectrum,
    ) -> Self {
        Self {
            extinction: mean_free_path.map(|path| if path > 0.0 { 1.0 / path } else { 0.0 }),
            albedo: reflectance.map(|effective| table.albedo_of(effective)),
        }
    }

    /// The fraction of the light that has entered which leaves again.
    pub(crate) fn effective_albedo(&self, table: &ProfileTable) -> Spectrum {
        self.albedo.map(|albedo| table.effective_albedo(albedo))
    }

    /// Its profiles, lane by lane.
    fn profiles<'a>(&self, table: &'a ProfileTable) -> [Profile<'a>; 4] {
        [0, 1, 2, 3].map(|lane| table.profile(self.extinction.0[lane], self.albedo.0[lane]))
    }
}

#[cfg(test)]
mod tests;
