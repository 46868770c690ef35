//! A BSDF for one outgoing direction ω_o, with what depends on that alone computed once.
//!
//! A path needs three things at a surface with the same ω_o: the function and the density for a light's direction, and a
//! direction of its own. What glTF's layers do toward ω_o is worked out once for them. The answers are those of
//! [`Bsdf::f`], [`Bsdf::pdf`] and [`Bsdf::sample`], bit for bit.

use glam::Vec3;

use super::{Bsdf, BsdfSample, Lobes, Mode, Principled, principled};
use crate::core::spectrum::Spectrum;

/// See the file's head.
pub struct LocalScattering<'a> {
    bsdf: &'a Bsdf,
    wo: Vec3,
    mode: Mode,
    lobes: Lobes,
    /// Of a principled surface, unless `wo` is grazing.
    principled: Option<&'a principled::LocalScattering>,
}

impl Bsdf {
    /// Calls `ask` with the scattering toward the unit direction `wo`, where [`Bsdf::sample`] may choose among `lobes`.
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

/// Apart, so that other surfaces need no room for what is known here.
#[inline(never)]
fn principled_toward<R>(
    look: &Principled,
    plain: &LocalScattering<'_>,
    ask: impl FnOnce(&LocalScattering<'_>) -> R,
) -> R {
    let principled = look.scattering(plain.wo, plain.lobes);
    ask(&LocalScattering { principled: principled.as_ref(), ..*plain })
}

impl LocalScattering<'_> {
    /// [`Bsdf::f`] and [`Bsdf::pdf`]; the density is 0 where the function is black, whatever it would be.
    #[inline]
    pub fn f_and_pdf(&self, wi: Vec3) -> (Spectrum, f32) {
        if let Some(principled) = self.principled {
            return principled.f_and_pdf(self.wo, wi, self.mode);
        }
        let f = self.bsdf.f(self.wo, wi, self.mode);
        (f, if f.is_black() { 0.0 } else { self.pdf(wi) })
    }

    /// [`Bsdf::pdf`].
    #[inline]
    pub fn pdf(&self, wi: Vec3) -> f32 {
        match self.principled {
            Some(principled) => principled.pdf(self.wo, wi),
            None => self.bsdf.pdf(self.wo, wi, self.mode, self.lobes),
        }
    }

    /// [`Bsdf::sample`].
    #[inline]
    pub fn sample(&self, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        match self.principled {
            Some(principled) => principled.sample(self.wo, uc, u, self.mode)?.if_useful(),
            None => self.bsdf.sample(self.wo, uc, u, self.mode, self.lobes),
        }
    }
}
