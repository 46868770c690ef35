//! Emitters of Mitsuba.

use std::f32::consts::FRAC_1_PI;

use glam::{DMat4, DVec3};
use lookfrom_scene::ErrorKind;
use lookfrom_scene::camera::Projection;
use lookfrom_scene::light::{Edge, LightKind, MapRows, Projected, Sky};
use lookfrom_scene::material::{Color, MaterialKind, Scalar};
use lookfrom_scene::settings::{Background, Integrator, Layers};
use lookfrom_scene::texture::{TexelFilter, TextureKind};

use super::{error, scene, told};

#[test]
fn light_that_paths_cannot_find_is_warned_of() {
    let (read, warnings) = told(
        "<shape type=\"rectangle\"><emitter type=\"directionalarea\"><rgb name=\"radiance\" value=\"1\"/></emitter></shape>",
    );
    assert!(read.shapes[0].emission.is_none());
    assert!(matches!(&warnings[..], [warning] if warning.contains("directionalarea")), "{warnings:?}");
}

#[test]
fn emitters_have_the_intensities_of_whitted() {
    let read = scene(
        r#"<emitter type="point"><point name="position" value="1 2 3"/><rgb name="intensity" value="6"/></emitter>
        <emitter type="directional"><vector name="direction" value="0 0 -1"/></emitter>
        <emitter type="envmap"><string name="filename" value="p.pfm"/><float name="scale" value="2"/></emitter>
        <emitter type="constant"><spectrum name="radiance" value="0.5"/></emitter>
        <shape type="sphere"><emitter type="area"><spectrum name="radiance" value="300:2, 900:2"/></emitter></shape>"#,
    );
    let scales: Vec<f32> = read.lights.iter().map(|light| light.power.scale).collect();
    assert_eq!(scales[..3], [FRAC_1_PI, FRAC_1_PI, 1.0]);
    // A constant spectrum of light is one of equal energy: in Mitsuba [0.602, 0.474, 0.454].
    assert!((scales[3] - 0.5).abs() < 1e-6, "{}", scales[3]);
    assert!(
        matches!(read.lights[0].kind, LightKind::Point { intensity, .. } if intensity == Color::gray(6.0))
    );
    let LightKind::Environment {
        sky: Sky::Image { scale, world_from_light, rows: MapRows::ToPoles, .. },
        ..
    } = read.lights[2].kind
    else {
        panic!("{:?}", read.lights[2].kind)
    };
    // The middle of our pictures is −z, the left edge of Mitsuba's is.
    assert_eq!(world_from_light.transform_vector3(DVec3::NEG_Z), DVec3::Z);
    assert_eq!(scale, [2.0; 3]);
    let emission = read.shapes[0].emission.expect("an area light");
    assert!(matches!(emission.radiance, Color::Curve(_)) && (emission.power.scale - 2.0).abs() < 1e-5);
    // An emitter without a BSDF is black.
    let black = &read.materials[read.shapes[0].material.index()];
    assert_eq!(black.kind, MaterialKind::Diffuse { reflectance: Color::BLACK });
}

#[test]
fn spots_and_projectors_have_pictures_and_linear_edges() {
    let read = scene(
        r#"<emitter type="spot"><float name="cutoff_angle" value="40"/></emitter>
        <emitter type="spot"><float name="cutoff_angle" value="30"/><float name="beam_width" value="10"/>
            <rgb name="intensity" value="2 3 4"/>
            <texture name="texture" type="bitmap"><string name="filename" value="p.pfm"/></texture></emitter>
        <emitter type="projector"><float name="fov" value="60"/><float name="scale" value="5"/>
            <texture name="irradiance" type="bitmap"><string name="filename" value="p.pfm"/>
            <string name="filter_type" value="nearest"/></texture></emitter>
        <emitter type="projector"><rgb name="irradiance" value="1 2 3"/></emitter>"#,
    );
    let LightKind::Spot { cone_angle: 40.0, inner_angle: 30.0, edge: Edge::Linear, .. } = read.lights[0].kind
    else {
        panic!("{:?}", read.lights[0])
    };
    let LightKind::Projection { image, filter, quantity, cone, fov, world_from_light, .. } =
        read.lights[1].kind
    else {
        panic!("{:?}", read.lights[1])
    };
    // The colour of the light is in its picture, whose rows run up.
    assert_eq!(read.images[image.index()].texel(0), [1.0, 1.5, 2.0]);
    assert_eq!(
        (filter, quantity, cone, fov),
        (TexelFilter::Bilinear, Projected::Intensity, Some([30.0, 10.0]), 60.0)
    );
    assert_eq!(world_from_light.transform_vector3(DVec3::ONE), DVec3::new(1.0, -1.0, 1.0));
    assert_eq!(read.lights[1].power.scale, FRAC_1_PI);
    let LightKind::Projection { filter, quantity, cone: None, fov, world_from_light, .. } =
        read.lights[2].kind
    else {
        panic!("{:?}", read.lights[2])
    };
    assert_eq!((filter, quantity), (TexelFilter::Nearest, Projected::Irradiance));
    assert!((fov - 60.0).abs() < 1e-4 && read.lights[2].power.scale == 5.0, "{fov}");
    assert_eq!(world_from_light.transform_vector3(DVec3::ONE), DVec3::new(-1.0, 1.0, 1.0));
    let LightKind::Projection { image, .. } = read.lights[3].kind else { panic!("{:?}", read.lights[3]) };
    assert_eq!(read.images[image.index()].texel(0), [1.0, 2.0, 3.0]);
    assert!(error("<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"90\"/><texture name=\"texture\" type=\"bitmap\"/></emitter>").message.contains("cutoff_angle"));
}

