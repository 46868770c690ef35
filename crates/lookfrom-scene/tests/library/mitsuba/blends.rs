//! Blends of BSDFs, masks and nothing.

use super::*;

/// The opacity of the only shape, and the part of the second material, at points where a texture is 0, 0.25 and 1.
fn opacity_and_part(bsdf: &str) -> [[f32; 2]; 3] {
    let (scene, warnings) = told(&format!("<shape type=\"cube\">{bsdf}</shape>"));
    assert!(warnings.is_empty(), "{warnings:?}");
    let shape = &scene.shapes[0];
    let MaterialKind::Mix { materials, amount } = &scene.materials[shape.material.index()].kind else {
        panic!("{:?}", scene.materials)
    };
    let kinds = materials.map(|id| &scene.materials[id.index()].kind);
    assert!(!kinds.iter().any(|kind| matches!(kind, MaterialKind::Interface)), "{kinds:?}");
    [0.0, 0.25, 1.0].map(|here| {
        [shape.alpha.unwrap_or(Scalar::Value(1.0)), *amount].map(|number| value(&scene, number, here))
    })
}

/// A number at a point where pictures, and the sides of a surface, are `here`.
fn value(scene: &Scene, number: Scalar, here: f32) -> f32 {
    let of = |color: Color| match color {
        Color::Value([gray, ..]) => gray,
        Color::Texture(id) => value(scene, Scalar::Texture(id), here),
        Color::Curve(_) => panic!("a curve"),
    };
    let id = match number {
        Scalar::Value(value) => return value,
        Scalar::Texture(id) => id,
    };
    match scene.textures[id.index()].kind {
        TextureKind::Image { .. } | TextureKind::Sides { .. } => here,
        TextureKind::Product { a, b } => of(a) * of(b),
        TextureKind::Quotient { a, b } => match value(scene, b, here) {
            0.0 => 0.0,
            divisor => value(scene, a, here) / divisor,
        },
        TextureKind::Mix { low, high, amount } => {
            let amount = value(scene, amount, here);
            of(low) * (1.0 - amount) + of(high) * amount
        }
        ref other => panic!("{other:?}"),
    }
}

const MASKED: &str =
    "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.5\"/><bsdf type=\"conductor\"/></bsdf>";
const DIFFUSE: &str = "<bsdf type=\"diffuse\"/>";
const PICTURED: &str =
    "<texture name=\"weight\" type=\"bitmap\"><string name=\"filename\" value=\"p.pfm\"/></texture>";

#[test]
fn opacities_are_blended_and_materials_by_what_is_opaque() {
    let blend = |rest: &str| opacity_and_part(&format!("<bsdf type=\"blendbsdf\">{rest}</bsdf>"));
    let quarter = "<float name=\"weight\" value=\"0.25\"/>";
    // 0.75 · 1 + 0.25 · 0.5, of which 0.125 is the masked one.
    assert_eq!(blend(&format!("{quarter}{DIFFUSE}{MASKED}")), [[0.875, 0.125 / 0.875]; 3]);
    assert_eq!(blend(&format!("{quarter}{MASKED}{DIFFUSE}")), [[0.625, 0.25 / 0.625]; 3]);
    assert_eq!(blend(&format!("{quarter}{MASKED}{MASKED}")), [[0.5, 0.25]; 3]);
    let pictured = blend(&format!("{PICTURED}{DIFFUSE}{MASKED}"));
    assert_eq!(pictured, [[1.0, 0.0], [0.875, 0.125 / 0.875], [0.5, 1.0]]);
    // Nothing is there where nothing is chosen.
    let pictured = blend(&format!("{PICTURED}<bsdf type=\"null\"/><bsdf type=\"conductor\"/>"));
    assert_eq!(pictured, [[0.0, 0.0], [0.25, 1.0], [1.0, 1.0]]);
}

#[test]
fn each_side_has_an_opacity_of_its_own() {
    let sides = opacity_and_part(&format!("<bsdf type=\"twosided\">{DIFFUSE}{MASKED}</bsdf>"));
    assert_eq!([sides[0], sides[2]], [[1.0, 0.0], [0.5, 1.0]]);
}

#[test]
fn masks_in_masks_are_products() {
    let (scene, _) = told(&format!(
        "<shape type=\"cube\"><bsdf type=\"mask\"><float name=\"opacity\" value=\"0.25\"/>{MASKED}</bsdf></shape>"
    ));
    let alpha = scene.shapes[0].alpha.expect("an opacity");
    assert_eq!(value(&scene, alpha, 0.0), 0.125);
}
