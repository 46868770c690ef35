//! Shapes composed of others: planes, boxes and the sphereflake.

use glam::{DVec3, Vec2, Vec3};

use crate::shape::{Mesh, Sphere};

/// Two unit vectors `u`, `v` with `u × v = n`, for a unit normal; `u` is horizontal if possible.
pub(crate) fn tangents(n: DVec3) -> (DVec3, DVec3) {
    let level = DVec3::Y.cross(n);
    let u = if level.length_squared() < 1e-12 { DVec3::X } else { level.normalize() };
    let v = n.cross(u);
    (u, v)
}

/// A square part of a plane around a point; uv are distances from the point.
pub(crate) fn plane(point: DVec3, normal: DVec3, size: f64) -> Mesh {
    let (u, v) = tangents(normal.normalize());
    let half = 0.5 * size;
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    Mesh {
        name: "plane".to_owned(),
        positions: corners.iter().map(|&(s, t)| (point + s * u + t * v).as_vec3()).collect(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: corners.iter().map(|&(s, t)| Vec2::new(s as f32, t as f32)).collect(),
        ..Mesh::default()
    }
}

/// The box between two corners, with its faces oriented outwards; uv runs from 0 to 1 over each face.
pub(crate) fn cuboid(min: DVec3, max: DVec3) -> Mesh {
    let mut mesh = Mesh { name: "box".to_owned(), ..Mesh::default() };
    for axis in 0..3 {
        for side in [min, max] {
            // u × v points along the axis; on the lower side they are swapped.
            let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
            if side == min {
                (u, v) = (v, u);
            }
            let first = mesh.positions.len() as u32;
            for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                let mut corner = min;
                corner[axis] = side[axis];
                corner[u] = if s == 0.0 { min[u] } else { max[u] };
                corner[v] = if t == 0.0 { min[v] } else { max[v] };
                mesh.positions.push(corner.as_vec3());
                mesh.uvs.push(Vec2::new(s, t));
            }
            mesh.triangles.push([first, first + 1, first + 2]);
            mesh.triangles.push([first, first + 2, first + 3]);
        }
    }
    mesh
}

/// The number of spheres of a sphereflake: `(9^(depth + 1) − 1) / 8`.
pub(crate) fn sphereflake_count(depth: u32) -> u64 {
    9_u64.checked_pow(depth + 1).map_or(u64::MAX, |power| (power - 1) / 8)
}

/// The sphereflake (the "balls" of Haines' standard procedural databases, 1987): on each sphere are nine of a third of its
/// radius, six around the equator and three above, each with its pole pointing away from its parent.
pub(crate) fn sphereflake(center: DVec3, radius: f64, depth: u32) -> Vec<Sphere> {
    let mut spheres = vec![Sphere { center, radius }];
    let mut poles = vec![(DVec3::Y, DVec3::X)];
    let mut generation = 0..1;
    for _ in 0..depth {
        for parent in generation.clone() {
            let Sphere { center, radius } = spheres[parent];
            let (n, u) = poles[parent];
            for direction in children(n, u) {
                spheres
                    .push(Sphere { center: center + direction * (4.0 / 3.0 * radius), radius: radius / 3.0 });
                poles.push((direction, (n - n.dot(direction) * direction).normalize()));
            }
        }
        generation = generation.end..spheres.len();
    }
    spheres
}

/// The directions of the nine children, around the pole `n`; `u` is a unit vector perpendicular to it.
fn children(n: DVec3, u: DVec3) -> [DVec3; 9] {
    let v = n.cross(u);
    let (half, root) = (0.5, 0.75_f64.sqrt());
    // The sines and cosines of 30° and 60°; the three above are 30° from the pole.
    let above = |across: DVec3| root * n + half * across;
    [
        u,
        half * u + root * v,
        -half * u + root * v,
        -u,
        -half * u - root * v,
        half * u - root * v,
        above(root * u + half * v),
        above(-root * u + half * v),
        above(-v),
    ]
}

/// A mesh of one triangle.
pub(crate) fn triangle(positions: [Vec3; 3]) -> Mesh {
    Mesh {
        name: "triangle".to_owned(),
        positions: positions.to_vec(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_faces_outwards() {
        let mesh = cuboid(DVec3::new(-1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 7.0));
        let middle = Vec3::new(1.5, 3.5, 5.0);
        assert_eq!(mesh.triangles.len(), 12);
        let mut volume = 0.0;
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize] - middle);
            let six_volumes = a.dot(b.cross(c));
            assert!(six_volumes > 0.0);
            volume += six_volumes / 6.0;
        }
        assert!((volume - 5.0 * 3.0 * 4.0).abs() < 1e-3);
    }

    #[test]
    fn a_sphereflake_touches_and_never_overlaps() {
        let spheres = sphereflake(DVec3::new(1.0, 2.0, 3.0), 2.0, 3);
        assert_eq!(spheres.len() as u64, sphereflake_count(3));
        assert_eq!(sphereflake_count(0), 1);
        assert_eq!(sphereflake_count(6), 597_871);
        for (i, a) in spheres.iter().enumerate() {
            for b in &spheres[i + 1..] {
                let gap = a.center.distance(b.center) - a.radius - b.radius;
                assert!(gap > -1e-9, "{a:?} and {b:?} overlap by {}", -gap);
            }
        }
    }

    #[test]
    fn tangents_are_a_right_handed_frame() {
        for n in [DVec3::Y, -DVec3::Y, DVec3::X, DVec3::Z, DVec3::new(1.0, 2.0, -3.0).normalize()] {
            let (u, v) = tangents(n);
            assert!((u.cross(v) - n).length() < 1e-12);
        }
    }
}
