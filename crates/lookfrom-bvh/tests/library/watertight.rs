//! Does any ray slip through a closed mesh?
//!
//! Rays go through corners and through points on edges of closed meshes near and far from the origin, from inside and from
//! outside. `LOOKFROM_RAYS=3400000 cargo test --release -p lookfrom-bvh watertight -- --nocapture` sends 10⁸ of them
//! in a few minutes, and prints counts.

use std::collections::HashMap;

use lookfrom_bvh::{Affine, Builder, Bvh, NONE, Ray, Triangles};
use std::sync::Arc;

use crate::testing::Random;

struct Mesh {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
    center: [f32; 3],
    radius: f32,
    /// Of a torus: how far its core is from the middle, and the radius around that. Of the others: 0, and a radius that is
    /// all inside.
    core: f32,
    thickness: f32,
}

impl Mesh {
    /// An icosahedron whose faces are divided into four, some times, moved onto a sphere.
    fn icosphere(levels: u32, center: [f32; 3], radius: f32) -> Self {
        let g = 1.618_034_f64;
        let mut points: Vec<[f64; 3]> = Vec::new();
        for [a, b] in [[-1.0, -g], [1.0, -g], [-1.0, g], [1.0, g]] {
            points.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
        }
        // Faces: all triples of corners that are 2 apart from each other.
        let near = |a: [f64; 3], b: [f64; 3]| {
            ((0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>() - 4.0).abs() < 0.1
        };
        let mut indices: Vec<[u32; 3]> = Vec::new();
        for i in 0..12 {
            for j in i + 1..12 {
                for k in j + 1..12 {
                    if near(points[i], points[j]) && near(points[j], points[k]) && near(points[k], points[i])
                    {
                        indices.push([i as u32, j as u32, k as u32]);
                    }
                }
            }
        }
        assert_eq!(indices.len(), 20);
        for _ in 0..levels {
            let mut middles = HashMap::new();
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let (p, q) = (points[a as usize], points[b as usize]);
                    points.push([0, 1, 2].map(|i| p[i] + q[i]));
                    points.len() as u32 - 1
                })
            };
            let mut finer = Vec::new();
            for [a, b, c] in indices {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            indices = finer;
            for p in &mut points {
                let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
                *p = p.map(|x| x / length);
            }
        }
        let place =
            |p: &[f64; 3]| [0, 1, 2].map(|i| (f64::from(center[i]) + f64::from(radius) * p[i]) as f32);
        let positions = points.iter().map(place).collect();
        Self { positions, indices, center, radius, core: 0.0, thickness: 0.75 * radius }
    }

    /// A cube whose sides are grids. Where center and radius are whole numbers, all its corners are.
    fn cube(cells: u32, center: [f32; 3], radius: f32) -> Self {
        let mut corners = HashMap::new();
        let mut mesh = Self::empty(center, radius, 0.0, radius);
        for axis in 0..3 {
            for side in [0, cells] {
                for cell in 0..cells * cells {
                    let (row, column) = (cell / cells, cell % cells);
                    let quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| {
                        let mut place = [0; 3];
                        (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) =
                            (side, row + i, column + j);
                        *corners.entry(place).or_insert_with(|| {
                            let at = |i: usize| 2.0 * place[i] as f32 / cells as f32 - 1.0;
                            mesh.positions.push([0, 1, 2].map(|i| center[i] + radius * at(i)));
                            mesh.positions.len() as u32 - 1
                        })
                    });
                    mesh.split(quad);
                }
            }
        }
        mesh
    }

    /// A ring around the z axis.
    fn torus(around: u32, across: u32, center: [f32; 3], radius: f32) -> Self {
        let mut mesh = Self::empty(center, radius, 0.7 * radius, 0.3 * radius);
        let turn = |part: u32, of: u32| (f64::from(part) / f64::from(of) * std::f64::consts::TAU).sin_cos();
        for i in 0..around {
            for j in 0..across {
                let ((sin, cos), (up, out)) = (turn(i, around), turn(j, across));
                let out = 0.7 + 0.3 * out;
                let p = [out * cos, out * sin, 0.3 * up];
                let place = |i: usize| (f64::from(center[i]) + f64::from(radius) * p[i]) as f32;
                mesh.positions.push([0, 1, 2].map(place));
                let number = |i: u32, j: u32| i % around * across + j % across;
                mesh.split([number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
            }
        }
        mesh
    }

    fn empty(center: [f32; 3], radius: f32, core: f32, thickness: f32) -> Self {
        Self { positions: Vec::new(), indices: Vec::new(), center, radius, core, thickness }
    }

    /// Adds a square of two triangles, split along the one diagonal or the other.
    fn split(&mut self, [a, b, c, d]: [u32; 4]) {
        match self.indices.len() % 4 {
            0 => self.indices.extend([[a, b, c], [a, c, d]]),
            _ => self.indices.extend([[a, b, d], [b, c, d]]),
        }
    }

    /// A point well inside, not far from another.
    fn inside(&self, random: &mut Random, near: [f32; 3]) -> [f32; 3] {
        let mut middle = self.center;
        if self.core > 0.0 {
            let out = [0, 1].map(|i| near[i] - self.center[i]);
            let length = (out[0] * out[0] + out[1] * out[1]).sqrt();
            (0..2).for_each(|i| middle[i] += self.core * out[i] / length);
        }
        match random.below(4) {
            0 => middle,
            // Often in one of a cube's planes.
            1 => middle.map(|x| x + self.thickness * (random.below(9) as f32 - 4.0) / 16.0),
            _ => random.near(middle, 0.3 * self.thickness),
        }
    }

    /// A ray that goes through a seam, and the t by which it has hit the mesh. None where rounding may have led it elsewhere.
    fn ray_through_a_seam(&self, random: &mut Random) -> Option<(Ray, f32)> {
        let seam = self.seam(random);
        let inside = self.inside(random, seam);
        let mut origin = inside;
        if random.below(2) == 0 {
            // From outside, and to the same point inside.
            let far = random.size(-1, 4);
            origin = [0, 1, 2].map(|i| seam[i] + far * (seam[i] - inside[i]));
        }
        let direction = [0, 1, 2].map(|i| seam[i] - origin[i]);
        let [o, d, q] = [origin, direction, inside].map(|x| x.map(f64::from));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let length = dot(d, d).sqrt();
        let to = [0, 1, 2].map(|i| q[i] - o[i]);
        let along = dot(to, d) / dot(d, d);
        let aside = [0, 1, 2].map(|i| to[i] - along * d[i]);
        let missed = dot(aside, aside).sqrt();
        // What rounding of the seam itself and of the direction amounts to, at the angles that there are.
        let largest = self.center.iter().fold(self.radius, |largest, x| largest.max(x.abs() + self.radius));
        let slack = f64::from(0.2 * self.thickness) + 16.0 * f64::from(largest * f32::EPSILON);
        let sure = length > 0.0 && missed < 0.2 * f64::from(self.thickness);
        sure.then_some((Ray::new(origin, direction), (1.0 + slack / length) as f32))
    }

    fn bvh(&self) -> Bvh {
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &self.positions, indices: &self.indices });
        let bvh = builder.build().unwrap();
        bvh.validate().unwrap();
        bvh
    }

    /// A corner, or a point on an edge.
    fn seam(&self, random: &mut Random) -> [f32; 3] {
        let triangle = self.indices[random.below(self.indices.len() as u32) as usize];
        let [a, b, _] = triangle.map(|index| self.positions[index as usize]);
        let s = match random.below(3) {
            0 => 0.0,
            1 => random.below(4) as f32 / 4.0,
            _ => random.unit(),
        };
        [0, 1, 2].map(|i| a[i] + s * (b[i] - a[i]))
    }
}

