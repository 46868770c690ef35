//! Path tracing against radiance that is known: inside lit spheres, in a white furnace, through two integrators.

use glam::{DMat4, DVec3};
use lookfrom::render::Renderer;
use lookfrom_scene::camera::{Camera, Projection, View};
use lookfrom_scene::light::{Edge, Falloff, Light, LightKind, MapRows, Power, Sky};
use lookfrom_scene::material::{
    Coat, CoatEstimate, Color, Energy, Ior, Material, MaterialKind, Metal, Microfacets, Plastic, Roughness,
    Scalar, Tint,
};
use lookfrom_scene::scene::{MaterialId, Scene};
use lookfrom_scene::settings::{ColorMode, FilterShape, Integrator, LightSampler, Sampler};
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
    scene.image.filter = FilterShape::Box.of_radius(0.5);
    scene.render.integrator = Integrator::Path;
    scene.render.depth = 100;
    scene
}

fn light(kind: LightKind) -> Light {
    Light { name: None, at: nowhere(), kind, power: Power::AS_WRITTEN }
}

/// Independent pictures of a scene, which share its samples.
const PICTURES: u32 = 16;

/// The mean over a scene's pictures by channel, and its standard error, measured by how the pictures differ. (That of their
/// samples would be too large, since they are stratified.)
#[derive(Debug)]
struct Estimate {
    mean: [f64; 3],
    error: [f64; 3],
}

impl Estimate {
    /// What is known.
    fn exactly(value: f64) -> Self {
        Self { mean: [value; 3], error: [0.0; 3] }
    }

    fn of(mut scene: Scene) -> Self {
        scene.render.samples /= PICTURES;
        let means: Vec<[f64; 3]> = (0..PICTURES)
            .map(|seed| {
                scene.render.seed = u64::from(seed);
                mean(scene.clone())
            })
            .collect();
        let over = |of: &dyn Fn(usize, f64) -> f64| {
            [0, 1, 2].map(|c| means.iter().map(|mean| of(c, mean[c])).sum::<f64>() / f64::from(PICTURES))
        };
        let mean = over(&|_, value| value);
        let variance = over(&|c, value| (value - mean[c]).powi(2));
        Self { mean, error: variance.map(|variance| (variance / f64::from(PICTURES - 1)).sqrt()) }
    }

    /// They differ by at most 4½ standard errors, which are small, and a part of the light that is no noise. (Of Student's
    /// distribution, one in two thousand is farther out.)
    #[track_caller]
    fn assert_is(&self, expected: &Self, bias: f64, what: &str) {
        for c in 0..3 {
            let error = self.error[c].hypot(expected.error[c]);
            assert!(
                error < 0.006 * expected.mean[c],
                "{what}: too much noise to tell: {self:?}, {expected:?}"
            );
            let difference = (self.mean[c] - expected.mean[c]).abs();
            assert!(
                difference <= bias * expected.mean[c] + 4.5 * error,
                "{what}: {self:?}, expected {expected:?}"
            );
        }
    }
}

/// The mean over one picture by channel.
fn mean(scene: Scene) -> [f64; 3] {
    let mut warnings: Vec<Warning> = Vec::new();
    let renderer = Renderer::of_scene(scene, &mut warnings).expect("a good scene");
    let rendered = renderer.render(None, &()).expect("a picture");
    assert_eq!(rendered.film.dropped(), 0);
    let pixels = rendered.film.picture().pixels;
    [0, 1, 2].map(|c| pixels.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / pixels.len() as f64)
}

