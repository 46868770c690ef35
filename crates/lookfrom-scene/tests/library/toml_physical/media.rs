//! Media.

use glam::{DVec3, Vec3};
use lookfrom_scene::material::{Color, MaterialKind, Scalar, SubsurfaceMedium};
use lookfrom_scene::medium::{Density, Extinction};
use lookfrom_scene::scene::MediumId;
use lookfrom_scene::settings::Integrator;

use super::{kind, read};

#[test]
fn media_are_what_they_say() {
    let scene = read(
        r##"
[camera]
lookfrom = [0, 0, 5]
lookat = [0, 0, 0]
medium = "haze"
[media.haze]
scattering = 0.1
g = -0.4
density = 3
[media.smoke]
absorption = [1, 2, 3]
emission = [4, 5, 6]
density = { formula = "x + 10 * y + 100 * z", min = [0, 0, 0], max = [4, 2, 1], cells = 4 }
translate = [7, 8, 9]
[media.spots]
scattering = 1
density = { type = "noise" }
max_density = 2
[media.flame]
absorption = 1
emission = 2
temperature = { formula = "1000 - 3000 * x", cells = 2 }
[materials.liquid]
type = "dielectric"
medium = "spots"
[[sphere]]
medium = "smoke"
[[sphere]]
medium = "smoke"
[[sphere]]
material = "liquid"
medium = "flame"
[[sphere]]
material = "liquid"
"##,
    );
    assert_eq!(scene.render.integrator, Integrator::Path);
    let medium = |name: &str| scene.media.iter().find(|medium| medium.name == name).expect("a medium");
    let id = |name: &str| scene.media.iter().position(|medium| medium.name == name);
    let (haze, smoke, spots, flame) = (medium("haze"), medium("smoke"), medium("spots"), medium("flame"));
    assert_eq!(scene.camera.as_ref().and_then(|camera| camera.medium).map(MediumId::index), id("haze"));
    let parts = |absorption, scattering| Extinction::Parts { absorption, scattering };
    assert_eq!((haze.extinction, haze.g, haze.scale), (parts(Color::BLACK, Color::gray(0.1)), -0.4, 3.0));
    assert!(haze.scatters() && !haze.emits() && haze.variation.is_none());
    assert!(!smoke.scatters() && smoke.emits());
    assert_eq!(
        (smoke.extinction, smoke.emission),
        (parts(Color::Value([1.0, 2.0, 3.0]), Color::BLACK), Color::Value([4.0, 5.0, 6.0]))
    );

    // A formula is evaluated at the centres of cells.
    let variation = smoke.variation.as_ref().expect("a variation");
    assert_eq!(variation.world_from_medium.w_axis.truncate(), DVec3::new(7.0, 8.0, 9.0));
    let Density::Grid(placed) = &variation.density else { panic!("no grid") };
    assert_eq!((placed.grid.size(), placed.bounds), ([4, 2, 1], [Vec3::ZERO, Vec3::new(4.0, 2.0, 1.0)]));
    assert_eq!(variation.bounds, Some(placed.bounds));
    for [x, y] in [[0, 0], [3, 0], [1, 1]] {
        let expected = (x as f32 + 0.5) + 10.0 * (y as f32 + 0.5) + 50.0;
        assert_eq!(placed.grid.value([x, y, 0]), expected);
    }
    let spots = spots.variation.as_ref().expect("a variation");
    assert!(matches!(spots.density, Density::Texture { of: Scalar::Texture(_), most: 2.0 }));
    assert_eq!(spots.bounds, None);
    let hot =
        flame.variation.as_ref().and_then(|variation| variation.temperature.as_ref()).expect("temperatures");
    // What is negative is nothing.
    assert_eq!([0, 1].map(|x| hot.grid.grid.value([x, 0, 0])), [2500.0, 0.0]);
    assert!(flame.emits());

    // What is filled has materials of its own, each once.
    let inside =
        |shape: usize| scene.materials[scene.shapes[shape].material.index()].medium.map(MediumId::index);
    assert_eq!([0, 1, 2, 3].map(inside), [id("smoke"), id("smoke"), id("flame"), id("spots")]);
    assert_eq!(scene.shapes[0].material, scene.shapes[1].material);
    let of = |shape: usize| &scene.materials[scene.shapes[shape].material.index()].kind;
    assert!(matches!(of(0), MaterialKind::Interface) && matches!(of(2), MaterialKind::Dielectric { .. }));
}

#[test]
fn media_below_surfaces() {
    let scene = read(
        r#"
        [materials.milk]
        type = "subsurface"

        [materials.skin]
        type = "subsurface"
        preset = "Skin1"
        scale = 10
        roughness = 0.5

        [materials.wax]
        type = "subsurface"
        absorption = [1, 2, 3]
        scattering = 9
        g = -0.3
        ior = 1.4

        [materials.jade]
        type = "subsurface"
        reflectance = [0.3, 0.7, 0.4]
        mean_free_path = 0.1
        "#,
    );
    let of = |name: &str| match kind(&scene, name) {
        MaterialKind::Subsurface(below) => &**below,
        other => panic!("{other:?}"),
    };
    let milk = of("milk");
    assert_eq!((&milk.medium, milk.scale, milk.g, milk.eta), (&SubsurfaceMedium::MILK, 1.0, 0.0, 1.33));
    let skin = of("skin");
    let absorption = Color::Value([0.032, 0.17, 0.48]);
    assert_eq!(
        skin.medium,
        SubsurfaceMedium::Coefficients { absorption, scattering: Color::Value([0.74, 0.88, 1.01]) }
    );
    assert_eq!((skin.scale, skin.roughness.u, skin.roughness.remap), (10.0, Scalar::Value(0.25), false));
    let wax = of("wax");
    let absorption = Color::Value([1.0, 2.0, 3.0]);
    assert_eq!(wax.medium, SubsurfaceMedium::Coefficients { absorption, scattering: Color::gray(9.0) });
    assert_eq!((wax.g, wax.eta), (-0.3, 1.4));
    let reflectance = Color::Value([0.3, 0.7, 0.4]);
    assert_eq!(
        of("jade").medium,
        SubsurfaceMedium::Reflectance { reflectance, mean_free_path: Color::gray(0.1) }
    );
}
