//! Free flights: how far a path travels in a medium before that scatters it.
//!
//! Where the extinction σ_t differs from lane to lane, the distance is sampled with that of one lane, chosen by the share
//! P of each in the path's throughput, and its density is that of all choices together: the balance heuristic over lanes in
//! one sample (Veach 1997, section 9.2.4). Choosing by throughput is that of Kutz et al. 2017 (Spectral and Decomposition
//! Tracking, "history-aware"): a path that one lane alone carries is sampled as that lane asks, and in a medium that absorbs
//! nothing the sum of the lanes stays what it was.

use lookfrom_simd::{Bits, Float, Kernel, Real, Simd};

use super::dimension;
use crate::core::elementary::{exp, ln};
use crate::core::lanes::width::{Lanes, Width};
use crate::core::lanes::{LANES, are_shaded_together, by_lane, shade_together};
use crate::core::spectrum::Spectrum;
use crate::integrator::SampleStream;
use crate::integrator::sample_streams::SampleStreams;
use crate::medium::Coefficients;

/// A sampled flight; or those of eight paths side by side.
#[derive(Clone, Copy, Debug)]
pub struct Flight<R: Real = f32> {
    /// σ_t: the extinction coefficient, per unit of length.
    pub extinction: Spectrum<R>,
    /// σ_s: the scattering coefficient.
    pub scattering: Spectrum<R>,
    /// P: the probability of each lane.
    pub choice: Spectrum<R>,
    /// The lane that was chosen.
    pub lane: R::Bits,
    /// The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills space; infinite where that has none.
    pub limit: R,
    /// The distance that was sampled.
    pub distance: R,
    /// T: the transmittance over the way, e^(−σ_t · length).
    pub transmittance: Spectrum<R>,
    /// The density of the distance of scattering, q = Σ P σ_t T; where the path is not scattered, its probability Q = Σ P T.
    pub density: R,
    /// The throughput before …
    pub before: Spectrum<R>,
    /// … and at the end of the way: β σ_s T / q, or β T / Q.
    pub after: Spectrum<R>,
}

impl<R: Real> Flight<R> {
    /// Samples a flight of a path with a throughput, which is not black, by `u ∈ [0, 1)²`: the lane and the distance.
    #[inline(always)]
    pub(super) fn sample(medium: &Coefficients<R>, beta: Spectrum<R>, limit: R, [which, u]: [R; 2]) -> Self {
        let (extinction, scattering) = (medium.extinction(), medium.scattering);
        let choice = beta / beta.sum();
        let (lane, sigma) = chosen(choice, extinction, which);
        let zero = limit.like(0.0);
        let distance = R::select(sigma.gt(zero), -ln(-u + 1.0) / sigma, limit.like(f32::INFINITY));
        let is_scattered = distance.lt(limit);
        let length = Float::min(distance, limit);
        let transmittance = extinction.map(
            #[inline(always)]
            |sigma| R::select(sigma.gt(zero), exp(-sigma * length), sigma.like(1.0)),
        );
        let part = Spectrum::select(is_scattered, extinction * transmittance, transmittance);
        let density = (choice * part).sum();
        let kept = Spectrum::select(is_scattered, scattering * transmittance, transmittance);
        let after = beta * kept / density;
        Self {
            extinction,
            scattering,
            choice,
            lane,
            limit,
            distance,
            transmittance,
            density,
            before: beta,
            after,
        }
    }
}

impl Flight {
    /// Whether the medium scatters the path before it arrives.
    pub fn is_scattered(&self) -> bool {
        self.distance < self.limit
    }
}

/// The lane that a number in [0, 1) chooses, by probabilities, and its extinction coefficient. Where rounding has left a rest, it is the
/// last one that is possible.
#[inline(always)]
fn chosen<R: Real>(choice: Spectrum<R>, extinction: Spectrum<R>, which: R) -> (R::Bits, R) {
    let ([p, q, r, s], [a, b, c, d]) = (choice.0, extinction.0);
    let zero = p.like(0.0);
    let (mut lane, mut sigma) = (which.to_bits().like(0), a);
    let mut left = which - p;
    let mut is_past = !left.lt(zero);
    for (number, probability, of_lane) in [(1, q, b), (2, r, c), (3, s, d)] {
        let takes = is_past & probability.gt(zero);
        lane = R::select_bits(takes, lane.like(number), lane);
        sigma = R::select(takes, of_lane, sigma);
        left = left - probability;
        is_past = is_past & !left.lt(zero);
    }
    (lane, sigma)
}

/// A path that flies through a homogeneous medium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flying {
    pub(super) stream: SampleStream,
    pub(super) coefficients: Coefficients,
    /// Not black.
    pub(super) throughput: Spectrum,
    /// The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills space; infinite where that has none.
    pub(super) limit: f32,
}

impl Flying {
    /// The flight of one path.
    pub(super) fn fly(&self) -> Flight {
        let u = self.stream.two(dimension::FLIGHT);
        Flight::sample(&self.coefficients, self.throughput, self.limit, u)
    }

    /// The flights of paths, eight of them side by side.
    pub(super) fn fly_all(flying: &[Self]) -> Vec<Flight> {
        if !are_shaded_together() {
            return flying.iter().map(Self::fly).collect();
        }
        let mut flights = Vec::with_capacity(flying.len());
        for chunk in flying.chunks(LANES) {
            // Unused lanes repeat the last path.
            let eight = by_lane!(lane => &chunk[lane.min(chunk.len() - 1)]);
            flights.extend_from_slice(&shade_together(Flights(&eight))[..chunk.len()]);
        }
        flights
    }
}

struct Flights<'a>(&'a [&'a Flying; LANES]);

impl Kernel for Flights<'_> {
    type Output = [Flight; LANES];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [Flight; LANES] {
        let flying = self.0;
        let streams = SampleStreams::new(simd, &by_lane!(lane => &flying[lane].stream));
        let coefficients = Coefficients {
            absorption: simd.spectra_of(
                #[inline(always)]
                |lane| flying[lane].coefficients.absorption,
            ),
            scattering: simd.spectra_of(
                #[inline(always)]
                |lane| flying[lane].coefficients.scattering,
            ),
            emission: Spectrum::splat(simd.splat(0.0)),
        };
        let throughput = simd.spectra_of(
            #[inline(always)]
            |lane| flying[lane].throughput,
        );
        let limit = simd.f32s(
            #[inline(always)]
            |lane| flying[lane].limit,
        );
        let flights = Flight::sample(&coefficients, throughput, limit, streams.two(dimension::FLIGHT));
        // Those of each lane.
        let [extinction, scattering] = [simd.spectra(flights.extinction), simd.spectra(flights.scattering)];
        let [choice, transmittance] = [simd.spectra(flights.choice), simd.spectra(flights.transmittance)];
        let [before, after] = [simd.spectra(flights.before), simd.spectra(flights.after)];
        let [distance, density] = [flights.distance.column(), flights.density.column()];
        let lanes: [u32; LANES] = flights.lane.into();
        by_lane!(lane => Flight {
            extinction: extinction[lane],
            scattering: scattering[lane],
            choice: choice[lane],
            lane: lanes[lane],
            limit: flying[lane].limit,
            distance: distance[lane],
            transmittance: transmittance[lane],
            density: density[lane],
            before: before[lane],
            after: after[lane],
        })
    }
}

#[cfg(test)]
mod tests;
