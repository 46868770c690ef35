//! Tori in their own space: the quartic equation `c₄ t⁴ + c₃ t³ + c₂ t² + c₁ t + c₀ = 0` of a ray, and its roots.

use lookfrom_bvh::reference::Real;

use super::disk::dot;
use super::{TestNumbers, TestRay};
use crate::primitive::Torus;

/// Steps of Newton's method in f32 from a root in f64.
const STEPS: u32 = 4;

/// The coefficients, c₀ first, of `(|a + t d|² + R² − r²)² = 4 R² (x² + y²)`.
fn quartic<T: Real>([a, d]: [[T; 3]; 2], [radius, tube]: [T; 2]) -> [T; 5] {
    let two = T::ONE + T::ONE;
    let (four, eight) = (two * two, two * two * two);
    let (dd, ad) = (dot(d, d), dot(a, d));
    let square = radius * radius;
    let sum = dot(a, a) + square - tube * tube;
    let across = |v: [T; 3], w: [T; 3]| v[0] * w[0] + v[1] * w[1];
    [
        sum * sum - four * square * across(a, a),
        four * ad * sum - eight * square * across(a, d),
        two * dd * sum + four * ad * ad - four * square * across(d, d),
        four * ad * dd,
        dd * dd,
    ]
}

/// Adds the inputs and numbers of the test of a torus; returns the reason why it is missed, if it is.
/// `miss` says why a root within the ray is no hit.
pub(super) fn test(
    torus: &Torus,
    ray: &TestRay,
    numbers: &mut TestNumbers,
    miss: impl Fn(f64) -> String,
) -> String {
    let Torus { radius, tube } = *torus;
    numbers.input("R", [radius]);
    numbers.input("r of the tube", [tube]);
    let line = [ray.origin, ray.direction].map(|v| v.to_array());
    let double: [f64; 5] = quartic(line, [radius, tube]);
    let single: [f32; 5] = quartic(line.map(|v| v.map(|x| x as f32)), [radius, tube].map(|x| x as f32));
    let names = ["c₀", "c₁", "c₂", "c₃", "c₄ = (d·d)²"];
    for (name, (single, double)) in names.into_iter().zip(single.into_iter().zip(double)).rev() {
        numbers.number(name, single, double);
    }
    let meetings = torus.meetings(ray.origin, ray.direction);
    let meetings = ["t₁", "t₂", "t₃", "t₄"].into_iter().zip(meetings);
    let outcomes: Vec<String> = meetings
        .map(|(name, t)| {
            numbers.number(name, newton(single, t as f32), t);
            format!("{name}: {}", ray.range(t).map_or_else(|| miss(t), str::to_owned))
        })
        .collect();
    if outcomes.is_empty() { "no real root on the surface".to_owned() } else { outcomes.join("; ") }
}

/// The root near `t` in f32.
fn newton([c0, c1, c2, c3, c4]: [f32; 5], mut t: f32) -> f32 {
    for _ in 0..STEPS {
        let value = (((c4 * t + c3) * t + c2) * t + c1) * t + c0;
        let slope = ((4.0 * c4 * t + 3.0 * c3) * t + 2.0 * c2) * t + c1;
        t -= value / slope;
    }
    t
}
