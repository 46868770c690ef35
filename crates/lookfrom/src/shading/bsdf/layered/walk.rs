//! Random walks between coat and base: their steps, and what leaves in a given direction.

use lookfrom_simd::{Float, Mask, Real};

use super::coat::{coat_f, coat_pdf, sample_coat};
use super::random::Random;
use super::{Base, Layered, transmittance};
use crate::core::elementary::ln;
use crate::core::math::power_heuristic;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::dielectric::Mode;
use crate::shading::bsdf::{DirectionSample, Lobes, is_grazing};

/// Russian roulette: the throughput after a step, and the walks that go on.
#[inline(always)]
pub(super) fn surviving<R: Real>(
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

/// The steps of a walk through the slab.
pub(super) struct Walk<R: Real> {
    pub(super) beta: Spectrum<R>,
    /// Direction of travel.
    pub(super) w: Vector<R>,
    /// Height above the base.
    pub(super) z: R,
    pub(super) alive: R::Mask,
}

/// The places that walks have reached in a step.
pub(super) struct Step<R: Real> {
    /// Walks that are at the coat.
    pub(super) at_coat: R::Mask,
    /// Walks that are at the base.
    pub(super) at_base: R::Mask,
    /// Walks that have met a particle, at the height `next`.
    pub(super) at_particle: R::Mask,
    pub(super) next: R,
    /// Walks that are where they were.
    pub(super) stays: R::Mask,
}

impl<R: Real, B: Base<R>> Layered<B, R> {
    /// Moves walks to the next boundary or particle, and attenuates those that nothing scatters.
    #[inline(always)]
    pub(super) fn step(&self, walk: &mut Walk<R>, random: &mut Random<R>) -> Step<R> {
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
    pub(super) fn turn(walk: &mut Walk<R>, mask: R::Mask, sample: &DirectionSample<R>) {
        walk.alive = walk.alive & (!mask | sample.is_valid);
        let mask = mask & sample.is_valid;
        let beta = walk.beta * sample.f * (Float::abs(sample.wi.z) / sample.pdf);
        walk.beta = Spectrum::select(mask, beta, walk.beta);
        walk.w = Vector::select(mask, sample.wi, walk.w);
    }

    /// One estimate of what enters along `wo` and leaves along `wi`, above the coat; black where a side cannot be
    /// passed.
    ///
    /// Two strategies of leaving through a rough coat are combined by MIS: by the density of sampling the way inside from
    /// `wi` ([`CoatEstimate`](lookfrom_scene::material::CoatEstimate)), or as pbrt has it: that of `wi` given the way.
    #[inline(always)]
    pub(super) fn walk(
        &self,
        [wo, wi]: [Vector<R>; 2],
        random: &mut Random<R>,
        active: R::Mask,
    ) -> Spectrum<R> {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let black = Spectrum::splat(zero);
        let coat_is_specular = self.coat.is_specular();
        let base_is_specular = self.base.is_specular();
        // Enter along `wo`, and find the direction from which light leaves along `wi`.
        let [entry, exit] = self.entry_and_exit([wo, wi], random, active);
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
                    let leaving = coat_f(&self.coat, -walk.w, wi, Mode::Radiance);
                    let weight = power_heuristic(pdf, self.exit_density(-walk.w, wi));
                    let out = transmittance(walk.z - self.thickness, walk.w);
                    let light = walk.beta * (leaving * (out * weight));
                    sum += Spectrum::select(leaves & leaving.gt(zero), light, black);
                }
            }
            if step.at_coat.any() {
                // Reflect at the coat, from inside.
                let u = (random.one(step.at_coat), random.two(step.at_coat));
                let sample = sample_coat(&self.coat, -walk.w, u.0, u.1, Mode::Radiance, Lobes::REFLECTION);
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
                    let leaving = coat_f(&self.coat, -walk.w, wi, Mode::Radiance);
                    let weight = power_heuristic(sample.pdf, self.exit_density(-walk.w, wi));
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
    fn exit_density(&self, w: Vector<R>, wi: Vector<R>) -> R {
        let is_unbiased = self.unbiased.gt(wi.x.like(0.5));
        let (from, to) = (Vector::select(is_unbiased, wi, w), Vector::select(is_unbiased, w, wi));
        coat_pdf(&self.coat, from, to, Lobes::TRANSMISSION)
    }
}
