//! Textures and their pictures.

use glam::Vec2;
use lookfrom_scene::material::{BumpMapping, Color, Scalar};
use lookfrom_scene::texture::{Channel, Mapping, TexelFilter, TextureKind, Wrap};
use serde_json::{Value, json};

use super::{Model, looking, mesh, one, pictures, principled};

/// Where our mapping looks for a glTF coordinate, as glTF's coordinate in the picture.
fn looked_up(mapping: &Mapping, [u, v]: [f32; 2]) -> Vec2 {
    let ours = [u, 1.0 - v, 1.0];
    let [s, t] = match mapping {
        Mapping::Uv { scale, offset } => [ours[0] * scale[0] + offset[0], ours[1] * scale[1] + offset[1]],
        Mapping::Affine { matrix, .. } => matrix.map(|row| row.iter().zip(ours).map(|(a, b)| a * b).sum()),
        other => panic!("{other:?}"),
    };
    Vec2::new(s, 1.0 - t)
}

#[test]
fn texture_coordinates_are_turned_over_and_transformed() {
    let mut model = Model::default();
    let positions = model.square();
    let uvs = model.floats("VEC2", &[0.25, 0.125, 1.0, 0.0, 0.0, 1.0, 3.0, -2.0]);
    let primitive = |material: Value| {
        let primitive = json!({"attributes": {"POSITION": positions, "TEXCOORD_0": uvs, "TEXCOORD_1": uvs}, "mode": 5, "material": 0});
        let mut root = one(primitive, pictures());
        root["materials"] = json!([material]);
        root["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
        root["textures"][0]["sampler"] = json!(0);
        root
    };
    let transform = json!({"offset": [0.5, -0.25], "rotation": 0.7, "scale": [2.0, 3.0], "texCoord": 1});
    let texture = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let scene = model.scene(primitive(json!({"pbrMetallicRoughness": {"baseColorTexture": texture}})));
    let mesh = mesh(&scene, &scene.shapes[0]);
    assert_eq!(mesh.uvs[0], Vec2::new(0.25, 0.875));
    assert_eq!(
        (mesh.uvs[3], mesh.more_uvs.len(), mesh.more_uvs[0][3]),
        (Vec2::new(3.0, 3.0), 1, Vec2::new(3.0, 3.0))
    );
    let Color::Texture(id) = principled(&scene).base_color else { panic!("a texture") };
    let TextureKind::Image { mapping, wrap, filter, .. } = &scene.textures[id.index()].kind else {
        panic!("a picture")
    };
    assert_eq!((*wrap, *filter), ([Wrap::Clamp, Wrap::Mirror], TexelFilter::Nearest));
    assert!(matches!(mapping, Mapping::Affine { set: 1, .. }));
    // As the extension writes it: translation · rotation · scale, with the rotation's columns (cos, −sin), (sin, cos).
    let (sin, cos) = 0.7_f32.sin_cos();
    for uv @ [u, v] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.9], [-4.0, 7.5]] {
        let expected = Vec2::new(0.5 + cos * 2.0 * u + sin * 3.0 * v, -0.25 - sin * 2.0 * u + cos * 3.0 * v);
        assert!((looked_up(mapping, uv) - expected).length() < 1e-5, "{uv:?}");
    }
    let scene = model.scene(primitive(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})));
    let Color::Texture(id) = principled(&scene).base_color else { panic!("a texture") };
    let TextureKind::Image { mapping, .. } = &scene.textures[id.index()].kind else { panic!("a picture") };
    assert_eq!(looked_up(mapping, [0.25, 0.125]), Vec2::new(0.25, 0.125));
}

#[test]
fn a_set_of_texture_coordinates_that_is_left_out_is_zero() {
    let mut model = Model::default();
    let positions = model.square();
    let uvs = model.floats("VEC2", &[0.25, 0.125, 1.0, 0.0, 0.0, 1.0, 3.0, -2.0]);
    let attributes = json!({"POSITION": positions, "TEXCOORD_0": uvs, "TEXCOORD_2": uvs});
    let scene = model.scene(one(json!({"attributes": attributes, "mode": 5}), pictures()));
    let mesh = mesh(&scene, &scene.shapes[0]);
    assert_eq!(mesh.more_uvs, [vec![Vec2::ZERO; 4], mesh.uvs.clone()]);
    scene.validate().expect("as readers make scenes");
}

#[test]
fn a_picture_is_decoded_once_for_each_meaning() {
    let material = json!({
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 0.5},
        "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1],
        "occlusionTexture": {"index": 0},
        "normalTexture": {"index": 0, "scale": 2},
    });
    let scene = looking(material, pictures());
    // Colours, numbers, normals.
    assert_eq!(scene.images.len(), 3);
    assert!(scene.images.iter().all(|image| (image.width, image.height) == (1, 2)));
    let Scalar::Texture(roughness) = principled(&scene).roughness else { panic!("a texture") };
    let TextureKind::Image { channel, scale, .. } = scene.textures[roughness.index()].kind else {
        panic!("a picture")
    };
    assert_eq!((channel, scale), (Channel::Green, 0.5));
    let bump_mapping = scene.materials[0].bump_mapping;
    assert!(matches!(bump_mapping, BumpMapping::NormalTexture(normals) if normals.scale == 2.0));
    assert!(scene.shapes[0].emission.is_some_and(|emission| !emission.two_sided));
}

#[test]
fn a_missing_picture_is_a_warning() {
    let mut model = Model::default();
    let positions = model.square();
    let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let root = one(
        json!({"attributes": {"POSITION": positions}, "mode": 5, "material": 0}),
        json!({"materials": [material], "textures": [{"source": 0}], "images": [{"uri": "none.png"}]}),
    );
    let (scene, warnings) = model.read(root).expect("it is survived");
    assert_eq!(scene.images[0].texel(0), [1.0; 3]);
    assert!(warnings[0].contains("m/a.gltf#/images/0") && warnings[0].contains("none.png"), "{warnings:?}");
}

#[test]
fn the_plain_picture_stands_in_for_one_that_is_not_read() {
    let mut files = pictures();
    files["images"].as_array_mut().expect("a list").push(json!({"uri": "data:image/ktx2;base64,AAAA"}));
    files["textures"][0]["extensions"] = json!({"KHR_texture_basisu": {"source": 1}});
    let scene = looking(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}), files);
    assert_eq!((scene.images[0].width, scene.images[0].height), (1, 2));
}
