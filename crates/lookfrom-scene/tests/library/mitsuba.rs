//! Scenes of Mitsuba in XML: what is read of each kind of plugin, what is said of faults, and hostile files.

mod attributes;
mod blends;
mod films;
mod phases;

use std::f32::consts::FRAC_1_PI;
use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, DVec4};
use lookfrom_scene::camera::{Projection, View};
use lookfrom_scene::excerpt::Excerpts;
use lookfrom_scene::light::{Edge, LightKind, MapRows, Projected, Sky};
use lookfrom_scene::material::{
    BackFace, BumpGuard, BumpMapping, Color, Distribution, Illuminant, Ior, Masking, MaterialKind, Metal,
    Microfacets, Plastic, Scalar,
};
use lookfrom_scene::medium::{Density, Extinction, Medium};
use lookfrom_scene::scene::TextureId;
use lookfrom_scene::settings::{Background, FilterShape, Integrator, Layers, PixelBounds, Sampler};
use lookfrom_scene::shape::{Geometry, Shape};
use lookfrom_scene::texture::{Mapping, TexelFilter, TextureKind, Wrap};
use lookfrom_scene::{Error, ErrorKind, LoadContext, Memory, Result, Scene, load};
use proptest::prelude::*;

fn files(files: &[(&str, &str)]) -> Memory {
    Memory(files.iter().map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec())).collect())
}

fn read_of(memory: &Memory, variables: &[(&str, &str)]) -> (Result<Scene>, Vec<String>) {
    let mut context = LoadContext::new(memory);
    context.limits.elements = 10_000;
    for (name, value) in variables {
        context.variables.values.insert((*name).to_owned(), (*value).to_owned());
    }
    let scene = load::scene(Path::new("s/a.xml"), &mut context);
    (scene, context.warnings.iter().map(ToString::to_string).collect())
}

/// The scene with these elements, and the warnings.
fn told(elements: &str) -> (Scene, Vec<String>) {
    let text = format!("<scene version=\"3.0.0\">\n{elements}\n</scene>");
    let (scene, warnings) =
        read_of(&files(&[("s/a.xml", &text), ("s/p.pfm", PICTURE), ("s/m.obj", MESH)]), &[]);
    (scene.unwrap_or_else(|error| panic!("{elements}: {error}")), warnings)
}

/// As [`told`], without warnings.
fn scene(elements: &str) -> Scene {
    let (scene, warnings) = told(elements);
    assert!(warnings.is_empty(), "{elements}: {warnings:?}");
    scene
}

fn error(elements: &str) -> Error {
    let text = format!("<scene version=\"3.0.0\">\n{elements}\n</scene>");
    read_of(&files(&[("s/a.xml", &text)]), &[]).0.expect_err(elements)
}

/// A grey picture of one texel.
const PICTURE: &str = "Pf\n1 1\n-1.0\n\0\0\0?";
const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

/// The matrix of the only shape, with this transform.
fn matrix(steps: &str) -> DMat4 {
    let scene =
        scene(&format!("<shape type=\"cube\"><transform name=\"to_world\">{steps}</transform></shape>"));
    scene.shapes[0].world_from_object
}

/// The material of a cube with this BSDF, and its shape.
fn material(bsdf: &str) -> (MaterialKind, Shape, Vec<String>) {
    let (scene, warnings) = told(&format!("<shape type=\"cube\">{bsdf}</shape>"));
    let shape = scene.shapes[0].clone();
    (scene.materials[shape.material.index()].kind.clone(), shape, warnings)
}

fn near(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-12
}

#[test]
fn parameters_have_defaults_that_come_first_or_from_outside() {
    let text = "<scene version=\"3.0.0\">\n<default name=\"kind\" value=\"per\"/><default name=\"kind\" value=\"x\"/>\n\
                <sensor type=\"$kind\"/></scene>";
    let memory = files(&[("s/a.xml", text)]);
    let (result, _) = read_of(&memory, &[]);
    let message = result.expect_err("per is no sensor").to_string();
    assert!(message.contains("s/a.xml:3:15: the sensor \"per\" is not supported"), "{message}");
    let text = r#"<scene version="3.0.0"><default name="spp" value="8"/><sensor type="perspective">
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor></scene>"#;
    let memory = files(&[("s/a.xml", text)]);
    let samples =
        |variables: &[(&str, &str)]| read_of(&memory, variables).0.map(|scene| scene.render.samples);
    assert_eq!(
        (samples(&[]), samples(&[("spp", "32")]), samples(&[("spp", "\"5\"")])),
        (Ok(8), Ok(32), Ok(5))
    );
    let stranger = samples(&[("sp", "32")]).expect_err("a slip");
    assert_eq!((stranger.kind, stranger.hint), (ErrorKind::Request, Some("did you mean `spp`?".into())));
    let missing = error("<shape type=\"$which\"/>");
    assert_eq!(missing.message, "the parameter `$which` has no value");
    assert_eq!((missing.at.line, missing.at.column), (2, 14));
}

#[test]
fn includes_paths_references_and_aliases_join_a_scene() {
    let main = r#"<scene version="3.0.0"><path value="../lib"/><include filename="parts.xml"/>
        <shape type="cube"><ref id="paint"/></shape>
        <shape type="cube"><ref id="later"/></shape>
        <bsdf type="diffuse" id="later"/></scene>"#;
    let parts =
        r#"<scene version="3.0.0"><include filename="deep.xml"/><alias id="red" as="paint"/></scene>"#;
    let deep = r##"<bsdf type="diffuse" id="red"><rgb name="reflectance" value="#ff0000"/></bsdf>"##;
    let memory = files(&[("s/a.xml", main), ("s/../lib/parts.xml", parts), ("s/../lib/deep.xml", deep)]);
    let (scene, warnings) = read_of(&memory, &[]);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    let reflectance = |index: usize| match scene.materials[scene.shapes[index].material.index()].kind {
        MaterialKind::Diffuse { reflectance } => reflectance,
        ref other => panic!("{other:?}"),
    };
    assert_eq!((reflectance(0), reflectance(1)), (Color::Value([1.0, 0.0, 0.0]), Color::gray(0.5)));
}

