//! Materials and lights that are changed: the bits of a scene compiled anew, on the same trees.

use lookfrom::prelude::*;
use lookfrom::scene::ErrorKind;
use lookfrom::scene::Location;
use lookfrom::scene::light::{Light, Power};
use lookfrom::scene::material::{BumpMapping, Material};
use lookfrom::scene::scene::MaterialId;
use lookfrom::session::Exposure;

use crate::support::{SMALL, scene};

/// A lamp, an instance, a floor, glass that absorbs.
fn room() -> Scene {
    scene(&format!(
        r#"{SMALL}
        samples = 4
        [camera]
        lookfrom = [0, 2, 6]
        lookat = [0, 0.8, 0]
        fov = 40
        [materials.floor]
        type = "diffuse"
        reflectance = 0.5
        [materials.glass]
        type = "dielectric"
        [materials.lamp]
        type = "diffuse"
        reflectance = 0
        [[plane]]
        point = [0, 0, 0]
        normal = [0, 1, 0]
        material = "floor"
        [[sphere]]
        center = [-1, 1, 0]
        radius = 1
        material = "glass"
        [[objects.post.box]]
        min = [-0.3, 0, -0.3]
        max = [0.3, 1.5, 0.3]
        material = "floor"
        [[instance]]
        object = "post"
        translate = [1, 0, 0]
        [[sphere]]
        center = [0, 4, 2]
        radius = 0.3
        material = "lamp"
        emission = 20
        [[light]]
        type = "point"
        position = [2, 4, 3]
        intensity = 5
        "#
    ))
}

fn picture(session: &Session) -> lookfrom::film::Picture {
    session.render(&()).expect("a picture").picture.clone()
}

fn anew(scene: Scene) -> lookfrom::film::Picture {
    picture(&Session::of_scene(scene, &Options::default()).expect("a scene"))
}

#[test]
fn changed_materials_and_lights_have_the_bits_of_a_scene_compiled_anew() {
    let mut session = Session::keeping(room(), &Options::default()).expect("a scene");
    let before = picture(&session);
    let tree: *const _ = session.world().bvh();
    let mut expected = room();

    // Rough metal needs derivatives of meshes, clear bodies have media, and all materials are compiled together.
    let metal = MaterialKind::Conductor {
        metal: Metal::Reflectance(Color::Value([0.9, 0.6, 0.3])),
        roughness: Roughness { u: Scalar::Value(0.1), v: Scalar::Value(0.4), ..Roughness::SMOOTH },
        energy: Energy::Conserved,
        specular_reflectance: Color::gray(1.0),
    };
    let tinted = MaterialKind::Whitted(Whitted {
        transmission: Color::gray(1.0),
        absorption: [0.5, 0.1, 0.9],
        ..Whitted::default()
    });
    for (id, kind) in [(MaterialId(0), metal), (MaterialId(1), tinted)] {
        let material =
            Material { kind, bump_mapping: BumpMapping::None, ..expected.materials[id.index()].clone() };
        expected.materials[id.index()] = material.clone();
        session.set_material(id, material).expect("a material");
        let changed = picture(&session);
        assert!(changed != before);
        assert_eq!(changed, anew(expected.clone()));
    }

    let sky = LightKind::Environment {
        sky: Sky::Gradient { zenith: [0.2, 0.4, 1.0], horizon: [1.0; 3], nadir: [0.1; 3] },
        portal: None,
        illuminates: true,
    };
    let light = Light { name: None, at: Location::default(), kind: sky, power: Power::AS_WRITTEN };
    expected.lights = vec![light.clone()];
    session.set_lights(vec![light]).expect("a light");
    assert_eq!(picture(&session), anew(expected));
    assert!(std::ptr::eq(tree, session.world().bvh()), "a tree was built");
}

