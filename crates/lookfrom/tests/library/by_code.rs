//! Scenes made by code, and pictures saved by the names of their files.

use lookfrom::prelude::*;
use lookfrom::scene::ErrorKind;
use lookfrom::scene::scene::MaterialId;

use crate::support;

fn gray(scene: &mut Scene) -> MaterialId {
    scene.material("gray", MaterialKind::Diffuse { reflectance: Color::gray(0.5) })
}

#[test]
fn a_scene_made_by_code_is_that_of_the_file_with_the_same_words() {
    let mut made = Scene::new();
    let gray = gray(&mut made);
    made.sphere([0.0, 1.0, 0.0], 1.0, gray)
        .cuboid([2.0, 0.0, 2.0], [-2.0, -0.5, -2.0], gray)
        .light(LightKind::Distant { direction: [-1.0, -2.0, -1.0].into(), intensity: Color::gray(1.0) })
        .look([0.0, 2.0, 6.0], [0.0, 1.0, 0.0], 40.0)
        .size(24, 16)
        .integrator(Integrator::Path, 2);
    let read = support::scene(
        r#"
        [camera]
        lookfrom = [0, 2, 6]
        lookat = [0, 1, 0]
        fov = 40
        [image]
        width = 24
        height = 16
        [render]
        integrator = "path"
        samples = 2
        [materials.gray]
        type = "diffuse"
        reflectance = 0.5
        [[sphere]]
        center = [0, 1, 0]
        radius = 1
        material = "gray"
        [[box]]
        min = [-2, -0.5, -2]
        max = [2, 0, 2]
        material = "gray"
        [[light]]
        type = "distant"
        direction = [-1, -2, -1]
        intensity = 1
        "#,
    );
    let picture = |scene: Scene| {
        let session = Session::of_scene(scene, &Options::default()).expect("a scene");
        session.render(&()).expect("a picture").picture.clone()
    };
    assert_eq!(picture(made), picture(read));
}

#[test]
fn a_box_with_a_corner_that_is_no_point_is_refused() {
    let nan = f64::NAN;
    for [a, b] in [[[nan, 0.0, 0.0], [1.0; 3]], [[1.0; 3], [0.0, nan, 0.0]], [[nan; 3]; 2]] {
        let mut scene = Scene::new();
        let gray = gray(&mut scene);
        let error = scene.cuboid(a, b, gray).validate().expect_err("no box");
        assert!(error.kind == ErrorKind::Invalid && error.message.contains("positions"), "{error}");
    }
}

#[test]
fn a_picture_is_saved_in_the_format_of_its_name() {
    let mut scene = Scene::new();
    let gray = gray(&mut scene);
    scene.sphere([0.0; 3], 1.0, gray).size(4, 4);
    let finished =
        Session::of_scene(scene, &Options::default()).expect("a scene").render(&()).expect("a picture");
    let file = |extension: &str| {
        std::env::temp_dir().join(format!("lookfrom-by-code-{}.{extension}", std::process::id()))
    };
    for (extension, format) in [("png", Format::Png), ("exr", Format::Exr)] {
        finished.save(file(extension)).expect("a file");
        let saved = std::fs::read(file(extension)).expect("a file");
        std::fs::remove_file(file(extension)).expect("a file");
        assert!(saved == finished.encode(format).expect("a picture"));
    }
    let refused = finished.save(file("pdf")).expect_err("no format");
    assert_eq!(refused.kind, ErrorKind::Request);
    assert!(refused.to_string().ends_with(
        ".pdf: its extension is of no format; pictures are written as .png, .jpg, .jpeg, .webp, .exr, .hdr, \
         .pfm, .ppm, .gif, .apng"
    ));
    let nowhere = file("png").join("picture.png");
    assert_eq!(finished.save(nowhere).expect_err("no such folder").kind, ErrorKind::Io);
}