#[test]
fn transforms_apply_in_the_order_of_the_file() {
    let point = |steps: &str, p: [f64; 3]| matrix(steps).transform_point3(p.into());
    let first = point("<translate x=\"1\"/><scale value=\"2\"/>", [1.0, 0.0, 0.0]);
    let other = point("<scale value=\"2, 2, 2\"/><translate value=\"1 0 0\"/>", [1.0, 0.0, 0.0]);
    assert_eq!((first, other), (DVec3::new(4.0, 0.0, 0.0), DVec3::new(3.0, 0.0, 0.0)));
    assert_eq!(point("<rotate z=\"1\" angle=\"90\"/>", [1.0, 0.0, 0.0]), DVec3::Y);
    // The axis as it is, as Mitsuba takes it: ScalarTransform4f().rotate([1, 1, 0], 40).
    let sheared = point("<rotate value=\"1 1 0\" angle=\"40\"/>", [1.0, 0.0, 0.0]);
    assert!((sheared - DVec3::new(1.0, 0.233956, -0.642788)).length() < 1e-6, "{sheared}");
    let rows = "<matrix value=\"1 0 0 5  0 2 0 6  0 0 3 7  0 0 0 1\"/>";
    assert_eq!(point(rows, [1.0; 3]), DVec3::new(6.0, 8.0, 10.0));
    assert_eq!(point("<matrix value=\"0 1 0 1 0 0 0 0 1\"/>", [1.0, 2.0, 3.0]), DVec3::new(2.0, 1.0, 3.0));
    // x to the left, y up, z forward.
    let look = matrix("<lookat origin=\"1 2 3\" target=\"1 2 -5\" up=\"0 9 0\"/>");
    assert_eq!(look.x_axis, DVec4::NEG_X);
    assert_eq!((look.y_axis, look.z_axis), (DVec4::Y, DVec4::NEG_Z));
    assert_eq!(look.w_axis, DVec4::new(1.0, 2.0, 3.0, 1.0));
}

#[test]
fn names_of_old_versions_are_understood() {
    let text = r#"<scene version="0.6.0"><sensor type="perspective"><float name="fov" value="90"/>
        <string name="fovAxis" value="y"/><transform name="toWorld"><lookAt origin="0 0 1" target="0 0 0" up="0 1 0"/>
        </transform></sensor><shape type="cube"><transform name="toWorld"><rotate x="1" y="1" z="1" angle="-120"/></transform>
        </shape></scene>"#;
    let (scene, warnings) = read_of(&files(&[("s/a.xml", text)]), &[]);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    // Axes were of unit length.
    assert!(near(scene.shapes[0].world_from_object.x_axis.truncate(), DVec3::Z));
    let camera = scene.camera.expect("a camera");
    assert_eq!(camera.view.lookfrom(), DVec3::Z);
    let Projection::Perspective { fov } = camera.projection else { panic!("{:?}", camera.projection) };
    assert!((fov - 90.0).abs() < 1e-12 && warnings.is_empty(), "{fov} {warnings:?}");
}

#[test]
fn sensors_films_and_integrators_are_settings() {
    let read = scene(
        r#"<integrator type="moment"><integrator type="volpath"><integer name="max_depth" value="8"/></integrator></integrator>
        <sensor type="thinlens"><float name="fov" value="60"/><float name="aperture_radius" value="0.1"/>
            <float name="focus_distance" value="3"/>
            <film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/>
                <integer name="crop_offset_x" value="10"/><integer name="crop_width" value="20"/>
                <rfilter type="mitchell"/></film>
            <sampler type="multijitter"><integer name="sample_count" value="16"/></sampler></sensor>"#,
    );
    assert_eq!((read.render.integrator, read.render.depth, read.render.media), (Integrator::Path, 7, true));
    assert_eq!((read.render.samples, read.render.sampler), (16, Sampler::Sobol));
    assert_eq!(read.image.crop, Some(PixelBounds { x0: 10, y0: 0, x1: 30, y1: 100 }));
    assert!(matches!(read.image.filter.shape, FilterShape::Mitchell { .. }));
    let camera = read.camera.expect("a camera");
    let Projection::Perspective { fov } = camera.projection else { panic!("{:?}", camera.projection) };
    // tan 30° along x is half of that along y.
    assert!(((0.5 * fov).to_radians().tan() - 0.5 * 30.0_f64.to_radians().tan()).abs() < 1e-12);
    assert_eq!(camera.view, View::Matrix(DMat4::IDENTITY));
    assert_eq!(camera.lens.map(|lens| (lens.radius, lens.focus_distance)), Some((0.1, 3.0)));
    // Mitsuba's own defaults: 38.1848° along x, for 768 × 576.
    let plain = scene("<integrator type=\"direct\"/><sensor type=\"perspective\"/>");
    assert_eq!(
        (plain.image.width, plain.image.height, plain.render.samples, plain.render.depth),
        (768, 576, 4, 1)
    );
    let Some(Projection::Perspective { fov }) = plain.camera.map(|camera| camera.projection) else {
        panic!()
    };
    let along_x = 2.0 * ((0.5 * fov).to_radians().tan() * 768.0 / 576.0).atan().to_degrees();
    assert!((along_x - 38.1848).abs() < 1e-4, "{along_x}");
    let moved = scene(
        "<sensor type=\"perspective\"><float name=\"principal_point_offset_x\" value=\"0.25\"/>\
         <film type=\"hdrfilm\"><integer name=\"width\" value=\"10\"/><integer name=\"height\" value=\"10\"/></film></sensor>",
    );
    assert_eq!(moved.camera.and_then(|camera| camera.window).map(|window| window.x), Some([-0.5, 1.5]));
    let flat = scene("<sensor type=\"orthographic\"/>").camera.expect("a camera");
    assert_eq!(flat.projection, Projection::Orthographic { height: 2.0 * 576.0 / 768.0 });
    assert_eq!(scene("<integrator type=\"path\"/>").render.depth, 1000);
}

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
fn light_that_paths_cannot_find_is_warned_of() {
    let (read, warnings) = told(
        "<shape type=\"rectangle\"><emitter type=\"directionalarea\"><rgb name=\"radiance\" value=\"1\"/></emitter></shape>",
    );
    assert!(read.shapes[0].emission.is_none());
    assert!(matches!(&warnings[..], [warning] if warning.contains("directionalarea")), "{warnings:?}");
}