/// What the rounding of f32 may add up to.
const ROUNDING: f64 = 1e-4;

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
                    scene.render.samples = if integrator == Integrator::RandomWalk { 2048 } else { 128 };
                    scene
                };
                let what = format!("camera {number}, {integrator:?}, {sampler:?}, {color:?}");

                let mut shining = configured(scene(half(), unit_sphere()));
                shining.shapes[0].emission = Some(Emission::new(Color::gray(0.5), true));
                Estimate::of(shining).assert_is(
                    &Estimate::exactly(1.0),
                    ROUNDING,
                    &format!("shining sphere, {what}"),
                );

                if integrator != Integrator::RandomWalk {
                    let mut lit = configured(scene(half(), unit_sphere()));
                    // In the units of Whitted: a white surface at a distance of 1 is seen as 1.
                    let kind = LightKind::Point {
                        position: DVec3::ZERO,
                        intensity: Color::gray(1.0),
                        falloff: Falloff::Quadratic,
                    };
                    lit.lights.push(light(kind));
                    Estimate::of(lit).assert_is(
                        &Estimate::exactly(1.0),
                        ROUNDING,
                        &format!("point light, {what}"),
                    );
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
    let rough = |alpha: f32| Roughness::of_alphas(Scalar::Value(alpha), Scalar::Value(alpha));
    let white = Color::gray(1.0);
    let metal = |roughness, energy| MaterialKind::Conductor {
        metal: Metal::Reflectance(white),
        roughness,
        energy,
        specular_reflectance: white,
    };
    let glass = |roughness, energy| MaterialKind::Dielectric {
        eta: Ior::Value(1.5),
        roughness,
        energy,
        tint: Tint::default(),
    };
    let plastic = MaterialKind::Plastic(Box::new(Plastic {
        reflectance: white,
        specular_reflectance: white,
        eta: 1.5,
        alpha: 0.0,
        microfacets: Microfacets::default(),
        is_nonlinear: true,
    }));
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
        ("thin glass", MaterialKind::ThinDielectric { eta: Ior::Value(1.5), tint: Tint::default() }),
        ("interface", MaterialKind::Interface),
        ("plastic", plastic),
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
            // Microfacets lose a little between them.
            Estimate::of(scene).assert_is(&Estimate::exactly(1.0), 0.005, &format!("{name}, {color:?}"));
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
    let found = Estimate::of(furnace(MaterialKind::CoatedDiffuse { reflectance: Color::gray(1.0), coat }));
    let y = found.mean[1];
    assert!(y > 0.985 && y < 1.0 + 4.5 * found.error[1], "{found:?}");
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
            edge: Edge::Smooth,
            falloff: Falloff::Quadratic,
        }));
        let view = View::Look { lookfrom: DVec3::new(0.0, 3.0, 0.01), lookat: DVec3::ZERO, up: DVec3::Z };
        scene.camera = Some(Camera { view, ..Camera::default() });
        scene.render.integrator = integrator;
        scene.render.light_sampler = light_sampler;
        scene.render.samples = 1024;
        scene.render.depth = 3;
        Estimate::of(scene)
    };
    let expected = lit(LightSampler::Bvh, Integrator::Path);
    for (sampler, integrator) in [
        (LightSampler::Uniform, Integrator::Path),
        (LightSampler::Power, Integrator::Path),
        (LightSampler::Bvh, Integrator::SimplePath),
    ] {
        lit(sampler, integrator).assert_is(&expected, ROUNDING, &format!("{sampler:?} {integrator:?}"));
    }
}

/// A picture of the surroundings with one bright spot: found by asking it and by chance alike.
#[test]
fn a_picture_all_around_lights_as_it_is_seen() {
    let lit = |octahedral: bool, integrator| {
        // In front of the sphere either way.
        let bright = if octahedral { 133 } else { 141 };
        let texels = (0..256).map(|k| if k == bright { [50.0, 20.0, 10.0] } else { [0.2; 3] }).collect();
        let image = lookfrom_scene::image::Image::from_linear("", 16, 16, texels);
        let mut scene = furnace(MaterialKind::Diffuse { reflectance: Color::gray(0.7) });
        scene.lights.clear();
        scene.images.push(image);
        let (image, scale) = (lookfrom_scene::scene::ImageId(0), [1.0; 3]);
        let world_from_light = DMat4::from_rotation_x(0.7);
        let sky = match octahedral {
            true => Sky::Octahedral { image, scale, world_from_light },
            false => Sky::Image { image, scale, world_from_light, rows: MapRows::Bands },
        };
        scene.lights.push(light(LightKind::Environment { sky, portal: None, illuminates: true }));
        scene.render.integrator = integrator;
        scene.render.samples = if integrator == Integrator::Path { 256 } else { 16_384 };
        Estimate::of(scene)
    };
    for octahedral in [true, false] {
        let expected = lit(octahedral, Integrator::Path);
        let found = lit(octahedral, Integrator::RandomWalk);
        found.assert_is(&expected, ROUNDING, &format!("octahedral {octahedral}"));
    }
}
