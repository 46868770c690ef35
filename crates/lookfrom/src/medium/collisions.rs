//! Collisions of rays with media that vary: points whose density along a ray is a bound of the extinction coefficient, the
//! majorant. Where the extinction is less, a collision is null with the probability that is missing (Woodcock et al. 1965).

use glam::Vec3;
use lookfrom_bvh::Ray;

use super::majorants::Walk;
use super::{Coefficients, Medium, Varying};
use crate::core::hash;
use crate::core::random::Random;
use crate::core::spectrum::Spectrum;
use crate::shading::texture::{SpectralMode, Textures};

/// A part of a ray in a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// In render space.
    pub(crate) origin: Vec3,
    /// Of unit length.
    pub(crate) direction: Vec3,
    pub(crate) length: f32,
}

/// A point of a ray at which it may interact with a medium.
#[derive(Clone, Copy, Debug)]
pub struct Collision {
    /// The distance of the ray.
    pub t: f32,
    /// The density of collisions, per unit of length: no less than σ_t in any lane.
    pub majorant: f32,
    /// The coefficients there.
    pub coefficients: Coefficients,
}

/// The collisions of a ray, in order, by random numbers.
pub(crate) struct Collisions<'a> {
    varying: &'a Varying,
    even: Coefficients,
    emission_scale: f32,
    textures: &'a Textures,
    mode: &'a SpectralMode,
    /// In medium space; distances are those in render space.
    origin: Vec3,
    direction: Vec3,
    walk: Option<Walk<'a>>,
    /// Majorant over bound of the density.
    most: f32,
    t: f32,
    /// The end of the cell and the majorant there.
    end: f32,
    majorant: f32,
    /// The optical depth by majorants to the next collision.
    left: f32,
    count: u32,
}

/// Most collisions of a ray: after so many, a density is so far below its bound that nothing is to be expected.
const MOST_COLLISIONS: u32 = 1 << 16;

/// Majorants are greater than bounds by so much, which interpolation may exceed by rounding.
const MARGIN: f32 = 1.0 + 1.0 / 65_536.0;

impl Way {
    /// The ray as far as a distance.
    pub(crate) fn new(ray: &Ray, length: f32) -> Self {
        let direction = Vec3::from_array(ray.direction).normalize();
        Self { origin: Vec3::from_array(ray.origin), direction, length }
    }

    /// A hash, from which random numbers along it may come.
    pub(crate) fn hash(&self) -> u64 {
        let bits = |a: f32, b: f32| u64::from(a.to_bits()) << 32 | u64::from(b.to_bits());
        let [o, d] = [self.origin, self.direction];
        hash::pair(hash::pair(bits(o.x, o.y), bits(o.z, d.x)), bits(d.y, d.z))
    }
}

impl Medium {
    /// The collisions of a ray, the first of them by `u ∈ [0, 1)`; `None` in a homogeneous medium.
    pub(crate) fn collisions<'a>(
        &'a self,
        way: &Way,
        (textures, mode): (&'a Textures, &'a SpectralMode),
        u: f32,
    ) -> Option<Collisions<'a>> {
        let varying = self.varying.as_deref()?;
        let even = self.coefficients(textures, mode);
        let (origin, direction) = (varying.point(way.origin), varying.direction(way.direction));
        let walk = varying.majorants.walk(origin, direction, way.length);
        let start = walk.as_ref().map_or(0.0, |walk| walk.start);
        Some(Collisions {
            varying,
            even,
            emission_scale: self.emission.as_ref().map_or(0.0, |emission| emission.scale),
            textures,
            mode,
            origin,
            direction,
            walk,
            most: even.extinction().max_lane() * MARGIN,
            t: start,
            end: start,
            majorant: 0.0,
            left: optical_depth(u),
            count: 0,
        })
    }
}

/// An optical depth of exponential density.
fn optical_depth(u: f32) -> f32 {
    -libm::log1pf(-u)
}

impl Collisions<'_> {
    /// The next collision; `None` where the ray leaves the medium before.
    pub(crate) fn next(&mut self, random: &mut Random) -> Option<Collision> {
        // Walk through cells up to the optical depth.
        loop {
            let depth = self.majorant * (self.end - self.t);
            if self.left < depth {
                break;
            }
            self.left -= depth;
            self.t = self.end;
            let segment = self.walk.as_mut()?.next()?;
            (self.end, self.majorant) = (segment.end, (segment.most * self.most).min(Coefficients::MOST));
        }
        self.count += 1;
        if self.count > MOST_COLLISIONS {
            return None;
        }
        self.t = (self.t + self.left / self.majorant).min(self.end);
        self.left = optical_depth(random.one());
        let point = self.origin + self.direction * self.t;
        let coefficients =
            self.varying.at(point, &self.even, self.emission_scale, (self.textures, self.mode));
        Some(Collision { t: self.t, majorant: self.majorant, coefficients })
    }
}

impl Collision {
    /// Coefficient of null collisions: the majorant less the extinction coefficient, at least 0.
    pub fn null(&self) -> Spectrum {
        self.coefficients.extinction().map(|sigma| (self.majorant - sigma).max(0.0))
    }
}

impl Medium {
    /// An estimate of the transmittance over a way through a medium that varies: the product of the probabilities of null
    /// collisions (ratio tracking, Novák et al. 2014), by random numbers that are a function of the way. What is weak is ended by
    /// Russian roulette. `notice` is told each collision and the product after it. `None` in a homogeneous medium.
    pub(crate) fn estimated_transmittance(
        &self,
        way: &Way,
        (textures, mode): (&Textures, &SpectralMode),
        mut notice: impl FnMut(Collision, Spectrum),
    ) -> Option<Spectrum> {
        let mut random = Random::new(way.hash());
        let u = random.one();
        let mut collisions = self.collisions(way, (textures, mode), u)?;
        let mut transmittance = mode.one();
        while let Some(collision) = collisions.next(&mut random) {
            transmittance = transmittance * collision.null() / collision.majorant;
            let survives = survives(&mut transmittance, 1.0, &mut random);
            notice(collision, transmittance);
            if !survives {
                break;
            }
        }
        Some(transmittance)
    }
}

/// Whether what has become weak along a way, as compared with its beginning, is kept; it is then made stronger for what is not.
pub(crate) fn survives(value: &mut Spectrum, at_first: f32, random: &mut Random) -> bool {
    const WEAK: f32 = 0.05;
    const SURVIVAL: f32 = 0.25;
    if value.max_lane() >= WEAK * at_first {
        return true;
    }
    if value.is_black() || random.one() >= SURVIVAL {
        *value = Spectrum::BLACK;
        return false;
    }
    *value = *value / SURVIVAL;
    true
}
