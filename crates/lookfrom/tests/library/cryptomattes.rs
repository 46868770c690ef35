//! Cryptomattes: the names and the parts of pixels that they cover, where both are known.

use std::collections::BTreeMap;

use lookfrom::render::{MOST_MATTE_SAMPLES, Renderer};
use lookfrom_scene::Scene;
use lookfrom_scene::settings::{Background, CryptomatteKind, PixelBounds};

use crate::support::{Compiled, own_scene, scene};

const BOTH: [CryptomatteKind; 2] = [CryptomatteKind::Object, CryptomatteKind::Material];

fn renderer(mut scene: Scene) -> Renderer {
    scene.image.cryptomattes = BOTH.to_vec();
    Compiled::new(scene).renderer()
}

/// The coverage of a pixel, by name.
fn coverage(scene: &Scene, kind: CryptomatteKind, pixel: usize) -> BTreeMap<String, f32> {
    let mattes = renderer(scene.clone()).cryptomattes(64);
    let matte = mattes.iter().find(|matte| matte.kind() == kind).expect("it is asked for");
    matte.coverage(pixel).map(|(name, part)| (name.to_owned(), part)).collect()
}

/// Four pixels of a parallel camera at squares of a size of 1, in the plane z = 0.
fn squares(more: &str) -> Scene {
    let text = r#"
        [camera]
        projection = "orthographic"
        height = 2
        lookfrom = [1, 1, 5]
        lookat = [1, 1, 0]
        [image]
        width = 2
        height = 2
        filter = "box"
        [materials.red]
        type = "diffuse"
        reflectance = "red"
        [materials.blue]
        type = "diffuse"
        reflectance = "blue"
        [objects.tile]
        quad = [{ corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0], material = "red" }]
    "#;
    scene(&format!("{text}\n{more}"))
}

fn assert_covers(found: &BTreeMap<String, f32>, expected: &[(&str, f32)]) {
    let names: Vec<_> = found.keys().map(String::as_str).collect();
    let expected_names: Vec<_> = expected.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, expected_names);
    for (name, part) in expected {
        // Of 64 samples in 8 × 8 strata.
        assert!((found[*name] - part).abs() < 1.0 / 16.0, "{name}: {} for {part}", found[*name]);
    }
}

#[test]
fn instances_are_objects_with_the_materials_that_they_show() {
    let scene = squares(
        r#"
        [[instance]]
        object = "tile"
        [[instance]]
        object = "tile"
        name = "mine"
        translate = [1, 0, 0]
        material = "blue"
        [[instance]]
        object = "tile"
        translate = [0.5, 1, 0]
        "#,
    );
    let objects = |pixel| coverage(&scene, CryptomatteKind::Object, pixel);
    // From the top left.
    assert_covers(&objects(0), &[("tile 3", 0.5)]);
    assert_covers(&objects(1), &[("tile 3", 0.5)]);
    assert_covers(&objects(2), &[("tile 1", 1.0)]);
    assert_covers(&objects(3), &[("mine", 1.0)]);
    let materials = |pixel| coverage(&scene, CryptomatteKind::Material, pixel);
    assert_covers(&materials(2), &[("red", 1.0)]);
    assert_covers(&materials(3), &[("blue", 1.0)]);
}

#[test]
fn pieces_of_a_mesh_are_objects() {
    let scene = squares(
        r#"
        [[mesh]]
        name = "whole"
        positions = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]]
        triangles = [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]
        pieces = [{ name = "left", first = 1 }, { name = "right", first = 2 }]
        material = "red"
        "#,
    );
    let objects = |pixel| coverage(&scene, CryptomatteKind::Object, pixel);
    assert_covers(&objects(2), &[("left", 0.5), ("whole", 0.5)]);
    assert_covers(&objects(3), &[("right", 1.0)]);
    assert_covers(&coverage(&scene, CryptomatteKind::Material, 3), &[("red", 1.0)]);
    // What has no triangles under its own name is no object.
    let scene = squares(
        r#"
        [[mesh]]
        name = "whole"
        positions = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
        triangles = [[0, 1, 2]]
        pieces = [{ name = "part", first = 0 }]
        "#,
    );
    let names = Compiled::new(scene).renderer().world().objects().names().to_vec();
    assert_eq!(names, ["part"]);
}

#[test]
fn fractional_alpha_covers_in_part() {
    let scene = squares(
        r#"
        [[quad]]
        name = "veil"
        corner = [0, 0, 1]
        edge_u = [2, 0, 0]
        edge_v = [0, 2, 0]
        alpha = 0.25
        material = "blue"
        [[instance]]
        object = "tile"
        [[sphere]]
        center = [1.5, 1.5, 0]
        radius = 0.25
        material = "red"
        "#,
    );
    let objects = |pixel| coverage(&scene, CryptomatteKind::Object, pixel);
    assert_covers(&objects(0), &[("veil", 0.25)]);
    assert_covers(&objects(2), &[("tile", 0.75), ("veil", 0.25)]);
    // Without names of their own, shapes have labels, without the place in the file, which another machine has elsewhere.
    let sphere = 0.75 * std::f32::consts::PI / 16.0;
    assert_covers(&objects(1), &[("red sphere", sphere), ("veil", 0.25)]);
    assert_covers(&coverage(&scene, CryptomatteKind::Material, 2), &[("blue", 0.25), ("red", 0.75)]);
}

#[test]
fn all_names_together_cover_what_the_picture_has_as_alpha() {
    for name in [
        "whitted1980.toml",
        "instances.toml",
        "still-life.toml",
        "../docs/guide/scenes/camera-lens.toml",
        "../docs/guide/scenes/camera-orthographic.toml",
        "../docs/guide/scenes/motion-blur.toml",
    ] {
        let mut scene = own_scene(name);
        (scene.image.width, scene.image.height) = (40, 30);
        scene.image.crop = Some(PixelBounds { x0: 5, y0: 2, x1: 38, y1: 29 });
        scene.image.background = Background::Transparent;
        scene.render.samples = 5;
        let renderer = renderer(scene);
        let picture = renderer.render(Some(2), &()).unwrap().film.picture();
        for matte in renderer.cryptomattes(5) {
            for (pixel, alpha) in picture.alpha.iter().enumerate() {
                let covered: f32 = matte.coverage(pixel).map(|(_, part)| part).sum();
                assert!((covered - alpha).abs() < 1e-5, "{name}, pixel {pixel}: {covered} for {alpha}");
            }
        }
    }
}

#[test]
fn no_more_samples_are_traced_than_make_a_difference() {
    let renderer = renderer(squares("[[instance]]\nobject = \"tile\"\ntranslate = [0.3, 0.1, 0]"));
    let most = renderer.cryptomattes(MOST_MATTE_SAMPLES);
    assert_eq!(most, renderer.cryptomattes(1_000_000));
    assert_ne!(most, renderer.cryptomattes(MOST_MATTE_SAMPLES / 2 - 1));
    let nobody = Compiled::new(squares("[[instance]]\nobject = \"tile\"")).renderer();
    assert!(nobody.cryptomattes(4).is_empty());
}
