//! Materials and their extensions.

use glam::Vec3;
use lookfrom_scene::Scene;
use lookfrom_scene::files::ImportOptions;
use lookfrom_scene::material::{Color, MaterialKind, Scalar};
use lookfrom_scene::medium::Extinction;
use lookfrom_scene::scene::{MediumId, TextureId};
use lookfrom_scene::settings::Integrator;
use lookfrom_scene::texture::{Channel, TextureKind};
use serde_json::{Value, json};

use super::{Model, looking, one, pictures, principled};

#[test]
fn extensions_of_materials_are_read() {
    let scene = looking(
        json!({
            "doubleSided": true,
            "emissiveFactor": [0.5, 0, 0.25],
            "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1], "metallicFactor": 0, "roughnessFactor": 0.25},
            "extensions": {
                "KHR_materials_emissive_strength": {"emissiveStrength": 8},
                "KHR_materials_ior": {"ior": 1.33},
                "KHR_materials_dispersion": {"dispersion": 0.2},
                "KHR_materials_transmission": {"transmissionFactor": 0.75},
                "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.25]},
                "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 1, 0]},
                "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.125},
                "KHR_materials_sheen": {"sheenColorFactor": [0, 0, 1], "sheenRoughnessFactor": 0.5},
                "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceIor": 1.8},
                "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1},
                "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25, "diffuseTransmissionColorFactor": [1, 0, 0]},
            },
        }),
        json!({}),
    );
    let look = principled(&scene);
    assert_eq!(look.base_color, Color::Value([0.1, 0.2, 0.3]));
    assert_eq!((look.metallic, look.roughness), (Scalar::Value(0.0), Scalar::Value(0.25)));
    assert_eq!((look.ior, look.dispersion, look.transmission), (1.33, 0.2, Scalar::Value(0.75)));
    assert!(look.is_solid);
    // After the distance, the colour is left.
    let left = look.absorption.map(|absorption| (-2.0 * absorption).exp());
    assert!((Vec3::from(left) - Vec3::new(1.0, 0.5, 0.25)).length() < 1e-6);
    assert_eq!((look.specular, look.specular_color), (Scalar::Value(0.5), Color::Value([2.0, 1.0, 0.0])));
    assert_eq!((look.clearcoat, look.clearcoat_roughness), (Scalar::Value(1.0), Scalar::Value(0.125)));
    assert_eq!((look.sheen_color, look.sheen_roughness), (Color::Value([0.0, 0.0, 1.0]), Scalar::Value(0.5)));
    assert_eq!((look.iridescence, look.iridescence_ior), (Scalar::Value(1.0), 1.8));
    assert_eq!(look.iridescence_thickness, Scalar::Value(400.0));
    assert!(
        look.anisotropy
            .is_some_and(|own| own.strength == 0.5 && own.rotation == 1.0 && own.texture.is_none())
    );
    assert_eq!(
        (look.diffuse_transmission, look.diffuse_transmission_color),
        (Scalar::Value(0.25), Color::Value([1.0, 0.0, 0.0]))
    );
    let emission = scene.shapes[0].emission.expect("it shines");
    assert_eq!((emission.radiance, emission.two_sided), (Color::Value([4.0, 0.0, 2.0]), true));
    assert!(!scene.shapes[0].single_sided);
}

/// A white body in which half of the light is left after a length of 2, with this scattering and more extensions.
fn scattering(scatter: Value, more: Value) -> (Scene, Vec<String>) {
    let mut extensions = json!({
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.5, 1]},
        "KHR_materials_volume_scatter": scatter,
    });
    if let (Value::Object(extensions), Value::Object(more)) = (&mut extensions, more) {
        extensions.extend(more);
    }
    let mut model = Model::default();
    let positions = model.square();
    let primitive = json!({"attributes": {"POSITION": positions}, "mode": 5, "material": 0});
    let used = ["KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_volume_scatter"];
    let materials = json!([{"name": "wax", "extensions": extensions}]);
    let root = one(primitive, json!({"materials": materials, "extensionsUsed": used}));
    model.read(root).expect("it is valid")
}

