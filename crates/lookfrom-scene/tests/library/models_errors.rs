//! What is said of broken models: the place, what was found, what was expected.

use std::path::{Path, PathBuf};

use lookfrom_scene::{Limits, LoadContext, Memory, Scene, model};

/// All that is said of a file: its error if there is one, then its warnings.
fn said(name: &str, content: impl AsRef<[u8]>) -> String {
    said_within(name, content, Limits::default())
}

fn said_within(name: &str, content: impl AsRef<[u8]>, limits: Limits) -> String {
    let files = Memory([(PathBuf::from(name), content.as_ref().to_vec())].into());
    let mut context = LoadContext::new(&files);
    context.limits = limits;
    let result = model::read(Path::new(name), &mut context, &mut Scene::default());
    let error = result.err().map(|error| error.to_string());
    error.into_iter().chain(context.warnings.iter().map(ToString::to_string)).collect::<Vec<_>>().join("\n")
}

#[test]
fn files_that_are_no_models() {
    assert_eq!(said("a.obj", ""), "a.obj: the file is empty");
    assert_eq!(
        said("a.xyz", "nothing known"),
        "a.xyz: neither its name nor its content is that of a model\n  help: models are OBJ, PLY, STL or HAIR files, and level sets of VDB files"
    );
    assert_eq!(
        said("a.obj", "<html>\n<body>\n"),
        "a.obj: no vertices: there is no line that starts with `v`\n  \
         help: check that this is a Wavefront OBJ file and that it is whole\n\
         a.obj:1: 2 lines with an unknown keyword ignored, such as `<html>` (the first is here)"
    );
    assert_eq!(said("a.ply", "v 1 2 3"), "a.ply: not a PLY file: it does not start with `ply`");
    assert_eq!(
        said("a.stl", "what?"),
        "a.stl: 5 bytes are too few for an STL file\n  help: the file may be empty or cut off"
    );
}

#[test]
fn obj() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    assert_eq!(said("a.obj", "v 0 0 0\nv 1 zwei 0\n"), "a.obj:2:5: expected a number, found `zwei`");
    assert_eq!(said("a.obj", "v 0 0\n"), "a.obj:1:6: expected 3 numbers, found 2");
    assert_eq!(
        said("a.obj", format!("{triangle}f 1 2\t7\n")),
        "a.obj:4:7: index 7 is out of range: there are 3 vertices (v)\n  \
         help: indices count from 1; negative ones count back from the last"
    );
    assert_eq!(
        said("a.obj", format!("{triangle}f -1 -2 -4\n")),
        "a.obj:4:9: index -4 is out of range: there are 3 vertices (v)\n  \
         help: indices count from 1; negative ones count back from the last"
    );
    assert_eq!(
        said("a.obj", format!("{triangle}f 1 2 0\n")).lines().next().unwrap(),
        "a.obj:4:7: index 0 is out of range: there are 3 vertices (v)"
    );
    assert_eq!(
        said("a.obj", format!("{triangle}f 1 2 3/x\n")),
        "a.obj:4:7: expected a corner as `1`, `1/2`, `1//3` or `1/2/3`, found `3/x`"
    );
    assert_eq!(
        said(
            "a.obj",
            format!(
                "{triangle}v nan 1e39 0\nf 1 2 3\nf 1 2 4\nf 4 2 3\nf 1 2 2\nf 1 2\ncurv 1 2\np 1\ncall x\nfoo\n"
            )
        ),
        "a.obj:11: 1 point element left out: only faces and lines are drawn\n\
         a.obj:9: 1 face left out: fewer than three corners\n\
         a.obj:10: 1 curve or surface left out: free-form geometry is not supported\n\
         a.obj:12: 1 `call` or `csh` statement ignored: no other files or programs are run\n\
         a.obj:13: 1 line with an unknown keyword ignored, such as `foo`\n\
         a.obj:6: 2 faces left out: a coordinate is infinite or not a number (the first is here)\n\
         a.obj:8: 1 triangle left out: without area"
    );
    assert_eq!(
        said_within("a.obj", triangle, Limits { elements: 2, ..Limits::default() }),
        "a.obj:3: more than 2 vertices\n  help: split the model into several files"
    );
    assert_eq!(
        said("a.obj", format!("mtllib no such.mtl\n{triangle}usemtl red\nf 1 2 3\n")),
        "a.obj:1:8: material library `no`: no such file\n\
         a.obj:1:8: material library `such.mtl`: no such file\n\
         a.obj: 1 material not defined in any library, such as `red`: the default is used"
    );
}

