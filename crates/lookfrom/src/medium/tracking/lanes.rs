//! The loop of [tracking](super): rays under way in lanes, from collision to collision.

use lookfrom_simd::{Bits, Float, Kernel, LaneMask, Real, Simd};

use super::{Collision, TrackedRay, Tracking};
use crate::core::elementary::ln;
use crate::core::hash;
use crate::core::lanes::width::{Bits64, Lanes, Width};
use crate::core::lanes::{Columns, LANES, load, load_spectrum, row, set_row, store_spectrum};
use crate::core::spectrum::Spectrum;
use crate::medium::grid::Lookup;
use crate::medium::majorants::{Approach, StoredWalk};
use crate::medium::{Coefficients, Medium, Varying};
use crate::shading::texture::{SpectralMode, Textures};

/// Most collisions of a ray: after so many, a density is so far below its bound that nothing is to be expected.
const MOST_COLLISIONS: f32 = 65_536.0;

/// Below this part of its throughput at the beginning a ray is ended by Russian roulette, …
const WEAK: f32 = 0.05;
/// … which it survives with this probability.
const SURVIVAL: f32 = 0.25;

/// Rays, and what has become of those that ended.
pub(super) struct Tracker<'a, 'b> {
    pub(super) medium: &'a Medium,
    pub(super) varying: &'a Varying,
    pub(super) textures: &'a Textures,
    pub(super) rays: &'a [TrackedRay<'a>],
    pub(super) tracked: &'b mut [Tracking],
    /// Whether collisions may be real.
    pub(super) scatters: bool,
    /// Whether they add light.
    pub(super) emits: bool,
    pub(super) listens: bool,
}

/// Rays under way, by lane.
struct UnderWay<'a> {
    /// In medium space; distances are those in render space.
    origin: Columns<3>,
    direction: Columns<3>,
    walk: StoredWalk,
    t: [f32; LANES],
    /// The majorant up to the end of the cell, …
    majorant: [f32; LANES],
    /// … and its factor of the bound of the density there.
    most: [f32; LANES],
    /// The optical depth by majorants to the next collision.
    left: [f32; LANES],
    count: [f32; LANES],
    random: [u64; LANES],
    /// The coefficients where the density is 1.
    even: Coefficients<[f32; LANES]>,
    throughput: Columns<4>,
    emitted: Columns<4>,
    /// The throughput below which a ray is weak.
    weak: [f32; LANES],
    modes: [&'a SpectralMode; LANES],
    /// The numbers of the rays.
    rays: [usize; LANES],
}

/// The collisions of the lanes of a mask.
struct Collisions<R: Real> {
    lanes: R::Mask,
    t: R,
    majorant: R,
    coefficients: Coefficients<R>,
    probability: R,
    are_real: R::Mask,
    emitted: Spectrum<R>,
    beta: Spectrum<R>,
}

impl Kernel for Tracker<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        self.track(simd);
    }
}

