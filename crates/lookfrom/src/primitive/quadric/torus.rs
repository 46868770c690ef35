//! Tori: the tube around a circle in the plane z = 0 of object space.
//!
//! A line meets the surface of the fourth degree `(x² + y² + z² + R² − r²)² = 4 R² (x² + y²)` at most four times. From its point
//! nearest to the centre on, the quartic has no cubic term, and its extremes, roots of a cubic, separate the meetings. Each is found
//! between two of them by Newton's method, to 10⁻¹¹ of R + r however thin the tube is; where a step would leave the interval, that is
//! halved.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use lookfrom_simd::{Float, Mask};

use super::UNIT;
use crate::core::vector::Vector;
use tube::Section;
pub(super) use tube::Tubes;

/// A tube of this part of the size or more is as exactly found by the quartic: that loses as many bits as the tube is thin.
const THIN: f64 = 1.0 / 16.0;
/// The most steps to a root: halving an interval of 2 leaves nothing between its ends.
const MOST_STEPS: u32 = 60;
/// The length of the last step, in units of the torus's size.
const FOUND: f64 = 1e-11;

/// The points at a distance of `tube` from the circle of `radius` around the z axis: of a tube that is thicker than the circle, those on
/// the outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// Of the circle in the middle of the tube, positive.
    pub radius: f64,
    /// Radius of the tube, positive.
    pub tube: f64,
}

/// The quartic `s⁴ + 2 p s² + 4 q s + rest`, which is positive outside.
struct Quartic<F> {
    p: F,
    q: F,
    rest: F,
}

impl<F: Float<Scalar = f64>> Quartic<F> {
    /// The value and the derivative.
    #[inline(always)]
    fn at(&self, s: F) -> (F, F) {
        let Self { p, q, rest } = *self;
        let (two, four) = (s.like(2.0), s.like(4.0));
        (((s * s + two * p) * s + four * q) * s + rest, four * ((s * s + p) * s + q))
    }

    /// Whether it has a minimum and no other extremes.
    #[inline(always)]
    fn has_one_extreme(&self) -> F::Mask {
        !self.discriminant().lt(self.p.like(0.0))
    }

    /// The discriminant of a quarter of the derivative, s³ + p s + q.
    #[inline(always)]
    fn discriminant(&self) -> F {
        self.p.like(0.25) * self.q * self.q + self.p * self.p * self.p / self.p.like(27.0)
    }
}

impl Quartic<f64> {
    /// Parameters of the extremes, ascending, then infinities: Cardano's formula for one, Viète's for three.
    fn extremes(&self) -> [f64; 4] {
        let Self { p, q, .. } = *self;
        let discriminant = self.discriminant();
        if discriminant >= 0.0 {
            // The term without cancellation, and the other by their product.
            let term = libm::cbrt(-0.5 * q - discriminant.sqrt().copysign(q));
            let other = if term == 0.0 { 0.0 } else { -p / (3.0 * term) };
            return [term + other, f64::INFINITY, f64::INFINITY, f64::INFINITY];
        }
        let scale = (-p / 3.0).sqrt();
        let third = libm::acos((-0.5 * q / (scale * scale * scale)).clamp(-1.0, 1.0)) / 3.0;
        let (sin, cos) = libm::sincos(third);
        let (sin, cos) = (scale * 3.0_f64.sqrt() * sin, scale * cos);
        [-cos - sin, -cos + sin, 2.0 * cos, f64::INFINITY]
    }
}

/// A line and a torus, in units of its size, in which nothing overflows.
struct Crossing<F> {
    torus: Torus,
    line: Line<F>,
    quartic: Quartic<F>,
    /// The ends of the line within the bounds of the torus ([`Torus::ends`]).
    from: F,
    to: F,
    /// Of the line's parameter: the way to its origin, the unit of s, and the way by t.
    nearest: F,
    size: F,
    speed: F,
}

/// The first meetings of rays, where they are found without extremes.
pub(super) struct FirstMeetings<F: Float> {
    pub(super) t: F,
    pub(super) exist: F::Mask,
    /// The lanes whose roots, if there are any, have to be searched for between extremes.
    pub(super) are_unclear: F::Mask,
}

