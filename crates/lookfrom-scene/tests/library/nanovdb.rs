//! NanoVDB files: what is read, and what is said of broken ones.

pub(crate) mod writer;

use std::path::{Path, PathBuf};

use glam::{DVec3, IVec3};
use lookfrom_scene::medium::Density;
use lookfrom_scene::volume::Volume;
use lookfrom_scene::{ErrorKind, LoadContext, Memory, Result, load, vdb};

use self::writer::{Sketch, codes, file, numbers};

fn read(bytes: Vec<u8>, name: &str) -> Result<Volume> {
    let files = Memory([(PathBuf::from("a.nvdb"), bytes)].into());
    vdb::read(Path::new("a.nvdb"), name, &mut LoadContext::new(&files))
}

fn value(volume: &Volume, index: [i32; 3]) -> f32 {
    volume.grid.value((IVec3::from_array(index) - volume.first).to_array())
}

/// Two leaves and a tile of each size.
fn sketch() -> Sketch {
    let mut sketch = Sketch::new("density");
    sketch.bounds = [[-13, -8, 0], [300, 40, 20]];
    sketch.leaves.insert([-16, -8, 0], numbers(|[x, y, z]| (x + 10 * y + 100 * z) as f32));
    sketch.leaves.insert([8, 16, 8], numbers(|[x, _, _]| 0.125 * x as f32));
    sketch.tiles[2].insert([16, 16, 8], 0.5);
    sketch.tiles[1].insert([256, 0, 0], 0.25);
    sketch
}

#[test]
fn values_are_those_of_leaves_and_tiles() {
    for codec in [0, 1, 2] {
        let volume = read(file(codec, &[Sketch::new("other"), sketch()]), "density").expect("good");
        assert_eq!(volume.bounds.map(|corner| corner.to_array()), [[-13, -8, 0], [301, 41, 21]]);
        for (index, expected) in [
            ([-16, -8, 0], 0.0),
            ([-15, -8, 0], 1.0),
            ([-9, -2, 3], 7.0 + 60.0 + 300.0),
            ([13, 16, 8], 0.625),
            ([16, 23, 15], 0.5),
            ([24, 16, 8], 0.0),
            ([256, 0, 0], 0.25),
            ([300, 40, 20], 0.25),
            ([255, 0, 0], 0.0),
            ([5000, 0, 0], 0.0),
        ] {
            assert_eq!(value(&volume, index), expected, "{index:?}");
        }
        // Of a tile there is what the bounds contain, in the memory of one brick.
        assert_eq!(volume.first.to_array(), [-16, -8, 0]);
        assert_eq!(volume.grid.size(), [320, 56, 24]);
        assert_eq!(volume.grid.stored().len(), 4 * 512);
        let [low, high] = volume.faces().map(|corner| corner.to_array());
        assert_eq!((low, high), ([-16.5, -8.5, -0.5], [303.5, 47.5, 23.5]));
    }
}

/// Warp's writer counts what is packed without the length that stands before it.
#[test]
fn packed_grids_are_as_long_as_they_say_themselves() {
    let mut bytes = file(1, &[Sketch::new("other"), sketch()]);
    let expected = read(bytes.clone(), "density").expect("good");
    for at in [24, 24 + 176 + "other\0".len()] {
        let length: [u8; 8] = std::array::from_fn(|place| bytes[at + place]);
        bytes[at..at + 8].copy_from_slice(&(u64::from_le_bytes(length) - 8).to_le_bytes());
    }
    let volume = read(bytes, "density").expect("good");
    assert_eq!(volume.grid.stored(), expected.grid.stored());
}