#[test]
fn ply() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let vertices = "0 0 0\n1 0 0\n0 1 0\n";
    assert_eq!(
        said("a.ply", "ply\nformat ascii 1.0\nelement vertex many\n"),
        "a.ply:3:16: expected the number of rows of the element, found `many`"
    );
    assert_eq!(
        said("a.ply", "ply\nformat ebcdic 1.0\n"),
        "a.ply:2:8: expected `ascii`, `binary_little_endian` or `binary_big_endian`, found `ebcdic`"
    );
    assert_eq!(
        said("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty flot x\n"),
        "a.ply:4:10: expected a type such as `float` or `uchar`, found `flot`"
    );
    assert_eq!(
        said("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
        "a.ply:3:1: element `vertex` has no property `y`"
    );
    assert_eq!(
        said("a.ply", "ply\nformat ascii 1.0\n"),
        "a.ply:3: the header does not end: expected `end_header`\n  help: the file may be cut off"
    );
    assert_eq!(
        said(
            "a.ply",
            header.replace("vertex 3", "vertex 1000000000000").replace("ascii", "binary_little_endian")
        ),
        "a.ply:3:1: 1000000000000 rows of `vertex` are declared, of at least 12 bytes each, but only 0 bytes are left\n  \
         help: the file may be cut off, or its header may be wrong"
    );
    assert_eq!(
        said("a.ply", format!("{header}{vertices}3 0 1 3\n")),
        "a.ply:13: vertex index 3 is out of range: there are 3 vertices"
    );
    assert_eq!(
        said("a.ply", format!("{header}0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n")),
        "a.ply:11:3: expected a number, found `x`"
    );
    assert_eq!(
        said("a.ply", format!("{header}{vertices}3 0 1")),
        "a.ply:13: the file ends before all its values\n  help: the file may be cut off, or its header may be wrong"
    );
    let mut binary = header.replace("ascii", "binary_big_endian").into_bytes();
    binary.extend([0; 36]);
    binary.extend([3, 0, 0, 0, 0, 0, 0, 0, 1, 255, 255, 255, 255]);
    assert_eq!(
        said("a.ply", &binary),
        format!(
            "a.ply: vertex index -1 is out of range: there are 3 vertices (at byte {})",
            binary.len() - 13
        )
    );
    let nan = format!("{vertices}nan 0 0\n3 0 1 3\n2 0 1\n3 0 1 1\n");
    assert_eq!(
        said("a.ply", header.replace("vertex 3", "vertex 4").replace("face 1", "face 3") + &nan),
        "a.ply:15: 1 face left out: fewer than three corners\n\
         a.ply:14: 1 face left out: a coordinate is infinite or not a number\n\
         a.ply:16: 1 triangle left out: without area"
    );
}

#[test]
fn stl() {
    let facet = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
    let mut binary = vec![0; 84 + 49];
    binary[80] = 1;
    assert_eq!(
        said("a.stl", &binary),
        "a.stl: 1 triangle is declared, but there are only bytes for 0\n  \
         help: the file may be cut off, or it may not be an STL file"
    );
    assert_eq!(
        said("a.stl", format!("solid\n{}", facet.replace("1 0 0", "1 o 0"))),
        "a.stl:5:12: expected a coordinate, found `o`"
    );
    assert_eq!(
        said("a.stl", format!("solid\n{}", facet.replace("endloop", "endlop"))),
        "a.stl:7:2: expected `facet`, `vertex` or `endsolid`, found `endlop`"
    );
    assert_eq!(
        said("a.stl", format!("solid\n{}", facet.replace("  vertex 1 0 0\n", ""))),
        "a.stl:6:2: a facet with 2 vertices, expected 3"
    );
    assert_eq!(
        said("a.stl", &format!("solid\n{facet}")[..53]),
        "a.stl:5: the file ends within a facet\n  help: the file may be cut off"
    );
    assert_eq!(
        said("a.stl", format!("solid\n{facet}")),
        "a.stl:9: `endsolid` is missing: the file may be cut off"
    );
    assert_eq!(said("a.stl", "solid x\nendsolid x\n"), "a.stl: there are no triangles");
}

#[test]
fn pointers_of_git_lfs_are_told_in_place_of_any_model() {
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n";
    for name in ["a.obj", "a.ply", "a.stl", "a.xyz"] {
        let said = said(name, pointer);
        assert!(said.contains("pointer of Git LFS") && said.contains("`git lfs pull`"), "{name}: {said}");
    }
}
