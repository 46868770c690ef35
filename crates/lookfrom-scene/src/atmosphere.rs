//! The light of a clear sky and of the sun in it, computed from the physics of the air.
//!
//! Air scatters by Rayleigh's law, aerosol by Cornette and Shanks's (1992), ozone absorbs; the Earth is a sphere. Light that
//! is scattered once is integrated along each direction, all further scattering as by Hillaire, "A Scalable and Production
//! Ready Sky and Atmosphere Rendering Technique" (2020), both at sixteen wavelengths. The observer stands on the
//! ground; refraction, clouds and the stars are left out.

mod air;
mod bands;
mod scattering;
mod sun;

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;

use crate::image::Image;
use crate::parallel;
use air::Air;
use scattering::Scattering;
pub(crate) use sun::{PlaceAndTime, is_date};

/// Texels along a side of the picture of a sky: the sun covers six of them.
const SIDE: u32 = 1024;
/// Rows and columns of the grid of directions in which the sky is computed.
const GRID: [usize; 2] = [64, 32];
/// Points of the sun's disk.
const SUN_POINTS: u32 = 4096;
/// The angular radius of the sun, in radians.
const SUN_RADIUS: f64 = 0.004_65;

/// The parameters of a clear sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearSky {
    /// Elevation of the sun above the horizon, in radians, from −π/2 to π/2.
    pub elevation: f64,
    /// Azimuth of the sun in radians, from north (−z) by east (+x).
    pub azimuth: f64,
    /// Optical thickness of the air with its aerosol over that of pure air, at 550 nm: at least 1.
    pub turbidity: f64,
    /// The part of the light that the ground reflects, in 0..=1.
    pub albedo: f64,
    /// Whether the disk of the sun is in the picture.
    pub has_sun: bool,
}

impl ClearSky {
    /// The radiance from all directions, in units of 10 000 cd/m², as an equal-area octahedral map (Clarberg 2008) with
    /// straight up in the middle, east to the right and north towards the last row.
    pub fn octahedral(&self, name: &str) -> Image {
        let air = Air::new(self.turbidity);
        let weights = bands::rgb_weights();
        let grid = self.grid(&Scattering::new(&air, self.albedo), &weights);
        let sun = bands::rgb(&air.sunlight(air::GROUND, libm::sin(self.elevation)), &weights);
        let ground = self.ground(&grid, sun);
        let rows = parallel::map((0..SIDE).collect(), |row| {
            let texel = |column| {
                let (up, around) = direction(column, row);
                if up < 0.0 {
                    ground
                } else {
                    interpolated(&grid, libm::asin(up), around - self.sun_around())
                }
            };
            (0..SIDE).map(texel).collect::<Vec<_>>()
        });
        let mut texels = rows.concat();
        if self.has_sun {
            self.add_sun(&air, &weights, &mut texels);
        }
        let texels = texels.into_iter().map(|rgb| rgb.map(|value| value.max(0.0) as f32)).collect();
        Image::from_linear(name, SIDE, SIDE, texels)
    }

    /// The azimuth of the sun in the plane of the map, from its x axis to its y axis.
    fn sun_around(&self) -> f64 {
        FRAC_PI_2 - self.azimuth
    }

    /// RGB radiances of the upper half: rows by elevation (close to each other at the horizon), columns by azimuth from the
    /// sun's, up to π.
    fn grid(&self, scattering: &Scattering<'_>, weights: &[[f64; 3]; bands::COUNT]) -> Vec<Vec<[f64; 3]>> {
        let (sin_sun, cos_sun) = libm::sincos(self.elevation);
        let sun = DVec3::new(cos_sun, 0.0, sin_sun);
        parallel::map((0..=GRID[0]).collect(), |row| {
            let along = row as f64 / GRID[0] as f64;
            let (up, level) = libm::sincos(FRAC_PI_2 * along * along);
            let radiance = |column: usize| {
                let across = column as f64 / GRID[1] as f64;
                let (y, x) = libm::sincos(PI * across * across);
                let view = DVec3::new(level * x, level * y, up);
                bands::rgb(&scattering.radiance(view, sun), weights)
            };
            (0..=GRID[1]).map(radiance).collect()
        })
    }

