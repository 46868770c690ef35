//! Scenes of pbrt-v3: what they mean in the words of version 4, and what only they have.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use lookfrom_scene::camera::Projection;
use lookfrom_scene::light::{LightKind, Sky};
use lookfrom_scene::material::{Color, MaterialKind, Scalar};
use lookfrom_scene::settings::{ColorMode, FilterShape};
use lookfrom_scene::shape::{Geometry, Mesh};
use lookfrom_scene::{LoadContext, Memory, Result, Scene, load};

fn load(text: &str) -> (Result<Scene>, Vec<String>) {
    // A picture of 2 × 1 pixels in red and green.
    let picture = b"PF\n2 1\n-1\n\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0".to_vec();
    let files = [(PathBuf::from("a.pbrt"), text.as_bytes().to_vec()), ("map.pfm".into(), picture)];
    let files = Memory(files.into());
    let mut context = LoadContext::new(&files);
    let scene = load::scene(Path::new("a.pbrt"), &mut context);
    (scene, context.warnings.iter().map(ToString::to_string).collect())
}

/// A scene of which no more is said than that it is of version 3.
fn read(text: &str) -> Scene {
    let (scene, warnings) = load(text);
    assert!(warnings.len() == 1 && warnings[0].contains("for pbrt-v3"), "{warnings:?}");
    scene.unwrap_or_else(|error| panic!("{error}"))
}

/// The two scenes are the same but for places, in RGB.
fn same(old: &str, new: &str) {
    let (old, (new, _)) = (read(old), load(new));
    let plain = |mut scene: Scene| {
        scene.render.color = ColorMode::Rgb;
        scene.materials.iter_mut().for_each(|material| (material.at, material.name) = Default::default());
        scene.shapes.iter_mut().for_each(|shape| shape.at = Default::default());
        scene.lights.iter_mut().for_each(|light| light.at = Default::default());
        scene.textures.iter_mut().for_each(|texture| texture.at = Default::default());
        scene.media.iter_mut().for_each(|medium| medium.at = Default::default());
        scene.camera.iter_mut().for_each(|camera| camera.at = Default::default());
        let Scene { image, render, camera, materials, shapes, lights, textures, meshes, media, .. } = scene;
        format!(
            "{image:?} {render:?} {camera:?} {materials:?} {shapes:?} {lights:?} {textures:?} {meshes:?} {media:?}"
        )
    };
    assert_eq!(plain(old), plain(new.expect("a scene of version 4")));
}

#[test]
fn words_have_the_meaning_of_those_of_version_4() {
    same(
        r#"Camera "perspective" "float halffov" [20]
        Film "image" "integer xresolution" [64] "integer yresolution" [48] "float scale" [2] "float maxsampleluminance" [5]
        PixelFilter "gaussian" "float alpha" [8]
        Sampler "lowdiscrepancy" "integer pixelsamples" [4]
        Integrator "volpath" "string lightsamplestrategy" "spatial" "float rrthreshold" [1]
        WorldBegin
        LightSource "point" "color I" [1 2 3] "color scale" [2 2 4] "point from" [1 2 3]
        LightSource "distant" "xyz L" [0.9504559 1 1.0890578]
        AreaLightSource "area" "rgb L" [1 1 1] "integer nsamples" [4]
        Material "matte" "color Kd" [.1 .2 1.5]
        Shape "trianglemesh" "point P" [0 0 0 1 0 0 0 1 0] "float st" [0 0 1 0 0 1] "bool discarddegenerateUVs" "true"
        Shape "loopsubdiv" "integer nlevels" [1] "point P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2]
        MakeNamedMedium "fog" "string type" "heterogeneous" "float density" [1 1] "integer nx" [2] "integer ny" [1] "integer nz" [1]
        WorldEnd"#,
        r#"Camera "perspective" "float fov" [40]
        Film "rgb" "integer xresolution" [64] "integer yresolution" [48] "float iso" [200] "float maxcomponentvalue" [5]
        PixelFilter "gaussian" "float sigma" [.25] "float xradius" [2] "float yradius" [2]
        Sampler "zsobol" "integer pixelsamples" [4]
        Integrator "volpath"
        WorldBegin
        LightSource "point" "rgb I" [2 4 12] "point3 from" [1 2 3]
        LightSource "distant" "rgb L" [1 1 1]
        AreaLightSource "diffuse" "rgb L" [1 1 1]
        Material "diffuse" "rgb reflectance" [.1 .2 1]
        Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "point2 uv" [0 0 1 0 0 1]
        Shape "loopsubdiv" "integer levels" [1] "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2]
        MakeNamedMedium "fog" "string type" "uniformgrid" "float density" [1 1] "integer nx" [2] "integer ny" [1] "integer nz" [1]"#,
    );
}

