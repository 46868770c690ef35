//! Curves that emit light.

use std::path::{Path, PathBuf};

use lookfrom_scene::scene::Scene;
use lookfrom_scene::settings::ColorMode;
use lookfrom_scene::{LoadContext, Memory, load};

use super::support::Compiled;

/// A tube along x above a floor, of which the camera sees the floor or the tube.
fn scene(integrator: &str, looks_at: &str, tube: &str) -> (Scene, Vec<String>) {
    let text = format!(
        "LookAt 0 0.02 0  {looks_at}  0 0 1  Camera \"perspective\" \"float fov\" 10\n\
         Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4 Sampler \"independent\" \"integer pixelsamples\" 65536\n\
         Integrator \"{integrator}\" \"integer maxdepth\" 1 WorldBegin\n\
         AttributeBegin Rotate -90 1 0 0 Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5] Shape \"disk\" \"float radius\" 9 AttributeEnd\n\
         AttributeBegin Translate 0 1 0 AreaLightSource \"diffuse\" \"rgb L\" [3 3 3] {tube} AttributeEnd"
    );
    let files = Memory([(PathBuf::from("a.pbrt"), text.into_bytes())].into());
    let mut context = LoadContext::new(&files);
    let mut scene = load::scene(Path::new("a.pbrt"), &mut context).unwrap_or_else(|error| panic!("{error}"));
    scene.render.color = ColorMode::Rgb;
    (scene, context.warnings.iter().map(ToString::to_string).collect())
}

const CURVE: &str = "Shape \"curve\" \"string type\" \"cylinder\" \"float width\" 0.4 \"point3 P\" [-2 0 0 -1 0 0 1 0 0 2 0 0]";

fn mean(integrator: &str, looks_at: &str, tube: &str) -> f64 {
    let (scene, warnings) = scene(integrator, looks_at, tube);
    assert!(warnings.is_empty(), "{warnings:?}");
    let pixels = Compiled::new(scene).film().picture().pixels;
    pixels.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / pixels.len() as f64
}

#[test]
fn a_curve_is_seen_as_bright_as_it_is() {
    for kind in ["flat", "cylinder"] {
        let seen = mean("path", "0 1 0", &CURVE.replace("cylinder", kind));
        assert!((seen - 3.0).abs() < 1e-4, "{kind}: {seen}");
    }
    // A ribbon has a back.
    let ribbon = |y: f64| {
        let normals = format!("\"normal N\" [0 {y} 0 0 {y} 0]");
        mean("path", "0 1 0", &format!("{} {normals}", CURVE.replace("cylinder", "ribbon")))
    };
    let seen = [ribbon(1.0), ribbon(-1.0)];
    assert!(seen.contains(&0.0) && seen.iter().any(|seen| (seen - 3.0).abs() < 1e-4), "{seen:?}");
}

#[test]
fn a_curve_lights_as_the_cylinder_that_it_stands_for() {
    let cylinder =
        "Rotate 90 0 1 0 Shape \"cylinder\" \"float radius\" 0.2 \"float zmin\" -2 \"float zmax\" 2";
    // A flat band of half-width r fills a smaller angle than a cylinder: sin θ = r / √(d² + r²), not r / d.
    let (r2, d2) = (0.2 * 0.2, 1.0 + 0.5 * 0.5);
    let sampled = mean("path", "0.3 0 0.5", cylinder) / f64::sqrt(1.0 + r2 / d2);
    for integrator in ["path", "simplepath", "randomwalk"] {
        let found = mean(integrator, "0.3 0 0.5", CURVE);
        assert!((found / sampled - 1.0).abs() < 0.01, "{integrator}: {found}, not {sampled}");
    }
}

#[test]
fn a_power_is_that_of_the_cylinder_around() {
    let with_power = |tube: &str| {
        let light = "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 5";
        mean("randomwalk", "0 1 0", &format!("{light} {tube}"))
    };
    // Radiance times the lateral area 2π r l times π, and the luminance of 1 is 1.
    let radiance = 5.0 / (std::f64::consts::PI * (2.0 * std::f64::consts::PI * 0.2 * 4.0));
    let seen = with_power(CURVE);
    assert!((seen / radiance - 1.0).abs() < 1e-3, "{seen}, not {radiance}");
}
