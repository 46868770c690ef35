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

use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

use super::dielectric::Dielectric;
use super::henyey_greenstein::HenyeyGreenstein;
use super::microfacet::TrowbridgeReitz;
use super::{BsdfSample, Lobes, Mode, is_grazing};
use crate::core::hash;
use crate::core::spectrum::Spectrum;

/// An opaque BSDF, which can be the base under a coat.
pub trait Base: Copy {
    /// As [`super::Bsdf::f`].
    fn f(&self, wo: Vec3, wi: Vec3) -> Spectrum;
    /// As [`super::Bsdf::pdf`].
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32;
    /// As [`super::Bsdf::sample`], without a choice between lobes.
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample>;
    /// As [`super::Bsdf::lobes`].
    fn lobes(&self) -> Lobes;
    /// As [`super::Bsdf::regularize`].
    fn regularize(&mut self);
}

/// A coat: a dielectric boundary and the slab below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatLayer {
    /// Index of refraction over that outside; 0 counts as 1.
    pub eta: f32,
    /// Roughness of the boundary.
    pub roughness: TrowbridgeReitz,
    /// Thickness of the slab, in mean free paths.
    pub thickness: f32,
    /// Single-scattering albedo of the slab's particles, clamped to 0 … 1; black for no particles.
    pub albedo: Spectrum,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// Maximum number of steps of a walk.
    pub max_depth: u16,
    /// Number of walks that are averaged, at least one.
    pub samples: u16,
}

impl Default for CoatLayer {
    /// pbrt's defaults.
    fn default() -> Self {
        Self {
            eta: 1.5,
            roughness: TrowbridgeReitz::SMOOTH,
            thickness: 0.01,
            albedo: Spectrum::BLACK,
            g: 0.0,
            max_depth: 10,
            samples: 1,
        }
    }
}

/// A base under a coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layered<B> {
    /// The coat's boundary.
    pub(crate) coat: Dielectric,
    /// The base's BSDF.
    pub(crate) base: B,
    /// Single-scattering albedo of the slab.
    pub(crate) albedo: Spectrum,
    /// Thickness of the slab, in mean free paths.
    pub(crate) thickness: f32,
    phase: HenyeyGreenstein,
    max_depth: u16,
    samples: u16,
}

/// Purpose of a walk's random numbers, so that walks for different purposes are independent.
#[derive(Clone, Copy)]
enum Purpose {
    Value = 1,
    Sample,
    Density,
}

/// Random numbers in [0, 1) that are a function of their seed.
struct Random(u64);

impl Random {
    #[inline]
    fn new(purpose: Purpose, wo: Vec3, rest: [f32; 3]) -> Self {
        let [x, y, z] = wo.to_array().map(|c| u64::from(c.to_bits()));
        let [a, b, c] = rest.map(|c| u64::from(c.to_bits()));
        Self(hash::pair(hash::pair(hash::pair(purpose as u64, x << 32 | y), z << 32 | a), b << 32 | c))
    }

    #[inline]
    fn one(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(hash::GOLDEN);
        (hash::mix(self.0) >> 40) as f32 * (1.0 / 16_777_216.0)
    }

    #[inline]
    fn two(&mut self) -> [f32; 2] {
        [self.one(), self.one()]
    }
}

/// MIS weight of the first of two strategies with the given densities (Veach's power heuristic); the first is
/// positive.
#[inline]
fn power_heuristic(pdf: f32, other: f32) -> f32 {
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}

/// Russian roulette: the throughput after a step, or `None` for a walk that was terminated.
#[inline]
fn surviving(beta: Spectrum, depth: u16, random: &mut Random) -> Option<Spectrum> {
    let survival = beta.max_lane();
    if depth <= 3 || survival >= 0.25 {
        return Some(beta);
    }
    (random.one() < survival).then(|| beta / survival)
}

/// Transmittance over `depth` mean free paths of slab along `w`.
#[inline]
fn transmittance(depth: f32, w: Vec3) -> f32 {
    if depth.abs() <= f32::MIN_POSITIVE { 1.0 } else { libm::expf(-(depth / w.z).abs()) }
}

/// A sample that carries light.
#[inline]
fn useful(sample: Option<BsdfSample>) -> Option<BsdfSample> {
    sample.filter(|s| s.pdf > 0.0 && !is_grazing(s.wi) && !s.f.is_black())
}

impl<B: Base> Layered<B> {
    /// A coat on a base; the base's indices are relative to the coat's.
    pub fn new(base: B, coat: &CoatLayer) -> Self {
        Self {
            coat: Dielectric::new(coat.eta, coat.roughness),
            base,
            albedo: coat.albedo.map(|lane| lane.clamp(0.0, 1.0)),
            thickness: coat.thickness.max(f32::MIN_POSITIVE),
            phase: HenyeyGreenstein::new(coat.g),
            max_depth: coat.max_depth,
            samples: coat.samples.max(1),
        }
    }

