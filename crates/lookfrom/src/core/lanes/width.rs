//! Numbers of a width between vectors and columns of memory: eight side by side, or one, which is that of the first lane.

use lookfrom_bvh::Ray;
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask32x8, prelude::*, transposed, u32x8, u64x8};

use super::{LANES, by_lane, gather_spectrum, scatter_rays, scatter_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// A width: it makes numbers from columns. A token of SIMD is that of eight, [`One`] that of one.
pub(crate) trait Width: Copy {
    /// The numbers.
    type Real: Lanes;
    /// The bits of all lanes.
    const ALL: u32;

    /// Numbers of single precision.
    fn load_f32(self, column: &[f32; LANES]) -> Self::Real;
    /// Numbers of double precision.
    fn load_f64(self, column: &[f64; LANES]) -> Double<Self>;
    /// Numbers by lane.
    fn f32s(self, of: impl Fn(usize) -> f32) -> Self::Real;
    /// Integers of 32 bits by lane.
    fn u32s(self, of: impl Fn(usize) -> u32) -> Bits<Self>;
    /// Integers of 64 bits by lane.
    fn u64s(self, of: impl Fn(usize) -> u64) -> Bits64<Self>;
    /// The column of integers of 64 bits.
    fn u64_column(self, bits: Bits64<Self>) -> [u64; LANES];
    /// Values by lane.
    fn by_lane<T: Copy>(self, of: impl Fn(usize) -> T) -> [T; LANES];
    /// The columns of rows of eight numbers.
    fn eights(self, rows: &[[f32; 8]; LANES]) -> [Self::Real; 8];
    /// The mask whose lane i is bit i.
    fn mask(self, bits: u32) -> Mask<Self>;
    /// The bits of a mask: bit i is lane i.
    fn bits(self, mask: Mask<Self>) -> u32;
    /// One number in each lane.
    fn splat(self, value: f32) -> Self::Real;
    /// Spectra by lane.
    fn spectra_of(self, of: impl Fn(usize) -> Spectrum) -> Spectrum<Self::Real>;
    /// The rows of spectra.
    fn spectra(self, spectra: Spectrum<Self::Real>) -> [Spectrum; LANES];
    /// The rows of rays, which start at t = 0.
    fn rays(
        self,
        origin: Vector<Self::Real>,
        direction: Vector<Self::Real>,
        t_max: Self::Real,
    ) -> [Ray; LANES];
}

/// Numbers of double precision of a width.
pub(crate) type Double<W> = <<W as Width>::Real as Real>::Double;
/// Integers of 32 bits of a width.
pub(crate) type Bits<W> = <<W as Width>::Real as Real>::Bits;
/// Integers of 64 bits of a width.
pub(crate) type Bits64<W> = <<W as Width>::Real as Real>::Bits64;
/// Masks of a width.
pub(crate) type Mask<W> = <<W as Width>::Real as Float>::Mask;

/// Numbers that are stored in columns. One number is in all lanes of its column.
pub(crate) trait Lanes: Real<Double: WideLanes> {
    /// The number of each lane.
    fn column(self) -> [f32; LANES];
}

/// [`Lanes`] of double precision.
pub(crate) trait WideLanes: Float<Scalar = f64> {
    /// The number of each lane.
    fn column(self) -> [f64; LANES];
}

/// The width of one number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct One;

impl Width for One {
    type Real = f32;
    const ALL: u32 = 1;

    #[inline(always)]
    fn load_f32(self, column: &[f32; LANES]) -> f32 {
        column[0]
    }
    #[inline(always)]
    fn load_f64(self, column: &[f64; LANES]) -> f64 {
        column[0]
    }
    #[inline(always)]
    fn f32s(self, of: impl Fn(usize) -> f32) -> f32 {
        of(0)
    }
    #[inline(always)]
    fn u32s(self, of: impl Fn(usize) -> u32) -> u32 {
        of(0)
    }
    #[inline(always)]
    fn u64s(self, of: impl Fn(usize) -> u64) -> u64 {
        of(0)
    }
    #[inline(always)]
    fn u64_column(self, bits: u64) -> [u64; LANES] {
        [bits; LANES]
    }
    #[inline(always)]
    fn by_lane<T: Copy>(self, of: impl Fn(usize) -> T) -> [T; LANES] {
        [of(0); LANES]
    }
    #[inline(always)]
    fn eights(self, rows: &[[f32; 8]; LANES]) -> [f32; 8] {
        rows[0]
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> bool {
        bits & 1 != 0
    }
    #[inline(always)]
    fn bits(self, mask: bool) -> u32 {
        u32::from(mask)
    }
    #[inline(always)]
    fn splat(self, value: f32) -> f32 {
        value
    }
    #[inline(always)]
    fn spectra_of(self, of: impl Fn(usize) -> Spectrum) -> Spectrum {
        of(0)
    }
    #[inline(always)]
    fn spectra(self, spectrum: Spectrum) -> [Spectrum; LANES] {
        [spectrum; LANES]
    }
    #[inline(always)]
    fn rays(self, origin: Vector<f32>, direction: Vector<f32>, t_max: f32) -> [Ray; LANES] {
        [Ray::new(origin.into(), direction.into()).with_t_max(t_max); LANES]
    }
}

impl Lanes for f32 {
    #[inline(always)]
    fn column(self) -> [f32; LANES] {
        [self; LANES]
    }
}

impl WideLanes for f64 {
    #[inline(always)]
    fn column(self) -> [f64; LANES] {
        [self; LANES]
    }
}

impl<S: Simd> Width for S {
    type Real = f32x8<S>;
    const ALL: u32 = 0xff;

    #[inline(always)]
    fn load_f32(self, column: &[f32; LANES]) -> f32x8<S> {
        f32x8::load_array(self, *column)
    }
    #[inline(always)]
    fn load_f64(self, column: &[f64; LANES]) -> f64x8<S> {
        f64x8::load_array(self, *column)
    }
    #[inline(always)]
    fn f32s(self, of: impl Fn(usize) -> f32) -> f32x8<S> {
        f32x8::load_array(self, by_lane!(lane => of(lane)))
    }
    #[inline(always)]
    fn u32s(self, of: impl Fn(usize) -> u32) -> u32x8<S> {
        u32x8::load_array(self, by_lane!(lane => of(lane)))
    }
    #[inline(always)]
    fn u64s(self, of: impl Fn(usize) -> u64) -> u64x8<S> {
        u64x8::load_array(self, by_lane!(lane => of(lane)))
    }
    #[inline(always)]
    fn u64_column(self, bits: u64x8<S>) -> [u64; LANES] {
        bits.into()
    }
    #[inline(always)]
    fn by_lane<T: Copy>(self, of: impl Fn(usize) -> T) -> [T; LANES] {
        by_lane!(lane => of(lane))
    }
    #[inline(always)]
    fn eights(self, rows: &[[f32; 8]; LANES]) -> [f32x8<S>; 8] {
        transposed(by_lane!(lane => f32x8::load_array(self, rows[lane])))
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> mask32x8<S> {
        mask32x8::from_bitmask(self, bits.into())
    }
    #[inline(always)]
    fn bits(self, mask: mask32x8<S>) -> u32 {
        mask.to_bitmask() as u32
    }
    #[inline(always)]
    fn splat(self, value: f32) -> f32x8<S> {
        f32x8::splat(self, value)
    }
    #[inline(always)]
    fn spectra_of(self, of: impl Fn(usize) -> Spectrum) -> Spectrum<f32x8<S>> {
        gather_spectrum(self, &by_lane!(lane => of(lane)))
    }
    #[inline(always)]
    fn spectra(self, spectra: Spectrum<f32x8<S>>) -> [Spectrum; LANES] {
        scatter_spectrum(spectra)
    }
    #[inline(always)]
    fn rays(self, origin: Vector<f32x8<S>>, direction: Vector<f32x8<S>>, t_max: f32x8<S>) -> [Ray; LANES] {
        scatter_rays(self, origin, direction, t_max)
    }
}

impl<S: Simd> Lanes for f32x8<S> {
    #[inline(always)]
    fn column(self) -> [f32; LANES] {
        self.into()
    }
}

impl<S: Simd> WideLanes for f64x8<S> {
    #[inline(always)]
    fn column(self) -> [f64; LANES] {
        self.into()
    }
}
