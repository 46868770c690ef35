//! The inspector of paths: does what it shows add up to what the film received, and do its numbers fit its formulas?

use std::collections::BTreeSet;

use crate::support::{Compiled, scene};
use glam::{DVec3, Vec3};
use lookfrom::film::{Film, FilmTile};
use lookfrom::inspect::{Inspection, RayKind, RayReport, SvgView, inspect, inspect_pixel, svg};
use lookfrom::render::SampleId;
use lookfrom_scene::image::Image;
use lookfrom_scene::light::{Light, LightKind, MapRows, Power, Sky};
use lookfrom_scene::scene::ImageId;
use lookfrom_scene::settings::{ColorMode, Integrator, PixelBounds};
use lookfrom_scene::{Location, Scene};

/// Glass that disperses, rough metal, a coat, a pane with holes, a mirror, a swallowing body, two lamps.
const ROOM: &str = r##"
[camera]
lookfrom = [0, 1.2, 5]
lookat = [0, 0.7, 0]
fov = 40

[image]
width = 48
height = 32

[render]
samples = 4
depth = 7

[materials.floor]
type = "diffuse"
reflectance = [0.7, 0.6, 0.5]

[materials.prism]
type = "dielectric"
ior = "SF11"

[materials.metal]
type = "conductor"
metal = "gold"
roughness = 0.5

[materials.mirror]
type = "conductor"
metal = "silver"

[materials.lacquer]
type = "coated_diffuse"
reflectance = [0.5, 0.1, 0.1]
roughness = 0.3

[materials.jelly]
diffuse = 0
mirror = 1
transmission = 1
fresnel = true
absorption = [0.1, 0.9, 0.5]

[materials.lamp]
type = "diffuse"
emission = [9, 8, 7]

[[quad]]
corner = [-4, 0, -3]
edge_u = [0, 0, 8]
edge_v = [8, 0, 0]
material = "floor"

[[sphere]]
center = [-1.6, 0.5, 0.4]
radius = 0.5
material = "prism"

[[sphere]]
center = [-0.5, 0.5, -0.3]
radius = 0.5
material = "metal"

[[sphere]]
center = [0.6, 0.5, 0.1]
radius = 0.5
material = "lacquer"

[[sphere]]
center = [1.6, 0.5, 0.6]
radius = 0.45
material = "jelly"

[[quad]]
corner = [-2.5, 0, -2]
edge_u = [5, 0, 0]
edge_v = [0, 1.6, 0]
material = "mirror"

[[quad]]
corner = [-1.2, 0, 1.2]
edge_u = [2.4, 0, 0]
edge_v = [0, 0.6, 0]
material = "floor"
alpha = 0.5

[[sphere]]
center = [0.3, 1.7, -0.5]
radius = 0.25
material = "lamp"

[[light]]
type = "rectangle"
name = "window"
center = [-3, 4, 2]
target = [0, 0, 0]
width = 1
height = 1
radiance = 20

[[light]]
type = "point"
name = "bulb"
position = [2, 3, 2]
intensity = 4
"##;

/// The room under a picture of a sky with a sun.
fn room(integrator: Integrator, color: ColorMode) -> Scene {
    let mut scene = scene(ROOM);
    let image = ImageId(scene.images.len() as u32);
    let texels = (0..128).map(|k| if k == 37 { [60.0, 50.0, 30.0] } else { [0.3, 0.4, 0.5] }).collect();
    scene.images.push(Image::from_linear("sky", 16, 8, texels));
    let sky =
        Sky::Image { image, scale: [1.0; 3], world_from_light: glam::DMat4::IDENTITY, rows: MapRows::Bands };
    scene.lights.push(Light {
        name: Some("sky".into()),
        at: Location::default(),
        kind: LightKind::Environment { sky, portal: None, illuminates: true },
        power: Power::AS_WRITTEN,
    });
    scene.render.integrator = integrator;
    scene.render.color = color;
    scene
}

const INTEGRATORS: [Integrator; 5] = [
    Integrator::Path,
    Integrator::SimplePath,
    Integrator::RandomWalk,
    Integrator::AmbientOcclusion { cosine: true },
    Integrator::AmbientOcclusion { cosine: false },
];