    pub(super) fn regularize(&mut self) {
        self.coat.regularize();
        self.base.regularize();
    }

    pub(super) fn lobes(&self) -> Lobes {
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

    pub(super) fn f(&self, wo: Vec3, wi: Vec3, mode: Mode) -> Spectrum {
        // Both sides scatter alike.
        let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
        if is_grazing(wo) || is_grazing(wi) || wi.z < 0.0 || !self.lobes().is_non_specular() {
            return Spectrum::BLACK;
        }
        let samples = f32::from(self.samples);
        let mut sum = self.coat.f(wo, wi, mode) * samples;
        let mut random = Random::new(Purpose::Value, wo, wi.to_array());
        // The density of the exit direction as in pbrt: of `wi` given the direction inside, not of the
        // direction inside given `wi`.
        let exit_density = |w| self.coat.pdf(w, wi, Lobes::TRANSMISSION);
        for _ in 0..self.samples {
            sum += self.walk([wo, wi], mode, &mut random, exit_density).unwrap_or(Spectrum::BLACK);
        }
        sum / samples
    }

    /// One estimate of the light that enters along `wo` and leaves along `wi`; `None` where a side cannot
    /// be passed.
    ///
    /// Two strategies of leaving through a rough coat are combined by MIS: `exit_density` of a direction (away from
    /// the coat, inside) should be the density of sampling it from `wi`.
    #[inline]
    fn walk(
        &self,
        [wo, wi]: [Vec3; 2],
        mode: Mode,
        random: &mut Random,
        exit_density: impl Fn(Vec3) -> f32,
    ) -> Option<Spectrum> {
        let adjoint = match mode {
            Mode::Radiance => Mode::Importance,
            Mode::Importance => Mode::Radiance,
        };
        let coat_is_specular = self.coat.lobes().is_specular();
        let base_is_specular = self.base.lobes().is_specular();
        let scatters = !self.albedo.is_black();
        // Enter along `wo`, and sample the direction inside from which light leaves along `wi`.
        let entry = self.coat.sample(wo, random.one(), random.two(), mode, Lobes::TRANSMISSION);
        let entry = useful(entry)?;
        let exit = self.coat.sample(wi, random.one(), random.two(), adjoint, Lobes::TRANSMISSION);
        let exit = useful(exit)?;
        let to_exit = -exit.wi;
        let exit_weight = exit.f / exit.pdf;

        let mut sum = Spectrum::BLACK;
        let mut beta = entry.f * (entry.wi.z.abs() / entry.pdf);
        let mut w = entry.wi;
        let mut z = self.thickness;
        for depth in 0..self.max_depth {
            match surviving(beta, depth, random) {
                Some(survivor) => beta = survivor,
                None => break,
            }
            if scatters {
                // Advance to the next particle.
                let next = self.next_depth(z, w, random);
                if next == z {
                    continue;
                }
                if 0.0 < next && next < self.thickness {
                    // Connect it with the exit.
                    let phase = self.phase.p(-w, to_exit);
                    let weight = if coat_is_specular { 1.0 } else { power_heuristic(exit.pdf, phase) };
                    let out = transmittance(next - self.thickness, to_exit);
                    sum += beta * self.albedo * exit_weight * (phase * weight * out);
                    // Scatter, and connect with the exit by this strategy, too.
                    let turned = self.phase.sample(-w, random.two());
                    let pdf = self.phase.p(-w, turned);
                    if is_grazing(turned) || !(pdf > 0.0) {
                        continue;
                    }
                    beta *= self.albedo;
                    w = turned;
                    z = next;
                    if w.z > 0.0 && !coat_is_specular {
                        let leaving = self.coat.f(-w, wi, mode);
                        if !leaving.is_black() {
                            let weight = power_heuristic(pdf, exit_density(-w));
                            let out = transmittance(z - self.thickness, w);
                            sum += beta * leaving * (out * weight);
                        }
                    }
                    continue;
                }
                z = next.clamp(0.0, self.thickness);
            } else {
                z = if z == self.thickness { 0.0 } else { self.thickness };
                beta = beta * transmittance(self.thickness, w);
            }
            if z == self.thickness {
                // Reflect at the coat, from inside.
                let sample = self.coat.sample(-w, random.one(), random.two(), mode, Lobes::REFLECTION);
                let Some(sample) = useful(sample) else { break };
                beta *= sample.f * (sample.wi.z.abs() / sample.pdf);
                w = sample.wi;
                continue;
            }
            // Connect the base with the exit.
            if !base_is_specular {
                let weight = if coat_is_specular {
                    1.0
                } else {
                    power_heuristic(exit.pdf, self.base.pdf(-w, to_exit))
                };
                let out = transmittance(self.thickness, to_exit);
                sum += beta * self.base.f(-w, to_exit) * exit_weight * (to_exit.z.abs() * weight * out);
            }
            // Reflect at the base, and connect with the exit by this strategy, too.
            let Some(sample) = useful(self.base.sample(-w, random.two())) else { break };
            beta *= sample.f * (sample.wi.z.abs() / sample.pdf);
            w = sample.wi;
            if !coat_is_specular {
                let leaving = self.coat.f(-w, wi, mode);
                if !leaving.is_black() {
                    let weight =
                        if base_is_specular { 1.0 } else { power_heuristic(sample.pdf, exit_density(-w)) };
                    sum += beta * leaving * (weight * transmittance(self.thickness, w));
                }
            }
        }
        Some(sum)
    }

    /// Depth of the next particle along `w` from depth `z`, perhaps beyond the slab.
    #[inline]
    fn next_depth(&self, z: f32, w: Vec3, random: &mut Random) -> f32 {
        z - libm::log1pf(-random.one()) * w.z
    }

    pub(super) fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2], mode: Mode) -> Option<BsdfSample> {
        let flipped = wo.z < 0.0;
        let wo = if flipped { -wo } else { wo };
        let turn_back = |wi: Vec3| if flipped { -wi } else { wi };
        let first = useful(self.coat.sample(wo, uc, u, mode, Lobes::ALL))?;
        if first.lobe.is_reflection() {
            return Some(BsdfSample { wi: turn_back(first.wi), pdf_is_proportional: true, ..first });
        }
        let mut random = Random::new(Purpose::Sample, wo, [uc, u[0], u[1]]);
        let scatters = !self.albedo.is_black();
        let mut all_specular = first.lobe.is_specular();
        let mut beta = first.f * (first.wi.z.abs() / first.pdf);
        let mut w = first.wi;
        let mut z = self.thickness;
        for depth in 0..self.max_depth {
            beta = surviving(beta, depth, &mut random)?;
            if scatters {
                let next = self.next_depth(z, w, &mut random);
                if next == z {
                    return None;
                }
                if 0.0 < next && next < self.thickness {
                    w = self.phase.sample(-w, random.two());
                    if is_grazing(w) {
                        return None;
                    }
                    beta *= self.albedo;
                    all_specular = false;
                    z = next;
                    continue;
                }
                z = next.clamp(0.0, self.thickness);
            } else {
                z = if z == self.thickness { 0.0 } else { self.thickness };
                beta = beta * transmittance(self.thickness, w);
            }
            let sample = if z == 0.0 {
                self.base.sample(-w, random.two())
            } else {
                self.coat.sample(-w, random.one(), random.two(), mode, Lobes::ALL)
            };
            let sample = useful(sample)?;
            beta *= sample.f * (sample.wi.z.abs() / sample.pdf);
            all_specular &= sample.lobe.is_specular();
            w = sample.wi;
            if sample.lobe.is_transmission() {
                let spread = if all_specular { Lobes::SPECULAR } else { Lobes::GLOSSY };
                let left = BsdfSample::new(turn_back(w), beta / w.z.abs(), 1.0, Lobes::REFLECTION | spread);
                return Some(BsdfSample { pdf_is_proportional: true, ..left });
            }
        }
        None
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3, mode: Mode) -> f32 {
        let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
        const UNIFORM: f32 = 0.25 * FRAC_1_PI;
        if is_grazing(wo) || is_grazing(wi) {
            return 0.0;
        }
        if wi.z < 0.0 {
            return 0.1 * UNIFORM;
        }
        let samples = f32::from(self.samples);
        let mut sum = samples * self.coat.pdf(wo, wi, Lobes::REFLECTION);
        let mut random = Random::new(Purpose::Density, wi, wo.to_array());
        for _ in 0..self.samples {
            sum += self.once_off_the_base(wo, wi, mode, &mut random).unwrap_or(0.0);
        }
        0.9 * (sum / samples) + 0.1 * UNIFORM
    }

    /// One estimate of the density of `wi` for light that enters, is reflected by the base once, and leaves.
    #[inline]
    fn once_off_the_base(&self, wo: Vec3, wi: Vec3, mode: Mode, random: &mut Random) -> Option<f32> {
        let adjoint = match mode {
            Mode::Radiance => Mode::Importance,
            Mode::Importance => Mode::Radiance,
        };
        let entry = useful(self.coat.sample(wo, random.one(), random.two(), mode, Lobes::TRANSMISSION))?;
        let exit = useful(self.coat.sample(wi, random.one(), random.two(), adjoint, Lobes::TRANSMISSION))?;
        if self.coat.lobes().is_specular() {
            return Some(self.base.pdf(-entry.wi, -exit.wi));
        }
        let reflected = useful(self.base.sample(-entry.wi, random.two()))?;
        let leaving = self.coat.pdf(-reflected.wi, wi, Lobes::ALL);
        if self.base.lobes().is_specular() {
            return Some(leaving);
        }
        let reflecting = self.base.pdf(-entry.wi, -exit.wi);
        Some(
            power_heuristic(exit.pdf, reflecting) * reflecting
                + power_heuristic(reflected.pdf, leaving) * leaving,
        )
    }
}

#[cfg(test)]
mod tests;
