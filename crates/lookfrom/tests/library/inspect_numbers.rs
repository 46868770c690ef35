//! The inspector's numbers, computed anew in f64 from the inputs that it prints: with them, a reader and a pocket
//! calculator can do the same.

use std::collections::BTreeSet;

use crate::support::{Compiled, own_scene};
use glam::{DMat3, DVec3, Vec3};
use lookfrom::inspect::{
    Candidate, Derivation, Inspection, LightReport, RayReport, Test, TestNumbers, inspect,
};
use lookfrom::render::SampleId;
use lookfrom_scene::settings::Integrator;

/// Scenes with triangles, spheres, instances, quadrics, tori, solids, disks, patches, curves, holes, glass that absorbs; each with an
/// integrator.
const SCENES: [(&str, Integrator); 11] = [
    ("notes-exercise.toml", Integrator::Raycast),
    ("hero.toml", Integrator::Whitted),
    ("hero.toml", Integrator::Path),
    ("instances.toml", Integrator::Whitted),
    ("cutouts.toml", Integrator::Whitted),
    ("glass-and-mirror.toml", Integrator::Whitted),
    ("../docs/guide/scenes/shape-cylinder.toml", Integrator::Whitted),
    ("../docs/guide/scenes/shape-disk.toml", Integrator::Path),
    ("../docs/guide/scenes/shape-patch.toml", Integrator::Path),
    ("../docs/guide/scenes/shape-torus.toml", Integrator::Whitted),
    ("../docs/guide/scenes/shape-solid.toml", Integrator::Whitted),
];

/// Every inspection of a grid over a small picture of each scene.
fn inspections() -> impl Iterator<Item = (String, Inspection)> {
    SCENES.into_iter().flat_map(|(name, integrator)| {
        let mut scene = own_scene(name);
        (scene.image.width, scene.image.height, scene.image.crop) = (36, 24, None);
        (scene.render.integrator, scene.render.samples) = (integrator, 2);
        let compiled = Compiled::new(scene);
        let renderer = compiled.renderer();
        let pixels = (0..24).step_by(2).flat_map(|y| (0..36).step_by(3).map(move |x| [x, y]));
        pixels
            .map(|pixel| {
                let at = format!("{name} {integrator:?} at {pixel:?}");
                (at, inspect(&renderer, SampleId { pixel, sample: 1 }))
            })
            .collect::<Vec<_>>()
    })
}

/// Asserts that a number is the expected one, but for rounding on a scale that it was computed on.
#[track_caller]
fn near(found: f64, expected: f64, scale: f64, what: &str) {
    let tolerance = 1e-11 * (scale.abs() + expected.abs());
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, expected {expected}");
}

/// Asserts that numbers in f32 agree.
#[track_caller]
fn single(found: impl Into<f64>, expected: impl Into<f64>, what: &str) {
    let (found, expected) = (found.into(), expected.into());
    let tolerance = 2e-6 * found.abs().max(expected.abs()) + 1e-12;
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, expected {expected}");
}

/// A vector among the inputs, by its name.
fn vector(test: &TestNumbers, name: &str) -> DVec3 {
    DVec3::from_slice(&find(test, name)[..3])
}

fn find<'a>(test: &'a TestNumbers, name: &str) -> &'a [f64] {
    let found = test.inputs.iter().find(|(known, _)| *known == name);
    &found.unwrap_or_else(|| panic!("no {name:?} in {test:?}")).1
}

fn has(test: &TestNumbers, name: &str) -> bool {
    test.inputs.iter().any(|(known, _)| *known == name)
}

/// A number in f64, if it is there.
fn number(test: &TestNumbers, name: &str) -> Option<f64> {
    test.numbers.iter().find(|(known, _)| *known == name).map(|(_, number)| number.f64)
}

/// Whether a number has this name and this value.
#[track_caller]
fn equals(test: &TestNumbers, name: &str, expected: f64, scale: f64, what: &str) {
    let found = number(test, name).unwrap_or_else(|| panic!("{what}: no {name:?} in {test:?}"));
    near(found, expected, scale, &format!("{what}: {name}"));
}

