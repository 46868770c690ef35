//! Composition and transmittance of the air. Lengths are in km, from the centre of the Earth.

use super::SUN_RADIUS;
use super::bands::{self, Bands};

/// The radius of the Earth.
pub(super) const GROUND: f64 = 6371.0;
/// The end of the atmosphere.
pub(super) const TOP: f64 = GROUND + 100.0;
/// The wavelength at which turbidity compares aerosol with pure air, in nm.
const REFERENCE: f64 = 550.0;
/// Scale heights of air and of aerosol.
const HEIGHTS: [f64; 2] = [8.0, 1.2];
/// Ozone: the height at which it is densest, and how far it reaches from there.
const OZONE: [f64; 2] = [25.0, 15.0];
/// The part of the light that aerosol does not absorb (continental aerosol).
const SINGLE_SCATTERING_ALBEDO: f64 = 0.93;
/// Ångström's exponent: how aerosol depends on wavelength.
const ANGSTROM: f64 = 1.3;
/// Heights and directions in the table of columns, and steps along each.
const TABLE: [usize; 2] = [32, 128];
const STEPS: u32 = 64;

/// A clear atmosphere.
pub(super) struct Air {
    /// Extinction by air, aerosol and ozone where each is densest, per km.
    extinction: [Bands; 3],
    /// Columns of the three to the end of the atmosphere, by height and direction.
    columns: Vec<[f64; 3]>,
}

impl Air {
    pub(super) fn new(turbidity: f64) -> Self {
        let aerosol = (turbidity - 1.0) * rayleigh_thickness(REFERENCE) / HEIGHTS[1];
        let extinction = [
            bands::bands(|nm| rayleigh_thickness(nm) / HEIGHTS[0]),
            bands::bands(|nm| aerosol * libm::pow(nm / REFERENCE, -ANGSTROM)),
            // A tent's column is its peak times half of its width: here 300 Dobson units of 2.687e16 molecules per cm².
            bands::bands(|nm| 300.0 * 2.687e16 * ozone_cross_section(nm) / OZONE[1]),
        ];
        let mut columns = Vec::with_capacity(TABLE[0] * TABLE[1]);
        for height in 0..TABLE[0] {
            let r = (GROUND * GROUND + squared(part(height, TABLE[0]) * horizon_of_top())).sqrt();
            for direction in 0..TABLE[1] {
                let [shortest, longest] = distances(r);
                let d = shortest + part(direction, TABLE[1]) * (longest - shortest);
                let mu = if d == 0.0 { 1.0 } else { (TOP * TOP - r * r - d * d) / (2.0 * r * d) };
                columns.push(column(r, mu.clamp(-1.0, 1.0), d));
            }
        }
        Self { extinction, columns }
    }

    /// Extinction per km, and scattering by air and by aerosol, at a radius.
    pub(super) fn at(&self, r: f64) -> (Bands, [Bands; 2]) {
        let density = densities(r - GROUND);
        let of = |kind: usize| self.extinction[kind].map(|value| value * density[kind]);
        let (air, aerosol, ozone) = (of(0), of(1), of(2));
        let extinction = std::array::from_fn(|i| air[i] + aerosol[i] + ozone[i]);
        (extinction, [air, aerosol.map(|value| value * SINGLE_SCATTERING_ALBEDO)])
    }

    /// The part of the light that passes from outside to a radius, from a direction of this cosine to the vertical; the
    /// ground is not in the way (a direction below the horizon is brought up to it).
    pub(super) fn transmittance(&self, r: f64, mu: f64) -> Bands {
        let column = self.column_to_top(r, mu.max(-horizon(r) / r));
        std::array::from_fn(|i| {
            libm::exp(-(0..3).map(|kind| self.extinction[kind][i] * column[kind]).sum::<f64>())
        })
    }

    /// The part of the sun's light that arrives, or 0 in the shadow of the Earth.
    pub(super) fn sunlight(&self, r: f64, mu: f64) -> Bands {
        let visible = ((mu + horizon(r) / r) / (2.0 * SUN_RADIUS) + 0.5).clamp(0.0, 1.0);
        if visible == 0.0 {
            [0.0; bands::COUNT]
        } else {
            self.transmittance(r, mu).map(|part| part * visible)
        }
    }

