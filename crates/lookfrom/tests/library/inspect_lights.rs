//! The densities, radiances and choices of lights, computed anew in f64 from the operands that the inspector prints.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::path::Path;

use crate::support::Compiled;
use glam::DVec3;
use lookfrom::inspect::{Derivation, FoundReport, Inspection, inspect};
use lookfrom::render::SampleId;
use lookfrom_scene::settings::ColorMode;
use lookfrom_scene::{LoadContext, Memory, Scene, image};

/// A floor, a ball, and what lights them.
const OWN: &str = r#"
[camera]
lookfrom = [0, 1.5, -5]
lookat = [0, 0.5, 0]
fov = 50
[image]
width = 24
height = 16
[materials.metal]
type = "conductor"
metal = "copper"
roughness = 0.3
[[plane]]
size = 40
[[sphere]]
center = [0.3, 0.8, 0.2]
radius = 0.8
material = "metal"
"#;

/// The same for pbrt.
const PBRT: &str = r#"
LookAt 0 1.5 -5  0 0.5 0  0 1 0
Camera "perspective" "float fov" 50
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "string filename" "a.exr"
WorldBegin
Shape "bilinearmesh" "point3 P" [ -9 0 -9  9 0 -9  -9 0 9  9 0 9 ]
AttributeBegin
    Translate 0.3 0.8 0.2
    Shape "sphere" "float radius" 0.8
AttributeEnd
"#;

/// A map with a sun, of numbers that look like noise.
fn map(width: usize, height: usize) -> Vec<u8> {
    let number = |k: usize| ((k * 7919 + 13) % 251) as f32 / 251.0;
    let sun = height / 3 * width + width / 4;
    let texel = |k: usize| if k == sun { [90.0; 3] } else { [3 * k, 3 * k + 1, 3 * k + 2].map(number) };
    let texels: Vec<[f32; 3]> = (0..width * height).map(texel).collect();
    image::encode_pfm(width as u32, height as u32, &texels).expect("a picture")
}

fn read(name: &str, text: &str) -> Scene {
    let files = [("map.pfm", map(32, 16)), ("square.pfm", map(16, 16)), (name, text.into())];
    let files = Memory(files.map(|(name, bytes)| (name.into(), bytes)).into());
    lookfrom_scene::load::scene(Path::new(name), &mut LoadContext::new(&files)).expect("a scene")
}

/// Every inspection of a picture.
fn inspections(name: &str, text: &str) -> Vec<Inspection> {
    let mut scene = read(name, text);
    scene.render.color = ColorMode::Rgb;
    let compiled = Compiled::new(scene);
    let renderer = compiled.renderer();
    let pixels = (0..16).flat_map(|y| (0..24).map(move |x| [x, y]));
    pixels.map(|[x, y]| inspect(&renderer, SampleId { pixel: [x, y], sample: (x + y) % 4 })).collect()
}

fn all<'a>(of: &'a Derivation, name: &str) -> &'a [f64] {
    let found = of.numbers.iter().find(|(known, _)| *known == name);
    &found.unwrap_or_else(|| panic!("no {name:?} in {of:#?}")).1
}

fn one(of: &Derivation, name: &str) -> f64 {
    all(of, name)[0]
}

fn vector(of: &Derivation, name: &str) -> DVec3 {
    DVec3::from_slice(all(of, name))
}

/// Asserts that two numbers agree, but for rounding to f32.
#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64, of: &Derivation) {
    let off = (found - expected).abs();
    assert!(
        off <= tolerance * expected.abs().max(found.abs()),
        "{found}, by its operands {expected}: {of:#?}"
    );
}

/// Asserts that an index is that of a place in a row of cells; `wi` has 24 bits.
#[track_caller]
fn index(found: f64, place: f64, count: f64, of: &Derivation) {
    let x = place * count;
    assert!(x >= found - 2e-3 && x <= found + 1.0 + 2e-3, "{found} of {count}, by its operands {x}: {of:#?}");
}