/// Cramer's rule.
fn triangle(test: &TestNumbers, a: DVec3, d: DVec3, what: &str) {
    let [p0, p1, p2] = ["P0", "P1", "P2"].map(|name| vector(test, name));
    let (e1, e2, r) = (p1 - p0, p2 - p0, a - p0);
    let det = |x, y, z| DMat3::from_cols(x, y, z).determinant();
    let size = |x: DVec3, y: DVec3, z: DVec3| x.length() * y.length() * z.length();
    equals(test, "D", det(e1, e2, -d), size(e1, e2, d), what);
    equals(test, "D1", det(r, e2, -d), size(r, e2, d), what);
    equals(test, "D2", det(e1, r, -d), size(e1, r, d), what);
    equals(test, "D3", det(e1, e2, r), size(e1, e2, r), what);
    let [d, d1, d2, d3] = ["D", "D1", "D2", "D3"].map(|name| number(test, name).expect("shown"));
    if d != 0.0 {
        equals(test, "β = D1/D", d1 / d, 0.0, what);
        equals(test, "γ = D2/D", d2 / d, 0.0, what);
        equals(test, "t = D3/D", d3 / d, 0.0, what);
        equals(test, "α", 1.0 - d1 / d - d2 / d, 1.0 + (d1 / d).abs() + (d2 / d).abs(), what);
    }
}

/// `A t² + 2 B t + C = 0`, around a centre.
fn quadratic(test: &TestNumbers, f: DVec3, d: DVec3, radius: f64, what: &str) {
    equals(test, "A", d.dot(d), 0.0, what);
    equals(test, "B", d.dot(f), d.length() * f.length(), what);
    equals(test, "C", f.dot(f) - radius * radius, f.dot(f) + radius * radius, what);
    let [a, b, c] = ["A", "B", "C"].map(|name| number(test, name).expect("shown"));
    equals(test, "B² − AC", b * b - a * c, b * b + (a * c).abs(), what);
    equals(test, "Δ (stable)", b * b - a * c, b * b + a * radius * radius + a * f.dot(f), what);
    let delta = number(test, "Δ (stable)").expect("shown");
    assert_eq!(number(test, "q").is_some(), delta >= 0.0, "{what}: no root, no row");
    if delta < 0.0 {
        return;
    }
    let q = if b < 0.0 { delta.sqrt() - b } else { -(b + delta.sqrt()) };
    equals(test, "q", q, 0.0, what);
    equals(test, "t₁ = q/A", q / a, 0.0, what);
    equals(test, "t₂ = C/q", c / q, 0.0, what);
}

/// A ray in the space of a primitive, which follows from the ray and the rows of the way there.
fn in_space(test: &TestNumbers, [a, d]: [DVec3; 2], space: &str, what: &str) -> (DVec3, DVec3) {
    let rows = [1, 2, 3].map(|row| vector(test, &format!("to the {space}, row {row}")));
    let there = |v: DVec3| DVec3::from_array(rows.map(|row| row.dot(v)));
    let at = vector(test, &format!("{space} at"));
    let [a_there, d_there] = ["a", "d"].map(|name| vector(test, &format!("{name} in the {space}")));
    let scale = rows.map(DVec3::length).iter().sum::<f64>() * (a.length() + at.length() + d.length());
    for k in 0..3 {
        near(a_there[k], there(a - at)[k], scale, what);
        near(d_there[k], there(d)[k], scale, what);
    }
    (a_there, d_there)
}

