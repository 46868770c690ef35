//! Quadrics in their own space, where they are spheres, cylinders, disks and tori around the z axis.

use glam::DVec3;
use lookfrom_bvh::reference::{Quadratic, sphere as quadratic};

use super::reference::roots;
use super::{TestNumbers, TestRay, torus};
use crate::primitive::{Clip, Quadric, QuadricKind};

/// Names of a ray in the space of a quadric.
const IN_QUADRIC: [&str; 2] = ["a in the quadric", "d in the quadric"];

/// Names of the way to the space of a quadric.
const TO_QUADRIC: [&str; 4] =
    ["quadric at", "to the quadric, row 1", "to the quadric, row 2", "to the quadric, row 3"];

const ALONG_PLANE: &str = "d_z = 0: the ray runs along the plane";

/// A quadric, or the part of it that a solid leaves.
#[derive(Clone, Copy)]
struct Surface<'a> {
    quadric: &'a Quadric,
    clip: Option<&'a Clip>,
}

impl Surface<'_> {
    /// Why a point of the quadric is no hit.
    fn miss(&self, at: DVec3) -> String {
        match self.clip.and_then(|clip| clip.cut(at)) {
            Some(cut) => format!("cut away, since it is {cut}"),
            None => "it is not hit".to_owned(),
        }
    }
}

/// Adds the inputs and numbers of the test of a quadric, of which `clip` may leave a part; returns the reason why it is missed, if it is.
pub(super) fn test(
    quadric: &Quadric,
    clip: Option<&Clip>,
    ray: &TestRay,
    numbers: &mut TestNumbers,
) -> Option<String> {
    let (rows, at) = quadric.object_space();
    numbers.space(TO_QUADRIC, rows, at);
    let ray = TestRay {
        origin: quadric.point_in_object(ray.origin),
        direction: quadric.vector_in_object(ray.direction),
        ..*ray
    };
    ray.add_to(numbers, IN_QUADRIC);
    let in_plane = DVec3::new(1.0, 1.0, 0.0);
    let surface = Surface { quadric, clip };
    let reason = match quadric.kind {
        QuadricKind::Sphere { radius, z } => {
            numbers.input("R", [radius]);
            numbers.input("z from, to", z);
            curved(&ray, DVec3::ONE, (radius, z, surface), numbers)
        }
        QuadricKind::Cylinder { radius, z } => {
            numbers.input("R", [radius]);
            numbers.input("z from, to", z);
            curved(&ray, in_plane, (radius, z, surface), numbers)
        }
        QuadricKind::Disk { height, radius, inner_radius } => {
            numbers.input("z", [height]);
            numbers.input("R", [radius]);
            numbers.input("R of the hole", [inner_radius]);
            flat(&ray, (height, radius, inner_radius, surface), numbers)
        }
        QuadricKind::Rectangle { size } => {
            numbers.input("size", size);
            return Some(rectangle(&ray, size, surface, numbers));
        }
        QuadricKind::Torus(torus) => {
            return Some(torus::test(&torus, &ray, numbers, |t| {
                surface.miss(ray.origin + t * ray.direction)
            }));
        }
    };
    numbers.input("φ up to", [quadric.phi_max]);
    reason
}