impl<'a> Tracker<'a, '_> {
    /// Tracks all.
    #[inline(always)]
    pub(super) fn track<W: Width>(mut self, width: W) {
        let Some(first) = self.rays.first() else { return };
        let mut under_way = UnderWay::none(first.mode);
        let mut waiting = 0..self.rays.len();
        let mut lanes = 0;
        loop {
            // Lanes without a ray take the next one that meets the medium.
            for lane in LaneMask(!lanes & W::ALL) {
                if waiting.any(
                    #[inline(always)]
                    |ray| self.begin(&mut under_way, lane, ray),
                ) {
                    lanes |= 1 << lane;
                }
            }
            if lanes == 0 {
                break;
            }
            lanes &= !self.go_on(width, &mut under_way, lanes);
        }
    }

    /// Puts a ray into a lane; `false` where it does not meet the medium.
    #[inline(never)]
    fn begin(&self, under_way: &mut UnderWay<'a>, lane: usize, number: usize) -> bool {
        let Self { medium, varying, textures, .. } = *self;
        let TrackedRay { way, throughput, u, seed, mode } = self.rays[number];
        let (origin, direction) = (varying.point(way.origin), varying.direction(way.direction));
        let Some((start, walk)) = varying.majorants.walk(origin, direction, way.length) else { return false };
        let even = medium.coefficients(textures, mode);
        set_row(&mut under_way.origin, lane, origin.to_array());
        set_row(&mut under_way.direction, lane, direction.to_array());
        under_way.walk.set(lane, &walk);
        under_way.t[lane] = start;
        under_way.majorant[lane] = 0.0;
        under_way.most[lane] = even.most();
        under_way.left[lane] = -ln(1.0 - u);
        under_way.count[lane] = 0.0;
        under_way.random[lane] = hash::mix(seed.wrapping_add(hash::GOLDEN));
        let Coefficients { absorption, scattering, emission } = &mut under_way.even;
        set_row(&mut absorption.0, lane, even.absorption.0);
        set_row(&mut scattering.0, lane, even.scattering.0);
        set_row(&mut emission.0, lane, even.emission.0);
        set_row(&mut under_way.throughput, lane, throughput.0);
        set_row(&mut under_way.emitted, lane, [0.0; 4]);
        under_way.weak[lane] = throughput.max_lane() * WEAK;
        under_way.modes[lane] = mode;
        under_way.rays[lane] = number;
        true
    }

    /// Brings the rays of a mask to their next collisions and through them, or to the ends of their ways. Returns those that ended.
    #[inline(always)]
    fn go_on<W: Width>(&mut self, width: W, under_way: &mut UnderWay<'a>, lanes: u32) -> u32 {
        // Walk through cells up to the optical depth.
        let [origin, direction] = [load(width, &under_way.origin), load(width, &under_way.direction)];
        let most = width.load_f32(&under_way.most);
        let mut approach = Approach {
            walk: under_way.walk.load(width),
            t: width.load_f32(&under_way.t),
            majorant: width.load_f32(&under_way.majorant),
            left: width.load_f32(&under_way.left),
        };
        let are_within = approach.arrive(&self.varying.majorants, (direction, most), width.mask(lanes));
        let Approach { walk, t, majorant, .. } = approach;

        // Collide there.
        let count = width.load_f32(&under_way.count) + 1.0;
        let collide = are_within & !count.gt(count.like(MOST_COLLISIONS));
        let mut random = width.u64s(
            #[inline(always)]
            |lane| under_way.random[lane],
        );
        random = random.wrapping_add(random.like(hash::GOLDEN));
        let [u, choice, roulette] = three(width, random);
        let point = origin + direction * t;
        let even = under_way.even.load(width);
        let emission_scale =
            self.medium.emission.as_ref().filter(|_| self.emits).map_or(0.0, |emission| emission.scale);
        let coefficients = self.varying.at(
            width,
            point,
            Lookup::OneCell(random),
            &even,
            emission_scale,
            (self.textures, &under_way.modes),
        );
        let beta = load_spectrum(width, &under_way.throughput);
        let collisions = self.collided((collide, t, majorant), coefficients, beta, choice);

        // Absorption alone makes the throughput weak: then Russian roulette may end the ray.
        let mut after = collisions.beta;
        let are_weak = collide & !collisions.are_real & after.max_lane().lt(width.load_f32(&under_way.weak));
        let are_dead = are_weak & (after.is_black() | !roulette.lt(roulette.like(SURVIVAL)));
        let black = Spectrum::splat(t.like(0.0));
        after = Spectrum::select(are_weak, after / t.like(SURVIVAL), after);
        after = Spectrum::select(are_dead, black, after);

        // Write what has become of them.
        let emitted = load_spectrum(width, &under_way.emitted) + collisions.emitted;
        under_way.t = t.column();
        under_way.majorant = majorant.column();
        under_way.left = (-ln(-u + 1.0)).column();
        under_way.walk.store(&walk);
        under_way.count = count.column();
        under_way.random = width.u64_column(random);
        under_way.throughput = store_spectrum(after);
        under_way.emitted = store_spectrum(emitted);
        if self.listens {
            self.keep(width, under_way, &collisions);
        }
        let are_scattered = width.bits(collisions.are_real);
        let ended = lanes & !width.bits(collide & !collisions.are_real & !are_dead);
        for lane in LaneMask(ended) {
            let tracking = &mut self.tracked[under_way.rays[lane]];
            tracking.after = Spectrum(row(&under_way.throughput, lane));
            tracking.emitted = Spectrum(row(&under_way.emitted, lane));
            tracking.scattered_at = (are_scattered & 1 << lane != 0).then(|| under_way.t[lane]);
        }
        ended
    }

    /// Decides collisions at which paths have a throughput, in the lanes of a mask, by random numbers; elsewhere the throughput stays.
    #[inline(always)]
    fn collided<R: Lanes>(
        &self,
        (lanes, t, majorant): (R::Mask, R, R),
        coefficients: Coefficients<R>,
        beta: Spectrum<R>,
        choice: R,
    ) -> Collisions<R> {
        let zero = t.like(0.0);
        let extinction = coefficients.extinction();
        let emitted = match self.emits {
            true => {
                let light = beta * coefficients.absorption * coefficients.emission / majorant;
                Spectrum::select(lanes, light, Spectrum::splat(zero))
            }
            false => Spectrum::splat(zero),
        };
        let probability = match self.scatters {
            true => Float::min((extinction * beta).sum() / beta.sum() / majorant, t.like(1.0)),
            false => zero,
        };
        let are_real = lanes & choice.lt(probability);
        let null = extinction.map(
            #[inline(always)]
            |sigma| Float::max(majorant - sigma, zero),
        );
        let scattered = coefficients.scattering / (majorant * probability);
        let passed = null / (majorant * (-probability + 1.0));
        let after = Spectrum::select(lanes, beta * Spectrum::select(are_real, scattered, passed), beta);
        Collisions { lanes, t, majorant, coefficients, probability, are_real, emitted, beta: after }
    }

    /// Keeps the collisions of rays for a probe.
    #[inline(always)]
    fn keep<W: Width>(&mut self, width: W, under_way: &UnderWay<'_>, collisions: &Collisions<W::Real>) {
        let Coefficients { absorption, scattering, emission } = collisions.coefficients;
        let [t, majorant, probability] =
            [collisions.t, collisions.majorant, collisions.probability].map(Lanes::column);
        let [absorption, scattering, emission, emitted] =
            [absorption, scattering, emission, collisions.emitted].map(store_spectrum);
        let are_real = width.bits(collisions.are_real);
        for lane in LaneMask(width.bits(collisions.lanes)) {
            let of = |columns: &Columns<4>| Spectrum(row(columns, lane));
            self.tracked[under_way.rays[lane]].collisions.push(Collision {
                t: t[lane],
                majorant: majorant[lane],
                coefficients: Coefficients {
                    absorption: of(&absorption),
                    scattering: of(&scattering),
                    emission: of(&emission),
                },
                probability: probability[lane],
                is_real: are_real & 1 << lane != 0,
                emitted: of(&emitted),
                beta: of(&under_way.throughput),
            });
        }
    }
}

