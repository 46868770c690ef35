//! Layered BSDFs: a dielectric coat over an opaque base, by random walks (Guo, Hašan & Zhao 2018).
//!
//! Between the coat (a dielectric boundary) and the base lies a slab of `thickness` in units of the mean free path,
//! which absorbs or scatters. Its scattering has no closed form; `f` estimates it by a short random walk whose
//! random numbers are a hash of the directions, so that `f` is a deterministic function of its arguments with the
//! right mean. `pdf` is also an estimate, of single reflections off the base, mixed with a tenth of a uniform
//! density. `sample` walks until it leaves the coat; only the ratio `f / pdf` of its result is meaningful.
//!
//! This is pbrt-v4's model, including every simplification that is visible in images: the slab absorbs even where
//! nothing scatters (exp(−thickness / cos θ) per crossing), walks are cut off after `max_depth` steps, and both
//! sides scatter alike. Where pbrt is biased, so is this: under a rough coat the MIS weights of the two exit
//! strategies in `f` do not add up to one (9 % too much for roughness 0.4 on white), and `f` misses light from a
//! particle that is reflected specularly before it leaves through a smooth coat. `sample` is unbiased in both
//! cases. (pbrt's issue 187 shows the first.) So for equal images, the weights of light sampling and of `sample`
//! must also be pbrt's.
//!
//! Guo, Hašan & Zhao 2018 (position-free Monte Carlo).

mod coat;
mod random;

use std::f32::consts::FRAC_1_PI;

use lookfrom_simd::{Float, Mask, Real};

use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::fresnel;
use super::henyey_greenstein::HenyeyGreenstein;
use super::lanes::LaneBsdf;
use super::microfacet::TrowbridgeReitz;
use super::{DirectionSample, Lobes, Mode, is_grazing};
use crate::core::elementary::{exp, ln};
use crate::core::math::power_heuristic;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
pub use coat::CoatLayer;
use coat::{coat_f, coat_pdf, sample_coat};
use random::{Purpose, Random};

/// An opaque BSDF of one lobe, which can be the base under a coat.
pub trait Base<R: Real>: LaneBsdf<R, View = Vector<R>> + Copy {
    /// True if it reflects in single directions.
    fn is_specular(&self) -> R::Mask;
}

/// A base under a coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layered<B, R = f32> {
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
}

impl Layered<Conductor> {
    /// A coat on a metal, given by its index of refraction and extinction in air: both are divided by the coat's index.
    pub fn coated_conductor(
        eta: Spectrum,
        k: Spectrum,
        roughness: TrowbridgeReitz,
        coat: &CoatLayer,
    ) -> Self {
        let coat_eta = fresnel::valid_eta(coat.eta);
        Self::new(Conductor::new(eta / coat_eta, k / coat_eta, roughness), coat)
    }
}

/// Russian roulette: the throughput after a step, and the walks that go on.
#[inline(always)]
fn surviving<R: Real>(
    beta: Spectrum<R>,
    depth: u32,
    alive: R::Mask,
    random: &mut Random<R>,
) -> (Spectrum<R>, R::Mask) {
    let survival = beta.max_lane();
    let in_doubt = alive & survival.lt(survival.like(0.25));
    if depth <= 3 || !in_doubt.any() {
        return (beta, alive);
    }
    let survives = random.one(in_doubt).lt(survival);
    (Spectrum::select(in_doubt, beta / survival, beta), alive & (!in_doubt | survives))
}

/// Transmittance along `w` through `depth` mean free paths of the slab.
#[inline(always)]
fn transmittance<R: Real>(depth: R, w: Vector<R>) -> R {
    let is_empty = !Float::abs(depth).gt(depth.like(f32::MIN_POSITIVE));
    R::select(is_empty, depth.like(1.0), exp(-Float::abs(depth / w.z)))
}

impl<B> Layered<B> {
    /// A coat on a base; the base's indices are those over the coat's.
    pub fn new(base: B, coat: &CoatLayer) -> Self {
        Self {
            coat: Dielectric::new(coat.eta, coat.roughness),
            base,
            albedo: coat.albedo.map(|lane| lane.clamp(0.0, 1.0)),
            thickness: coat.thickness.max(f32::MIN_POSITIVE),
            phase: HenyeyGreenstein::new(coat.g),
            max_depth: f32::from(coat.max_depth),
            samples: f32::from(coat.samples.max(1)),
        }
    }

