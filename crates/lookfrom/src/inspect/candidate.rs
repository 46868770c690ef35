//! Candidates of an intersection test, with each number of the test in f32 and f64.
//!
//! The numbers are those of the kernel's reference implementation ([`lookfrom_bvh::reference`]) for the ray that was
//! traced: the same inputs, computed once in f32 and once in f64, so that a difference shows the loss of precision.

use glam::Vec3;
use lookfrom_bvh::reference::{Cramer, Quadratic, Rejection, Root, cramer, sphere};
use lookfrom_bvh::{Hit, NONE, Observer, Procedural, Ray};
use serde::Serialize;

use crate::primitive::{Mesh, Primitives};
use crate::world::World;

/// Maximum number of reported primitives per ray.
const MOST_CANDIDATES: usize = 10_000;

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

/// The numbers of a test, each with its name in the lecture notes.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub enum Test {
    /// Cramer's rule: `D D1 D2 D3 α β γ t`.
    Triangle {
        /// The numbers, by name.
        numbers: Vec<(&'static str, Number)>,
    },
    /// The quadratic equation `A t² + 2 B t + C = 0`.
    Sphere {
        /// The numbers, by name.
        numbers: Vec<(&'static str, Number)>,
    },
    /// Another primitive, without numbers in the notes.
    Other,
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

/// Every primitive that the kernel tests `ray` against, in order.
pub(super) fn candidates(world: &World, ray: &Ray, nearest: &Hit) -> Vec<Candidate> {
    let mut tested = Tested(Vec::new());
    world.bvh.query().observer(&mut tested).closest_hit(ray);
    tested.0.into_iter().map(|ids| candidate(world, ray, ids, nearest)).collect()
}

/// The observer that collects the candidates.
struct Tested(Vec<[u32; 3]>);

impl Observer for Tested {
    fn candidate(&mut self, instance: u32, geometry: u32, primitive: u32) {
        let ids = [instance, geometry, primitive];
        if self.0.len() < MOST_CANDIDATES && !self.0.contains(&ids) {
            self.0.push(ids);
        }
    }
}

fn candidate(
    world: &World,
    ray: &Ray,
    [instance, geometry, primitive]: [u32; 3],
    nearest: &Hit,
) -> Candidate {
    let (primitives, placed) = world.primitives(&Hit { instance, geometry, primitive, ..Hit::MISS });
    // In an instance the test is done in object space, with the same t.
    let ray = match placed {
        None => *ray,
        Some(placed) => {
            let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
            let (origin, direction) = placed.in_object(origin, direction);
            Ray { origin: origin.as_vec3().to_array(), direction: direction.as_vec3().to_array(), ..*ray }
        }
    };
    let index = primitive as usize;
    let (kind, shape, test, outcome) = match primitives {
        Primitives::Mesh(mesh) => {
            let (test, outcome) = triangle_test(mesh, index, &ray);
            ("triangle", mesh.binding.shape, test, outcome)
        }
        Primitives::Spheres(spheres) => {
            let shape = spheres.bindings[spheres.binding_of[index] as usize].binding.shape;
            let (test, outcome) = sphere_test(&spheres.spheres[index], &ray);
            ("sphere", shape, test, outcome)
        }
        Primitives::Disks(disks) => {
            ("disk", disks.bindings[index].shape, Test::Other, procedural_test(disks, primitive, &ray))
        }
        Primitives::Quadrics(quadrics) => {
            let outcome = procedural_test(&**quadrics, primitive, &ray);
            ("quadric", quadrics.bindings[index].shape, Test::Other, outcome)
        }
        Primitives::Patches(patches) => {
            let outcome = procedural_test(&**patches, primitive, &ray);
            ("patch", patches.binding.shape, Test::Other, outcome)
        }
        Primitives::Curves(curves) => {
            let outcome = procedural_test(&**curves, primitive, &ray);
            ("curve segment", curves.binding.shape, Test::Other, outcome)
        }
    };
    let within = if instance == NONE { String::new() } else { format!(" in instance {instance}") };
    let is_nearest =
        [nearest.instance, nearest.geometry, nearest.primitive] == [instance, geometry, primitive];
    let verdict = match (is_nearest, outcome.starts_with("hit")) {
        (true, true) => format!("{outcome}: the nearest"),
        (true, false) => format!("the nearest hit, though in f64 by Cramer's rule alone {outcome}"),
        (false, true) => format!("{outcome}, but another is nearer"),
        (false, false) => outcome,
    };
    Candidate {
        name: format!("{kind} {primitive} of {}{within}", world.names.shapes[shape as usize]),
        verdict,
        is_nearest,
        test,
    }
}

fn procedural_test(primitives: &impl Procedural, primitive: u32, ray: &Ray) -> String {
    let hit = primitives.intersect(primitive, ray);
    hit.map_or("rejected: outside of the primitives or of the range of t".to_owned(), |_| "hit".into())
}

fn triangle_test(mesh: &Mesh, index: usize, ray: &Ray) -> (Test, String) {
    let [p0, p1, p2] = mesh.corners(index);
    let single: Cramer<f32> = cramer(ray.origin, ray.direction, p0, p1, p2);
    let [a, d, p0, p1, p2] = [ray.origin, ray.direction, p0, p1, p2].map(|v| v.map(f64::from));
    let double: Cramer<f64> = cramer(a, d, p0, p1, p2);
    let numbers = vec![
        ("D", Number::new(single.d, double.d)),
        ("D1", Number::new(single.d1, double.d1)),
        ("D2", Number::new(single.d2, double.d2)),
        ("D3", Number::new(single.d3, double.d3)),
        ("α", Number::new(single.alpha, double.alpha)),
        ("β = D1/D", Number::new(single.beta, double.beta)),
        ("γ = D2/D", Number::new(single.gamma, double.gamma)),
        ("t = D3/D", Number::new(single.t, double.t)),
    ];
    let outcome = match double.accept(f64::from(ray.t_min), f64::from(ray.t_max)) {
        Ok(_) => "hit".to_owned(),
        Err(reason) => format!("rejected: {}", why(reason)),
    };
    (Test::Triangle { numbers }, outcome)
}

fn sphere_test(of: &lookfrom_bvh::Sphere, ray: &Ray) -> (Test, String) {
    let single: Quadratic<f32> = sphere(ray.origin, ray.direction, of.center, of.radius);
    let [a, d, c] = [ray.origin, ray.direction, of.center].map(|v| v.map(f64::from));
    let double: Quadratic<f64> = sphere(a, d, c, f64::from(of.radius));
    let numbers = vec![
        ("A", Number::new(single.a, double.a)),
        ("B", Number::new(single.b, double.b)),
        ("C", Number::new(single.c, double.c)),
        ("B² − AC", Number::new(single.discriminant_naive, double.discriminant_naive)),
        ("Δ (stable)", Number::new(single.discriminant, double.discriminant)),
        ("q", Number::new(single.q, double.q)),
        ("t₁ = q/A", Number::new(single.t1, double.t1)),
        ("t₂ = C/q", Number::new(single.t2, double.t2)),
    ];
    let outcome = match double.accept(f64::from(ray.t_min), f64::from(ray.t_max)) {
        Ok((root, t)) => {
            let which = if t == double.t1 { "t₁" } else { "t₂" };
            let side = if root == Root::Near { "the near root" } else { "the far root" };
            format!("hit at {which}, {side}")
        }
        Err(reason) => format!("rejected: {}", why(reason)),
    };
    (Test::Sphere { numbers }, outcome)
}

fn why(reason: Rejection) -> &'static str {
    match reason {
        Rejection::Parallel => "D = 0: the ray runs along the plane",
        Rejection::BetaNegative => "β < 0",
        Rejection::GammaNegative => "γ < 0",
        Rejection::BeyondEdge => "β + γ > 1",
        Rejection::NoRealRoot => "no real root",
        Rejection::BeforeTMin => "t ≤ 0: behind the origin",
        Rejection::BeyondTMax => "t beyond the end of the ray",
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
