//! Layered BSDFs: a dielectric coat over an opaque base, by random walks (Guo, Hašan & Zhao 2018).
//!
//! Between the coat (a dielectric boundary) and the base lies a slab of `thickness` in units of the mean free path,
//! which absorbs or scatters. Its scattering has no closed form; `f` estimates it by a short random walk whose
//! random numbers are a hash of a seed, which differs by sample, and of the directions: `f` is a deterministic function
//! whose mean over seeds is right. Over a diffuse base, below a slab without particles, nothing is left to chance: the fraction of light
//! that gets through the coat along each direction is a polynomial ([`CoatInterior`]; only the ways through the coat are sampled
//! where none fits), and what goes to and fro between is a geometric series. `pdf` is also an estimate, of single reflections off
//! the base (there a cosine), mixed with a tenth of a uniform density. `sample` walks until it leaves the coat; only the ratio
//! `f / pdf` of its result is meaningful.
//!
//! This is pbrt-v4's model, including every simplification that is visible in images: the slab absorbs even where
//! nothing scatters (exp(−thickness / cos θ) per crossing), walks are cut off after `max_depth` steps, and both
//! sides scatter alike. `f` misses light from a particle that a smooth base reflects before it leaves through a smooth
//! coat; `sample` finds it.
//!
//! For equal images, pbrt's files take pbrt's weights, too ([`CoatEstimate::Pbrt`]): under a rough coat the MIS weights
//! of the two exit strategies in `f` do not add up to one (9 % too much for roughness 0.4 on white; pbrt's issue 187).
//! `sample` is unbiased in both cases.
//!
//! Guo, Hašan & Zhao 2018 (position-free Monte Carlo).

mod coat;
mod random;
mod walk;

use std::f32::consts::FRAC_1_PI;
use std::fmt;

use glam::Vec3;
use lookfrom_scene::material::CoatEstimate;
use lookfrom_simd::{Float, Mask, Real};

use super::conductor::Conductor;
use super::dielectric::{Dielectric, Mode};
use super::diffuse::Diffuse;
use super::fresnel;
use super::henyey_greenstein::HenyeyGreenstein;
use super::lanes::LaneBsdf;
use super::microfacet::Microfacets;
use super::{Description, DirectionSample, Lobes, MicrofacetFactors, ScatteringFunction, is_grazing};
use crate::core::elementary::exp;
use crate::core::math::{both, power_heuristic};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
pub use coat::{CoatInterior, CoatLayer, DiffuseInterior};
pub(super) use coat::{PLANE, lattice};
use coat::{coat_f, coat_pdf, sample_coat};
use random::{Purpose, Random};
use walk::{Walk, surviving};

/// An opaque BSDF of one lobe, which can be the base under a coat.
pub trait Base<R: Real>: LaneBsdf<R, Prepared = Vector<R>> + Copy {
    /// Knowledge of the light between coat and base; by default there is none.
    type Interior: Copy + fmt::Debug;
    /// The name of such a base under a coat, and what it does.
    const COATED: [&str; 2];

    /// True if it reflects in single directions.
    fn is_specular(&self) -> R::Mask;
    /// The albedo of a base that reflects all light alike into all directions, and what is known of the light above it.
    fn lambertian<'a>(&self, interior: &'a Self::Interior) -> Option<(Spectrum<R>, &'a DiffuseInterior<R>)>;
}

/// A base under a coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layered<B: Base<R>, R: Real = f32> {
    /// The coat's boundary.
    pub(crate) coat: Dielectric<R>,
    /// The base's BSDF.
    pub(crate) base: B,
    /// Single-scattering albedo of the slab.
    pub(crate) albedo: Spectrum<R>,
    /// Thickness of the slab, in mean free paths.
    pub(crate) thickness: R,
    pub(crate) phase: HenyeyGreenstein<R>,
    /// A whole number, as `samples` is.
    pub(crate) max_depth: R,
    pub(crate) samples: R,
    /// 1 for [`CoatEstimate::Unbiased`], 0 for [`CoatEstimate::Pbrt`].
    pub(crate) unbiased: R,
    /// The seed of its walks, in [0, 1).
    pub(crate) seed: R,
    /// Knowledge of the light between coat and base.
    pub(crate) interior: B::Interior,
}

