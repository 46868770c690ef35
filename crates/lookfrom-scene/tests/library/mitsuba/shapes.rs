//! Shapes of Mitsuba, serialized meshes, and their texture coordinates.

use std::path::PathBuf;

use glam::{DVec3, DVec4};
use lookfrom_scene::material::{Color, MaterialKind, Scalar};
use lookfrom_scene::scene::TextureId;
use lookfrom_scene::shape::Geometry;
use lookfrom_scene::texture::{Mapping, TexelFilter, TextureKind, Wrap};
use lookfrom_scene::{ErrorKind, Result, Scene};

use super::{files, near, read_of, scene, told};

#[test]
fn shapes_have_their_geometry_and_sides() {
    let (read, warnings) = told(
        r#"<shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="2"/></shape>
        <shape type="cylinder"><float name="radius" value="0.5"/><point name="p1" value="0 0 4"/></shape>
        <shape type="rectangle"><boolean name="flip_normals" value="true"/></shape>
        <shape type="disk"/>
        <shape type="obj"><string name="filename" value="m.obj"/><boolean name="face_normals" value="true"/></shape>
        <shape type="obj"><string name="filename" value="m.obj"/></shape>"#,
    );
    assert!(warnings.is_empty(), "{warnings:?}");
    let shapes = &read.shapes;
    assert!(matches!(shapes[0].geometry, Geometry::PartialSphere { radius: 2.0, .. }));
    assert_eq!(shapes[0].world_from_object.w_axis, DVec4::new(1.0, 2.0, 3.0, 1.0));
    let bounds = shapes[1].bounds(&read.meshes);
    assert!(
        near(bounds.min, DVec3::new(-0.5, -0.5, 0.0)) && near(bounds.max, DVec3::new(0.5, 0.5, 4.0)),
        "{bounds:?}"
    );
    assert!(shapes[2].reverse_orientation && !shapes[3].reverse_orientation);
    let mesh = |index: usize| match shapes[index].geometry {
        Geometry::Mesh(id) => &read.meshes[id.index()],
        ref other => panic!("{other:?}"),
    };
    assert!(mesh(4).normals.is_empty());
    assert_eq!(mesh(5).normals, [[0.0, 0.0, 1.0]; 3].map(glam::Vec3::from));
    // Mitsuba turns v of OBJ files around, so that pictures are as usual: here they are as usual.
    assert_eq!(mesh(5).uvs[2].to_array(), [0.0, 1.0]);
    // v of a rectangle grows upward in Mitsuba, so that its pictures stand on their heads.
    assert_eq!(mesh(2).uvs[0].to_array(), [0.0, 1.0]);
}

/// Positions far from the origin are relative to their middle, and still where the file has them.
#[test]
fn small_meshes_are_where_their_files_have_them() {
    let text = "<scene version=\"3.0.0\"><shape type=\"obj\"><string name=\"filename\" value=\"far.obj\"/>\
                <transform name=\"to_world\"><scale value=\"2\"/></transform></shape></scene>";
    let far = "v 10 -20 0\nv 10.1 -20 0\nv 10 -19.9 0\nf 1 2 3\n";
    let (read, _) = read_of(&files(&[("s/a.xml", text), ("s/far.obj", far)]), &[]);
    let read = read.expect("a scene");
    let bounds = read.shapes[0].bounds(&read.meshes);
    let is_at = |a: DVec3, b: [f64; 3]| (a - DVec3::from(b)).length() < 1e-5;
    assert!(is_at(bounds.min, [20.0, -40.0, 0.0]) && is_at(bounds.max, [20.2, -39.8, 0.0]), "{bounds:?}");
}

#[test]
fn mirrored_meshes_face_as_their_corners_turn() {
    let reversed = |more: &str| {
        let read = scene(&format!(
            "<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>{more}\
             <transform name=\"to_world\"><scale x=\"-1\"/></transform></shape>"
        ));
        read.shapes[0].reverse_orientation
    };
    assert!(reversed("") && reversed("<boolean name=\"face_normals\" value=\"true\"/>"));
    assert!(!reversed("<boolean name=\"flip_normals\" value=\"true\"/>"));
}

#[test]
fn v_runs_down_unless_it_is_turned_around() {
    let v_of = |flip: &str| {
        let read =
            scene(&format!("<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>{flip}</shape>"));
        read.meshes[0].uvs.iter().map(|uv| uv.y).collect::<Vec<f32>>()
    };
    assert_eq!(v_of(""), [0.0, 0.0, 1.0]);
    assert_eq!(v_of("<boolean name=\"flip_tex_coords\" value=\"true\"/>"), [0.0, 0.0, 1.0]);
    assert_eq!(v_of("<boolean name=\"flip_tex_coords\" value=\"false\"/>"), [1.0, 1.0, 0.0]);
}