#[test]
fn maps_lie_over_all_of_a_blend() {
    let read = scene(
        "<shape type=\"cube\"><bsdf type=\"bumpmap\"><boolean name=\"use_shadowing_function\" value=\"false\"/>\
         <texture type=\"checkerboard\"/><bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.2\"/>\
         <bsdf type=\"diffuse\"/><bsdf type=\"conductor\"/></bsdf></bsdf></shape>",
    );
    let MaterialKind::Mix { materials, .. } = &read.materials[read.shapes[0].material.index()].kind else {
        panic!("no mix")
    };
    for id in materials {
        let part = &read.materials[id.index()];
        assert!(matches!(part.bump_mapping, BumpMapping::Bump(_)), "{part:?}");
        assert_eq!(part.bump_guard, Some(BumpGuard { turns: true, shadows: false }));
        assert_eq!(part.back_face, BackFace::Black);
    }
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

#[test]
fn bsdfs_become_materials() {
    let (glass, _, warnings) = material(
        "<bsdf type=\"dielectric\"><rgb name=\"specular_reflectance\" value=\"1\"/><float name=\"specular_transmittance\" value=\"0.5\"/></bsdf>",
    );
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(warning.contains("specular_transmittance"), "{warning}");
    let MaterialKind::Dielectric { eta: Ior::Value(eta), .. } = glass else { panic!("{glass:?}") };
    assert!((eta - 1.5046 / 1.000_277).abs() < 1e-6);
    let (metal, _, warnings) = material(
        "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"Al\"/><float name=\"alpha_u\" value=\"0.25\"/></bsdf>",
    );
    let MaterialKind::Conductor { metal, roughness, specular_reflectance, .. } = metal else {
        panic!("{metal:?}")
    };
    assert!(matches!(metal, Metal::Indices { illuminant: Illuminant::EqualEnergy, .. }));
    assert_eq!(specular_reflectance, Color::gray(1.0));
    let tinted = material(
        "<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"0.2 0.9 1.1\"/><rgb name=\"specular_reflectance\" value=\"0.5\"/></bsdf>",
    );
    let MaterialKind::Conductor { metal, specular_reflectance, .. } = tinted.0 else {
        panic!("{:?}", tinted.0)
    };
    assert!(matches!(metal, Metal::Indices { illuminant: Illuminant::D65, .. }));
    assert_eq!((specular_reflectance, tinted.2.len()), (Color::gray(0.5), 0));
    assert_eq!((roughness.u, roughness.v, roughness.remap), (Scalar::Value(0.25), Scalar::Value(0.1), false));
    let separable = |distribution| Microfacets { distribution, masking: Masking::Separable };
    assert_eq!(roughness.microfacets, separable(Distribution::Beckmann));
    assert!(warnings.is_empty(), "{warnings:?}");
    let mirror = material("<bsdf type=\"conductor\"/>").0;
    assert!(
        matches!(mirror, MaterialKind::Conductor { metal: Metal::Reflectance(white), .. } if white == Color::gray(1.0))
    );
    let (kind, shape, _) = material(
        "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.3\"/><bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf></bsdf>",
    );
    assert_eq!(
        (kind, shape.alpha),
        (MaterialKind::Diffuse { reflectance: Color::gray(0.5) }, Some(Scalar::Value(0.3)))
    );
    assert_eq!(material("<bsdf type=\"null\"/>").0, MaterialKind::Interface);
    let back_of = |text: &str| {
        let read = scene(&format!("<shape type=\"sphere\">{text}</shape>"));
        read.materials[read.shapes[0].material.index()].back_face
    };
    for (text, back) in [
        ("", BackFace::Black),
        ("<bsdf type=\"diffuse\"/>", BackFace::Black),
        ("<bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf>", BackFace::Own),
        ("<bsdf type=\"principled\"/>", BackFace::Black),
        ("<bsdf type=\"principled\"><float name=\"spec_trans\" value=\"1\"/></bsdf>", BackFace::Own),
        ("<bsdf type=\"twosided\"><bsdf type=\"principled\"/></bsdf>", BackFace::Own),
        ("<bsdf type=\"roughdielectric\"/>", BackFace::Own),
    ] {
        assert_eq!(back_of(text), back, "{text}");
    }
    // A BSDF that is named alone and in a `twosided` is a material for each.
    let read = scene(
        "<bsdf type=\"diffuse\" id=\"a\"/><bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf>\
         <shape type=\"sphere\"><ref id=\"a\"/></shape><shape type=\"sphere\"><ref id=\"b\"/></shape>",
    );
    let backs: Vec<BackFace> =
        read.shapes.iter().map(|shape| read.materials[shape.material.index()].back_face).collect();
    assert_eq!(backs, [BackFace::Black, BackFace::Own]);
    // The first BSDF is that of the outside; two diffuse ones are one with a texture.
    let two = |back: &str| {
        material(&format!("<bsdf type=\"twosided\"><bsdf type=\"diffuse\"/><bsdf type=\"{back}\"/></bsdf>")).0
    };
    assert!(matches!(two("conductor"), MaterialKind::Mix { amount: Scalar::Texture(_), .. }));
    assert!(matches!(two("diffuse"), MaterialKind::Diffuse { reflectance: Color::Texture(_) }));
    let mix = material(
        "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.2\"/><bsdf type=\"diffuse\"/><bsdf type=\"conductor\"/></bsdf>",
    );
    assert!(matches!(mix.0, MaterialKind::Mix { amount: Scalar::Value(0.2), .. }), "{:?}", mix.0);
    let (plastic, _, warnings) = material("<bsdf type=\"plastic\"/>");
    let eta = (1.49 / 1.000_277) as f32;
    let expected = Plastic {
        reflectance: Color::gray(0.5),
        specular_reflectance: Color::gray(1.0),
        eta,
        alpha: 0.0,
        microfacets: Microfacets::default(),
        is_nonlinear: false,
    };
    assert_eq!((plastic, warnings.len()), (MaterialKind::Plastic(Box::new(expected)), 0));
    let (plastic, _, warnings) = material(
        "<bsdf type=\"roughplastic\"><string name=\"distribution\" value=\"ggx\"/><boolean name=\"nonlinear\" value=\"true\"/></bsdf>",
    );
    let microfacets = separable(Distribution::TrowbridgeReitz);
    let expected = Plastic { alpha: 0.1, microfacets, is_nonlinear: true, ..expected };
    assert_eq!((plastic, warnings.len()), (MaterialKind::Plastic(Box::new(expected)), 0));
    let (principled, _, warnings) =
        material("<bsdf type=\"principled\"><float name=\"specular\" value=\"0.5\"/></bsdf>");
    let MaterialKind::Disney(look) = principled else { panic!("{principled:?}") };
    assert!(look.eta == Scalar::Value(1.5) && warnings.is_empty() && !look.is_thin, "{look:?} {warnings:?}");
    let thin = material("<bsdf type=\"principledthin\"><float name=\"diff_trans\" value=\"0.6\"/></bsdf>").0;
    assert!(
        matches!(thin, MaterialKind::Disney(look) if look.is_thin && look.diff_trans == Scalar::Value(0.6))
    );
    let bumpy = scene(
        "<shape type=\"cube\"><bsdf type=\"bumpmap\"><texture type=\"checkerboard\"/><bsdf type=\"diffuse\"/></bsdf></shape>",
    );
    let of_shape = &bumpy.materials[bumpy.shapes[0].material.index()];
    assert!(matches!(of_shape.bump_mapping, BumpMapping::Bump(Scalar::Texture(_))));
}

#[test]
fn emitters_have_the_intensities_of_whitted() {
    let read = scene(
        r#"<emitter type="point"><point name="position" value="1 2 3"/><rgb name="intensity" value="6"/></emitter>
        <emitter type="directional"><vector name="direction" value="0 0 -1"/></emitter>
        <emitter type="envmap"><string name="filename" value="p.pfm"/><float name="scale" value="2"/></emitter>
        <emitter type="constant"><spectrum name="radiance" value="0.5"/></emitter>
        <shape type="sphere"><emitter type="area"><spectrum name="radiance" value="300:2, 900:2"/></emitter></shape>"#,
    );
    let scales: Vec<f32> = read.lights.iter().map(|light| light.power.scale).collect();
    assert_eq!(scales[..3], [FRAC_1_PI, FRAC_1_PI, 1.0]);
    // A constant spectrum of light is one of equal energy: in Mitsuba [0.602, 0.474, 0.454].
    assert!((scales[3] - 0.5).abs() < 1e-6, "{}", scales[3]);
    assert!(
        matches!(read.lights[0].kind, LightKind::Point { intensity, .. } if intensity == Color::gray(6.0))
    );
    let LightKind::Environment {
        sky: Sky::Image { scale, world_from_light, rows: MapRows::ToPoles, .. },
        ..
    } = read.lights[2].kind
    else {
        panic!("{:?}", read.lights[2].kind)
    };
    // The middle of our pictures is −z, the left edge of Mitsuba's is.
    assert_eq!(world_from_light.transform_vector3(DVec3::NEG_Z), DVec3::Z);
    assert_eq!(scale, [2.0; 3]);
    let emission = read.shapes[0].emission.expect("an area light");
    assert!(matches!(emission.radiance, Color::Curve(_)) && (emission.power.scale - 2.0).abs() < 1e-5);
    // An emitter without a BSDF is black.
    let black = &read.materials[read.shapes[0].material.index()];
    assert_eq!(black.kind, MaterialKind::Diffuse { reflectance: Color::BLACK });
}

#[test]
fn spots_and_projectors_have_pictures_and_linear_edges() {
    let read = scene(
        r#"<emitter type="spot"><float name="cutoff_angle" value="40"/></emitter>
        <emitter type="spot"><float name="cutoff_angle" value="30"/><float name="beam_width" value="10"/>
            <rgb name="intensity" value="2 3 4"/>
            <texture name="texture" type="bitmap"><string name="filename" value="p.pfm"/></texture></emitter>
        <emitter type="projector"><float name="fov" value="60"/><float name="scale" value="5"/>
            <texture name="irradiance" type="bitmap"><string name="filename" value="p.pfm"/>
            <string name="filter_type" value="nearest"/></texture></emitter>
        <emitter type="projector"><rgb name="irradiance" value="1 2 3"/></emitter>"#,
    );
    let LightKind::Spot { cone_angle: 40.0, inner_angle: 30.0, edge: Edge::Linear, .. } = read.lights[0].kind
    else {
        panic!("{:?}", read.lights[0])
    };
    let LightKind::Projection { image, filter, quantity, cone, fov, world_from_light, .. } =
        read.lights[1].kind
    else {
        panic!("{:?}", read.lights[1])
    };
    // The colour of the light is in its picture, whose rows run up.
    assert_eq!(read.images[image.index()].texel(0), [1.0, 1.5, 2.0]);
    assert_eq!(
        (filter, quantity, cone, fov),
        (TexelFilter::Bilinear, Projected::Intensity, Some([30.0, 10.0]), 60.0)
    );
    assert_eq!(world_from_light.transform_vector3(DVec3::ONE), DVec3::new(1.0, -1.0, 1.0));
    assert_eq!(read.lights[1].power.scale, FRAC_1_PI);
    let LightKind::Projection { filter, quantity, cone: None, fov, world_from_light, .. } =
        read.lights[2].kind
    else {
        panic!("{:?}", read.lights[2])
    };
    assert_eq!((filter, quantity), (TexelFilter::Nearest, Projected::Irradiance));
    assert!((fov - 60.0).abs() < 1e-4 && read.lights[2].power.scale == 5.0, "{fov}");
    assert_eq!(world_from_light.transform_vector3(DVec3::ONE), DVec3::new(-1.0, 1.0, 1.0));
    let LightKind::Projection { image, .. } = read.lights[3].kind else { panic!("{:?}", read.lights[3]) };
    assert_eq!(read.images[image.index()].texel(0), [1.0, 2.0, 3.0]);
    assert!(error("<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"90\"/><texture name=\"texture\" type=\"bitmap\"/></emitter>").message.contains("cutoff_angle"));
}

/// A mesh with an attribute of faces and one of vertices.
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
fn media_are_absorption_and_scattering() {
    let read = scene(
        r#"<medium type="homogeneous" id="fog"><rgb name="sigma_t" value="1 2 4"/><float name="albedo" value="0.75"/>
            <float name="scale" value="3"/><phase type="hg"><float name="g" value="0.5"/></phase></medium>
        <shape type="sphere"><bsdf type="null"/><ref name="interior" id="fog"/></shape>
        <shape type="cube"><bsdf type="null"/><ref name="interior" id="fog"/></shape>"#,
    );
    let [fog] = &read.media[..] else { panic!("{:?}", read.media) };
    assert_eq!(
        fog.extinction,
        Extinction::Sum { sum: Color::Value([1.0, 2.0, 4.0]), albedo: Color::gray(0.75) }
    );
    assert_eq!((fog.g, fog.scale), (0.5, 3.0));
    let sides = read.shapes[1].sides.expect("sides");
    assert!(sides.inside.is_some() && sides.outside.is_none());
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
fn skies_blackbodies_and_old_integrators_are_understood() {
    let (read, warnings) = told(
        r#"<integrator type="aov"><string name="aovs" value="d:depth"/><integrator type="bdpt"/></integrator>
        <sensor type="radiancemeter"><film type="ldrfilm"><integer name="width" value="1"/>
            <integer name="height" value="1"/></film><sampler type="sobol"/></sensor>
        <emitter type="sunsky"><vector name="sun_direction" value="0 1 1"/></emitter>
        <emitter type="constant"><spectrum name="radiance" type="blackbody"><float name="temperature" value="5000"/></spectrum></emitter>
        <shape type="merge"><shape type="cube"/><shape type="sphere"/></shape>"#,
    );
    assert_eq!(
        (read.shapes.len(), read.image.layers, read.render.integrator),
        (2, Layers::Geometry, Integrator::Path)
    );
    assert!(
        matches!(read.camera.expect("a camera").projection, Projection::Perspective { fov } if fov < 1e-3)
    );
    let LightKind::Environment { sky: Sky::Octahedral { world_from_light, .. }, .. } = read.lights[0].kind
    else {
        panic!("{:?}", read.lights[0])
    };
    assert_eq!(world_from_light, DMat4::IDENTITY);
    // Planck's law in W/(m² sr nm), by the luminous efficiencies of 1 nm steps.
    let luminance = f64::from(read.lights[1].power.scale);
    assert!((luminance / 12_579.29 - 1.0).abs() < 2e-3, "{luminance}");
    assert_eq!(warnings.len(), 2, "{warnings:?}");
}

#[test]
fn the_sun_is_told_by_place_and_time() {
    let picture = |elements: &str| {
        let (read, warnings) = told(&format!("<emitter type=\"sunsky\">{elements}</emitter>"));
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        read.images[0].clone()
    };
    let default = picture("");
    let told = picture("<vector name=\"sun_direction\" value=\"0.0513854 0.691748 0.720308\"/>");
    let differs = default.texels().zip(told.texels()).filter(|(a, b)| (a[1] / b[1] - 1.0).abs() > 0.01);
    // The rim of the sun.
    assert!(differs.count() < 64);
    let morning = picture("<float name=\"hour\" value=\"9\"/>");
    assert_ne!(morning.texels().collect::<Vec<_>>(), default.texels().collect::<Vec<_>>());
    let wrong = error("<emitter type=\"sunsky\"><integer name=\"month\" value=\"13\"/></emitter>");
    assert_eq!(wrong.kind, ErrorKind::Invalid);
}

#[test]
fn integrators_for_derivatives_make_pictures_of_others() {
    let render = |integrator: &str| told(integrator).0.render;
    let adjoint = render("<integrator type=\"prbvolpath\"/>");
    assert_eq!((adjoint.integrator, adjoint.depth, adjoint.media), (Integrator::Path, 5, true));
    let direct = render("<integrator type=\"direct_projective\"/>");
    assert_eq!((direct.integrator, direct.depth), (Integrator::Path, 1));
    assert_eq!(render("<integrator type=\"depth\"/>").integrator, Integrator::Depth);
}

#[test]
fn masks_do_not_thin_what_emitters_emit() {
    let lamp = |opacity: &str| {
        let mask = format!("<bsdf type=\"mask\">{opacity}<bsdf type=\"diffuse\"/></bsdf>");
        let emitter = "<emitter type=\"area\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter>";
        let read = scene(&format!("<shape type=\"rectangle\">{mask}{emitter}</shape>"));
        let emission = read.shapes[0].emission.expect("a lamp");
        (read, emission)
    };
    let (_, quarter) = lamp("<float name=\"opacity\" value=\"0.25\"/>");
    assert_eq!((quarter.radiance, quarter.power.scale), (Color::Value([1.0, 2.0, 3.0]), 4.0));
    let (read, checks) = lamp("<texture name=\"opacity\" type=\"checkerboard\"/>");
    let Color::Texture(id) = checks.radiance else { panic!("{checks:?}") };
    let TextureKind::Scale { color, by: Scalar::Texture(by) } = read.textures[id.index()].kind else {
        panic!("{:?}", read.textures)
    };
    assert_eq!(color, Color::Value([1.0, 2.0, 3.0]));
    let opacity = read.shapes[0].alpha.expect("an opacity");
    assert_eq!(read.textures[by.index()].kind, TextureKind::Quotient { a: Scalar::Value(1.0), b: opacity });
}

#[test]
fn hidden_emitters_are_seen_by_no_camera() {
    let hidden =
        scene("<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>");
    assert!(hidden.render.hide_lights);
    assert_eq!(hidden.image.background, Background::Transparent);
}

/// A `.vol` file.
fn volume(size: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1, size[0], size[1], size[2], channels].into_iter().flat_map(i32::to_le_bytes));
    bytes.extend([0.0_f32, 0.0, 0.0, 2.0, 3.0, 4.0].into_iter().flat_map(f32::to_le_bytes));
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// The medium of these elements, with a volume `v.vol`.
fn heterogeneous(elements: &str, bytes: Vec<u8>) -> Result<Medium> {
    let text = format!(
        "<scene version=\"3.0.0\">\n<medium type=\"heterogeneous\" id=\"m\">{elements}</medium>\
         <shape type=\"cube\"><bsdf type=\"null\"/><ref name=\"interior\" id=\"m\"/></shape>\n</scene>"
    );
    let mut memory = files(&[("s/a.xml", &text)]);
    memory.0.insert(PathBuf::from("s/v.vol"), bytes);
    read_of(&memory, &[]).0.map(|scene| scene.media[0].clone())
}

#[test]
fn volumes_are_grids_whose_outermost_cells_go_on() {
    let grid = "<volume name=\"sigma_t\" type=\"gridvolume\"><string name=\"filename\" value=\"v.vol\"/>\
                <boolean name=\"use_grid_bbox\" value=\"true\"/></volume><rgb name=\"albedo\" value=\"0.5 0.25 0\"/>";
    let medium = heterogeneous(grid, volume([2, 1, 1], 1, &[1.0, 3.0])).expect("a medium");
    assert_eq!(
        medium.extinction,
        Extinction::Sum { sum: Color::gray(1.0), albedo: Color::Value([0.5, 0.25, 0.0]) }
    );
    let variation = medium.variation.expect("a grid");
    assert_eq!(variation.world_from_medium, DMat4::from_scale(DVec3::new(2.0, 3.0, 4.0)));
    assert_eq!(
        variation.bounds.map(|[low, high]| (low.to_array(), high.to_array())),
        Some(([0.0; 3], [1.0; 3]))
    );
    let Density::Grid(placed) = variation.density else { panic!("{:?}", variation.density) };
    assert_eq!(placed.grid.size(), [4, 3, 3]);
    assert_eq!([0, 1, 2, 3].map(|x| placed.grid.value([x, 2, 0])), [1.0, 1.0, 3.0, 3.0]);
    assert_eq!(placed.bounds.map(|corner| corner.to_array()), [[-0.5, -1.0, -1.0], [1.5, 2.0, 2.0]]);

    // Colours by place.
    let colored = "<float name=\"sigma_t\" value=\"2\"/><volume name=\"albedo\" type=\"gridvolume\">\
                   <string name=\"filename\" value=\"v.vol\"/></volume>";
    let medium =
        heterogeneous(colored, volume([1, 1, 2], 3, &[0.5, 0.25, 0.0, 1.0, 1.0, 1.0])).expect("a medium");
    let Some(Density::Colors { absorption: Some(absorption), scattering: Some(scattering), .. }) =
        medium.variation.map(|variation| variation.density)
    else {
        panic!("colours")
    };
    assert_eq!(
        [absorption.grid.value([1, 1, 1]), scattering.grid.value([1, 1, 1])],
        [[1.0, 1.5, 2.0], [1.0, 0.5, 0.0]]
    );
    assert_eq!([absorption.grid.value([1, 1, 2]), scattering.grid.value([1, 1, 2])], [[0.0; 3], [2.0; 3]]);

    for (bytes, kind) in [
        (volume([2, 1, 1], 1, &[1.0]), ErrorKind::Syntax),
        (volume([2, 1, 1], 1, &[1.0, -1.0]), ErrorKind::Invalid),
        (volume([2, 1, 1], 1, &[1.0, f32::NAN]), ErrorKind::Invalid),
        (volume([i32::MAX; 3], 3, &[1.0]), ErrorKind::Invalid),
        (volume([-1, 1, 1], 1, &[]), ErrorKind::Invalid),
        (volume([1, 1, 1], 2, &[1.0, 1.0]), ErrorKind::Invalid),
        (b"VOL\x02".repeat(20), ErrorKind::Unsupported),
        (b"VOL".to_vec(), ErrorKind::Syntax),
    ] {
        assert_eq!(heterogeneous(grid, bytes).expect_err("a fault").kind, kind);
    }
}

#[test]
fn what_has_no_effect_is_warned_of() {
    let (_, warnings) = told(
        "<shape type=\"cube\">\n<float name=\"raduis\" value=\"2\"/><bsdf type=\"diffuse\" id=\"d\"/></shape>\n\
         <bsdf type=\"diffuse\" id=\"unused\"><float name=\"x\" value=\"1\"/></bsdf>",
    );
    assert_eq!(warnings, ["s/a.xml:3:29: the `raduis` of the shape \"cube\" has no effect here"]);
}

#[test]
fn errors_have_their_place_and_a_remedy() {
    for (elements, at, message, hint) in [
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"x\"/></shape>",
            50,
            "\"x\" is not a number, or too large",
            "",
        ),
        ("<shape type=\"spere\"/>", 14, "the shape \"spere\" is not supported", "did you mean \"sphere\"?"),
        (
            "<shape type=\"ellipsoids\"/>",
            14,
            "the shape \"ellipsoids\" is not supported",
            "there are: bsplinecurve",
        ),
        ("<shap type=\"sphere\" name=\"x\"/>", 1, "<shap> is not a known element", "did you mean <shape>?"),
        ("<shape type=\"cube\"><ref id=\"b\"/></shape>", 29, "\"b\" is not a known id", ""),
        ("<float name=\"x\" valeu=\"1\"/>", 17, "<float> has no attribute `valeu`", "it has: name, value"),
        ("<shape type=\"cube\"><ref/></shape>", 20, "this <ref> has no `id`", ""),
        ("<emitter type=\"area\"/>", 16, "an area light is a part of a shape", "write <emitter"),
        (
            "<shape type=\"ply\"><string name=\"filename\" value=\"no.ply\"/></shape>",
            50,
            "s/no.ply: no such file",
            "",
        ),
        ("words", 0, "unexpected text between elements", "comments are"),
        (
            "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"0\"/></transform></shape>",
            20,
            "`to_world` has to be a transform that can be inverted",
            "",
        ),
    ] {
        let found = error(elements);
        assert_eq!(found.message, message);
        if at > 0 {
            assert_eq!((found.at.line, found.at.column), (2, at), "{elements}");
        }
        let hinted = found.hint.map(|hint| hint.to_string()).unwrap_or_default();
        assert!(hinted.starts_with(hint), "{elements}: {hinted}");
    }
    let text = "<scene version=\"3.0.0\">\n  <shape type=\"sphree\"/>\n</scene>";
    let memory = files(&[("s/a.xml", text)]);
    let found = read_of(&memory, &[]).0.expect_err("a slip");
    let shown = Excerpts::new(&memory).of(&found.at).expect("a line").to_string();
    assert_eq!(shown, "  <shape type=\"sphree\"/>\n               ^^^^^^");
    let broken = read_of(&files(&[("s/a.xml", "<scene version=\"3.0.0\">\n<shape>\n</scene>")]), &[]);
    let broken = broken.0.expect_err("no end");
    assert_eq!((broken.kind, broken.at.line), (ErrorKind::Syntax, 3));
}

