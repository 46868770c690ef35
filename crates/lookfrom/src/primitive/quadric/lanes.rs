//! Points on quadrics, eight at a time.

use lookfrom_simd::{Float, Mask, Simd, f32x8, f64x8, prelude::*};

use super::torus::Tubes;
use super::{Quadric, QuadricKind, Torus, UNIT, gather_frames};
use crate::core::lanes::{LANES, by_lane, gather_f64};
use crate::core::points::Points;
use crate::core::vector::Vector;

/// The surface of a quadric in one lane, in its object space.
#[derive(Clone, Copy)]
struct SurfaceLane {
    /// At this z, if it is flat.
    height: f64,
    is_flat: bool,
    /// Whether the distance from the origin matters, not that from the axis.
    is_ball: bool,
    /// The radius of the circle in the middle of a torus's tube; 0 for others.
    circle: f64,
    /// Of a ball, a cylinder or a tube; that of the curvature, but for a torus.
    radius: f64,
    /// Bounds of the distance from the surface in object space.
    error: [f64; 3],
}

impl SurfaceLane {
    #[inline]
    fn of(quadric: &Quadric) -> Self {
        let flat = |height: f64| Self {
            height,
            is_flat: true,
            is_ball: false,
            circle: 0.0,
            radius: f64::INFINITY,
            error: [0.0, 0.0, 4.0 * UNIT * height.abs()],
        };
        let round = |radius: f64, is_ball: bool| {
            let own = radius * (16.0 * UNIT);
            let error = [own, own, if is_ball { own } else { 0.0 }];
            Self { height: 0.0, is_flat: false, is_ball, circle: 0.0, radius, error }
        };
        match quadric.kind {
            QuadricKind::Sphere { radius, .. } => round(radius, true),
            QuadricKind::Cylinder { radius, .. } => round(radius, false),
            QuadricKind::Disk { height, .. } => flat(height),
            QuadricKind::Rectangle { .. } => flat(0.0),
            QuadricKind::Torus(torus) => {
                let Torus { radius: circle, tube } = torus;
                Self { circle, error: [torus.error(); 3], ..round(tube, false) }
            }
        }
    }
}

/// Points, and outward unit normals.
type PointsAndNormals<S> = (Points<f32x8<S>>, Vector<f64x8<S>>);