#[test]
fn backgrounds_and_tiles_of_roots_fill_the_bounds() {
    let mut sketch = Sketch { background: 0.75, bounds: [[-4, 0, 0], [9, 3, 3]], ..Sketch::new("density") };
    sketch.leaves.insert([0; 3], numbers(|_| 0.0));
    let volume = read(file(0, &[sketch.clone()]), "density").expect("good");
    assert_eq!(
        [-8, -1, 0, 7, 8, 15, 16].map(|x| value(&volume, [x, 0, 0])),
        [0.75, 0.75, 0.0, 0.0, 0.75, 0.75, 0.0]
    );
    sketch.tiles[0].insert([-4096, 0, 0], 0.0);
    sketch.tiles[0].insert([4096, 0, 0], 2.0);
    sketch.bounds[1][0] = 4097;
    let volume = read(file(0, &[sketch]), "density").expect("good");
    assert_eq!(
        [-1, 0, 8, 4095, 4096, 4098].map(|x| value(&volume, [x, 0, 0])),
        [0.0, 0.0, 0.75, 0.75, 2.0, 2.0]
    );
    let empty = Sketch { bounds: [[i32::MAX; 3], [i32::MIN; 3]], ..Sketch::new("density") };
    let volume = read(file(0, &[empty]), "density").expect("a frame before the smoke");
    assert_eq!((volume.bounds, volume.grid.stored().len()), ([IVec3::ZERO; 2], 0));
}

#[test]
fn quantised_leaves_are_codes_times_a_quantum() {
    for (kind, log) in [(13, 2), (14, 3), (15, 4), (16, 0), (16, 1), (16, 2), (16, 3), (16, 4)] {
        let code =
            |[x, y, z]: [i32; 3]| (x * 8191 + y * 77 + z * 3) as u16 & ((1_u32 << (1 << log)) - 1) as u16;
        let mut sketch = Sketch { kind, ..Sketch::new("density") };
        sketch.leaves.insert([0; 3], codes(log, 0.5, 0.25, code));
        let volume = read(file(1, &[sketch]), "density").expect("good");
        for index in (0..512).map(|index| [index / 64, index / 8 % 8, index % 8]) {
            let expected = f32::from(code(index)) * 0.25 + 0.5;
            assert_eq!(value(&volume, index), expected, "{kind} {log} {index:?}");
        }
    }
}

#[test]
fn files_of_nanovdb_itself_are_read() {
    // A sphere of fog and a tile, written by NanoVDB 32.4.2: the formula is that of the program that made them.
    let density = |[x, y, z]: [i32; 3]| {
        let r = (((x - 9).pow(2) + (y - 6).pow(2) + (z - 13).pow(2)) as f32).sqrt();
        let is_tile = (32..40).contains(&x) && (8..16).contains(&y) && (16..24).contains(&z);
        if is_tile { 0.5 } else { (1.0 - r / 9.0).max(0.0) }
    };
    let files: [(&[u8], &str, f32, f32); 6] = [
        (include_bytes!("nanovdb/float.nvdb"), "density", 1.0, 0.0),
        (include_bytes!("nanovdb/float.nvdb"), "temperature", 4000.0, 0.0),
        (include_bytes!("nanovdb/fp4.nvdb"), "density", 1.0, 1.0 / 30.0),
        (include_bytes!("nanovdb/fp8.nvdb"), "density", 1.0, 1.0 / 510.0),
        (include_bytes!("nanovdb/fp16.nvdb"), "density", 1.0, 1.0 / 131_070.0),
        (include_bytes!("nanovdb/fpn.nvdb"), "density", 1.0, 0.02),
    ];
    for (bytes, name, gain, error) in files {
        let volume = read(bytes.to_vec(), name).expect("good");
        assert_eq!(volume.bounds.map(|corner| corner.to_array()), [[1, -2, 5], [40, 16, 24]]);
        for index in (0..44 * 24 * 24).map(|index| [index % 44, index / 44 % 24 - 4, index / 44 / 24 + 2]) {
            let (found, expected) = (value(&volume, index), gain * density(index));
            assert!((found - expected).abs() <= error * 1.01, "{name} {index:?}: {found}, {expected}");
        }
        let at = volume.world_from_index.transform_point3(DVec3::new(1.0, 2.0, 3.0));
        let [c, s] = [0.25 * f64::cos(0.3), 0.25 * f64::sin(0.3)];
        let expected = DVec3::new(c + 2.0 * s + 1.0, 2.0 * c - s + 2.0, 3.75);
        assert!((at - expected).length() < 1e-12, "{at}");
    }
}