/// (u, v) of a direction in an equal-area octahedral square.
fn octahedral(d: DVec3) -> [f64; 2] {
    let r = (1.0 - d.z.abs()).max(0.0).sqrt();
    let q = r * d.y.abs().atan2(d.x.abs()) * 2.0 / PI;
    let [u, v] = if d.z >= 0.0 { [r - q, q] } else { [1.0 - q, 1.0 - r + q] };
    [0.5 * (1.0 + u.copysign(d.x)), 0.5 * (1.0 + v.copysign(d.y))]
}

/// (u, v) of a direction in an equirectangular map.
fn equirectangular(d: DVec3) -> [f64; 2] {
    [0.5 + d.x.atan2(-d.z) / (2.0 * PI), d.y.clamp(-1.0, 1.0).acos() / PI]
}

/// What a sample of a light reports.
struct Sample<'a> {
    wi: DVec3,
    arrives: &'a [f32],
    pdf: f64,
}

/// A direction in a light's space, which follows from the sample's.
fn in_space(of: &Derivation, direction: DVec3) -> DVec3 {
    let rows = ["M, row 1", "M, row 2", "M, row 3"].map(|name| vector(of, name));
    let expected = DVec3::from_array(rows.map(|row| row.dot(direction))).normalize();
    let found = vector(of, "(x, y, z)");
    assert!(found.distance(expected) < 2e-6, "{found}, by its operands {expected}: {of:#?}");
    found
}

