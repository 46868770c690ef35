//! Bilinear patches (Reshetov 2019): u is a root of `a + b u + c u² = 0`, then v and t are those of the point of the line
//! of constant u that is nearest to the ray.

use glam::DVec3;
use lookfrom_bvh::reference::Real;

use super::disk::{cross, dot, subtract};
use super::{TestNumbers, TestRay};

/// The numbers of the test.
struct PatchTest<T> {
    /// `(P00 − a)×d · (P01 − P00)`.
    a: T,
    /// The rest of `(P10 − a)×d · (P11 − P10)`.
    b: T,
    /// `(P10 − P00)×E · (−d)` with `E = P11 − P01 − (P10 − P00)`.
    c: T,
    /// `b² − 4 a c`.
    discriminant: T,
    /// u, v, t of both roots.
    roots: [[T; 3]; 2],
}

fn patch_test<T: Real>([o, d, p00, p10, p01, p11]: [[T; 3]; 6]) -> PatchTest<T> {
    let (along_u, along_v) = (subtract(p10, p00), subtract(p01, p00));
    let twist = subtract(subtract(p11, p01), along_u);
    let start = subtract(p00, o);
    let a = dot(cross(start, d), along_v);
    let c = dot(cross(along_u, twist), d.map(|x| -x));
    let whole = dot(cross(subtract(p10, o), d), subtract(p11, p10));
    let b = whole - a - c;
    let two = T::ONE + T::ONE;
    let discriminant = b * b - two * two * a * c;
    let root = discriminant.square_root();
    let q = if b < T::ZERO { root - b } else { -(b + root) } / two;
    let roots = [q / c, a / q].map(|u| {
        let line: [T; 3] = std::array::from_fn(|k| along_v[k] + u * twist[k]);
        let from: [T; 3] = std::array::from_fn(|k| start[k] + u * along_u[k]);
        let across = cross(d, line);
        let size = dot(across, across);
        [u, dot(cross(across, from), d) / size, dot(cross(across, from), line) / size]
    });
    PatchTest { a, b, c, discriminant, roots }
}

/// Adds the inputs and numbers of the test of a patch; returns the reason why it is missed, if it is.
pub(super) fn test(corners: [DVec3; 4], ray: &TestRay, numbers: &mut TestNumbers) -> Option<String> {
    let [p00, p10, p01, p11] = corners.map(|corner| corner.to_array());
    let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
    let f64 = patch_test([o, d, p00, p10, p01, p11]);
    let f32 = patch_test([o, d, p00, p10, p01, p11].map(|v| v.map(|x| x as f32)));
    numbers.input("P00", p00);
    numbers.input("P10", p10);
    numbers.input("P01", p01);
    numbers.input("P11", p11);
    numbers.number("a = (P00−a)×d·(P01−P00)", f32.a, f64.a);
    numbers.number("b = (P10−a)×d·(P11−P10)−a−c", f32.b, f64.b);
    numbers.number("c = −(P10−P00)×(P11−P01−P10+P00)·d", f32.c, f64.c);
    numbers.number("b² − 4ac", f32.discriminant, f64.discriminant);
    let names = [["u₁ = q/c", "v₁", "t₁"], ["u₂ = a/q", "v₂", "t₂"]];
    for (names, (single, double)) in names.into_iter().zip(f32.roots.into_iter().zip(f64.roots)) {
        for (name, (single, double)) in names.into_iter().zip(single.into_iter().zip(double)) {
            numbers.number(name, single, double);
        }
    }
    if f64.discriminant < 0.0 {
        return Some("b² − 4ac < 0: no real root".to_owned());
    }
    let why = |(name, [u, v, t]): (&str, [f64; 3])| {
        let part = 0.0..=1.0;
        let outside = if !part.contains(&u) {
            "u is not between 0 and 1"
        } else if !part.contains(&v) {
            "v is not between 0 and 1"
        } else {
            ray.range(t).unwrap_or("it is not hit")
        };
        format!("{name}: {outside}")
    };
    let both: Vec<String> = ["u₁", "u₂"].into_iter().zip(f64.roots).map(why).collect();
    Some(both.join("; "))
}