/// Some pixels of every kind of thing in the room.
fn pixels() -> impl Iterator<Item = [u32; 2]> {
    (0..32).step_by(3).flat_map(|y| (0..48).step_by(5).map(move |x| [x, y]))
}

#[test]
fn what_is_shown_of_a_path_adds_up_to_what_the_film_received() {
    for integrator in INTEGRATORS {
        for color in [ColorMode::Rgb, ColorMode::Spectral] {
            let compiled = Compiled::new(room(integrator, color));
            let renderer = compiled.renderer();
            let area = PixelBounds { x0: 0, y0: 0, x1: 48, y1: 32 };
            let mut tile = FilmTile::new(area).expect("a small tile");
            renderer.render_tile(2..3, &mut tile).expect("an empty tile");
            let mut film = Film::new(48, 32, None).expect("a small film");
            film.add_tile(&tile).expect("of this film");

            let mut light_was_seen = false;
            for [x, y] in pixels() {
                let inspection = inspect(&renderer, SampleId { pixel: [x, y], sample: 2 });
                let at = format!("{integrator:?} {color:?} at {x} {y}");
                let mut sum = vec![0.0; if color == ColorMode::Rgb { 3 } else { 4 }];
                for addition in &inspection.additions {
                    for (sum, value) in sum.iter_mut().zip(&addition.value.lanes) {
                        *sum += value;
                    }
                }
                assert_eq!(sum, inspection.radiance.lanes, "{at}");
                assert!(inspection.adds_up, "{at}");
                assert_eq!(film.mean(x, y), inspection.film, "{at}");
                assert!(inspection.to_string().contains("the same, bit for bit"), "{at}");
                let drawing = svg(&renderer, &inspection, SvgView::Sheet);
                assert!(drawing.is_ok_and(|drawing| drawing.ends_with("</svg>\n")), "{at}");
                light_was_seen |= inspection.film != [0.0; 3];
            }
            assert!(light_was_seen, "{integrator:?} {color:?} is black");
        }
    }
}

/// Y of a linear Rec. 709 colour.
fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.212_639 * r + 0.715_169 * g + 0.072_192 * b
}

fn close(a: f32, b: f32) -> bool {
    (a - b).abs() <= 1e-5 * a.abs().max(b.abs()) + 1e-12
}

fn assert_close(found: &[f32], expected: impl Fn(usize) -> f32, what: &str) {
    for (lane, found) in found.iter().enumerate() {
        let expected = expected(lane);
        assert!(close(*found, expected), "{what}, lane {lane}: {found}, expected {expected}");
    }
}

fn heuristic(p: f32, q: f32) -> f32 {
    let [p, q] = [p, q].map(f64::from);
    (p * p / (p * p + q * q)) as f32
}

