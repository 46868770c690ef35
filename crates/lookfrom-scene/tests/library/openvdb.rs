//! OpenVDB files: what is read, and what is said of broken ones.

mod broken;
mod level_sets;
mod writer;

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, DVec4, IVec3};
use lookfrom_scene::medium::Density;
use lookfrom_scene::volume::Volume;
use lookfrom_scene::{ErrorKind, LoadContext, Memory, Result, load, vdb};

use self::writer::{ACTIVE, BLOSC, Draft, Voxel, ZIP, file, file_of_version};
use crate::nanovdb::writer as nano;

fn read(bytes: Vec<u8>, name: &str) -> Result<Volume> {
    let files = Memory([(PathBuf::from("a.vdb"), bytes)].into());
    vdb::read(Path::new("a.vdb"), name, &mut LoadContext::new(&files))
}

/// Numbers without an order, from 0 on and below a limit.
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }

    /// A number that is exact as a `half` as well.
    fn number(&mut self) -> f32 {
        let exponent = self.below(20) as i32 - 10;
        let sign = if self.below(4) == 0 { -1.0 } else { 1.0 };
        sign * (1024 + self.below(1024)) as f32 / 1024.0 * 2.0_f32.powi(exponent)
    }
}

/// Leaves whose values that are not active are of each kind that is stored in another way, and tiles of each size.
fn draft(random: &mut Dice, background: f32) -> Draft {
    let mut draft = Draft { background, ..Draft::new("density") };
    let [one, two, three] = std::array::from_fn(|_| random.number());
    // Not the other zero, which is the same to OpenVDB.
    let negative = 0.0 - background;
    let others: [&[f32]; 8] = [
        &[],
        &[background],
        &[negative],
        &[one],
        &[background, negative],
        &[background, one],
        &[one, two],
        &[one, two, three],
    ];
    for (index, others) in (0..).zip(others) {
        let first = [16 * index - 136, 8 * (index % 3) - 8, 120 * (index % 2)];
        let cell = |_| match others {
            [] => (random.number(), true),
            _ if random.below(2) == 0 => (random.number(), true),
            _ => (others[random.below(others.len() as u64) as usize], false),
        };
        draft.leaves.insert(first, (0..512).map(cell).collect());
    }
    draft.leaves.insert([-64, -64, -64], vec![(background, false); 512]);
    let mut tile = |level: usize, first, is_active| {
        draft.tiles[level].insert(first, (random.number(), is_active));
    };
    tile(2, [-48, 24, 32], true);
    tile(2, [-40, 24, 32], false);
    tile(1, [128, -128, 0], true);
    tile(1, [-256, 0, 0], false);
    draft.tiles[2].insert([-32, 24, 32], (background, true));
    draft
}

/// The same grid by NanoVDB's writer.
fn as_nano(draft: &Draft) -> nano::Sketch {
    let mut sketch = nano::Sketch { background: draft.background, ..nano::Sketch::new("density") };
    for (level, tiles) in draft.tiles.iter().enumerate() {
        sketch.tiles[level] = tiles.iter().map(|(first, cell)| (*first, cell.0)).collect();
    }
    let place = |[x, y, z]: [i32; 3]| (64 * x + 8 * y + z) as usize;
    for (first, cells) in &draft.leaves {
        sketch.leaves.insert(*first, nano::numbers(|at| cells[place(at)].0));
    }
    let mut corners = Vec::new();
    for (tiles, side) in draft.tiles.iter().zip([4096, 128, 8]) {
        let active = tiles.iter().filter(|(_, cell)| cell.1);
        corners.extend(active.flat_map(|(first, _)| [*first, first.map(|at| at + side - 1)]));
    }
    for (first, cells) in &draft.leaves {
        let places = (0..512).map(|index| [index / 64, index / 8 % 8, index % 8]);
        let active = places.filter(|at| cells[place(*at)].1);
        corners.extend(active.map(|at| std::array::from_fn(|axis| first[axis] + at[axis])));
    }
    let corners = corners.into_iter().map(IVec3::from_array);
    let bounds = corners.map(|at| [at; 2]).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
    sketch.bounds = bounds.expect("some are active").map(|corner| corner.to_array());
    sketch
}

/// All of a volume, with a hash (FNV-1a) of the bits of its values and their places.
fn whole(volume: &Volume) -> (IVec3, [u32; 3], [IVec3; 2], DMat4, u64) {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    volume.grid.for_each(|[x, y, z], value| {
        for number in [x, y, z, value.to_bits()] {
            hash = (hash ^ u64::from(number)).wrapping_mul(0x0100_0000_01b3);
        }
    });
    (volume.first, volume.grid.size(), volume.bounds, volume.world_from_index, hash)
}

