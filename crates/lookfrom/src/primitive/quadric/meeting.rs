//! The first meetings of rays with quadrics, at any width.
//!
//! The quadratic equation after Haines et al. (2019), "Precision Improvements for Ray/Sphere Intersection".

use lookfrom_simd::{Float, Mask, Real};

use super::{Clip, Quadric, QuadricKind};
use crate::core::vector::Vector;

/// Whether numbers are within two bounds.
#[inline(always)]
fn is_within<F: Float<Scalar = f64>>(x: F, low: f64, high: f64) -> F::Mask {
    !(x.lt(x.like(low)) | x.gt(x.like(high)))
}

/// Rays in render space, with their ranges.
pub(super) struct TestedRays<R> {
    pub(super) origin: Vector<R>,
    pub(super) direction: Vector<R>,
    pub(super) t_min: R,
    pub(super) t_max: R,
}

impl<R: Real> TestedRays<R> {
    /// Whether they include the points of parameters.
    #[inline(always)]
    fn include(&self, t: R) -> R::Mask {
        t.gt(self.t_min) & t.lt(self.t_max)
    }
}

/// The first meetings of rays.
pub(super) struct Meetings<R: Real> {
    /// Parameters, where they exist.
    pub(super) t: R,
    pub(super) exist: R::Mask,
    /// The rays for which [`Quadric::unclear_meeting`] has to be asked.
    pub(super) are_unclear: R::Mask,
}

/// Parameters, of those lanes where they exist.
struct Roots<F: Float> {
    exist: F::Mask,
    /// In ascending order.
    t: [F; 2],
}

impl Quadric {
    /// The first meetings of rays with its part of the surface, of which `clip` may leave a part.
    #[inline(always)]
    pub(super) fn first_meetings<R: Real>(&self, clip: Option<&Clip>, rays: &TestedRays<R>) -> Meetings<R> {
        let like = rays.t_min;
        let nowhere = Float::eq(like, like).like(false);
        let none = Meetings { t: like, exist: nowhere, are_unclear: nowhere };
        let at = Vector::splat(like.widen(), self.render_from_object.translation);
        let origin = self.in_object(rays.origin.widen() - at);
        let direction = self.in_object(rays.direction.widen());
        let zero = origin.x.like(0.0);
        let roots = match self.kind {
            QuadricKind::Sphere { radius, .. } => Roots::of_ball(origin, direction, radius),
            QuadricKind::Cylinder { radius, .. } => {
                Roots::of_ball(Vector { z: zero, ..origin }, Vector { z: zero, ..direction }, radius)
            }
            QuadricKind::Disk { height, .. } => Roots::of_plane(origin.z, direction.z, height),
            QuadricKind::Rectangle { .. } => Roots::of_plane(origin.z, direction.z, 0.0),
            QuadricKind::Torus(_) if clip.is_some() => return Meetings { are_unclear: !nowhere, ..none },
            QuadricKind::Torus(torus) => {
                let found = torus.first_meetings([origin, direction], rays.t_min.widen());
                let t = R::narrow(found.t);
                let exist = rays.include(t) & t.narrow_mask(found.exist);
                return Meetings { t, exist, are_unclear: t.narrow_mask(found.are_unclear) };
            }
        };
        if !roots.exist.any() {
            return none;
        }
        let line = [origin, direction];
        let (t1, meets1) = self.meeting(clip, rays, line, (roots.t[0], roots.exist));
        if meets1.all() || matches!(self.kind, QuadricKind::Disk { .. } | QuadricKind::Rectangle { .. }) {
            return Meetings { t: t1, exist: meets1, ..none };
        }
        let (t2, meets2) = self.meeting(clip, rays, line, (roots.t[1], roots.exist));
        Meetings { t: R::select(meets1, t1, t2), exist: meets1 | meets2, ..none }
    }

    /// A root as a parameter of the rays, and whether they meet what is left of the surface there; `line` is in object space.
    #[inline(always)]
    fn meeting<R: Real>(
        &self,
        clip: Option<&Clip>,
        rays: &TestedRays<R>,
        [origin, direction]: [Vector<R::Double>; 2],
        (t, exists): (R::Double, <R::Double as Float>::Mask),
    ) -> (R, R::Mask) {
        let rounded = R::narrow(t);
        let is_in_range = rays.include(rounded) & rounded.narrow_mask(exists);
        if !is_in_range.any() {
            return (rounded, is_in_range);
        }
        let p = origin + direction * t;
        let is_left = match clip {
            // The whole surface but for the ends of cylinders, which refining does not move.
            Some(clip) => {
                let is_part = self.contains(p);
                if is_part.any() { is_part & clip.keeps(rounded, p) } else { is_part }
            }
            None => self.contains(self.refined_across(p)),
        };
        (rounded, is_in_range & rounded.narrow_mask(is_left))
    }