/// Three random numbers in [0, 1) of a state: two of them multiples of 2⁻²⁴, the third of 2⁻¹⁶.
#[inline(always)]
fn three<W: Width>(_: W, state: Bits64<W>) -> [W::Real; 3] {
    let bits = hash::mix(state);
    [
        number::<W::Real>(bits >> 40) * (1.0 / 16_777_216.0),
        number::<W::Real>((bits >> 16) & bits.like(0xff_ffff)) * (1.0 / 16_777_216.0),
        number::<W::Real>(bits & bits.like(0xffff)) * (1.0 / 65_536.0),
    ]
}

/// Integers below 2²⁴ as numbers.
#[inline(always)]
fn number<R: Real>(bits: R::Bits64) -> R {
    R::from_integer(R::low_half(bits))
}

impl Coefficients<[f32; LANES]> {
    /// Their numbers.
    #[inline(always)]
    fn load<W: Width>(&self, width: W) -> Coefficients<W::Real> {
        let Self { absorption, scattering, emission } = self;
        Coefficients {
            absorption: load_spectrum(width, &absorption.0),
            scattering: load_spectrum(width, &scattering.0),
            emission: load_spectrum(width, &emission.0),
        }
    }
}

impl<'a> UnderWay<'a> {
    /// Memory for rays, with any mode.
    fn none(mode: &'a SpectralMode) -> Self {
        let zero = Columns::<3>::default();
        let none = || Spectrum([[0.0; LANES]; 4]);
        Self {
            origin: zero,
            direction: zero,
            walk: StoredWalk::default(),
            t: [0.0; LANES],
            majorant: [0.0; LANES],
            most: [0.0; LANES],
            left: [0.0; LANES],
            count: [0.0; LANES],
            random: [0; LANES],
            even: Coefficients { absorption: none(), scattering: none(), emission: none() },
            throughput: [[0.0; LANES]; 4],
            emitted: [[0.0; LANES]; 4],
            weak: [0.0; LANES],
            modes: [mode; LANES],
            rays: [0; LANES],
        }
    }
}
