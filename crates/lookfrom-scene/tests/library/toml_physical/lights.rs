//! Lights.

use glam::DVec3;
use lookfrom_scene::light::{LightKind, Sky};
use lookfrom_scene::material::Color;
use lookfrom_scene::spectrum::{self, Curve};
use lookfrom_scene::texture::TexelFilter;

use super::{read, read_files};

#[test]
fn lights_have_curves_and_totals() {
    let scene = read(
        r#"
[[light]]
type = "point"
position = [0, 1, 0]
intensity = { kelvin = 3000, scale = 7 }
[[light]]
type = "distant"
direction = [0, -1, 0]
illuminance = 5
[[light]]
type = "environment"
color = { illuminant = "D65" }
portal = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]
[[light]]
type = "ambient"
color = { illuminant = "D65", scale = 2 }
[[light]]
type = "sphere"
center = [0, 2, 0]
radius = 1
radiance = { kelvin = 3000 }
power = 100
[[sphere]]
emission = { kelvin = 3000, scale = 4 }
"#,
    );
    let LightKind::Point { intensity: Color::Curve(warm), .. } = scene.lights[0].kind else {
        panic!("a point")
    };
    assert_eq!(scene.curves[warm.index()], Curve::Blackbody { kelvin: 3000.0 });
    assert_eq!((scene.lights[0].power.scale, scene.lights[0].power.total), (7.0, None));
    assert!(!scene.lights[0].power.absolute);
    let LightKind::Distant { intensity, .. } = scene.lights[1].kind else { panic!("distant") };
    assert_eq!((intensity, scene.lights[1].power.total), (Color::gray(1.0), Some(5.0)));
    let LightKind::Environment { sky: Sky::Constant(Color::Curve(_)), portal: Some(corners), .. } =
        scene.lights[2].kind
    else {
        panic!("a window to the sky")
    };
    assert_eq!(corners[2], DVec3::new(2.0, 1.0, 0.0));
    // D65 is white, as bright as it says.
    let LightKind::Ambient { color } = scene.lights[3].kind else { panic!("ambient") };
    assert!(color.iter().all(|c| (c - 2.0).abs() < 1e-3), "{color:?}");
    // What it comes to as a whole outdoes the brightness; the curve is kept once.
    let emissions: Vec<_> = scene.shapes.iter().map(|shape| shape.emission.expect("it shines")).collect();
    assert!(emissions.iter().all(|emission| emission.radiance == Color::Curve(warm)));
    let powers: Vec<_> = emissions.iter().map(|e| (e.power.scale, e.power.total)).collect();
    assert!(powers.contains(&(1.0, Some(100.0))) && powers.contains(&(4.0, None)));
}