/// The points of eight quadrics nearest to some that are on them up to errors, and the outward unit normals there.
#[inline(always)]
pub(crate) fn points_on_quadrics<S: Simd>(
    simd: S,
    quadrics: &[&Quadric; LANES],
    near: Vector<f64x8<S>>,
) -> PointsAndNormals<S> {
    let lanes = by_lane!(lane => SurfaceLane::of(quadrics[lane]));
    let frames = gather_frames(simd, &by_lane!(lane => &quadrics[lane].frame));
    let zero = f64x8::splat(simd, 0.0);
    let is_flat = f64x8::load_array(simd, by_lane!(lane => f64::from(lanes[lane].is_flat))).gt(zero);
    let is_ball = f64x8::load_array(simd, by_lane!(lane => f64::from(lanes[lane].is_ball))).gt(zero);
    let radius = f64x8::load_array(simd, by_lane!(lane => lanes[lane].radius));
    let circle = f64x8::load_array(simd, by_lane!(lane => lanes[lane].circle));
    let height = f64x8::load_array(simd, by_lane!(lane => lanes[lane].height));

    // Bring the points onto the surfaces.
    let p = frames.point_in_object(near);
    let across = Vector { z: Float::select(is_ball, p.z, zero), ..p };
    let stretched = across * (radius / across.length());
    let z = Float::select(is_ball, stretched.z, p.z);
    let position = Vector {
        x: Float::select(is_flat, p.x, stretched.x),
        y: Float::select(is_flat, p.y, stretched.y),
        z: Float::select(is_flat, height, z),
    };

    let across = Vector { z: Float::select(is_ball, position.z, zero), ..position };
    let up = Vector::splat(zero, [0.0, 0.0, 1.0]);
    let outward = Vector::select(is_flat, up, across.normalize());
    let error = gather_f64(simd, &by_lane!(lane => lanes[lane].error));
    let is_torus = circle.gt(zero);
    if !is_torus.any() {
        return frames.place(position, outward, error, radius);
    }
    let tubes = Tubes { radius: circle, tube: radius };
    let refined = tubes.refined(p);
    frames.place(
        Vector::select(is_torus, refined, position),
        Vector::select(is_torus, tubes.outward(refined), outward),
        error,
        Float::select(is_torus, tubes.radius_of_curvature(refined), radius),
    )
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};
    use lookfrom_simd::{Kernel, Level, dispatch};

    use super::*;
    use crate::core::hash;
    use crate::core::lanes::scatter_f64;
    use crate::primitive::MaterialBinding;

    struct Eight<'a>([&'a Quadric; LANES], [[f64; 3]; LANES]);

    impl Kernel for Eight<'_> {
        /// Positions, errors and normals.
        type Output = [[[f64; 3]; LANES]; 3];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let Self(quadrics, near) = self;
            let (points, ng) = points_on_quadrics(simd, &quadrics, gather_f64(simd, &near));
            [points.position, points.error, ng].map(scatter_f64)
        }
    }

    #[test]
    fn eight_points_are_those_of_one_at_a_time() {
        for round in 0..1000_u64 {
            let number = |k: u64| hash::pair(round, k) as f64 / u64::MAX as f64;
            let quadrics: [Quadric; LANES] = std::array::from_fn(|lane| {
                let own = |k: u64| number(100 * lane as u64 + k);
                let radius = libm::exp2(20.0 * own(0) - 10.0);
                let kind = match hash::pair(round, 7 + lane as u64) % 5 {
                    0 => QuadricKind::Sphere { radius, z: [-radius, 0.4 * radius] },
                    1 => QuadricKind::Cylinder { radius, z: [-1.0, own(1)] },
                    2 => QuadricKind::Disk { height: own(2) - 0.5, radius, inner_radius: 0.0 },
                    3 => {
                        QuadricKind::Torus(Torus { radius, tube: radius * libm::exp2(12.0 * own(12) - 10.0) })
                    }
                    _ => QuadricKind::Rectangle { size: [radius, 2.0] },
                };
                let axis = DVec3::new(own(3) - 0.5, own(4) - 0.5, own(5) - 0.5).normalize();
                let matrix = DMat4::from_translation(DVec3::new(own(6), 100.0 * own(7), own(8)))
                    * DMat4::from_axis_angle(axis, 6.0 * own(9))
                    * DMat4::from_scale(DVec3::new(1.0, own(10) - 0.5, 2.0));
                Quadric::new(kind, 360.0, &matrix, own(11) < 0.5).unwrap()
            });
            let points: [DVec3; LANES] = std::array::from_fn(|lane| {
                let u = [20, 21].map(|k| number(100 * lane as u64 + k) as f32);
                let quadric = &quadrics[lane];
                quadric.point_in_render(quadric.sample_in_object(u) * 1.000_001)
            });
            let near = points.map(|point| point.to_array());
            let [positions, errors, normals] =
                dispatch(Level::new(), Eight(std::array::from_fn(|lane| &quadrics[lane]), near));
            for lane in 0..LANES {
                let quadric = &quadrics[lane];
                let one = quadric.point(quadric.point_in_object(points[lane]), MaterialBinding::NONE);
                let expected = [one.point.position, one.point.error, one.ng.to_array()];
                let found = [positions[lane], errors[lane], normals[lane]];
                let bits = |vectors: [[f64; 3]; 3]| vectors.map(|v| v.map(f64::to_bits));
                assert_eq!(bits(found), bits(expected), "{quadric:?}");
            }
        }
    }
}
