//! Measured irradiance: of every kind of shape, against its integral by another way, and under light that is known.

use std::f64::consts::PI;

use glam::{DMat4, DVec3, Vec3};
use lookfrom::render::Renderer;
use lookfrom_bvh::Ray;
use lookfrom_scene::camera::{Camera, Projection};
use lookfrom_scene::light::{Falloff, Light, LightKind, Power, Sky};
use lookfrom_scene::material::{Color, Material, MaterialKind};
use lookfrom_scene::scene::{MaterialId, MeshId, Scene};
use lookfrom_scene::settings::{FilterShape, Integrator, Sampler};
use lookfrom_scene::shape::{Emission, Geometry, Mesh, Shape, Sphere};
use lookfrom_scene::{Error, Location};

use crate::support::forms::{Random, forms, shape, world};
use crate::support::{Compiled, scene};

/// The radiance of the lamp, beside that of the sky, 1.
const LAMP: f32 = 30.0;

/// A black shape that is measured, under a white sky.
fn measured(geometry: Geometry, map: DMat4, meshes: Vec<Mesh>) -> Scene {
    let kind = MaterialKind::Diffuse { reflectance: Color::BLACK };
    let sky =
        LightKind::Environment { sky: Sky::Constant(Color::gray(1.0)), portal: None, illuminates: true };
    let mut scene = Scene {
        camera: Some(Camera {
            projection: Projection::Irradiance { surface: "measured".to_owned() },
            ..Camera::default()
        }),
        materials: vec![Material::new("black", Location::default(), kind)],
        meshes,
        shapes: vec![Shape { name: Some("measured".to_owned()), ..shape(geometry, map) }],
        lights: vec![Light { name: None, at: Location::default(), power: Power::AS_WRITTEN, kind: sky }],
        ..Scene::default()
    };
    (scene.image.width, scene.image.height) = (8, 8);
    scene.image.filter = FilterShape::Box.of_radius(0.5);
    (scene.render.integrator, scene.render.samples) = (Integrator::Path, 256);
    scene
}

/// The mean of a picture's red.
fn mean(scene: Scene) -> f64 {
    let film = Compiled::new(scene).film();
    let [width, height] = [film.width(), film.height()];
    let sum: f64 = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| f64::from(film.mean(x, y)[0]))
        .sum();
    sum / f64::from(width * height)
}

/// A lamp beside a form.
fn lamp(map: &DMat4) -> Shape {
    let sphere = Sphere { center: DVec3::new(0.6, 0.8, 1.6), radius: 0.5 };
    let emission = Some(Emission::new(Color::gray(LAMP), false));
    Shape { emission, ..shape(Geometry::Sphere(sphere), *map) }
}

/// The irradiance of triangles by uniform points and uniform directions on the side of their normals.
fn by_triangles(mesh: &Mesh, map: DMat4, is_reversed: bool) -> f64 {
    const COUNT: usize = 200_000;
    let reversed = Shape { reverse_orientation: is_reversed, ..shape(Geometry::Mesh(MeshId(0)), map) };
    let own = world(reversed, vec![mesh.clone()]);
    let lamp = world(lamp(&map), vec![]);
    let corners: Vec<[DVec3; 3]> = mesh
        .triangles
        .iter()
        .map(|t| t.map(|vertex| map.transform_point3(mesh.positions[vertex as usize].as_dvec3())))
        .collect();
    let side = if is_reversed == (map.determinant() < 0.0) { 1.0 } else { -1.0 };
    let normal = |[a, b, c]: [DVec3; 3]| side * (b - a).cross(c - a);
    let mut ends: Vec<f64> = Vec::new();
    for triangle in &corners {
        ends.push(ends.last().unwrap_or(&0.0) + normal(*triangle).length());
    }
    let (mut random, mut sum) = (Random(7), 0.0);
    for _ in 0..COUNT {
        let place = random.unit() * ends[ends.len() - 1];
        let triangle @ [a, b, c] = corners[ends.partition_point(|end| *end <= place)];
        let (s, t) = (random.unit().sqrt(), random.unit());
        let n = normal(triangle).normalize();
        let point = a + s * (1.0 - t) * (b - a) + s * t * (c - a);
        let direction = random.direction();
        let direction = if direction.dot(n) < 0.0 { -direction } else { direction };
        let size = (b - a).length();
        let ray = Ray::new((point + 1e-3 * size * n).as_vec3().to_array(), direction.as_vec3().to_array());
        let radiance = match (own.bvh().closest_hit(&ray).t, lamp.bvh().closest_hit(&ray)) {
            (t, hit) if hit.is_hit() && hit.t < t => f64::from(LAMP),
            (t, _) if t.is_finite() => 0.0,
            _ => 1.0,
        };
        // Uniform over a hemisphere.
        sum += radiance * direction.dot(n) * 2.0 * PI;
    }
    sum / COUNT as f64
}

#[test]
fn every_kind_of_shape_is_measured_evenly_on_its_outside() {
    let mut random = Random(11);
    for form in forms() {
        for is_reversed in [false, true] {
            // Not at all of even scale; as large as the world's origin is far.
            let map = DMat4::from_translation(0.5 * random.direction())
                * DMat4::from_rotation_y(random.between(0.0, 6.0))
                * DMat4::from_scale(DVec3::new(0.4, 1.1, 1.7));
            let mut scene = measured(form.geometry.clone(), map, vec![]);
            scene.shapes[0].reverse_orientation = is_reversed;
            scene.shapes.push(lamp(&map));
            let (found, expected) = (mean(scene), by_triangles(&form.triangles(40), map, is_reversed));
            let name = form.name;
            assert!(
                (found - expected).abs() <= 0.02 * expected,
                "{name}, reversed: {is_reversed}: {found} instead of {expected}"
            );
        }
    }
}

