//! OBJ and MTL files of other programs: extensions of Wavefront's specification, and violations of it.

use super::*;

/// A triangle of material `m`, beside other things.
fn obj_with(more: &str) -> Vec<u8> {
    format!("{TRIANGLE}{more}usemtl m\nf 1 2 3\n").into_bytes()
}

#[test]
fn faces_with_wrong_indices_are_left_out_alone() {
    let read =
        |faces: &str| Model::of(&[("a.obj", format!("{TRIANGLE}vt 0 0\nvn 0 0 1\n{faces}").as_bytes())]);
    let model = read("f 1 2 3\nf 1 2 0\nf 1 2 9\nf 3 2 1\nf -9 1 2\nl 1 2\nl 1 7\n");
    assert_eq!(model.mesh(0).triangles.len(), 2);
    assert_eq!(
        model.warnings,
        ["a.obj:7: 4 elements left out: an index of a vertex (v) is out of range (the first is here)"]
    );
    // Texture coordinates and normals alone are lost.
    let model = read("f 1/0/0 2/1/1 3/5/9\nf 3/1/1 2/1/1 1/-4/1\n");
    assert_eq!(model.mesh(0).triangles.len(), 2);
    assert_eq!(model.mesh(0).uvs.len(), model.mesh(0).positions.len());
    assert_eq!(
        model.warnings,
        [
            "a.obj:6: 3 texture coordinates of corners ignored: an index is out of range (the first is here)",
            "a.obj:6: 2 normals of corners ignored: an index is out of range (the first is here)",
        ]
    );
}

#[test]
fn polypaint_of_zbrush_colors_vertices() {
    let model = Model::of(&[("a.obj", &obj_with("#MRGB ffff0000ff00ff00\n#MRGB ff0000ffff123456\n"))]);
    assert_eq!(model.mesh(0).colors, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let model = Model::of(&[("a.obj", &obj_with("#MRGB what is this?\n"))]);
    assert_eq!(model.mesh(0).colors, [[0.0; 3]; 0]);
}

#[test]
fn the_library_of_the_same_name_needs_no_name() {
    let red: (&str, &[u8]) = ("a.mtl", b"newmtl m\nKd 1 0 0\n");
    let model = Model::of(&[("a.obj", &obj_with("")), red]);
    assert_eq!(model.look(0).diffuse, Color::Value([1.0, 0.0, 0.0]));
    assert!(
        model.warnings[0].contains("`m` is in no library that is named: a.mtl is read, too"),
        "{:?}",
        model.warnings
    );
    // One that is named, but does not have it.
    let model = Model::of(&[("a.obj", &obj_with("mtllib b.mtl\n")), ("b.mtl", b"newmtl other\n"), red]);
    assert_eq!(model.look(0).diffuse, Color::Value([1.0, 0.0, 0.0]));
    let model = Model::of(&[("a.obj", &obj_with(""))]);
    assert_eq!((model.warnings.len(), model.parts[0].material), (0, None), "names without any library");
}

#[test]
fn opaque_things_have_the_illumination_model_of_glass_in_many_files() {
    let white: (&str, &[u8]) = ("d/w.ppm", WHITE);
    for mtl in [
        "Kd .5 .5 .5\nKs 1 1 1\nNs 50\nillum 7\n",
        "Kd .5 .5 .5\nKs 1 1 1\nNs 50\nNi 1\nTf 1 1 1\nillum 6\n",
        "Kd .5 .5 .5\nKs 1 1 1\nNs 50\nNi 1.5\nillum 7\nmap_Kd w.ppm\n",
        "Kd .5 .5 .5\nKs 1 1 1\nNs 50\nNi 1\nillum 4\n",
    ] {
        let model = with_material(mtl, &[white]);
        let look = model.look(0);
        assert_ne!(look.diffuse, Color::BLACK, "{mtl}");
        assert_eq!(
            (look.mirror, look.transmission, look.fresnel),
            (Color::BLACK, Color::BLACK, false),
            "{mtl}"
        );
        assert_eq!((look.specular, look.shininess), (Color::gray(1.0), 50.0), "{mtl}");
        assert_eq!(
            model.warnings.len(),
            usize::from(!mtl.contains("illum 4")),
            "{mtl}: {:?}",
            model.warnings
        );
    }
    for mtl in ["Kd 0 0 0\nillum 7\n", "Ni 1.5\nillum 6\n", "Kd 1 1 1\nTf .5 1 1\nillum 7\n"] {
        let model = with_material(mtl, &[]);
        assert_eq!((model.look(0).diffuse, model.warnings.len()), (Color::BLACK, 0), "{mtl}");
        assert_ne!(model.look(0).transmission, Color::BLACK, "{mtl}");
    }
    // What is partly transparent reflects by its model.
    let veil = with_material("Ks .5 .5 .5\nd .5\nillum 4\n", &[]);
    assert_eq!(veil.look(0).mirror, Color::gray(0.5));
}

#[test]
fn maps_of_scanning_telephones_are_those_of_physically_based_materials() {
    let (parts, blue) = (ppm([26, 128, 255]), ppm([128, 128, 255]));
    let model = pictured(
        "map_Kd p.ppm\nroughness 0.5\nmetallic 0.25\nmap_roughness p.ppm\nmap_ao p.ppm\nmap_tangentSpaceNormal n.ppm\n",
        &[("p.ppm", &parts), ("n.ppm", &blue)],
    );
    let look = model.principled();
    assert_eq!(look.metallic, Scalar::Value(0.25));
    assert!(matches!(look.roughness, Scalar::Texture(_)));
    assert!(matches!(model.material().bump_mapping, BumpMapping::NormalTexture(_)));
    assert_eq!(model.warnings, [""; 0]);
}

#[test]
fn a_black_factor_of_a_picture_is_none() {
    let model = with_material("Ke 0 0 0\nmap_Ke w.ppm\n", &[("d/w.ppm", WHITE)]);
    assert_eq!(model.picture(model.parts[0].emission.unwrap().radiance).0, [[1.0; 3]]);
}