/// Every line of a sample's derivations.
fn check(derivations: &[Derivation], sample: &Sample<'_>, told: &mut BTreeSet<String>) {
    let Sample { wi, arrives, pdf } = *sample;
    let light = |of: &Derivation, expected: [f64; 3]| {
        for (arrives, expected) in arrives.iter().zip(expected) {
            near(f64::from(*arrives), expected, 2e-4, of);
        }
    };
    let rgb = |of: &Derivation, name: &str| <[f64; 3]>::from(vector(of, name));
    let product = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|c| (a[c] * b[c]).max(0.0));
    let mut direction = DVec3::ZERO;
    for of in derivations {
        let formula = of.formula.as_str();
        let [columns, rows] = match of.numbers.iter().find(|(name, _)| *name == "columns, rows") {
            Some((_, size)) => [size[0], size[1]],
            None => [0.0; 2],
        };
        if formula.starts_with("texel (i, j) of the map") {
            direction = in_space(of, wi);
            let is_octahedral = formula.contains("octahedral") || formula.contains("½ (1 ± U)");
            let [u, v] = if is_octahedral { octahedral(direction) } else { equirectangular(direction) };
            index(all(of, "i, j")[0], u, columns, of);
            index(all(of, "i, j")[1], v, rows, of);
        } else if formula.starts_with("pdf = P(j) P(i)") {
            let probability = one(of, "P(j)") * one(of, "P(i)");
            let jacobian = match formula.contains("sin θ)") {
                true => {
                    let sin = one(of, "sin θ");
                    assert!((sin - direction.x.hypot(direction.z)).abs() < 1e-4, "{of:#?}");
                    2.0 * PI * PI * sin
                }
                false => 4.0 * PI,
            };
            near(pdf, probability * columns * rows / jacobian, 2e-5, of);
            let mean = if formula.contains("max(B − mean, 0)") { one(of, "mean") } else { 0.0 };
            let sine = if formula.contains("sin θ_j,") { one(of, "sin θ_j") } else { 1.0 };
            near(one(of, "W"), (one(of, "B") - mean).max(0.0) * sine, 1e-5, of);
            let expected = one(of, "W") / one(of, "ΣW");
            assert!((probability - expected).abs() <= 2e-5 * expected + 1e-9, "{expected}: {of:#?}");
        } else if formula.starts_with("pdf = cos / π") {
            near(one(of, "cos"), vector(of, "N").dot(wi), 1e-4, of);
            near(pdf, one(of, "cos") / PI, 1e-5, of);
        } else if formula.starts_with("L = scale · ((1−f)") {
            let [f, g] = [all(of, "f, g")[0], all(of, "f, g")[1]];
            let corners = ["T00", "T10", "T01", "T11"].map(|name| vector(of, name));
            let mixed = corners[0].lerp(corners[1], f).lerp(corners[2].lerp(corners[3], f), g);
            light(of, product(rgb(of, "scale"), mixed.into()));
        } else if formula.starts_with("L = scale · texel") {
            light(of, product(rgb(of, "scale"), rgb(of, "texel")));
        } else if formula.starts_with("L = (1 − |y|)") {
            let y = one(of, "y");
            near(y, wi.y, 1e-5, of);
            let end = if y >= 0.0 { rgb(of, "zenith") } else { rgb(of, "nadir") };
            let horizon = rgb(of, "horizon");
            light(of, std::array::from_fn(|c| (1.0 - y.abs()) * horizon[c] + y.abs() * end[c]));
        } else if formula.starts_with("cell (i, j) of the square") {
            let [x, y, z] = ["X", "Y", "Z"].map(|name| vector(of, name).dot(wi));
            let to = [x / z, y / z];
            for axis in 0..2 {
                let at = 0.5 + to[axis].atan() / PI;
                near(all(of, "x, y")[axis], to[axis], 1e-4, of);
                near(all(of, "u, v")[axis], at, 1e-5, of);
                index(all(of, "i, j")[axis], at, [columns, rows][axis], of);
            }
        } else if formula.starts_with("pdf = W / ΣW · columns rows / J") {
            let cell = &derivations[0];
            let size = all(cell, "columns, rows");
            let [x2, y2] = [0, 1].map(|axis| all(cell, "x, y")[axis].powi(2));
            let j = PI * PI * (1.0 + x2) * (1.0 + y2) / (1.0 + x2 + y2).powf(1.5);
            near(one(of, "J"), j, 1e-5, of);
            near(one(of, "W"), one(of, "B") * one(of, "ω"), 1e-9, of);
            near(pdf, one(of, "W") / one(of, "ΣW") * size[0] * size[1] / j, 2e-5, of);
            let axes = ["X", "Y", "Z"].map(|name| vector(cell, name));
            for (corner, end) in [("first corner − p", "window from"), ("across − p", "window to")] {
                let [x, y, z] = axes.map(|axis| axis.dot(vector(of, corner)));
                near(all(of, end)[0], 0.5 + (x / z).atan() / PI, 1e-9, of);
                near(all(of, end)[1], 0.5 + (y / z).atan() / PI, 1e-9, of);
            }
        } else if formula.starts_with("(x, y, z) = M (−wi)") {
            direction = in_space(of, -wi);
        } else if formula.starts_with("L = I / d², I = scale") {
            let half = all(of, "half size at z = 1");
            index(all(of, "i, j")[0], 0.5 * (1.0 + direction.x / (half[0] * direction.z)), columns, of);
            index(all(of, "i, j")[1], 0.5 * (1.0 - direction.y / (half[1] * direction.z)), rows, of);
            let factor = one(of, "scale") / one(of, "d").powi(2);
            light(of, rgb(of, "texel").map(|channel| factor * channel));
        } else if formula.starts_with("L = I / d², I = I₀") {
            let [u, v] = octahedral(direction);
            index(all(of, "i, j")[0], u, columns, of);
            index(all(of, "i, j")[1], v, rows, of);
            let mean = rgb(of, "texel").iter().sum::<f64>() / 3.0;
            let factor = mean / one(of, "d").powi(2);
            light(of, rgb(of, "I₀").map(|intensity| factor * intensity));
        } else if formula.starts_with("pdf = P s d²") {
            let [u, v] = [all(of, "u, v")[0], all(of, "u, v")[1]];
            let corners = all(of, "J00, J10, J01, J11");
            let mixed = (1.0 - v) * ((1.0 - u) * corners[0] + u * corners[1])
                + v * ((1.0 - u) * corners[2] + u * corners[3]);
            let share = 4.0 * mixed / corners.iter().sum::<f64>();
            let cos = vector(of, "n at the light").dot(wi).abs();
            near(one(of, "cos at the light"), cos, 1e-6, of);
            let expected = one(of, "P") * share * one(of, "d").powi(2) / (one(of, "J") * cos);
            near(pdf, expected, 2e-4, of);
        } else if formula.starts_with("pdf = P / Ω") {
            let [a, b, c] = ["a − p", "b − p", "c − p"].map(|name| vector(of, name).normalize());
            let tan = a.dot(b.cross(c)).abs() / (1.0 + a.dot(b) + b.dot(c) + c.dot(a));
            let angle = 2.0 * tan.atan().rem_euclid(PI);
            near(one(of, "Ω"), angle, 1e-4, of);
            near(pdf, one(of, "P") / one(of, "Ω"), 2e-5, of);
        } else if formula.starts_with("pdf = P d²") {
            if formula.contains("triangle") {
                let [a, b, c] = ["a − p", "b − p", "c − p"].map(|name| vector(of, name));
                near(one(of, "A"), 0.5 * (b - a).cross(c - a).length(), 1e-6, of);
            }
            let expected = one(of, "P") * one(of, "d").powi(2) / (one(of, "A") * one(of, "cos at the light"));
            near(pdf, expected, 2e-5, of);
        } else if formula.starts_with("pdf = 1 / (2π (1 − cos θ))") {
            let sin = one(of, "R") / one(of, "D");
            near(pdf, (1.0 + (1.0 - sin * sin).sqrt()) / (2.0 * PI * sin * sin), 2e-5, of);
        } else if formula.starts_with("L = s C") {
            emission(of, arrives);
        } else {
            continue;
        }
        told.insert(formula.chars().take(40).collect());
    }
}