/// The light that arrives, or its density, by its derivation.
fn derivation(of: &Derivation, arrives: &[f32], pdf: f32, what: &str) {
    let operand = |name: &str| {
        let found = of.numbers.iter().find(|(known, _)| *known == name);
        found.unwrap_or_else(|| panic!("{what}: no {name} in {of:?}")).1.clone()
    };
    let one = |name: &str| operand(name)[0];
    let pi = std::f64::consts::PI;
    // Those of environments and pictures are in `inspect_lights.rs`.
    if !["L = I · fall-off", "pdf = P d²", "pdf = P / Ω", "pdf = 1 / (2π (1 − cos"]
        .iter()
        .any(|known| of.formula.starts_with(known))
    {
        return;
    }
    if of.formula.starts_with("L = I") {
        let distance = one("d");
        let law = of.formula.split("fall-off = ").nth(1).expect("a law").split(';').next();
        let mut share = match law {
            Some("1 / d²") => 1.0 / (distance * distance),
            Some("1 / d") => 1.0 / distance,
            _ => 1.0,
        };
        single(one("fall-off") as f32, share, what);
        if of.formula.contains("· S") {
            let bounds = operand("cos outer, inner");
            let x = ((one("cos to the axis") - bounds[0]) / (bounds[1] - bounds[0])).clamp(0.0, 1.0);
            assert!((one("S") - x * x * (3.0 - 2.0 * x)).abs() < 1e-4, "{what}: {of:?}");
            share *= one("S");
        }
        for (arrives, intensity) in arrives.iter().zip(operand("I")) {
            single(*arrives, intensity * share, what);
        }
    } else {
        let expected = match of.formula.as_str() {
            formula if formula.starts_with("pdf = P d²") => {
                one("P") * one("d").powi(2) / (one("A") * one("cos at the light"))
            }
            formula if formula.starts_with("pdf = P / Ω") => one("P") / one("Ω"),
            _ => {
                let sin2 = (one("R") / one("D")).powi(2);
                1.0 / (2.0 * pi * (sin2 / (1.0 + (1.0 - sin2).sqrt())))
            }
        };
        let off = (f64::from(pdf) - expected).abs();
        assert!(off <= 2e-5 * expected, "{what}: {pdf}, by its operands {expected}: {of:?}");
    }
}

/// The probability of a light, by its derivation.
fn choice(of: &Derivation, probability: f32, what: &str) {
    let all = |name: &'static str| of.numbers.iter().filter(move |(known, _)| *known == name);
    let one = |name: &'static str| all(name).next().map(|(_, values)| values[0]);
    let expected = match (one("power"), one("listed"), one("trees")) {
        (Some(power), ..) => power / one("sum").expect("the sum of all powers"),
        (_, Some(listed), Some(trees)) if of.formula.starts_with("P = 1") => 1.0 / (listed + trees),
        (_, Some(listed), Some(trees)) => {
            all("importances")
                .map(|(_, pair)| (pair[0] / (pair[0] + pair[1])).clamp(1.0 / 65536.0, 1.0 - 1.0 / 65536.0))
                .product::<f64>()
                * trees
                / (listed + trees)
        }
        _ => panic!("{what}: {of:?}"),
    };
    assert!((f64::from(probability) - expected).abs() <= 1e-4 * expected, "{what}: {probability}: {of:?}");
}

/// The quartic equation of a torus, by five of its values, and its roots by the distance from the torus.
fn torus(test: &TestNumbers, [a, d]: [DVec3; 2], [radius, tube]: [f64; 2], what: &str) {
    let coefficients = ["c₀", "c₁", "c₂", "c₃", "c₄ = (d·d)²"].map(|name| number(test, name).expect("shown"));
    let unit = radius / d.length();
    for t in [-2.0, -0.5, 0.0, 1.0, 3.0].map(|step| step * unit) {
        let p = a + t * d;
        let sum = p.length_squared() + radius * radius - tube * tube;
        let expected = sum * sum - 4.0 * radius * radius * p.truncate().length_squared();
        let terms: Vec<f64> = coefficients.iter().zip(0..).map(|(c, power)| c * t.powi(power)).collect();
        let scale = (a.length() + (t * d).length() + radius + tube).powi(4);
        near(terms.iter().sum(), expected, scale, what);
    }
    for t in ["t₁", "t₂", "t₃", "t₄"].iter().filter_map(|name| number(test, name)) {
        let p = a + t * d;
        let off = (p.truncate().length() - radius).hypot(p.z) - tube;
        assert!(off.abs() <= 1e-9 * (radius + tube), "{what}: t = {t} is off by {off}");
    }
}

