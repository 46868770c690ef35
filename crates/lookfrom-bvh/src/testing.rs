//! Seeded random geometry for tests, including those in `tests/`: with random exponents, not just
//! random numbers.

#![allow(dead_code)] // No test uses all of it.

/// PCG32 (O'Neill 2014).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn next(&mut self) -> u32 {
        let state = self.0;
        self.0 = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let shifted = (((state >> 18) ^ state) >> 27) as u32;
        shifted.rotate_right((state >> 59) as u32)
    }

    /// A number in [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / 16_777_216.0
    }

    /// An integer in 0..count.
    pub(crate) fn below(&mut self, count: u32) -> u32 {
        ((u64::from(self.next()) * u64::from(count)) >> 32) as u32
    }

    /// A direction of any length, sometimes along an axis or in a plane of two.
    pub(crate) fn direction(&mut self) -> [f32; 3] {
        loop {
            let length = self.size(-3, 3);
            let zeros = if self.unit() < 0.2 { 0.6 } else { 0.0 };
            let direction = [0; 3].map(|_| match self.unit() < zeros {
                true => [0.0, -0.0][self.below(2) as usize],
                false => length * (2.0 * self.unit() - 1.0),
            });
            if direction.iter().any(|&x| x != 0.0) {
                return direction;
            }
        }
    }

    /// A positive number between two powers of ten.
    pub(crate) fn size(&mut self, low: i32, high: i32) -> f32 {
        10.0_f32.powf(low as f32 + (high - low) as f32 * self.unit())
    }

    /// A point whose coordinates have independent exponents.
    pub(crate) fn point_with_exponents(&mut self, low: i32, high: i32) -> [f32; 3] {
        [0; 3].map(|_| self.size(low, high) * if self.unit() < 0.5 { -1.0 } else { 1.0 })
    }

    /// A point in a cube around another.
    pub(crate) fn near(&mut self, center: [f32; 3], size: f32) -> [f32; 3] {
        center.map(|x| x + size * (2.0 * self.unit() - 1.0))
    }

    /// A point on a triangle, perhaps on an edge or corner, perhaps a little outside.
    pub(crate) fn on_triangle(&mut self, corners: &[[f32; 3]; 3]) -> [f32; 3] {
        let mut weights = [0; 3].map(|_| if self.unit() < 0.2 { 0.0 } else { self.unit() - 0.05 });
        if weights.iter().sum::<f32>() == 0.0 {
            weights[0] = 1.0;
        }
        let sum: f32 = weights.iter().sum();
        [0, 1, 2].map(|axis| (0..3).map(|i| weights[i] / sum * corners[i][axis]).sum())
    }
}
