//! The reference: the same queries by the simplest formulas, for tests and for users who want to see the numbers.
//!
//! Generic over f32 and f64, close to the lecture notes in letters and formulas, without a tree and without any of
//! the kernel's precautions: in f32 its results may be wrong where the kernel's are right.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// f32 or f64.
///
/// ```
/// use lookfrom_bvh::reference::Real;
/// fn twice<T: Real>(x: f32) -> T {
///     T::from_single(x) + T::from_single(x)
/// }
/// assert_eq!(twice::<f64>(1.5), 3.0);
/// ```
pub trait Real:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The square root; NaN below 0.
    fn square_root(self) -> Self;
    /// From single precision, exactly.
    fn from_single(x: f32) -> Self;
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    fn square_root(self) -> Self {
        self.sqrt()
    }
    fn from_single(x: f32) -> Self {
        x
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    fn square_root(self) -> Self {
        self.sqrt()
    }
    fn from_single(x: f32) -> Self {
        x.into()
    }
}

/// Reason why something is not hit. The first reason in this order is returned.
///
/// ```
/// use lookfrom_bvh::reference::{Rejection, cramer};
/// let rule = cramer([0.25, 0.5, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]);
/// assert_eq!(rule.accept(0.0, 1.0), Err(Rejection::BeyondTMax));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejection {
    /// D = 0: the ray runs along the plane, or the triangle has no area.
    Parallel,
    /// The hit with the plane is beyond the edge P0 P2.
    BetaNegative,
    /// The hit with the plane is beyond the edge P0 P1.
    GammaNegative,
    /// β + γ > 1: the hit with the plane is beyond the edge P1 P2.
    BeyondEdge,
    /// The ray's line misses the sphere.
    NoRealRoot,
    /// `t ≤ t_min`: behind the origin, where `t_min` is 0.
    BeforeTMin,
    /// `t ≥ t_max`.
    BeyondTMax,
}

/// Cramer's rule for `a + t d = P0 + β (P1 − P0) + γ (P2 − P0)`, with all intermediate results.
///
/// Nothing is checked: where `d` is 0, quotients are NaN or infinite.
///
/// ```
/// use lookfrom_bvh::reference::cramer;
/// let rule = cramer([0.25, 0.5, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]);
/// assert_eq!((rule.beta, rule.gamma, rule.t), (0.25, 0.5, 2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cramer<T> {
    /// `D = det[P1−P0, P2−P0, −d]`.
    pub d: T,
    /// `det[a−P0, P2−P0, −d]`.
    pub d1: T,
    /// `det[P1−P0, a−P0, −d]`.
    pub d2: T,
    /// `det[P1−P0, P2−P0, a−P0]`.
    pub d3: T,
    /// `1 − β − γ`, the weight of P0.
    pub alpha: T,
    /// `d1 / D`, the weight of P1.
    pub beta: T,
    /// `d2 / D`, the weight of P2.
    pub gamma: T,
    /// `d3 / D`, the ray's parameter.
    pub t: T,
}

/// The ray `a + t d` against the plane of the triangle P0 P1 P2.
///
/// ```
/// use lookfrom_bvh::reference::{Rejection, cramer};
/// let corners = ([0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]);
/// let hit = cramer([0.25, 0.5, 0.0], [0.0, 0.0, 1.0], corners.0, corners.1, corners.2);
/// assert_eq!((hit.alpha, hit.beta, hit.gamma, hit.t), (0.25, 0.25, 0.5, 2.0));
/// assert_eq!(hit.accept(0.0, f64::INFINITY), Ok(2.0));
/// assert_eq!(hit.accept(2.0, f64::INFINITY), Err(Rejection::BeforeTMin));
/// ```
pub fn cramer<T: Real>(a: [T; 3], d: [T; 3], p0: [T; 3], p1: [T; 3], p2: [T; 3]) -> Cramer<T> {
    let c1 = subtract(p1, p0);
    let c2 = subtract(p2, p0);
    let c3 = d.map(|x| -x);
    let r = subtract(a, p0);
    let determinant_d = determinant(c1, c2, c3);
    let d1 = determinant(r, c2, c3);
    let d2 = determinant(c1, r, c3);
    let d3 = determinant(c1, c2, r);
    let beta = d1 / determinant_d;
    let gamma = d2 / determinant_d;
    let alpha = T::ONE - beta - gamma;
    Cramer { d: determinant_d, d1, d2, d3, alpha, beta, gamma, t: d3 / determinant_d }
}