#[test]
fn what_is_not_read_is_told() {
    let of = |bytes: Vec<u8>| {
        let error = read(bytes, "density").expect_err("broken");
        (error.kind, error.message)
    };
    let with = |change: &dyn Fn(&mut Sketch)| {
        let mut sketch = sketch();
        change(&mut sketch);
        of(file(0, &[sketch]))
    };
    let (invalid, unsupported) = (ErrorKind::Invalid, ErrorKind::Unsupported);
    let expected = "a grid of the class \"level set\", expected a fog volume (at byte 632 of the grid)";
    assert_eq!(with(&|sketch| sketch.class = 1), (unsupported, expected.into()));
    let expected =
        "a grid of the type \"double\", expected float, Fp4, Fp8, Fp16 or FpN (at byte 636 of the grid)";
    assert_eq!(with(&|sketch| sketch.kind = 2), (unsupported, expected.into()));
    let expected = "the map from index space to the world has no inverse (at byte 384 of the grid)";
    assert_eq!(with(&|sketch| sketch.rows[1] = [0.0; 3]), (invalid, expected.into()));
    assert_eq!(with(&|sketch| sketch.name = "Density").1, "no grid is called \"density\"; found \"Density\"");
    let far = with(&|sketch| sketch.bounds[1] = [i32::MAX; 3]);
    assert_eq!(far, (ErrorKind::Limit, "index coordinates beyond ±2²² (at byte 736 of the grid)".into()));
    let not_finite = with(&|sketch| sketch.tiles[2] = [([16, 16, 8], f32::NAN)].into());
    assert_eq!(not_finite.1, "the value NaN at the index [16, 16, 8] or near it, expected a finite number");
    let mut old = file(0, &[sketch()]);
    old[8..12].copy_from_slice(&(29_u32 << 21 | 3 << 10).to_le_bytes());
    assert_eq!(of(old), (unsupported, "version 29.3.0 of NanoVDB, expected 32 (at byte 8)".into()));
    let mut other = file(0, &[sketch()]);
    other[14] = 3;
    let codec = "the grid \"density\" is compressed by the unknown codec 3, expected ZIP, BLOSC or none";
    assert_eq!(of(other), (unsupported, codec.into()));
    for other in [Vec::new(), b"ply\nformat ascii 1.0\n".to_vec()] {
        assert_eq!(of(other), (ErrorKind::Syntax, "the file is of neither NanoVDB nor OpenVDB".into()));
    }
}

#[test]
fn nodes_in_several_places_are_refused() {
    let mut bytes = file(0, &[sketch()]);
    let grid = bytes.len() - sketch().bytes().len();
    let lower = grid + 672 + 64 + 64 + 2 * 32 + 2 * 270_400;
    // All children of a lower node are its one leaf.
    bytes[lower + 544..lower + 1056].fill(0xff);
    let entry: [u8; 8] = std::array::from_fn(|byte| bytes[lower + 1088 + 8 * (14 << 8 | 15 << 4) + byte]);
    (0..4096).for_each(|index| bytes[lower + 1088 + 8 * index..][..8].copy_from_slice(&entry));
    let error = read(bytes, "density").expect_err("a bomb");
    assert!(error.message.starts_with("more nodes than there are bytes"), "{error}");
}

#[test]
fn broken_files_are_survived() {
    for codec in [0, 1, 2] {
        let mut small = sketch();
        small.tiles[1].clear();
        small.leaves.remove(&[8, 16, 8]);
        small.tiles[2].clear();
        let whole = file(codec, &[small]);
        // What is in the tables of nodes is all alike.
        let (dense, step) = if codec == 0 { (1200, 997) } else { (whole.len(), 1) };
        let tail = whole.len() - 40;
        let places = || (0..whole.len()).filter(|at| *at < dense || at % step == 0 || *at > tail);
        for at in places() {
            assert!(read(whole[..at].to_vec(), "density").is_err(), "{at}");
            for bit in [0, 3, 7] {
                let mut broken = whole.clone();
                broken[at] ^= 1 << bit;
                let _ = read(broken, "density");
            }
        }
    }
}

#[test]
fn claimed_sizes_are_not_believed() {
    for codec in [1, 2] {
        let whole = file(codec, &[sketch()]);
        for (at, length) in [(12, 2), (16, 8), (24, 8), (16 + 136, 4), (16 + 176 + 8, 8)] {
            for byte in [0x7f, 0xff] {
                let mut broken = whole.clone();
                broken[at..at + length].fill(byte);
                assert!(read(broken, "density").is_err(), "{at}");
            }
        }
    }
    let mut sketch = sketch();
    sketch.bounds = [[-(1 << 22) + 1; 3], [(1 << 22) - 1; 3]];
    sketch.background = 1.0;
    let error = read(file(0, &[sketch]), "density").expect_err("an exabyte");
    assert_eq!(error.kind, ErrorKind::Limit, "{error}");
}

