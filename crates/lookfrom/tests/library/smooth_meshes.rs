//! Coarse meshes with smooth normals: no dark rims at silhouettes, and no facets at the terminator.

use crate::support::{Compiled, scene};
use glam::{DMat4, DVec3, Vec3};
use lookfrom::integrator::Event;
use lookfrom::render::SampleId;
use lookfrom_scene::Location;
use lookfrom_scene::Scene;
use lookfrom_scene::scene::{MaterialId, MeshId, VertexNormals};
use lookfrom_scene::settings::Integrator;
use lookfrom_scene::shape::{Geometry, Mesh, Shape};

/// A unit sphere of `rings` × 2 `rings` quadrangles with the normals of the sphere.
fn sphere(rings: u32) -> Mesh {
    let turns = 2 * rings;
    let mut mesh = Mesh::default();
    for (i, j) in (0..=rings).flat_map(|i| (0..=turns).map(move |j| (i, j))) {
        let [theta, phi] = [f64::from(i) / f64::from(rings), f64::from(j) / f64::from(rings)]
            .map(|x| x * std::f64::consts::PI);
        let p = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()).as_vec3();
        mesh.positions.push(p);
        mesh.normals.push(p);
    }
    for (i, j) in (0..rings).flat_map(|i| (0..turns).map(move |j| (i, j))) {
        let [a, b] = [i * (turns + 1) + j, (i + 1) * (turns + 1) + j];
        if i > 0 {
            mesh.triangles.push([a, a + 1, b]);
        }
        if i + 1 < rings {
            mesh.triangles.push([a + 1, b + 1, b]);
        }
    }
    mesh
}

/// The mesh of a sphere, turned, of a material and in a light.
fn turned(mesh: Mesh, settings: &str) -> Scene {
    let mut scene = scene(&format!(
        r#"
        [camera]
        lookfrom = [0, 0, 8]
        lookat = [0, 0, 0]
        fov = 17
        [image]
        width = 100
        height = 100
        filter = "box"
        {settings}
        "#
    ));
    let turn = DMat4::from_rotation_x(0.4) * DMat4::from_rotation_z(0.3);
    scene.meshes.push(mesh);
    let mut shape = Shape::new(Location::default(), Geometry::Mesh(MeshId(0)), MaterialId(0));
    shape.world_from_object = turn;
    scene.shapes.push(shape);
    scene
}

#[test]
fn silhouettes_have_no_dark_rim() {
    for material in [
        "type = \"diffuse\"\nreflectance = 0.8",
        "type = \"conductor\"\nreflectance = 0.9\nroughness = 0.3",
        "type = \"coated_diffuse\"\nreflectance = 0.8\nroughness = 0.3",
        "type = \"principled\"\nbase_color = 0.8",
    ] {
        let settings = format!(
            "[render]\nintegrator = \"path\"\nsamples = 64\ndepth = 3\n[[light]]\ntype = \"environment\"\ncolor = 1\n[materials.m]\n{material}"
        );
        let scene = turned(sphere(6), &settings);
        let as_given = Scene { vertex_normals: VertexNormals::AsGiven, ..scene.clone() };
        // In even light no pixel is much darker than the material; the noise of coats is.
        let darkest = if material.contains("coated") { 0.3 } else { 0.5 };
        let dark = |scene| {
            let picture = Compiled::new(scene).film().picture();
            picture.pixels.iter().filter(|rgb| rgb[1] < darkest).count()
        };
        assert_eq!(dark(scene), 0, "{material}");
        if material.contains("\"diffuse\"") {
            assert!(dark(as_given) > 20, "pbrt's normals are as they were");
        }
    }
}

/// The brightness of a sphere in the light of a far lamp is N·L, and its mesh's is nearly so, however coarse it is: near
/// the terminator no facet is in the shadow of its neighbours.
#[test]
fn brightness_near_the_terminator_follows_the_sphere() {
    let to_light = DVec3::new(1.0, 0.4, 0.3).normalize();
    for integrator in [Integrator::Path, Integrator::Whitted] {
        for rings in [5, 8, 16] {
            let mut scene = turned(
                sphere(rings),
                "[render]\nsamples = 4\ndepth = 1\n[[light]]\ntype = \"distant\"\ndirection = [-1, -0.4, -0.3]\nintensity = 1\n[materials.m]\ntype = \"diffuse\"\nreflectance = 1",
            );
            scene.render.integrator = integrator;
            let compiled = Compiled::new(scene);
            let renderer = compiled.renderer();
            let picture = compiled.film().picture();
            let (mut sum, mut expected, mut black, mut count) = (0.0, 0.0, 0, 0);
            for (index, rgb) in picture.pixels.iter().enumerate() {
                let [x, y] = [index % 100, index / 100].map(|k| k as f64 + 0.5);
                let ray = renderer.view().camera().ray([x, 100.0 - y], [0.5; 2]);
                let ray = lookfrom_bvh::Ray::new([0.0; 3], ray.direction.as_vec3().to_array());
                let hit = compiled.world.bvh().closest_hit(&ray);
                if !hit.is_hit() {
                    continue;
                }
                let n: Vec3 = compiled.world.surface(&ray, &hit).ns;
                let cos = n.as_dvec3().dot(to_light);
                if (0.05..0.15).contains(&cos) {
                    (sum, expected) = (sum + f64::from(rgb[1]), expected + cos);
                    black += u32::from(rgb[1] < 0.01);
                    count += 1;
                }
            }
            assert!(count > 100, "{count}");
            let ratio = sum / expected;
            assert!((ratio - 1.0).abs() < 0.03, "{integrator:?}, {rings} rings: {ratio}");
            assert!(black * 100 < count, "{integrator:?}, {rings} rings: {black} of {count} are black");
        }
    }
}

/// A shadow ray is told with what blocks it, and with nothing where it passes: the triangle that it leaves, which it may graze,
/// does neither.
#[test]
fn shadow_rays_are_told_with_what_blocks_them() {
    let lights = (0..12).map(|k| {
        let (sin, cos) = (f64::from(k) * 0.53).sin_cos();
        format!("[[light]]\ntype = \"distant\"\ndirection = [{sin}, {cos}, {}]\nintensity = 1\n", 0.3 * sin)
    });
    let settings = "[render]\nsamples = 4\ndepth = 1\n[materials.m]\ntype = \"diffuse\"\n[[sphere]]\ncenter = [0.9, 0.9, 0.9]\nradius = 0.5\nmaterial = \"m\"\n".to_owned();
    let scene = turned(sphere(9), &lights.fold(settings, |all, light| all + &light));
    let compiled = Compiled::new(scene);
    let ids: Vec<_> = (0..100 * 100_u32)
        .map(|pixel| SampleId { pixel: [pixel % 100, pixel / 100], sample: pixel % 4 })
        .collect();
    let mut events = Vec::new();
    compiled.renderer().trace_events(&ids, &mut events);
    let (mut passed, mut blocked) = (0, 0);
    for event in &events {
        let Event::Shadow { shadow, hit, passed: light } = event else { continue };
        assert_eq!(hit.is_hit(), light.is_black(), "{:?} meets {hit:?}", shadow.ray);
        (passed, blocked) = (passed + u32::from(!hit.is_hit()), blocked + u32::from(hit.is_hit()));
    }
    assert!(passed > 1000 && blocked > 300, "{passed} pass, {blocked} are blocked");
}
