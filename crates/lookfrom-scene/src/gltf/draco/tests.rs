//! Streams of a grid written by Google's encoder 1.5.7, and damaged copies of them.

use std::path::Path;

use super::*;
use crate::Disk;
use crate::files::LoadContext;

/// A grid of 5 × 5 vertices: positions in 12 bits, texture coordinates in 10, normals in 8, joints in bytes; encoded by
/// Edgebreaker, and triangle by triangle (sequentially).
const STREAMS: [&str; 2] = [
    "445241434f020201010000001920032003000aefd3ea53adea53d5aa1aff0111ff02cc42ff02cc42ff02cc4204ff0000\
    00000001000002000001000903000002010309020001020101090300020301040204000301010101000d0321051bb51e\
    7d142105910208a16a3c14aa7aff88ffffff00f87fffff0700fdff0f0000ff0108f80f0000000200f03f0080ff0002fc\
    07000000010000400000fe030080ff0000e07f0000ff0500f80f00000002000080000410200000000840407f00000050\
    0080fe00000000ff0f0000000000000000000000000000000080400c050101000b032105039102032105cd0ce9115d0f\
    910291020b6507f2fce9fe6ff3c65f80ffffffdf3f6d00b800f41e58ce32ca9a26060d21e0a320000436800600f702a9\
    972700c1b72440d803170000000b03f9af8300000000ff03000000000000000000000000803f0a060301000903910217\
    713d03e02891c11fc10fc912c906c107ba12b91cb92ac12fc924d515d507e708e710548f24c304dfe8ced0bacc9abcaa\
    bc9aacaad07600ff0000007f000000ff02b34108010101010305293ced01a403490108ba388f84ffe96f800000000009\
    000000",
    "445241434f02020100000020190100010505010601020606020702030707030803040808040905060a0a060b06070b0b\
    070c07080c0c080d08090d0d090e0a0b0f0f0b100b0c10100c110c0d11110d120d0e12120e130f101414101510111515\
    1116111216161217121317171318010400090300000309020001010903000204020400030202030100010101048020e5\
    17036903fffffffffffffff36903fffffffffffffffb6903fffffffffffffff3dc039102fffffffffffffff3f905dced\
    1103dcffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffefdc1a412028deb7087fb9aee65c\
    46d7106fe700a7592e0e6a926754af00000000ff0f000000010101038104251c032105ffffffffffffffebb107030d17\
    0df8911f7d3b0efe47439240938b00000000ff03000000030101028001b93efff749010322df9eff0000007f00000000\
    0101010308712da45d0f0f910210578dab24f77a9300e9b17aab9446438c000000000900000000000000000000000000\
    0000000080400c00000000000000000000803f0a08",
];

fn bytes(text: &str) -> Vec<u8> {
    let digit = |byte: u8| char::from(byte).to_digit(16).unwrap() as u8;
    text.as_bytes().as_chunks().0.iter().map(|&[high, low]| 16 * digit(high) + digit(low)).collect()
}

fn run(bytes: &[u8]) -> Result<Decoded> {
    let limits = Limits { elements: 1 << 16, ..Limits::default() };
    decode(bytes, &Location::file(Path::new("model.gltf")), &limits)
}

#[test]
fn a_grid_is_what_was_written() {
    for stream in STREAMS {
        let grid = run(&bytes(stream)).unwrap();
        assert_eq!((grid.indices.len(), grid.vertices), (3 * 32, 25));
        let [positions, uvs, normals, joints] = [0, 1, 2, 3].map(|id| &grid.attributes[&id]);
        assert_eq!([positions.width, uvs.width, normals.width, joints.width], [3, 2, 3, 4]);
        assert_eq!([positions.one, joints.one], [None, Some(255.0)]);
        let mut seen = Vec::new();
        for vertex in 0..25 {
            let at = |attribute: &Attribute, i: usize| attribute.numbers[vertex * attribute.width + i];
            let [x, y, z] = [0, 1, 2].map(|i| at(positions, i));
            let near = |a: f32, b: f32| (a - b).abs() < 4.0 / 1024.0;
            assert!(near(z, x.round() * y.round() / 4.0), "{x} {y} {z}");
            assert!(near(at(uvs, 0), x / 4.0) && near(at(uvs, 1), y / 4.0));
            assert!(near(at(normals, 2), 1.0));
            assert_eq!([0, 1, 2, 3].map(|i| at(joints, i)), [x.round(), y.round(), 0.0, 9.0]);
            seen.push((x.round() as i32, y.round() as i32));
        }
        // Every vertex occurs once, and every triangle is half a cell, seen from above.
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 25);
        for triangle in grid.indices.as_chunks::<3>().0 {
            let corner = |i: usize| [0, 1].map(|c| positions.numbers[3 * triangle[i] as usize + c]);
            let ([a, b], [c, d], [e, f]) = (corner(0), corner(1), corner(2));
            let area = ((c - a) * (f - b) - (e - a) * (d - b)) / 2.0;
            assert!((area - 0.5).abs() < 0.01, "{area}");
        }
    }
}

#[test]
fn damaged_streams_give_errors_or_other_numbers_but_never_a_panic() {
    for stream in STREAMS {
        let whole = bytes(stream);
        for length in 0..whole.len() {
            let _ = run(&whole[..length]);
        }
        assert!(run(&whole[..whole.len() / 2]).is_err());
        for place in 0..whole.len() {
            for change in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
                let mut bytes = whole.clone();
                bytes[place] ^= change;
                if let Ok(mesh) = run(&bytes) {
                    assert!(mesh.indices.iter().all(|&index| (index as usize) < mesh.vertices));
                    let is_whole = |a: &Attribute| a.numbers.len() == a.width * mesh.vertices;
                    assert!(mesh.attributes.values().all(is_whole));
                }
            }
        }
    }
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn a_model_of_the_corpus_is_the_same_with_and_without() {
    let corpus = lookfrom_test_data::shared("corpus/assimp/glTF2");
    let paths = ["draco/2CylinderEngine.gltf", "2CylinderEngine-glTF-Binary/2CylinderEngine.glb"];
    let [packed, plain] = paths.map(|name| {
        let mut context = LoadContext::new(&Disk);
        let scene = crate::gltf::read(&corpus.join(name), &mut context).unwrap();
        assert_eq!(context.warnings, []);
        // The number of triangles, and their total area.
        let triangles: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let area: f32 = scene
            .meshes
            .iter()
            .flat_map(|mesh| {
                mesh.triangles.iter().map(move |t| {
                    let [a, b, c] = t.map(|vertex| mesh.positions[vertex as usize]);
                    (b - a).cross(c - a).length() / 2.0
                })
            })
            .sum();
        (triangles as f32, area)
    });
    let near = |a: f32, b: f32| (a - b).abs() < 0.01 * b;
    assert!(near(packed.0, plain.0) && near(packed.1, plain.1), "{packed:?}, not {plain:?}");
}
