//! Whole spheres (ellipsoids, after their transforms), sampled over the cone that they subtend or, from inside, over all
//! directions, at any width.
//!
//! In object space, where they are round. A linear map `A` changes solid angle by `|det A| / |A ω|³` (ω of unit length).

use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask64x8, prelude::*};

use crate::core::lanes::{LANES, bitmask, by_lane};
use crate::core::vector::Vector;
use crate::core::warp;
use crate::light::area::{AreaSamples, toward_all};
use crate::primitive::{QuadricFrames, gather_frames};

/// Relative tolerance within which a point counts as inside: for points on the sphere itself, lit by its inner side.
const ON_SPHERE: f64 = 1e-6;

/// Sampled points nearer than this part of the radius to the reference point are that point itself.
const NEAREST: f64 = 1e-5;

type Wide<R> = <R as Real>::Double;
type WideMask<R> = <Wide<R> as Float>::Mask;

/// Spheres around the origins of their object spaces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphereLights<R: Real> {
    pub(super) frames: QuadricFrames<R>,
    pub(super) radius: Wide<R>,
    /// Ratio of a volume in render space to that in object space.
    pub(super) volume_scale: Wide<R>,
    /// Whether the inner side shines.
    pub(super) shines_inward: WideMask<R>,
}

/// Spheres as seen from points, in object space.
struct View<R: Real> {
    from: Vector<Wide<R>>,
    /// Distance from the centre.
    distance: Wide<R>,
    is_inside: WideMask<R>,
    /// 1 − cosine of the angle between the centre and the rim; 2 from inside.
    one_minus_cos: Wide<R>,
}

impl<R: Real> SphereLights<R> {
    /// Points uniform over the directions in which the spheres are seen from `from`, and the same points in object space;
    /// `u ∈ [0, 1)²`.
    #[inline(always)]
    pub(crate) fn sample(&self, from: Vector<Wide<R>>, u: [R; 2]) -> (AreaSamples<R>, Vector<Wide<R>>) {
        let view = self.view(from);
        let View { from: eye, distance, is_inside, one_minus_cos } = view;
        let (zero, one) = (distance.like(0.0), distance.like(1.0));

        // A direction.
        let local = warp::uniform_cone(u, R::narrow(one_minus_cos)).widen();
        let toward = Vector { x: -eye.x / distance, y: -eye.y / distance, z: -eye.z / distance };
        let axis = Vector::select(distance.gt(zero), toward, Vector { x: zero, y: zero, z: one });
        let (s, t) = warp::basis_about(axis);
        let direction = (s * local.x + t * local.y + axis * local.z).normalize();

        // Its intersection with the sphere; a direction that misses by rounding touches it.
        let along = -eye.dot(direction);
        let nearest = (eye + direction * along).length();
        let half_chord = Float::sqrt(Float::max((self.radius - nearest) * (self.radius + nearest), zero));
        let depth = Float::select(is_inside, along + half_chord, along - half_chord);
        let is_there = !is_inside | depth.gt(self.radius * NEAREST);
        let p = eye + direction * depth;
        let in_object = p * (self.radius / p.length());
        let (points, normal) = self.frames.place_on_spheres(in_object, self.radius);
        let (wi, length) = toward_all(from, points.position);
        let mut samples = AreaSamples::new(points, normal, (wi, length), self.density(&view, wi));
        samples.is_valid = samples.is_valid & samples.pdf.narrow_mask(is_there);
        (samples, in_object)
    }

    /// The solid angle density of unit directions in [`SphereLights::sample`].
    #[inline(always)]
    pub(super) fn pdf(&self, from: Vector<Wide<R>>, wi: Vector<R>) -> R {
        self.density(&self.view(from), wi)
    }

    #[inline(always)]
    fn density(&self, view: &View<R>, wi: Vector<R>) -> R {
        let own = view.distance.like(1.0) / (view.one_minus_cos * (2.0 * std::f64::consts::PI));
        let stretch = self.frames.vector_in_object(wi.widen().normalize()).length();
        R::narrow(own / (self.volume_scale * stretch * stretch * stretch))
    }

    #[inline(always)]
    fn view(&self, from: Vector<Wide<R>>) -> View<R> {
        let from = self.frames.point_in_object(from);
        let distance = from.length();
        let radius = self.radius;
        let border = Float::select(self.shines_inward, radius * (1.0 + ON_SPHERE), radius);
        let is_inside = !distance.gt(border);
        let one = distance.like(1.0);
        let sin = radius / distance;
        // Without cancellation for far spheres.
        let cone = sin * sin / (one + Float::sqrt((one - sin) * (one + sin)));
        View { from, distance, is_inside, one_minus_cos: Float::select(is_inside, one.like(2.0), cone) }
    }
}

/// One sphere in each lane.
#[inline(always)]
pub(crate) fn gather_spheres<S: Simd>(simd: S, rows: &[&SphereLights<f32>; LANES]) -> SphereLights<f32x8<S>> {
    let inward = bitmask(&by_lane!(lane => rows[lane].shines_inward));
    SphereLights {
        frames: gather_frames(simd, &by_lane!(lane => &rows[lane].frames)),
        radius: f64x8::load_array(simd, by_lane!(lane => rows[lane].radius)),
        volume_scale: f64x8::load_array(simd, by_lane!(lane => rows[lane].volume_scale)),
        shines_inward: mask64x8::from_bitmask(simd, inward.into()),
    }
}