/// A light's probability, and the operands of that.
fn choice(all_of_it: &[Derivation], probability: f64, told: &mut BTreeSet<String>) {
    let [of, operands @ ..] = all_of_it else { panic!("no derivation") };
    let ways: Vec<&[f64]> =
        of.numbers.iter().filter(|(name, _)| *name == "importances").map(|(_, pair)| &pair[..]).collect();
    let expected = if of.formula.starts_with("P = power") {
        one(of, "power") / one(of, "sum")
    } else if of.formula.starts_with("P = 1 / (listed") {
        1.0 / (one(of, "listed") + one(of, "trees"))
    } else {
        let share = |pair: &&[f64]| match pair {
            [_, 0.0] => 1.0,
            [chosen, other] => (chosen / (chosen + other)).clamp(1.0 / 65536.0, 1.0 - 1.0 / 65536.0),
            _ => panic!("{of:#?}"),
        };
        let product: f64 = ways.iter().map(share).product();
        product * one(of, "trees") / (one(of, "listed") + one(of, "trees"))
    };
    near(probability, expected, 1e-6, of);
    let (children, powers): (Vec<&Derivation>, Vec<&Derivation>) =
        operands.iter().partition(|operand| operand.formula.starts_with("importance = "));
    // The children of each node on the way, the chosen one first; whose lights are those below.
    assert_eq!(children.len(), 2 * ways.len(), "{of:#?}");
    for (pair, node) in ways.iter().zip(children.chunks(2)) {
        node.iter().for_each(|child| importance(child));
        assert_eq!(pair[..], [one(node[0], "importance"), one(node[1], "importance")], "{of:#?}");
    }
    for nodes in children.chunks(2).collect::<Vec<_>>().windows(2) {
        let below: f64 = nodes[1].iter().map(|child| one(child, "Φ")).sum();
        near(one(nodes[0][0], "Φ"), below, 1e-6, nodes[0][0]);
    }
    let is_chosen_by_power = of.formula.starts_with("P = power") || !ways.is_empty();
    assert_eq!(powers.len(), usize::from(is_chosen_by_power), "{all_of_it:#?}");
    for of_light in &powers {
        power(of_light);
        let chosen = children.iter().rev().nth(1).map_or_else(|| one(of, "power"), |leaf| one(leaf, "Φ"));
        near(chosen, one(of_light, "power"), 1e-12, of_light);
    }
    told.extend(all_of_it.iter().map(|of| of.formula.chars().take(40).collect::<String>()));
}