const PLACES: [([f32; 3], f32); 6] = [
    ([0.0, 0.0, 0.0], 1.0),
    ([148_376.0, 1234.0, -223_423.0], 1.0),
    ([148_376.0, 1234.0, -223_423.0], 100.0),
    ([1e-3, -1e8, 1e4], 1e4),
    ([3e-9, 1e-8, -2e-8], 1e-8),
    ([0.1, 0.2, 0.3], 1e8),
];

#[test]
fn no_ray_slips_through_a_seam() {
    let mut random = Random::new(11);
    let rays = std::env::var("LOOKFROM_RAYS").ok().and_then(|text| text.parse().ok()).unwrap_or(10_000);
    let (mut slipped, mut all, mut whole) = (0, 0_u64, 0_u64);
    for (center, radius) in PLACES {
        for mesh in [
            Mesh::icosphere(0, center, radius),
            Mesh::icosphere(2, center, radius),
            Mesh::icosphere(4, center, radius),
            Mesh::cube(16, center, radius),
            Mesh::torus(64, 24, center, radius),
        ] {
            let bvh = mesh.bvh();
            for _ in 0..rays {
                whole += 1;
                let Some((ray, hit_by)) = mesh.ray_through_a_seam(&mut random) else { continue };
                all += 1;
                let hit = bvh.closest_hit(&ray);
                if !(hit.t <= hit_by) || !bvh.occluded(&ray.with_t_max(hit_by.next_up())) {
                    slipped += 1;
                    println!("{ray:?} should hit by {hit_by}: {hit:?}");
                }
            }
        }
    }
    println!("{slipped} of {all} rays slipped");
    assert_eq!(slipped, 0);
    assert!(all > whole / 10 * 9, "{all} of {whole} rays were sure");
}

