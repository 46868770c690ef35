//! Eight paths side by side: arrays by lane, and their gathering into vectors.

use lookfrom_simd::{Simd, f32x8, f64x8, prelude::*};

use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// Number of paths in a vector.
pub(crate) const LANES: usize = 8;

/// An array of the values of an expression for each lane. (Closures of `from_fn` and `map` are not compiled for the
/// level.)
macro_rules! by_lane {
    ($lane:ident => $value:expr) => {{
        let mut $lane = 0;
        let first = $value;
        let mut all = [first; $crate::core::lanes::LANES];
        $lane = 1;
        while $lane < $crate::core::lanes::LANES {
            all[$lane] = $value;
            $lane += 1;
        }
        all
    }};
}

pub(crate) use by_lane;

/// The answers of the lanes: that of lane i in bit i.
#[inline(always)]
pub(crate) fn bitmask(lanes: &[bool; LANES]) -> u32 {
    let (mut bits, mut lane) = (0, 0);
    while lane < LANES {
        bits |= u32::from(lanes[lane]) << lane;
        lane += 1;
    }
    bits
}

/// A vector in each lane.
#[inline(always)]
pub(crate) fn gather<S: Simd>(simd: S, rows: &[[f32; 3]; LANES]) -> Vector<f32x8<S>> {
    Vector {
        x: f32x8::load_array(simd, by_lane!(lane => rows[lane][0])),
        y: f32x8::load_array(simd, by_lane!(lane => rows[lane][1])),
        z: f32x8::load_array(simd, by_lane!(lane => rows[lane][2])),
    }
}

/// A vector of double precision in each lane.
#[inline(always)]
pub(crate) fn gather_f64<S: Simd>(simd: S, rows: &[[f64; 3]; LANES]) -> Vector<f64x8<S>> {
    Vector {
        x: f64x8::load_array(simd, by_lane!(lane => rows[lane][0])),
        y: f64x8::load_array(simd, by_lane!(lane => rows[lane][1])),
        z: f64x8::load_array(simd, by_lane!(lane => rows[lane][2])),
    }
}

/// A spectrum in each lane.
#[inline(always)]
pub(crate) fn gather_spectrum<S: Simd>(simd: S, rows: &[Spectrum; LANES]) -> Spectrum<f32x8<S>> {
    Spectrum([
        f32x8::load_array(simd, by_lane!(lane => rows[lane].0[0])),
        f32x8::load_array(simd, by_lane!(lane => rows[lane].0[1])),
        f32x8::load_array(simd, by_lane!(lane => rows[lane].0[2])),
        f32x8::load_array(simd, by_lane!(lane => rows[lane].0[3])),
    ])
}

/// The vectors of the lanes.
#[inline(always)]
pub(crate) fn scatter<S: Simd>(v: Vector<f32x8<S>>) -> [[f32; 3]; LANES] {
    let [x, y, z]: [[f32; LANES]; 3] = [v.x.into(), v.y.into(), v.z.into()];
    by_lane!(lane => [x[lane], y[lane], z[lane]])
}

/// The vectors of double precision of the lanes.
#[inline(always)]
pub(crate) fn scatter_f64<S: Simd>(v: Vector<f64x8<S>>) -> [[f64; 3]; LANES] {
    let [x, y, z]: [[f64; LANES]; 3] = [v.x.into(), v.y.into(), v.z.into()];
    by_lane!(lane => [x[lane], y[lane], z[lane]])
}

/// The spectra of the lanes.
#[inline(always)]
pub(crate) fn scatter_spectrum<S: Simd>(s: Spectrum<f32x8<S>>) -> [Spectrum; LANES] {
    let [a, b, c, d]: [[f32; LANES]; 4] = [s.0[0].into(), s.0[1].into(), s.0[2].into(), s.0[3].into()];
    by_lane!(lane => Spectrum([a[lane], b[lane], c[lane], d[lane]]))
}
