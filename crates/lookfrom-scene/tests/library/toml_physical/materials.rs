//! Materials.

use std::path::Path;

use lookfrom_scene::material::{
    BumpMapping, Color, Distribution, Energy, Illuminant, Ior, Masking, MaterialKind, Metal, Microfacets,
    Plastic, Roughness, Scalar, Tint,
};
use lookfrom_scene::spectrum::{self};
use lookfrom_scene::texture::TextureKind;
use lookfrom_scene::{LoadContext, Memory, image, load};

use super::{kind, read};

#[test]
fn microfacets_are_of_a_kind() {
    let scene = read(
        r#"
[materials.usual]
type = "dielectric"
roughness = 0.3
distribution = "trowbridge_reitz"
[materials.walter]
type = "conductor"
metal = "gold"
energy = "single_scattering"
distribution = "beckmann"
masking = "separable"
[materials.ball]
type = "plastic"
[materials.toy]
type = "plastic"
reflectance = [0.1, 0.2, 0.3]
specular_reflectance = 0.5
nonlinear = false
ior = 1.4
roughness = 0.5
distribution = "beckmann"
"#,
    );
    let MaterialKind::Dielectric { roughness, .. } = kind(&scene, "usual") else { panic!("a dielectric") };
    assert_eq!(roughness.microfacets, Microfacets::default());
    let MaterialKind::Conductor { roughness, .. } = kind(&scene, "walter") else { panic!("a conductor") };
    let walter = Microfacets { distribution: Distribution::Beckmann, masking: Masking::Separable };
    assert_eq!(roughness.microfacets, walter);
    let ball = Plastic {
        reflectance: Color::gray(0.8),
        specular_reflectance: Color::gray(1.0),
        eta: 1.5,
        alpha: 0.0,
        microfacets: Microfacets::default(),
        is_nonlinear: true,
    };
    assert_eq!(*kind(&scene, "ball"), MaterialKind::Plastic(Box::new(ball)));
    let toy = Plastic {
        reflectance: Color::Value([0.1, 0.2, 0.3]),
        specular_reflectance: Color::gray(0.5),
        eta: 1.4,
        alpha: 0.25,
        microfacets: Microfacets { distribution: Distribution::Beckmann, ..Microfacets::default() },
        is_nonlinear: false,
    };
    assert_eq!(*kind(&scene, "toy"), MaterialKind::Plastic(Box::new(toy)));
}