/// The numbers of a candidate, from its inputs. Returns t where there is one hit with the plane.
fn candidate(candidate: &Candidate, ray: &RayReport, what: &str) {
    let what = &format!("{what}: {}", candidate.name);
    let test = candidate.test.numbers();
    let [mut a, mut d] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
    if has(test, "instance at") {
        let rows = ["to object, row 1", "to object, row 2", "to object, row 3"].map(|row| vector(test, row));
        let to_object = |v: DVec3| DVec3::from_array(rows.map(|row| row.dot(v)));
        let (at, far) = (vector(test, "instance at"), a);
        (a, d) = (to_object(a - at), to_object(d));
        let scale = rows.map(DVec3::length).iter().sum::<f64>() * (far.length() + at.length());
        for k in 0..3 {
            near(vector(test, "a in the object")[k], a[k], scale, what);
            near(vector(test, "d in the object")[k], d[k], scale, what);
        }
        (a, d) = (vector(test, "a in the object"), vector(test, "d in the object"));
    } else {
        assert_eq!((vector(test, "a"), vector(test, "d")), (a, d), "{what}");
    }
    match &candidate.test {
        Test::Triangle(_) => triangle(test, a, d, what),
        Test::Sphere(_) => quadratic(test, a - vector(test, "c"), d, find(test, "R")[0], what),
        Test::Quadric(_) if has(test, "r of the tube") => {
            let (a, d) = in_space(test, [a, d], "quadric", what);
            torus(test, [a, d], [find(test, "R")[0], find(test, "r of the tube")[0]], what);
        }
        Test::Quadric(_) if has(test, "size") => {
            let (a, d) = in_space(test, [a, d], "quadric", what);
            let t = -a.z / d.z;
            equals(test, "t = −a_z/d_z", t, 0.0, what);
            equals(test, "x at t", a.x + t * d.x, a.length() + (t * d).length(), what);
            equals(test, "y at t", a.y + t * d.y, a.length() + (t * d).length(), what);
        }
        Test::Quadric(_) => {
            let (a, d) = in_space(test, [a, d], "quadric", what);
            let [is_flat, is_round] = [has(test, "R of the hole"), number(test, "z at t₁").is_some()];
            if is_flat {
                equals(test, "t = (z − a_z)/d_z", (find(test, "z")[0] - a.z) / d.z, 0.0, what);
            } else if is_round {
                // The equation is that of a sphere, or of a cylinder: across the axis.
                let t = number(test, "t₁ = q/A").expect("shown");
                equals(test, "z at t₁", a.z + t * d.z, a.length() + (t * d).length(), what);
                let axes = [DVec3::ONE, DVec3::new(1.0, 1.0, 0.0)];
                let of = axes.into_iter().find(|axes| {
                    let found = number(test, "A").expect("shown");
                    (found - (d * *axes).length_squared()).abs() <= 1e-12 * found
                });
                let axes = of.unwrap_or_else(|| panic!("{what}: A is of neither"));
                quadratic(test, a * axes, d * axes, find(test, "R")[0], what);
            }
        }
        Test::Disk(_) => {
            let [c, u, v] = ["c", "u", "v"].map(|name| vector(test, name));
            let n = u.cross(v);
            equals(test, "N·(c − a)", n.dot(c - a), n.length() * (c - a).length(), what);
            equals(test, "N·d", n.dot(d), n.length() * d.length(), what);
            let t = number(test, "N·(c − a)").expect("shown") / number(test, "N·d").expect("shown");
            equals(test, "t", t, 0.0, what);
            let p = a + t * d - c;
            let scale = (a.length() + (t * d).length() + c.length()) / u.length().min(v.length());
            let (x, y) = (p.dot(u) / u.dot(u), p.dot(v) / v.dot(v));
            // These disks are round, so that their axes are perpendicular.
            near(u.dot(v), 0.0, u.length() * v.length(), what);
            equals(test, "x", x, scale, what);
            equals(test, "y", y, scale, what);
            equals(test, "x² + y²", x * x + y * y, scale * (x.abs() + y.abs()) + 1.0, what);
        }
        Test::Patch(_) => {
            let [p00, p10, p01, p11] = ["P00", "P10", "P01", "P11"].map(|name| vector(test, name));
            let c0 = (p00 - a).cross(d).dot(p01 - p00);
            let c2 = -(p10 - p00).cross(p11 - p01 - p10 + p00).dot(d);
            let c1 = (p10 - a).cross(d).dot(p11 - p10) - c0 - c2;
            let scale = 1e2 * (a.length() + p11.length()).powi(2) * d.length();
            equals(test, "a = (P00−a)×d·(P01−P00)", c0, scale, what);
            equals(test, "b = (P10−a)×d·(P11−P10)−a−c", c1, scale, what);
            equals(test, "c = −(P10−P00)×(P11−P01−P10+P00)·d", c2, scale, what);
            let discriminant = number(test, "b² − 4ac").expect("shown");
            let is_missed = candidate.verdict.starts_with("rejected");
            assert!(discriminant >= 0.0 || candidate.verdict.contains("no real root"), "{what}");
            assert!(!is_missed || candidate.verdict.contains("u₁") || discriminant < 0.0, "{what}");
            for [u, v, t] in [["u₁ = q/c", "v₁", "t₁"], ["u₂ = a/q", "v₂", "t₂"]] {
                let (Some(u), Some(v), Some(t)) = (number(test, u), number(test, v), number(test, t)) else {
                    continue;
                };
                if !(-0.1..1.1).contains(&u) || !(-0.1..1.1).contains(&v) {
                    continue;
                }
                // The root is a point of the patch, and of the ray.
                let on_patch = p00.lerp(p10, u).lerp(p01.lerp(p11, u), v);
                let off = (on_patch - (a + t * d)).length();
                assert!(off <= 1e-9 * (a.length() + p11.length()), "{what}: off by {off}");
            }
        }
        Test::Curve(_) => {
            if let (Some(distance), Some(half)) =
                (number(test, "|B − a − t d|"), number(test, "half the width"))
            {
                let (a, d) = in_space(test, [a, d], "curve", what);
                let p = ["P0", "P1", "P2", "P3"].map(|name| vector(test, name));
                let u = find(test, "u")[0];
                let v = 1.0 - u;
                let b = v * v * v * p[0] + 3.0 * v * v * u * p[1] + 3.0 * v * u * u * p[2] + u * u * u * p[3];
                let t = (b - a).dot(d) / d.dot(d);
                equals(test, "t", t, a.length() / d.length(), what);
                near(distance, (b - a).reject_from(d).length(), a.length() + b.length(), what);
                let width = find(test, "width from, to");
                let mut visible = v * width[0] + u * width[1];
                if has(test, "N at u = 0") {
                    // Spherical interpolation of unit vectors.
                    let [first, last] =
                        ["N at u = 0", "N at u = 1"].map(|name| vector(test, name).normalize());
                    let angle = first.dot(last).clamp(-1.0, 1.0).acos();
                    let n = match angle.sin() == 0.0 {
                        true => first,
                        false => ((v * angle).sin() * first + (u * angle).sin() * last) / angle.sin(),
                    };
                    visible *= n.dot(d.normalize()).abs();
                }
                assert!(
                    (half - 0.5 * visible).abs() <= 1e-7 * half.abs() + 1e-9,
                    "{what}: {half}, {visible}"
                );
                let is_hit = candidate.verdict.starts_with("hit");
                assert!(!is_hit || distance <= 1.001 * half, "{what}: {distance} is beyond {half}");
            }
        }
        test => panic!("{what}: {test:?}"),
    }
    for (name, number) in &test.numbers {
        assert!(!(number.f32.is_nan() && number.f64.is_nan()), "{what}: {name} is not a number");
    }
}

