//! Bump maps: slopes are taken over half a pixel's footprint, however the surface is parameterised.

use crate::support::{Compiled, scene};
use glam::{DMat4, Vec2, Vec3};
use lookfrom_scene::Location;
use lookfrom_scene::scene::{MaterialId, MeshId};
use lookfrom_scene::shape::{Geometry, Mesh, Shape};

/// The picture of a wall of 2 × 2 with bumps of noise, whose u and v go to `span`, seen from a distance.
fn wall(span: Vec2, distance: f64, fov: f64) -> Vec<[f32; 3]> {
    let mut scene = scene(&format!(
        r#"
        [camera]
        lookfrom = [0, 0, {distance}]
        lookat = [0, 0, 0]
        fov = {fov}
        [image]
        width = 40
        height = 40
        filter = "box"
        [render]
        integrator = "path"
        samples = 16
        depth = 1
        [[light]]
        type = "distant"
        direction = [-1, -0.5, -1]
        intensity = 1
        [materials.m]
        type = "diffuse"
        reflectance = 1
        bump = {{ type = "fbm", size = 0.3, octaves = 2 }}
        "#
    ));
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vec2::from);
    scene.meshes.push(Mesh {
        positions: corners.map(|p| p.extend(0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        uvs: corners.map(|p| span * (0.5 * p + 0.5)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    let mut shape = Shape::new(Location::default(), Geometry::Mesh(MeshId(0)), MaterialId(0));
    shape.world_from_object = DMat4::IDENTITY;
    scene.shapes.push(shape);
    Compiled::new(scene).film().picture().pixels
}

fn difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a[1] - b[1]).abs()).sum::<f32>() / a.len() as f32
}

#[test]
fn slopes_do_not_depend_on_the_scale_of_u_and_v() {
    let plain = wall(Vec2::ONE, 5.0, 20.0);
    let mean = plain.iter().map(|rgb| rgb[1]).sum::<f32>() / plain.len() as f32;
    let relief = plain.iter().map(|rgb| (rgb[1] - mean).abs()).sum::<f32>() / plain.len() as f32;
    assert!(relief > 0.1 * mean, "it has bumps: {relief} of {mean}");
    let equal = [1e-3, 30.0, 1e4].map(Vec2::splat);
    let unequal = [Vec2::new(1.0, 30.0), Vec2::new(4.0, 1e-3)];
    for span in equal.into_iter().chain(unequal) {
        let difference = difference(&plain, &wall(span, 5.0, 20.0));
        assert!(difference < 0.01 * relief, "u and v to {span}: {difference}, relief {relief}");
    }
}
