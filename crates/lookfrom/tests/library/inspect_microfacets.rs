//! The inspector's D, G and F of microfacets, computed anew in f64 from the directions and α that it prints, and their
//! product, which is the BSDF.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use crate::support::{Compiled, scene};
use glam::{DVec3, Vec3};
use lookfrom::inspect::{Inspection, MicrofacetReport, RayReport, inspect};
use lookfrom::render::SampleId;
use lookfrom_scene::Scene;
use lookfrom_scene::settings::ColorMode;

/// Balls of rough metal and glass, a coat, glTF's layers, and smooth glass, on a floor under a lamp.
const BALLS: &str = r#"
[camera]
lookfrom = [0, 2, 7]
lookat = [0, 0.4, 0]
fov = 40

[image]
width = 48
height = 20

[render]
integrator = "path"
samples = 4
depth = 6

[materials]
floor = { type = "diffuse", reflectance = 0.7 }
metal = { type = "conductor", metal = "gold", roughness = 0.4 }
glass = { type = "dielectric", ior = 1.5, roughness = 0.3 }
smooth = { type = "dielectric", ior = 1.5 }
sheet = { type = "thin_dielectric", ior = 1.5 }
mirror = { type = "conductor", metal = "silver" }
lacquer = { type = "coated_diffuse", reflectance = [0.5, 0.1, 0.1], roughness = 0.4 }
car = { type = "principled", base_color = [0.1, 0.3, 0.7], roughness = 0.6, clearcoat = 0.8, clearcoat_roughness = 0.5 }
frost = { type = "principled", base_color = [0.9, 1, 0.9], roughness = 0.6, transmission = 1, solid = true, ior = 1.4 }
toy = { type = "plastic", reflectance = [0.1, 0.5, 0.1], roughness = 0.6 }
marble = { type = "plastic", reflectance = 0.3 }
pane = { type = "principled", base_color = [0.9, 1, 0.9], roughness = 0.6, transmission = 1 }

[[plane]]
point = [0, 0, 0]
normal = [0, 1, 0]
size = 40
material = "floor"

[[sphere]]
center = [-2.6, 0.4, 0]
radius = 0.4
material = "metal"

[[sphere]]
center = [-1.7, 0.4, 0]
radius = 0.4
material = "glass"

[[sphere]]
center = [-0.8, 0.4, 0]
radius = 0.4
material = "lacquer"

[[sphere]]
center = [0.1, 0.4, 0]
radius = 0.4
material = "car"

[[sphere]]
center = [1, 0.4, 0]
radius = 0.4
material = "frost"

[[sphere]]
center = [1.9, 0.4, 0]
radius = 0.4
material = "pane"

[[sphere]]
center = [2.6, 0.3, 0.4]
radius = 0.3
material = "smooth"

[[sphere]]
center = [-2.2, 0.3, 1]
radius = 0.3
material = "mirror"

[[sphere]]
center = [1.4, 0.3, 1]
radius = 0.3
material = "sheet"

[[sphere]]
center = [-0.5, 0.3, 1]
radius = 0.3
material = "toy"

[[sphere]]
center = [0.4, 0.3, 1]
radius = 0.3
material = "marble"

[[light]]
type = "rectangle"
center = [-3, 5, 4]
target = [0, 0, 0]
width = 3
height = 3
radiance = 20
"#;

/// The Trowbridge–Reitz distribution for one α.
fn d(cos: f64, alpha: f64) -> f64 {
    let (alpha2, cos2) = (alpha * alpha, cos * cos);
    let below = cos2 * (alpha2 - 1.0) + 1.0;
    alpha2 / (PI * below * below)
}

/// Smith's Λ for one α.
fn lambda(cos: f64, alpha: f64) -> f64 {
    let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos);
    ((1.0 + alpha * alpha * tan2).sqrt() - 1.0) / 2.0
}

/// Fresnel's equations for a dielectric; η is the index there over here.
fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - cos * cos).max(0.0) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let there = (1.0 - sin2).sqrt();
    let parallel = (eta * cos - there) / (eta * cos + there);
    let perpendicular = (cos - eta * there) / (cos + eta * there);
    (parallel * parallel + perpendicular * perpendicular) / 2.0
}

#[track_caller]
fn near(found: impl Into<f64>, expected: f64, what: &str) {
    let found = found.into();
    let tolerance = 2e-3 * found.abs().max(expected.abs()) + 1e-6;
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, expected {expected}");
}