#[test]
fn volumes_are_those_of_the_same_grids_of_nanovdb() {
    let mut random = Dice(1);
    for background in [0.0, 0.75] {
        for tree in [
            "Tree_float_5_4_3",
            "Tree_float_5_4_3_HalfFloat",
            "Tree_double_5_4_3",
            "Tree_double_5_4_3_HalfFloat",
            "Tree_half_5_4_3",
        ] {
            for flags in [0, ZIP, ACTIVE, ZIP | ACTIVE, BLOSC, BLOSC | ACTIVE] {
                let draft = Draft { tree, flags, ..draft(&mut random, background) };
                let expected = read(nano::file(0, &[as_nano(&draft)]), "density").expect("good");
                let found =
                    read(file(&[draft]), "density").unwrap_or_else(|error| panic!("{tree} {flags}: {error}"));
                assert_eq!(whole(&found), whole(&expected), "{tree} {flags} {background}");
            }
        }
    }
}

/// Before version 222 nodes have all their values, but for those in the places of children, and leaves may have several arrays.
#[test]
fn files_of_old_versions_are_read() {
    let mut random = Dice(2);
    for (version, flags) in [(219, ZIP), (220, 0), (220, ZIP), (221, 0), (221, ZIP)] {
        for tree in ["Tree_float_5_4_3", "Tree_float_5_4_3_HalfFloat", "Tree_double_5_4_3", "Tree_half_5_4_3"]
        {
            let draft = Draft { tree, flags, ..draft(&mut random, 0.75) };
            let expected = read(file(std::slice::from_ref(&draft)), "density").expect("good");

            let found = read(file_of_version(version, &[draft]), "density")
                .unwrap_or_else(|error| panic!("{version} {tree} {flags}: {error}"));
            assert_eq!(whole(&found), whole(&expected), "{version} {tree} {flags}");
        }
    }
}

#[test]
fn tiles_of_roots_and_empty_grids_are_read() {
    let mut draft = Draft::new("density");
    draft.tiles[0].insert([-4096, 0, 0], (0.5, true));
    draft.tiles[0].insert([0, 0, 0], (0.25, false));
    draft.tiles[0].insert([1 << 30, 0, 0], (0.0, false));
    let volume = read(file(&[draft]), "density").expect("good");
    assert_eq!(volume.bounds.map(|corner| corner.to_array()), [[-4096, 0, 0], [0, 4096, 4096]]);
    let value = |x: i32| volume.grid.value((IVec3::new(x, 7, 4000) - volume.first).to_array());
    assert_eq!([-4097, -4096, -1, 8].map(value), [0.0, 0.5, 0.5, 0.0]);
    let volume = read(file(&[Draft::new("density")]), "density").expect("a frame before the smoke");
    assert_eq!((volume.bounds, volume.grid.stored().len()), ([IVec3::ZERO; 2], 0));
}

#[test]
fn maps_are_read() {
    let scale = [0.5, 0.25, 2.0];
    let by_scale = [&scale[..], &[9.0; 12]].concat();
    let both = [&[1.0, 2.0, 3.0], &*by_scale].concat();
    let rows = [0.0, 2.0, 0.0, 0.0, -3.0, 0.0, 0.0, 0.0, 0.0, 1.0, 4.0, 0.0, 5.0, 6.0, 7.0, 1.0];
    let scaled = DMat4::from_scale(DVec3::from_array(scale));
    let moved = DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0));
    let affine = DMat4::from_cols(
        DVec4::new(0.0, 2.0, 0.0, 0.0),
        DVec4::new(-3.0, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 1.0, 4.0, 0.0),
        DVec4::new(5.0, 6.0, 7.0, 1.0),
    );
    for (name, numbers, expected) in [
        ("ScaleMap", by_scale.clone(), scaled),
        ("UniformScaleMap", by_scale, scaled),
        ("TranslationMap", vec![1.0, 2.0, 3.0], moved),
        ("ScaleTranslateMap", both.clone(), moved * scaled),
        ("UniformScaleTranslateMap", both, moved * scaled),
        ("AffineMap", rows.to_vec(), affine),
        ("UnitaryMap", rows.to_vec(), affine),
    ] {
        let draft = Draft { map: (name, numbers), ..Draft::new("density") };
        assert_eq!(read(file(&[draft]), "density").expect("good").world_from_index, expected, "{name}");
    }
}

#[test]
fn grids_are_found_by_their_names() {
    let cell = |value: f32| -> Vec<Voxel> { vec![(value, true); 512] };
    let of = |name, value| Draft { leaves: [([0; 3], cell(value))].into(), ..Draft::new(name) };
    let map = ("TranslationMap", vec![1.0, 2.0, 3.0]);
    let grids = [
        Draft { tree: "Tree_vec3s_5_4_3", flags: u32::MAX, ..Draft::new("velocity") },
        of("density\u{1e}0", 1.0),
        of("density\u{1e}1", 2.0),
        Draft { parent: "density\u{1e}1", map, flags: 0, ..Draft::new("twin") },
        Draft { parent: "nobody", ..Draft::new("orphan") },
    ];
    let bytes = file(&grids);
    let value = |name| read(bytes.clone(), name).map(|volume| volume.grid.value([0; 3]));
    assert_eq!(["density", "density[0]", "density[1]"].map(value), [Ok(1.0), Ok(1.0), Ok(2.0)]);
    let twin = read(bytes.clone(), "twin").expect("good");
    let moved = DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0));
    assert_eq!((twin.grid.value([0; 3]), twin.world_from_index), (2.0, moved));
    let message = |name| value(name).expect_err("not there").message;
    assert!(message("orphan").starts_with("the grid \"orphan\" has the tree of another one"));
    let found = "found \"velocity\", \"density[0]\", \"density[1]\", \"twin\", \"orphan\"";
    assert_eq!(message("Density"), format!("no grid is called \"Density\"; {found}"));
    let error = read(file(&[]), "density").expect_err("nothing in it");
    assert_eq!(
        (error.kind, &*error.message),
        (ErrorKind::Invalid, "no grid is called \"density\"; found no grids")
    );
    assert_eq!(error.hint.expect("advice").to_string(), "write the file again, with its grids");
}