#[test]
fn what_is_not_written_is_the_default_of_version_3() {
    let scene = read("Camera \"environment\"\nWorldBegin\nWorldEnd");
    assert_eq!((scene.image.width, scene.image.height, scene.render.color), (640, 480, ColorMode::Rgb));
    assert_eq!(scene.image.filter, FilterShape::Box.of_radius(0.5));
    assert_eq!(scene.camera.expect("one").projection, Projection::EquirectangularPbrt);
}

fn kinds(text: &str) -> Vec<MaterialKind> {
    let scene = read(&format!("Film \"image\"\nWorldBegin\n{text}"));
    scene.materials.into_iter().skip(1).map(|material| material.kind).collect()
}

#[test]
fn materials_are_the_nearest_of_ours() {
    let kinds_of = kinds(
        r#"Material "plastic" "color Kd" [.1 .2 .3] "color Ks" [.4 .4 .4] "float roughness" [.1]
        Material "plastic" "color Ks" [0 0 0]
        Material "mirror" "color Kr" [.5 .6 .7]
        Material "glass" "float index" [1.4] "color Kt" [.9 .8 .7]
        Material "substrate" "color Ks" [.04 .04 .04]
        Material "disney" "color color" [.1 .2 .3] "float metallic" [1]
        Material "translucent" "color Kd" [.5 .5 .5] "color reflect" [.2 .2 .2]"#,
    );
    let [
        MaterialKind::Plastic(plastic),
        MaterialKind::Diffuse { .. },
        MaterialKind::Conductor { specular_reflectance, .. },
        MaterialKind::Dielectric { tint, .. },
        MaterialKind::Plastic(substrate),
        MaterialKind::Disney(disney),
        MaterialKind::DiffuseTransmission { reflectance, transmittance, .. },
    ] = &kinds_of[..]
    else {
        panic!("{kinds_of:?}")
    };
    assert_eq!(
        (plastic.reflectance, plastic.specular_reflectance),
        (Color::Value([0.1, 0.2, 0.3]), Color::gray(0.4))
    );
    // By the polynomial of version 3, where version 4 has the square root.
    assert!((plastic.alpha - 0.461_9).abs() < 1e-3, "{}", plastic.alpha);
    assert_eq!(*specular_reflectance, Color::Value([0.5, 0.6, 0.7]));
    assert_eq!((tint.reflectance, tint.transmittance), (Color::gray(1.0), Color::Value([0.9, 0.8, 0.7])));
    assert!((substrate.eta - 1.5).abs() < 1e-6 && substrate.specular_reflectance == Color::gray(1.0));
    assert_eq!(disney.metallic, Scalar::Value(1.0));
    assert_eq!((*reflectance, *transmittance), (Color::gray(0.1), Color::gray(0.25)));
}

#[test]
fn mixtures_and_opacities_are_parts_of_two_materials() {
    let kinds_of = kinds(
        r#"MakeNamedMaterial "a" "string type" "matte"
        MakeNamedMaterial "b" "string type" "mirror"
        MakeNamedMaterial "m" "string type" "mix" "string namedmaterial1" "a" "string namedmaterial2" "b" "color amount" [.25 .25 .25]
        Material "uber" "color opacity" [.5 .5 .5]"#,
    );
    let MaterialKind::Mix { materials, amount } = &kinds_of[2] else { panic!("{kinds_of:?}") };
    // A quarter of the first.
    assert_eq!((materials.map(|id| id.0), *amount), ([2, 1], Scalar::Value(0.25)));
    let Some(MaterialKind::Mix { materials: [through, _], amount }) = kinds_of.last() else {
        panic!("{kinds_of:?}")
    };
    assert_eq!((&kinds_of[through.index() - 1], *amount), (&MaterialKind::Interface, Scalar::Value(0.5)));
}

