//! Models far from the origin, ranges of colours, and STL and OBJ files of careless programs.

use std::fmt::Write as _;
use std::path::Path;

use glam::{DVec3, Vec3};
use lookfrom_scene::scene::Scene;
use lookfrom_scene::shape::{Geometry, Mesh};
use lookfrom_scene::{LoadContext, Memory, load};

fn scene(name: &str, bytes: &[u8]) -> Result<(Scene, Vec<String>), String> {
    let mut files = Memory::default();
    files.0.insert(name.into(), bytes.to_vec());
    let mut context = LoadContext::new(&files);
    let scene = load::scene(Path::new(name), &mut context).map_err(|error| error.to_string())?;
    Ok((scene, context.warnings.iter().map(ToString::to_string).collect()))
}

/// The one mesh, and where its vertices are in the world.
fn placed(scene: &Scene) -> (&Mesh, Vec<DVec3>) {
    let [shape] = &scene.shapes[..] else { panic!("{} shapes", scene.shapes.len()) };
    let Geometry::Mesh(id) = shape.geometry else { panic!("{:?}", shape.geometry) };
    let mesh = &scene.meshes[id.index()];
    let world = |point: &Vec3| shape.world_from_object.transform_point3(point.as_dvec3());
    (mesh, mesh.positions.iter().map(world).collect())
}

/// Places of maps: UTM, a planet's centre, a mine's grid.
const PLACES: [[f64; 3]; 3] =
    [[500_123.25, 4_649_776.5, 117.0], [4_510_023.5, -4_510_023.25, 1.0e5], [1e7, 1e7, 1e7]];

/// A tetrahedron of the size of a chair.
const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.125, 0.0], [0.25, 1.0, 0.0], [0.25, 0.25, 0.875]];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

#[test]
fn models_of_maps_keep_their_shape() {
    for place in PLACES.map(DVec3::from) {
        let corners = CORNERS.map(|corner| DVec3::from(corner) + place);
        let row = |p: DVec3| format!("{} {} {}", p.x, p.y, p.z);
        let mut obj: String = corners.iter().map(|&corner| format!("v {}\n", row(corner))).collect();
        let mut stl = "solid a\n".to_owned();
        let head = |format: &str, kind: &str| {
            format!(
                "ply\nformat {format} 1.0\nelement vertex 4\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\n\
                     element face 4\nproperty list uchar int vertex_indices\nend_header\n"
            )
        };
        let mut ply = head("ascii", "float");
        corners.iter().for_each(|&corner| writeln!(ply, "{}", row(corner)).unwrap());
        let mut binary = head("binary_little_endian", "double").into_bytes();
        binary.extend(corners.iter().flat_map(DVec3::to_array).flat_map(f64::to_le_bytes));
        for [a, b, c] in FACES {
            writeln!(obj, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
            writeln!(ply, "3 {a} {b} {c}").unwrap();
            binary.push(3);
            binary.extend([a, b, c].iter().flat_map(|&index| (index as u32).to_le_bytes()));
            stl += "facet normal 0 0 0\nouter loop\n";
            [a, b, c].iter().for_each(|&k| writeln!(stl, "vertex {}", row(corners[k])).unwrap());
            stl += "endloop\nendfacet\n";
        }
        stl += "endsolid\n";
        for (name, bytes) in [
            ("a.obj", obj.as_bytes()),
            ("a.ply", ply.as_bytes()),
            ("b.ply", &binary),
            ("a.stl", stl.as_bytes()),
        ] {
            let (scene, said) = scene(name, bytes).unwrap();
            let (mesh, found) = placed(&scene);
            assert_eq!((mesh.triangles.len(), said), (4, vec![]), "{name}");
            for corner in corners {
                let nearest = found.iter().map(|point| point.distance(corner)).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-6, "{name}: {corner} is {nearest} off");
            }
        }
    }
}

#[test]
fn what_single_precision_cannot_hold_is_told() {
    // A ball of 10 cm in a binary STL at UTM coordinates: the file itself has steps of half a metre.
    let mut stl = vec![0; 80];
    stl.extend(4_u32.to_le_bytes());
    for face in FACES {
        stl.extend([0; 12]);
        for corner in face.map(|k| 0.1 * DVec3::from(CORNERS[k]) + DVec3::from(PLACES[0])) {
            stl.extend(corner.as_vec3().to_array().iter().flat_map(|value| value.to_le_bytes()));
        }
        stl.extend([0; 2]);
    }
    let (_, said) = scene("a.stl", &stl).unwrap();
    assert!(said.iter().any(|said| said.contains("single precision is too coarse")), "{said:?}");
    // Small things far apart from each other.
    let mut obj = String::new();
    for place in [-1e7, 1e7] {
        CORNERS.iter().for_each(|[x, y, z]| writeln!(obj, "v {} {y} {z}", x + place).unwrap());
    }
    for first in [1, 5] {
        FACES
            .iter()
            .for_each(|[a, b, c]| writeln!(obj, "f {} {} {}", first + a, first + b, first + c).unwrap());
    }
    let (_, said) = scene("a.obj", obj.as_bytes()).unwrap();
    assert!(said.iter().any(|said| said.contains("single precision is too coarse")), "{said:?}");
    let at_home: String = obj.replace("10000000", "3").replace("9999999", "2").replace("10000001", "4");
    assert_eq!(scene("a.obj", at_home.as_bytes()).unwrap().1.len(), 0);
}

