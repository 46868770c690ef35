//! Files by the names that people and scenes give: packed ones, and ones that are not there.

use std::io::Write;
use std::path::{Path, PathBuf};

use lookfrom_scene::{Disk, Error, ErrorKind, Files as _, Limits, LoadContext, Memory, Scene, load, model};

const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const PLY: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const STL: &[u8] =
    b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
const PBRT: &[u8] = b"WorldBegin Shape \"plymesh\" \"string filename\" \"m.ply\"";

fn packed(content: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(content).unwrap();
    encoder.finish().unwrap()
}

fn memory(files: &[(&str, Vec<u8>)]) -> Memory {
    Memory(files.iter().map(|(name, bytes)| (PathBuf::from(name), bytes.clone())).collect())
}

fn read(name: &str, files: &Memory) -> Result<Scene, Error> {
    load::scene(Path::new(name), &mut LoadContext::new(files))
}

fn triangles(scene: &Scene) -> usize {
    scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum()
}

#[test]
fn packed_files_are_read_wherever_plain_ones_are() {
    let toml = |model: &str| format!("[[mesh]]\nfile = \"{model}\"\n").into_bytes();
    for (name, content) in [("m.obj", OBJ), ("m.ply", PLY), ("m.stl", STL)] {
        let gz = format!("{name}.gz");
        // By the name it has, in any case, by that of the unpacked file, and where the name says nothing.
        let names = [gz.clone(), gz.to_uppercase(), "m.gz".to_owned(), "m".to_owned()];
        for there in names {
            let files = memory(&[(&there, packed(content)), ("a.toml", toml(&there))]);
            assert_eq!(triangles(&read(&there, &files).unwrap()), 1, "{there}");
            assert_eq!(triangles(&read("a.toml", &files).unwrap()), 1, "a.toml with {there}");
        }
        let files = memory(&[(&gz, packed(content)), ("a.toml", toml(name))]);
        assert_eq!(triangles(&read(name, &files).unwrap()), 1, "{name}");
        assert_eq!(triangles(&read("a.toml", &files).unwrap()), 1, "a.toml with {name}");
    }
    // Scenes of pbrt, what they include, and their meshes.
    let main = b"Include \"b.pbrt\"";
    for (scene, part) in [("a.pbrt", "b.pbrt"), ("a.pbrt.gz", "b.pbrt.gz"), ("a.gz", "b.pbrt.gz")] {
        let bytes = |name: &str, text: &[u8]| if name.ends_with("gz") { packed(text) } else { text.to_vec() };
        let begins = [b"LookAt 0 0 5 0 0 0 0 1 0\n", &main[..]].concat();
        let files =
            memory(&[(scene, bytes(scene, &begins)), (part, bytes(part, PBRT)), ("m.ply.gz", packed(PLY))]);
        assert_eq!(triangles(&read(scene, &files).unwrap()), 1, "{scene}");
    }
}

#[test]
fn models_are_unpacked() {
    let files = memory(&[("m.obj.gz", packed(OBJ)), ("m.ply.gz", packed(PLY)), ("m.stl.gz", packed(STL))]);
    let (context, scene) = (&mut LoadContext::new(&files), &mut Scene::default());
    for name in ["m.obj", "m.ply.gz", "m.stl"] {
        assert_eq!(model::read(Path::new(name), context, scene).unwrap().len(), 1, "{name}");
    }
}

#[test]
fn the_unpacked_file_comes_first_and_packed_ones_are_limited() {
    let files = memory(&[("m.ply", PLY.to_vec()), ("m.ply.gz", b"\x1f\x8bdamaged".to_vec())]);
    assert_eq!(triangles(&read("m.ply", &files).unwrap()), 1);
    assert_eq!(read("m.ply.gz", &files).unwrap_err().kind, ErrorKind::Syntax);

    let bomb = packed(&vec![b' '; 64 << 20]);
    let files = memory(&[("m.obj.gz", bomb)]);
    let error = read("m.obj", &files).unwrap_err();
    assert_eq!((error.kind, &*error.at.file), (ErrorKind::Limit, "m.obj.gz"), "{error}");
    let files = memory(&[("m.ply.gz", packed(PLY))]);
    let limits = Limits { file_bytes: PLY.len() as u64 - 1, ..Limits::default() };
    let error =
        load::scene(Path::new("m.ply"), &mut LoadContext { limits, ..LoadContext::new(&files) }).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Limit, "{error}");

    let error = read("m.ply", &memory(&[])).unwrap_err();
    assert_eq!((error.kind, &*error.at.file), (ErrorKind::Io, "m.ply"), "{error}");
}

/// Line and message, without the line that is shown.
fn told(error: &Error) -> Vec<(u32, String)> {
    error.each().map(|error| (error.at.line, error.message.lines().next().unwrap().to_owned())).collect()
}

