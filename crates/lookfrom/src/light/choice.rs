//! Light samplers: choice of one light at a point (uniform, by power, by a light tree).
//!
//! Each light infinitely far away is chosen with the same probability as the whole light tree of those that have a
//! position, as in pbrt-v4. Lights that BSDF sampling finds as well (a uniform sky) need not be sampled: they have
//! probability 0.

use lookfrom_scene::settings::LightSampler as Kind;
use lookfrom_simd::{Float, LaneMask, Simd, f32x8, f64x8, prelude::*};

use super::derivation::Derivation;
use super::power::Powers;
use super::tree::{LightBounds, Tree};
use super::{Light, LightSampleContext};
use crate::core::distribution::Discrete;
use crate::core::lanes::{LANES, by_lane, row, store, store_f64};
use crate::core::sampler::ONE_MINUS_EPSILON;
use crate::core::vector::Vector;
use crate::shading::texture::Textures;

/// A light that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChosenLight {
    /// Its index in the world.
    pub light: u32,
    /// The probability of the choice.
    pub probability: f32,
    /// The position of `u` in the interval that chooses it: a number in [0, 1) for the choice of a point on the light, so
    /// that the points on each light stay well distributed.
    pub rest: f32,
}

/// A distribution over lights.
#[derive(Clone, Debug)]
pub struct LightChoice {
    kind: Kind,
    /// Lights without a position (or, if there is no tree, all lights) …
    listed: Vec<u32>,
    /// … by weight; uniform if `None`.
    weights: Option<Discrete>,
    /// For each light of the world, its index in `listed`.
    places: Vec<Option<u32>>,
    tree: Tree,
    powers: Powers,
}

impl LightChoice {
    /// The distribution over the lights that need to be sampled, given the brightness of each; `radius` is that of the
    /// scene, for the power of lights infinitely far away.
    pub fn new(kind: Kind, lights: &[Light], brightness: Vec<f32>, radius: f32) -> Self {
        Self::of_powers(kind, lights, Powers::new(lights, brightness, radius))
    }

    /// The distribution over the same lights, of which others may need to be sampled.
    pub(crate) fn among(&self, lights: &[Light]) -> Self {
        Self::of_powers(self.kind, lights, self.powers.among(lights))
    }

    fn of_powers(kind: Kind, lights: &[Light], powers: Powers) -> Self {
        let mut listed: Vec<u32> = Vec::new();
        let mut weights: Vec<f32> = Vec::new();
        let mut with_place: Vec<(u32, LightBounds)> = Vec::new();
        for (index, light) in (0..).zip(lights).filter(|(_, light)| light.is_sampled()) {
            let power = powers.relative(index, light);
            match light.bounds(power) {
                Some(bounds) if kind == Kind::Bvh => with_place.push((index, bounds)),
                _ => {
                    listed.push(index);
                    weights.push(power);
                }
            }
        }
        let mut places = vec![None; lights.len()];
        for (place, light) in (0..).zip(&listed) {
            places[*light as usize] = Some(place);
        }
        let weights = (kind == Kind::Power && !listed.is_empty()).then(|| Discrete::new(&weights));
        Self { kind, listed, weights, places, tree: Tree::new(&with_place, lights.len()), powers }
    }

    /// The light to sample at a point, for `u ∈ [0, 1)`.
    pub fn sample(&self, at: &LightSampleContext, u: f32) -> Option<ChosenLight> {
        if let Some(weights) = &self.weights {
            let (place, probability, rest) = weights.sample(u);
            return Some(ChosenLight { light: self.listed[place], probability, rest });
        }
        let in_list = self.share_of_list();
        if u < in_list {
            let count = self.listed.len();
            let at = u / in_list * count as f32;
            let place = (at as usize).min(count - 1);
            let rest = (at - place as f32).min(ONE_MINUS_EPSILON);
            return Some(ChosenLight {
                light: self.listed[place],
                probability: in_list / count as f32,
                rest,
            });
        }
        let u = ((u - in_list) / (1.0 - in_list)).min(ONE_MINUS_EPSILON);
        let chosen = self.tree.sample(at.point.as_vec3(), at.n, u)?;
        Some(ChosenLight { probability: chosen.probability * (1.0 - in_list), ..chosen })
    }

