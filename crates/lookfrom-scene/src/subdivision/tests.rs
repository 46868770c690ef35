use glam::{Vec2, Vec3};

use super::*;
use crate::shape::Mesh;

fn cage(positions: &[[f64; 3]], faces: &[&[u32]]) -> Cage {
    let mut cage = Cage { positions: positions.iter().map(|&p| p.into()).collect(), ..Cage::default() };
    for face in faces {
        cage.corners.extend(*face);
        cage.end_face(0);
    }
    cage
}

/// The cube from −1 to 1.
fn cube() -> Cage {
    let positions: Vec<[f64; 3]> =
        (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|bit| 2.0 * f64::from(bit) - 1.0)).collect();
    cage(
        &positions,
        &[&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]],
    )
}

#[test]
fn a_cube_becomes_its_known_limit() {
    for levels in 1..5 {
        let refined = cube().subdivided(levels);
        assert_eq!(refined.corners.len(), 4 * 6 * 4_usize.pow(levels));
        // A corner of valence 3: (9 P + 4 ΣE + ΣC) / 24, with three edges' ends and three faces' far corners. After one level
        // the limit is the same.
        let corner = refined.positions[7];
        let expected = (9.0 * Vec3::ONE + 4.0 * Vec3::ONE - Vec3::ONE) / 24.0;
        assert!((corner - expected).length() < 1e-6, "{corner}, {expected}");
        assert!((refined.normals[7] - Vec3::ONE.normalize()).length() < 1e-6);
        // The middle of a face is on its axis, and the surface has the symmetry of the cube.
        let most = refined.positions.iter().fold(Vec3::ZERO, |most, p| most.max(*p));
        assert!((most.x - most.y).abs() < 1e-6 && most.x > 0.6 && most.x < 0.9, "{most}");
        for (position, normal) in refined.positions.iter().zip(&refined.normals) {
            assert!((normal.length() - 1.0).abs() < 1e-5 && normal.dot(*position) > 0.0);
        }
    }
}

#[test]
fn levels_agree_on_the_limit() {
    // The vertices of a level are among those of the next: the limit of a vertex does not depend on the level.
    let (coarse, fine) = (cube().subdivided(2), cube().subdivided(4));
    for (k, position) in coarse.positions.iter().enumerate() {
        assert!((*position - fine.positions[k]).length() < 1e-6);
        assert!((coarse.normals[k] - fine.normals[k]).length() < 1e-5, "{k}");
    }
}

#[test]
fn normals_are_those_of_the_surface() {
    let refined = cube().subdivided(6);
    let mut means = vec![Vec3::ZERO; refined.positions.len()];
    for quad in refined.corners.chunks_exact(4) {
        let [a, b, c, d] = [quad[0], quad[1], quad[2], quad[3]].map(|v| refined.positions[v as usize]);
        let normal = (c - a).cross(d - b);
        quad.iter().for_each(|&v| means[v as usize] += normal);
    }
    for (mean, normal) in means.iter().zip(&refined.normals) {
        assert!(mean.normalize().dot(*normal) > 0.9999, "{mean} {normal}");
    }
}

/// The textbook's step on a map of edges, without creases.
fn slow_step(positions: &[DVec3], faces: &[Vec<u32>]) -> (Vec<DVec3>, Vec<Vec<u32>>) {
    use std::collections::BTreeMap;
    let at = |v: u32| positions[v as usize];
    let centers: Vec<DVec3> =
        faces.iter().map(|f| f.iter().map(|&v| at(v)).sum::<DVec3>() / f.len() as f64).collect();
    let mut edges: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (index, face) in faces.iter().enumerate() {
        for k in 0..face.len() {
            let (a, b) = (face[k], face[(k + 1) % face.len()]);
            edges.entry([a.min(b), a.max(b)]).or_default().push(index);
        }
    }
    let mut new: Vec<DVec3> = (0..positions.len() as u32)
        .map(|v| {
            let own: Vec<usize> = (0..faces.len()).filter(|&f| faces[f].contains(&v)).collect();
            let n = own.len() as f64;
            let q = own.iter().map(|&f| centers[f]).sum::<DVec3>() / n;
            let middles: Vec<DVec3> =
                edges.keys().filter(|e| e.contains(&v)).map(|e| (at(e[0]) + at(e[1])) / 2.0).collect();
            let r = middles.iter().sum::<DVec3>() / middles.len() as f64;
            q / n + r * (2.0 / n) + at(v) * ((n - 3.0) / n)
        })
        .collect();
    let mut number = BTreeMap::new();
    for (edge, owners) in &edges {
        number.insert(*edge, new.len() as u32);
        new.push((at(edge[0]) + at(edge[1]) + centers[owners[0]] + centers[owners[1]]) / 4.0);
    }
    let mut quads = Vec::new();
    for (index, face) in faces.iter().enumerate() {
        let center = new.len() as u32;
        new.push(centers[index]);
        let edge = |a: u32, b: u32| number[&[a.min(b), a.max(b)]];
        for k in 0..face.len() {
            let (before, here, next) =
                (face[(k + face.len() - 1) % face.len()], face[k], face[(k + 1) % face.len()]);
            quads.push(vec![here, edge(here, next), center, edge(before, here)]);
        }
    }
    (new, quads)
}