/// Each number of a ray by the formula that the report gives for it.
fn check_ray(inspection: &Inspection, ray: &RayReport, what: &str) {
    let share = ray.throughput_there.as_ref().unwrap_or(&ray.throughput);
    let is_path = inspection.integrator == "path";
    for found in &ray.found {
        let (radiance, w) = (&found.radiance.lanes, found.weight);
        assert_close(&found.added.lanes, |lane| share[lane] * radiance[lane] * w, &format!("{what}: found"));
        match (ray.pdf, inspection.integrator) {
            (Some(p), "path") => assert!(close(w, heuristic(p, found.light_pdf)), "{what}: {found:?}"),
            (Some(_), "simple_path") => assert_eq!(w == 0.0, found.light_pdf > 0.0, "{what}: {found:?}"),
            _ => assert_eq!(w, 1.0, "{what}: {found:?}"),
        }
    }
    let light_sample = ray.light_sample.as_ref();
    if let Some((light, sample)) = light_sample.and_then(|light| Some((light, light.sample.as_ref()?))) {
        assert!(close(sample.pdf, light.probability * sample.light_pdf), "{what}: {light:?}");
        let expected = sample.bsdf_pdf.map_or(1.0, |q| heuristic(sample.pdf, q));
        assert!(close(sample.weight, expected), "{what}: {light:?}");
        let through = |lane: usize| match &light.shadow {
            Some(shadow) => {
                let passed: f32 = shadow.blockers.iter().map(|blocker| blocker.passed[lane]).product();
                passed * shadow.rest.as_ref().map_or(0.0, |rest| rest[lane])
            }
            None => 0.0,
        };
        let (arrives, f_cos) = (&sample.arrives.lanes, &sample.f_cos);
        let added =
            |lane| share[lane] * f_cos[lane] * arrives[lane] * through(lane) * sample.weight / sample.pdf;
        assert_close(&light.added.lanes, added, &format!("{what}: light sample"));
    }
    let next = inspection.rays.iter().find(|next| next.parent == Some(ray.address));
    if let Some(bounce) = &ray.bounce {
        assert_eq!(&bounce.throughput_before, share, "{what}");
        let expected = |lane| share[lane] * bounce.f[lane] * bounce.cos / bounce.pdf;
        assert_close(&bounce.throughput_after, expected, &format!("{what}: β"));
        assert!(is_path || bounce.survival == 1.0, "{what}");
        if let Some(next) = next {
            assert_eq!(Some(&next.throughput), bounce.next_throughput.as_ref(), "{what}");
            assert_close(&next.throughput, |lane| bounce.throughput_after[lane] / bounce.survival, what);
            assert_eq!(next.pdf.is_none(), bounce.lobe.starts_with("specular"), "{what}");
        }
    }
    assert_eq!(ray.ends.is_none(), next.is_some(), "{what}: {:?}", ray.ends);
    // along a path: what comes after is part of it
    let none = vec![0.0; ray.added.lanes.len()];
    let after = next.map_or(&none, |next| &next.subtree.lanes);
    assert_close(&ray.subtree.lanes, |lane| ray.added.lanes[lane] + after[lane], &format!("{what}: subtree"));
}

#[test]
fn the_numbers_fit_the_formulas_and_everything_is_told() {
    let mut told: BTreeSet<String> = BTreeSet::new();
    for integrator in INTEGRATORS {
        for color in [ColorMode::Rgb, ColorMode::Spectral] {
            let compiled = Compiled::new(room(integrator, color));
            let renderer = compiled.renderer();
            for (pixel, sample) in pixels().flat_map(|pixel| [0, 1, 2, 3, 4, 5].map(|sample| (pixel, sample)))
            {
                let inspection = inspect(&renderer, SampleId { pixel, sample });
                for ray in &inspection.rays {
                    let name = inspection.integrator;
                    check_ray(
                        &inspection,
                        ray,
                        &format!("{name} {color:?} at {pixel:?}, ray {}", ray.address),
                    );
                    told.insert(ray.kind.to_string());
                    told.extend(ray.ends.map(String::from));
                    told.extend(ray.scattering.iter().map(|scattering| scattering.kind.into()));
                    told.extend(ray.bounce.iter().map(|bounce| bounce.lobe.clone()));
                    told.extend(ray.found.iter().map(|found| format!("{name} found {}", found.light)));
                    told.extend(
                        ray.light_sample.iter().map(|light| format!("{name} sampled {}", light.light)),
                    );
                    let absorbs = ray.throughput_there.as_ref().is_some_and(|share| *share != ray.throughput);
                    told.extend(absorbs.then(|| "absorbs".into()));
                }
                let dispersed = inspection.wavelengths.is_some_and(|wavelengths| wavelengths.dispersed);
                told.extend(dispersed.then(|| "disperses".into()));
            }
        }
    }
    for expected in [
        "camera",
        "reflected",
        "transmitted",
        "scattered",
        "straight on",
        "disperses",
        "absorbs",
        "diffuse",
        "dielectric",
        "conductor",
        "coated diffuse",
        "whitted",
        "diffuse reflection",
        "glossy reflection",
        "specular reflection",
        "specular transmission",
        "path found sky",
        "path sampled sky",
        "path sampled window",
        "path sampled bulb",
        "simple_path sampled window",
        "simple_path found sky",
        "random_walk found sky",
        "it leaves the scene",
        "the maximum depth is reached",
        "Russian roulette ends it",
        "ambient occlusion needs no further rays",
    ] {
        assert!(told.contains(expected), "{expected:?} is not in {told:#?}");
    }
    assert!(!told.iter().any(|told| told.starts_with("random_walk sampled")), "{told:#?}");
}

