//! Constructive solid geometry: what is left has the volume that it should have, is closed, faces outward, and each part keeps
//! the material and the normals of its operand.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

use glam::{DVec3, Vec3};
use lookfrom_scene::shape::{Geometry, Mesh, Shape};
use lookfrom_scene::{Budget, Error, LoadContext, Memory, Scene, Warning, load};
use proptest::prelude::*;

fn load_with(text: &str, budget: &Budget) -> Result<(Scene, Vec<Warning>), Error> {
    let mut files = Memory([("a.toml".into(), text.as_bytes().to_vec())].into());
    let font = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide/scenes/parts/letters.ttf");
    files.0.insert("letters.ttf".into(), std::fs::read(font).expect("our own font"));
    files.0.insert("cube.obj".into(), CUBE.as_bytes().to_vec());
    let mut context = LoadContext::within(budget, &files);
    let scene = load::scene(Path::new("a.toml"), &mut context)?;
    Ok((scene, context.warnings))
}

fn read(text: &str) -> Scene {
    let (scene, warnings) =
        load_with(text, &Budget::default()).unwrap_or_else(|error| panic!("{error}\nin\n{text}"));
    assert_eq!(warnings, [], "{text}");
    scene
}

/// A cube from 0 to 1 whose sides have two materials: neither of both parts is closed by itself.
const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1
usemtl sides\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\nusemtl ends\nf 1 3 4 2\nf 5 6 8 7\n";

/// The triangles of all shapes in the world, with the normals of their corners.
fn triangles(scene: &Scene) -> Vec<([DVec3; 3], Option<[Vec3; 3]>)> {
    let of_shape = |shape: &Shape| {
        let mesh = mesh(scene, shape);
        let matrix = shape.world_from_object;
        let each = mesh.triangles.iter().map(|triangle| {
            let corners = triangle.map(|v| matrix.transform_point3(mesh.positions[v as usize].as_dvec3()));
            (corners, (!mesh.normals.is_empty()).then(|| triangle.map(|v| mesh.normals[v as usize])))
        });
        each.collect::<Vec<_>>()
    };
    scene.shapes.iter().flat_map(of_shape).collect()
}

fn mesh<'a>(scene: &'a Scene, shape: &Shape) -> &'a Mesh {
    let Geometry::Mesh(id) = shape.geometry else { panic!("{:?} is no mesh", shape.geometry) };
    &scene.meshes[id.index()]
}

/// The volume inside, by the divergence theorem.
fn volume(scene: &Scene) -> f64 {
    triangles(scene).iter().map(|([a, b, c], _)| a.dot(b.cross(*c)) / 6.0).sum()
}

/// Each edge is as often there in one direction as in the other, over all parts together.
#[track_caller]
fn is_closed(scene: &Scene) {
    let mut edges: BTreeMap<[[u64; 3]; 2], i32> = BTreeMap::new();
    let key = |p: DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    for ([a, b, c], _) in triangles(scene) {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            let (p, q) = (key(p), key(q));
            *edges.entry(if p < q { [p, q] } else { [q, p] }).or_default() += if p < q { 1 } else { -1 };
        }
    }
    assert!(!edges.is_empty());
    assert_eq!(edges.values().filter(|&&count| count != 0).count(), 0);
}

/// A solid that is a mesh.
fn solid(operation: &str, of: &str) -> String {
    solid_in_pieces(operation, of, 96)
}

fn solid_in_pieces(operation: &str, of: &str, segments: u32) -> String {
    format!("{}segments = {segments}\n", exact_solid(operation, of))
}

/// A solid that may be exact.
fn exact_solid(operation: &str, of: &str) -> String {
    format!("[[solid]]\noperation = \"{operation}\"\nof = [{of}]\n")
}

fn cuboid(min: [f64; 3], max: [f64; 3]) -> String {
    format!("{{ type = \"box\", min = {min:?}, max = {max:?} }}")
}

