//! Triangles and spheres: the kernel's reference implementation.

use lookfrom_bvh::Sphere;
use lookfrom_bvh::reference::{Cramer, Quadratic, Rejection, Root, cramer, sphere as quadratic};

use super::{TestNumbers, TestRay};

/// Cramer's rule for a triangle. Returns the outcome.
pub(super) fn triangle(corners: [[f32; 3]; 3], ray: &TestRay, numbers: &mut TestNumbers) -> String {
    let [p0, p1, p2] = corners;
    let single: Cramer<f32> = cramer(ray.single.origin, ray.single.direction, p0, p1, p2);
    let [p0, p1, p2] = corners.map(|corner| corner.map(f64::from));
    let double: Cramer<f64> = cramer(ray.origin.to_array(), ray.direction.to_array(), p0, p1, p2);
    numbers.input("P0", p0);
    numbers.input("P1", p1);
    numbers.input("P2", p2);
    numbers.number("D", single.d, double.d);
    numbers.number("D1", single.d1, double.d1);
    numbers.number("D2", single.d2, double.d2);
    numbers.number("D3", single.d3, double.d3);
    numbers.number("α", single.alpha, double.alpha);
    numbers.number("β = D1/D", single.beta, double.beta);
    numbers.number("γ = D2/D", single.gamma, double.gamma);
    numbers.number("t = D3/D", single.t, double.t);
    match double.accept(f64::from(ray.single.t_min), f64::from(ray.single.t_max)) {
        Ok(_) => "hit".to_owned(),
        Err(reason) => format!("rejected: {}", why(reason)),
    }
}

/// The quadratic equation of a sphere. Returns the outcome.
pub(super) fn sphere(of: &Sphere, ray: &TestRay, numbers: &mut TestNumbers) -> String {
    let single = quadratic(ray.single.origin, ray.single.direction, of.center, of.radius);
    let (center, radius) = (of.center.map(f64::from), f64::from(of.radius));
    let double = quadratic(ray.origin.to_array(), ray.direction.to_array(), center, radius);
    numbers.input("c", center);
    numbers.input("R", [radius]);
    roots(&single, &double, numbers);
    match double.accept(f64::from(ray.single.t_min), f64::from(ray.single.t_max)) {
        Ok((root, t)) => {
            let which = if t == double.t1 { "t₁" } else { "t₂" };
            let side = if root == Root::Near { "the near root" } else { "the far root" };
            format!("hit at {which}, {side}")
        }
        Err(reason) => format!("rejected: {}", why(reason)),
    }
}

/// The numbers of a quadratic equation.
pub(super) fn roots(single: &Quadratic<f32>, double: &Quadratic<f64>, numbers: &mut TestNumbers) {
    numbers.number("A", single.a, double.a);
    numbers.number("B", single.b, double.b);
    numbers.number("C", single.c, double.c);
    numbers.number("B² − AC", single.discriminant_naive, double.discriminant_naive);
    numbers.number("Δ (stable)", single.discriminant, double.discriminant);
    numbers.number("q", single.q, double.q);
    numbers.number("t₁ = q/A", single.t1, double.t1);
    numbers.number("t₂ = C/q", single.t2, double.t2);
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