/// A name stands for what it was defined as last.
#[test]
fn names_can_be_defined_again() {
    let scene = read(
        r#"WorldBegin
        Texture "t" "color" "constant" "color value" [.1 .1 .1]
        MakeNamedMaterial "a" "string type" "matte" "texture Kd" "t"
        NamedMaterial "a"
        Shape "sphere"
        Texture "t" "color" "constant" "color value" [.9 .9 .9]
        MakeNamedMaterial "a" "string type" "matte" "texture Kd" "t"
        NamedMaterial "a"
        Shape "sphere""#,
    );
    let reflectances: Vec<_> =
        scene.shapes.iter().map(|shape| scene.materials[shape.material.index()].kind.clone()).collect();
    let of = |value| MaterialKind::Diffuse { reflectance: Color::gray(value) };
    assert_eq!(reflectances, [of(0.1), of(0.9)]);
}

#[test]
fn panoramas_have_z_up_and_longitudes_from_x_to_y() {
    let scene =
        read("WorldBegin\nLightSource \"infinite\" \"string mapname\" \"map.pfm\" \"color L\" [1 2 3]");
    let LightKind::Environment { sky: Sky::Image { scale, world_from_light, .. }, .. } =
        &scene.lights[0].kind
    else {
        panic!("{:?}", scene.lights)
    };
    assert_eq!(*scale, [1.0, 2.0, 3.0]);
    // Ours have y up, −z in the middle and +x at three quarters.
    let at = |direction: DVec3| world_from_light.transform_vector3(direction);
    assert_eq!([at(DVec3::Y), at(DVec3::NEG_Z), at(DVec3::X)], [DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y]);
}

fn mesh(shape: &str) -> Mesh {
    let scene = read(&format!("Film \"image\"\nWorldBegin\nShape {shape}"));
    let Geometry::Mesh(id) = scene.shapes[0].geometry else { panic!("a mesh") };
    scene.meshes[id.index()].clone()
}

#[test]
fn shapes_that_version_4_lacks_are_meshes() {
    let cone = mesh("\"cone\" \"float radius\" [2] \"float height\" [3]");
    for (p, n) in cone.positions.iter().zip(&cone.normals) {
        assert!((p.truncate().length() - 2.0 * (1.0 - p.z / 3.0)).abs() < 1e-5, "{p}");
        let out = Vec3::new(p.x, p.y, 0.0).normalize_or(Vec3::ZERO) * 3.0 + Vec3::Z * 2.0;
        assert!(p.truncate().length() < 1e-3 || n.dot(out.normalize()) > 0.9999, "{p} {n}");
    }
    let bowl = mesh("\"paraboloid\" \"float radius\" [2] \"float zmax\" [8]");
    assert!(bowl.positions.iter().all(|p| (p.truncate().length_squared() - 0.5 * p.z).abs() < 1e-4));
    let saddle = mesh("\"hyperboloid\" \"point p1\" [1 0 0] \"point p2\" [0 1 1]");
    let waist = saddle.positions.iter().map(|p| p.truncate().length()).fold(f32::INFINITY, f32::min);
    assert!((waist - 0.5_f32.sqrt()).abs() < 1e-3, "{waist}");
    let field = mesh("\"heightfield\" \"integer nu\" [3] \"integer nv\" [2] \"float Pz\" [0 1 2 3 4 5]");
    assert_eq!((field.positions[4], field.triangles.len()), (Vec3::new(0.5, 1.0, 4.0), 4));
    let (left_out, warnings) = load("Film \"image\"\nWorldBegin\nShape \"nurbs\" \"integer nu\" [3]");
    assert!(left_out.expect("a scene").shapes.is_empty() && warnings[1].contains("nurbs"), "{warnings:?}");
}

/// Words of version 3 in a scene of version 4 are mistakes.
#[test]
fn versions_are_not_mixed() {
    for text in [
        "Film \"rgb\"\nWorldBegin\nMaterial \"matte\"",
        "WorldBegin\nMaterial \"diffuse\"\nShape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0]",
        "WorldBegin\nMaterial \"conductor\"\nWorldEnd",
    ] {
        let error = load(text).0.expect_err("a mixture");
        assert!(error.message.contains("a word of pbrt-v3 in a scene of pbrt-v4"), "{error}");
    }
}