#[test]
fn boxes_are_exact() {
    let unit = cuboid([0.0; 3], [1.0; 3]);
    for (other, union, intersection, difference) in [
        (cuboid([0.5; 3], [1.5; 3]), 1.875, 0.125, 0.875),
        // Flush sides, a shared side, a hole from end to end, a cave, and the same box.
        (cuboid([0.5, 0.0, 0.0], [1.5, 1.0, 1.0]), 1.5, 0.5, 0.5),
        (cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]), 2.0, 0.0, 1.0),
        (cuboid([0.25, 0.25, 0.0], [0.75, 0.75, 1.0]), 1.0, 0.25, 0.75),
        (cuboid([0.25; 3], [0.75; 3]), 1.0, 0.125, 0.875),
        (unit.clone(), 1.0, 1.0, 0.0),
    ] {
        for (operation, expected) in
            [("union", union), ("intersection", intersection), ("difference", difference)]
        {
            let text = solid(operation, &format!("{unit}, {other}"));
            let (scene, warnings) = load_with(&text, &Budget::default()).expect("a scene");
            assert!((volume(&scene) - expected).abs() < 1e-12, "{text}: {}", volume(&scene));
            if expected > 0.0 {
                is_closed(&scene);
                assert_eq!(warnings, []);
            } else {
                assert!(warnings[0].message.contains("nothing is left"), "{warnings:?}");
            }
        }
    }
}

#[test]
fn curved_shapes_are_fine_enough() {
    // A circle in N pieces lacks 2π²/3N² of its area; a sphere and a torus lack about twice as much.
    let lacking = 2.0 * PI * PI / (3.0 * 96.0 * 96.0);
    for (shape, expected) in [
        ("{ type = \"sphere\", radius = 2 }", 4.0 / 3.0 * PI * 8.0),
        ("{ type = \"cylinder\", from = [1, 0, 0], to = [1, 3, 0], radius = 0.5 }", 0.75 * PI),
        ("{ type = \"cone\", from = [1, 0, 0], to = [1, 3, 0], radius = 0.5 }", 0.25 * PI),
        ("{ type = \"torus\", radius = 1, tube = 0.25 }", 2.0 * PI * PI * 0.0625),
    ] {
        let scene = read(&solid("union", shape));
        let ratio = volume(&scene) / expected;
        assert!((1.0 - 2.6 * lacking..1.0 - 0.9 * lacking).contains(&ratio), "{shape}: {ratio}");
        is_closed(&scene);
    }
    let rough = read(&solid_in_pieces("union", "{ type = \"sphere\" }", 8));
    assert_eq!(triangles(&rough).len(), 8 * 2 * 3);
}

#[test]
fn parts_keep_their_materials() {
    let materials = "[materials.red]\ndiffuse = \"red\"\n[materials.blue]\ndiffuse = \"blue\"\n";
    let of = |first: &str, second: &str, more: &str| {
        let of = format!(
            "{{ type = \"box\", min = [-1, -1, -1], max = [1, 1, 1]{first} }}, {{ type = \"sphere\", radius = 1.2{second} }}"
        );
        let scene = read(&format!("{materials}{}{more}", solid("difference", &of)));
        let by_part = |shape: &Shape| {
            let name = scene.materials[shape.material.index()].name.clone();
            // The cut is inside of the cube.
            let radii = mesh(&scene, shape).positions.iter().map(|p| p.length());
            (name, radii.fold(0.0_f32, f32::max) < 1.3)
        };
        scene.shapes.iter().map(by_part).collect::<Vec<_>>()
    };
    let (red, blue) = (", material = \"red\"", ", material = \"blue\"");
    let named = |cube: &str, cut: &str| vec![(cube.to_owned(), false), (cut.to_owned(), true)];
    assert_eq!(of(red, blue, ""), named("red", "blue"));
    assert_eq!(of(red, "", ""), named("red", "red"));
    assert_eq!(of("", blue, ""), named("default", "blue"));
    assert_eq!(of(red, blue, "material = \"blue\"\n"), named("blue", "blue"));
}

