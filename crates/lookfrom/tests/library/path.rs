//! Path tracing against radiance that is known: inside lit spheres, in a white furnace, through two integrators.

use glam::{DMat4, DVec3};
use lookfrom::render::Renderer;
use lookfrom_scene::camera::{Camera, Projection, View};
use lookfrom_scene::light::{Falloff, Light, LightKind, Power, Sky};
use lookfrom_scene::material::{
    Coat, CoatEstimate, Color, Energy, Ior, Material, MaterialKind, Metal, Roughness, Scalar,
};
use lookfrom_scene::scene::{MaterialId, Scene};
use lookfrom_scene::settings::{ColorMode, Filter, Integrator, LightSampler, Sampler};
use lookfrom_scene::shape::{Emission, Geometry, Shape, Sphere};
use lookfrom_scene::{Location, Warning};

fn nowhere() -> Location {
    Location::default()
}

fn unit_sphere() -> Geometry {
    Geometry::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 })
}

/// A scene of one shape of one material, small pictures, a box filter.
fn scene(kind: MaterialKind, geometry: Geometry) -> Scene {
    let mut scene = Scene::default();
    scene.materials.push(Material::new("the one", nowhere(), kind));
    scene.shapes.push(Shape::new(nowhere(), geometry, MaterialId(0)));
    (scene.image.width, scene.image.height) = (8, 8);
    scene.image.filter = Filter::Box { radius: 0.5 };
    scene.render.integrator = Integrator::Path;
    scene.render.depth = 100;
    scene
}

fn light(kind: LightKind) -> Light {
    Light { name: None, at: nowhere(), kind, power: Power::AS_WRITTEN }
}

/// The mean over the picture by channel.
fn mean(scene: Scene) -> [f64; 3] {
    let mut warnings: Vec<Warning> = Vec::new();
    let renderer = Renderer::of_scene(scene, &mut warnings).expect("a good scene");
    let rendered = renderer.render(None, &()).expect("a picture");
    assert_eq!(rendered.film.dropped(), 0);
    let pixels = rendered.film.picture().pixels;
    let mut sum = [0.0; 3];
    for pixel in &pixels {
        for c in 0..3 {
            sum[c] += f64::from(pixel[c]) / pixels.len() as f64;
        }
    }
    sum
}

fn assert_is(found: [f64; 3], expected: f64, within: f64, what: &str) {
    for channel in found {
        assert!((channel - expected).abs() <= within * expected, "{what}: {found:?}, expected {expected}");
    }
}

fn cameras() -> Vec<Camera> {
    let view = View::Look { lookfrom: DVec3::ZERO, lookat: DVec3::new(0.2, 0.3, 1.0), up: DVec3::Y };
    let camera = |projection| Camera { view, projection, ..Camera::default() };
    vec![
        camera(Projection::Perspective { fov: 45.0 }),
        camera(Projection::Orthographic { height: 1.0 }),
        camera(Projection::Equirectangular),
        camera(Projection::Octahedral),
    ]
}

/// ρ = ½ and a light that alone would be seen as ½: ½ + ¼ + ⅛ … = 1, everywhere in the sphere.
#[test]
fn inside_a_lit_sphere_radiance_is_one() {
    let half = || MaterialKind::Diffuse { reflectance: Color::gray(0.5) };
    for (number, camera) in cameras().into_iter().enumerate() {
        for integrator in [Integrator::Path, Integrator::SimplePath, Integrator::RandomWalk] {
            for (sampler, color) in [
                (Sampler::Sobol, ColorMode::Rgb),
                (Sampler::Independent, ColorMode::Rgb),
                (Sampler::Sobol, ColorMode::Spectral),
            ] {
                let configured = |mut scene: Scene| {
                    scene.camera = Some(camera.clone());
                    scene.render.integrator = integrator;
                    scene.render.sampler = sampler;
                    scene.render.color = color;
                    scene.render.samples = if integrator == Integrator::RandomWalk { 512 } else { 128 };
                    scene
                };
                let within = if integrator == Integrator::RandomWalk { 0.05 } else { 0.03 };
                let what = format!("camera {number}, {integrator:?}, {sampler:?}, {color:?}");

                let mut shining = configured(scene(half(), unit_sphere()));
                shining.shapes[0].emission = Some(Emission::new(Color::gray(0.5), true));
                assert_is(mean(shining), 1.0, within, &format!("shining sphere, {what}"));

                if integrator != Integrator::RandomWalk {
                    let mut lit = configured(scene(half(), unit_sphere()));
                    // In the units of Whitted: a white surface at a distance of 1 is seen as 1.
                    let kind = LightKind::Point {
                        position: DVec3::ZERO,
                        intensity: Color::gray(1.0),
                        falloff: Falloff::Quadratic,
                    };
                    lit.lights.push(light(kind));
                    assert_is(mean(lit), 1.0, within, &format!("point light, {what}"));
                }
            }
        }
    }
}