/// The hit, by the ray.
fn met(inspection: &Inspection, ray: &RayReport, what: &str) {
    let Some(met) = &ray.met else { return };
    let origin = DVec3::from_array(inspection.render_origin);
    let direction = Vec3::from_array(ray.direction).as_dvec3();
    let a = origin + Vec3::from_array(ray.origin).as_dvec3();
    assert_eq!(a.to_array(), ray.a, "{what}");
    let p = a + f64::from(met.t) * direction;
    let off = (p - DVec3::from_array(met.point)).length();
    // t has 24 bits, and a curve is met at its centre line.
    assert!(off <= 1e-6 * (a - origin).length().max((p - a).length()) + 1e-6, "{what}: off by {off}");
    let viewer = Vec3::from_array(met.wo);
    assert!(viewer.distance(-Vec3::from_array(ray.direction).normalize()) < 1e-6, "{what}");
    single(met.cos_viewer, Vec3::from_array(met.n).dot(viewer), what);
    if let Some(absorption) = &ray.absorption {
        single(absorption.length, direction.length() * f64::from(met.t), what);
        for lane in 0..absorption.sigma.len() {
            let depth = f64::from(absorption.sigma[lane])
                * f64::from(absorption.scale)
                * f64::from(absorption.length);
            single(absorption.transmittance[lane], (-depth).exp(), what);
            single(absorption.throughput[lane], ray.throughput[lane] * absorption.transmittance[lane], what);
        }
    }
}