impl<T: Real> Cramer<T> {
    /// The ray's parameter at the hit, or the reason why there is none with `t_min < t < t_max`.
    ///
    /// # Errors
    /// The first reason that applies.
    ///
    /// ```
    /// use lookfrom_bvh::reference::cramer;
    /// let rule = cramer([0.25, 0.5, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]);
    /// assert_eq!(rule.accept(0.0, f64::INFINITY), Ok(2.0));
    /// ```
    pub fn accept(&self, t_min: T, t_max: T) -> Result<T, Rejection> {
        if self.d == T::ZERO {
            Err(Rejection::Parallel)
        } else if !(self.beta >= T::ZERO) {
            Err(Rejection::BetaNegative)
        } else if !(self.gamma >= T::ZERO) {
            Err(Rejection::GammaNegative)
        } else if !(self.beta + self.gamma <= T::ONE) {
            Err(Rejection::BeyondEdge)
        } else if !(self.t > t_min) {
            Err(Rejection::BeforeTMin)
        } else if !(self.t < t_max) {
            Err(Rejection::BeyondTMax)
        } else {
            Ok(self.t)
        }
    }
}

/// The quadratic equation of a ray and a sphere, `A t² + 2 B t + C = 0`, with all intermediate results.
///
/// Nothing is checked: where the discriminant is negative, `q` and the roots are NaN.
///
/// ```
/// use lookfrom_bvh::reference::sphere;
/// let ball = sphere([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], [0.0; 3], 1.0);
/// assert_eq!((ball.t1, ball.t2), (4.0, 2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic<T> {
    /// `A = d·d`.
    pub a: T,
    /// `B = d·(a−c)`, half the linear coefficient.
    pub b: T,
    /// `C = (a−c)·(a−c) − R²`.
    pub c: T,
    /// `A (R² − |(a−c) − (B/A) d|²)`: without cancellation for small or distant spheres.
    pub discriminant: T,
    /// `B² − A C`, the usual form.
    pub discriminant_naive: T,
    /// `−(B + sign(B) √discriminant)`.
    pub q: T,
    /// `q / A`.
    pub t1: T,
    /// `C / q`.
    pub t2: T,
}

/// The root of a [`Quadratic`] that is the hit.
///
/// ```
/// use lookfrom_bvh::reference::{Root, sphere};
/// let ball = sphere([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], [0.0; 3], 1.0);
/// assert_eq!(ball.accept(2.0, 9.0), Ok((Root::Far, 4.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    /// The smaller one: the ray enters the sphere.
    Near,
    /// The larger one: the ray leaves the sphere, or the smaller one is out of range.
    Far,
}

