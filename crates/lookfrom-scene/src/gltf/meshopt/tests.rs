//! Streams of procedural data written by meshoptimizer 1.3's encoder, and damaged copies of them.

use std::path::Path;

use super::*;
use crate::files::{LoadContext, Memory};
use crate::shape::Geometry;

fn hex(text: &str) -> Vec<u8> {
    text.as_bytes()
        .chunks(2)
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap())
        .collect()
}

fn run(bytes: &[u8], count: u64, stride: u64, mode: Mode) -> Result<Vec<u8>> {
    let layout = CompressedView { count, stride, mode, filter: Filter::None };
    decode(bytes, &layout, &Location::file(Path::new("model.gltf")), &Limits::default())
}

/// 37 elements of four 16-bit integers: smooth, then noise.
fn words() -> Vec<u8> {
    let word = |i: u32, c: u32| if i < 20 { i * (c + 1) * 7 } else { i * i * (c * 977 + 31) };
    (0..37).flat_map(|i| (0..4).flat_map(move |c| (word(i, c) as u16).to_le_bytes())).collect()
}

/// 40 elements of three floats.
fn floats() -> Vec<u8> {
    (0..40u8)
        .map(f32::from)
        .flat_map(|i| [i / 8.0, 1.0 + i * i / 64.0, 5.0].map(f32::to_le_bytes).concat())
        .collect()
}

/// A grid of 4 × 4 cells, then triangles that share few vertices.
fn triangles() -> Vec<u32> {
    let cells = (0..4).flat_map(|y| (0..4).map(move |x| 5 * y + x));
    let grid = cells.flat_map(|a| [a, a + 1, a + 5, a + 5, a + 1, a + 6]);
    grid.chain([3, 9, 24, 0, 0, 7, 24, 23, 22, 100, 200, 300, 301, 299, 100]).collect()
}

const WORDS_0: &str = "a01e0eeeeeeeeeeeeeee0e0e0e0e29116ae69d215ad6ad314ac6ffc00000bd413ab6cd180000faacacceceef6010ffc0\
    0000100e1012101f001c1c1c1c1c1c1c1c1c1c1c1c1c1c1c1c1c1c1c13e0a060201f5f9fdfe0a060ffc00000201f5f9f\
    df1c000000024cbdad9d8b7f6d5d4d3f2f1fdfc000000d1020301f002a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a02\
    2dd625de1de615ee0df605efc00000fef90af11d0000002000000000387c9abadaf8e9c9a98b6d4dffc000002d0f0e2e\
    4e1f003838383838383838383838383838383838383818c4f3ab631b2c74bcfbb36bffc0000023246cb4fc1d00000800\
    00000002244b1b10406e9ccafad9a97bffc000004d1f0e3c6c0000000000000000000000000000000000000000000000\
    000000000000000000";
const WORDS_1: &str = "a131330e0eeeeeeeeeeeeeee0e0e0e0ed6ee6ae662de5ad652ce4ac61f0042be3ab6321c0000f9aabbccddee5f1f000f\
    0f101011001c1c1c1c1c1c1c1c1c1c1c1c1c1c1c1c1c1c1cec1f5f9fdf1f5f9fdf1f5f9fdf1fa0602014f0ff4bbdad9d\
    8d7e6e5e4e3f2f1f1d000f0f1f2f002a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a02d2d6dadee21915110d090501fd\
    060a0e14f0ff387b9ab9d8f7e9caab8c6d4e1f002f0f0f2e4d0038383838383838383838383838383838383838183bf3\
    549ce42c74bcfbb36b23db6cb4fc14f0ff244b1c113f6d9ccaf8d8aa7c1f004e1f0e3c6a000000000000000000000000\
    000000000000000000000101";
const FLOATS_1: &str = "a16878aa0502000f01001f1a0ffff8f8f4c4f4c48020107018381cf262e262f262e262fc1edddd00003e030703010001\
    03001050d09090d0501088a8e848c85894848494b4e4a4aceaa262aafa92b29a8941c145cd59c97dd505004dc4dc03ff\
    03074c4c4313030f030788000103000000000000000000000000000000803f0000a040623200";