#[test]
fn hostile_files_end_in_errors() {
    let of = |text: &str| read_of(&files(&[("s/a.xml", text)]), &[]).0.expect_err("hostile");
    let bomb = "<!DOCTYPE scene [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]>\n<scene version=\"&b;\"/>";
    assert_eq!(of(bomb).kind, ErrorKind::Unsupported);
    let endless =
        of("<scene version=\"3.0.0\"><include filename=\"a.xml\"/><include filename=\"a.xml\"/></scene>");
    assert_eq!(endless.kind, ErrorKind::Limit);
    let deep = format!("<scene version=\"3.0.0\">{}", "<bsdf type=\"twosided\">".repeat(100_000));
    assert!(matches!(of(&deep).kind, ErrorKind::Syntax | ErrorKind::Limit));
    let closed = "<bsdf type=\"twosided\">".repeat(10_000) + &"</bsdf>".repeat(10_000);
    assert_eq!(error(&closed).kind, ErrorKind::Limit);
    assert_eq!(
        error("<shape type=\"sphere\"><float name=\"radius\" value=\"1e400\"/></shape>").kind,
        ErrorKind::Invalid
    );
    let huge = "<scale value=\"1e38\"/>".repeat(20);
    let huge =
        error(&format!("<shape type=\"cube\"><transform name=\"to_world\">{huge}</transform></shape>"));
    assert_eq!(huge.kind, ErrorKind::Invalid);
    // Each parameter is twice as long as the one before it.
    let doubled: String =
        (1..60).map(|k| format!("<default name=\"p{k}\" value=\"$p{}$p{}\"/>\n", k - 1, k - 1)).collect();
    assert_eq!(error(&format!("<default name=\"p0\" value=\"xx\"/>{doubled}")).kind, ErrorKind::Limit);
    // Many long values, each within its limit.
    let long = format!("<default name=\"p\" value=\"{}\"/>", "x".repeat(60_000));
    let uses: String = (0..500).map(|k| format!("<string name=\"s{k}\" value=\"$p\"/>")).collect();
    assert_eq!(error(&format!("{long}<shape type=\"cube\">{uses}</shape>")).kind, ErrorKind::Limit);
    // Columns of one long line are not counted from its beginning each time.
    let line = format!("{}<shape type=\"x\"/>", "<bsdf type=\"diffuse\"/>".repeat(100_000));
    assert_eq!(error(&line).at.column, 22 * 100_000 + 14);
    let circle = "<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf><bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf>\
                  <shape type=\"cube\"><ref id=\"a\"/></shape>";
    assert!(error(circle).message.ends_with("is a part of itself"));
    let twice = "<bsdf type=\"diffuse\" id=\"a\"/><bsdf type=\"diffuse\" id=\"a\"/>";
    assert!(error(twice).message.starts_with("the id \"a\" is taken already"));
}