/// The ray `a + t d` against the sphere around `c` with radius `r`.
///
/// ```
/// use lookfrom_bvh::reference::{Root, sphere};
/// let hit = sphere([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 3.0], 1.0);
/// assert_eq!((hit.a, hit.b, hit.c, hit.discriminant), (1.0, -3.0, 8.0, 1.0));
/// assert_eq!(hit.accept(0.0, f64::INFINITY), Ok((Root::Near, 2.0)));
/// assert_eq!(hit.accept(2.0, f64::INFINITY), Ok((Root::Far, 4.0)));
/// ```
pub fn sphere<T: Real>(a: [T; 3], d: [T; 3], c: [T; 3], r: T) -> Quadratic<T> {
    let f = subtract(a, c);
    let coefficient_a = dot(d, d);
    let b = dot(d, f);
    // (|f| − R) (|f| + R) loses fewer digits than f·f − R².
    let length = dot(f, f).square_root();
    let coefficient_c = (length - r) * (length + r);
    let s = b / coefficient_a;
    let nearest = subtract(f, d.map(|x| s * x));
    let discriminant = coefficient_a * (r * r - dot(nearest, nearest));
    let discriminant_naive = b * b - coefficient_a * coefficient_c;
    let root = discriminant.square_root();
    let q = if b < T::ZERO { root - b } else { -(b + root) };
    let (t1, t2) = if q == T::ZERO { (T::ZERO, T::ZERO) } else { (q / coefficient_a, coefficient_c / q) };
    Quadratic { a: coefficient_a, b, c: coefficient_c, discriminant, discriminant_naive, q, t1, t2 }
}

impl<T: Real> Quadratic<T> {
    /// The root that is the nearest hit with `t_min < t < t_max`, and its t; or the reason why there is none.
    ///
    /// # Errors
    /// The first reason that applies.
    ///
    /// ```
    /// use lookfrom_bvh::reference::{Root, sphere};
    /// let ball = sphere([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], [0.0; 3], 1.0);
    /// assert_eq!(ball.accept(0.0, 9.0), Ok((Root::Near, 2.0)));
    /// ```
    pub fn accept(&self, t_min: T, t_max: T) -> Result<(Root, T), Rejection> {
        if !(self.discriminant >= T::ZERO) {
            return Err(Rejection::NoRealRoot);
        }
        let (near, far) = if self.t1 <= self.t2 { (self.t1, self.t2) } else { (self.t2, self.t1) };
        let (root, t) = if near > t_min { (Root::Near, near) } else { (Root::Far, far) };
        if !(t > t_min) {
            Err(Rejection::BeforeTMin)
        } else if !(t < t_max) {
            Err(Rejection::BeyondTMax)
        } else {
            Ok((root, t))
        }
    }
}

/// A primitive, for the brute-force queries.
///
/// ```
/// use lookfrom_bvh::reference::Shape;
/// let ball = Shape::Sphere([0.0; 3], 1.0);
/// # assert!(ball.intersect([0.0; 3], [0.0, 0.0, 1.0], 0.0, 9.0).is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<T> {
    /// Three corners.
    Triangle([[T; 3]; 3]),
    /// Centre and radius.
    Sphere([T; 3], T),
}

impl<T: Real> Shape<T> {
    /// The t of the first hit of the ray `a + t d` with `t_min < t < t_max`.
    ///
    /// # Errors
    /// The reason why there is none.
    ///
    /// ```
    /// use lookfrom_bvh::reference::Shape;
    /// let ball = Shape::Sphere([0.0; 3], 1.0);
    /// assert_eq!(ball.intersect([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], 0.0, 9.0), Ok(2.0));
    /// ```
    pub fn intersect(&self, a: [T; 3], d: [T; 3], t_min: T, t_max: T) -> Result<T, Rejection> {
        match *self {
            Self::Triangle([p0, p1, p2]) => cramer(a, d, p0, p1, p2).accept(t_min, t_max),
            Self::Sphere(c, r) => sphere(a, d, c, r).accept(t_min, t_max).map(|(_, t)| t),
        }
    }
}

/// The first of the nearest hits among shapes: the shape's index, and t.
///
/// ```
/// use lookfrom_bvh::reference::{Shape, closest};
/// let shapes = [Shape::Sphere([0.0, 0.0, -9.0], 1.0), Shape::Sphere([0.0; 3], 1.0)];
/// let (a, d) = ([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
/// assert_eq!(closest(&shapes, a, d, 0.0, 99.0), Some((1, 2.0)));
/// ```
pub fn closest<T: Real>(shapes: &[Shape<T>], a: [T; 3], d: [T; 3], t_min: T, t_max: T) -> Option<(usize, T)> {
    let mut best: Option<(usize, T)> = None;
    for (index, shape) in shapes.iter().enumerate() {
        if let Ok(t) = shape.intersect(a, d, t_min, t_max)
            && best.is_none_or(|(_, least)| t < least)
        {
            best = Some((index, t));
        }
    }
    best
}

