//! Meshes whose lists are arrays of NumPy in files: the same as written lists, and errors that name the file or the key.

use std::path::Path;

use lookfrom_scene::{Budget, Error, LoadContext, Memory, Scene, load};

fn array(kind: &str, shape: [usize; 2], data: Vec<u8>) -> Vec<u8> {
    let header =
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}, {}), }}", shape[0], shape[1]);
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.into_bytes());
    bytes.extend(data);
    bytes
}

fn floats(rows: &[[f32; 3]]) -> Vec<u8> {
    array("<f4", [rows.len(), 3], rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect())
}

fn read(mesh: &str, positions: &[[f32; 3]], triangles: &[[i64; 3]]) -> Result<Scene, Error> {
    let corners = triangles.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let files = Memory(
        [
            ("a/scene.toml".into(), format!("[[mesh]]\n{mesh}").into_bytes()),
            ("a/p.npy".into(), floats(positions)),
            ("a/t.npy".into(), array("<i8", [triangles.len(), 3], corners)),
        ]
        .into(),
    );
    load::scene(Path::new("a/scene.toml"), &mut LoadContext::within(&Budget::default(), &files))
}

const POSITIONS: [[f32; 3]; 4] = [[0.0, 0.0, 0.1], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TRIANGLES: [[i64; 3]; 2] = [[0, 2, 1], [0, 1, 3]];
const BOTH: &str = "positions = { npy = \"p.npy\" }\ntriangles = { npy = \"t.npy\" }";

#[test]
fn arrays_are_lists() {
    let all = format!("{BOTH}\nnormals = {{ npy = \"p.npy\" }}\ncolors = {{ npy = \"p.npy\" }}");
    let of_arrays = read(&all, &POSITIONS, &TRIANGLES).unwrap();
    let written = format!(
        "positions = {POSITIONS:?}\ntriangles = {TRIANGLES:?}\nnormals = {POSITIONS:?}\ncolors = {POSITIONS:?}"
    );
    assert_eq!(format!("{:?}", of_arrays.meshes), format!("{:?}", read(&written, &[], &[]).unwrap().meshes));
}

#[test]
fn arrays_that_make_no_mesh_are_told() {
    for (mesh, positions, triangles, message) in [
        (BOTH, &POSITIONS[..], &[[0, 1, 4]][..], "there is no vertex 4"),
        (BOTH, &POSITIONS, &[[0, 1, -1]], "there is no vertex -1"),
        (BOTH, &POSITIONS, &[], "`triangles` is empty"),
        (BOTH, &[[f32::NAN; 3]; 4], &TRIANGLES, "`positions` has numbers that are not finite"),
        ("positions = { npy = \"no.npy\" }\ntriangles = []", &[], &[], "no such file"),
        ("positions = { npz = \"p.npy\" }\ntriangles = []", &[], &[], "npz"),
        ("positions = { npy = \"scene.toml\" }\ntriangles = []", &[], &[], "no array of NumPy"),
        (&format!("{BOTH}\nuvs = {{ npy = \"p.npy\" }}"), &POSITIONS, &TRIANGLES, "expected (n, 2)"),
        (
            &format!("{BOTH}\nnormals = {{ npy = \"t.npy\" }}"),
            &POSITIONS,
            &TRIANGLES,
            "`normals` has 2 values",
        ),
        (&format!("{BOTH}\ncolors = {{ npy = \"p.npy\" }}"), &[[-1.0; 3]; 4], &TRIANGLES, "negative"),
    ] {
        let error = read(mesh, positions, triangles).unwrap_err();
        assert!(error.each().any(|error| error.to_string().contains(message)), "{message}: {error}");
    }
}