fn furnace(kind: MaterialKind) -> Scene {
    let mut scene = scene(kind, unit_sphere());
    let sky = Sky::Constant(Color::gray(1.0));
    scene.lights.push(light(LightKind::Environment { sky, portal: None, illuminates: true }));
    let view = View::Look { lookfrom: DVec3::new(0.0, 0.0, 2.0), lookat: DVec3::ZERO, up: DVec3::Y };
    let projection = Projection::Perspective { fov: 20.0 };
    scene.camera = Some(Camera { view, projection, ..Camera::default() });
    scene.render.samples = 256;
    scene
}

/// Whoever keeps all light cannot be seen in front of light that is the same all around.
#[test]
fn a_white_furnace_hides_what_keeps_all_light() {
    let rough = |alpha: f32| Roughness { u: Scalar::Value(alpha), v: Scalar::Value(alpha), remap: false };
    let white = Color::gray(1.0);
    let metal =
        |roughness, energy| MaterialKind::Conductor { metal: Metal::Reflectance(white), roughness, energy };
    let glass = |roughness, energy| MaterialKind::Dielectric { eta: Ior::Value(1.5), roughness, energy };
    let kinds = [
        ("diffuse", MaterialKind::Diffuse { reflectance: white }),
        (
            "diffuse transmission",
            MaterialKind::DiffuseTransmission {
                reflectance: Color::gray(0.5),
                transmittance: Color::gray(0.5),
                scale: 1.0,
            },
        ),
        ("glass", glass(Roughness::SMOOTH, Energy::SingleScattering)),
        ("thin glass", MaterialKind::ThinDielectric { eta: Ior::Value(1.5) }),
        ("interface", MaterialKind::Interface),
        ("mirror", metal(Roughness::SMOOTH, Energy::SingleScattering)),
        ("nearly smooth metal", metal(rough(0.05), Energy::SingleScattering)),
        ("nearly smooth glass", glass(rough(0.02), Energy::SingleScattering)),
        ("rough metal", metal(rough(0.9), Energy::Conserved)),
        ("rough glass", glass(rough(0.8), Energy::Conserved)),
    ];
    for (name, kind) in kinds {
        for color in [ColorMode::Rgb, ColorMode::Spectral] {
            let mut scene = furnace(kind.clone());
            scene.render.color = color;
            // Spectral samples differ in colour; microfacets lose a little between them.
            let within = if color == ColorMode::Rgb { 0.005 } else { 0.02 };
            assert_is(mean(scene), 1.0, within, &format!("{name}, {color:?}"));
        }
    }
}

/// A smooth coat over a white base keeps all light, but for what is cut off after many bounces.
#[test]
fn a_smooth_coat_keeps_all_light() {
    let coat = Coat {
        eta: Ior::Value(1.5),
        roughness: Roughness::SMOOTH,
        // The layer itself takes some light, as in pbrt: none is left to take here.
        thickness: Scalar::Value(1e-6),
        albedo: Color::BLACK,
        g: Scalar::Value(0.0),
        max_depth: 100,
        samples: 1,
        estimate: CoatEstimate::Unbiased,
    };
    let found = mean(furnace(MaterialKind::CoatedDiffuse { reflectance: Color::gray(1.0), coat }));
    assert!(found[0] > 0.985 && found[0] < 1.005, "{found:?}");
}