    /// Directions of render space, in object space.
    #[inline(always)]
    fn in_object<F: Float<Scalar = f64>>(&self, v: Vector<F>) -> Vector<F> {
        let [x, y, z] = self.object_from_render.matrix;
        Vector::new(Vector::splat(v.x, x).dot(v), Vector::splat(v.x, y).dot(v), Vector::splat(v.x, z).dot(v))
    }

    /// The points of a sphere nearest to ones that are on it up to errors; of other kinds these, which have the same heights, turns and
    /// distances from the axis up to errors that do not matter.
    #[inline(always)]
    fn refined_across<F: Float<Scalar = f64>>(&self, p: Vector<F>) -> Vector<F> {
        match self.kind {
            QuadricKind::Sphere { radius, .. } => p * (p.x.like(radius) / p.length()),
            _ => p,
        }
    }

    /// Whether points of the whole surface are in the quadric's part of it.
    #[inline(always)]
    fn contains<F: Float<Scalar = f64>>(&self, p: Vector<F>) -> F::Mask {
        let there = match self.kind {
            QuadricKind::Sphere { radius, z: [low, high] } => {
                // A whole sphere has no edge for rounding to fall beyond.
                let from = if low <= -radius { f64::NEG_INFINITY } else { low };
                is_within(p.z, from, if high >= radius { f64::INFINITY } else { high })
            }
            QuadricKind::Cylinder { z: [low, high], .. } => is_within(p.z, low, high),
            QuadricKind::Disk { radius, inner_radius, .. } => {
                is_within(p.x * p.x + p.y * p.y, inner_radius * inner_radius, radius * radius)
            }
            QuadricKind::Rectangle { size: [x, y] } => is_within(p.x, 0.0, x) & is_within(p.y, 0.0, y),
            QuadricKind::Torus(_) => p.x.eq(p.x).like(true),
        };
        if self.is_whole_turn() { there } else { there & self.is_swept(p) }
    }

    /// Whether the angles of points around the z axis are at most `phi_max`.
    #[inline(always)]
    fn is_swept<F: Float<Scalar = f64>>(&self, p: Vector<F>) -> F::Mask {
        let zero = p.x.like(0.0);
        let [cos, sin] = self.sweep_end;
        // The sine of the angle that is left to the end.
        let is_before_end = !(p.x * p.x.like(sin) - p.y * p.x.like(cos)).lt(zero);
        let is_in_first_half = !p.y.lt(zero);
        if self.phi_max <= std::f64::consts::PI {
            is_in_first_half & is_before_end
        } else {
            is_in_first_half | is_before_end
        }
    }
}

impl<F: Float<Scalar = f64>> Roots<F> {
    /// Of lines with the sphere around the origin; `f` are points of the lines.
    #[inline(always)]
    fn of_ball(f: Vector<F>, d: Vector<F>, radius: f64) -> Self {
        let square = f.x.like(radius * radius);
        let a = d.length_squared();
        let b = f.dot(d);
        let by_a = a.like(1.0) / a;
        // The discriminant from the lines' points nearest to the centre: no cancellation for small or far spheres.
        let nearest = (f - d * (b * by_a)).length_squared();
        let discriminant = a * (square - nearest);
        let zero = a.like(0.0);
        let exist = discriminant.gt(zero) | Float::eq(discriminant, zero);
        if !exist.any() {
            return Self { exist, t: [zero; 2] };
        }
        // Both roots without cancellation.
        let c = f.length_squared() - square;
        let q = -(b + discriminant.sqrt().copysign(b));
        let is_double = Float::eq(q, zero);
        let t1 = F::select(is_double, zero, q * by_a);
        let t2 = F::select(is_double, zero, c / q);
        let is_ascending = !t1.gt(t2);
        Self { exist, t: [F::select(is_ascending, t1, t2), F::select(is_ascending, t2, t1)] }
    }

    /// Of lines with a plane perpendicular to the z axis; one of each.
    #[inline(always)]
    fn of_plane(z: F, by_t: F, height: f64) -> Self {
        let t = (z.like(height) - z) / by_t;
        Self { exist: Float::eq(t, t), t: [t, t] }
    }
}