    /// The kinds of scattering, given the base's.
    pub(super) fn lobes(&self, base: Lobes) -> Lobes {
        let coat = self.coat.lobes();
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
}

/// The steps of a walk through the slab.
struct Walk<R: Real> {
    beta: Spectrum<R>,
    /// Direction of travel.
    w: Vector<R>,
    /// Height above the base.
    z: R,
    alive: R::Mask,
}

/// The places that walks have reached in a step.
struct Step<R: Real> {
    /// Walks that are at the coat.
    at_coat: R::Mask,
    /// Walks that are at the base.
    at_base: R::Mask,
    /// Walks that have met a particle, at the height `next`.
    at_particle: R::Mask,
    next: R,
    /// Walks that are where they were.
    stays: R::Mask,
}

impl<R: Real, B: Base<R>> Layered<B, R> {
    /// True if there is a lobe that is not specular.
    #[inline(always)]
    pub(super) fn has_density(&self) -> R::Mask {
        self.base.has_density() | !self.albedo.is_black() | !self.coat.is_specular()
    }

    /// Moves walks to the next boundary or particle, and attenuates those that nothing scatters.
    #[inline(always)]
    fn step(&self, walk: &mut Walk<R>, random: &mut Random<R>) -> Step<R> {
        let zero = walk.z.like(0.0);
        let none = walk.alive.like(false);
        let mut step = Step { at_coat: none, at_base: none, at_particle: none, next: walk.z, stays: none };
        let scatters = !self.albedo.is_black();
        let mut at_boundary = walk.alive;
        if scatters.any() {
            let moves = walk.alive & scatters;
            // 1 − u is exact.
            step.next = walk.z - ln(zero.like(1.0) - random.one(moves)) * walk.w.z;
            step.stays = moves & Float::eq(step.next, walk.z);
            step.at_particle = moves & step.next.gt(zero) & step.next.lt(self.thickness) & !step.stays;
            at_boundary = at_boundary & !step.at_particle & !step.stays;
            let within = Float::min(Float::max(step.next, zero), self.thickness);
            walk.z = R::select(moves & at_boundary, within, walk.z);
        }
        let crosses = at_boundary & !scatters;
        let other_side = R::select(Float::eq(walk.z, self.thickness), zero, self.thickness);
        walk.z = R::select(crosses, other_side, walk.z);
        let attenuated = walk.beta * transmittance(self.thickness, walk.w);
        walk.beta = Spectrum::select(crosses, attenuated, walk.beta);
        let is_top = Float::eq(walk.z, self.thickness);
        step.at_coat = at_boundary & is_top;
        step.at_base = at_boundary & !is_top;
        step
    }

    /// Goes on in a sampled direction; walks without one end.
    #[inline(always)]
    fn turn(walk: &mut Walk<R>, mask: R::Mask, sample: &DirectionSample<R>) {
        walk.alive = walk.alive & (!mask | sample.is_valid);
        let mask = mask & sample.is_valid;
        let beta = walk.beta * sample.f * (Float::abs(sample.wi.z) / sample.pdf);
        walk.beta = Spectrum::select(mask, beta, walk.beta);
        walk.w = Vector::select(mask, sample.wi, walk.w);
    }

    /// As [`super::Bsdf::f`].
    #[inline(always)]
    pub(super) fn f(&self, wo: Vector<R>, wi: Vector<R>, mode: Mode) -> Spectrum<R> {
        let zero = wo.z.like(0.0);
        // Both sides scatter alike.
        let is_below = wo.z.lt(zero);
        let (wo, wi) = (wo.negate_where(is_below), wi.negate_where(is_below));
        let black = Spectrum::splat(zero);
        let is_lit = !is_grazing(wo) & !is_grazing(wi) & wi.z.gt(zero) & self.has_density();
        if !is_lit.any() {
            return black;
        }
        let mut sum = Spectrum::splat(coat_f(&self.coat, wo, wi, mode)) * self.samples;
        let mut random = Random::new(Purpose::Value, wo, [wi.x, wi.y, wi.z]);
        let mut taken = 0.0;
        loop {
            let active = is_lit & self.samples.gt(zero.like(taken));
            if !active.any() {
                return Spectrum::select(is_lit, sum / self.samples, black);
            }
            sum += self.walk::<false>([wo, wi], mode, &mut random, active);
            taken += 1.0;
        }
    }