/// One light of Whitted's formula.
fn light(light: &LightReport, ray: &RayReport, what: &str) {
    let Some(wi) = light.wi.map(Vec3::from_array) else { return };
    let met = ray.met.as_ref().expect("a hit");
    let k = met.coefficients.as_ref().expect("Whitted's coefficients");
    let n = Vec3::from_array(met.n);
    let viewer = Vec3::from_array(met.wo);
    let h = (wi + viewer).normalize();
    let n_dot_l = light.n_dot_l.expect("shown");
    single(n_dot_l, n.dot(wi), what);
    single(light.n_dot_h.expect("shown"), n.dot(h), what);
    for of in &light.derivations {
        derivation(of, &light.arrives.lanes, light.pdf.expect("shown"), what);
    }
    let share = ray.throughput_there.as_ref().unwrap_or(&ray.throughput);
    let n_dot_h = f64::from(light.n_dot_h.expect("shown"));
    for lane in 0..share.len() {
        single(light.diffuse[lane], k.diffuse[lane] * n_dot_l.max(0.0), what);
        let highlight = f64::from(k.specular[lane]) * n_dot_h.max(0.0).powf(f64::from(k.shininess));
        // A large power magnifies the rounding of N·H.
        let tolerance = (1e-4 + 1e-6 * f64::from(k.shininess)) * highlight + 1e-12;
        assert!((f64::from(light.specular[lane]) - highlight).abs() <= tolerance, "{what}: {light:?}");
        let pdf = light.pdf.expect("shown");
        single(light.intensity.lanes[lane], light.arrives.lanes[lane] / (std::f32::consts::PI * pdf), what);
        let Some(shadow) = &light.shadow else { continue };
        let through: f32 = shadow.blockers.iter().map(|blocker| blocker.passed[lane]).product();
        let rest = shadow.rest.as_ref().map_or(0.0, |rest| rest[lane]);
        let terms = light.diffuse[lane] + light.specular[lane];
        single(
            light.added.lanes[lane],
            share[lane] * terms * light.intensity.lanes[lane] * through * rest,
            what,
        );
    }
}

/// Fresnel's equations for a dielectric, by the cosines on both sides; η is the index there over here.
fn fresnel(cos_here: f64, cos_there: f64, eta: f64) -> f64 {
    let parallel = (eta * cos_here - cos_there) / (eta * cos_here + cos_there);
    let perpendicular = (cos_here - eta * cos_there) / (cos_here + eta * cos_there);
    (parallel * parallel + perpendicular * perpendicular) / 2.0
}

