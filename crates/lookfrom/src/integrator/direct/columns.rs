//! Results of eight paths side by side in memory: a column for each component, from which a path takes its row.

use lookfrom_simd::{Simd, f32x8};

use crate::core::lanes::LANES;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// `N` components of eight paths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns<const N: usize>([[f32; LANES]; N]);

impl<const N: usize> Columns<N> {
    pub(super) const ZERO: Self = Self([[0.0; LANES]; N]);
}

impl Columns<3> {
    #[inline(always)]
    pub(super) fn of<S: Simd>(v: Vector<f32x8<S>>) -> Self {
        Self([v.x.into(), v.y.into(), v.z.into()])
    }

    #[inline(always)]
    pub(super) fn row(&self, lane: usize) -> [f32; 3] {
        let [x, y, z] = &self.0;
        [x[lane], y[lane], z[lane]]
    }
}

impl Columns<4> {
    #[inline(always)]
    pub(super) fn of_spectrum<S: Simd>(Spectrum([a, b, c, d]): Spectrum<f32x8<S>>) -> Self {
        Self([a.into(), b.into(), c.into(), d.into()])
    }

    #[inline(always)]
    pub(super) fn spectrum(&self, lane: usize) -> Spectrum {
        let [a, b, c, d] = &self.0;
        Spectrum([a[lane], b[lane], c[lane], d[lane]])
    }
}