    /// The radiance of the ground: it is diffuse, lit by the sun of this irradiance and by the sky.
    fn ground(&self, grid: &[Vec<[f64; 3]>], sun: [f64; 3]) -> [f64; 3] {
        let steps = [64, 64];
        let mut irradiance = sun.map(|value| value * libm::sin(self.elevation).max(0.0));
        for index in 0..steps[0] * steps[1] {
            // Uniform in projected solid angle.
            let squared = (f64::from(index / steps[1]) + 0.5) / f64::from(steps[0]);
            let around = 2.0 * PI * (f64::from(index % steps[1]) + 0.5) / f64::from(steps[1]);
            let sky = interpolated(grid, libm::asin(squared.sqrt()), around);
            for (sum, value) in irradiance.iter_mut().zip(sky) {
                *sum += value * PI / f64::from(steps[0] * steps[1]);
            }
        }
        irradiance.map(|value| value * self.albedo / PI)
    }

    /// Adds the part of the sun's disk that is above the horizon: all of its light, in the texels that it covers.
    fn add_sun(&self, air: &Air, weights: &[[f64; 3]; bands::COUNT], texels: &mut [[f64; 3]]) {
        let golden_angle = PI * (3.0 - 5f64.sqrt());
        let per_texel = f64::from(SIDE) * f64::from(SIDE) / (4.0 * PI);
        let (sin, cos) = libm::sincos(self.elevation);
        let (sin_around, cos_around) = libm::sincos(self.sun_around());
        let toward = DVec3::new(cos * cos_around, cos * sin_around, sin);
        let right = DVec3::new(-sin_around, cos_around, 0.0);
        let above = toward.cross(right);
        for point in 0..SUN_POINTS {
            let radius = SUN_RADIUS * ((f64::from(point) + 0.5) / f64::from(SUN_POINTS)).sqrt();
            let (y, x) = libm::sincos(f64::from(point) * golden_angle);
            let direction = (toward + radius * (x * right + y * above)).normalize();
            if direction.z <= 0.0 {
                continue;
            }
            let light = bands::rgb(&air.transmittance(air::GROUND, direction.z), weights);
            for (sum, value) in texels[texel_towards(direction)].iter_mut().zip(light) {
                *sum += value * per_texel / f64::from(SUN_POINTS);
            }
        }
    }
}

/// The direction of a texel's centre: its height in −1..=1 and its azimuth from x to y.
fn direction(column: u32, row: u32) -> (f64, f64) {
    let place = |texel: u32| 2.0 * (f64::from(texel) + 0.5) / f64::from(SIDE) - 1.0;
    let (u, v) = (place(column), place(row));
    let signed = 1.0 - u.abs() - v.abs();
    let r = 1.0 - signed.abs();
    let quarter = if r == 0.0 { 0.0 } else { ((v.abs() - u.abs()) / r + 1.0) * FRAC_PI_4 };
    let half = if u < 0.0 { PI - quarter } else { quarter };
    ((1.0 - r * r).copysign(signed), half.copysign(v))
}

/// The index of the texel in which a unit direction of the upper half lies.
fn texel_towards(direction: DVec3) -> usize {
    let r = (1.0 - direction.z).max(0.0).sqrt();
    let v = r * libm::atan2(direction.y.abs(), direction.x.abs()) / FRAC_PI_2;
    let place = |coordinate: f64| {
        let texel = (coordinate + 1.0) * 0.5 * f64::from(SIDE);
        (texel.max(0.0) as usize).min(SIDE as usize - 1)
    };
    place(v.copysign(direction.y)) * SIDE as usize + place((r - v).copysign(direction.x))
}

/// The radiance of the grid at an elevation in 0..=π/2 and any azimuth from the sun's, linear between its entries.
fn interpolated(grid: &[Vec<[f64; 3]>], elevation: f64, from_sun: f64) -> [f64; 3] {
    let turn = (from_sun / (2.0 * PI)).abs();
    let turn = turn - turn.floor();
    let across = 2.0 * turn.min(1.0 - turn);
    let place = |part: f64, count: usize| {
        let place = part.sqrt() * count as f64;
        let below = (place as usize).min(count - 1);
        (below, place - below as f64)
    };
    let (row, t) = place(elevation / FRAC_PI_2, GRID[0]);
    let (column, s) = place(across, GRID[1]);
    std::array::from_fn(|i| {
        let along = |row: usize| grid[row][column][i] * (1.0 - s) + grid[row][column + 1][i] * s;
        along(row) * (1.0 - t) + along(row + 1) * t
    })
}

#[cfg(test)]
mod tests;