/// The importance of a child of the light tree: angles are cosine and sine.
fn importance(of: &Derivation) {
    let close = |name: &str, found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-6, "{name} = {found}, by its operands {expected}: {of:#?}");
    };
    let (to, r) = (vector(of, "p − c"), one(of, "r"));
    near(one(of, "d²"), to.length_squared(), 1e-6, of);
    let by_distance = one(of, "Φ") / one(of, "d²").max(r);
    if of.formula.starts_with("importance = Φ / max") {
        assert!(!(1e-36..1e36).contains(&one(of, "d²")), "{of:#?}");
        return near(one(of, "importance"), by_distance.clamp(1e-30, 1e30), 1e-6, of);
    }
    let angle = |name: &str| {
        let [cos, sin] = all(of, &format!("cos, sin {name}"))[..] else { panic!("{of:#?}") };
        close(name, cos * cos + sin * sin, 1.0);
        [cos, sin]
    };
    let [axis, normals, of_box, at_surface] = ["θ_w", "θ_o", "θ_b", "θ_i"].map(angle);
    let (w, d) = (to.normalize(), one(of, "d²").sqrt());
    let cos_axis = vector(of, "a").dot(w);
    close("cos θ_w", axis[0], if one(of, "two-sided") == 1.0 { cos_axis.abs() } else { cos_axis });
    close("cos θ_i", at_surface[0], vector(of, "N").dot(w).abs());
    match d > r {
        true => close("sin θ_b", of_box[1], r / d),
        false => assert_eq!(of_box, [-1.0, 0.0], "{of:#?}"),
    }
    let less = |[cos_a, sin_a]: [f64; 2], [cos_b, sin_b]: [f64; 2]| match cos_a > cos_b {
        true => [1.0, 0.0],
        false => [cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b],
    };
    let [least, incident] = ["cos θ'", "cos θᵢ'"].map(|name| one(of, name));
    close("cos θ'", least, less(less(axis, normals), of_box)[0]);
    close("cos θᵢ'", incident, less(at_surface, of_box)[0]);
    let is_lit = least > one(of, "cos θ_e");
    let directed = (by_distance * least * incident).clamp(1e-30, 1e30);
    near(one(of, "importance"), if is_lit { directed } else { 0.0 }, 1e-6, of);
}

/// The power of a light.
fn power(of: &Derivation) {
    let b = one(of, "B");
    let formula = of.formula.strip_prefix("power = ").and_then(|formula| formula.split(" / M").next());
    let whole = match formula {
        Some("B") => b,
        Some("4π B") => 4.0 * PI * b,
        Some("π A B") => PI * one(of, "A") * b,
        Some("π R² B") => PI * one(of, "R").powi(2) * b,
        Some("4π² R² B") => (2.0 * PI * one(of, "R")).powi(2) * b,
        _ => panic!("{of:#?}"),
    };
    near(one(of, "power"), (whole / one(of, "M")).max(1e-30), 1e-6, of);
    if of.formula.contains("B = s · the largest channel of C") {
        near(b, one(of, "s") * vector(of, "C").max_element(), 1e-6, of);
    }
}