/// The quadratic equation of a sphere around the origin, or, across the axis, of a cylinder; and z and φ of its roots.
fn curved(
    ray: &TestRay,
    axes: DVec3,
    (radius, [low, high], surface): (f64, [f64; 2], Surface<'_>),
    numbers: &mut TestNumbers,
) -> Option<String> {
    let [a, d] = [ray.origin, ray.direction].map(|v| (v * axes).to_array());
    let double: Quadratic<f64> = quadratic(a, d, [0.0; 3], radius);
    let [a32, d32] = [a, d].map(|v| v.map(|x| x as f32));
    let single: Quadratic<f32> = quadratic(a32, d32, [0.0; 3], radius as f32);
    roots(&single, &double, numbers);
    if !(double.discriminant >= 0.0) {
        return Some("no real root".to_owned());
    }
    let names = [["z at t₁", "φ at t₁"], ["z at t₂", "φ at t₂"]];
    let root_pairs = [(single.t1, double.t1), (single.t2, double.t2)];
    for ([z, phi], (t32, t64)) in names.into_iter().zip(root_pairs) {
        place(ray, t32, t64, [z, phi], numbers);
    }
    let why = |(name, t): (&str, f64)| {
        let at = ray.origin + t * ray.direction;
        let [z, phi] = place_of(at);
        let outside = if phi > surface.quadric.phi_max {
            "φ is not of its part".to_owned()
        } else if !(low..=high).contains(&z) {
            "z is not of its part".to_owned()
        } else {
            surface.miss(at)
        };
        format!("{name}: {}", ray.range(t).unwrap_or(&outside))
    };
    let both = [("t₁", double.t1), ("t₂", double.t2)].map(why);
    Some(both.join("; "))
}

/// The plane of a disk.
fn flat(
    ray: &TestRay,
    (height, outer, inner, surface): (f64, f64, f64, Surface<'_>),
    numbers: &mut TestNumbers,
) -> Option<String> {
    let (a, d) = (ray.origin, ray.direction);
    let t = (height - a.z) / d.z;
    let single = (height as f32 - a.z as f32) / d.z as f32;
    numbers.number("t = (z − a_z)/d_z", single, t);
    let radius = |x: f64, y: f64| (x * x + y * y).sqrt();
    let at = a + t * d;
    let at32 = a.as_vec3() + single * d.as_vec3();
    numbers.number("√(x² + y²)", (at32.x * at32.x + at32.y * at32.y).sqrt(), radius(at.x, at.y));
    place(ray, single, t, ["z at t", "φ at t"], numbers);
    let from_axis = radius(at.x, at.y);
    let outside = if d.z == 0.0 {
        ALONG_PLANE.to_owned()
    } else if from_axis > outer {
        "√(x² + y²) > R".to_owned()
    } else if from_axis < inner {
        "√(x² + y²) < R of the hole".to_owned()
    } else if place_of(at)[1] > surface.quadric.phi_max {
        "φ is not of its part".to_owned()
    } else {
        surface.miss(at)
    };
    Some(ray.range(t).unwrap_or(&outside).to_owned())
}

/// The plane of a rectangle, and x and y there. Returns the reason why it is missed.
fn rectangle(
    ray: &TestRay,
    [width, height]: [f64; 2],
    surface: Surface<'_>,
    numbers: &mut TestNumbers,
) -> String {
    let (a, d) = (ray.origin, ray.direction);
    let t = -a.z / d.z;
    let single = -(a.z as f32) / d.z as f32;
    numbers.number("t = −a_z/d_z", single, t);
    let at = a + t * d;
    let at32 = a.as_vec3() + single * d.as_vec3();
    numbers.number("x at t", at32.x, at.x);
    numbers.number("y at t", at32.y, at.y);
    let outside = if d.z == 0.0 {
        ALONG_PLANE.to_owned()
    } else if !(0.0..=width).contains(&at.x) {
        "x is not of its side".to_owned()
    } else if !(0.0..=height).contains(&at.y) {
        "y is not of its side".to_owned()
    } else {
        surface.miss(at)
    };
    ray.range(t).unwrap_or(&outside).to_owned()
}

/// z and φ of a point, φ from 0 to 2π.
fn place_of(at: DVec3) -> [f64; 2] {
    let phi = libm::atan2(at.y, at.x);
    [at.z, if phi < 0.0 { phi + std::f64::consts::TAU } else { phi }]
}

/// z and φ of the point at t.
fn place(ray: &TestRay, t32: f32, t64: f64, [z, phi]: [&'static str; 2], numbers: &mut TestNumbers) {
    let at = ray.origin + t64 * ray.direction;
    let at32 = ray.origin.as_vec3() + t32 * ray.direction.as_vec3();
    let turn = |phi: f64| if phi < 0.0 { phi + std::f64::consts::TAU } else { phi };
    numbers.number(z, at32.z, at.z);
    let single = libm::atan2f(at32.y, at32.x);
    numbers.number(phi, turn(f64::from(single)) as f32, place_of(at)[1]);
}