    /// [`LightChoice::sample`] for eight surfaces at once, in the lanes of a mask.
    #[inline(always)]
    pub(crate) fn sample_lanes<S: Simd>(
        &self,
        simd: S,
        points: Vector<f64x8<S>>,
        n: Vector<f32x8<S>>,
        u: f32x8<S>,
        mask: u32,
    ) -> [Option<ChosenLight>; LANES] {
        if let Some(weights) = &self.weights {
            let (places, probabilities, rests) = weights.sample_lanes(simd, u);
            return by_lane!(lane => match mask & 1 << lane {
                0 => None,
                _ => Some(ChosenLight {
                    light: self.listed[places[lane]],
                    probability: probabilities[lane],
                    rest: rests[lane],
                }),
            });
        }
        let is_listed = self.tree.is_empty();
        let (in_list, mut listed, mut chosen) = (self.share_of_list(), mask, [None; LANES]);
        if !is_listed {
            listed &= u.simd_lt(in_list).to_bitmask() as u32;
            let rest = (u - in_list) / (1.0 - in_list);
            let rest = Float::min(rest, rest.like(ONE_MINUS_EPSILON));
            chosen = self.tree.sample_lanes(simd, Vector::narrow(points), n, rest, mask & !listed);
            for ChosenLight { probability, .. } in chosen.iter_mut().flatten() {
                *probability *= 1.0 - in_list;
            }
        }
        if listed != 0 {
            let (points, normals, numbers) = (store_f64(points), store(n), <[f32; LANES]>::from(u));
            for lane in LaneMask(listed) {
                let at = LightSampleContext {
                    point: row(&points, lane).into(),
                    n: row(&normals, lane).into(),
                    time: 0.0,
                };
                chosen[lane] = self.sample(&at, numbers[lane]);
            }
        }
        chosen
    }

    /// Whether no light needs to be sampled.
    pub(crate) fn is_empty(&self) -> bool {
        self.listed.is_empty() && self.tree.is_empty()
    }

    /// Whether a light is sampled that has no place in the light tree.
    pub(crate) fn is_listed(&self, light: u32) -> bool {
        self.places[light as usize].is_some()
    }

    /// The only light that is sampled, if there is only one.
    #[inline]
    pub(crate) fn only(&self) -> Option<u32> {
        match *self.listed {
            [] => self.tree.only(),
            [light] if self.tree.is_empty() => Some(light),
            _ => None,
        }
    }

    /// The probability with which [`LightChoice::sample`] chooses a light at a point.
    pub fn probability(&self, at: &LightSampleContext, light: u32) -> f32 {
        match (self.places[light as usize], &self.weights) {
            (Some(place), Some(weights)) => weights.pdf(place as usize),
            (Some(_), None) => self.share_of_list() / self.listed.len() as f32,
            (None, _) => {
                (1.0 - self.share_of_list()) * self.tree.probability(at.point.as_vec3(), at.n, light)
            }
        }
    }

    /// The formula of a light's probability at a point, and then those of its operands.
    pub(crate) fn derivations(
        &self,
        lights: &[Light],
        textures: &Textures,
        at: &LightSampleContext,
        light: u32,
    ) -> Vec<Derivation> {
        let of_light = || self.powers.derivation(textures, light, &lights[light as usize]);
        let place = self.places.get(light as usize).copied().flatten();
        let weight = |place: u32| self.weights.as_ref().map(|weights| weights.weight(place as usize));
        if let Some([power, sum]) = place.and_then(weight) {
            let choice = Derivation::new(
                "P = power / sum of all powers, of which the greatest is 1",
                vec![("power", vec![power]), ("sum", vec![sum])],
            );
            return [choice].into_iter().chain(of_light()).collect();
        }
        let (list, has_tree) = (self.listed.len() as f64, !self.tree.is_empty());
        let others = vec![("listed", vec![list]), ("trees", vec![f64::from(u8::from(has_tree))])];
        if place.is_some() {
            return vec![Derivation::new("P = 1 / (listed + trees)", others)];
        }
        let way = self.tree.way(at.point.as_vec3(), at.n, light);
        let pairs = way
            .iter()
            .map(|[(chosen, _), (other, _)]| ("importances", [*chosen, *other].map(f64::from).to_vec()));
        let choice = Derivation::new(
            "P = trees / (listed + trees) · the product of chosen / (chosen + other) of all importances, within 2⁻¹⁶ … 1 − 2⁻¹⁶ \
             where neither is 0",
            others.into_iter().chain(pairs).collect(),
        );
        let power = if way.is_empty() { None } else { of_light() };
        let importances = way.into_iter().flatten().map(|(_, importance)| importance);
        [choice].into_iter().chain(importances).chain(power).collect()
    }

    /// The probability of choosing from the list; the tree counts as one more light.
    fn share_of_list(&self) -> f32 {
        let (list, tree) = (self.listed.len() as f32, if self.tree.is_empty() { 0.0 } else { 1.0 });
        if list == 0.0 { 0.0 } else { list / (list + tree) }
    }
}