#[test]
fn volumes_that_scatter_are_filled_with_a_medium() {
    // By the texts of 2025 and of 2026.
    for name in ["multiscatterColor", "multiscatterColorFactor"] {
        let (scene, warnings) = scattering(json!({name: [1, 0.5, 1], "scatterAnisotropy": 0.25}), json!({}));
        assert_eq!(warnings, Vec::<String>::new());
        assert_eq!(scene.materials[0].medium.map(MediumId::index), Some(0));
        let medium = &scene.media[0];
        assert_eq!((medium.name.as_str(), medium.g, medium.scale), ("wax", 0.25, 1.0));
        assert_eq!(medium.at.to_string(), "m/a.gltf#/materials/0/extensions/KHR_materials_volume_scatter");
        let Extinction::Parts { absorption: Color::Value(absorption), scattering: Color::Value(scattering) } =
            medium.extinction
        else {
            panic!("values")
        };
        let attenuation = 0.5_f32.ln() / -2.0;
        let total = Vec3::from(absorption) + Vec3::from(scattering);
        assert!((total - Vec3::new(attenuation, attenuation, 0.0)).length() < 1e-6, "{total}");
        assert!(absorption[0] < 1e-7 * attenuation, "white absorbs nothing");
        // s of a half is 4.09712 + 2.104315 − √(9.59217 + 20.8404 + 4.42815) = 0.297138.
        let s2 = 0.297_138_f32 * 0.297_138;
        let albedo = (1.0 - s2) / (1.0 - 0.25 * s2);
        assert!((scattering[1] / attenuation - albedo).abs() < 1e-5, "{}", scattering[1] / attenuation);
        // Light bounces often in there.
        assert_eq!((scene.render.integrator, scene.render.depth), (Integrator::Path, 200));
    }
}

#[test]
fn volumes_that_only_absorb_have_no_medium() {
    let nothing = |scatter: Value, more: Value, expected: &[&str]| {
        let (scene, warnings) = scattering(scatter, more);
        assert_eq!((scene.media.len(), scene.materials[0].medium, scene.render.depth), (0, None, 8));
        assert_eq!(warnings.len(), expected.len(), "{warnings:?}");
        for (warning, expected) in warnings.iter().zip(expected) {
            assert!(warning.contains(expected), "{warning}");
        }
    };
    let white = json!({"multiscatterColorFactor": [1, 1, 1]});
    nothing(json!({}), json!({}), &[]);
    nothing(json!({"multiscatterColor": [0, 0, 0]}), json!({}), &[]);
    let below = "multiscatterColor: the factor is [-1, -0.5, 0]; expected 0 to 1";
    nothing(json!({"multiscatterColor": [-1, -0.5, 0]}), json!({}), &[below]);
    let volume = |volume: Value| json!({"KHR_materials_volume": volume});
    nothing(white.clone(), volume(json!({"thicknessFactor": 1})), &[]);
    let clear = json!({"thicknessFactor": 1, "attenuationDistance": 1});
    nothing(white.clone(), volume(clear), &[]);
    let thin = "KHR_materials_volume_scatter: nothing is scattered in a thin sheet";
    let sheet = json!({"attenuationDistance": 1, "attenuationColor": [0, 0, 0]});
    nothing(white.clone(), volume(sheet), &[thin]);
    nothing(white.clone(), volume(Value::Null), &[thin]);
    nothing(white, json!({"KHR_materials_unlit": {}}), &[]);
}

#[test]
fn scattering_out_of_range_is_clamped() {
    let (scene, warnings) = scattering(
        json!({"multiscatterColorFactor": [2, -1, 1e300], "multiscatterColorTexture": {"index": 7}, "scatterAnisotropy": -1}),
        json!({}),
    );
    let expected = [
        "KHR_materials_volume_scatter/multiscatterColorTexture: the texture is ignored",
        "KHR_materials_volume_scatter/multiscatterColorFactor: the factor is [2, -1, 1000",
        "KHR_materials_volume_scatter/scatterAnisotropy: the anisotropy is -1; expected a number between -1 and 1: -0.999 is used",
    ];
    assert_eq!(warnings.len(), expected.len(), "{warnings:?}");
    for (warning, expected) in warnings.iter().zip(expected) {
        assert!(warning.contains(expected), "{warning}");
    }
    assert_eq!(scene.media[0].g, -0.999);
    scene.validate().expect("it is valid");
    let (scene, warnings) =
        scattering(json!({"multiscatterColor": [1, 1, 1], "scatterAnisotropy": 1e30}), json!({}));
    assert_eq!((scene.media[0].g, warnings.len()), (0.999, 1));
    // The densest that can be written.
    let dense =
        json!({"thicknessFactor": 1, "attenuationDistance": 1e-300, "attenuationColor": [0, -1, 0.5]});
    let (scene, _) =
        scattering(json!({"multiscatterColor": [1, 0.5, 1]}), json!({"KHR_materials_volume": dense}));
    scene.validate().expect("it is valid");
}