/// The radiance of an area light.
fn emission(of: &Derivation, radiance: &[f32]) {
    let (s, color) = (one(of, "s"), vector(of, "C"));
    let is_filtered = of.formula.starts_with("L = s C T");
    let through = if is_filtered { one(of, "T") } else { 1.0 };
    for (lane, color) in radiance.iter().zip(color.to_array()) {
        near(f64::from(*lane), s * color * through, 1e-6, of);
    }
    let luminance = |color: DVec3| color.dot(DVec3::new(0.2126, 0.7152, 0.0722));
    if of.formula.contains("s = k") {
        let (k, y) = (one(of, "k"), one(of, "Y"));
        let whole = match of.formula.contains("s = k Φ / (n π A Y)") {
            true => one(of, "Φ") / (one(of, "n") * PI * one(of, "A")),
            false => 1.0,
        };
        near(s, k * whole / y, 1e-6, of);
        if !of.formula.contains("texture") {
            near(y, luminance(color), 2e-4, of);
        }
        let is_two_sided = of.formula.contains("on both sides");
        assert!(is_two_sided || !of.formula.contains("Φ") || one(of, "n") == 1.0, "{of:#?}");
    }
}

/// Every light of every ray; the beginnings of all formulas that were computed anew.
fn told(name: &str, text: &str) -> BTreeSet<String> {
    let mut told = BTreeSet::new();
    for inspection in inspections(name, text) {
        for ray in &inspection.rays {
            if let Some(sampled) = &ray.light_sample {
                choice(&sampled.choice, f64::from(sampled.probability), &mut told);
                if let Some(sample) = &sampled.sample {
                    let (wi, pdf) =
                        (DVec3::from_array(sample.wi.map(f64::from)), f64::from(sample.light_pdf));
                    check(
                        &sample.derivations,
                        &Sample { wi, arrives: &sample.arrives.lanes, pdf },
                        &mut told,
                    );
                }
            }
            for light in &ray.lights {
                let (Some(wi), Some(pdf)) = (light.wi, light.pdf) else { continue };
                let sample = Sample {
                    wi: DVec3::from_array(wi.map(f64::from)),
                    arrives: &light.arrives.lanes,
                    pdf: f64::from(pdf),
                };
                check(&light.derivations, &sample, &mut told);
            }
            for FoundReport { sampling, light_pdf, radiance, emission: of_radiance, .. } in &ray.found {
                if let Some(of) = of_radiance {
                    emission(of, &radiance.lanes);
                    told.insert("found emission".into());
                }
                let Some(sampling) = sampling else { continue };
                let (probability, density) = (f64::from(sampling.probability), f64::from(sampling.density));
                near(f64::from(*light_pdf), probability * density, 1e-6, &sampling.choice[0]);
                choice(&sampling.choice, probability, &mut told);
                let direction = DVec3::from_array(ray.direction.map(f64::from)).normalize();
                let sample = Sample { wi: direction, arrives: &radiance.lanes, pdf: density };
                check(&sampling.derivations, &sample, &mut told);
                told.insert("found".into());
            }
        }
    }
    told
}

#[track_caller]
fn tells(name: &str, text: &str, expected: &[&str]) {
    let told = told(name, text);
    for beginning in expected {
        assert!(
            told.iter().any(|formula| formula.starts_with(beginning)),
            "{beginning:?} is not in {told:?}"
        );
    }
}

fn own(integrator: &str, light: &str) -> String {
    format!("{OWN}[render]\nsamples = 4\n{integrator}\n{light}")
}

#[test]
fn environment_maps() {
    let light = "[[light]]\ntype = \"environment\"\nimage = \"map.pfm\"\nscale = [0.5, 1, 2]\nrotate = 40\n";
    let told = ["texel (i, j) of the map", "pdf = P(j) P(i)", "L = scale · ((1−f)", "found", "P = 1 / ("];
    tells("a.toml", &own("integrator = \"path\"", light), &told);
    tells("a.toml", &own("integrator = \"whitted\"", light), &told[..3]);
    let square =
        "[[light]]\ntype = \"environment\"\nlayout = \"octahedral\"\nimage = \"square.pfm\"\nrotate = 40\n";
    let told = ["texel (i, j) of the map", "pdf = P(j) P(i)", "L = scale · texel", "found"];
    tells("a.toml", &own("integrator = \"path\"", square), &told);
    tells("a.toml", &own("integrator = \"whitted\"", square), &told[..3]);
    let sky = "[[light]]\ntype = \"sun_and_sky\"\nelevation = 30\n";
    tells("a.toml", &own("integrator = \"path\"", sky), &["pdf = P(j) P(i)", "L = scale"]);
}