#[test]
fn all_missing_files_of_a_scene_are_told_of_at_once() {
    let text = "\
        WorldBegin\n\
        Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n\
        Texture \"b\" \"float\" \"imagemap\" \"string filename\" \"a.png\"\n\
        Material \"diffuse\" \"texture reflectance\" \"a\" \"string normalmap\" \"n.png\"\n\
        Shape \"plymesh\" \"string filename\" \"m.ply\"\n\
        Shape \"plymesh\" \"string filename\" \"there.ply\"\n\
        Shape \"plymesh\" \"string filename\" \"broken.ply\"\n\
        Shape \"plymesh\" \"string filename\" \"m.ply\"\n\
        Material \"conductor\" \"spectrum eta\" \"eta.spd\" \"spectrum k\" \"metal-Cu-kk\"\n\
        LightSource \"infinite\" \"string filename\" \"sky.exr\"\n";
    let there = || vec![("there.ply", PLY.to_vec()), ("broken.ply", b"ply\nformat".to_vec())];
    let mut files = there();
    files.push(("a.pbrt", text.as_bytes().to_vec()));
    let error = read("a.pbrt", &memory(&files)).unwrap_err();
    let expected = [
        (2, "a.png: no such file"),
        (4, "n.png: no such file"),
        (9, "there is no spectrum named \"eta.spd\", and no file eta.spd"),
        (9, "there is no spectrum named \"metal-Cu-kk\", and no file metal-Cu-kk"),
        (10, "sky.exr: no such file"),
    ];
    let expected = expected.map(|(line, message)| (line, message.to_owned()));
    assert_eq!(told(&error)[..5], expected);
    let rest: Vec<&str> = error.more[4..].iter().map(|error| &*error.at.file).collect();
    assert_eq!(rest, ["broken.ply", "a.pbrt"], "{error}");
    assert_eq!(told(&error)[6], (5, "m.ply: no such file".to_owned()));

    // What else is wrong comes after them.
    files.push(("a.pbrt", format!("{text}NamedMaterial \"x\"").into_bytes()));
    let error = read("a.pbrt", &memory(&files)).unwrap_err();
    assert_eq!(told(&error)[..5], expected);
    assert_eq!((error.more.len(), told(&error)[7].0), (7, 11), "{error}");

    // Where the missing part of a scene may be what makes a name known, the name is not told of.
    let parts = "Include \"c.pbrt\"\nInclude \"d.pbrt\"\nInclude \"c.pbrt\"\n";
    files.push(("a.pbrt", format!("{parts}{text}NamedMaterial \"x\"").into_bytes()));
    files.push(("d.pbrt", b"Include \"e.pbrt\"\nTranslate 1 0 0".to_vec()));
    let error = read("a.pbrt", &memory(&files)).unwrap_err();
    assert_eq!(error.at.line, 1);
    assert_eq!(error.more[0].at.to_string(), "d.pbrt:1:9");
    assert_eq!((error.more.len(), told(&error)[2].0), (8, 5), "{error}");
}

#[test]
fn of_very_many_missing_files_some_are_told_of() {
    let shapes: String =
        (0..51).map(|k| format!("Shape \"plymesh\" \"string filename\" \"{k}.ply\"\n")).collect();
    let error =
        read("a.pbrt", &memory(&[("a.pbrt", format!("WorldBegin\n{shapes}").into_bytes())])).unwrap_err();
    assert_eq!(error.each().count(), 51);
    assert!(error.to_string().ends_with("\n… and 31 more"), "{error}");
    let pictures: String = (0..3000)
        .map(|k| format!("Texture \"{k}\" \"float\" \"imagemap\" \"string filename\" \"{k}.png\"\n"))
        .collect();
    let error =
        read("a.pbrt", &memory(&[("a.pbrt", format!("WorldBegin\n{pictures}").into_bytes())])).unwrap_err();
    assert_eq!(error.each().count(), 1001);
}

/// As in scenes that were made where letters have no case and folders are divided by `\\`.
#[test]
fn names_from_windows_are_found() {
    let folder = std::env::temp_dir().join(format!("lookfrom-names-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("Textures")).unwrap();
    std::fs::write(folder.join("Textures/Wood.obj"), OBJ).unwrap();
    let read = |name: &str| Disk.read(&folder.join(name), 1 << 20);
    for name in ["Textures/Wood.obj", "textures/WOOD.OBJ", "Textures\\Wood.obj", "TEXTURES\\wood.obj"] {
        assert_eq!(read(name).unwrap(), OBJ, "{name}");
    }
    for name in ["Textures/Wood", "Textures/Wood.ob", "Texture/Wood.obj", "textures"] {
        assert_eq!(read(name).unwrap_err().kind, ErrorKind::Io, "{name}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