/// A file alone is a scene: its densities as smoke, alike in every unit of length and of density, behind a box that is not seen.
#[test]
fn files_alone_are_scenes() {
    let scene_of = |grids: &[Draft]| {
        let files = Memory([(PathBuf::from("a"), file(grids))].into());
        let mut context = LoadContext::new(&files);
        load::scene(Path::new("a"), &mut context).map(|scene| (scene, context.warnings))
    };
    let of = |value: f32, map: Vec<f64>| {
        let cells = (0..512).map(|index| (if index % 2 == 0 { value } else { -1.0 }, true)).collect();
        let leaves = [([8, 0, 0], cells)].into();
        Draft { leaves, map: ("UniformScaleMap", [map, vec![0.0; 12]].concat()), ..Draft::new("density") }
    };
    let velocity = Draft { tree: "Tree_vec3s_5_4_3", ..Draft::new("velocity") };
    let (small, warnings) = scene_of(&[velocity.clone(), of(0.5, vec![0.25; 3])]).expect("good");
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].message.contains("nothing of \"velocity\""), "{}", warnings[0].message);
    let (large, warnings) = scene_of(&[of(64.0, vec![-100.0; 3])]).expect("good");
    assert!(warnings.is_empty());
    // The mean density along the side of a cube as large as the 256 cells that are not empty.
    for (scene, density, cell) in [(&small, 0.5, 0.25), (&large, 64.0, 100.0)] {
        let thickness = scene.media[0].scale * density * cell * 256_f32.cbrt();
        assert!((thickness - 30.0).abs() < 1e-4, "{thickness}");
        let bounds = scene.shapes[0].bounds(&scene.meshes);
        assert_eq!(bounds.max - bounds.min, DVec3::splat(8.0 * f64::from(cell)));
        assert_eq!(scene.shapes[0].sides.expect("both").outside, None);
    }
    // A tile is as dense as leaves that fill its place.
    let mut tile = Draft::new("density");
    tile.tiles[1].insert([0; 3], (0.5, true));
    let (tile, _) = scene_of(&[tile]).expect("good");
    let thickness = tile.media[0].scale * 0.5 * 128.0;
    assert!((thickness - 30.0).abs() < 1e-4, "{thickness}");
    let (empty, _) = scene_of(&[Draft::new("density")]).expect("a frame before the smoke");
    assert_eq!(empty.media[0].scale, 0.0);
    let (heat, _) =
        scene_of(&[velocity.clone(), Draft { name: "heat", ..of(1.0, vec![1.0; 3]) }]).expect("good");
    assert_eq!(heat.media[0].name, "heat");
    let error = scene_of(&[velocity]).map(|_| ()).expect_err("nothing dense");
    assert_eq!(error.kind, ErrorKind::Unsupported);
}

/// In both formats of scenes, under whatever name.
#[test]
fn media_are_read() {
    let mut draft = draft(&mut Dice(5), 0.0);
    draft.map.1[0] = 3.0;
    let of = |name: &str, text: &str| {
        let files = [(name, text.as_bytes().to_vec()), ("smoke.nvdb", file(&[draft.clone()]))];
        let files = Memory(files.map(|(name, bytes)| (PathBuf::from(name), bytes)).into());
        let scene = load::scene(Path::new(name), &mut LoadContext::new(&files));
        scene.unwrap_or_else(|error| panic!("{error}")).media[0].variation.clone().expect("it varies")
    };
    let ours = of(
        "a.toml",
        "[media.smoke]\nabsorption = 1\ndensity = { file = \"smoke.nvdb\" }\n[[sphere]]\nmedium = \"smoke\"",
    );
    assert_eq!(ours.world_from_medium, DMat4::from_translation(DVec3::new(3.0, 0.0, 0.0)));
    let Density::Grid(density) = &ours.density else { panic!("no grid") };
    assert!(density.grid.stored().iter().any(|value| *value > 0.0));
    if cfg!(feature = "pbrt") {
        let text = "WorldBegin MakeNamedMedium \"smoke\" \"string type\" \"nanovdb\" \"string filename\" \"smoke.nvdb\"";
        let theirs = of("a.pbrt", text);
        let Density::Grid(other) = &theirs.density else { panic!("no grid") };
        assert_eq!((other.bounds, other.grid.stored()), (density.bounds, density.grid.stored()));
    }
}
