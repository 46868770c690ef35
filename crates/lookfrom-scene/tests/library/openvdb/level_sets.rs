//! Level sets: the surface where the distance is zero.

use std::collections::HashMap;

use glam::Vec3;
use lookfrom_scene::scene::{Scene, SourceFormat};
use lookfrom_scene::shape::{Geometry, Mesh};

use super::*;

/// Half the width of the band of cells that know their distance.
const BAND: f32 = 3.0;

/// A level set of a distance: leaves around its surface, tiles of the background's negative inside.
fn level_set(name: &'static str, distance: impl Fn(Vec3) -> f32) -> Draft {
    let mut draft = Draft { class: "level set", background: BAND, ..Draft::new(name) };
    for place in 0..1000 {
        let first = [place % 10, place / 10 % 10, place / 100].map(|brick| 8 * brick - 40);
        let at = |index: i32| IVec3::from_array(first) + IVec3::new(index / 64, index / 8 % 8, index % 8);
        let cells: Vec<Voxel> = (0..512)
            .map(|index| distance(at(index).as_vec3()))
            .map(|distance| (distance.clamp(-BAND, BAND), distance.abs() < BAND))
            .collect();
        if cells.iter().any(|cell| cell.1) {
            draft.leaves.insert(first, cells);
        } else if cells[0].0 < 0.0 {
            draft.tiles[2].insert(first, (-BAND, false));
        }
    }
    draft
}

fn scene_of(bytes: Vec<u8>) -> (Result<Scene>, Vec<String>) {
    let files = Memory([(PathBuf::from("a.vdb"), bytes)].into());
    let mut context = LoadContext::new(&files);
    let scene = load::scene(Path::new("a.vdb"), &mut context);
    (scene, context.warnings.into_iter().map(|warning| warning.message).collect())
}

/// The volume inside of a closed mesh, of which each edge has one triangle on either side.
fn inside(mesh: &Mesh) -> f64 {
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|turns| *turns == 0), "a closed surface with one side outside");
    let corner = |index: u32| mesh.positions[index as usize].as_dvec3();
    mesh.triangles.iter().map(|t| t.map(corner)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

#[test]
fn a_ball_is_a_closed_mesh_near_its_sphere() {
    let (center, radius) = (Vec3::new(0.3, -1.2, 2.1), 25.0_f32);
    let draft = level_set("ball", |p| p.distance(center) - radius);
    assert!(!draft.tiles[2].is_empty());
    let draft = Draft { map: ("UniformScaleTranslateMap", scale_and_offset(0.5, 10.0)), ..draft };
    let (scene, warnings) = scene_of(file(std::slice::from_ref(&draft)));
    let scene = scene.expect("a model");
    assert_eq!((scene.source_format, warnings.len()), (SourceFormat::Model, 0));
    let [shape] = &*scene.shapes else { panic!("one shape") };
    let Geometry::Mesh(mesh) = shape.geometry else { panic!("a mesh") };
    assert_eq!(shape.name.as_deref(), Some("ball"));
    assert_eq!(shape.world_from_object.transform_point3(DVec3::ZERO), DVec3::splat(10.0));
    let mesh = &scene.meshes[mesh.index()];
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        let out = *position - center;
        assert!((out.length() - radius).abs() < 0.02, "{position}");
        assert!(normal.dot(out.normalize()) > 0.9995, "{position} {normal}");
    }
    let expected = 4.0 / 3.0 * std::f64::consts::PI * f64::from(radius).powi(3);
    let volume = inside(mesh);
    assert!((volume / expected - 1.0).abs() < 2e-3, "{volume} {expected}");

    // The same grid in NanoVDB's format.
    let sketch = nano::Sketch { name: "ball", class: 1, ..as_nano(&draft) };
    let (nano, _) = scene_of(nano::file(0, &[sketch]));
    let nano = nano.expect("a model");
    assert_eq!((&nano.meshes[0].positions, &nano.meshes[0].triangles), (&mesh.positions, &mesh.triangles));
}