/// True if any shape is hit.
///
/// ```
/// use lookfrom_bvh::reference::{Shape, any};
/// let shapes = [Shape::Sphere([0.0, 0.0, -9.0], 1.0), Shape::Sphere([0.0; 3], 1.0)];
/// let (a, d) = ([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
/// assert!(any(&shapes, a, d, 0.0, 3.0) && !any(&shapes, a, d, 0.0, 2.0));
/// ```
pub fn any<T: Real>(shapes: &[Shape<T>], a: [T; 3], d: [T; 3], t_min: T, t_max: T) -> bool {
    shapes.iter().any(|shape| shape.intersect(a, d, t_min, t_max).is_ok())
}

/// The nearest hit of each shape that is hit, in the order of the shapes: the shape's index, and t.
///
/// ```
/// use lookfrom_bvh::reference::{Shape, all};
/// let shapes = [Shape::Sphere([0.0, 0.0, -9.0], 1.0), Shape::Sphere([0.0; 3], 1.0)];
/// let (a, d) = ([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
/// assert_eq!(all(&shapes, a, d, 0.0, 99.0), [(0, 11.0), (1, 2.0)]);
/// ```
pub fn all<T: Real>(shapes: &[Shape<T>], a: [T; 3], d: [T; 3], t_min: T, t_max: T) -> Vec<(usize, T)> {
    let hit =
        |(index, shape): (usize, &Shape<T>)| shape.intersect(a, d, t_min, t_max).ok().map(|t| (index, t));
    shapes.iter().enumerate().filter_map(hit).collect()
}

fn subtract<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The determinant of three columns, by cofactors of the first.
fn determinant<T: Real>(x: [T; 3], y: [T; 3], z: [T; 3]) -> T {
    x[0] * (y[1] * z[2] - y[2] * z[1]) - x[1] * (y[0] * z[2] - y[2] * z[0])
        + x[2] * (y[0] * z[1] - y[1] * z[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_of_a_triangle() {
        let accept = |a: [f64; 3], d: [f64; 3]| {
            cramer(a, d, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).accept(0.0, 10.0)
        };
        let up = [0.0, 0.0, 1.0];
        assert_eq!(accept([0.2, 0.2, -1.0], up), Ok(1.0));
        assert_eq!(accept([0.2, 0.2, -1.0], [1.0, 0.0, 0.0]), Err(Rejection::Parallel));
        assert_eq!(accept([-0.2, 0.2, -1.0], up), Err(Rejection::BetaNegative));
        assert_eq!(accept([0.2, -0.2, -1.0], up), Err(Rejection::GammaNegative));
        assert_eq!(accept([0.8, 0.8, -1.0], up), Err(Rejection::BeyondEdge));
        assert_eq!(accept([0.2, 0.2, 1.0], up), Err(Rejection::BeforeTMin));
        assert_eq!(accept([0.2, 0.2, -10.0], up), Err(Rejection::BeyondTMax));
        assert!(cramer::<f64>([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]).t.is_nan());
    }

    #[test]
    fn the_stable_discriminant_sees_what_the_naive_one_loses() {
        let far = sphere([0.0_f32, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1e4], 0.01);
        assert!((far.discriminant - 1e-4).abs() < 1e-8, "{far:?}");
        assert!((far.discriminant_naive - 1e-4).abs() > 1e-5, "{far:?}");
        assert_eq!(far.accept(0.0, f32::INFINITY).map(|(root, _)| root), Ok(Root::Near));
        let beside = sphere([0.02_f32, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1e4], 0.01);
        assert_eq!(beside.accept(0.0, f32::INFINITY), Err(Rejection::NoRealRoot));
    }
}