    /// One estimate of what enters along `wo` and leaves along `wi`, above the coat; black where a side cannot be
    /// passed.
    ///
    /// Two strategies of leaving through a rough coat are combined by MIS: by the density of sampling the way inside from
    /// `wi` (`UNBIASED`), or as pbrt has it: that of `wi` given the way.
    #[inline(always)]
    fn walk<const UNBIASED: bool>(
        &self,
        [wo, wi]: [Vector<R>; 2],
        mode: Mode,
        random: &mut Random<R>,
        active: R::Mask,
    ) -> Spectrum<R> {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let black = Spectrum::splat(zero);
        let coat_is_specular = self.coat.is_specular();
        let base_is_specular = self.base.is_specular();
        // Enter along `wo`, and find the direction from which light leaves along `wi`.
        let [entry, exit] = self.entry_and_exit([wo, wi], mode, random, active);
        let to_exit = -exit.wi;
        let exit_weight = exit.f / exit.pdf;

        let mut sum = black;
        let beta = entry.f * (Float::abs(entry.wi.z) / entry.pdf);
        let mut walk = Walk { beta, w: entry.wi, z: self.thickness, alive: active & exit.is_valid };
        for depth in 0_u32.. {
            walk.alive = walk.alive & self.max_depth.gt(zero.like(depth as f32));
            if !walk.alive.any() {
                break;
            }
            (walk.beta, walk.alive) = surviving(walk.beta, depth, walk.alive, random);
            let step = self.step(&mut walk, random);
            if step.at_particle.any() {
                // Join the particle with the exit.
                let phase = self.phase.p(-walk.w, to_exit);
                let weight = R::select(coat_is_specular, one, power_heuristic(exit.pdf, phase));
                let out = transmittance(step.next - self.thickness, to_exit);
                let joined = walk.beta * self.albedo * exit_weight * (phase * weight * out);
                sum += Spectrum::select(step.at_particle, joined, black);
                // Scatter, and see whether this leads out, too.
                let wi_in = self.phase.sample(-walk.w, random.two(step.at_particle));
                let pdf = self.phase.p(-walk.w, wi_in);
                let scatters = step.at_particle & !is_grazing(wi_in) & pdf.gt(zero);
                walk.beta = Spectrum::select(scatters, walk.beta * self.albedo, walk.beta);
                walk.w = Vector::select(scatters, wi_in, walk.w);
                walk.z = R::select(scatters, step.next, walk.z);
                let leaves = scatters & walk.w.z.gt(zero) & !coat_is_specular;
                if leaves.any() {
                    let leaving = coat_f(&self.coat, -walk.w, wi, mode);
                    let weight = power_heuristic(pdf, self.exit_density::<UNBIASED>(-walk.w, wi));
                    let out = transmittance(walk.z - self.thickness, walk.w);
                    let light = walk.beta * (leaving * (out * weight));
                    sum += Spectrum::select(leaves & leaving.gt(zero), light, black);
                }
            }
            if step.at_coat.any() {
                // Reflect at the coat, from inside.
                let u = (random.one(step.at_coat), random.two(step.at_coat));
                let sample = sample_coat(&self.coat, -walk.w, u.0, u.1, mode, Lobes::REFLECTION);
                Self::turn(&mut walk, step.at_coat, &sample);
            }
            if step.at_base.any() {
                // Join the base with the exit.
                let joins = step.at_base & !base_is_specular;
                if joins.any() {
                    let weight = power_heuristic(exit.pdf, self.base.pdf(&-walk.w, to_exit));
                    let weight = R::select(coat_is_specular, one, weight);
                    let out = transmittance(self.thickness, to_exit);
                    let factor = Float::abs(to_exit.z) * weight * out;
                    let joined = walk.beta * self.base.f(&-walk.w, to_exit) * exit_weight * factor;
                    sum += Spectrum::select(joins, joined, black);
                }
                // Reflect at the base, and see whether this leads out, too.
                let sample = self.base.sample(&-walk.w, zero, random.two(step.at_base)).if_lit();
                Self::turn(&mut walk, step.at_base, &sample);
                let leaves = step.at_base & walk.alive & !coat_is_specular;
                if leaves.any() {
                    let leaving = coat_f(&self.coat, -walk.w, wi, mode);
                    let weight = power_heuristic(sample.pdf, self.exit_density::<UNBIASED>(-walk.w, wi));
                    let weight = R::select(base_is_specular, one, weight);
                    let light = walk.beta * (leaving * (weight * transmittance(self.thickness, walk.w)));
                    sum += Spectrum::select(leaves & leaving.gt(zero), light, black);
                }
            }
        }
        sum
    }