/// The branches of Whitted's tree.
fn branches(inspection: &Inspection, ray: &RayReport, what: &str) {
    let Some(met) = &ray.met else { return };
    for branch in &ray.branches {
        let cos = f64::from(met.cos_viewer);
        let direction = Vec3::from_array(branch.direction);
        if let Some(eta) = branch.eta.map(f64::from) {
            let sin = |cos: f64| (1.0 - cos * cos).max(0.0).sqrt();
            let there = f64::from(branch.cos);
            assert!((sin(cos) - eta * sin(there)).abs() < 1e-3, "{what}: Snell's law: {branch:?}");
            if let Some(reflectance) = branch.fresnel {
                let expected = fresnel(cos, there, eta);
                assert!((f64::from(reflectance) - expected).abs() < 1e-4, "{what}: Fresnel: {branch:?}");
            }
        } else {
            single(branch.cos, met.cos_viewer, what);
        }
        let share = ray.throughput_there.as_ref().unwrap_or(&ray.throughput);
        match inspection.ray(branch.address) {
            Some(child) => {
                assert_eq!(branch.cut, None, "{what}");
                assert_eq!((child.parent, child.kind), (Some(ray.address), branch.kind), "{what}");
                // An interpolated normal may send a ray to the wrong side: then it is reflected at the tangent plane.
                let ng = DVec3::from_array(met.ng).as_vec3();
                let followed = Vec3::from_array(child.direction);
                let turned = direction - 2.0 * ng * ng.dot(direction);
                assert!(followed == direction || followed.distance(turned) < 1e-5, "{what}: {branch:?}");
                for (lane, share) in share.iter().enumerate() {
                    single(child.throughput[lane], share * branch.weight[lane], what);
                }
            }
            None => assert!(branch.cut.is_some(), "{what}: {branch:?}"),
        }
    }
}

#[test]
fn every_number_follows_from_what_is_printed() {
    let mut told: BTreeSet<String> = BTreeSet::new();
    for (at, inspection) in inspections() {
        for ray in &inspection.rays {
            let what = format!("{at}, ray {}", ray.address);
            if let Some(sampled) = &ray.light_sample {
                let of = sampled.choice.first().unwrap_or_else(|| panic!("{what}: {sampled:?}"));
                choice(of, sampled.probability, &what);
                told.insert("choice".to_owned());
                for (sample, of) in sampled
                    .sample
                    .iter()
                    .flat_map(|sample| sample.derivations.iter().map(move |of| (sample, of)))
                {
                    derivation(of, &sample.arrives.lanes, sample.light_pdf, &what);
                    told.insert(of.formula[..9].to_owned());
                }
            }
            for of_ray in &ray.candidates {
                candidate(of_ray, ray, &what);
                let is_torus = of_ray.name.starts_with("torus") && of_ray.is_nearest;
                told.extend(is_torus.then(|| "Torus met".to_owned()));
                let kind = format!("{:?}", of_ray.test);
                let kind = kind.split('(').next().expect("a name");
                told.extend(of_ray.verdict.contains("cut away").then(|| "cut away".to_owned()));
                told.insert(format!("{kind}{}", if of_ray.is_nearest { " met" } else { "" }));
                told.extend(has(of_ray.test.numbers(), "instance at").then(|| "Instance".to_owned()));
            }
            // A primitive may be tested twice; every one is told.
            let tests = ray.traversal.tests as usize;
            assert!(tests >= ray.candidates.len() && (tests == 0) == ray.candidates.is_empty(), "{what}");
            assert!(ray.traversal.nodes > 0, "{what}");
            met(&inspection, ray, &what);
            ray.lights.iter().for_each(|of_ray| light(of_ray, ray, &what));
            branches(&inspection, ray, &what);
            told.insert(ray.kind.to_string());
            told.extend(ray.absorption.as_ref().map(|_| "absorbs".to_owned()));
            let blockers = ray.lights.iter().filter_map(|light| light.shadow.as_ref());
            let passes = |shadow: &lookfrom::inspect::ShadowReport| {
                shadow.rest.is_some() && !shadow.blockers.is_empty()
            };
            told.extend(blockers.into_iter().any(passes).then(|| "through".to_owned()));
        }
    }
    for expected in [
        "Triangle met",
        "Sphere met",
        "Quadric met",
        "Torus met",
        "cut away",
        "Disk met",
        "Patch met",
        "Curve met",
        "Instance",
        "straight on",
        "absorbs",
        "reflected",
        "refracted",
        "transmitted",
        "through",
        "choice",
        "pdf = P d",
    ] {
        assert!(told.contains(expected), "{expected:?} is not in {told:?}");
    }
}

