//! Phase functions of media: the distribution over directions of light that a point of a medium scatters. Each is its own density.

use lookfrom_simd::{Mask, Real};

use super::droplets::Droplets;
use super::henyey_greenstein::HenyeyGreenstein;
use crate::core::lanes::width::Width;
use crate::core::vector::Vector;

/// The phase function of a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// That of Henyey and Greenstein.
    HenyeyGreenstein(HenyeyGreenstein),
    /// That of water droplets.
    Droplets(Droplets),
}

/// A lobe of a phase function, as the inspector tells of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhaseLobe {
    pub(crate) name: &'static str,
    /// Its share in the mix.
    pub(crate) weight: f32,
    pub(crate) g: f32,
    /// 0 in that of Henyey and Greenstein.
    pub(crate) alpha: f32,
    /// Its value, per solid angle.
    pub(crate) value: f32,
}

impl Phase {
    /// The lobes, of which droplets have two, with their values for two directions.
    pub(crate) fn lobes(&self, wo: Vector<f32>, wi: Vector<f32>) -> (PhaseLobe, Option<PhaseLobe>) {
        let first = |weight, g, value| PhaseLobe { name: "Henyey-Greenstein", weight, g, alpha: 0.0, value };
        match self {
            Self::HenyeyGreenstein(of) => (first(1.0, of.g(), of.p(wo, wi)), None),
            Self::Droplets(of) => {
                let [ahead, back] = of.lobes(wo, wi);
                let Droplets { g, alpha, weight, .. } = *of;
                let second = PhaseLobe { name: "Draine", weight, g, alpha, value: back };
                (first(1.0 - weight, of.ahead, ahead), Some(second))
            }
        }
    }

    fn droplets(&self) -> Option<&Droplets> {
        match self {
            Self::Droplets(droplets) => Some(droplets),
            Self::HenyeyGreenstein(_) => None,
        }
    }

    fn g(&self) -> f32 {
        match self {
            Self::HenyeyGreenstein(of) => of.g(),
            Self::Droplets(_) => 0.0,
        }
    }
}

/// Phase functions by lane.
#[derive(Clone, Copy)]
pub(crate) struct Phases<R: Real> {
    henyey_greenstein: HenyeyGreenstein<R>,
    /// Droplets and the lanes that have them, if any has.
    droplets: Option<(R::Mask, Droplets<R>)>,
}

impl<R: Real> Phases<R> {
    /// Those of lanes.
    #[inline(always)]
    pub(crate) fn by_lane<W: Width<Real = R>>(width: W, of: impl Fn(usize) -> Phase) -> Self {
        let henyey_greenstein = HenyeyGreenstein::of(width.f32s(
            #[inline(always)]
            |lane| of(lane).g(),
        ));
        // What other lanes have is any numbers.
        let number = |number: fn(&Droplets) -> f32, other: f32| {
            width.f32s(
                #[inline(always)]
                |lane| of(lane).droplets().map_or(other, number),
            )
        };
        let weight = number(|of| of.weight, 0.0);
        let is_droplets = weight.gt(weight.like(0.0));
        let droplets = is_droplets.any().then(|| {
            let [ahead, g] = [number(|of| of.ahead, 0.5), number(|of| of.g, 0.5)];
            let weight = R::select(is_droplets, weight, weight.like(0.5));
            (is_droplets, Droplets { ahead, g, alpha: number(|of| of.alpha, 0.0), weight })
        });
        Self { henyey_greenstein, droplets }
    }

    /// The values, per solid angle; also the densities of [`Self::sample`].
    #[inline(always)]
    pub(crate) fn p(&self, wo: Vector<R>, wi: Vector<R>) -> R {
        let p = self.henyey_greenstein.p(wo, wi);
        match self.droplets {
            None => p,
            Some((is, droplets)) => R::select(is, droplets.p(wo, wi), p),
        }
    }

    /// Directions distributed by [`Self::p`].
    #[inline(always)]
    pub(crate) fn sample(&self, wo: Vector<R>, u: [R; 2]) -> Vector<R> {
        let wi = self.henyey_greenstein.sample(wo, u);
        match self.droplets {
            None => wi,
            Some((is, droplets)) => Vector::select(is, droplets.sample(wo, u), wi),
        }
    }

    /// The lanes that choose Draine's lobe.
    #[inline(always)]
    pub(crate) fn choose_draine(&self, u: R) -> R::Mask {
        let none = u.lt(u);
        self.droplets.map_or(none, |(is, droplets)| is & droplets.chooses_draine(u))
    }
}