#[test]
fn instances_place_groups() {
    let read = scene(
        r#"<shape type="shapegroup" id="g"><shape type="cube"/><shape type="sphere"/></shape>
        <shape type="instance"><ref id="g"/></shape>
        <shape type="instance"><ref id="g"/><transform name="to_world"><translate x="5"/></transform></shape>"#,
    );
    assert_eq!((read.objects.len(), read.objects[0].shapes.len(), read.shapes.len()), (1, 2, 0));
    assert_eq!(read.instances[1].world_from_object.w_axis.x, 5.0);
}

/// A serialized file of one mesh for each list of flags: a triangle at heights that rise by the number of the mesh.
fn serialized(version: u16, flags: &[u32]) -> Vec<u8> {
    let mut bytes = [0x041c_u16.to_le_bytes(), version.to_le_bytes()].concat();
    let mut places = Vec::new();
    for (index, &flags) in flags.iter().enumerate() {
        places.push(bytes.len() as u64);
        bytes.extend([0x041c_u16.to_le_bytes(), version.to_le_bytes()].concat());
        let mut mesh = flags.to_le_bytes().to_vec();
        if version == 4 {
            mesh.extend(b"name\0");
        }
        mesh.extend([3_u64.to_le_bytes(), 1_u64.to_le_bytes()].concat());
        let mut number = |value: f32| match flags & 0x2000 {
            0 => mesh.extend(value.to_le_bytes()),
            _ => mesh.extend(f64::from(value).to_le_bytes()),
        };
        let height = index as f32;
        [0.0, 0.0, height, 1.0, 0.0, height, 0.0, 1.0, height].into_iter().for_each(&mut number);
        if flags & 1 != 0 {
            (0..3).for_each(|_| [0.0, 0.0, 1.0].into_iter().for_each(&mut number));
        }
        if flags & 2 != 0 {
            [0.0, 0.0, 1.0, 0.0, 0.0, 1.0].into_iter().for_each(&mut number);
        }
        mesh.extend([0_u32, 1, 2].into_iter().flat_map(u32::to_le_bytes));
        let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        std::io::Write::write_all(&mut packed, &mesh).expect("memory");
        bytes.extend(packed.finish().expect("memory"));
    }
    for place in &places {
        match version {
            4 => bytes.extend(place.to_le_bytes()),
            _ => bytes.extend((*place as u32).to_le_bytes()),
        }
    }
    bytes.extend((places.len() as u32).to_le_bytes());
    bytes
}

/// The scene of a serialized file.
fn with_serialized(bytes: &[u8], index: u32) -> Result<Scene> {
    let text = format!(
        "<scene version=\"3.0.0\">\n<shape type=\"serialized\"><string name=\"filename\" value=\"m.serialized\"/>\
         <integer name=\"shape_index\" value=\"{index}\"/></shape>\n</scene>"
    );
    let mut memory = files(&[("s/a.xml", &text)]);
    memory.0.insert(PathBuf::from("s/m.serialized"), bytes.to_vec());
    read_of(&memory, &[]).0
}

#[test]
fn serialized_meshes_are_read_by_their_number() {
    for version in [3, 4] {
        let bytes = serialized(version, &[0x1000, 0x2003]);
        let plain = with_serialized(&bytes, 0).expect("a mesh");
        assert_eq!(
            (plain.meshes[0].positions[2].to_array(), plain.meshes[0].uvs.len()),
            ([0.0, 1.0, 0.0], 0)
        );
        let full = with_serialized(&bytes, 1).expect("a mesh");
        assert_eq!(full.meshes[0].positions[1].to_array(), [1.0, 0.0, 1.0]);
        assert_eq!(full.meshes[0].normals, [glam::Vec3::Z; 3]);
        // v runs up here.
        assert_eq!(full.meshes[0].uvs[2].to_array(), [0.0, 0.0]);
        assert_eq!(with_serialized(&bytes, 2).expect_err("two meshes").kind, ErrorKind::Invalid);
        // Files that are cut off or changed anywhere.
        for length in 0..bytes.len() {
            assert!(with_serialized(&bytes[..length], 0).is_err(), "{length}");
        }
        for place in 0..bytes.len() {
            let mut broken = bytes.clone();
            broken[place] ^= 0x55;
            let _ = with_serialized(&broken, 1);
        }
    }
    let unknown = with_serialized(&serialized(5, &[0]), 0).expect_err("a version to come");
    assert_eq!(unknown.kind, ErrorKind::Unsupported);
}