/// What the factors of a boundary must be for two directions; `n` is the shading normal.
fn check(report: &MicrofacetReport, ray: &RayReport, wi: Vec3, n: Vec3, what: &str) {
    let what = &format!("{what}: {report:?}");
    let wo = Vec3::from_array(ray.met.as_ref().expect("a hit").wo).as_dvec3();
    let (wi, n) = (wi.as_dvec3(), n.as_dvec3());
    let is_coat = report.boundary == "clear coat";
    let is_mirrored = matches!(report.boundary, "specular" | "glass");
    let [cos_o, cos_i, cos_om, cos_im] =
        [report.cos_o, report.cos_i, report.cos_om, report.cos_im].map(f64::from);
    near(cos_i, n.dot(wi).abs(), what);
    if !is_coat {
        near(cos_o, n.dot(wo).abs(), what);
    }
    let wm = Vec3::from_array(report.half_vector).as_dvec3();
    let eta = f64::from(report.eta);
    // Some of what a sheet or a rough body scatters is mirrored at its surface.
    if !is_mirrored {
        // Rough glass mirrors at its surface what would leave to the wrong side.
        let is_glass = report.boundary == "dielectric" && report.d.is_some();
        let ways = if is_glass { vec![wi, wi - 2.0 * n.dot(wi) * n] } else { vec![wi] };
        let alike = |wi: DVec3| {
            let half = if report.refracts { wo + eta * wi } else { wo + wi }.normalize();
            half.dot(wm).abs()
        };
        let wi = ways.into_iter().max_by(|a, b| alike(*a).total_cmp(&alike(*b))).expect("a way");
        assert!(report.d.is_none() || alike(wi) > 1.0 - 1e-4, "{what}: {}", alike(wi));
        near(cos_om.abs(), wo.dot(wm).abs(), what);
        near(cos_im.abs(), wi.dot(wm).abs(), what);
    }
    let [alpha, across] = report.alpha.map(f64::from);
    assert_eq!(alpha, across, "{what}: every α of these scenes is isotropic");
    let factor = match (report.d, report.g) {
        (Some(found_d), Some(found_g)) => {
            if !is_coat {
                near(found_d, d(n.dot(wm).abs(), alpha), what);
            }
            let is_shadowed = !matches!(report.boundary, "glass" | "dielectric");
            let masking = 1.0 + lambda(cos_o, alpha) + if is_shadowed { lambda(cos_i, alpha) } else { 0.0 };
            near(found_g, 1.0 / masking, what);
            let jacobian = match report.refracts {
                true => (cos_om * cos_im).abs() / (cos_im + cos_om / eta).powi(2) / (eta * eta),
                false => 0.25,
            };
            f64::from(found_d) * f64::from(found_g) * jacobian / (cos_o * cos_i)
        }
        _ => 1.0 / (cos_i * eta * eta),
    };
    for lane in 0..report.value.len() {
        let gain = report.multiple_scattering.as_ref().map_or(1.0, |more| {
            let [one, mean] = [more.albedo, more.mean_albedo].map(f64::from);
            let fresnel = f64::from(more.mean_fresnel[lane]);
            let gain = 1.0 + fresnel * mean / (1.0 - fresnel * (1.0 - mean)) * (1.0 - one) / one;
            near(more.gain[lane], gain, what);
            assert!((0.3..1.0).contains(&one) && gain < 2.0, "{what}: {gain}");
            gain
        });
        let expected = f64::from(report.weight) * f64::from(report.part[lane]) * factor * gain;
        near(report.value[lane], expected, what);
        match report.boundary {
            "dielectric" => {
                let eta = if wo.dot(n) > 0.0 { 1.5 } else { 1.0 / 1.5 };
                near(report.fresnel[lane], fresnel(cos_om.abs(), eta), what);
                let rest = 1.0 - f64::from(report.fresnel[lane]);
                near(report.part[lane], if report.refracts { rest } else { 1.0 - rest }, what);
            }
            // Once reflected, or through, back and through, and so on.
            "thin dielectric" => {
                let once = fresnel(cos_om.abs(), 1.5);
                let whole = once + (1.0 - once) * (1.0 - once) * once / (1.0 - once * once);
                near(report.fresnel[lane], whole, what);
                let is_reflected = wo.dot(n) * wi.dot(n) > 0.0;
                near(report.part[lane], if is_reflected { whole } else { 1.0 - whole }, what);
            }
            _ if !report.refracts && report.boundary != "specular" => {
                assert_eq!(report.part[lane], report.fresnel[lane], "{what}");
            }
            _ => assert!((0.0..=1.0).contains(&report.part[lane]), "{what}"),
        }
    }
}

