//! Phase functions of media: the distribution over directions of light that a point of a medium scatters. Each is its own density.

use lookfrom_simd::{Mask, Real};

use super::henyey_greenstein::HenyeyGreenstein;
use super::two_lobes::TwoLobes;
use crate::core::lanes::width::Width;
use crate::core::vector::Vector;

/// The phase function of a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// That of Henyey and Greenstein.
    HenyeyGreenstein(HenyeyGreenstein),
    /// A mix of one of Henyey and Greenstein and one of Draine, as of water droplets.
    TwoLobes(TwoLobes),
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
    /// The lobe, or both, with their values for two directions.
    pub(crate) fn lobes(&self, wo: Vector<f32>, wi: Vector<f32>) -> (PhaseLobe, Option<PhaseLobe>) {
        let first = |weight, g, value| PhaseLobe { name: "Henyey-Greenstein", weight, g, alpha: 0.0, value };
        match self {
            Self::HenyeyGreenstein(of) => (first(1.0, of.g(), of.p(wo, wi)), None),
            Self::TwoLobes(of) => {
                let [ahead, back] = of.lobes(wo, wi);
                let TwoLobes { g, alpha, weight, .. } = *of;
                let second = PhaseLobe { name: "Draine", weight, g, alpha, value: back };
                (first(1.0 - weight, of.ahead, ahead), Some(second))
            }
        }
    }

    fn two_lobes(&self) -> Option<&TwoLobes> {
        match self {
            Self::TwoLobes(lobes) => Some(lobes),
            Self::HenyeyGreenstein(_) => None,
        }
    }

    fn g(&self) -> f32 {
        match self {
            Self::HenyeyGreenstein(of) => of.g(),
            Self::TwoLobes(_) => 0.0,
        }
    }
}

/// Phase functions by lane.
#[derive(Clone, Copy)]
pub(crate) struct Phases<R: Real> {
    henyey_greenstein: HenyeyGreenstein<R>,
    /// Pairs of lobes and the lanes that have them, if any has.
    two_lobes: Option<(R::Mask, TwoLobes<R>)>,
}

impl<R: Real> Phases<R> {
    /// The phase functions of lanes.
    #[inline(always)]
    pub(crate) fn by_lane<W: Width<Real = R>>(width: W, of: impl Fn(usize) -> Phase) -> Self {
        let henyey_greenstein = HenyeyGreenstein::of(width.f32s(
            #[inline(always)]
            |lane| of(lane).g(),
        ));
        // What other lanes have is any numbers.
        let number = |number: fn(&TwoLobes) -> f32, other: f32| {
            width.f32s(
                #[inline(always)]
                |lane| of(lane).two_lobes().map_or(other, number),
            )
        };
        let weight = number(|of| of.weight, 0.0);
        let are_two = weight.gt(weight.like(0.0));
        let two_lobes = are_two.any().then(|| {
            let [ahead, g] = [number(|of| of.ahead, 0.5), number(|of| of.g, 0.5)];
            let weight = R::select(are_two, weight, weight.like(0.5));
            (are_two, TwoLobes { ahead, g, alpha: number(|of| of.alpha, 0.0), weight })
        });
        Self { henyey_greenstein, two_lobes }
    }

    /// The values, per solid angle; also the densities of [`Self::sample`].
    #[inline(always)]
    pub(crate) fn p(&self, wo: Vector<R>, wi: Vector<R>) -> R {
        let p = self.henyey_greenstein.p(wo, wi);
        match self.two_lobes {
            None => p,
            Some((is, two_lobes)) => R::select(is, two_lobes.p(wo, wi), p),
        }
    }

    /// Directions distributed by [`Self::p`].
    #[inline(always)]
    pub(crate) fn sample(&self, wo: Vector<R>, u: [R; 2]) -> Vector<R> {
        let wi = self.henyey_greenstein.sample(wo, u);
        match self.two_lobes {
            None => wi,
            Some((is, two_lobes)) => Vector::select(is, two_lobes.sample(wo, u), wi),
        }
    }

    /// The lanes that choose Draine's lobe.
    #[inline(always)]
    pub(crate) fn choose_draine(&self, u: R) -> R::Mask {
        let none = u.lt(u);
        self.two_lobes.map_or(none, |(is, two_lobes)| is & two_lobes.chooses_draine(u))
    }
}