/// Lights of each kind, and many of them: asked by importance or evenly, the light is the same.
#[test]
fn the_way_of_choosing_lights_does_not_matter() {
    let lit = |light_sampler, integrator| {
        let floor = Geometry::Quad {
            corner: DVec3::new(-2.0, 0.0, -2.0),
            edge_u: DVec3::Z * 4.0,
            edge_v: DVec3::X * 4.0,
        };
        let mut scene = scene(MaterialKind::Diffuse { reflectance: Color::gray(0.6) }, floor);
        for (k, radiance) in [(0, 3.0), (1, 8.0), (2, 1.0), (3, 20.0)] {
            let at = DVec3::new(f64::from(k) - 1.5, 0.8, 0.3 * f64::from(k));
            let geometry = match k % 2 {
                0 => Geometry::Sphere(Sphere { center: at, radius: 0.1 }),
                _ => Geometry::Disk { center: at, normal: DVec3::NEG_Y, radius: 0.1 },
            };
            let emission = Some(Emission::new(Color::gray(radiance), k == 3));
            scene.shapes.push(Shape { emission, ..Shape::new(nowhere(), geometry, MaterialId(0)) });
        }
        scene.lights.push(light(LightKind::Spot {
            position: DVec3::new(0.0, 2.0, 0.0),
            direction: DVec3::NEG_Y,
            intensity: Color::gray(1.0),
            cone_angle: 40.0,
            inner_angle: 20.0,
            falloff: Falloff::Quadratic,
        }));
        let view = View::Look { lookfrom: DVec3::new(0.0, 3.0, 0.01), lookat: DVec3::ZERO, up: DVec3::Z };
        scene.camera = Some(Camera { view, ..Camera::default() });
        scene.render.integrator = integrator;
        scene.render.light_sampler = light_sampler;
        scene.render.samples = 1024;
        scene.render.depth = 3;
        mean(scene)[0]
    };
    let expected = lit(LightSampler::Bvh, Integrator::Path);
    for (sampler, integrator) in [
        (LightSampler::Uniform, Integrator::Path),
        (LightSampler::Power, Integrator::Path),
        (LightSampler::Bvh, Integrator::SimplePath),
    ] {
        let found = lit(sampler, integrator);
        let difference = (found - expected).abs() / expected;
        assert!(difference < 0.01, "{sampler:?} {integrator:?}: {found}, expected {expected}");
    }
}

/// A picture of the surroundings with one bright spot: found by asking it and by chance alike.
#[test]
fn a_picture_all_around_lights_as_it_is_seen() {
    let texels = (0..256).map(|k| if k == 133 { [50.0, 20.0, 10.0] } else { [0.2; 3] }).collect();
    let image = lookfrom_scene::image::Image::from_linear("", 16, 16, texels);
    let lit = |octahedral: bool, integrator| {
        let mut scene = furnace(MaterialKind::Diffuse { reflectance: Color::gray(0.7) });
        scene.lights.clear();
        scene.images.push(image.clone());
        let (image, scale) = (lookfrom_scene::scene::ImageId(0), [1.0; 3]);
        let world_from_light = DMat4::from_rotation_x(0.7);
        let sky = match octahedral {
            true => Sky::Octahedral { image, scale, world_from_light },
            false => Sky::Image { image, scale, world_from_light },
        };
        scene.lights.push(light(LightKind::Environment { sky, portal: None, illuminates: true }));
        scene.render.integrator = integrator;
        scene.render.samples = if integrator == Integrator::Path { 256 } else { 4096 };
        mean(scene)
    };
    for octahedral in [true, false] {
        let expected = lit(octahedral, Integrator::Path);
        let found = lit(octahedral, Integrator::RandomWalk);
        for c in 0..3 {
            let difference = (found[c] - expected[c]).abs() / expected[c];
            assert!(difference < 0.03, "octahedral {octahedral}: {found:?}, expected {expected:?}");
        }
    }
}