    /// The density of leaving along `wi` by a direction `w` inside, away from the coat.
    #[inline(always)]
    fn exit_density<const UNBIASED: bool>(&self, w: Vector<R>, wi: Vector<R>) -> R {
        let (from, to) = if UNBIASED { (wi, w) } else { (w, wi) };
        coat_pdf(&self.coat, from, to, Lobes::TRANSMISSION)
    }

    /// The directions in which light enters along `wo` and comes from below to leave along `wi`; the second is valid
    /// where both are.
    #[inline(always)]
    fn entry_and_exit(
        &self,
        [wo, wi]: [Vector<R>; 2],
        mode: Mode,
        random: &mut Random<R>,
        active: R::Mask,
    ) -> [DirectionSample<R>; 2] {
        let adjoint = match mode {
            Mode::Radiance => Mode::Importance,
            Mode::Importance => Mode::Radiance,
        };
        let u = (random.one(active), random.two(active));
        let entry = sample_coat(&self.coat, wo, u.0, u.1, mode, Lobes::TRANSMISSION);
        let enters = active & entry.is_valid;
        let u = (random.one(enters), random.two(enters));
        let exit = sample_coat(&self.coat, wi, u.0, u.1, adjoint, Lobes::TRANSMISSION);
        let is_valid = exit.is_valid & enters;
        [entry, DirectionSample { is_valid, ..exit }]
    }

    /// As [`super::Bsdf::sample`]; only `f / pdf` means anything.
    #[inline(always)]
    pub(super) fn sample(&self, wo: Vector<R>, uc: R, u: [R; 2], mode: Mode) -> DirectionSample<R> {
        let (zero, one) = (uc.like(0.0), uc.like(1.0));
        let is_below = wo.z.lt(zero);
        let wo = wo.negate_where(is_below);
        let first = sample_coat(&self.coat, wo, uc, u, mode, Lobes::ALL);
        let none = is_below.like(false);
        let mut result = DirectionSample {
            is_valid: first.is_valid & !first.is_transmission,
            is_transmission: none,
            ..first
        };

        let mut random = Random::new(Purpose::Sample, wo, [uc, u[0], u[1]]);
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
                let sample = sample_coat(&self.coat, -walk.w, u.0, u.1, mode, Lobes::ALL);
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
    pub(super) fn pdf(&self, wo: Vector<R>, wi: Vector<R>, mode: Mode) -> R {
        wo.x.at_level(
            #[inline(always)]
            || self.density(wo, wi, mode),
        )
    }

    #[inline(always)]
    fn density(&self, wo: Vector<R>, wi: Vector<R>, mode: Mode) -> R {
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
        let mut sum = coat_pdf(&self.coat, wo, wi, Lobes::REFLECTION) * self.samples;
        let mut random = Random::new(Purpose::Density, wi, [wo.x, wo.y, wo.z]);
        let mut taken = 0.0;
        loop {
            let active = reflects & self.samples.gt(zero.like(taken));
            if !active.any() {
                return R::select(reflects, sum / self.samples * 0.9 + 0.1 * UNIFORM, uniform);
            }
            sum = sum + self.once_off_the_base(wo, wi, mode, &mut random, active);
            taken += 1.0;
        }
    }

    /// One estimate of the density of `wi` for light that enters, is reflected by the base once, and leaves.
    #[inline(always)]
    fn once_off_the_base(
        &self,
        wo: Vector<R>,
        wi: Vector<R>,
        mode: Mode,
        random: &mut Random<R>,
        active: R::Mask,
    ) -> R {
        let zero = wo.z.like(0.0);
        let [entry, exit] = self.entry_and_exit([wo, wi], mode, random, active);
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