#[test]
fn media_of_pbrt_are_read() {
    let mut cold = sketch();
    cold.rows[0][0] = 2.0;
    cold.translation = [5.0, 0.0, 0.0];
    cold.leaves.insert([0; 3], numbers(|_| -1.0));
    let mut hot = Sketch { name: "temperature", bounds: [[0; 3], [7; 3]], ..Sketch::new("temperature") };
    hot.rows = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
    hot.leaves.insert([0; 3], numbers(|_| 2000.0));
    let text = "WorldBegin Scale 2 2 2 MakeNamedMedium \"smoke\" \"string type\" \"nanovdb\" \"string filename\" \"a.nvdb\"\n\
                \"float Lescale\" 3 \"float temperaturecutoff\" 7 \"float scale\" 4\n\
                MediumInterface \"smoke\" \"\" Shape \"sphere\"";
    let of = |grids: &[Sketch]| {
        let files = [("dir/a.pbrt", text.as_bytes().to_vec()), ("dir/a.nvdb", file(1, grids))];
        let files = Memory(files.map(|(name, bytes)| (PathBuf::from(name), bytes)).into());
        let mut context = LoadContext::new(&files);
        let scene = load::scene(Path::new("dir/a.pbrt"), &mut context);
        (scene, context.warnings.iter().map(ToString::to_string).collect::<Vec<_>>())
    };
    let (scene, warnings) = of(&[cold.clone(), hot.clone()]);
    assert_eq!(warnings, ["dir/a.nvdb: densities below 0 are read as 0"]);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    let medium = &scene.media[0];
    let varying = medium.variation.as_ref().expect("it varies");
    assert_eq!((medium.scale, medium.emits()), (4.0, true));
    let corner = varying.world_from_medium.transform_point3(DVec3::ONE);
    assert!((corner - DVec3::new(14.0, 2.0, 2.0)).length() < 1e-12, "{corner}");
    let Density::Grid(density) = &varying.density else { panic!("{:?}", varying.density) };
    assert!(density.grid.stored().iter().all(|value| *value >= 0.0));
    assert_eq!(density.bounds[0].to_array(), [-16.5, -8.5, -0.5]);
    let heat = varying.temperature.as_ref().expect("a temperature");
    assert_eq!((heat.offset, heat.scale), (7.0, 1.0));
    // Index 0 of the temperatures is at x = 0 in the world of the file, which is −2.5 in the space of the densities.
    assert_eq!(
        heat.grid.bounds.map(|corner| corner.to_array()),
        [[-2.625, -0.25, -0.25], [-0.625, 3.75, 3.75]]
    );
    assert_eq!(
        varying.bounds.expect("a box").map(|corner| corner.to_array()),
        [[-13.0, -8.0, 0.0], [301.0, 41.0, 21.0]]
    );

    let (scene, _) = of(&[cold.clone()]);
    assert!(!scene.expect("it does not shine").media[0].emits());
    hot.rows[0][1] = 0.25;
    let error = of(&[cold, hot.clone()]).0.expect_err("a sheared temperature");
    assert!(error.message.contains("a grid whose axes are those of the densities"), "{error}");
    let error = of(&[hot]).0.expect_err("no density");
    assert_eq!(error.message, "dir/a.nvdb: no grid is called \"density\"; found \"temperature\"");
    assert!(error.at.to_string().starts_with("dir/a.pbrt:1:"), "{error}");

    let files = Memory([(PathBuf::from("dir/a.pbrt"), text.as_bytes().to_vec())].into());
    let error = load::scene(Path::new("dir/a.pbrt"), &mut LoadContext::new(&files)).expect_err("no file");
    assert!(error.to_string().starts_with("dir/a.pbrt:1:"), "{error}");
    assert_eq!(error.kind, ErrorKind::Io, "{error}");
}