    fn column_to_top(&self, r: f64, mu: f64) -> [f64; 3] {
        let d = to_top(r, mu);
        let [shortest, longest] = distances(r);
        let place = |part: f64, count: usize| {
            let place = part.clamp(0.0, 1.0) * (count - 1) as f64;
            let below = (place as usize).min(count - 2);
            (below, place - below as f64)
        };
        let (row, t) = place(horizon(r) / horizon_of_top(), TABLE[0]);
        let (column, s) = place((d - shortest) / (longest - shortest), TABLE[1]);
        let at = |row: usize, column: usize| self.columns[row * TABLE[1] + column];
        std::array::from_fn(|kind| {
            let along = |row| at(row, column)[kind] * (1.0 - s) + at(row, column + 1)[kind] * s;
            along(row) * (1.0 - t) + along(row + 1) * t
        })
    }
}

/// The distance along a direction to the end of the atmosphere.
pub(super) fn to_top(r: f64, mu: f64) -> f64 {
    (-r * mu + (r * r * (mu * mu - 1.0) + TOP * TOP).max(0.0).sqrt()).max(0.0)
}

/// The distance along a direction to the ground, if it is hit.
pub(super) fn to_ground(r: f64, mu: f64) -> Option<f64> {
    let inside = r * r * (mu * mu - 1.0) + GROUND * GROUND;
    (mu < 0.0 && inside >= 0.0).then(|| (-r * mu - inside.sqrt()).max(0.0))
}

/// The distance to the horizon.
fn horizon(r: f64) -> f64 {
    (r * r - GROUND * GROUND).max(0.0).sqrt()
}

fn horizon_of_top() -> f64 {
    horizon(TOP)
}

/// The shortest and the longest way to the end of the atmosphere that does not meet the ground.
fn distances(r: f64) -> [f64; 2] {
    [TOP - r, horizon(r) + horizon_of_top()]
}

/// The densities of air, aerosol and ozone, relative to where each is densest.
fn densities(height: f64) -> [f64; 3] {
    let height = height.max(0.0);
    let tent = 1.0 - (height - OZONE[0]).abs() / OZONE[1];
    [libm::exp(-height / HEIGHTS[0]), libm::exp(-height / HEIGHTS[1]), tent.max(0.0)]
}

/// The densities integrated along a distance, with short steps at its beginning.
fn column(r: f64, mu: f64, distance: f64) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for step in 0..STEPS {
        let [begin, end] =
            [step, step + 1].map(|step| distance * squared(f64::from(step) / f64::from(STEPS)));
        let t = 0.5 * (begin + end);
        let height = (r * r + 2.0 * r * mu * t + t * t).sqrt() - GROUND;
        for (sum, density) in sums.iter_mut().zip(densities(height)) {
            *sum += density * (end - begin);
        }
    }
    sums
}

/// The optical thickness of pure air (Hansen & Travis 1974, equation 2.30).
fn rayleigh_thickness(nm: f64) -> f64 {
    let inverse_square = 1e6 / (nm * nm);
    0.008_569 * squared(inverse_square) * (1.0 + (0.011_3 + 0.000_13 * inverse_square) * inverse_square)
}

/// The cross-section of ozone in its Chappuis band, in cm²: measurements at 233 K (Bogumil et al. 2003), rounded.
fn ozone_cross_section(nm: f64) -> f64 {
    /// In 10⁻²¹ cm², from 380 to 740 nm.
    const EVERY_20_NM: [f64; 19] = [
        0.0, 0.02, 0.06, 0.16, 0.37, 0.78, 1.5, 2.1, 3.1, 4.3, 4.4, 5.0, 3.7, 2.7, 1.9, 1.2, 0.75, 0.51, 0.42,
    ];
    let place = ((nm - 380.0) / 20.0).clamp(0.0, 18.0);
    let below = (place as usize).min(17);
    let t = place - below as f64;
    1e-21 * (EVERY_20_NM[below] * (1.0 - t) + EVERY_20_NM[below + 1] * t)
}

fn part(index: usize, count: usize) -> f64 {
    index as f64 / (count - 1) as f64
}

fn squared(x: f64) -> f64 {
    x * x
}