impl Layered<Conductor> {
    /// A coat on a metal, given by its index of refraction and extinction in air: both are divided by the coat's index.
    pub fn coated_conductor(
        eta: Spectrum,
        k: Spectrum,
        roughness: impl Into<Microfacets>,
        coat: &CoatLayer,
        seed: f32,
    ) -> Self {
        let coat_eta = fresnel::valid_eta(coat.eta);
        Self::with_interior(Conductor::new(eta / coat_eta, k / coat_eta, roughness), coat, seed, ())
    }
}

impl Layered<Diffuse> {
    /// A coat on a diffuse base.
    pub fn coated_diffuse(base: Diffuse, coat: &CoatLayer, seed: f32) -> Self {
        Self::with_interior(base, coat, seed, DiffuseInterior::new(coat.interior))
    }
}

/// Transmittance along `w` through `depth` mean free paths of the slab.
#[inline(always)]
fn transmittance<R: Real>(depth: R, w: Vector<R>) -> R {
    let is_empty = !Float::abs(depth).gt(depth.like(f32::MIN_POSITIVE));
    R::select(is_empty, depth.like(1.0), exp(-Float::abs(depth / w.z)))
}

impl<B: Base<f32>> Layered<B> {
    /// A coat on a base, whose indices are those over the coat's; walks of different seeds in [0, 1) are independent.
    fn with_interior(base: B, coat: &CoatLayer, seed: f32, interior: B::Interior) -> Self {
        Self {
            coat: Dielectric::new(coat.eta, coat.roughness),
            base,
            albedo: coat.albedo.map(|lane| lane.clamp(0.0, 1.0)),
            thickness: coat.thickness.max(f32::MIN_POSITIVE),
            phase: HenyeyGreenstein::new(coat.g),
            max_depth: f32::from(coat.max_depth),
            samples: f32::from(coat.samples.max(1)),
            unbiased: f32::from(coat.estimate == CoatEstimate::Unbiased),
            seed,
            interior,
        }
    }
}

impl<B: Base<f32, Interior: Default> + ScatteringFunction> ScatteringFunction for Layered<B> {
    fn lobes(&self) -> Lobes {
        let (coat, base) = (self.coat.lobes(), self.base.lobes());
        let mut lobes = Lobes::REFLECTION;
        if coat.is_specular() {
            lobes |= Lobes::SPECULAR;
        }
        if base.intersects(Lobes::DIFFUSE) || !self.albedo.is_black() {
            lobes |= Lobes::DIFFUSE;
        } else if (coat | base).intersects(Lobes::GLOSSY) {
            lobes |= Lobes::GLOSSY;
        }
        lobes
    }

    fn regularize(&mut self) {
        self.coat.regularize();
        self.base.regularize();
        // It was that of a smoother coat.
        self.interior = B::Interior::default();
    }

    /// A part of what is reflected is reflected by the coat; both sides scatter alike.
    fn factors(&self, wo: Vec3, wi: Vec3, _: bool) -> Vec<MicrofacetFactors> {
        self.coat.factors_of_coat(wo, wi)
    }

    fn description(&self) -> Description {
        let [kind, does] = B::COATED;
        let mut numbers = vec![
            ("coat eta", self.coat.eta.into()),
            ("coat alpha", self.coat.roughness.into()),
            ("coat thickness", self.thickness.into()),
            ("coat albedo", self.albedo.into()),
        ];
        numbers.extend(self.base.description().numbers);
        Description { kind, does, numbers }
    }
}

