//! OpenPBR.

use std::f32::consts::LN_2;
use std::path::Path;

use lookfrom_scene::material::{Color, MaterialKind, OpenPbr, Roughness, Scalar, SubsurfaceMedium, Tangent};
use lookfrom_scene::medium::Extinction;
use lookfrom_scene::{LoadContext, Memory, load};

use super::{kind, read};

#[test]
fn openpbr_is_a_surface_a_medium_and_what_shapes_have() {
    let scene = read(
        r##"
[materials.usual]
type = "openpbr"
[materials.honey]
type = "openpbr"
transmission_weight = 1
transmission_color = [0.5, 1, 0.25]
transmission_depth = 2
transmission_scatter = [0.2, 0.4, 0.6]
transmission_scatter_anisotropy = -1
transmission_dispersion_scale = 0.5
[materials.wax]
type = "openpbr"
subsurface_weight = 1
subsurface_color = [0.9, 0.8, 0.7]
subsurface_radius = 0.5
specular_roughness = 0.5
specular_roughness_anisotropy = 0.5
[materials.skin]
type = "openpbr"
subsurface_weight = 0.25
[materials.lamp]
type = "openpbr"
emission_luminance = 3
emission_color = [1, 0.5, 0]
geometry_opacity = 0.5
geometry_tangent = [0, 1]
[[sphere]]
material = "lamp"
[[sphere]]
material = "lamp"
alpha = 0.75
"##,
    );
    let look = |name| match kind(&scene, name) {
        MaterialKind::OpenPbr(look) => look,
        other => panic!("{other:?}"),
    };
    // The specification's defaults.
    assert_eq!(**look("usual"), OpenPbr::default());
    assert!(!look("usual").is_body() && look("honey").is_body());
    // Extinction −ln T / depth, less scattering S / depth, raised by what green has less than none.
    assert_eq!(look("honey").transmission_color, Color::gray(1.0));
    assert_eq!(look("honey").dispersion, 0.5);
    let honey = scene.materials.iter().find(|material| material.name == "honey").expect("honey");
    let medium = &scene.media[honey.medium.expect("a medium").index()];
    let Extinction::Parts { absorption: Color::Value(absorption), scattering: Color::Value(scattering) } =
        medium.extinction
    else {
        panic!("{medium:?}")
    };
    let expected = [0.5 * LN_2 - 0.1 + 0.2, 0.0, LN_2 - 0.3 + 0.2];
    for k in 0..3 {
        assert!((absorption[k] - expected[k]).abs() < 1e-5, "{absorption:?} {expected:?}");
    }
    assert_eq!(scattering, [0.1, 0.2, 0.3]);
    assert_eq!(medium.g, -0.99);
    // In depth it is the material of that name, or a mix with it.
    let MaterialKind::Subsurface(wax) = kind(&scene, "wax") else { panic!("{:?}", kind(&scene, "wax")) };
    let reflectance = Color::Value([0.9, 0.8, 0.7]);
    let mean_free_path = Color::Value([0.5, 0.25, 0.125]);
    assert_eq!(wax.medium, SubsurfaceMedium::Reflectance { reflectance, mean_free_path });
    let [u, v] = OpenPbr::alphas(0.5, 0.5).map(Scalar::Value);
    assert_eq!((wax.eta, wax.roughness), (1.5, Roughness::of_alphas(u, v)));
    let MaterialKind::Mix { materials: [above, below], amount } = kind(&scene, "skin") else {
        panic!("{:?}", kind(&scene, "skin"))
    };
    assert_eq!(*amount, Scalar::Value(0.25));
    let part = |id: &lookfrom_scene::scene::MaterialId| &scene.materials[id.index()].kind;
    assert!(matches!(part(above), MaterialKind::OpenPbr(_)));
    assert!(matches!(part(below), MaterialKind::Subsurface(_)));
    // Shapes have emission and opacity.
    let glow = scene.shapes[0].emission.expect("a lamp");
    assert_eq!((glow.radiance, glow.power.scale), (Color::Value([1.0, 0.5, 0.0]), 3.0));
    assert_eq!(
        scene.shapes.iter().map(|shape| shape.alpha).collect::<Vec<_>>(),
        [0.5, 0.75].map(|a| Some(Scalar::Value(a)))
    );
    assert_eq!(look("lamp").geometry_tangent, Tangent::Value([0.0, 1.0]));
}

#[test]
fn openpbr_tells_what_it_approximates() {
    let warnings = |text: &str| {
        let mut files = Memory::default();
        files.0.insert("a.toml".into(), format!("[materials.a]\ntype = \"openpbr\"\n{text}").into_bytes());
        let mut context = LoadContext::new(&files);
        load::scene(Path::new("a.toml"), &mut context).unwrap_or_else(|error| panic!("{error}"));
        context.warnings.iter().map(|warning| warning.message.clone()).collect::<Vec<_>>()
    };
    let said = |text: &str, word: &str| {
        let said = warnings(text);
        assert!(said.iter().any(|message| message.contains(word)), "{text}: {said:?}");
    };
    said("subsurface_weight = 1\ncoat_weight = 0.5", "taken for diffuse");
    said("subsurface_weight = 1\nbase_metalness = 0.5", "taken for diffuse");
    said("emission_luminance = 1\ncoat_weight = 1\ncoat_color = [1, 0, 0]", "does not colour");
    said("transmission_weight = 1\ntransmission_scatter = 0.5", "`transmission_depth`");
    said("transmission_depth = 1", "`transmission_weight`");
    said("emission_color = 0.5", "`emission_luminance`");
    for fine in
        ["", "subsurface_weight = 1", "geometry_thin_walled = true\nsubsurface_weight = 1\ncoat_weight = 1"]
    {
        assert_eq!(warnings(fine), Vec::<String>::new(), "{fine}");
    }
}
