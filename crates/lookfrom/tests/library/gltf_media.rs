//! Bodies of glTF files that scatter light (`KHR_materials_volume_scatter`): as pbrt's media, and in a white furnace.

use crate::gltf_and_pbrt::{assert_same, gltf, pbrt};
use crate::scattering::{assert_near, mean};
use lookfrom_scene::Scene;
use lookfrom_scene::camera::Projection;
use lookfrom_scene::light::{Light, LightKind, Power, Sky};
use lookfrom_scene::material::Color;
use lookfrom_scene::settings::{ColorMode, FilterShape};

const EXTENSIONS: &str = r#","KHR_materials_transmission","KHR_materials_diffuse_transmission","KHR_materials_ior","KHR_materials_volume",
    "KHR_materials_volume_scatter""#;

/// A smooth white material with these extensions.
fn material(extensions: &str) -> String {
    format!(
        r#"{{"pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":0}},"extensions":{{{extensions}}}}}"#
    )
}

const GLASS: &str = r#""KHR_materials_transmission":{"transmissionFactor":1}"#;

/// Light is transmitted diffusely, and nothing is mirrored.
const MATTE: &str = r#""KHR_materials_specular":{"specularFactor":0},
    "KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":0.75}"#;

/// After a distance of 2, (1/2, 1/4, 1) of the light is left. With a multi-scatter colour of a half and the mean cosine 1/4, 0.932287 of
/// what is taken away is scattered.
const VOLUME: &str = r#""KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.5,0.25,1],"attenuationDistance":2},
    "KHR_materials_volume_scatter":{"multiscatterColor":[0.5,1,0.5],"scatterAnisotropy":0.25}"#;
const PBRTS_VOLUME: &str = "MakeNamedMedium \"inside\" \"string type\" \"homogeneous\" \"float g\" 0.25 \
    \"rgb sigma_a\" [0.0234676 0 0] \"rgb sigma_s\" [0.323106 0.6931472 0]\nMediumInterface \"inside\" \"\"\n";

#[test]
fn a_ball_that_scatters_is_pbrts_medium() {
    let glass = material(&format!(r#"{GLASS},"KHR_materials_ior":{{"ior":1.33}},{VOLUME}"#));
    let dielectric = format!("{PBRTS_VOLUME}Material \"dielectric\" \"float eta\" 1.33");
    assert_same(&gltf(&glass, EXTENSIONS), &pbrt(&dielectric), 128);
}

#[test]
fn light_that_is_transmitted_diffusely_is_in_the_medium() {
    let shell = material(&format!("{MATTE},{VOLUME}"));
    let pbrts = format!(
        "{PBRTS_VOLUME}Material \"diffusetransmission\" \"rgb reflectance\" [0.25 0.25 0.25] \
         \"rgb transmittance\" [0.75 0.75 0.75] \"float scale\" 1"
    );
    assert_same(&gltf(&shell, EXTENSIONS), &pbrt(&pbrts), 128);
}

/// The ball of a material alone, before light that is 1 all around, by a camera that sees nothing else.
fn furnace(extensions: &str, color: ColorMode) -> Scene {
    let mut scene = gltf(&material(extensions), EXTENSIONS);
    scene.shapes.truncate(1);
    let sky = Sky::Constant(Color::gray(1.0));
    let kind = LightKind::Environment { sky, portal: None, illuminates: true };
    scene.lights = vec![Light { name: None, at: Default::default(), kind, power: Power::AS_WRITTEN }];
    let camera = scene.camera.as_mut().expect("the file has one");
    camera.projection = Projection::Perspective { fov: 15.0 };
    (scene.image.width, scene.image.height) = (4, 4);
    scene.image.filter = FilterShape::Box.of_radius(0.5);
    (scene.render.samples, scene.render.depth, scene.render.color) = (4096, 256, color);
    scene
}

fn volume(color: &str, anisotropy: f32) -> String {
    format!(
        r#""KHR_materials_volume":{{"thicknessFactor":1,"attenuationColor":[0.3,0.25,0.2],"attenuationDistance":1}},
        "KHR_materials_volume_scatter":{{"multiscatterColorFactor":{color},"scatterAnisotropy":{anisotropy}}}"#
    )
}

#[test]
fn white_bodies_are_unseen_in_a_furnace() {
    for color in [ColorMode::Rgb, ColorMode::Spectral] {
        for (name, surface) in [
            ("no surface", format!(r#"{GLASS},"KHR_materials_ior":{{"ior":1}}"#)),
            ("glass", GLASS.to_owned()),
            ("matte", MATTE.to_owned()),
            ("glossy", r#""KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":1}"#.to_owned()),
        ] {
            for anisotropy in [0.0, 0.7, -0.4] {
                let scene = furnace(&format!("{surface},{}", volume("[1,1,1]", anisotropy)), color);
                assert_near(mean(scene), [1.0; 3], 0.012, &format!("{name}, {color:?}, {anisotropy}"));
            }
        }
    }
}

#[test]
fn bodies_that_absorb_gain_nothing_in_a_furnace() {
    for surface in [GLASS, MATTE] {
        let [r, g, b] = mean(furnace(&format!("{surface},{}", volume("[0.8,0.5,0.2]", 0.0)), ColorMode::Rgb));
        assert!(1.0 > r && r > g && g > b && b > 0.05, "{surface}: {r} {g} {b}");
    }
}