impl<R: Real, B: Base<R>> Layered<B, R> {
    /// True if there is a lobe that is not specular.
    #[inline(always)]
    pub(super) fn has_density(&self) -> R::Mask {
        self.base.has_density() | !self.albedo.is_black() | !self.coat.is_specular()
    }

    /// The part of [`Self::f`] that the outside of the coat reflects.
    #[inline(always)]
    pub(super) fn off_the_coat(&self, wo: Vector<R>, wi: Vector<R>) -> R {
        let zero = wo.z.like(0.0);
        let is_below = wo.z.lt(zero);
        let (wo, wi) = (wo.negate_where(is_below), wi.negate_where(is_below));
        R::select(wi.z.gt(zero), coat_f(&self.coat, wo, wi, Mode::Radiance), zero)
    }

    /// As [`super::Bsdf::f`].
    #[inline(always)]
    pub(super) fn f(&self, wo: Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        let zero = wo.z.like(0.0);
        // Both sides scatter alike.
        let is_below = wo.z.lt(zero);
        let (wo, wi) = (wo.negate_where(is_below), wi.negate_where(is_below));
        let black = Spectrum::splat(zero);
        let is_lit = !is_grazing(wo) & !is_grazing(wi) & wi.z.gt(zero) & self.has_density();
        if !is_lit.any() {
            return black;
        }
        let mut sum = Spectrum::splat(coat_f(&self.coat, wo, wi, Mode::Radiance)) * self.samples;
        let mut random = Random::new(Purpose::Value, self.seed, wo, [wi.x, wi.y, wi.z]);
        let mut taken = 0.0;
        loop {
            let active = is_lit & self.samples.gt(zero.like(taken));
            if !active.any() {
                // Products of numbers of any size may be too large.
                let mean = (sum / self.samples).map(
                    #[inline(always)]
                    |lane| R::select(Float::is_finite(lane), lane, zero),
                );
                return Spectrum::select(is_lit, mean, black);
            }
            sum += match self.base.lambertian(&self.interior) {
                Some((reflectance, interior)) => {
                    self.through((reflectance, interior), [wo, wi], &mut random, active)
                }
                None => self.walk([wo, wi], &mut random, active),
            };
            taken += 1.0;
        }
    }

    /// One estimate of what enters along `wo` and leaves along `wi`, over a Lambertian base. Where it is known how much of its
    /// light comes back from the coat, the way between is a geometric series.
    #[inline(always)]
    fn through(
        &self,
        (reflectance, interior): (Spectrum<R>, &DiffuseInterior<R>),
        [wo, wi]: [Vector<R>; 2],
        random: &mut Random<R>,
        active: R::Mask,
    ) -> Spectrum<R> {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let is_unknown = interior.internal_reflectance.lt(zero);
        let series = |both: R| {
            reflectance.map(
                #[inline(always)]
                |rho| both * rho / (one - rho * interior.internal_reflectance),
            )
        };
        // What gets through the coat along both directions is known; light is spread by the refraction on one of its ways.
        let is_closed = active & interior.has_transmission();
        let mut sum = Spectrum::splat(zero);
        if is_closed.any() {
            let [there, back] = [interior.transmission_along(wo), interior.transmission_along(wi)];
            let both = there * back * FRAC_1_PI / (self.coat.eta * self.coat.eta);
            sum = Spectrum::select(is_closed, series(both), sum);
        }
        let active = active & !is_closed;
        let is_known = active & !is_unknown;
        if (active & is_unknown).any() {
            let walked = self.walk([wo, wi], random, active & is_unknown);
            sum = Spectrum::select(active & is_unknown, walked, sum);
        }
        if is_known.any() {
            let [entry, exit] = self.entry_and_exit([wo, wi], random, is_known);
            let [entering, leaving] = both(
                [entry, exit],
                #[inline(always)]
                |way| {
                    let passed = transmittance(self.thickness, way.wi) / way.pdf;
                    way.f.0[0] * Float::abs(way.wi.z) * passed
                },
            );
            let both = entering * leaving * FRAC_1_PI;
            sum = Spectrum::select(is_known & exit.is_valid, series(both), sum);
        }
        sum
    }