#[test]
fn skies_that_vary_little() {
    let light =
        "[[light]]\ntype = \"environment\"\nzenith = [1, 2, 3]\nhorizon = [3, 2, 1]\nnadir = [1, 1, 0]\n";
    tells("a.toml", &own("integrator = \"whitted\"", light), &["pdf = cos / π", "L = (1 − |y|)"]);
}

#[test]
fn portals() {
    let portal = "portal = [[-2, 0.5, 4], [-2, 3, 4], [2, 3, 4], [2, 0.5, 4]]\n";
    for sky in ["image = \"map.pfm\"\nscale = [0.5, 1, 2]\n", "color = [2, 3, 5]\n"] {
        let light = format!("[[light]]\ntype = \"environment\"\n{sky}{portal}");
        let told = ["cell (i, j) of the square", "pdf = W / ΣW", "found"];
        tells("a.toml", &own("integrator = \"path\"", &light), &told);
        tells("a.toml", &own("integrator = \"whitted\"", &light), &told[..2]);
    }
}

#[test]
fn lights_that_move_are_where_they_are_at_the_time() {
    let lights = "[[sphere]]\ncenter = [\"= 2 - 96 * t\", 3, 0]\nradius = 0.4\nemission = 9\n\
        [[quad]]\ncorner = [-2, \"= 2.2 + 48 * t\", -1]\nedge_u = [1, 0, 0]\nedge_v = [0, 0.3, 1]\nemission = 9\n";
    let text = own("integrator = \"path\"", lights).replace("fov = 50", "fov = 50\nshutter = 1");
    tells("a.toml", &text, &["pdf = 1 / (2π (1 − cos θ))", "pdf = P / Ω", "found"]);
    // The distance of the centre is that at the time of the sample.
    let mut distances = 0;
    for inspection in inspections("a.toml", &text) {
        let time = f64::from(inspection.time.expect("a time"));
        let center = DVec3::new(2.0 - 96.0 / 24.0 * time, 3.0, 0.0);
        let found =
            inspection.rays.iter().filter_map(|ray| Some((ray.met.as_ref()?, ray.light_sample.as_ref()?)));
        for (met, light) in found {
            for of in light.sample.iter().flat_map(|sample| &sample.derivations) {
                if of.formula.starts_with("pdf = 1 / (2π (1 − cos θ))") {
                    near(one(of, "D"), center.distance(met.point.into()), 1e-4, of);
                    distances += 1;
                }
            }
        }
    }
    assert!(distances > 50, "{distances}");
}

#[test]
fn pictures_and_patches_by_power() {
    let lights = r#"
AttributeBegin
    Translate 0 4 -1
    Rotate 80 1 0 0
    LightSource "projection" "string filename" "map.pfm" "float scale" 9 "float fov" 80
AttributeEnd
AttributeBegin
    Translate -2 3 0
    Rotate 50 1 2 0
    LightSource "goniometric" "string filename" "square.pfm" "rgb I" [ 3 2 1 ]
AttributeEnd
AttributeBegin
    AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
    Shape "bilinearmesh" "point3 P" [ 3 1 -1  3 1 1  3 3 -1  2 4 1 ]
AttributeEnd
AttributeBegin
    AreaLightSource "diffuse" "rgb L" [ 5 4 3 ]
    Shape "trianglemesh" "point3 P" [ -3 0 0  -3 3 0  -4 1 -2 ] "integer indices" [ 0 1 2 ]
AttributeEnd
"#;
    for (sampler, of_choice) in [("power", "P = power / "), ("bvh", "P = trees / "), ("uniform", "P = 1 / (")]
    {
        let text = format!("Integrator \"path\" \"string lightsampler\" \"{sampler}\"\n{PBRT}{lights}");
        let told = [
            of_choice,
            "(x, y, z) = M (−wi)",
            "L = I / d², I = scale",
            "L = I / d², I = I₀",
            "pdf = P s d²",
            "pdf = P / Ω",
        ];
        tells("a.pbrt", &text, &told);
    }
}