#[test]
fn glossy_and_unlit_materials_are_converted() {
    let glossy = json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.25, 0, 1], "specularFactor": [0.1, 0.2, 0.3], "glossinessFactor": 0.75,
    }}});
    let scene = looking(glossy, json!({}));
    let look = principled(&scene);
    assert_eq!(
        (look.base_color, look.specular_color),
        (Color::Value([0.5, 0.25, 0.0]), Color::Value([0.1, 0.2, 0.3]))
    );
    assert_eq!((look.metallic, look.roughness, look.ior), (Scalar::Value(0.0), Scalar::Value(0.25), 0.0));

    let unlit = json!({"extensions": {"KHR_materials_unlit": {}}, "pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]}});
    let scene = looking(unlit, json!({}));
    assert_eq!(scene.materials[0].kind, MaterialKind::Unlit { color: Color::Value([0.0, 1.0, 0.0]) });
}

#[test]
fn what_is_not_there_lets_light_through() {
    let alpha = |mode: &str, alpha: f64| {
        let material =
            json!({"alphaMode": mode, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, alpha]}});
        looking(material, json!({})).shapes[0].alpha
    };
    assert_eq!(alpha("OPAQUE", 0.25), None);
    assert_eq!(alpha("BLEND", 0.25), Some(Scalar::Value(0.25)));
    assert_eq!(alpha("BLEND", 1.0), None);
    assert_eq!(alpha("MASK", 0.75), None);
    assert_eq!(alpha("MASK", 0.25), Some(Scalar::Value(0.0)));

    let material = json!({"alphaMode": "MASK", "alphaCutoff": 0.3, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let scene = looking(material, pictures());
    let Some(Scalar::Texture(TextureId(id))) = scene.shapes[0].alpha else { panic!("a texture") };
    let TextureKind::Threshold { value: Scalar::Texture(inner), edge } = scene.textures[id as usize].kind
    else {
        panic!("an edge")
    };
    assert_eq!(edge, 0.3);
    assert!(matches!(scene.textures[inner.index()].kind, TextureKind::Image { channel: Channel::Alpha, .. }));
    assert_eq!(scene.images.len(), 1, "colour and opacity are of one picture");
}

#[test]
fn variants_are_chosen() {
    let mut model = Model::default();
    let positions = model.square();
    let primitive = json!({
        "attributes": {"POSITION": positions}, "mode": 5, "material": 0,
        "extensions": {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [1]}]}},
    });
    let root = one(
        primitive,
        json!({
            "materials": [{"name": "plain"}, {"name": "fancy"}],
            "extensions": {"KHR_materials_variants": {"variants": [{"name": "a"}, {"name": "b"}]}},
        }),
    );
    let worn = |variant: Option<&str>| {
        let choice = ImportOptions { variant: variant.map(ToOwned::to_owned), ..ImportOptions::default() };
        model.chosen(root.clone(), choice).map(|(scene, _)| scene.materials[0].name.clone())
    };
    assert_eq!(worn(None).expect("valid"), "plain");
    assert_eq!(worn(Some("a")).expect("valid"), "plain");
    assert_eq!(worn(Some("b")).expect("valid"), "fancy");
    assert_eq!(worn(Some("1")).expect("valid"), "fancy");
    let error = worn(Some("c")).expect_err("there is none").to_string();
    assert!(error.contains("there is no variant \"c\"") && error.contains("\"a\", \"b\""), "{error}");
}