    /// The directions in which light enters along `wo` and comes from below to leave along `wi`; the second is valid
    /// where both are.
    #[inline(always)]
    fn entry_and_exit(
        &self,
        [wo, wi]: [Vector<R>; 2],
        random: &mut Random<R>,
        active: R::Mask,
    ) -> [DirectionSample<R>; 2] {
        let u = (random.one(active), random.two(active));
        let entry = sample_coat(&self.coat, wo, u.0, u.1, Mode::Radiance, Lobes::TRANSMISSION);
        let enters = active & entry.is_valid;
        let u = (random.one(enters), random.two(enters));
        let exit = sample_coat(&self.coat, wi, u.0, u.1, Mode::Importance, Lobes::TRANSMISSION);
        let is_valid = exit.is_valid & enters;
        [entry, DirectionSample { is_valid, ..exit }]
    }

    /// As [`super::Bsdf::sample`]; only `f / pdf` means anything.
    #[inline(always)]
    pub(super) fn sample(&self, wo: Vector<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        let (zero, one) = (uc.like(0.0), uc.like(1.0));
        let is_below = wo.z.lt(zero);
        let wo = wo.negate_where(is_below);
        let first = sample_coat(&self.coat, wo, uc, u, Mode::Radiance, Lobes::ALL);
        let none = is_below.like(false);
        let mut result = DirectionSample {
            is_valid: first.is_valid & !first.is_transmission,
            is_transmission: none,
            ..first
        };

        let mut random = Random::new(Purpose::Sample, self.seed, wo, [uc, u[0], u[1]]);
        let (mut is_specular, mut is_diffuse) = (first.is_specular, none);
        let beta = first.f * (Float::abs(first.wi.z) / first.pdf);
        let alive = first.is_valid & first.is_transmission;
        let mut walk = Walk { beta, w: first.wi, z: self.thickness, alive };
        for depth in 0_u32.. {
            walk.alive = walk.alive & self.max_depth.gt(zero.like(depth as f32));
            if !walk.alive.any() {
                break;
            }
            (walk.beta, walk.alive) = surviving(walk.beta, depth, walk.alive, &mut random);
            let step = self.step(&mut walk, &mut random);
            walk.alive = walk.alive & !step.stays;
            if step.at_particle.any() {
                let w = self.phase.sample(-walk.w, random.two(step.at_particle));
                walk.alive = walk.alive & !(step.at_particle & is_grazing(w));
                walk.w = Vector::select(step.at_particle, w, walk.w);
                walk.beta = Spectrum::select(step.at_particle, walk.beta * self.albedo, walk.beta);
                walk.z = R::select(step.at_particle, step.next, walk.z);
                is_specular = is_specular & !step.at_particle;
                is_diffuse = is_diffuse | step.at_particle;
            }
            if step.at_base.any() {
                let sample = self.base.sample(&-walk.w, zero, random.two(step.at_base)).if_lit();
                Self::turn(&mut walk, step.at_base, &sample);
                is_specular = is_specular & (!step.at_base | sample.is_specular);
                is_diffuse = is_diffuse | (step.at_base & sample.is_diffuse);
            }
            if step.at_coat.any() {
                let u = (random.one(step.at_coat), random.two(step.at_coat));
                let sample = sample_coat(&self.coat, -walk.w, u.0, u.1, Mode::Radiance, Lobes::ALL);
                Self::turn(&mut walk, step.at_coat, &sample);
                is_specular = is_specular & (!step.at_coat | sample.is_specular);
                let leaves = step.at_coat & walk.alive & sample.is_transmission;
                walk.alive = walk.alive & !leaves;
                let left = DirectionSample {
                    wi: walk.w,
                    f: walk.beta / Float::abs(walk.w.z),
                    pdf: one,
                    eta: one,
                    is_specular,
                    is_diffuse,
                    is_transmission: none,
                    is_valid: leaves,
                };
                result = DirectionSample::select(leaves, left, result);
            }
        }
        DirectionSample { wi: result.wi.negate_where(is_below), ..result }
    }

