//! Sensors of Mitsuba, and its integrators.

use glam::{DMat4, DVec3};
use lookfrom_scene::camera::{Projection, View};
use lookfrom_scene::settings::{FilterShape, Integrator, PixelBounds, Sampler};
use lookfrom_scene::{ErrorKind, Scene};

use super::{error, scene, told};

#[test]
fn sensors_films_and_integrators_are_settings() {
    let read = scene(
        r#"<integrator type="moment"><integrator type="volpath"><integer name="max_depth" value="8"/></integrator></integrator>
        <sensor type="thinlens"><float name="fov" value="60"/><float name="aperture_radius" value="0.1"/>
            <float name="focus_distance" value="3"/>
            <film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/>
                <integer name="crop_offset_x" value="10"/><integer name="crop_width" value="20"/>
                <rfilter type="mitchell"/></film>
            <sampler type="multijitter"><integer name="sample_count" value="16"/></sampler></sensor>"#,
    );
    assert_eq!((read.render.integrator, read.render.depth, read.render.media), (Integrator::Path, 7, true));
    assert_eq!((read.render.samples, read.render.sampler), (16, Sampler::Sobol));
    assert_eq!(read.image.crop, Some(PixelBounds { x0: 10, y0: 0, x1: 30, y1: 100 }));
    assert!(matches!(read.image.filter.shape, FilterShape::Mitchell { .. }));
    let camera = read.camera.expect("a camera");
    let Projection::Perspective { fov } = camera.projection else { panic!("{:?}", camera.projection) };
    // tan 30° along x is half of that along y.
    assert!(((0.5 * fov).to_radians().tan() - 0.5 * 30.0_f64.to_radians().tan()).abs() < 1e-12);
    assert_eq!(camera.view, View::Matrix(DMat4::IDENTITY));
    assert_eq!(camera.lens.map(|lens| (lens.radius, lens.focus_distance)), Some((0.1, 3.0)));
    // Mitsuba's own defaults: 38.1848° along x, for 768 × 576.
    let plain = scene("<integrator type=\"direct\"/><sensor type=\"perspective\"/>");
    assert_eq!(
        (plain.image.width, plain.image.height, plain.render.samples, plain.render.depth),
        (768, 576, 4, 1)
    );
    let Some(Projection::Perspective { fov }) = plain.camera.map(|camera| camera.projection) else {
        panic!()
    };
    let along_x = 2.0 * ((0.5 * fov).to_radians().tan() * 768.0 / 576.0).atan().to_degrees();
    assert!((along_x - 38.1848).abs() < 1e-4, "{along_x}");
    let moved = scene(
        "<sensor type=\"perspective\"><float name=\"principal_point_offset_x\" value=\"0.25\"/>\
         <film type=\"hdrfilm\"><integer name=\"width\" value=\"10\"/><integer name=\"height\" value=\"10\"/></film></sensor>",
    );
    assert_eq!(moved.camera.and_then(|camera| camera.window).map(|window| window.x), Some([-0.5, 1.5]));
    let flat = scene("<sensor type=\"orthographic\"/>").camera.expect("a camera");
    assert_eq!(flat.projection, Projection::Orthographic { height: 2.0 * 576.0 / 768.0 });
    assert_eq!(scene("<integrator type=\"path\"/>").render.depth, 1000);
}

#[test]
fn integrators_for_derivatives_make_pictures_of_others() {
    let render = |integrator: &str| told(integrator).0.render;
    let adjoint = render("<integrator type=\"prbvolpath\"/>");
    assert_eq!((adjoint.integrator, adjoint.depth, adjoint.media), (Integrator::Path, 5, true));
    let direct = render("<integrator type=\"direct_projective\"/>");
    assert_eq!((direct.integrator, direct.depth), (Integrator::Path, 1));
    assert_eq!(render("<integrator type=\"depth\"/>").integrator, Integrator::Depth);
}