#[test]
fn the_factors_of_a_contribution_are_of_the_light_that_counts() {
    let compiled = Compiled::new(room(Integrator::Path, ColorMode::Spectral));
    let renderer = compiled.renderer();
    let mut dispersed = 0;
    for pixel in pixels() {
        let inspection = inspect(&renderer, SampleId { pixel, sample: 1 });
        let is_dispersed = inspection.wavelengths.as_ref().is_some_and(|light| light.dispersed);
        for of in &inspection.contributions {
            assert!(!of.why.contains("β 1 ") || !of.why.contains("large β"), "{}", of.why);
            let addition = inspection.additions.iter().find(|addition| {
                addition.address == of.address
                    && addition.value.rgb.map(|c| c * inspection.weight) == of.value
            });
            let Some(addition) = addition.filter(|_| is_dispersed) else { continue };
            // Of the first wavelength alone: β · L · w, or β · f cos · L · w / p.
            let (factors, _) = of.why.split_once(": ").expect("factors, and a reason");
            let number = |words: &str| words.rsplit(' ').next().and_then(|word| word.parse::<f32>().ok());
            let product =
                factors.split(" / ").map(|part| part.split(" · ").filter_map(number).product::<f32>());
            let product = product.reduce(|factors, divisor| factors / divisor).expect("a product");
            // A shadow ray may lose a part.
            let lane = addition.value.lanes[0];
            let is_alike = if factors.contains(" / p ") {
                product >= 0.97 * lane
            } else {
                (product / lane - 1.0).abs() < 0.03
            };
            assert!(is_alike, "{lane}, by its factors {product}: {}", of.why);
            dispersed += usize::from(lane > 0.0);
        }
    }
    assert!(dispersed > 5, "{dispersed}");
}

#[test]
fn hair_is_told_with_the_angle_of_its_scales() {
    let text = "camera = { lookfrom = [0, 0, 5], lookat = [0, 0, 0] }\nimage = { width = 3, height = 3 }\n\
        render = { integrator = \"path\" }\nlight = [{ type = \"environment\", color = 1 }]\n\
        [materials.hair]\ntype = \"hair\"\noffset = 3\n\
        [[curve]]\npoints = [[0, -2, 0], [0, -1, 0], [0, 1, 0], [0, 2, 0]]\nwidth = 3\nmaterial = \"hair\"";
    let inspection = inspect(&Compiled::new(scene(text)).renderer(), SampleId { pixel: [1, 1], sample: 0 });
    let scattering = inspection.rays[0].scattering.as_ref().expect("hair");
    let [sine] = scattering.numbers.iter().find(|(name, _)| *name == "sin α").expect("sin α").1[..] else {
        panic!("{scattering:?}")
    };
    assert!((f64::from(sine) - 3.0_f64.to_radians().sin()).abs() < 1e-6, "{sine}");
}