impl<F: Float<Scalar = f64>> Crossing<F> {
    /// The parameter of the line that was given.
    #[inline(always)]
    fn parameter(&self, s: F) -> F {
        (self.nearest + s * self.size) / self.speed
    }

    /// Whether the line meets the bounds of the torus after `first`.
    #[inline(always)]
    fn is_near(&self, first: F) -> F::Mask {
        self.from.lt(self.to) & first.lt(self.to)
    }

    /// The first root after `first` of quartics with one extreme, if there is one, without that extreme. It is unclear where Newton's
    /// method passes by the minimum, as it may where the quartic is not convex.
    #[inline(always)]
    fn first_roots(&self, first: F, mut are_sought: F::Mask) -> FirstMeetings<F> {
        let zero = first.like(0.0);
        let start = first.max(self.from);
        let (value, slope) = self.quartic.at(start);
        let comes_down = value.gt(zero) | !first.gt(self.from);
        are_sought = are_sought & (slope.lt(zero) | !comes_down);
        // Towards the minimum, from the outside before it or after it.
        let mut s = F::select(comes_down, start - value / slope, self.to);
        let (mut exist, mut are_unclear) = (are_sought.like(false), are_sought.like(false));
        for _ in 0..MOST_STEPS {
            if !are_sought.any() {
                break;
            }
            let (value, slope) = self.quartic.at(s);
            let descends = slope.lt(zero);
            let has_passed = are_sought & ((descends & !comes_down) | (!descends & comes_down));
            // Of a convex function that has roots no step is too long.
            let is_above = !self.quartic.p.lt(zero) & value.gt(zero);
            are_unclear = are_unclear | (has_passed & !is_above);
            are_sought = are_sought & !has_passed;
            let step = value / slope;
            s = F::select(are_sought, s - step, s);
            let is_found = are_sought & !step.abs().gt(step.like(FOUND));
            exist = exist | is_found;
            are_sought = are_sought & !is_found;
        }
        FirstMeetings { t: self.parameter(s), exist, are_unclear: are_unclear | are_sought }
    }
}

impl Crossing<f64> {
    /// A function that is positive outside and negative inside, and its derivative: the quartic, which is soon computed, but the distance
    /// where that is more exact, or the quartic has roots inside.
    fn at(&self, s: f64) -> (f64, f64) {
        if self.torus.is_by_quartic() {
            return self.quartic.at(s);
        }
        let [origin, direction] = [self.line.origin, self.line.direction].map(DVec3::from);
        let (distance, gradient) = self.torus.distance(origin + s * direction);
        (distance, gradient.dot(direction))
    }

    /// The roots in ascending order, but those far before `first`: between the extremes of the quartic.
    fn roots(&self, first: f64) -> impl Iterator<Item = f64> {
        let mut low = (self.from, true);
        let extremes = self.quartic.extremes().into_iter().take_while(|_| self.from < self.to);
        extremes.filter_map(move |extreme| {
            let high = extreme.clamp(self.from, self.to);
            let is_outside = high == self.to || self.at(high).0 > 0.0;
            let (start, was_outside) = std::mem::replace(&mut low, (high, is_outside));
            let interval = if was_outside { [start, high] } else { [high, start] };
            (high >= first && was_outside != is_outside).then(|| self.root(interval))
        })
    }

    /// The root between a parameter where it is outside and one where it is inside.
    fn root(&self, [outside, inside]: [f64; 2]) -> f64 {
        // From the root of the parabola through both ends whose vertex is at the inner one.
        let [above, below] = [outside, inside].map(|end| self.at(end).0);
        let start = inside + (outside - inside) * (below / (below - above)).sqrt();
        newton(|s| self.at(s), [inside, outside], start)
    }
}

/// The root of a function, given with its derivative, between an end where it is not positive and one where it is: Newton's method, with
/// bisection where a step would leave the bracket.
fn newton(function: impl Fn(f64) -> (f64, f64), [mut below, mut above]: [f64; 2], mut x: f64) -> f64 {
    for _ in 0..MOST_STEPS {
        let (value, slope) = function(x);
        *(if value > 0.0 { &mut above } else { &mut below }) = x;
        let next = x - value / slope;
        let is_between = next > above.min(below) && next < above.max(below);
        let next = if is_between { next } else { 0.5 * (above + below) };
        let step = (next - x).abs();
        x = next;
        // The next step would be some square of this one.
        if step <= FOUND {
            break;
        }
    }
    x
}