#[test]
fn skies_blackbodies_and_old_integrators_are_understood() {
    let (read, warnings) = told(
        r#"<integrator type="aov"><string name="aovs" value="d:depth"/><integrator type="bdpt"/></integrator>
        <sensor type="radiancemeter"><film type="ldrfilm"><integer name="width" value="1"/>
            <integer name="height" value="1"/></film><sampler type="sobol"/></sensor>
        <emitter type="sunsky"><vector name="sun_direction" value="0 1 1"/></emitter>
        <emitter type="constant"><spectrum name="radiance" type="blackbody"><float name="temperature" value="5000"/></spectrum></emitter>
        <shape type="merge"><shape type="cube"/><shape type="sphere"/></shape>"#,
    );
    assert_eq!(
        (read.shapes.len(), read.image.layers, read.render.integrator),
        (2, Layers::Geometry, Integrator::Path)
    );
    assert!(
        matches!(read.camera.expect("a camera").projection, Projection::Perspective { fov } if fov < 1e-3)
    );
    let LightKind::Environment { sky: Sky::Octahedral { world_from_light, .. }, .. } = read.lights[0].kind
    else {
        panic!("{:?}", read.lights[0])
    };
    assert_eq!(world_from_light, DMat4::IDENTITY);
    // Planck's law in W/(m² sr nm), by the luminous efficiencies of 1 nm steps.
    let luminance = f64::from(read.lights[1].power.scale);
    assert!((luminance / 12_579.29 - 1.0).abs() < 2e-3, "{luminance}");
    assert_eq!(warnings.len(), 2, "{warnings:?}");
}

#[test]
fn the_sun_is_told_by_place_and_time() {
    let picture = |elements: &str| {
        let (read, warnings) = told(&format!("<emitter type=\"sunsky\">{elements}</emitter>"));
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        read.images[0].clone()
    };
    let default = picture("");
    let told = picture("<vector name=\"sun_direction\" value=\"0.0513854 0.691748 0.720308\"/>");
    let differs = default.texels().zip(told.texels()).filter(|(a, b)| (a[1] / b[1] - 1.0).abs() > 0.01);
    // The rim of the sun.
    assert!(differs.count() < 64);
    let morning = picture("<float name=\"hour\" value=\"9\"/>");
    assert_ne!(morning.texels().collect::<Vec<_>>(), default.texels().collect::<Vec<_>>());
    let wrong = error("<emitter type=\"sunsky\"><integer name=\"month\" value=\"13\"/></emitter>");
    assert_eq!(wrong.kind, ErrorKind::Invalid);
}

#[test]
fn masks_do_not_thin_what_emitters_emit() {
    let lamp = |opacity: &str| {
        let mask = format!("<bsdf type=\"mask\">{opacity}<bsdf type=\"diffuse\"/></bsdf>");
        let emitter = "<emitter type=\"area\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter>";
        let read = scene(&format!("<shape type=\"rectangle\">{mask}{emitter}</shape>"));
        let emission = read.shapes[0].emission.expect("a lamp");
        (read, emission)
    };
    let (_, quarter) = lamp("<float name=\"opacity\" value=\"0.25\"/>");
    assert_eq!((quarter.radiance, quarter.power.scale), (Color::Value([1.0, 2.0, 3.0]), 4.0));
    let (read, checks) = lamp("<texture name=\"opacity\" type=\"checkerboard\"/>");
    let Color::Texture(id) = checks.radiance else { panic!("{checks:?}") };
    let TextureKind::Scale { color, by: Scalar::Texture(by) } = read.textures[id.index()].kind else {
        panic!("{:?}", read.textures)
    };
    assert_eq!(color, Color::Value([1.0, 2.0, 3.0]));
    let opacity = read.shapes[0].alpha.expect("an opacity");
    assert_eq!(read.textures[by.index()].kind, TextureKind::Quotient { a: Scalar::Value(1.0), b: opacity });
}

#[test]
fn hidden_emitters_are_seen_by_no_camera() {
    let hidden =
        scene("<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>");
    assert!(hidden.render.hide_lights);
    assert_eq!(hidden.image.background, Background::Transparent);
}