#[test]
fn words_for_panes_and_tints_are_true() {
    let text = |material: &str| {
        let text = format!(
            "camera = {{ lookfrom = [0, 0, 5], lookat = [0, 0, 0] }}\nimage = {{ width = 3, height = 3 }}\n\
             render = {{ integrator = \"path\", samples = 4 }}\nlight = [{{ type = \"point\", position = [1, 2, 4], intensity = 1 }}]\n\
             quad = [{{ corner = [-9, -9, 0], edge_u = [18, 0, 0], edge_v = [0, 18, 0], material = \"here\" }}]\n\
             [materials.here]\n{material}"
        );
        let renderer = Compiled::new(scene(&text)).renderer();
        let words = (0..4).map(|sample| inspect(&renderer, SampleId { pixel: [1, 1], sample }).to_string());
        words
            .flat_map(|text| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
            .collect::<Vec<_>>()
            .join(" ")
    };
    let pane = text("type = \"thin_dielectric\"");
    assert!(pane.contains("goes on by specular transmission"), "{pane}");
    assert!(pane.contains("the thin dielectric is smooth and lets light through: F = "), "{pane}");
    let varnish = text("type = \"openpbr\"\ncoat_weight = 1\ncoat_color = [1, 0.8, 0.4]");
    assert!(
        varnish.contains("each reflects: ") && varnish.contains("part = what goes this way, tinted = ["),
        "{varnish}"
    );
}

#[test]
fn a_mirrored_camera_says_how_its_axes_follow() {
    for (x, is_mirrored) in [(1, false), (-1, true)] {
        let matrix = format!("[{x}, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -5, 0, 0, 0, 1]");
        let text =
            format!("camera = {{ matrix = {matrix} }}\nimage = {{ width = 3, height = 3 }}\nsphere = [{{}}]");
        let inspection =
            inspect(&Compiled::new(scene(&text)).renderer(), SampleId { pixel: [1, 1], sample: 0 });
        let [u, v, w] =
            [inspection.camera.u, inspection.camera.v, inspection.camera.w].map(DVec3::from_array);
        assert_eq!(if is_mirrored { u.cross(w) } else { w.cross(u) }, v);
        let words = inspection.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(words.contains("(mirrored: u = w × up, v = u × w)"), is_mirrored, "{words}");
    }
}

#[test]
fn contributions_are_of_what_the_film_received() {
    let text = "camera = { lookfrom = [0, 0, 5], lookat = [0, 0, 0] }\nimage = { width = 3, height = 3, max_component = 0.2 }\n\
        render = { integrator = \"path\" }\nsphere = [{ radius = 2, emission = [3, 2, 1] }]";
    let inspection = inspect(&Compiled::new(scene(text)).renderer(), SampleId { pixel: [1, 1], sample: 0 });
    let [of] = &inspection.contributions[..] else { panic!("{inspection}") };
    assert!(inspection.film[0] < 0.3 && of.value[0] > 0.0, "{inspection}");
    assert_close(&of.value, |channel| inspection.film[channel], "a limited sample");
    assert!(
        of.why.contains(" · limit 0.0") && inspection.to_string().contains("100 %   camera"),
        "{inspection}"
    );
}

#[test]
fn a_pixel_is_the_sum_of_its_samples() {
    for integrator in [Integrator::Path, Integrator::Whitted] {
        let compiled = Compiled::new(room(integrator, ColorMode::Rgb));
        let renderer = compiled.renderer();
        let mut said = BTreeSet::new();
        for pixel in pixels() {
            let whole = inspect_pixel(&renderer, pixel, 0..4).expect("a pixel of the picture");
            let mut contributions: Vec<f32> = Vec::new();
            for summary in &whole.all {
                let one = inspect(&renderer, SampleId { pixel, sample: summary.sample });
                assert_eq!(one.film, summary.film, "{pixel:?}");
                contributions.extend(one.additions.iter().map(|addition| luminance(addition.value.rgb)));
                assert_eq!(summary.light.is_some(), one.film != [0.0; 3], "{pixel:?}");
                assert!(one.to_string().contains("In short"), "{one}");
            }
            contributions.sort_by(|a, b| b.total_cmp(a));
            let told: Vec<f32> = whole.contributions.iter().map(|one| luminance(one.value)).collect();
            assert_eq!(told, contributions[..told.len()], "{pixel:?}: the largest of all");
            assert_eq!(told.len(), contributions.len().min(3), "{pixel:?}");
            said.extend(whole.contributions.into_iter().map(|one| one.expression));
        }
        for expected in match integrator {
            Integrator::Path => {
                ["camera → floor quad 1 (D) → window", "camera → prism (T) → ", " (D) → sky", "metal (G) → "]
            }
            _ => [
                "camera → floor quad 1 (D) → window",
                "camera → jelly (R) → ",
                "mirror (R) → ",
                "camera → prism (T) → ",
            ],
        } {
            assert!(said.iter().any(|said| said.contains(expected)), "{expected:?} is not in {said:#?}");
        }
    }
    let compiled = Compiled::new(room(Integrator::Path, ColorMode::Rgb));
    let renderer = compiled.renderer();
    assert!(inspect_pixel(&renderer, [48, 0], 0..1).is_err_and(|error| error.message.contains("48 × 32")));
    assert!(inspect_pixel(&renderer, [0, 0], 1..1).is_err_and(|error| error.message.contains("1..1")));
}

/// A sheet with holes above a floor, seen straight from above.
const SHEET: &str = r#"
[camera]
lookfrom = [0, 5, 0.01]
lookat = [0, 0, 0]
fov = 40

[image]
width = 16
height = 16

[render]
samples = 2

[materials.floor]
diffuse = 0.5

[[quad]]
corner = [-4, 0, -4]
edge_u = [0, 0, 8]
edge_v = [8, 0, 0]
material = "floor"

[[quad]]
corner = [-4, 1, -4]
edge_u = [0, 0, 8]
edge_v = [8, 0, 0]
material = "floor"
alpha = 0.4

[[quad]]
corner = [-4, 2, -4]
edge_u = [0, 0, 8]
edge_v = [8, 0, 0]
material = "floor"
alpha = 0.4

[[light]]
type = "point"
position = [0, 3, 0]
intensity = 5
"#;

#[test]
fn rays_that_pass_holes_are_shown() {
    for integrator in [Integrator::Whitted, Integrator::Raycast, Integrator::Normals] {
        let mut of_sheets = scene(SHEET);
        of_sheets.render.integrator = integrator;
        let compiled = Compiled::new(of_sheets);
        let renderer = compiled.renderer();
        let mut longest = 0;
        for (y, x) in (0..16).flat_map(|y| (0..16).map(move |x| (y, x))) {
            let inspection = inspect(&renderer, SampleId { pixel: [x, y], sample: 1 });
            let text = inspection.to_string();
            let mut parent = None;
            for ray in &inspection.rays {
                let kind = if parent.is_none() { RayKind::Camera } else { RayKind::StraightOn };
                assert_eq!((ray.kind, ray.parent), (kind, parent), "{integrator:?} at {x} {y}");
                assert!(text.contains(&format!("{kind} ray {}:", ray.address)), "{text}");
                assert_eq!(ray.subtree, inspection.radiance, "{integrator:?} at {x} {y}");
                parent = Some(ray.address);
            }
            longest = longest.max(inspection.rays.len());
            let drawing =
                svg(&renderer, &inspection, SvgView::Side).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(drawing.contains("ray that passed a surface"), inspection.rays.len() > 1, "{x} {y}");
        }
        assert_eq!(longest, 3, "{integrator:?}: past both sheets to the floor");
    }
}

/// Attributes of the elements of a drawing that contain a text, in order.
fn attributes(drawing: &str, mark: &str, names: &[&str]) -> Vec<Vec<f64>> {
    let value = |line: &str, name: &str| -> f64 {
        let rest = line.split(&format!(" {name}=\"")).nth(1).unwrap_or_else(|| panic!("no {name}: {line}"));
        rest.split('"').next().expect("its end").parse().expect("a number")
    };
    let lines = drawing.lines().filter(|line| line.contains(mark));
    lines.map(|line| names.iter().map(|name| value(line, name)).collect()).collect()
}

#[test]
fn the_ring_is_around_the_pixel_whatever_the_lens() {
    for (name, lens) in [("a pinhole", ""), ("a lens", "aperture = 0.4\nfocus_distance = 5\n")] {
        let text = ROOM.replace("fov = 40\n", &format!("fov = 40\n{lens}"));
        let compiled = Compiled::new(scene(&text));
        let renderer = compiled.renderer();
        for pixel in [[3, 4], [40, 25], [24, 16]] {
            let inspection = inspect(&renderer, SampleId { pixel, sample: 2 });
            let drawing = svg(&renderer, &inspection, SvgView::Camera).expect("a drawing");
            let rings = attributes(&drawing, "<circle ", &["cx", "cy", "r"]);
            let ring = rings.iter().find(|ring| ring[2] == 9.0).expect("a ring");
            // The panel is the image plane, 976 units wide.
            let scale = 976.0 / 48.0;
            let [x, y] = [inspection.camera.p_k[0] * scale, (32.0 - inspection.camera.p_k[1]) * scale];
            assert!((ring[0] - x).abs() < 0.2 && (ring[1] - y).abs() < 0.2, "{name}: {ring:?}, {x} {y}");
        }
    }
}

#[test]
fn parallel_cameras_are_drawn_as_boxes() {
    let edges = |projection: &str| {
        let compiled = Compiled::new(scene(&ROOM.replace("fov = 40\n", projection)));
        let renderer = compiled.renderer();
        let inspection = inspect(&renderer, SampleId { pixel: [24, 16], sample: 0 });
        let drawing = svg(&renderer, &inspection, SvgView::Side).expect("a drawing");
        let lines = drawing.lines().filter(|line| line.contains("stroke-opacity=\"0.6\""));
        let points = |line: &str| -> Vec<f64> {
            let numbers = line.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
            numbers.filter(|word| word.contains('.')).filter_map(|word| word.parse().ok()).take(4).collect()
        };
        lines.map(points).collect::<Vec<_>>()
    };
    let slope = |line: &Vec<f64>| (line[3] - line[1]).atan2(line[2] - line[0]);
    let spread = |lines: Vec<Vec<f64>>| {
        assert_eq!(lines.len(), 4, "{lines:?}");
        let slopes: Vec<f64> = lines.iter().map(slope).collect();
        slopes.iter().fold(f64::MIN, |a, b| a.max(*b)) - slopes.iter().fold(f64::MAX, |a, b| a.min(*b))
    };
    assert!(spread(edges("fov = 40\n")) > 0.3);
    assert!(spread(edges("projection = \"orthographic\"\nheight = 3\n")) < 0.02);
}

#[test]
fn a_texture_that_is_averaged_tells_the_footprint() {
    // From straight above, 2 units high: all pixels are nearly 4 tan 2° / 64 wide, and uv are an eighth of that.
    let floor = |footprint: &str| {
        scene(&format!(
            r#"
            [camera]
            lookfrom = [0, 2, 0]
            lookat = [0, 0, 0]
            up = [0, 0, 1]
            fov = 4
            [image]
            width = 64
            height = 64
            filter = "box"
            [textures.tiles]
            type = "checker"
            {footprint}
            [materials.floor]
            type = "diffuse"
            reflectance = "tiles"
            [[quad]]
            corner = [-4, 0, -4]
            edge_u = [0, 0, 8]
            edge_v = [8, 0, 0]
            material = "floor"
            [[light]]
            type = "environment"
            color = 1
            "#
        ))
    };
    let met = |footprint| {
        let compiled = Compiled::new(floor(footprint));
        let inspection = inspect(&compiled.renderer(), SampleId { pixel: [32, 31], sample: 0 });
        (inspection.rays[0].met.clone().expect("the floor"), inspection.to_string())
    };
    let (met_sharp, text) = met("");
    assert!(met_sharp.footprint.is_none() && !text.contains("a pixel sees"));
    let (met, text) = met("footprint = 2");
    let found = met.footprint.expect("a footprint");
    let width = 4.0 * 2_f32.to_radians().tan() / 64.0;
    let is_near = |a: f32, b: f32| (a - b).abs() < 0.01 * width;
    let [dpdx, dpdy] = [found.dpdx, found.dpdy].map(Vec3::from);
    assert!(is_near(dpdx.length(), width) && is_near(dpdy.length(), width), "{found:?}");
    assert!(is_near(dpdx.y, 0.0) && is_near(dpdx.dot(dpdy) / width, 0.0), "{found:?}");
    for (dp, [du, dv]) in [(dpdx, found.duv_dx), (dpdy, found.duv_dy)] {
        assert!(is_near(8.0 * du, dp.z) && is_near(8.0 * dv, dp.x), "{found:?}");
    }
    assert!(text.contains("a pixel sees ∂p/∂x = "), "{text}");
}