/// A vector divided by a number, component by component.
#[inline(always)]
fn quotient<F: Float>(v: Vector<F>, by: F) -> Vector<F> {
    Vector { x: v.x / by, y: v.y / by, z: v.z / by }
}

/// A line from its point nearest to the centre on, in units of the torus's size: `origin + s direction`.
struct Line<F> {
    origin: Vector<F>,
    /// Of unit length.
    direction: Vector<F>,
}

impl Torus {
    /// The radius of the sphere around it.
    pub(super) fn size(&self) -> f64 {
        self.radius + self.tube
    }

    /// A bound of the distance of [refined](Self::refined) points from the surface, along an axis.
    pub(super) fn error(&self) -> f64 {
        32.0 * UNIT * self.size()
    }

    /// Its tube.
    fn tubes(&self) -> Tubes<f64> {
        Tubes { radius: self.radius, tube: self.tube }
    }

    /// The first meetings with rays from `t_min` on, which are sought where the mask is set.
    #[inline(always)]
    pub(super) fn first_meetings<F: Float<Scalar = f64>>(
        &self,
        [origin, direction]: [Vector<F>; 2],
        t_min: F,
    ) -> FirstMeetings<F> {
        let crossing = self.crossing(origin, direction);
        let first = (t_min * crossing.speed - crossing.nearest) / crossing.size;
        let is_near = crossing.is_near(first);
        let are_simple = is_near & crossing.quartic.has_one_extreme();
        if !(crossing.torus.is_by_quartic() && are_simple.any()) {
            return FirstMeetings { t: first, exist: is_near.like(false), are_unclear: is_near };
        }
        let meetings = crossing.first_roots(first, are_simple);
        FirstMeetings { are_unclear: meetings.are_unclear | (is_near & !are_simple), ..meetings }
    }

    /// The parameter of the first meeting with a ray from `t_min` on that is accepted, which any may be.
    pub(super) fn first_accepted(
        &self,
        [origin, direction]: [DVec3; 2],
        t_min: f64,
        accepts: impl Fn(&f64) -> bool,
    ) -> Option<f64> {
        let crossing = self.crossing(origin.into(), direction.into());
        let first = (t_min * crossing.speed - crossing.nearest) / crossing.size;
        crossing.roots(first).map(|s| crossing.parameter(s)).find(accepts)
    }

    /// The parameters of all meetings with a line, in ascending order.
    pub(crate) fn meetings(&self, origin: DVec3, direction: DVec3) -> Vec<f64> {
        let crossing = self.crossing(origin.into(), direction.into());
        crossing.roots(f64::NEG_INFINITY).map(|s| crossing.parameter(s)).collect()
    }

    #[inline(always)]
    fn crossing<F: Float<Scalar = f64>>(&self, origin: Vector<F>, direction: Vector<F>) -> Crossing<F> {
        let speed = direction.length();
        let size = speed.like(self.size());
        let direction = quotient(direction, speed);
        let nearest = -origin.dot(direction);
        let line = Line { origin: quotient(origin + direction * nearest, size), direction };
        let torus = Self { radius: self.radius / self.size(), tube: self.tube / self.size() };
        let [from, to] = torus.ends(&line);
        let quartic = torus.quartic(&line);
        Crossing { torus, line, quartic, from, to, nearest, size, speed }
    }

    /// Whether the quartic is as exact as the distance, and has no roots inside.
    fn is_by_quartic(&self) -> bool {
        self.tube >= THIN && self.tube <= self.radius
    }