/// A ribbon, a bilinear patch, a sphere and lights of all kinds that no scene of the repository has together.
const ODD: &str = r#"
LookAt 0 1 -6  0 1 0  0 1 0
Camera "perspective" "float fov" 50
Film "rgb" "integer xresolution" 36 "integer yresolution" 24 "string filename" "odd.exr"
Integrator "path" "string lightsampler" "bvh"
WorldBegin
LightSource "spot" "point3 from" [ 0 5 -2 ] "point3 to" [ 0 0 0 ] "float coneangle" 60 "float conedeltaangle" 30
LightSource "point" "point3 from" [ 3 4 -4 ] "rgb I" [ 9 8 7 ]
LightSource "distant" "rgb L" [ 1 1 1 ]
AttributeBegin
    AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
    Translate -3 3 0
    Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
    AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
    Shape "trianglemesh" "point3 P" [ 3 0 0  3 3 0  4 1 -2 ] "integer indices" [ 0 1 2 ]
AttributeEnd
AttributeBegin
    Rotate 20 1 2 3
    Shape "curve" "string type" "ribbon" "point3 P" [ -1 0 0  -0.5 1 0  0 1 0.5  1 2 0 ] "normal N" [ 0 0 -1  1 0 -1 ] "float width" 0.6
    Shape "cylinder" "float radius" 0.4 "float zmin" -1 "float zmax" 1 "float phimax" 200
AttributeEnd
Shape "bilinearmesh" "point3 P" [ -4 -1 -4  4 -1 -4  -4 -1 4  4 -0.5 4 ]
"#;

#[test]
fn so_do_those_of_ribbons_spots_and_solid_angles() {
    let mut told: BTreeSet<String> = BTreeSet::new();
    let options = lookfrom::session::Options { samples: Some(4), ..Default::default() };
    let session = lookfrom::session::Session::from_bytes("odd.pbrt", ODD.into(), &options).expect("a scene");
    for (x, y) in (0..24).flat_map(|y| (0..36).map(move |x| (x, y))) {
        let inspection = inspect(session.renderer(), SampleId { pixel: [x, y], sample: (x + y) % 4 });
        for ray in &inspection.rays {
            let what = format!("at {x} {y}, ray {}", ray.address);
            for of_ray in &ray.candidates {
                candidate(of_ray, ray, &what);
                let is_torus = of_ray.name.starts_with("torus") && of_ray.is_nearest;
                told.extend(is_torus.then(|| "Torus met".to_owned()));
                let test = of_ray.test.numbers();
                told.extend(has(test, "N at u = 0").then(|| format!("ribbon {}", of_ray.is_nearest)));
                let reasons = of_ray.verdict.strip_prefix("rejected: ").into_iter();
                reasons.for_each(|reason| {
                    assert!(!reason.contains("outside of the primitive"), "{what}: {reason}");
                });
            }
            let Some(sampled) = &ray.light_sample else { continue };
            choice(sampled.choice.first().expect("a derivation"), sampled.probability, &what);
            let Some(sample) = &sampled.sample else { continue };
            for of in &sample.derivations {
                derivation(of, &sample.arrives.lanes, sample.light_pdf, &what);
                told.insert(of.formula.chars().take(22).collect());
                let is_spot = of.formula.contains("· S;");
                told.extend(is_spot.then(|| "spot".to_owned()));
            }
        }
    }
    for expected in [
        "ribbon true",
        "ribbon false",
        "L = I · fall-off(d); f",
        "spot",
        "pdf = P / Ω: a directi",
        "pdf = 1 / (2π (1 − cos",
    ] {
        assert!(told.contains(expected), "{expected:?} is not in {told:?}");
    }
}
