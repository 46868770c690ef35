//! Candidates of an intersection test, with the inputs of the test and each of its numbers in f32 and f64.
//!
//! The numbers are those of the kernel's reference implementation ([`lookfrom_bvh::reference`]) for the ray that was
//! traced: the same inputs, computed once in f32 and once in f64, so that a difference shows the loss of precision.
//! Every number can be computed anew from the inputs, which are printed exactly.

mod curve;
mod disk;
mod patch;
mod quadric;
mod reference;
mod torus;
mod traversal;

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, NONE, Procedural, Ray};
use serde::Serialize;

use traversal::Tested;

use crate::primitive::{Primitives, QuadricKind};
use crate::world::{PlacedInstance, World};

pub use traversal::TraversalReport;
pub(super) use traversal::of_shadow;

/// A primitive that a ray was tested against.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// The primitive and its shape.
    pub name: String,
    /// The result of the test, with the reason for a miss.
    pub verdict: String,
    /// Whether it is the ray's closest hit.
    pub is_nearest: bool,
    /// The numbers of the test.
    pub test: Test,
}

/// A test by the kind of primitive.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub enum Test {
    /// Cramer's rule: `D D1 D2 D3 α β γ t`.
    Triangle(TestNumbers),
    /// The quadratic equation `A t² + 2 B t + C = 0`.
    Sphere(TestNumbers),
    /// The same of a sphere or cylinder in its own space, the plane of a disk there, or the quartic equation of a torus.
    Quadric(TestNumbers),
    /// The plane of the disk, and the coordinates `x y` in it.
    Disk(TestNumbers),
    /// The quadratic equation `a + b u + c u² = 0` of a bilinear patch.
    Patch(TestNumbers),
    /// The distance of the ray from the curve at its hit.
    Curve(TestNumbers),
}

impl Test {
    /// The inputs and the numbers.
    pub fn numbers(&self) -> &TestNumbers {
        match self {
            Self::Triangle(numbers)
            | Self::Sphere(numbers)
            | Self::Quadric(numbers)
            | Self::Disk(numbers)
            | Self::Patch(numbers)
            | Self::Curve(numbers) => numbers,
        }
    }
}