#[test]
fn textures_undo_the_direction_of_v() {
    let read = scene(
        r#"<shape type="cube"><bsdf type="blendbsdf"><texture name="weight" type="checkerboard"><transform name="to_uv">
            <scale x="3" y="5"/></transform></texture>
        <bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="p.pfm"/>
            <string name="wrap_mode" value="mirror"/><string name="filter_type" value="nearest"/>
            <transform name="to_uv"><scale x="2" y="4"/><translate x="0.5" y="0.25"/></transform></texture></bsdf>
        <bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="p.pfm"/></texture></bsdf>
        </bsdf></shape>"#,
    );
    let [TextureKind::Checker { mapping, even, .. }, TextureKind::Checker { even: odd, .. }, first, second] =
        [0, 1, 2, 3].map(|index| read.textures[index].kind.clone())
    else {
        panic!("{:?}", read.textures)
    };
    // As a number, which it is here, Mitsuba's checkerboard has its fields exchanged.
    let TextureKind::Mix { amount: Scalar::Texture(TextureId(1)), .. } = read.textures[4].kind else {
        panic!("{:?}", read.textures)
    };
    assert_eq!(odd, Color::gray(0.2));
    // 2 · 5 · (1 − v).
    assert_eq!(mapping, Mapping::Uv { scale: [6.0, -10.0], offset: [0.0, 10.0] });
    assert_eq!(even, Color::gray(0.4));
    let TextureKind::Image { mapping, wrap, filter, .. } = first else { panic!("{first:?}") };
    // 1 − (4 (1 − v) + ¼).
    assert_eq!(mapping, Mapping::Uv { scale: [2.0, 4.0], offset: [0.5, -3.25] });
    assert_eq!((wrap, filter), ([Wrap::Mirror; 2], TexelFilter::Nearest));
    assert!(matches!(second, TextureKind::Image { mapping: Mapping::UV, .. }), "{second:?}");
}

#[test]
fn u_is_the_radius_of_a_disk() {
    let checks =
        "<bsdf type=\"diffuse\" id=\"checks\"><texture type=\"checkerboard\" name=\"reflectance\"/></bsdf>";
    let (read, warnings) = told(&format!(
        "{checks}<shape type=\"disk\"><ref id=\"checks\"/></shape><shape type=\"cube\"><ref id=\"checks\"/></shape>"
    ));
    assert!(warnings.is_empty(), "{warnings:?}");
    let mapping = |shape: usize| {
        let MaterialKind::Diffuse { reflectance: Color::Texture(id) } =
            read.materials[read.shapes[shape].material.index()].kind
        else {
            panic!("{:?}", read.materials)
        };
        let TextureKind::Checker { mapping, .. } = read.textures[id.index()].kind else {
            panic!("{:?}", read.textures)
        };
        mapping
    };
    // Twice (1 − v, u) and twice (u, 1 − v).
    assert_eq!(mapping(0), Mapping::Affine { set: 0, matrix: [[0.0, -2.0, 2.0], [2.0, 0.0, 0.0]] });
    assert_eq!(mapping(1), Mapping::Uv { scale: [2.0, -2.0], offset: [0.0, 2.0] });
    let brushed = "<bsdf type=\"roughconductor\"><float name=\"alpha_u\" value=\"0.4\"/></bsdf>";
    let (_, warnings) = told(&format!("<shape type=\"disk\">{brushed}</shape>"));
    assert!(warnings.len() == 1 && warnings[0].contains("grain"), "{warnings:?}");
}

#[test]
fn curves_are_strands_of_bezier() {
    let of = |kind: &str, text: &str| {
        let scene = format!(
            "<scene version=\"3.0.0\">\n<shape type=\"{kind}\"><string name=\"filename\" value=\"c.txt\"/><bsdf type=\"hair\"/></shape>\n</scene>"
        );
        read_of(&files(&[("s/a.xml", &scene), ("s/c.txt", text)]), &[]).0
    };
    let strands = |scene: &Scene| match &scene.shapes[0].geometry {
        Geometry::Curves(strands) => strands.to_vec(),
        other => panic!("{other:?}"),
    };
    let two = "0 0 0 1\n2 0 0 3\n\n0 1 0 1\n0 2 0 1\n0 3 0 1\n";
    let linear = of("linearcurve", two).expect("curves");
    assert_eq!(strands(&linear).len(), 3);
    assert_eq!(
        (strands(&linear)[0].points[3].to_array(), strands(&linear)[0].width),
        ([2.0, 0.0, 0.0], [2.0, 6.0])
    );
    let MaterialKind::Hair(hair) = &linear.materials[linear.shapes[0].material.index()].kind else {
        panic!("no hair")
    };
    assert_eq!((hair.beta_m, hair.alpha), (Scalar::Value(0.3), Scalar::Value(2.0)));
    // A straight spline of equal steps goes from the second to the third point.
    let spline = of("bsplinecurve", "0 0 0 1\n1 0 0 1\n2 0 0 1\n3 0 0 1").expect("curves");
    let [first, .., last] = strands(&spline)[0].points;
    assert!((first.x - 1.0).abs() < 1e-6 && (last.x - 2.0).abs() < 1e-6, "{first} {last}");
    let short = of("bsplinecurve", two).expect_err("two points");
    assert_eq!((short.kind, short.at.line), (ErrorKind::Invalid, 3));
    assert_eq!(of("linearcurve", "1 2 3\n").expect_err("no radius").kind, ErrorKind::Invalid);
    assert_eq!(of("linearcurve", "\n\n").expect_err("nothing").kind, ErrorKind::Invalid);
}

#[test]
fn hair_on_what_is_no_curve_is_told_of() {
    let (_, warnings) = told("<shape type=\"cylinder\"><bsdf type=\"hair\"/></shape>");
    assert!(warnings.len() == 1 && warnings[0].contains("hair on what is no curve"), "{warnings:?}");
}