#[test]
fn irradiance_is_measured_on_the_shape_that_has_the_sensor() {
    let meter = |size: u32| {
        format!(
            r#"<sensor type="irradiancemeter"><sampler type="independent"><integer name="sample_count" value="32"/></sampler>
            <film type="hdrfilm"><integer name="width" value="{size}"/><integer name="height" value="1"/></film></sensor>"#
        )
    };
    let surface = |read: &Scene| match &read.camera.as_ref().expect("a camera").projection {
        Projection::Irradiance { surface } => surface.clone(),
        other => panic!("{other:?}"),
    };
    let one = meter(1);
    let (read, warnings) = told(&format!(
        r#"<shape type="sphere"/><shape type="cube">{one}</shape><shape type="sphere" id="ball">{}</shape>"#,
        meter(3)
    ));
    assert_eq!(surface(&read), "measured surface");
    assert_eq!(read.shapes[1].name.as_deref(), Some("measured surface"));
    assert_eq!((read.image.width, read.image.height, read.render.samples), (1, 1, 32));
    assert!(
        warnings.len() == 1 && warnings[0].ends_with("only the first sensor is rendered"),
        "{warnings:?}"
    );

    let (read, warnings) = told(&format!(r#"<shape type="sphere" id="ball">{}</shape>"#, meter(3)));
    assert_eq!((surface(&read), read.image.width), ("ball".to_owned(), 3));
    assert!(warnings.len() == 1 && warnings[0].contains("measures the whole shape"), "{warnings:?}");

    // Sensors at the top level come first.
    let (read, warnings) =
        told(&format!(r#"<shape type="sphere">{one}</shape><sensor type="perspective"/>"#));
    assert!(matches!(read.camera.expect("a camera").projection, Projection::Perspective { .. }));
    assert!(
        warnings.len() == 1 && warnings[0].ends_with("only the first sensor is rendered"),
        "{warnings:?}"
    );

    assert!(error(&one).message.contains("a part of the shape"));
    let other = error(r#"<shape type="sphere"><sensor type="perspective"/></shape>"#);
    assert_eq!(other.kind, ErrorKind::Unsupported);
    let instance = error(&format!(
        r#"<shape type="instance"><ref id="group"/>{one}</shape><shape type="shapegroup" id="group"><shape type="sphere"/></shape>"#
    ));
    assert!(instance.message.contains("an instance"), "{instance}");

    // Only that of the first of two shapes without a name.
    let (read, _) = told(&format!(r#"<shape type="sphere">{one}</shape><shape type="sphere">{one}</shape>"#));
    assert_eq!(read.shapes_named("measured surface").count(), 1);
}

#[test]
fn distant_sensors_see_a_point_from_outside_of_the_scene() {
    let sensor = |direction: &str, target: &str| {
        format!(r#"<shape type="sphere"/><sensor type="distant">{direction}{target}</sensor>"#)
    };
    let point = r#"<point name="target" x="0.2" y="0" z="0.1"/>"#;
    let seen = |direction: &str| {
        let camera = scene(&sensor(direction, point)).camera.expect("a camera");
        assert!(matches!(camera.projection, Projection::Perspective { fov } if fov < 1e-3));
        let View::Matrix(matrix) = camera.view else { panic!("{:?}", camera.view) };
        (matrix.w_axis.truncate(), matrix.z_axis.truncate())
    };
    let target = DVec3::new(0.2, 0.0, 0.1);
    let (from, along) = seen(r#"<vector name="direction" x="0.5" y="-1" z="0"/>"#);
    assert!((along - DVec3::new(0.5, -1.0, 0.0).normalize()).length() < 1e-12, "{along}");
    // Twice the radius of the scene's bounds.
    assert!((from - target + 2.0 * 3.0_f64.sqrt() * along).length() < 1e-12, "{from}");
    let turned = seen(
        r#"<transform name="to_world"><lookat origin="0,0,0" target="0.5,-1,0" up="0,0,1"/></transform>"#,
    );
    assert!((turned.0 - from).length() < 1e-12 && (turned.1 - along).length() < 1e-12, "{turned:?}");

    let direction = r#"<vector name="direction" x="0" y="0" z="0"/>"#;
    assert!(error(&sensor(direction, point)).message.contains("other than 0"));
    for target in ["", r#"<shape type="rectangle" name="target"/>"#] {
        let error = error(&sensor("", target));
        assert_eq!(error.kind, ErrorKind::Unsupported, "{error}");
    }
}