fn colors(name: &str, text: &str) -> (Vec<[f32; 3]>, Vec<String>) {
    let (scene, said) = scene(name, text.as_bytes()).unwrap();
    (placed(&scene).0.colors.clone(), said)
}

#[test]
fn colours_of_vertices_in_every_range() {
    let obj = |tails: [&str; 3]| {
        let [a, b, c] = tails;
        colors("a.obj", &format!("v 0 0 0 {a}\nv 1 0 0 {b}\nv 0 1 0 {c}\nf 1 2 3\n"))
    };
    let orange = lookfrom_scene::image::linear_from_srgb(128.0 / 255.0);
    let (found, said) = obj(["255 128 0", "255 128 0", "0 0 255"]);
    assert_eq!(found, [[1.0, orange, 0.0], [1.0, orange, 0.0], [0.0, 0.0, 1.0]]);
    assert!(said.len() == 1 && said[0].contains("255 is taken to be white"), "{said:?}");
    let red = vec![[1.0, 0.0, 0.0]; 3];
    assert_eq!(obj(["1 1 0 0"; 3]), (red.clone(), vec![]), "x y z w r g b");
    assert_eq!(obj(["1 0 0 1"; 3]), (vec![[0.0, 0.0, 1.0]; 3], vec![]), "w, since it is 1");
    assert_eq!(obj(["1 0 0 1", "1 0 0 1", "0 0 1 1"]).0, [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(obj(["255 0 0 255", "255 0 0 255", "0 0 255 255"]).0[2], [0.0, 0.0, 1.0]);
    assert_eq!(obj(["1 0 0"; 3]), (red.clone(), vec![]));
    let (found, said) = obj(["1.5 0 0", "1 0 0", "1 0 0"]);
    assert!(found == red && said[0].contains("1 colours of vertices are above 1, up to 1.5"), "{said:?}");

    let ply = |kind: &str, color: &str| {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty {kind} red\n\
             property {kind} green\nproperty {kind} blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 {color}\n1 0 0 {color}\n0 1 0 {color}\n3 0 1 2\n"
        );
        colors("a.ply", &text)
    };
    let (found, said) = ply("float", "255 128 0");
    assert_eq!((found, said.len()), (vec![[1.0, orange, 0.0]; 3], 1));
    assert_eq!(ply("uchar", "255 128 0"), (vec![[1.0, orange, 0.0]; 3], vec![]));
    assert_eq!(ply("float", "1 0.5 0"), (vec![[1.0, 0.5, 0.0]; 3], vec![]));
    let (found, said) = ply("double", "2 0.5 0");
    assert!(found[0] == [2.0, 0.5, 0.0] && said[0].contains("above 1, up to 2"), "{said:?}");
}

/// A binary STL with this header and number of triangles, the tetrahedron, and bytes behind it.
fn stl(header: &str, count: u32, rest: &[u8]) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|&k| CORNERS[k]).flat_map(|value| (value as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes.extend(rest);
    bytes
}

#[test]
fn stl_files_of_careless_programs() {
    let triangles = |bytes: &[u8]| {
        let (scene, said) = scene("a.stl", bytes).unwrap();
        (placed(&scene).0.triangles.len(), said)
    };
    // "solid" and "facet" in the header of a binary file, which is longer than it says.
    for header in ["solid part", "solid facet normal", "solid a facet endsolid"] {
        let (count, said) = triangles(&stl(header, 4, b"by a program of somebody"));
        assert!(count == 4 && said.len() == 1 && said[0].contains("24 bytes after the last"), "{said:?}");
    }
    for (claimed, word) in [
        (0, "does not tell"),
        (u32::MAX, "does not tell"),
        (3, "3 triangles are declared"),
        (9, "9 triangles are declared"),
    ] {
        let (count, said) = triangles(&stl("solid facet", claimed, &[]));
        assert!(count == 4 && said.len() == 1 && said[0].contains(word), "{claimed}: {said:?}");
    }
    assert!(scene("a.stl", &stl("", 9, b"cut")).unwrap_err().contains("only bytes for 4"));
    let mut text = "Solid x\n".to_owned();
    for face in FACES {
        text += "Facet Normal 0 0 0\nOuter Loop\n";
        face.iter().for_each(|&k| {
            writeln!(text, "Vertex {} {} {}", CORNERS[k][0], CORNERS[k][1], CORNERS[k][2]).unwrap();
        });
        text += "End Loop\nend facet\n";
    }
    assert_eq!(triangles((text + "end solid x\n").as_bytes()), (4, vec![]));
}

#[test]
fn obj_lines_go_on_behind_blanks() {
    for end in ["\n", " \n", "\t \n", "\r\n", "  \r\n", " \r"] {
        let text = format!("v 0 0 \\{end}0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2\\{end} 3 \\{end} 4\n");
        let (scene, said) = scene("a.obj", text.as_bytes()).unwrap();
        assert_eq!((placed(&scene).0.triangles.len(), said), (2, vec![]), "{end:?}");
    }
}