    /// The segment of a line within the bounding sphere, of radius 1, and the slab |z| ≤ r; its ends descend where there is none.
    #[inline(always)]
    fn ends<F: Float<Scalar = f64>>(&self, line: &Line<F>) -> [F; 2] {
        let Line { origin: o, direction: d } = *line;
        let (zero, tube) = (o.x.like(0.0), o.x.like(self.tube));
        let half = (o.x.like(1.0) - o.length_squared()).sqrt();
        let [a, b] = [(-tube - o.z) / d.z, (tube - o.z) / d.z];
        let is_level = Float::eq(d.z, zero);
        let is_beside = is_level & o.z.abs().gt(tube);
        let low = F::select(is_level, -half, Float::min(a, b));
        let high = F::select(is_level, half, Float::max(a, b));
        let is_through = half.gt(zero) & !is_beside;
        [
            F::select(is_through, Float::max(low, -half), zero),
            F::select(is_through, Float::min(high, half), zero),
        ]
    }

    /// The quartic of a line.
    #[inline(always)]
    fn quartic<F: Float<Scalar = f64>>(&self, line: &Line<F>) -> Quartic<F> {
        let Line { origin: o, direction: d } = *line;
        let (two, four) = (o.x.like(2.0), o.x.like(4.0));
        let square = o.x.like(self.radius * self.radius);
        let sum = o.length_squared() + square - o.x.like(self.tube * self.tube);
        Quartic {
            p: sum - two * square * (d.x * d.x + d.y * d.y),
            q: -two * square * (o.x * d.x + o.y * d.y),
            rest: sum * sum - four * square * (o.x * o.x + o.y * o.y),
        }
    }

    /// The distance of a point from the surface, negative inside, and its gradient.
    fn distance(&self, p: DVec3) -> (f64, DVec3) {
        let Section { away: [x, y], offset: [across, along], .. } = self.tubes().section(p.into());
        let from_middle = (across * across + along * along).sqrt();
        let gradient = DVec3::new(x * across, y * across, along) / from_middle;
        (from_middle - self.tube, gradient)
    }

    /// The point of the surface nearest to one that is on it up to errors.
    pub(super) fn refined(&self, p: DVec3) -> DVec3 {
        self.tubes().refined(p.into()).into()
    }

    /// The unit normal at a point of the surface.
    pub(super) fn outward(&self, p: DVec3) -> DVec3 {
        self.tubes().outward(p.into()).into()
    }

    /// The angle around the middle of the tube, from the outermost circle up: [0, 2π).
    pub(super) fn angle(&self, p: DVec3) -> f64 {
        let Section { offset: [across, along], .. } = self.tubes().section(p.into());
        super::angle(DVec3::new(across, along, 0.0))
    }

    /// The derivative of a point of the surface by the fraction of [`Torus::angle`].
    pub(super) fn along_tube(&self, p: DVec3) -> DVec3 {
        let Section { away: [x, y], offset: [across, along], .. } = self.tubes().section(p.into());
        TAU * DVec3::new(x * -along, y * -along, across)
    }

    /// The smaller radius of curvature at a point of the surface; where the tube meets itself on the axis, one that is small.
    pub(super) fn radius_of_curvature(&self, p: DVec3) -> f64 {
        self.tubes().radius_of_curvature(p.into())
    }

    /// The half of the angle around the middle of the tube that is on the surface: π, but where the tube meets itself.
    fn half_angle(&self) -> f64 {
        if self.tube > self.radius { libm::acos(-self.radius / self.tube) } else { PI }
    }

    /// The area of a part, for each radian around the axis.
    pub(super) fn area_by_angle(&self) -> f64 {
        let half = self.half_angle();
        2.0 * self.tube * (self.radius * half + self.tube * libm::sin(half))
    }

    /// The distance from the axis and the height of a point of the surface, uniform over the area for uniform `u` in [0, 1).
    pub(super) fn sample(&self, u: f64) -> [f64; 2] {
        let Self { radius, tube } = *self;
        // The area grows by the angle as radius + tube cos: its integral is radius angle + tube sin.
        let half = self.half_angle();
        let wanted = (2.0 * u - 1.0) * (radius * half + tube * libm::sin(half));
        let beyond = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            (radius * angle + tube * sin - wanted, radius + tube * cos)
        };
        let angle = newton(beyond, [-half, half], (2.0 * u - 1.0) * half);
        let (sin, cos) = libm::sincos(angle);
        [radius + tube * cos, tube * sin]
    }
}

#[cfg(test)]
mod tests;
mod tube;