/// A scene with most of the vocabulary, for mutations.
const SEED: &str = r##"<scene version="3.0.0"><default name="spp" value="4"/><integrator type="path"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0 0 4" target="0 0 0" up="0 1 0"/></transform>
<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>
<bsdf type="diffuse" id="d"><rgb name="reflectance" value="#808080"/></bsdf>
<shape type="sphere"><ref id="d"/><transform name="to_world"><scale x="2"/><rotate y="1" angle="30"/></transform></shape>
<emitter type="point"><spectrum name="intensity" value="400:1, 700:2"/></emitter></scene>"##;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn broken_scenes_are_errors_or_scenes(
        edits in proptest::collection::vec((0..SEED.len(), any::<u8>(), 0..4_usize), 1..6),
    ) {
        let mut bytes = SEED.as_bytes().to_vec();
        for (place, byte, kind) in edits {
            let place = place.min(bytes.len().saturating_sub(1));
            match kind {
                0 => bytes.truncate(place),
                1 => bytes.insert(place, byte),
                2 if !bytes.is_empty() => drop(bytes.remove(place)),
                _ if !bytes.is_empty() => bytes[place] = byte,
                _ => {}
            }
        }
        let memory = Memory([(PathBuf::from("s/a.xml"), bytes)].into());
        match read_of(&memory, &[]).0 {
            Err(error) => prop_assert!(!error.message.is_empty() && !error.at.file.is_empty()),
            Ok(scene) => prop_assert!(scene.shapes.iter().all(|shape| shape.material.index() < scene.materials.len())),
        }
    }
}