#[test]
fn a_step_is_that_of_the_textbook() {
    // A prism of five sides, bent, with two pentagons.
    let ring = |z: f64, r: f64| {
        (0..5).map(move |i| {
            let (s, c) = (f64::from(i) * 1.2566).sin_cos();
            [r * c, r * s, z + 0.3 * c * s]
        })
    };
    let positions: Vec<[f64; 3]> = ring(0.0, 1.0).chain(ring(1.5, 0.6)).collect();
    let mut faces: Vec<Vec<u32>> = (0..5).map(|i| vec![i, (i + 1) % 5, 5 + (i + 1) % 5, 5 + i]).collect();
    faces.push((0..5).rev().collect());
    faces.push((5..10).collect());
    let slices: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    let cage = cage(&positions, &slices).refined_once();
    let points: Vec<DVec3> = positions.iter().map(|&p| p.into()).collect();
    let (expected, quads) = slow_step(&points, &faces);
    assert_eq!(cage.corners, quads.concat());
    for (found, expected) in cage.positions.iter().zip(&expected) {
        assert!((*found - *expected).length() < 1e-12);
    }
}

#[test]
fn borders_are_splines_and_corners_stay() {
    // A flat grid of 3 × 3 squares stays flat, and in its border.
    let positions: Vec<[f64; 3]> = (0..16).map(|i| [f64::from(i % 4), f64::from(i / 4), 0.0]).collect();
    let faces: Vec<[u32; 4]> =
        (0..9).map(|i| i % 3 + 4 * (i / 3)).map(|v| [v, v + 1, v + 5, v + 4]).collect();
    let slices: Vec<&[u32]> = faces.iter().map(|face| &face[..]).collect();
    let refined = cage(&positions, &slices).subdivided(3);
    for (position, normal) in refined.positions.iter().zip(&refined.normals) {
        assert!(position.min_element() >= 0.0 && position.max_element() <= 3.0 && position.z == 0.0);
        assert!((*normal - Vec3::Z).length() < 1e-6);
    }
    assert_eq!(refined.positions[0], Vec3::ZERO);
    // The second vertex of the border: (P₀ + 4 P₁ + P₂) / 6 of a uniform line is P₁.
    assert!((refined.positions[1] - Vec3::X).length() < 1e-6);
}

#[test]
fn odd_cages_give_finite_surfaces() {
    let point = |x: f64, y: f64, z: f64| [x, y, z];
    let positions = [
        point(0.0, 0.0, 0.0),
        point(1.0, 0.0, 0.0),
        point(0.0, 1.0, 0.0),
        point(0.0, 0.0, 1.0),
        point(0.0, -1.0, 0.5),
        point(5.0, 5.0, 5.0),
    ];
    // Three faces at an edge, a face of the wrong orientation, a vertex without faces.
    let cage = cage(&positions, &[&[0, 1, 2], &[0, 1, 3], &[1, 0, 4], &[2, 1, 3]]);
    assert_eq!(cage.branching_edges(), 1);
    let refined = cage.subdivided(3);
    assert!(refined.positions.iter().chain(&refined.normals).all(|p| p.is_finite()));
    assert_eq!(refined.positions[5], Vec3::splat(5.0));
}

#[test]
fn pairs_of_triangles_are_quadrilaterals_again() {
    // A cube of twelve triangles with vertices of its own for each face, and texture coordinates.
    let solid = cube();
    let mut mesh = Mesh::default();
    for quad in solid.corners.chunks_exact(4) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(quad.iter().map(|&v| solid.positions[v as usize].as_vec3()));
        mesh.uvs.extend([Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]);
        mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k: u32| first + k)));
    }
    let quads = mesh::cage(&mesh);
    assert_eq!((quads.corners.len(), quads.positions.len(), quads.count_after(3)), (24, 8, 384));
    mesh::replace(&mut mesh, &quads, 2);
    let expected = solid.subdivided(2);
    assert_eq!(mesh.triangles.len(), 2 * expected.corners.len() / 4);
    // The seams of texture coordinates do not open the surface.
    let place = |p: &Vec3| p.to_array().map(f32::to_bits);
    let (found, known): (std::collections::BTreeSet<_>, std::collections::BTreeSet<_>) =
        (mesh.positions.iter().map(place).collect(), expected.positions.iter().map(place).collect());
    assert_eq!(found, known);
    assert!(mesh.uvs.iter().all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0));
    // Each face is a grid of 25 vertices; a few of neighbouring faces have the same texture coordinates.
    assert!((98..=150).contains(&mesh.positions.len()), "{}", mesh.positions.len());
}
