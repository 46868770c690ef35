//! BSDFs of Mitsuba.

use lookfrom_scene::material::{
    BackFace, BumpGuard, BumpMapping, Color, Distribution, Illuminant, Ior, Masking, MaterialKind, Metal,
    Microfacets, Plastic, Scalar, Tint,
};

use super::{material, scene, told};

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
fn bsdfs_become_materials() {
    let (glass, _, warnings) = material(
        "<bsdf type=\"dielectric\"><rgb name=\"specular_reflectance\" value=\"1\"/><rgb name=\"specular_transmittance\" value=\"0.5\"/></bsdf>",
    );
    assert!(warnings.is_empty(), "{warnings:?}");
    let MaterialKind::Dielectric { eta: Ior::Value(eta), tint, .. } = glass else { panic!("{glass:?}") };
    assert_eq!(tint, Tint { transmittance: Color::gray(0.5), ..Tint::default() });
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
fn what_has_no_effect_is_warned_of() {
    let (_, warnings) = told(
        "<shape type=\"cube\">\n<float name=\"raduis\" value=\"2\"/><bsdf type=\"diffuse\" id=\"d\"/></shape>\n\
         <bsdf type=\"diffuse\" id=\"unused\"><float name=\"x\" value=\"1\"/></bsdf>",
    );
    assert_eq!(warnings, ["s/a.xml:3:29: the `raduis` of the shape \"cube\" has no effect here"]);
}
