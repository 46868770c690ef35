//! Scenes with each material.

use lookfrom_scene::Scene;
use lookfrom_scene::material::{
    Anisotropy, BackFace, BumpGuard, BumpMapping, Coat, CoatEstimate, Color, Disney, Distribution, Energy,
    Hair, Illuminant, Ior, Masking, Material, MaterialKind, Metal, Microfacets, NormalTexture, OpenPbr,
    Pigment, Plastic, Principled, Roughness, Scalar, Subsurface, SubsurfaceMedium, Tangent, Tint, Whitted,
};
use lookfrom_scene::scene::{CurveId, ImageId, MaterialId, MediumId};

use super::{COLOR, NOISE, TABLE, TEXTURE, each, here, unit};

fn roughness(u: Scalar, v: Scalar, remap: bool) -> Roughness {
    Roughness { remap, ..Roughness::of_alphas(u, v) }
}

pub(super) fn materials() -> Vec<(String, Scene)> {
    let rough = roughness(Scalar::Value(0.3), TEXTURE, true);
    let alpha = roughness(Scalar::Value(0.04), Scalar::Value(0.5), false);
    let coat = Coat {
        eta: Ior::Curve(CurveId(4)),
        roughness: roughness(Scalar::Value(0.25), Scalar::Value(0.25), false),
        thickness: TEXTURE,
        albedo: Color::Value([0.1, 0.2, 0.3]),
        g: Scalar::Value(-0.5),
        max_depth: 10,
        samples: 3,
        estimate: CoatEstimate::Pbrt,
    };
    let gold = Metal::Indices {
        eta: Color::Curve(CurveId(5)),
        k: Color::Curve(CurveId(6)),
        illuminant: Illuminant::EqualEnergy,
    };
    let odd =
        Metal::Indices { eta: Color::Curve(TABLE), k: Color::Curve(CurveId(1)), illuminant: Illuminant::D65 };
    let conductor = |metal, roughness, energy, specular_reflectance| MaterialKind::Conductor {
        metal,
        roughness,
        energy,
        specular_reflectance,
    };
    let below = |medium| {
        MaterialKind::Subsurface(Box::new(Subsurface {
            medium,
            scale: 2.0,
            g: 0.5,
            eta: 1.4,
            roughness: alpha,
        }))
    };
    let hair = |pigment| {
        MaterialKind::Hair(Box::new(Hair {
            pigment,
            eta: Scalar::Value(1.5),
            beta_m: TEXTURE,
            beta_n: Scalar::Value(0.5),
            alpha: Scalar::Value(-3.0),
        }))
    };
    let map = NormalTexture { texture: NOISE, scale: 0.5 };
    let principled = Principled {
        base_color: COLOR,
        metallic: TEXTURE,
        roughness: Scalar::Value(0.25),
        anisotropy: Some(Anisotropy { strength: 0.5, rotation: 0.777_777_7, texture: Some(NOISE) }),
        ior: 0.0,
        dispersion: 0.4,
        specular: Scalar::Value(0.75),
        specular_color: Color::Value([1.0, 0.5, 0.25]),
        transmission: TEXTURE,
        is_solid: true,
        absorption: [0.1, 0.2, 0.3],
        diffuse_transmission: Scalar::Value(0.125),
        diffuse_transmission_color: COLOR,
        clearcoat: Scalar::Value(0.5),
        clearcoat_roughness: Scalar::Value(0.125),
        clearcoat_normal: Some(map),
        sheen_color: Color::Value([0.3, 0.2, 0.1]),
        sheen_roughness: Scalar::Value(0.25),
        iridescence: TEXTURE,
        iridescence_ior: 1.5,
        iridescence_thickness: TEXTURE,
    };
    let open = OpenPbr {
        base_weight: TEXTURE,
        base_color: COLOR,
        base_diffuse_roughness: Scalar::Value(0.5),
        base_metalness: Scalar::Value(0.5),
        specular_weight: Scalar::Value(2.0),
        specular_color: Color::Value([0.5, 0.25, 1.0]),
        specular_roughness: TEXTURE,
        specular_roughness_anisotropy: Scalar::Value(0.5),
        specular_ior: 1.7,
        transmission_weight: Scalar::Value(0.5),
        transmission_color: Color::Value([0.5, 0.75, 1.0]),
        dispersion: 0.333_333_3,
        subsurface_weight: Scalar::Value(0.25),
        subsurface_color: COLOR,
        subsurface_scatter_anisotropy: 0.5,
        coat_weight: Scalar::Value(0.5),
        coat_color: Color::Value([0.5, 0.25, 0.125]),
        coat_roughness: TEXTURE,
        coat_roughness_anisotropy: Scalar::Value(0.5),
        coat_ior: 1.5,
        coat_darkening: Scalar::Value(0.5),
        fuzz_weight: Scalar::Value(0.5),
        fuzz_color: Color::Value([0.0, 0.5, 1.0]),
        fuzz_roughness: TEXTURE,
        thin_film_weight: Scalar::Value(0.5),
        thin_film_thickness: Scalar::Value(0.25),
        thin_film_ior: 1.5,
        geometry_thin_walled: false,
        geometry_coat_normal: Some(map),
        geometry_tangent: Tangent::Value([0.5, -2.0]),
        geometry_coat_tangent: Tangent::Texture(NOISE),
    };
    let thin = OpenPbr { geometry_thin_walled: true, ..open.clone() };
    let value = Color::Value([0.123, 0.456, 0.789]);
    let whitted = Whitted {
        ambient: Some(Color::gray(0.3)),
        diffuse: COLOR,
        specular: Color::gray(0.5),
        shininess: 12.5,
        mirror: Color::gray(0.1),
        transmission: Color::gray(0.9),
        ior: 1.3,
        fresnel: true,
        absorption: [0.5, 0.25, 0.125],
    };
    let disney = Disney {
        base_color: COLOR,
        roughness: Scalar::Value(0.3),
        anisotropic: TEXTURE,
        metallic: Scalar::Value(0.123),
        spec_trans: Scalar::Value(0.5),
        eta: Scalar::Value(1.333),
        spec_tint: TEXTURE,
        sheen: Scalar::Value(2.0),
        sheen_tint: Scalar::Value(0.1),
        flatness: Scalar::Value(0.7),
        clearcoat: TEXTURE,
        clearcoat_gloss: Scalar::Value(0.9),
        diff_trans: Scalar::Value(0.0),
        is_thin: false,
    };
    let microfacets = Microfacets { distribution: Distribution::Beckmann, masking: Masking::Separable };
    let plastic = Plastic {
        reflectance: COLOR,
        specular_reflectance: value,
        eta: 1.7,
        alpha: 0.123,
        microfacets,
        is_nonlinear: false,
    };
    let beckmann = Roughness { microfacets, ..alpha };
    let (conserved, single) = (Energy::Conserved, Energy::SingleScattering);
    let (clear, stained) = (Tint::default(), Tint { reflectance: value, transmittance: COLOR });
    let glass = |eta, roughness, energy, tint| MaterialKind::Dielectric { eta, roughness, energy, tint };
    let variants = vec![
        MaterialKind::Whitted(whitted),
        MaterialKind::Diffuse { reflectance: Color::Curve(CurveId(3)) },
        MaterialKind::DiffuseTransmission { reflectance: value, transmittance: COLOR, scale: 0.5 },
        conductor(gold, rough, single, Color::gray(1.0)),
        conductor(odd, alpha, conserved, value),
        conductor(Metal::Reflectance(value), alpha, single, COLOR),
        glass(Ior::Curve(TABLE), alpha, single, clear),
        glass(Ior::Curve(CurveId(3)), rough, conserved, stained),
        MaterialKind::ThinDielectric { eta: Ior::Value(1.25), tint: clear },
        MaterialKind::ThinDielectric { eta: Ior::Value(1.25), tint: stained },
        MaterialKind::CoatedDiffuse { reflectance: value, coat },
        MaterialKind::CoatedConductor { metal: gold, roughness: rough, coat },
        below(SubsurfaceMedium::Coefficients { absorption: value, scattering: Color::Curve(TABLE) }),
        below(SubsurfaceMedium::Reflectance { reflectance: COLOR, mean_free_path: value }),
        hair(Pigment::Absorption(value)),
        hair(Pigment::Reflectance(COLOR)),
        hair(Pigment::Melanin { eumelanin: TEXTURE, pheomelanin: Scalar::Value(0.5) }),
        MaterialKind::Mix { materials: [MaterialId(0), MaterialId(0)], amount: TEXTURE },
        MaterialKind::Principled(Box::new(principled)),
        MaterialKind::Principled(Box::default()),
        MaterialKind::OpenPbr(Box::new(open)),
        MaterialKind::OpenPbr(Box::new(thin)),
        MaterialKind::OpenPbr(Box::default()),
        MaterialKind::Disney(Box::new(disney)),
        MaterialKind::Disney(Box::default()),
        MaterialKind::Disney(Box::new(Disney { is_thin: true, diff_trans: TEXTURE, ..Disney::default() })),
        MaterialKind::Plastic(Box::new(plastic)),
        MaterialKind::Plastic(Box::new(Plastic { alpha: 0.25, is_nonlinear: true, ..plastic })),
        conductor(gold, beckmann, single, Color::gray(1.0)),
        glass(Ior::Value(1.3), beckmann, single, clear),
        MaterialKind::Unlit { color: value },
        MaterialKind::ShadowCatcher { normal: unit() },
        MaterialKind::Interface,
        MaterialKind::Whitted(Whitted::default()),
    ];
    // Measured materials are copies of files: one is among the scenes of the guide.
    let index = |kind: &MaterialKind| match kind {
        MaterialKind::Whitted(_) => 0,
        MaterialKind::Diffuse { .. } => 1,
        MaterialKind::DiffuseTransmission { .. } => 2,
        MaterialKind::Conductor { .. } => 3,
        MaterialKind::Dielectric { .. } => 4,
        MaterialKind::ThinDielectric { .. } => 5,
        MaterialKind::CoatedDiffuse { .. } => 6,
        MaterialKind::CoatedConductor { .. } => 7,
        MaterialKind::Subsurface(_) => 8,
        MaterialKind::Hair(_) => 9,
        MaterialKind::Mix { .. } => 10,
        MaterialKind::Principled(_) => 11,
        MaterialKind::OpenPbr(_) => 12,
        MaterialKind::Unlit { .. } => 13,
        MaterialKind::ShadowCatcher { .. } => 14,
        MaterialKind::Interface => 15,
        MaterialKind::Disney(_) => 16,
        MaterialKind::Plastic(_) => 17,
        MaterialKind::Measured(_) => 18,
    };
    each("material", variants, index, |scene, kind| {
        scene.materials.push(Material { medium: Some(MediumId(0)), ..Material::new("made", here(), kind) });
        scene.shapes[0].material = MaterialId(1);
    })
}

pub(super) fn bumps() -> Vec<(String, Scene)> {
    let map = NormalTexture { texture: NOISE, scale: 1.0 };
    let variants = vec![
        BumpMapping::None,
        BumpMapping::Bump(TEXTURE),
        BumpMapping::NormalMap(ImageId(4)),
        BumpMapping::NormalTexture(map),
        BumpMapping::NormalTexture(NormalTexture { scale: -0.5, ..map }),
    ];
    let index = |bump: &BumpMapping| match bump {
        BumpMapping::None => 0,
        BumpMapping::Bump(_) => 1,
        BumpMapping::NormalMap(_) => 2,
        BumpMapping::NormalTexture(_) => 3,
    };
    each("bump", variants, index, |scene, bump_mapping| {
        let material = &mut scene.materials[0];
        material.bump_guard = match bump_mapping {
            BumpMapping::Bump(_) => Some(BumpGuard { turns: true, shadows: false }),
            BumpMapping::NormalMap(_) => Some(BumpGuard { turns: false, shadows: true }),
            _ => None,
        };
        material.back_face = match bump_mapping {
            BumpMapping::None => BackFace::Black,
            _ => BackFace::Own,
        };
        material.bump_mapping = bump_mapping;
    })
}