#[test]
fn lights_throw_pictures_the_right_way() {
    let scene = read(
        r#"
[[light]]
type = "projection"
image = "half.png"
position = [1, 2, 3]
direction = [0, 0, -2]
fov = 30
[[light]]
type = "goniometric"
image = "half.png"
position = [1, 2, 3]
intensity = 2
rotate = 90
[[light]]
type = "environment"
image = "half.png"
layout = "octahedral"
"#,
    );
    let LightKind::Projection { world_from_light, fov: 30.0, .. } = scene.lights[0].kind else {
        panic!("a projector")
    };
    let to = |v: DVec3| world_from_light.transform_vector3(v);
    assert_eq!((to(DVec3::X), to(DVec3::Y), to(DVec3::Z)), (DVec3::X, DVec3::Y, -DVec3::Z));
    assert_eq!(world_from_light.transform_point3(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
    let LightKind::Goniometric { world_from_light, .. } = scene.lights[1].kind else { panic!("a lamp") };
    assert_eq!(world_from_light.transform_vector3(DVec3::Z), DVec3::Y);
    assert_eq!(world_from_light.transform_vector3(DVec3::X), -DVec3::Z);
    let LightKind::Environment { sky: Sky::Octahedral { world_from_light, .. }, .. } = scene.lights[2].kind
    else {
        panic!("a sky")
    };
    assert_eq!(world_from_light.transform_vector3(DVec3::Z), DVec3::Y);
    assert_eq!(world_from_light.transform_vector3(DVec3::X), DVec3::X);
    assert!(world_from_light.determinant() > 0.0);
}

#[test]
fn photometric_files_are_read_once() {
    let lamp = "[[light]]\ntype = \"goniometric\"\nimage = \"a.IES\"\nposition = [0, 2, 0]\nintensity = 3\n";
    let ies = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0 1 1 1\n0 90\n0\n2 1\n";
    let scene = read_files(&[("a.toml", &lamp.repeat(2)), ("a.IES", ies)]);
    assert_eq!((scene.lights.len(), scene.images.len()), (2, 1));
    let Color::Value(intensity) = (match scene.lights[1].kind {
        LightKind::Goniometric { intensity, .. } => intensity,
        ref other => panic!("{other:?}"),
    }) else {
        panic!("no colour")
    };
    assert_eq!(intensity, [3.0; 3]);
    // The brightest direction, straight down, is at the corners of the map.
    assert!(scene.images[0].texel(0)[0] > 0.99);
}

#[test]
fn photometric_files_tell_their_power() {
    let lamp = |keys: &str| {
        let place = "[[light]]\ntype = \"goniometric\"\nimage = \"a.ies\"\nposition = [0, 2, 0]\n";
        // 300 cd straight down, less in proportion to the angle until 0 at the horizon: by hand 2π (1 − 2/π) 300 lm.
        let ies = "TILT=NONE\n1 -1 2 2 1 1 2 0 0 0 0.75 1 1\n0 90\n0\n200 0\n";
        read_files(&[("a.toml", &format!("{place}{keys}\n")), ("a.ies", ies)]).lights.remove(0)
    };
    let light = lamp("intensity = { kelvin = 3000 }\npower = \"file\"");
    let lumens = light.power.total.expect("a power");
    assert!((lumens / (600.0 * (std::f32::consts::PI - 2.0)) - 1.0).abs() < 1e-3, "{lumens}");
    let LightKind::Goniometric { intensity: Color::Curve(_), filter: TexelFilter::Bilinear, .. } = light.kind
    else {
        panic!("a warm luminaire")
    };
    let dimmed = lamp("power = { total = \"file\", scale = 0.5 }").power;
    assert_eq!((dimmed.total, dimmed.scale), (Some(lumens), 0.5));
}

#[test]
fn the_sun_is_where_it_is_at_a_place_and_time() {
    // By NOAA's formulas, to the west of the zenith and in the east.
    let cases = [
        ("place = [48.137, 11.575]\ndate = [2026, 6, 21]\nhour = 9.5\ntimezone = 2", [39.444, 98.412]),
        ("place = [-33.87, 151.2]\ndate = [2026, 12, 5]\nhour = 17.25\ntimezone = 11", [30.541, 262.171]),
    ];
    let brightest = |keys: &str| {
        let scene = read(&format!("[[light]]\ntype = \"sun_and_sky\"\n{keys}\n"));
        let (image, mut found) = (&scene.images[0], (0, 0.0));
        for (index, texel) in image.texels().enumerate() {
            found = if texel[1] > found.1 { (index, texel[1]) } else { found };
        }
        [found.0 as u32 % image.width, found.0 as u32 / image.width]
    };
    for (keys, [elevation, azimuth]) in cases {
        let (found, expected) =
            (brightest(keys), brightest(&format!("elevation = {elevation}\nazimuth = {azimuth}")));
        // A texel is a fifth of a degree; the sun covers six, of which another may be the brightest.
        assert!((0..2).all(|k| found[k].abs_diff(expected[k]) <= 1), "{keys}: {found:?}, not {expected:?}");
    }
}

#[test]
fn d50_is_the_cies() {
    let xy = |color: &str| {
        let scene =
            read(&format!("[[light]]\ntype = \"point\"\nposition = [0, 0, 0]\nintensity = {color}\n"));
        let [x, y, z] = spectrum::observer::xyz(&scene.curves[0]);
        [x / (x + y + z), y / (x + y + z)]
    };
    let [x, y] = xy("{ illuminant = \"D50\" }");
    assert!((x - 0.3457).abs() < 2e-4 && (y - 0.3585).abs() < 2e-4, "{x} {y}");
    let [x, _] = xy("{ illuminant = \"D65\" }");
    assert!((x - 0.3127).abs() < 2e-4, "{x}");
}
