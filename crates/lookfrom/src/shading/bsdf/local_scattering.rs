//! A BSDF for one outgoing direction ω_o, with everything that depends on ω_o alone computed once.
//!
//! At a surface a path needs three results for the same ω_o: the value and the density for the direction to a
//! light, and a sampled direction. For glTF's layers the terms that depend on ω_o are computed once for all three.
//! The results are those of [`Bsdf::f`], [`Bsdf::pdf`] and [`Bsdf::sample`], bit for bit.

use glam::Vec3;

use super::{Bsdf, BsdfSample, Lobes, Mode, Principled, principled};
use crate::core::spectrum::Spectrum;

/// A BSDF for one outgoing direction ω_o.
pub struct LocalScattering<'a> {
    bsdf: &'a Bsdf,
    wo: Vec3,
    mode: Mode,
    lobes: Lobes,
    /// The precomputed terms of a principled surface.
    principled: Option<&'a principled::LocalScattering>,
}

impl Bsdf {
    /// Calls `ask` with the BSDF for the fixed unit direction `wo`; [`Bsdf::sample`] may choose among `lobes`.
    #[inline]
    pub fn scattering<R>(
        &self,
        wo: Vec3,
        mode: Mode,
        lobes: Lobes,
        ask: impl FnOnce(&LocalScattering<'_>) -> R,
    ) -> R {
        let plain = LocalScattering { bsdf: self, wo, mode, lobes, principled: None };
        match self {
            Self::Principled(look) => principled_toward(look, &plain, ask),
            _ => ask(&plain),
        }
    }
}

/// A separate function, so that other BSDFs need no stack space for the principled one's terms.
#[inline(never)]
fn principled_toward<R>(
    look: &Principled,
    plain: &LocalScattering<'_>,
    ask: impl FnOnce(&LocalScattering<'_>) -> R,
) -> R {
    let principled = look.scattering(plain.wo, plain.lobes);
    ask(&LocalScattering { principled: Some(&principled), ..*plain })
}

impl LocalScattering<'_> {
    /// [`Bsdf::f`] and [`Bsdf::pdf`]; the density is set to 0 where the value is black.
    #[inline]
    pub fn f_and_pdf(&self, wi: Vec3) -> (Spectrum, f32) {
        if let Some(principled) = self.principled {
            return principled.f_and_pdf(wi.into(), self.mode);
        }
        let f = self.bsdf.f(self.wo, wi, self.mode);
        (f, if f.is_black() { 0.0 } else { self.pdf(wi) })
    }

    /// [`Bsdf::pdf`].
    #[inline]
    pub fn pdf(&self, wi: Vec3) -> f32 {
        match self.principled {
            Some(principled) => principled.pdf(wi.into()),
            None => self.bsdf.pdf(self.wo, wi, self.mode, self.lobes),
        }
    }

    /// [`Bsdf::sample`].
    #[inline]
    pub fn sample(&self, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        match self.principled {
            Some(principled) => principled.sample_one(uc, u, self.mode)?.if_useful(),
            None => self.bsdf.sample(self.wo, uc, u, self.mode, self.lobes),
        }
    }
}
