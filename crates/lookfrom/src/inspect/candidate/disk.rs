//! Disks: the plane `N·(p − c) = 0` with `N = u × v`, and the coordinates in it of `p = a + t d`.

use glam::DVec3;
use lookfrom_bvh::reference::Real;

use super::{TestNumbers, TestRay};
use crate::primitive::Disk;

/// A vector of the reference's numbers.
type Vector<T> = [T; 3];

/// The numbers of the test.
struct DiskTest<T> {
    /// `N·(c − a)`.
    height: T,
    /// `N·d`.
    slope: T,
    /// Their quotient.
    t: T,
    /// `((p − c) × v)·N / N·N`.
    x: T,
    /// `(u × (p − c))·N / N·N`.
    y: T,
    /// `x² + y²`.
    square: T,
}

fn disk_test<T: Real>([a, d, c, u, v]: [Vector<T>; 5]) -> DiskTest<T> {
    let n = cross(u, v);
    let (height, slope) = (dot(n, subtract(c, a)), dot(n, d));
    let t = height / slope;
    let from_center: Vector<T> = std::array::from_fn(|k| a[k] + t * d[k] - c[k]);
    let size = dot(n, n);
    let (x, y) = (dot(cross(from_center, v), n) / size, dot(cross(u, from_center), n) / size);
    DiskTest { height, slope, t, x, y, square: x * x + y * y }
}

/// Adds the inputs and numbers of the test of a disk; returns the reason why it is missed, if it is.
pub(super) fn test(disk: &Disk, ray: &TestRay, numbers: &mut TestNumbers) -> Option<&'static str> {
    let single = |v: DVec3| v.as_vec3().to_array();
    let &Disk { center, axis_u, axis_v, .. } = disk;
    let f32 =
        disk_test([ray.single.origin, ray.single.direction, single(center), single(axis_u), single(axis_v)]);
    let f64 = disk_test([ray.origin, ray.direction, center, axis_u, axis_v].map(|v| v.to_array()));
    numbers.input("c", center.to_array());
    numbers.input("u", axis_u.to_array());
    numbers.input("v", axis_v.to_array());
    numbers.number("N·(c − a)", f32.height, f64.height);
    numbers.number("N·d", f32.slope, f64.slope);
    numbers.number("t", f32.t, f64.t);
    numbers.number("x", f32.x, f64.x);
    numbers.number("y", f32.y, f64.y);
    numbers.number("x² + y²", f32.square, f64.square);
    match f64.slope == 0.0 {
        true => Some("N·d = 0: the ray runs along the plane"),
        false => ray.range(f64.t).or((f64.square > 1.0).then_some("x² + y² > 1")),
    }
}

pub(super) fn subtract<T: Real>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(super) fn dot<T: Real>(a: Vector<T>, b: Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<T: Real>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}