#[test]
fn irradiance_is_measured_on_the_shape_that_has_the_sensor() {
    let meter = |size: u32| {
        format!(
            r#"<sensor type="irradiancemeter"><sampler type="independent"><integer name="sample_count" value="32"/></sampler>
            <film type="hdrfilm"><integer name="width" value="{size}"/><integer name="height" value="1"/></film></sensor>"#
        )
    };
    let surface = |read: &Scene| match &read.camera.as_ref().expect("a camera").projection {
        Projection::Irradiance { surface } => surface.clone(),
        other => panic!("{other:?}"),
    };
    let one = meter(1);
    let (read, warnings) = told(&format!(
        r#"<shape type="sphere"/><shape type="cube">{one}</shape><shape type="sphere" id="ball">{}</shape>"#,
        meter(3)
    ));
    assert_eq!(surface(&read), "measured surface");
    assert_eq!(read.shapes[1].name.as_deref(), Some("measured surface"));
    assert_eq!((read.image.width, read.image.height, read.render.samples), (1, 1, 32));
    assert!(
        warnings.len() == 1 && warnings[0].ends_with("only the first sensor is rendered"),
        "{warnings:?}"
    );

    let (read, warnings) = told(&format!(r#"<shape type="sphere" id="ball">{}</shape>"#, meter(3)));
    assert_eq!((surface(&read), read.image.width), ("ball".to_owned(), 3));
    assert!(warnings.len() == 1 && warnings[0].contains("measures the whole shape"), "{warnings:?}");

    // Sensors at the top level come first.
    let (read, warnings) =
        told(&format!(r#"<shape type="sphere">{one}</shape><sensor type="perspective"/>"#));
    assert!(matches!(read.camera.expect("a camera").projection, Projection::Perspective { .. }));
    assert!(
        warnings.len() == 1 && warnings[0].ends_with("only the first sensor is rendered"),
        "{warnings:?}"
    );

    assert!(error(&one).message.contains("a part of the shape"));
    let other = error(r#"<shape type="sphere"><sensor type="perspective"/></shape>"#);
    assert_eq!(other.kind, ErrorKind::Unsupported);
    let instance = error(&format!(
        r#"<shape type="instance"><ref id="group"/>{one}</shape><shape type="shapegroup" id="group"><shape type="sphere"/></shape>"#
    ));
    assert!(instance.message.contains("an instance"), "{instance}");

    // Only that of the first of two shapes without a name.
    let (read, _) = told(&format!(r#"<shape type="sphere">{one}</shape><shape type="sphere">{one}</shape>"#));
    assert_eq!(read.shapes_named("measured surface").count(), 1);
}

#[test]
fn distant_sensors_see_a_point_from_outside_of_the_scene() {
    let sensor = |direction: &str, target: &str| {
        format!(r#"<shape type="sphere"/><sensor type="distant">{direction}{target}</sensor>"#)
    };
    let point = r#"<point name="target" x="0.2" y="0" z="0.1"/>"#;
    let seen = |direction: &str| {
        let camera = scene(&sensor(direction, point)).camera.expect("a camera");
        assert!(matches!(camera.projection, Projection::Perspective { fov } if fov < 1e-3));
        let View::Matrix(matrix) = camera.view else { panic!("{:?}", camera.view) };
        (matrix.w_axis.truncate(), matrix.z_axis.truncate())
    };
    let target = DVec3::new(0.2, 0.0, 0.1);
    let (from, along) = seen(r#"<vector name="direction" x="0.5" y="-1" z="0"/>"#);
    assert!((along - DVec3::new(0.5, -1.0, 0.0).normalize()).length() < 1e-12, "{along}");
    // Twice the radius of the scene's bounds.
    assert!((from - target + 2.0 * 3.0_f64.sqrt() * along).length() < 1e-12, "{from}");
    let turned = seen(
        r#"<transform name="to_world"><lookat origin="0,0,0" target="0.5,-1,0" up="0,0,1"/></transform>"#,
    );
    assert!((turned.0 - from).length() < 1e-12 && (turned.1 - along).length() < 1e-12, "{turned:?}");

    let direction = r#"<vector name="direction" x="0" y="0" z="0"/>"#;
    assert!(error(&sensor(direction, point)).message.contains("other than 0"));
    for target in ["", r#"<shape type="rectangle" name="target"/>"#] {
        let error = error(&sensor("", target));
        assert_eq!(error.kind, ErrorKind::Unsupported, "{error}");
    }
}