#[test]
fn materials_are_what_they_say() {
    let scene = read(
        r##"
[materials.gold]
type = "conductor"
metal = "gold"
illuminant = "E"
roughness = 0.5
[materials.tin]
type = "conductor"
reflectance = "#808080"
specular_reflectance = 0.5
roughness = [0.1, "spots"]
energy = "single_scattering"
[materials.salt]
type = "conductor"
eta = { curve = [[500, 1.5], [600, 2]] }
k = [3, 2, 1]
[materials.prism]
type = "dielectric"
ior = "SF11"
[materials.flint]
type = "dielectric"
ior = { n_d = 1.6, abbe = 36 }
[materials.pane]
type = "thin_dielectric"
ior = 1.3
specular_reflectance = 0.5
specular_transmittance = [0.2, 0.4, 0.6]
[materials.plastic]
type = "coated_diffuse"
roughness = 0.3
coat_albedo = 0.4
g = 0.5
bump = "spots"
[materials.anodised]
type = "coated_conductor"
metal = "Al"
base_roughness = 0.5
[materials.a_mix]
type = "mix"
materials = ["gold", "plastic"]
amount = "spots"
[materials.paper]
type = "diffuse_transmission"
transmittance = 0.5
normal_map = "half.png"
[materials.nothing]
type = "interface"
[materials.red]
type = "diffuse"
reflectance = { type = "image", file = "half.png" }
[textures.spots]
type = "dots"
"##,
    );
    let curve = |color: Color| match color {
        Color::Curve(id) => &scene.curves[id.index()],
        other => panic!("{other:?} is no curve"),
    };
    let MaterialKind::Conductor { metal, roughness, energy, specular_reflectance } = *kind(&scene, "gold")
    else {
        panic!("a conductor")
    };
    let Metal::Indices { eta, k, illuminant } = metal else { panic!("{metal:?}") };
    assert_eq!((illuminant, specular_reflectance), (Illuminant::EqualEnergy, Color::gray(1.0)));
    assert_eq!(*curve(eta), spectrum::named("metal-Au-eta").expect("gold"));
    assert_eq!(*curve(k), spectrum::named("metal-Au-k").expect("gold"));
    assert_eq!(energy, Energy::Conserved);
    // Perceptual 0.5 is α = 0.25.
    let quarter = Scalar::Value(0.25);
    assert_eq!(roughness, Roughness::of_alphas(quarter, quarter));

    // A texture is squared as a number is.
    let MaterialKind::Conductor {
        metal: Metal::Reflectance(_),
        roughness,
        energy,
        specular_reflectance: Color::Value([0.5, 0.5, 0.5]),
    } = *kind(&scene, "tin")
    else {
        panic!("a conductor")
    };
    assert_eq!(energy, Energy::SingleScattering);
    assert_eq!((roughness.u, roughness.remap), (Scalar::Value(0.1_f32 * 0.1), false));
    let Scalar::Texture(squared) = roughness.v else { panic!("a texture") };
    let TextureKind::Scale { color: Color::Texture(spots), by: Scalar::Texture(also) } =
        scene.textures[squared.index()].kind
    else {
        panic!("a product")
    };
    assert_eq!((spots, scene.textures[spots.index()].name.as_str()), (also, "spots"));

    // Optical constants go on beyond their table.
    let MaterialKind::Conductor { metal: Metal::Indices { eta, .. }, .. } = *kind(&scene, "salt") else {
        panic!("a conductor")
    };
    for (nm, expected) in [(360.0, 1.5), (550.0, 1.75), (830.0, 2.0)] {
        assert!((curve(eta).at(nm) - expected).abs() < 1e-6);
    }

    let MaterialKind::Dielectric { eta: Ior::Curve(glass), roughness, energy, tint } = *kind(&scene, "prism")
    else {
        panic!("a dielectric")
    };
    assert_eq!((energy, tint), (Energy::Conserved, Tint::default()));
    assert_eq!(scene.curves[glass.index()], spectrum::named("glass-SF11").expect("a glass"));
    assert_eq!(roughness.u, Scalar::Value(0.0));
    let MaterialKind::Dielectric { eta: Ior::Curve(flint), .. } = *kind(&scene, "flint") else {
        panic!("a dielectric")
    };
    let [blue, yellow, red] = [486.13, 587.56, 656.27].map(|nm| scene.curves[flint.index()].at(nm));
    assert!((yellow - 1.6).abs() < 1e-5 && (0.6 / (blue - red) - 36.0).abs() < 0.01);
    let tint = Tint { reflectance: Color::gray(0.5), transmittance: Color::Value([0.2, 0.4, 0.6]) };
    assert_eq!(*kind(&scene, "pane"), MaterialKind::ThinDielectric { eta: Ior::Value(1.3), tint });
    let MaterialKind::CoatedDiffuse { coat, .. } = *kind(&scene, "plastic") else { panic!("coated") };
    assert_eq!((coat.roughness.u, coat.albedo), (Scalar::Value(0.3 * 0.3), Color::gray(0.4)));
    assert_eq!((coat.eta, coat.g), (Ior::Value(1.5), Scalar::Value(0.5)));
    let MaterialKind::CoatedConductor { roughness, coat, .. } = *kind(&scene, "anodised") else {
        panic!("coated")
    };
    assert_eq!((roughness.u, coat.roughness.u), (quarter, Scalar::Value(0.0)));
    let MaterialKind::Mix { materials, amount } = *kind(&scene, "a_mix") else { panic!("a mix") };
    assert_eq!(materials.map(|id| scene.materials[id.index()].name.as_str()), ["gold", "plastic"]);
    assert_eq!(amount, Scalar::Texture(spots));
    assert_eq!(*kind(&scene, "nothing"), MaterialKind::Interface);

    // The same file is numbers for a normal map and a colour elsewhere.
    let bump_mapping =
        |name: &str| scene.materials.iter().find(|m| m.name == name).expect("a material").bump_mapping;
    assert_eq!(bump_mapping("plastic"), BumpMapping::Bump(Scalar::Texture(spots)));
    let BumpMapping::NormalMap(normals) = bump_mapping("paper") else { panic!("a normal map") };
    assert_eq!(scene.images[normals.index()].texel(0)[0], 128.0 / 255.0);
    let linear = image::linear_from_srgb(128.0 / 255.0);
    assert!(scene.images.iter().any(|image| image.texel(0)[0] == linear));
}

#[test]
fn mixes_of_mixes_come_to_an_end() {
    let chain: String = (0..100_000)
        .map(|i| format!("[materials.m{i}]\ntype = \"mix\"\nmaterials = [\"m{}\", \"last\"]\n", i + 1))
        .collect();
    let text = format!("{chain}[materials.m100000]\n[materials.last]\n");
    let mut files = Memory::default();
    files.0.insert("a.toml".into(), text.into_bytes());
    let error = load::scene(Path::new("a.toml"), &mut LoadContext::new(&files)).unwrap_err();
    assert_eq!(error.kind, lookfrom_scene::ErrorKind::Limit, "{error}");
}
