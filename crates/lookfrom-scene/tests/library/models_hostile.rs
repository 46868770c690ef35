//! Broken files of any kind: never a panic, never a mesh that breaks its promises.

use std::path::{Path, PathBuf};

use lookfrom_scene::shape::{Geometry, Mesh};
use lookfrom_scene::{LoadContext, Memory, Scene, model};
use proptest::prelude::*;

const OBJ: &str = "mtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0.5e-1\nv 0 1 -.5\nvt 0 0\nvt 1 1\nvn 0 0 1\ns 1\n\
    usemtl red\nf 1/1/1 2/2/1 3/1/1 4\nf -4//1 -3//1 \\\n-2//1\nf 1 2 3 4 2\ng x\np 1 2\ns off\nl 1 2\nusemtl blue\nf 1/2 3/1 4/2\n";
const MTL: &str = "newmtl red\nKd 1 .5 0\nKs 1\nNs 10\nd 0.5\nillum 7\nTf 1 0 1\nNi 1.5\nmap_Kd -s 1 2 -o 0 1 3 -clamp on a b.png\n\
    newmtl blue\nTr 0.1\nKe 1 1 1\nPm 1\nPr .2\nmap_Ke \"c\\d.png\"\nmap_Bump -bm 2 x.png\nKd xyz 1 1 1\n";
const PLY: &str = "ply\r\nformat ascii 1.0\r\ncomment TextureFile a.png\r\nelement vertex 4\r\nproperty float x\r\n\
    property double y\r\nproperty float z\r\nproperty float nx\r\nproperty float ny\r\nproperty float nz\r\n\
    property float s\r\nproperty float t\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n\
    element face 2\r\nproperty list uchar int vertex_indices\r\nproperty list uchar float texcoord\r\n\
    element tristrips 1\r\nproperty list int int vertex_indices\r\nelement extra 1\r\nproperty int a\r\nend_header\r\n\
    0 0 0 0 0 1 0 0 255 0 0\r\n1 0 0 0 0 1 1 0 0 255 0\r\n1 1 0 0 0 1 1 1 0 0 255\r\n0 1 0 0 0 1 0 1 9 9 9\r\n\
    4 0 1 2 3 8 0 0 1 0 1 1 0 1\r\n3 0 1 2 0\r\n6 0 1 2 3 -1 0\r\n7\r\n";
const EDGES: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element edge 2\nproperty int vertex1\nproperty list uchar int l\nproperty int vertex2\nproperty uchar red\n\
    property uchar green\nproperty uchar blue\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 1 9 1 255 0 0\n1 0 2 0 0 255\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\n\
    endsolid a\nsolid b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 1\nvertex 1 1 1\nvertex 0 1 1\nendloop\n\
    endfacet\nendsolid\n";

/// Two strands of one and of two segments, with all arrays.
fn hair() -> Vec<u8> {
    let mut hair = b"HAIR".to_vec();
    hair.extend([2_u32, 5, 31, 0].into_iter().flat_map(u32::to_le_bytes));
    hair.resize(128, 0);
    hair.extend([1, 0, 2, 0]);
    hair.extend((0..40_u8).flat_map(|number| (f32::from(number) / 40.0).to_le_bytes()));
    hair
}

/// Small files of every kind, all good.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let mesh = Mesh {
        positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y],
        triangles: vec![[0, 1, 2]],
        normals: vec![glam::Vec3::Z; 3],
        ..Mesh::default()
    };
    let mut stl = vec![b' '; 80];
    stl[..6].copy_from_slice(b"COLOR=");
    stl.extend(2_u32.to_le_bytes());
    for facet in 0..2 {
        let values = [0.0, 0.0, 1.0, 0.0, 0.0, facet as f32, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        stl.extend(values.into_iter().flat_map(f32::to_le_bytes));
        stl.extend([1, 2]);
    }
    let big = String::from(
        "ply\nformat binary_big_endian 1.0\nelement vertex 2\nproperty float x\nproperty short y\nproperty list uchar float l\nproperty double z\nend_header\n",
    );
    let mut big = big.into_bytes();
    big.extend([0; 4 + 2 + 1 + 8]);
    big.extend([1, 1, 1, 1, 0, 1, 1, 9, 9, 9, 9, 0, 0, 0, 0, 0, 0, 0, 0]);
    let utf16 = [0xff, 0xfe].into_iter().chain(OBJ.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    vec![
        ("a.obj", OBJ.as_bytes().to_vec()),
        ("a.obj", utf16),
        ("a.ply", PLY.as_bytes().to_vec()),
        ("a.ply", EDGES.as_bytes().to_vec()),
        ("a.ply", lookfrom_scene::ply::write(&mesh)),
        ("a.ply", big),
        ("a.stl", STL.as_bytes().to_vec()),
        ("a.stl", stl),
        ("a.mtl", MTL.as_bytes().to_vec()),
        ("a.hair", hair()),
    ]
}

/// Reads a file (an MTL by way of an OBJ) and checks what the types promise.
fn read(name: &str, content: Vec<u8>) -> Result<(), String> {
    let (obj, mtl) =
        if name == "a.mtl" { (OBJ.as_bytes().to_vec(), content) } else { (content, MTL.as_bytes().to_vec()) };
    let name = if name == "a.mtl" { "a.obj" } else { name };
    let files = Memory([(PathBuf::from(name), obj), (PathBuf::from("a.mtl"), mtl)].into());
    let mut context = LoadContext::new(&files);
    let mut scene = Scene::default();
    let parts = model::read(Path::new(name), &mut context, &mut scene).map_err(|error| error.to_string())?;
    for part in &parts {
        assert!(part.material.is_none_or(|material| material.index() < scene.materials.len()));
        match &part.geometry {
            Geometry::Spheres(spheres) => {
                for sphere in &**spheres {
                    assert!(sphere.center.is_finite() && sphere.radius > 0.0 && sphere.radius.is_finite());
                }
            }
            Geometry::Curves(strands) => {
                for strand in &**strands {
                    assert!(strand.points.iter().all(|point| point.is_finite()));
                    assert!(strand.width[0] > 0.0 && strand.width[0].is_finite());
                }
            }
            Geometry::Mesh(mesh) => check(&scene.meshes[mesh.index()]),
            other => panic!("unexpected {other:?}"),
        }
    }
    Ok(())
}

fn check(mesh: &Mesh) {
    let count = mesh.positions.len();
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.positions.iter().all(|position| position.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < count));
    assert!(mesh.normals.is_empty() || mesh.normals.len() == count);
    assert!(mesh.normals.iter().all(|normal| normal.is_finite()));
    assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count);
    assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
    assert!(mesh.colors.is_empty() || mesh.colors.len() == count);
    assert!(mesh.colors.iter().flatten().all(|color| color.is_finite() && *color >= 0.0));
}