/// Asserts that the factors of a direction come to the BSDF there. Returns what was told of.
fn of_direction(
    microfacets: &[MicrofacetReport],
    (ray, wi, n): (&RayReport, Vec3, Vec3),
    f: &[f32],
    what: &str,
) -> Vec<String> {
    let kind = ray.scattering.as_ref().expect("a BSDF").kind;
    for report in microfacets {
        check(report, ray, wi, n, what);
    }
    for (lane, f) in f.iter().enumerate() {
        let sum: f32 = microfacets.iter().map(|report| report.value[lane]).sum();
        match kind {
            "conductor" | "dielectric" | "thin dielectric" => near(sum, f64::from(*f), what),
            // The rest is diffuse, or scattered between layers; walks there are estimates.
            "coated diffuse" => {}
            _ => assert!(sum <= 1.001 * f + 1e-6, "{what}: {sum} is more than {f}"),
        }
    }
    let does = |report: &MicrofacetReport| {
        let smooth = if report.d.is_none() { "smooth " } else { "" };
        format!("{smooth}{} {}", report.boundary, if report.refracts { "refracts" } else { "reflects" })
    };
    microfacets.iter().map(does).collect()
}

fn of_inspection(inspection: &Inspection, what: &str) -> BTreeSet<String> {
    let mut told = BTreeSet::new();
    for ray in &inspection.rays {
        let Some(scattering) = &ray.scattering else { continue };
        let what = &format!("{what}, ray {}", ray.address);
        let n = Vec3::from_array(scattering.n);
        if let Some(bounce) = &ray.bounce {
            let wi = Vec3::from_array(bounce.wi);
            // Walks between layers return one of many estimates.
            told.extend(of_direction(&bounce.microfacets, (ray, wi, n), &bounce.f, what));
        }
        if let Some(sample) = ray.light_sample.as_ref().and_then(|light| light.sample.as_ref()) {
            let wi = Vec3::from_array(sample.wi);
            let cos = n.dot(wi).abs();
            let f: Vec<f32> = sample.f_cos.iter().map(|lane| lane / cos).collect();
            let of_light = of_direction(&sample.microfacets, (ray, wi, n), &f, what);
            told.extend(of_light.into_iter().map(|does| format!("light: {does}")));
        }
    }
    told
}

#[test]
fn microfacets_come_to_the_bsdf() {
    let mut told = BTreeSet::new();
    for color in [ColorMode::Rgb, ColorMode::Spectral] {
        let mut scene: Scene = scene(BALLS);
        scene.render.color = color;
        let compiled = Compiled::new(scene);
        let renderer = compiled.renderer();
        for [x, y] in (0..20).flat_map(|y| (0..48).map(move |x| [x, y])) {
            for sample in 0..2 {
                let inspection = inspect(&renderer, SampleId { pixel: [x, y], sample });
                assert!(inspection.adds_up);
                told.extend(of_inspection(
                    &inspection,
                    &format!("{color:?}, pixel {x} {y}, sample {sample}"),
                ));
                let rays = inspection.rays.iter();
                let of_rays = rays.flat_map(|ray| {
                    let bounce = ray.bounce.iter().flat_map(|bounce| &bounce.microfacets);
                    let light = ray.light_sample.iter().filter_map(|light| light.sample.as_ref());
                    bounce.chain(light.flat_map(|sample| &sample.microfacets))
                });
                let is_rough = of_rays.into_iter().any(|boundary| boundary.d.is_some());
                assert_eq!(inspection.to_string().contains("   G = "), is_rough, "{inspection}");
            }
        }
    }
    for expected in [
        "conductor reflects",
        "dielectric reflects",
        "dielectric refracts",
        "smooth dielectric reflects",
        "smooth dielectric refracts",
        "smooth conductor reflects",
        "smooth thin dielectric reflects",
        "coat reflects",
        "smooth coat reflects",
        "light: coat reflects",
        "specular reflects",
        "clear coat reflects",
        "glass reflects",
        "glass refracts",
        "light: conductor reflects",
        "light: dielectric reflects",
        "light: clear coat reflects",
    ] {
        assert!(told.contains(expected), "{expected:?} is not in {told:?}");
    }
}