/// Our own format places the same file as pbrt's does.
#[test]
fn media_of_our_own_format_are_read() {
    let bytes = include_bytes!("nanovdb/float.nvdb");
    let of = |name: &str, text: &str| {
        let files = [(name, text.as_bytes().to_vec()), ("a.nvdb", bytes.to_vec())];
        let files = Memory(files.map(|(name, bytes)| (PathBuf::from(name), bytes)).into());
        let scene = load::scene(Path::new(name), &mut LoadContext::new(&files));
        scene.unwrap_or_else(|error| panic!("{error}"))
    };
    let ours = of(
        "a.toml",
        "[media.fire]\nabsorption = 1\nscale = 2\ndensity = { file = \"a.nvdb\" }\ntemperature = { file = \"a.nvdb\" }\n[[sphere]]\nmedium = \"fire\"",
    );
    let theirs = of(
        "a.pbrt",
        "WorldBegin Scale 2 2 2 MakeNamedMedium \"fire\" \"string type\" \"nanovdb\" \"string filename\" \"a.nvdb\"",
    );
    let [ours, theirs] = [ours, theirs].map(|scene| scene.media[0].variation.clone().expect("it varies"));
    assert_eq!((ours.world_from_medium, ours.bounds), (theirs.world_from_medium, theirs.bounds));
    let (Density::Grid(a), Density::Grid(b)) = (&ours.density, &theirs.density) else { panic!("no grids") };
    assert_eq!((a.bounds, a.grid.stored()), (b.bounds, b.grid.stored()));
    let [a, b] = [ours.temperature, theirs.temperature].map(|of| of.expect("temperatures").grid);
    assert_eq!((a.bounds, a.grid.stored()), (b.bounds, b.grid.stored()));
}

/// The map of `emission_density` is that of its own file or formula, independent of the cells of `density`.
#[test]
fn densities_of_emission_have_a_place_of_their_own() {
    let mut smoke = sketch();
    (0..3).for_each(|axis| smoke.rows[axis][axis] = 0.25);
    let mut flames = Sketch { translation: [1.0, 2.0, 3.0], ..Sketch::new("flames") };
    flames.leaves.insert([0; 3], numbers(|_| 1.0));
    let mut turned = Sketch { rows: [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], ..flames.clone() };
    turned.name = "turned";
    let bytes = file(0, &[smoke, flames, turned]);
    let of = |density: &str, emission: &str| {
        let text = format!(
            "[media.fire]\nabsorption = 1\nemission = 1\nscale = 2\n{density}\nemission_density = {emission}\n[[sphere]]\nmedium = \"fire\""
        );
        let files = [("a.toml", text.into_bytes()), ("a.nvdb", bytes.clone())];
        let files = Memory(files.map(|(name, bytes)| (PathBuf::from(name), bytes)).into());
        load::scene(Path::new("a.toml"), &mut LoadContext::new(&files))
    };
    let grid = "density = { file = \"a.nvdb\" }";
    let formula = "density = { formula = \"1\", min = [-9, -9, -9], max = [9, 9, 9] }";
    for density in [grid, formula, ""] {
        for (emission, expected) in [
            ("{ file = \"a.nvdb\", grid = \"flames\" }", [[1.0, 3.0, 5.0], [17.0, 19.0, 21.0]]),
            ("{ formula = \"1\", min = [0, 0, 0], max = [1, 2, 3] }", [[0.0; 3], [2.0, 4.0, 6.0]]),
        ] {
            let scene = of(density, emission).unwrap_or_else(|error| panic!("{error}"));
            let varying = scene.media[0].variation.as_ref().expect("it varies");
            let bounds = varying.emission_scale.as_ref().expect("a grid").bounds;
            let corners = bounds.map(|corner| varying.world_from_medium.transform_point3(corner.as_dvec3()));
            let expected = expected.map(DVec3::from_array);
            let away = corners[0].distance(expected[0]).max(corners[1].distance(expected[1]));
            assert!(away < 1e-5, "{density} {emission}: {corners:?}");
        }
    }
    let error = of(grid, "{ file = \"a.nvdb\", grid = \"flame\" }").expect_err("no such grid");
    assert!(error.at.to_string().starts_with("a.toml:6:"), "{error}");
    let message = "a.nvdb: no grid is called \"flame\"; found \"density\", \"flames\", \"turned\"";
    assert_eq!(error.message, message);
    assert!(error.to_string().contains("did you mean \"flames\"?"), "{error}");
    let error = of(grid, "{ file = \"a.nvdb\", grid = \"turned\" }").expect_err("turned");
    assert_eq!((error.at.line, &*error.message), (6, "its axes are not those of `density`"));
}