#[test]
fn normals_are_those_of_the_operands_and_face_outward() {
    let lathe =
        "{ type = \"lathe\", profile = [[0, -1.5], [0.5, -1.2], [0.6, 0.4], [0, 1.5]], scale = [1, 1, -1] }";
    let scene = read(&solid("difference", &format!("{{ type = \"sphere\" }}, {lathe}")));
    assert_eq!(scene.shapes.len(), 2);
    is_closed(&scene);
    for ([a, b, c], normals) in triangles(&scene) {
        let normals = normals.expect("normals").map(|normal| normal.as_dvec3().normalize());
        let flat = (b - a).cross(c - a);
        if flat.length() > 1e-6 {
            assert!(normals.iter().all(|normal| normal.dot(flat.normalize()) > 0.9), "{a} {normals:?}");
        }
    }
    let sphere = mesh(&scene, &scene.shapes[0]);
    for (position, normal) in sphere.positions.iter().zip(&sphere.normals) {
        assert!(position.normalize().dot(normal.normalize()) > 0.9999, "{position} {normal}");
    }
    assert!(sphere.uvs.len() == sphere.positions.len());
}

#[test]
fn solids_are_nested_and_placed() {
    let inner = "{ type = \"solid\", operation = \"union\", translate = [1, 0, 0], of = [
        { type = \"box\", min = [0, 0, 0], max = [1, 1, 1] }, { type = \"box\", min = [1, 0, 0], max = [2, 1, 1], translate = [0, 0.5, 0] }] }";
    let text = solid("intersection", &format!("{inner}, {}", cuboid([1.5, -1.0, -1.0], [9.0, 9.0, 9.0])));
    let scene = read(&format!("{text}scale = 2\ntranslate = [0, 5, 0]\n"));
    assert!((volume(&scene) / 8.0 - 1.5).abs() < 1e-9, "{}", volume(&scene));
    let bounds = scene.bounds();
    assert!((bounds.min - DVec3::new(3.0, 5.0, 0.0)).length() < 1e-6);
    is_closed(&scene);
}

#[test]
fn letters_and_models_are_operands() {
    let text = "{ type = \"text\", text = \"of\", font = \"letters.ttf\", depth = 1 }";
    let sign =
        read(&solid("difference", &format!("{}, {text}", cuboid([-1.0, -1.0, -0.5], [2.0, 2.0, 0.5]))));
    let letters = read(&solid("union", text));
    is_closed(&sign);
    is_closed(&letters);
    assert!((volume(&sign) - (9.0 - 0.5 * volume(&letters))).abs() < 1e-4);
    let model = read(&solid("difference", "{ type = \"mesh\", file = \"cube.obj\" }, { type = \"sphere\" }"));
    is_closed(&model);
    // Two materials of the file, and the cut, which has the first of them.
    assert_eq!(model.shapes.len(), 3);
    assert!((volume(&model) - (1.0 - PI / 6.0)).abs() < 1e-3);
}

#[test]
fn variables_and_keyframes_reach_into_solids() {
    let text = "[variables]\nr = 0.5\n[[solid]]\noperation = \"difference\"\nof = [
        { type = \"box\", min = [0, 0, 0], max = [\"= 2 * r\", 1, 1] },
        { type = \"box\", min = [0, 0, 0], max = [1, 1, { keyframes = [[0, 0.25], [1, 1]] }] }]\n";
    let scene = read(text);
    assert!((volume(&scene) - 0.75).abs() < 1e-6, "{}", volume(&scene));
}

#[test]
fn results_are_the_same_every_time() {
    let of = "{ type = \"sphere\" }, { type = \"torus\", radius = 1, tube = 0.3 }, { type = \"cone\", from = [0, 0, 0], to = [0, 2, 0], radius = 1 }";
    let bits = || {
        let scene = read(&solid("difference", of));
        let of_mesh = |mesh: &Mesh| format!("{:?} {:?} {:?}", mesh.positions, mesh.normals, mesh.triangles);
        scene.meshes.iter().map(of_mesh).collect::<Vec<_>>()
    };
    assert_eq!(bits(), bits());
}

#[test]
fn memory_is_counted_and_only_results_stay() {
    let of = "{ type = \"sphere\" }, { type = \"torus\", radius = 1, tube = 0.3 }";
    assert_eq!(read(&solid("union", of)).meshes.len(), 2);
    let fine = solid_in_pieces("union", of, 4096);
    let budget = Budget::new(64 << 20);
    let error = load_with(&fine, &budget).expect_err("too little memory");
    assert!(error.to_string().contains("the solid takes"), "{error}");
    assert_eq!(budget.left(), budget.limit());
}

#[test]
fn solids_of_bodies_are_exact_where_none_of_their_surfaces_are_flush() {
    let materials = "[materials.glow]\nemission = [1, 1, 1]\n";
    let ball = "{ type = \"sphere\", radius = 1.2 }";
    let block = &cuboid([-1.0; 3], [1.0; 3]);
    let rod = "{ type = \"cylinder\", from = [0, -2, 0], to = [0, 2, 0], radius = 0.3 }";
    let many: Vec<String> =
        (0..70).map(|k| format!("{{ type = \"sphere\", center = [{k}, 0, 0], radius = 0.8 }}")).collect();
    for (is_exact, of, more) in [
        (true, vec![ball, rod], ""),
        (true, vec![block, ball, "{ type = \"torus\", radius = 1, tube = 0.25, rotate = [10, 20, 30] }"], ""),
        (
            true,
            vec!["{ type = \"solid\", operation = \"union\", of = [{ type = \"sphere\" }] }", rod],
            "scale = [1, 2, 3]",
        ),
        // Only boxes: a mesh is as exact.
        (false, vec![block, &cuboid([-0.5; 3], [2.0; 3])], ""),
        // An end of the cylinder lies in a side of the box, and a sphere is there twice.
        (false, vec![block, "{ type = \"cylinder\", from = [0, 0, 0], to = [0, 1, 0], radius = 0.3 }"], ""),
        (false, vec![ball, rod, ball], ""),
        (false, vec![ball, rod], "segments = 32"),
        (false, vec![ball, "{ type = \"torus\", radius = 1, tube = 0.25, segments = 32 }"], ""),
        (false, vec![ball, "{ type = \"cone\", from = [0, 0, 0], to = [0, 2, 0], radius = 0.4 }"], ""),
        (false, vec![ball, rod], "emission = [1, 1, 1]"),
        (false, vec![ball, rod], "material = \"glow\""),
        (false, vec![ball, "{ type = \"sphere\", center = [0, 1, 0], material = \"glow\" }"], ""),
        (false, many.iter().map(String::as_str).collect(), ""),
    ] {
        let text = format!("{}{more}\n{materials}", exact_solid("difference", &of.join(", ")));
        let scene = read(&text);
        let is_surface = |shape: &Shape| matches!(shape.geometry, Geometry::SolidSurface { .. });
        assert!(scene.shapes.iter().all(|shape| is_surface(shape) == is_exact), "{text}");
        assert_eq!(scene.meshes.is_empty(), is_exact, "{text}");
    }
}

#[test]
fn nothing_is_left_of_exact_solids_either() {
    let apart = "{ type = \"sphere\" }, { type = \"sphere\", center = [5, 0, 0] }";
    let covered = "{ type = \"sphere\" }, { type = \"sphere\", radius = 2 }";
    for (operation, of) in [("intersection", apart), ("difference", covered)] {
        let (scene, warnings) = load_with(&exact_solid(operation, of), &Budget::default()).expect("a scene");
        assert!(warnings[0].message.contains("nothing is left"), "{warnings:?}");
        assert!(scene.shapes.is_empty());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// |A ∪ B| = |A| + |B| − |A ∩ B|, and |A − B| = |A| − |A ∩ B|.
    #[test]
    fn volumes_add_up(center in prop::array::uniform3(-1.0..1.0), turn in prop::array::uniform3(0.0..90.0), size in 0.2..1.5) {
        let a = "{ type = \"torus\", radius = 0.8, tube = 0.35, segments = 24 }";
        let b = format!("{{ type = \"box\", min = [-0.5, -0.5, -0.5], max = [0.5, 0.5, 0.5], scale = {size:?}, rotate = {turn:?}, translate = {center:?} }}");
        let of = |operation: &str, of: &str| {
            let (scene, _) = load_with(&solid(operation, of), &Budget::default()).expect("a scene");
            volume(&scene)
        };
        let both = format!("{a}, {b}");
        let [whole, common, rest] = ["union", "intersection", "difference"].map(|operation| of(operation, &both));
        let [a, b] = [of("union", a), of("union", &b)];
        prop_assert!((whole - (a + b - common)).abs() < 1e-5, "{whole} {a} {b} {common}");
        prop_assert!((rest - (a - common)).abs() < 1e-5, "{rest} {a} {common}");
    }
}

/// A mesh of these tetrahedra, given inline.
fn tetrahedra(points: &[[u8; 3]], corners: &[[usize; 4]], scale: f64) -> String {
    let faces = |&[a, b, c, d]: &[usize; 4]| [[a, c, b], [a, b, d], [a, d, c], [b, c, d]];
    let triangles: Vec<[usize; 3]> = corners.iter().flat_map(faces).collect();
    format!("{{ type = \"mesh\", positions = {points:?}, triangles = {triangles:?}, scale = {scale:?} }}")
}

#[test]
fn what_crosses_itself_is_united() {
    // Two tetrahedra, one of which is the other turned about its middle: the star has 12/8 of the volume.
    let points = [[0, 0, 0], [2, 2, 0], [2, 0, 2], [0, 2, 2], [2, 2, 2], [0, 0, 2], [0, 2, 0], [2, 0, 0]];
    let one = volume(&read(&solid("union", &tetrahedra(&points, &[[0, 1, 2, 3]], 1.0))));
    let star = read(&solid("union", &tetrahedra(&points, &[[0, 1, 2, 3], [4, 6, 5, 7]], 1.0)));
    is_closed(&star);
    assert!((one - 8.0 / 3.0).abs() < 1e-9 && (volume(&star) - 1.5 * one).abs() < 1e-9, "{}", volume(&star));
}

/// The points of tetrahedra, and which four of them each has.
type Tetrahedra<'a> = (&'a [[u8; 3]; 8], &'a [[usize; 4]]);

/// A closed result or an error for each operation on tetrahedra and a box.
#[track_caller]
fn is_survived((points, corners): Tetrahedra<'_>, scale: f64) {
    let of = format!("{}, {}", tetrahedra(points, corners, scale), cuboid([0.5; 3], [1.5; 3]));
    for operation in ["union", "intersection", "difference"] {
        match load_with(&solid(operation, &of), &Budget::default()) {
            Ok((scene, _)) if scene.shapes.is_empty() => {}
            Ok((scene, _)) => is_closed(&scene),
            Err(error) => assert!(error.to_string().contains("this mesh"), "{error}"),
        }
    }
}

#[test]
fn results_that_were_not_closed_are_closed() {
    let cases: [(Tetrahedra<'_>, f64); 3] = [
        (
            (
                &[[2, 3, 1], [1, 2, 2], [1, 3, 2], [1, 2, 0], [2, 0, 1], [0, 0, 0], [0, 1, 3], [0, 0, 0]],
                &[[2, 4, 3, 6], [2, 6, 1, 0], [0, 5, 3, 6]],
            ),
            1e15,
        ),
        (
            (
                &[[0, 0, 2], [1, 1, 2], [2, 0, 3], [0, 1, 0], [0, 0, 0], [0, 2, 2], [1, 0, 1], [0, 0, 3]],
                &[[2, 0, 5, 7], [1, 0, 3, 6]],
            ),
            1.0,
        ),
        (
            (
                &[[0, 0, 0], [1, 0, 0], [0, 2, 1], [1, 0, 1], [0, 2, 2], [2, 0, 2], [2, 1, 3], [2, 0, 0]],
                &[[4, 3, 6, 2], [6, 2, 5, 4], [2, 0, 7, 3]],
            ),
            1.0,
        ),
    ];
    for (tetrahedra, scale) in cases {
        is_survived(tetrahedra, scale);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// Surfaces that touch, cross and cover themselves: a closed result or an error, never a panic.
    #[test]
    fn any_mesh_is_survived(
        points in prop::array::uniform8(prop::array::uniform3(0_u8..4)),
        corners in prop::collection::vec(prop::array::uniform4(0_usize..8), 1..6),
        scale in prop::sample::select(vec![1e-30, 1e-9, 1.0, 1e15, 1e37]),
    ) {
        is_survived((&points, &corners), scale);
    }
}