const TRIANGLES: &str = "e1fe1e100e100e100ece1e160e150e140ece1e140e140e140ece1e140e140e140effffffffff0f0af1290cff11000e78\
    22ff9801c801c801f30203007687566778a9866589689801690000";
const SEQUENCE: &str = "d1000404cd010007981f04c3019cec1004a91f00000000";

#[test]
fn attributes_of_both_versions_are_what_was_written() {
    assert_eq!(run(&hex(WORDS_0), 37, 8, Mode::Attributes).unwrap(), words());
    assert_eq!(run(&hex(WORDS_1), 37, 8, Mode::Attributes).unwrap(), words());
    assert_eq!(run(&hex(FLOATS_1), 40, 12, Mode::Attributes).unwrap(), floats());
}

#[test]
fn the_specifications_example_of_a_group() {
    let mut group = [0; 16];
    let packed = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
    let mut stream = Stream { rest: &packed };
    attributes::read_group(&mut stream, 4, &mut group).unwrap();
    let signed = group.map(|d| ((d >> 1) ^ (d & 1).wrapping_neg()).cast_signed());
    assert_eq!(signed, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
}

#[test]
fn indices_are_what_was_written() {
    let all = triangles();
    let bytes = run(&hex(TRIANGLES), all.len() as u64, 4, Mode::Triangles).unwrap();
    let decoded: Vec<u32> = bytes.as_chunks().0.iter().map(|&index| u32::from_le_bytes(index)).collect();
    // The encoder may rotate the corners of a triangle.
    for (ours, [a, b, c]) in decoded.as_chunks::<3>().0.iter().zip(all.as_chunks().0) {
        assert!([[*a, *b, *c], [*b, *c, *a], [*c, *a, *b]].contains(ours), "{ours:?}, not {:?}", [a, b, c]);
    }
    let sequence = [0u32, 1, 2, 51, 2, 49, 1000, 1001, 0, 70000, 70001, 1002];
    let words: Vec<u8> = sequence.iter().flat_map(|&index| (index as u16).to_le_bytes()).collect();
    assert_eq!(run(&hex(SEQUENCE), 12, 2, Mode::Indices).unwrap(), words);
}

/// Inputs of filters, and the outputs of meshoptimizer.
const FILTERED: &[(Filter, usize, &str, &str)] = &[
    (Filter::Octahedral, 4, "00007f7f7f7f7f8136497f7fad5c7f00", "00007f7f000081814c66007fc44cae00"),
    (
        Filter::Octahedral,
        8,
        "00000000ff07ff7fff07ff07ff0701806d039204ff07ff7fcbfac405ff070000",
        "00000000ff7fff7f0000000001800180c54c6b660000ff7f97c2ca4c0dae0000",
    ),
    (
        Filter::Quaternion,
        8,
        "000000000000ff07000000000000fc0759faa70559fafc07dffe16f8dffefd07",
        "000000000000ff7fff7f0000000000000f4006c0fa3f06c039f39f5939f36ca6",
    ),
    (
        Filter::Exponential,
        16,
        "000000f4001000f400e8fff4443200f400000035000000355e2b003500000035",
        "000000000000803f0000c0bf0010494000000000000000000078ad6000000000",
    ),
    (Filter::Color, 4, "407fc1ff7f007fc04081c0a0660000df", "fe0100ff00fe00800100ff40666666bf"),
    (
        Filter::Color,
        8,
        "0004ff0701fcff0fff070000ff07000c000401f800fc000a660600000000ff0d",
        "efff10000000ffff0000efff0000088010000000ffff0440666666666666fbbf",
    ),
];

#[test]
fn filters_are_within_one_step_of_the_reference() {
    for &(filter, stride, from, to) in FILTERED {
        let (mut bytes, expected) = (hex(from), hex(to));
        filter::apply(filter, stride, &mut bytes);
        let integers = |bytes: &[u8]| -> Vec<i32> {
            match (filter, stride) {
                (Filter::Color, 4) => bytes.iter().map(|&b| i32::from(b)).collect(),
                (_, 4) => bytes.iter().map(|&b| i32::from(b.cast_signed())).collect(),
                (Filter::Color, 8) => {
                    bytes.chunks(2).map(|b| i32::from(u16::from_le_bytes([b[0], b[1]]))).collect()
                }
                _ => bytes.chunks(2).map(|b| i32::from(i16::from_le_bytes([b[0], b[1]]))).collect(),
            }
        };
        if filter == Filter::Exponential {
            assert_eq!(bytes, expected);
        }
        for (ours, theirs) in integers(&bytes).into_iter().zip(integers(&expected)) {
            assert!((ours - theirs).abs() <= 1, "{filter:?} {stride}: {ours}, not {theirs}");
        }
    }
}

#[test]
fn damaged_streams_give_errors_or_other_numbers_but_never_a_panic() {
    let corners = triangles().len() as u64;
    let streams = [
        (WORDS_0, 37, 8, Mode::Attributes),
        (WORDS_1, 37, 8, Mode::Attributes),
        (FLOATS_1, 40, 12, Mode::Attributes),
        (TRIANGLES, corners, 4, Mode::Triangles),
        (SEQUENCE, 12, 2, Mode::Indices),
    ];
    for (text, count, stride, mode) in streams {
        let whole = hex(text);
        for length in 0..whole.len() {
            assert!(run(&whole[..length], count, stride, mode).is_err(), "{mode:?} of {length} bytes");
        }
        for place in 0..whole.len() {
            for bit in 0..8 {
                let mut bytes = whole.clone();
                bytes[place] ^= 1 << bit;
                if let Ok(decoded) = run(&bytes, count, stride, mode) {
                    assert_eq!(decoded.len() as u64, count * stride);
                }
            }
        }
        // A count larger than the stream allocates nothing.
        assert!(run(&whole, 3_000_000, stride, mode).is_err());
        assert_eq!(run(&whole, 3 << 40, stride, mode).unwrap_err().kind, ErrorKind::Limit);
    }
    assert!(run(&[], 0, 0, Mode::Attributes).is_err());
    assert!(run(&[], u64::MAX, u64::MAX, Mode::Attributes).is_err());
    for filter in [Filter::Octahedral, Filter::Quaternion, Filter::Exponential, Filter::Color] {
        for value in [0, 1, 0x7f, 0x80, 0xff] {
            for stride in [4, 8] {
                filter::apply(filter, stride, &mut [value; 16]);
            }
        }
    }
}

#[test]
fn a_view_of_a_file_is_unpacked() {
    let json = r#"{
        "asset": {"version": "2.0"}, "extensionsRequired": ["EXT_meshopt_compression"],
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 40, "type": "VEC3"}],
        "bufferViews": [{"buffer": 1, "byteLength": 480, "extensions": {"EXT_meshopt_compression": {
            "buffer": 0, "byteLength": LENGTH, "byteStride": 12, "count": 40, "mode": "ATTRIBUTES", "filter": "FILTER"}}}],
        "buffers": [{"uri": "b", "byteLength": LENGTH}, {"byteLength": 480}]
    }"#;
    let bytes = hex(FLOATS_1);
    let json = json.replace("LENGTH", &bytes.len().to_string());
    let read = |filter: &str| {
        let json = json.replace("FILTER", filter).into_bytes();
        let files = Memory([("a.gltf".into(), json), ("b".into(), bytes.clone())].into());
        crate::gltf::read(Path::new("a.gltf"), &mut LoadContext::new(&files))
    };
    let scene = read("NONE").unwrap();
    let Geometry::Spheres(points) = &scene.shapes[0].geometry else { panic!("no points") };
    assert_eq!((points.len(), points[39].center.to_array()), (40, [4.875, 24.765625, 5.0]));
    let error = read("SQUARE").unwrap_err().to_string();
    let place = "a.gltf#/bufferViews/0/extensions/EXT_meshopt_compression";
    assert!(error.starts_with(&format!("{place}: the meshopt filter \"SQUARE\" is not known")), "{error}");
}
