//! The origins of rays that leave surfaces, computed anew from the operands that the inspector prints.

use std::path::Path;

use crate::support::Compiled;
use glam::{DMat3, DVec3, Vec3};
use lookfrom::inspect::{Departure, Inspection, MetReport, inspect};
use lookfrom::render::SampleId;
use lookfrom_scene::{LoadContext, Memory};

/// A coarse mesh with the normals of a sphere, as itself and as an instance, on a floor.
const SCENE: &str = r#"
[camera]
lookfrom = [0, 1.5, -6]
lookat = [0, 0.8, 0]
fov = 40
[image]
width = 24
height = 16
[[light]]
type = "point"
position = [4, 5, -3]
intensity = [30, 30, 30]
[[plane]]
size = 40
[[mesh]]
file = "ball.obj"
translate = [-1.3, 1, 0]
[[instance]]
object = "one"
transform = [{ scale = [1, 0.7, 1.2] }, { rotate = [20, 30, 40] }, { translate = [1.3, 1, 0] }]
[[objects.one.mesh]]
file = "ball.obj"
"#;

/// A coarse sphere as an OBJ file.
fn ball() -> String {
    const RINGS: usize = 5;
    let mut text = String::new();
    for (i, j) in (0..=RINGS).flat_map(|i| (0..=2 * RINGS).map(move |j| (i, j))) {
        let [theta, phi] = [i, j].map(|k| std::f64::consts::PI * k as f64 / RINGS as f64);
        let [x, y, z] = [theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()];
        text += &format!("v {x} {y} {z}\nvn {x} {y} {z}\n");
    }
    for (i, j) in (0..RINGS).flat_map(|i| (0..2 * RINGS).map(move |j| (i, j))) {
        let [a, b] = [i * (2 * RINGS + 1) + j + 1, (i + 1) * (2 * RINGS + 1) + j + 1];
        text += &format!("f {a}//{a} {0}//{0} {1}//{1} {b}//{b}\n", a + 1, b + 1);
    }
    text
}

fn double(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// The origin of a ray from a hit, relative to the render origin.
fn leaves(inspection: &Inspection, met: &MetReport, departure: &Departure, origin: DVec3, direction: DVec3) {
    let ng = DVec3::from_array(met.ng);
    let p = DVec3::from_array(met.point) - DVec3::from_array(inspection.render_origin);
    let error = DVec3::from_array(met.error);
    let step = ng.abs().dot(error + p.abs() * 2f64.powi(-51));
    assert!((departure.step.abs() / step - 1.0).abs() < 1e-3, "{step}: {departure:?}");
    let lift = departure.lift.map_or(DVec3::ZERO, double);
    let off = origin - (p + lift + departure.step * ng);
    // Rounded to f32.
    assert!(off.abs().max_element() <= 1.2e-7 * origin.abs().max_element(), "{off}: {departure:?}");
    let is_outside = departure.lift.is_some() || ng.dot(direction) >= 0.0;
    assert_eq!(departure.step >= 0.0, is_outside, "{departure:?}");
    if let Some(lift) = departure.lift {
        assert_eq!(met.lift.as_ref().map(|report| report.lift), Some(lift));
        let n = double(met.n);
        assert!(n.dot(direction) > -1e-6, "{n} {direction}");
    }
}

/// The lift of a hit.
fn lift(met: &MetReport) {
    let Some(report) = &met.lift else { return };
    let (corners, normals, weights) =
        (report.corners.map(double), report.normals.map(double), double(report.weights));
    assert!((weights.element_sum() - 1.0).abs() < 1e-6);
    let p: DVec3 = (0..3).map(|k| weights[k] * corners[k]).sum();
    let mut expected: DVec3 =
        (0..3).map(|k| weights[k] * (-(p - corners[k]).dot(normals[k])).max(0.0) * normals[k]).sum();
    if let Some(rows) = report.from_object {
        expected = DMat3::from_cols_array_2d(&rows).transpose() * expected;
    }
    let off = double(report.lift).distance(expected);
    assert!(off < 1e-6, "{off}: {report:?}");
}

#[test]
fn origins_follow_from_what_is_printed() {
    let files = [("a.toml", SCENE.to_owned()), ("ball.obj", ball())];
    let files = Memory(files.map(|(name, text)| (name.into(), text.into_bytes())).into());
    let mut counts = [0; 5];
    for integrator in ["path", "whitted"] {
        let mut context = LoadContext::new(&files);
        let mut scene = lookfrom_scene::load::scene(Path::new("a.toml"), &mut context).expect("a scene");
        scene.render.integrator = match integrator {
            "path" => lookfrom_scene::settings::Integrator::Path,
            _ => lookfrom_scene::settings::Integrator::Whitted,
        };
        let compiled = Compiled::new(scene);
        let renderer = compiled.renderer();
        for [x, y] in (0..16).flat_map(|y| (0..24).map(move |x| [x, y])) {
            let inspection = inspect(&renderer, SampleId { pixel: [x, y], sample: 0 });
            let text = inspection.to_string();
            for ray in &inspection.rays {
                let shadows = ray
                    .lights
                    .iter()
                    .filter_map(|light| light.shadow.as_ref())
                    .chain(ray.light_sample.iter().filter_map(|sample| sample.shadow.as_ref()));
                if let Some(met) = &ray.met {
                    lift(met);
                    let is_placed = met.lift.as_ref().is_some_and(|lift| lift.from_object.is_some());
                    counts[usize::from(is_placed)] += usize::from(met.lift.is_some());
                    assert!(met.lift.is_none() || text.contains("lift = "), "{text}");
                    for shadow in shadows {
                        let departure = shadow.departure.as_ref().expect("the shadow ray leaves a hit");
                        let from =
                            DVec3::from_array(shadow.from) - DVec3::from_array(inspection.render_origin);
                        let to = DVec3::from_array(shadow.to) - DVec3::from_array(shadow.from);
                        leaves(&inspection, met, departure, from, to);
                        counts[2] += usize::from(departure.lift.is_some());
                        assert!(departure.lift.is_none() || text.contains("point + lift + s ng"), "{text}");
                    }
                }
                let parent = ray.parent.and_then(|parent| inspection.ray(parent));
                if let Some(met) = parent.and_then(|parent| parent.met.as_ref()) {
                    let departure = ray.departure.as_ref().expect("it leaves a hit");
                    let [from, to] = [ray.origin, ray.direction].map(double);
                    leaves(&inspection, met, departure, from, to);
                    counts[3] += usize::from(departure.lift.is_some());
                    counts[4] += usize::from(departure.lift.is_none());
                } else {
                    assert!(ray.departure.is_none() && Vec3::from_array(ray.origin).is_finite());
                }
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 10), "{counts:?}");
}