#[test]
fn what_is_refused_changes_nothing() {
    let mut session = Session::keeping(room(), &Options::default()).expect("a scene");
    let before = picture(&session);
    let material =
        |color| Material::new("wrong", Location::default(), MaterialKind::Diffuse { reflectance: color });
    let refused =
        session.set_material(MaterialId(0), material(Color::gray(f32::NAN))).expect_err("no number");
    assert_eq!(refused.kind, ErrorKind::Invalid);
    let refused = session.set_material(MaterialId(9), material(Color::BLACK)).expect_err("no such material");
    assert_eq!(refused.kind, ErrorKind::Request);
    assert_eq!(session.scene().expect("it is kept").materials[0].name, room().materials[0].name);
    assert_eq!(picture(&session), before);

    let mut without = Session::of_scene(room(), &Options::default()).expect("a scene");
    assert!(without.scene().is_none());
    let refused = without.set_lights(Vec::new()).expect_err("it is not kept");
    assert_eq!(refused.kind, ErrorKind::Request);
}

#[test]
fn moved_instances_have_the_bits_of_a_scene_compiled_anew() {
    let mut session = Session::keeping(room(), &Options::default()).expect("a scene");
    let before = picture(&session);
    let pose = DMat4::from_translation(DVec3::new(-0.5, 0.25, 1.5)) * DMat4::from_rotation_y(0.5);
    session.set_poses(vec![(0, DMat4::IDENTITY), (0, pose)]).expect("a pose");
    let mut moved = room();
    moved.instances[0].world_from_object = pose;
    assert_eq!(picture(&session), anew(moved));
    assert_ne!(picture(&session), before);

    // What is impossible changes nothing.
    let flat = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0));
    for (poses, kind) in
        [(vec![(0, DMat4::IDENTITY), (0, flat)], ErrorKind::Invalid), (vec![(1, pose)], ErrorKind::Request)]
    {
        let now = picture(&session);
        assert_eq!(session.set_poses(poses).expect_err("no pose").kind, kind);
        assert_eq!(picture(&session), now);
        assert_eq!(session.scene().expect("it is kept").instances[0].world_from_object, pose);
    }
}

/// What changes without the scene is as if it had been asked for from the start.
#[test]
fn options_change_the_picture_and_the_camera() {
    let with = |options: &Options| Session::of_scene(room(), options).expect("a scene");
    let mut session = with(&Options::default());
    for options in [
        Options { width: Some(20), samples: Some(8), seed: Some(3), ..Options::default() },
        Options { exposure: Some(Exposure::Stops(1.0)), depth: Some(2), ..Options::default() },
        Options { integrator: Some(Integrator::Whitted), part: Some([2, 2]), ..Options::default() },
        Options { first_sample: 1, ..Options::default() },
    ] {
        let mut changed = session.clone();
        changed.change(&options).expect("it suits");
        assert_eq!(picture(&changed), picture(&with(&options)), "{options:?}");
        assert_eq!(changed.image().exposure, options.exposure.map_or(0.0, |_| 1.0));
    }

    // From elsewhere, with other rounding.
    let elsewhere =
        Options { lookfrom: Some(DVec3::new(3.0, 3.0, 4.0)), fov: Some(30.0), ..Options::default() };
    session.change(&elsewhere).expect("it suits");
    let (changed, anew) = (picture(&session), picture(&with(&elsewhere)));
    let mean = |picture: &lookfrom::film::Picture| {
        picture.pixels.iter().flatten().sum::<f32>() / picture.pixels.len() as f32
    };
    assert!((mean(&changed) / mean(&anew) - 1.0).abs() < 0.02, "{} {}", mean(&changed), mean(&anew));
    assert_eq!(session.camera().look(DVec3::ZERO), with(&elsewhere).camera().look(DVec3::ZERO));

    // What does not suit changes nothing.
    let before = picture(&session);
    for options in [
        Options { floor: true, ..Options::default() },
        Options { fov: Some(60.0), part: Some([1, 2]), samples: Some(1), ..Options::default() },
        Options {
            width: Some(1 << 20),
            height: Some(1 << 20),
            lookfrom: Some(DVec3::ONE),
            ..Options::default()
        },
        Options { turn: Some(30.0), ..Options::default() },
        Options { keep_scene: true, ..Options::default() },
    ] {
        let error = session.change(&options).expect_err("it does not suit");
        assert_eq!(error.kind, ErrorKind::Request, "{error}");
        assert_eq!(picture(&session), before);
    }
}