/// The numbers of a map of scale and translation: both, the size of cells, and inverses of the scale.
fn scale_and_offset(scale: f64, offset: f64) -> Vec<f64> {
    let cube = |value: f64| [value; 3];
    [cube(offset), cube(scale), cube(scale), cube(1.0 / scale), cube(1.0 / scale / scale), cube(0.5 / scale)]
        .concat()
}

#[test]
fn surfaces_at_the_bounds_are_closed() {
    // Negative up to the bounds, and thin parts that are not resolved.
    let slab = level_set("slab", |p| p.x.abs().max((p.y - 0.5).abs() - 0.4) - 12.0 + 0.1 * p.z);
    let mut noise = Draft { class: "level set", background: 1.0, ..Draft::new("noise") };
    let mut dice = Dice(7);
    for first in [[0; 3], [8, 0, 0], [0, 8, 8]] {
        let cells = (0..512).map(|_| (dice.below(3) as f32 - 0.7, true)).collect();
        noise.leaves.insert(first, cells);
    }
    for draft in [slab, noise] {
        let (scene, _) = scene_of(file(&[draft]));
        assert!(inside(&scene.expect("a model").meshes[0]) > 100.0);
    }
}

#[test]
fn tiles_have_surfaces_where_others_begin() {
    // A block of two tiles of 128³ cells, in bounds that are wider on all sides.
    let mut draft = Draft { class: "level set", background: 1.0, ..Draft::new("block") };
    draft.tiles[1].insert([0; 3], (-1.0, true));
    draft.tiles[1].insert([128, 0, 0], (-1.0, false));
    draft.tiles[2].insert([-8; 3], (1.0, true));
    draft.tiles[2].insert([256, 128, 128], (1.0, true));
    let (scene, _) = scene_of(file(&[draft]));
    let mesh = &scene.expect("a model").meshes[0];
    assert_eq!(mesh.triangles.len(), 2 * (2 * 128 * 128 + 4 * 256 * 128));
    // Along its edges a quarter of a cell is cut off, at its corners a little more.
    let (volume, expected) = (inside(mesh), 256.0 * 128.0 * 128.0 - 0.25 * 4.0 * (256.0 + 128.0 + 128.0));
    assert!((volume - expected).abs() < 4.0, "{volume} {expected}");
}

#[test]
fn level_sets_are_models_and_densities_are_not() {
    let ball = |name| level_set(name, |p| p.length() - 9.0);
    let mut smoke = Draft::new("density");
    smoke.leaves.insert([0; 3], vec![(1.0, true); 512]);
    // A level set beside densities is not shown, and said to be there.
    let (scene, warnings) = scene_of(file(&[ball("ball"), smoke.clone()]));
    assert_eq!(scene.expect("smoke").media.len(), 1);
    assert!(warnings[0].contains("nothing of \"ball\""), "{warnings:?}");
    // Several are parts of one model; without a surface there is a warning.
    let nothing = level_set("nothing", |p| p.length() + 1.0);
    let (scene, warnings) = scene_of(file(&[ball("a"), ball("b"), nothing]));
    assert_eq!(scene.expect("a model").shapes.len(), 2);
    assert_eq!(warnings, ["the level set \"nothing\" is nowhere negative: it has no surface"]);

    let text = "[[mesh]]\nfile = \"a.vdb\"\n";
    let of = |bytes: Vec<u8>| {
        let texts = [(PathBuf::from("s.toml"), text.into()), (PathBuf::from("a.vdb"), bytes)];
        load::scene(Path::new("s.toml"), &mut LoadContext::new(&Memory(texts.into())))
    };
    assert_eq!(of(file(&[ball("ball")])).expect("a scene").shapes.len(), 1);
    assert_eq!(of(file(&[smoke])).expect_err("no model").message, "a.vdb: a volume is no model");
}