/// Convex shapes do not see themselves: whatever their scale and place, each sample is π, but for how often its place is sampled.
#[test]
fn under_a_constant_sky_the_irradiance_is_pi() {
    let mut random = Random(5);
    let sphere = Geometry::Sphere(Sphere { center: DVec3::X * 0.25, radius: 0.75 });
    let disk = Geometry::Disk { center: DVec3::ZERO, normal: DVec3::new(0.3, 1.0, 0.2), radius: 1.0 };
    let quad = Geometry::Quad { corner: DVec3::ZERO, edge_u: DVec3::X, edge_v: DVec3::Y + DVec3::Z };
    let ball = forms().swap_remove(0).triangles(30);
    for geometry in [sphere, disk, quad, Geometry::Mesh(MeshId(0)), forms().swap_remove(0).geometry] {
        for _ in 0..4 {
            let map = random.map(100.0);
            let found = mean(measured(geometry.clone(), map, vec![ball.clone()]));
            assert!((found / PI - 1.0).abs() < 2e-3, "{geometry:?} {map}: {found}");
        }
    }
}

/// Integrators find the light of further rays, and each pixel has the same mean.
#[test]
fn integrators_samplers_and_sizes_agree() {
    let text = |integrator: &str, size: u32| {
        format!(
            "[camera]\nprojection = \"irradiance\"\nsurface = \"floor\"\n\
             [image]\nwidth = {size}\nheight = {size}\n[render]\nintegrator = \"{integrator}\"\nsamples = {}\n\
             [materials.white]\nreflectance = 0.8\ntype = \"diffuse\"\n\
             [[quad]]\nname = \"floor\"\ncorner = [-1, 0, 1]\nedge_u = [2, 0, 0]\nedge_v = [0, 0, -2]\nmaterial = \"white\"\n\
             [[quad]]\ncorner = [-1, 0, -1]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]\nmaterial = \"white\"\n\
             [[light]]\ntype = \"rectangle\"\ncorner = [-0.5, 2, -0.5]\nedge_u = [1, 0, 0]\nedge_v = [0, 0, 1]\nradiance = 5\n",
            65_536 / (size * size)
        )
    };
    let of = |integrator: &str, size: u32| mean(scene(&text(integrator, size)));
    let expected = of("path", 16);
    for (integrator, size) in [("path", 1), ("simple_path", 1), ("random_walk", 4)] {
        let found = of(integrator, size);
        assert!((found / expected - 1.0).abs() < 0.02, "{integrator} {size}: {found} instead of {expected}");
    }
    let mut independent = scene(&text("path", 2));
    independent.render.sampler = Sampler::Independent;
    let found = mean(independent);
    assert!((found / expected - 1.0).abs() < 0.06, "{found} instead of {expected}");
    // Whitted's trees and rays alone find the lamp, at least.
    for integrator in ["whitted", "raycast"] {
        let found = of(integrator, 4);
        assert!(found.is_finite() && found > 0.5 * expected, "{integrator}: {found} of {expected}");
    }
}

#[test]
fn measurements_have_the_same_bits_on_any_number_of_threads() {
    let mut scene = measured(forms().swap_remove(1).geometry, DMat4::IDENTITY, vec![]);
    (scene.image.width, scene.image.height) = (40, 40);
    scene.render.samples = 4;
    scene.shapes.push(lamp(&DMat4::IDENTITY));
    let compiled = Compiled::new(scene);
    let [one, many] = [1, 3].map(|threads| compiled.render(threads).film);
    for (x, y) in (0..40).flat_map(|y| (0..40).map(move |x| (x, y))) {
        assert_eq!(one.mean(x, y), many.mean(x, y));
    }
}

#[test]
fn what_cannot_be_measured_is_an_error_and_light_that_no_ray_meets_a_warning() {
    let of = |scene: Scene| -> Result<Vec<String>, Error> {
        let mut warnings = Vec::new();
        Renderer::of_scene(scene, &mut warnings)?;
        Ok(warnings.into_iter().map(|warning| warning.message).collect())
    };
    let sphere = || Geometry::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });
    let mut unknown = measured(sphere(), DMat4::IDENTITY, vec![]);
    unknown.shapes[0].name = Some("mesured".to_owned());
    let error = of(unknown).expect_err("no such shape");
    assert!(error.to_string().contains("there is no shape \"measured\""), "{error}");
    let flat = Mesh { positions: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let error = of(measured(Geometry::Mesh(MeshId(0)), DMat4::IDENTITY, vec![flat])).expect_err("no area");
    assert!(error.to_string().contains("with an area"), "{error}");
    let error = of(measured(Geometry::Curves([].into()), DMat4::IDENTITY, vec![])).expect_err("curves");
    assert!(error.to_string().contains("has curves"), "{error}");

    let mut lit = measured(sphere(), DMat4::IDENTITY, vec![]);
    assert_eq!(of(lit.clone()).expect("a sphere"), Vec::<String>::new());
    let kind = LightKind::Point {
        position: DVec3::Y * 3.0,
        intensity: Color::gray(1.0),
        falloff: Falloff::Quadratic,
    };
    lit.lights.push(Light { name: None, at: Location::default(), power: Power::AS_WRITTEN, kind });
    lit.shapes.push(shape(sphere(), DMat4::from_translation(DVec3::X * 4.0)));
    lit.shapes[1].material = MaterialId(0);
    let warnings = of(lit).expect("a sphere");
    assert!(warnings.len() == 1 && warnings[0].contains("without a size"), "{warnings:?}");
}
