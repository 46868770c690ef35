//! Unsupported grids, damaged files, and files that claim too much.

use lookfrom_scene::Budget;

use super::*;

#[test]
fn what_is_not_read_is_told() {
    let of = |bytes: Vec<u8>| {
        let error = read(bytes, "density").expect_err("broken");
        (error.kind, error.message.split(" (at").next().unwrap_or_default().to_owned())
    };
    let (invalid, unsupported) = (ErrorKind::Invalid, ErrorKind::Unsupported);
    let good = || Draft::new("density");
    let affine = |numbers: [f64; 16]| Draft { map: ("AffineMap", numbers.to_vec()), ..good() };
    let mut first_row = [0.0; 16];
    first_row[0] = 1.0;
    let mut flat = first_row;
    flat[15] = 1.0;
    let mut not_finite = good();
    not_finite.tiles[2].insert([16, 16, 8], (f32::NAN, true));
    let mut far = good();
    far.tiles[0].insert([1 << 22, 0, 0], (1.0, true));
    for (draft, kind, message) in [
        (
            Draft { class: "level set", ..good() },
            unsupported,
            "a grid of the class \"level set\", expected a fog volume",
        ),
        (
            Draft { tree: "Tree_vec3s_5_4_3", ..good() },
            unsupported,
            "a grid of the type \"Tree_vec3s_5_4_3\", expected a tree of float, double or half, 5_4_3",
        ),
        (
            Draft { map: ("NonlinearFrustumMap", vec![]), ..good() },
            unsupported,
            "a map of the type \"NonlinearFrustumMap\", expected scales, translations and affine maps",
        ),
        (Draft { flags: 8, ..good() }, unsupported, "a grid that is compressed by unknown means (flags 0x8)"),
        (affine(first_row), invalid, "a matrix that is no affine map"),
        (affine(flat), invalid, "the map from index space to the world has no inverse"),
        (
            Draft { map: ("TranslationMap", vec![0.0, f64::NAN, 0.0]), ..good() },
            invalid,
            "the map from index space to the world has no inverse",
        ),
        (not_finite, invalid, "the value NaN at the index [16, 16, 8] or near it, expected a finite number"),
        (far, ErrorKind::Limit, "index coordinates beyond ±2²²"),
    ] {
        assert_eq!(of(file(&[draft])), (kind, message.into()));
    }
    let with = |at: usize, byte: u8| {
        let mut bytes = file(&[good()]);
        bytes[at] = byte;
        of(bytes)
    };
    assert_eq!(with(8, 218), (unsupported, "version 218 of OpenVDB's format, expected 219 to 226".into()));
    assert_eq!(with(20, 0), (unsupported, "a stream of grids without their positions".into()));
}

#[test]
fn broken_files_are_survived() {
    for flags in [0, ZIP | ACTIVE, BLOSC | ACTIVE] {
        let mut small = Draft { flags, ..draft(&mut Dice(3), 0.5) };
        small.leaves.retain(|first, _| (-136..-56).contains(&first[0]));
        small.tiles = Default::default();
        small.tiles[2].insert([-48, 24, 32], (0.25, true));
        let bytes = file(&[small]);
        assert!(read(bytes.clone(), "density").is_ok());
        // What is in the masks and tiles of nodes is all alike.
        let places = (0..bytes.len()).filter(|at| *at < 200 || at % 1999 == 0 || at + 60 > bytes.len());
        for at in places {
            assert!(read(bytes[..at].to_vec(), "density").is_err(), "{at}");
            for bit in [0, 7] {
                let mut broken = bytes.clone();
                broken[at] ^= 1 << bit;
                let _ = read(broken, "density");
            }
            let mut claimed = bytes.clone();
            claimed[at..bytes.len().min(at + 8)].fill(0xff);
            let _ = read(claimed, "density");
        }
    }
}

/// A few kilobytes that are the tiles of many nodes need no more memory than there may be.
#[test]
fn memory_is_that_of_the_budget() {
    let mut draft = Draft::new("density");
    for index in 0..4096 {
        let first = [8 * (index >> 8), 8 * (index >> 4 & 15), 8 * (index & 15)];
        draft.tiles[2].insert(first, (1.0 + index as f32, true));
    }
    for index in 0..32_768 {
        let first = [128 * (index >> 10) + 4096, 128 * (index >> 5 & 31), 128 * (index & 31)];
        draft.tiles[1].insert(first, (1.0 + index as f32, false));
    }
    let files = Memory([(PathBuf::from("a.vdb"), file(&[draft]))].into());
    for (limit, is_enough) in [(1 << 18, false), (1 << 22, false), (1 << 30, true)] {
        let mut context = LoadContext::within(&Budget::new(limit), &files);
        let volume = vdb::read(Path::new("a.vdb"), "density", &mut context);
        assert_eq!(volume.is_ok(), is_enough, "{limit}");
        assert!(volume.is_ok_and(|_| true) || context.budget.take_refusal().is_some(), "{limit}");
    }
}

#[test]
fn nodes_are_where_there_can_be_some() {
    let mut bytes = file(&[Draft { flags: 0, ..draft(&mut Dice(3), 0.5) }]);
    let corner: Vec<u8> = [-4096_i32, -4096, -4096].iter().flat_map(|at| at.to_le_bytes()).collect();
    let at = bytes.windows(12).position(|window| window == corner).expect("a node");
    bytes[at] = 8;
    let error = read(bytes, "density").expect_err("no multiple of 4096");
    assert!(
        error.message.starts_with("a node at the index [-4088, -4096, -4096], expected multiples"),
        "{error}"
    );
}