    /// As [`super::Bsdf::pdf`]. Not inlined, since it is needed twice.
    #[inline(never)]
    pub(super) fn pdf(&self, wo: Vector<R>, wi: Vector<R>) -> R {
        wo.x.at_level(
            #[inline(always)]
            || self.density(wo, wi),
        )
    }

    #[inline(always)]
    fn density(&self, wo: Vector<R>, wi: Vector<R>) -> R {
        const UNIFORM: f32 = 0.25 * FRAC_1_PI;
        let zero = wo.z.like(0.0);
        let is_below = wo.z.lt(zero);
        let (wo, wi) = (wo.negate_where(is_below), wi.negate_where(is_below));
        let is_usable = !is_grazing(wo) & !is_grazing(wi);
        let reflects = is_usable & wi.z.gt(zero);
        let uniform = R::select(is_usable, zero.like(0.1 * UNIFORM), zero);
        if !reflects.any() {
            return uniform;
        }
        let reflecting = coat_pdf(&self.coat, wo, wi, Lobes::REFLECTION);
        // What gets through comes back as from a Lambertian surface.
        let interior = self.base.lambertian(&self.interior);
        let (is_closed, through) = match interior {
            Some((_, interior)) => (interior.has_transmission(), interior.transmission_along(wo)),
            None => (zero.lt(zero), zero),
        };
        let closed = reflecting * (zero.like(1.0) - through) + through * (wi.z * FRAC_1_PI);
        let closed = R::select(reflects, closed * 0.9 + 0.1 * UNIFORM, uniform);
        if is_closed.all() {
            return closed;
        }
        let mut sum = reflecting * self.samples;
        let mut random = Random::new(Purpose::Density, self.seed, wi, [wo.x, wo.y, wo.z]);
        let mut taken = 0.0;
        loop {
            let active = reflects & !is_closed & self.samples.gt(zero.like(taken));
            if !active.any() {
                let estimate = R::select(reflects, sum / self.samples * 0.9 + 0.1 * UNIFORM, uniform);
                return R::select(is_closed, closed, estimate);
            }
            sum = sum + self.once_off_the_base(wo, wi, &mut random, active);
            taken += 1.0;
        }
    }

    /// One estimate of the density of `wi` for light that enters, is reflected by the base once, and leaves.
    #[inline(always)]
    fn once_off_the_base(&self, wo: Vector<R>, wi: Vector<R>, random: &mut Random<R>, active: R::Mask) -> R {
        let zero = wo.z.like(0.0);
        let [entry, exit] = self.entry_and_exit([wo, wi], random, active);
        let passes = active & exit.is_valid;
        let reflecting = self.base.pdf(&-entry.wi, -exit.wi);
        let coat_is_specular = self.coat.is_specular();
        let density = R::select(passes & coat_is_specular, reflecting, zero);
        let scatters = passes & !coat_is_specular;
        if !scatters.any() {
            return density;
        }
        let reflected = self.base.sample(&-entry.wi, zero, random.two(scatters)).if_lit();
        let leaving = coat_pdf(&self.coat, -reflected.wi, wi, Lobes::ALL);
        let both = power_heuristic(exit.pdf, reflecting) * reflecting
            + power_heuristic(reflected.pdf, leaving) * leaving;
        let both = R::select(self.base.is_specular(), leaving, both);
        R::select(scatters & reflected.is_valid, both, density)
    }
}

#[cfg(test)]
mod tests;