#[test]
fn what_is_many_is_read_in_good_time() {
    let libraries: String = (0..100_000).map(|number| format!("mtllib {number}.mtl\n")).collect();
    let elements: String = (0..50_000).map(|number| format!("element e{number} 0\n")).collect();
    let materials: String = (0..10_000).map(|number| format!("newmtl m{number}\n")).collect();
    let start = std::time::Instant::now();
    assert_eq!(read("a.obj", (libraries + OBJ).into_bytes()), Ok(()));
    assert_eq!(
        read("a.ply", PLY.replace("element extra", &(elements + "element extra")).into_bytes()),
        Ok(())
    );
    // The same library again and again.
    let again = OBJ.replace("mtllib a.mtl", &format!("mtllib {}", "a.mtl ".repeat(64)));
    let files =
        Memory([("a.obj".into(), again.into_bytes()), ("a.mtl".into(), materials.into_bytes())].into());
    let read = model::read(Path::new("a.obj"), &mut LoadContext::new(&files), &mut Scene::default());
    assert!(read.is_ok() && start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}

#[test]
fn the_seeds_are_good() {
    for (name, content) in seeds() {
        assert_eq!(read(name, content), Ok(()), "{name}");
    }
}

#[test]
fn every_truncation_is_survived() {
    for (name, content) in seeds() {
        for length in 0..content.len() {
            let _ = read(name, content[..length].to_vec());
        }
    }
}

#[test]
fn numbers_of_files_of_our_own_are_finite() {
    let mesh = Mesh {
        positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y],
        triangles: vec![[0, 1, 2]],
        normals: vec![glam::Vec3::Z; 3],
        uvs: vec![glam::Vec2::ONE; 3],
        ..Mesh::default()
    };
    let content = lookfrom_scene::ply::write(&mesh);
    // One face of a byte and three indices at the end, before it three vertices of eight numbers.
    let first = content.len() - 13 - 3 * 8 * 4;
    for place in (first..content.len() - 13).step_by(4) {
        for number in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut content = content.clone();
            content[place..place + 4].copy_from_slice(&number.to_le_bytes());
            let error = read("a.ply", content).unwrap_err();
            assert_eq!(error, "a.ply: a number of a vertex is infinite or not a number", "{place} {number}");
        }
    }
}

/// What a mutation puts in: bytes that mean something in these formats.
fn piece() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..5),
        prop::sample::select(vec![
            "-1",
            "0",
            "1e39",
            "nan",
            "-inf",
            "4294967295",
            "99999999999999999999",
            "\n",
            "\r",
            "\\\n",
            "/",
            "//",
            "#",
            " ",
            "\0",
            "f 1 2 3 4 1 2 3\n",
            "element vertex 1000000000000\n",
            "property list char char vertex_indices\n",
            "element face 9\n",
            "usemtl\n",
            "v 1 1 1\n",
            "s 4294967295\n",
            "mtllib a.mtl\n",
            "endsolid\n",
            "Kd",
            "d 0\n",
            "1e-45",
            "3.4e38",
            "1e-39",
        ])
        .prop_map(|text| text.as_bytes().to_vec()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn mutations_are_survived(
        seed in 0..seeds().len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..8_usize, piece()), 1..5),
    ) {
        let (name, mut content) = seeds().swap_remove(seed);
        for (place, removed, piece) in edits {
            let start = place.index(content.len() + 1);
            let end = (start + removed).min(content.len());
            content.splice(start..end, piece);
        }
        let _ = read(name, content);
    }

    #[test]
    fn noise_is_survived(
        name in prop::sample::select(vec!["a.obj", "a.ply", "a.stl", "a.mtl", "a.hair", "a"]),
        head in prop::sample::select(vec!["", "ply\nformat ascii 1.0\nelement vertex 9\n", "solid facet ", "v 0 0 0\nf "]),
        noise in prop::collection::vec(any::<u8>(), 0..400),
    ) {
        let _ = read(name, [head.as_bytes(), &noise].concat());
    }
}
