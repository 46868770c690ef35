//! Does any ray slip through a closed mesh?
//!
//! `LOOKFROM_RAYS=1000000 cargo test --release --test watertight -- --nocapture` tries more rays a mesh and prints counts.

use std::collections::HashMap;

use lookfrom_bvh::{Affine, Builder, Bvh, NONE, Ray, Triangles};
use std::sync::Arc;

#[path = "../src/testing.rs"]
mod testing;
use testing::Random;

struct Mesh {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
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
        Self { positions: points.iter().map(place).collect(), indices }
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
        let s = if random.below(3) == 0 { 0.0 } else { random.unit() };
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
fn no_ray_leaves_a_closed_mesh() {
    let mut random = Random::new(11);
    let rays = std::env::var("LOOKFROM_RAYS").ok().and_then(|text| text.parse().ok()).unwrap_or(20_000);
    let (mut slipped, mut all) = (0, 0);
    for (center, radius) in PLACES {
        for levels in [0, 2, 4] {
            let mesh = Mesh::icosphere(levels, center, radius);
            let bvh = mesh.bvh();
            for ray in 0..rays {
                let inside = if ray % 4 == 0 { center } else { random.near(center, 0.3 * radius) };
                let target = mesh.seam(&mut random);
                let ray = Ray::new(inside, [0, 1, 2].map(|i| target[i] - inside[i]));
                slipped += usize::from(!bvh.closest_hit(&ray).is_hit() || !bvh.occluded(&ray));
                all += 1;
            }
        }
    }
    println!("{slipped} of {all} rays slipped");
    assert_eq!(slipped, 0);
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