/// The inputs of a test and the numbers that are computed from them. Lengths and points are relative to the render
/// origin ([`Inspection::render_origin`](super::Inspection::render_origin)), or in the space of an object where an input
/// `a in the object` says so.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TestNumbers {
    /// The inputs by name, exactly: each is a vector or a number. `a` and `d` are the ray's, `a + t d`.
    pub inputs: Vec<(&'static str, Vec<f64>)>,
    /// The numbers, each with its name in the lecture notes.
    pub numbers: Vec<(&'static str, Number)>,
}

impl TestNumbers {
    /// Adds an input.
    fn input(&mut self, name: &'static str, value: impl AsRef<[f64]>) {
        self.inputs.push((name, value.as_ref().to_vec()));
    }

    /// Adds the way to another space: `v' = M v` of directions, `p' = M (p − at)` of points.
    fn space(&mut self, names: [&'static str; 4], rows: [[f64; 3]; 3], at: DVec3) {
        let [of_place, of_rows @ ..] = names;
        self.input(of_place, at.to_array());
        of_rows.into_iter().zip(rows).for_each(|(name, row)| self.input(name, row));
    }

    /// Adds a number, unless there is none.
    fn number(&mut self, name: &'static str, f32: f32, f64: f64) {
        if !(f32.is_nan() && f64.is_nan()) {
            self.numbers.push((name, Number::new(f32, f64)));
        }
    }
}

/// One quantity, computed twice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Number {
    /// In f32.
    pub f32: f32,
    /// In f64.
    pub f64: f64,
    /// Number of leading bits that agree, of the 24 that f32 has.
    pub bits: u32,
}

impl Number {
    fn new(f32: f32, f64: f64) -> Self {
        Self { f32, f64, bits: matching_bits(f32, f64) }
    }
}

/// Number of correct leading bits of `approximate`: 24 when it is `exact` rounded to f32, 0 when not even the first is.
fn matching_bits(approximate: f32, exact: f64) -> u32 {
    if approximate == exact as f32 || (approximate.is_nan() && exact.is_nan()) {
        return f32::MANTISSA_DIGITS;
    }
    let error = ((f64::from(approximate) - exact) / exact).abs();
    // An error of 2⁻ᵏ leaves k bits; one that is infinite or not a number leaves none.
    let bits = -libm::log2(error);
    if bits > 0.0 { (bits as u32).min(f32::MANTISSA_DIGITS - 1) } else { 0 }
}

/// The cost of a ray, and every primitive that the kernel tests it against, in order.
pub(super) fn candidates(
    world: &World,
    (ray, time): (&Ray, f32),
    nearest: &Hit,
) -> (TraversalReport, Vec<Candidate>) {
    let mut tested = Tested::default();
    world.bvh.query().time(time).observer(&mut tested).closest_hit(ray);
    let Tested { traversal, primitives } = tested;
    (traversal, primitives.into_iter().map(|ids| candidate(world, (ray, time), ids, nearest)).collect())
}

/// A ray in the space in which a primitive is tested.
#[derive(Clone, Copy, Debug)]
struct TestRay {
    /// As the kernel tests it: not rounded to f32 in an instance.
    origin: DVec3,
    direction: DVec3,
    /// Rounded to f32.
    single: Ray,
}

impl TestRay {
    /// A ray of render space, or in the object of an instance as the kernel takes it there; t stays the same.
    fn new(ray: &Ray, instance: Option<PlacedInstance<'_>>) -> Self {
        let [mut origin, mut direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        if let Some(instance) = instance {
            let to_object = instance.object_from_render();
            origin = to_object.transform_vector3(origin - instance.render_from_object().w_axis.truncate());
            direction = to_object.transform_vector3(direction);
        }
        let single =
            Ray { origin: origin.as_vec3().to_array(), direction: direction.as_vec3().to_array(), ..*ray };
        Self { origin, direction, single }
    }

    /// Why a hit at `t` is out of range, if it is.
    fn range(&self, t: f64) -> Option<&'static str> {
        if !(t > f64::from(self.single.t_min)) {
            Some("t ≤ 0: behind the origin")
        } else if !(t < f64::from(self.single.t_max)) {
            Some("t beyond the end of the ray")
        } else {
            None
        }
    }

    /// Adds the ray as inputs.
    fn add_to(&self, numbers: &mut TestNumbers, names: [&'static str; 2]) {
        numbers.input(names[0], self.origin.to_array());
        numbers.input(names[1], self.direction.to_array());
    }
}

/// Names of a ray in the space of an object.
const IN_OBJECT: [&str; 2] = ["a in the object", "d in the object"];

fn candidate(
    world: &World,
    (ray, time): (&Ray, f32),
    [instance, geometry, primitive]: [u32; 3],
    nearest: &Hit,
) -> Candidate {
    let (primitives, placed) = world.primitives(&Hit { instance, geometry, primitive, ..Hit::MISS }, time);
    let ray = TestRay::new(ray, placed);
    let index = primitive as usize;
    let mut numbers = TestNumbers::default();
    if let Some(placed) = placed {
        let [x, y, z, _] = placed.object_from_render().transpose().to_cols_array_2d();
        numbers.input("instance at", placed.render_from_object().w_axis.truncate().to_array());
        numbers.input("to object, row 1", &x[..3]);
        numbers.input("to object, row 2", &y[..3]);
        numbers.input("to object, row 3", &z[..3]);
    }
    ray.add_to(&mut numbers, if placed.is_some() { IN_OBJECT } else { ["a", "d"] });
    let (kind, shape, test, outcome) = match primitives {
        Primitives::Mesh(mesh) => {
            let outcome = reference::triangle(mesh.corners_at(index, time), &ray, &mut numbers);
            ("triangle", mesh.binding.shape, Test::Triangle(numbers), outcome)
        }
        Primitives::Spheres(spheres) => {
            let shape = spheres.bindings[spheres.binding_of[index] as usize].binding.shape;
            let outcome = reference::sphere(&spheres.spheres[index], &ray, &mut numbers);
            ("sphere", shape, Test::Sphere(numbers), outcome)
        }
        Primitives::Disks(disks) => {
            let reason = disk::test(&disks.disks[index], &ray, &mut numbers);
            let outcome = procedural(disks, primitive, &ray, reason);
            ("disk", disks.bindings[index].shape, Test::Disk(numbers), outcome)
        }
        Primitives::Quadrics(quadrics) => {
            let reason =
                quadric::test(&quadrics.quadrics[index], quadrics.clips.get(index), &ray, &mut numbers);
            let outcome = procedural(&**quadrics, primitive, &ray, reason.as_deref());
            let is_torus = matches!(quadrics.quadrics[index].kind, QuadricKind::Torus(_));
            let kind = if is_torus { "torus" } else { "quadric" };
            (kind, quadrics.bindings[index].shape, Test::Quadric(numbers), outcome)
        }
        Primitives::Patches(patches) => {
            let reason = patch::test(patches.corners(index), &ray, &mut numbers);
            let outcome = procedural(&**patches, primitive, &ray, reason.as_deref());
            ("patch", patches.binding.shape, Test::Patch(numbers), outcome)
        }
        Primitives::Curves(curves) => {
            let reason = curve::test(curves, primitive, &ray, &mut numbers);
            let outcome = procedural(&**curves, primitive, &ray, reason.as_deref());
            ("curve segment", curves.binding.shape, Test::Curve(numbers), outcome)
        }
    };
    let within = if instance == NONE { String::new() } else { format!(" in instance {instance}") };
    let is_nearest =
        [nearest.instance, nearest.geometry, nearest.primitive] == [instance, geometry, primitive];
    let verdict = match (is_nearest, outcome.starts_with("hit")) {
        (true, true) => format!("{outcome}: the nearest"),
        (true, false) => format!("the nearest hit, though by these numbers in f64 alone {outcome}"),
        (false, true) => format!("{outcome}, but another is nearer"),
        (false, false) => outcome,
    };
    Candidate {
        name: format!("{kind} {primitive} of {}{within}", world.names.shapes[shape as usize].of(primitive)),
        verdict,
        is_nearest,
        test,
    }
}

/// The result of the kernel's own test of a primitive, which is in f64; `reason` is that of a miss, where it is known.
fn procedural(primitives: &impl Procedural, primitive: u32, ray: &TestRay, reason: Option<&str>) -> String {
    match primitives.intersect(primitive, &ray.single) {
        Some(_) => "hit".into(),
        None => format!("rejected: {}", reason.unwrap_or("outside of the primitive or of the range of t")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_counted() {
        assert_eq!(matching_bits(0.1, 0.1), 24);
        assert_eq!(matching_bits(0.0, 0.0), 24);
        assert_eq!(matching_bits(1.0, 1.0 + 2f64.powi(-10)), 10);
        assert_eq!(matching_bits(1.0, 1.0 - 2f64.powi(-30)), 24);
        assert_eq!(matching_bits(-1.0, 1.0), 0);
        assert_eq!(matching_bits(1.0, 0.0), 0);
        assert_eq!(matching_bits(f32::NAN, 1.0), 0);
        assert_eq!(matching_bits(f32::INFINITY, 1.0), 0);
    }
}
