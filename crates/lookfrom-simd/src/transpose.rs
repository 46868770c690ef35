//! Rows to columns, by shuffles.

use fearless_simd::{Simd, f32x8, prelude::*};

/// The columns of eight rows of eight numbers: number `i` of column `k` is number `k` of row `i`.
#[inline(always)]
pub fn transposed<S: Simd>(mut v: [f32x8<S>; 8]) -> [f32x8<S>; 8] {
    // Three perfect shuffles of all 64 numbers.
    let mut round = 0;
    while round < 3 {
        let [a, b, c, d, e, f, g, h] = v;
        v = [
            a.zip_low(e),
            a.zip_high(e),
            b.zip_low(f),
            b.zip_high(f),
            c.zip_low(g),
            c.zip_high(g),
            d.zip_low(h),
            d.zip_high(h),
        ];
        round += 1;
    }
    v
}

#[cfg(test)]
mod tests {
    use fearless_simd::Level;

    use super::*;
    use crate::{Kernel, dispatch};

    struct Transposed([[f32; 8]; 8]);

    impl Kernel for Transposed {
        type Output = [[f32; 8]; 8];
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            transposed(self.0.map(|row| f32x8::load_array(simd, row))).map(Into::into)
        }
    }

    #[test]
    fn rows_become_columns() {
        let rows = std::array::from_fn(|i| std::array::from_fn(|k| (8 * i + k) as f32));
        let columns: [[f32; 8]; 8] = std::array::from_fn(|k| std::array::from_fn(|i| (8 * i + k) as f32));
        for level in [Level::baseline(), Level::new()] {
            assert_eq!(dispatch(level, Transposed(rows)), columns);
        }
    }
}