/// Lights of every kind; those of pbrt have written powers, curves and textures.
const EVERY_KIND: &str = r#"
LightSource "point" "point3 from" [ 0 1e19 0 ]
LightSource "point" "point3 from" [ -3 3 -1 ] "rgb I" [ 3 2 1 ]
LightSource "spot" "point3 from" [ 2 4 -2 ] "point3 to" [ 0 0 0 ] "rgb I" [ 20 30 10 ]
LightSource "distant" "point3 from" [ 1 3 -2 ] "rgb L" [ 0.1 0.2 0.3 ]
LightSource "infinite" "string filename" "square.pfm" "float scale" 0.1
AttributeBegin
    Translate 0 4 -1
    Rotate 80 1 0 0
    LightSource "projection" "string filename" "map.pfm" "float scale" 9 "float fov" 80
AttributeEnd
AttributeBegin
    AreaLightSource "diffuse" "rgb L" [ 1 2 4 ] "float power" 30
    Translate -1.5 1 -1.5
    Shape "sphere" "float radius" 0.3
AttributeEnd
AttributeBegin
    AreaLightSource "diffuse" "blackbody L" 3000 "bool twosided" true "float power" 50
    Shape "bilinearmesh" "point3 P" [ 3 1 -1  3 1 1  3 3 -1  2 4 1 ]
AttributeEnd
AttributeBegin
    AreaLightSource "diffuse" "blackbody L" 5000 "float scale" 3
    Translate 1.5 2.5 -1
    Rotate 90 1 0 0
    Shape "disk" "float radius" 0.5 "float alpha" 0.5
AttributeEnd
AttributeBegin
    AreaLightSource "diffuse" "string filename" "map.pfm" "float power" 20 "bool twosided" true
    Shape "trianglemesh" "point3 P" [ -3 0 0  -3 3 0  -4 1 -2 ] "point2 uv" [ 0 0  1 0  0 1 ] "integer indices" [ 0 1 2 ]
AttributeEnd
"#;

#[test]
fn lights_of_every_kind_by_importance_and_power() {
    let emissions = [
        "L = s C on the side of its normal: C its",
        "L = s C on both sides: C its colour, s =",
        "L = s C on both sides: C the colour of i",
        "L = s C T on the side of its normal: C i",
        "found emission",
        "found",
    ];
    let text = |sampler: &str| {
        format!("Integrator \"path\" \"string lightsampler\" \"{sampler}\"\n{PBRT}{EVERY_KIND}")
    };
    let by_importance =
        ["P = trees / ", "importance = Φ cos θ'", "importance = Φ / max(d², r)", "power = π A B"];
    tells("a.pbrt", &text("bvh"), &[&by_importance[..], &emissions].concat());
    let by_power = ["P = power / ", "power = 4π B", "power = π A B", "power = 4π² R² B"];
    tells("a.pbrt", &text("power"), &by_power);
    let even = "[[light]]\ntype = \"distant\"\ndirection = [1, -2, 1]\nintensity = [1, 2, 3]\n[[light]]\ntype = \"environment\"\n\
        image = \"map.pfm\"\nscale = [0.5, 1, 2]\n";
    let settings = "integrator = \"path\"\nlight_sampler = \"power\"";
    tells("a.toml", &own(settings, even), &["power = π R² B", "power = 4π² R² B"]);
}