#[test]
fn rays_along_axes_do_not_leave_either() {
    // From the middle, and from straight below corners and edges.
    let mut slipped = 0;
    for (center, radius) in PLACES {
        let mesh = Mesh::icosphere(2, center, radius);
        let bvh = mesh.bvh();
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let mut direction = [0.0; 3];
                direction[axis] = sign;
                for position in &mesh.positions {
                    let mut inside = *position;
                    inside[axis] = center[axis];
                    let out = (0..3).map(|i| f64::from(inside[i] - center[i]).powi(2)).sum::<f64>().sqrt();
                    if out < 0.9 * f64::from(radius) {
                        slipped += usize::from(!bvh.closest_hit(&Ray::new(inside, direction)).is_hit());
                    }
                }
            }
        }
    }
    assert_eq!(slipped, 0);
}

#[test]
fn nor_a_mesh_in_an_instance() {
    let mut random = Random::new(12);
    let mesh = Mesh::icosphere(3, [5.0, -3.0, 2.0], 1.0);
    let ball = Arc::new(mesh.bvh());
    let map = Affine {
        matrix: [[-30.0, 4.0, 0.5], [0.0, 2.0, 0.1], [0.3, 0.0, 1e-3]],
        translation: [148_376.0, 1234.0, -223_423.0],
    };
    let mut builder = Builder::new();
    builder.instance(ball, map);
    let bvh = builder.build().unwrap();
    bvh.validate().unwrap();
    let to_world = |p: [f32; 3]| map.point(p.map(f64::from)).map(|x| x as f32);
    let mut slipped = 0;
    for _ in 0..100_000 {
        // The mesh is a hundredth of a unit thin at 2·10⁵, less than f32 can tell: only its long directions are sure.
        let origin = to_world([5.0, -3.0, 2.0]);
        let target = to_world(mesh.seam(&mut random));
        let direction = [0, 1, 2].map(|i| target[i] - origin[i]);
        let back = map.inverse().unwrap();
        let inside = back.point(origin.map(f64::from));
        let distance = (0..3).map(|i| (inside[i] - [5.0, -3.0, 2.0][i]).powi(2)).sum::<f64>().sqrt();
        if distance < 0.9 && direction.iter().any(|&x| x != 0.0) {
            let hit = bvh.closest_hit(&Ray::new(origin, direction));
            slipped += usize::from(hit.instance == NONE);
        }
    }
    assert_eq!(slipped, 0);
}
