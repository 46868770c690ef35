//! Error bounds of the f32 tests, which only exclude: the exact ones decide in f64.
//!
//! The unit of rounding of f32 is 2⁻²⁴. A box test compares distances along the ray, each with a relative margin
//! ([`ROOM`]) and one for what underflows ([`TINY`]); a triangle test compares determinants with bounds ([`ERROR`],
//! [`UNDERFLOW`]) that grow with the numbers in them. Both need numbers in a range where nothing overflows; usual rays
//! have it ([`SHORT`], [`FAR`]), for others the numbers are scaled and limited.

/// Usual directions are longer than this, 2⁻²⁰, and no component is longer than its inverse.
pub(crate) const SHORT: f32 = 9.536_743e-7;

/// Upper limit of the coordinates of usual origins, 2²⁴.
pub(crate) const FAR: f32 = 16_777_216.0;

/// Largest reciprocal for usual origins.
pub(crate) const LARGEST_RECIPROCAL: f32 = LARGEST_PRODUCT / FAR;

/// The largest product of an origin and a reciprocal, 2¹²⁶: reciprocals that would exceed it are reduced, including
/// that of 0. So no slab distance is ever NaN, and inside a padded box such a component does not limit t.
pub(crate) const LARGEST_PRODUCT: f32 = 8.507_059e37;

/// Relative margin of a product of origin and reciprocal, 2⁻²²: for its rounding, and the origin's in an
/// instance.
pub(crate) const PRODUCT_ROOM: f32 = 2.384_185_8e-7;

/// Relative margin for rounding in distances along a ray: 2⁻²⁰, sixteen units of rounding. Four are needed for a
/// slab (reciprocal, product, and the f32 t that it is compared with), on either side.
pub(crate) const ROOM: f32 = 9.536_743e-7;

/// Absolute margin for a t so small that rounding is not relative to it: 2⁻¹⁰⁰.
pub(crate) const TINY: f32 = 7.888_609e-31;

/// Relative margin for rounding in f64 where a start is moved: 2⁻⁴⁸.
pub(crate) const MOVED_ROOM: f64 = 3.552_713_678_800_501e-15;

/// Errors of the triangle test's determinants: 160 units of rounding, relative to the longest component of the direction.
///
/// Relative to the largest components e of the edges and c of the vector from the origin to the first corner: an
/// edge function is a sum of three products of e and a sum of two products of c and the direction; with one unit
/// for each rounding its error is below 45 e c units, that of the determinant N·d below 45 e e, and that of the
/// third edge function, which is the determinant minus the other two, below 114 e c + 57 e e. An origin that was
/// rounded adds to c.
pub(crate) const ERROR: f32 = 160.0 / 16_777_216.0;

/// The error that underflow may add, relative to the direction where that is longer than 1: a few products that are
/// less than this.
pub(crate) const UNDERFLOW: f32 = 64.0 * f32::MIN_POSITIVE;

/// [`UNDERFLOW`] for usual directions, relative to nothing.
pub(crate) const USUAL_UNDERFLOW: f32 = UNDERFLOW / SHORT;

/// Beyond this (2⁴⁰) the test's products may overflow, and it excludes nothing.
pub(crate) const LARGEST_FILTERED: f32 = 1.099_511_6e12;

/// Scaled distances of sure hits are above this, 2⁻⁶⁰, and below 2⁶⁰.
pub(crate) const SURE_AFTER: f32 = 8.673_617e-19;
