//! Does a ray cross a closed mesh as often as it should, even through edges and corners, and along them?

use std::sync::Arc;

use lookfrom_bvh::{Affine, Builder, Bvh, Hit, HitF64, Ray, RayF64, Sphere, Triangles};

use crate::testing::Random;

/// A grid of cubes, all but some of them solid: a closed mesh with edges of four triangles, where two solid cubes touch.
fn blocks(random: &mut Random) -> (Vec<[f32; 3]>, Vec<[u32; 3]>, Vec<bool>) {
    const N: i32 = 4;
    let solid: Vec<bool> = (0..N * N * N).map(|_| random.unit() < 0.5).collect();
    let is_solid = |p: [i32; 3]| {
        p.iter().all(|&x| (0..N).contains(&x)) && solid[((p[2] * N + p[1]) * N + p[0]) as usize]
    };
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for cell in 0..N * N * N {
        let p = [cell % N, cell / N % N, cell / (N * N)];
        for axis in 0..3 {
            for side in [0, 1] {
                let mut neighbour = p;
                neighbour[axis] += 2 * side - 1;
                if !is_solid(p) || is_solid(neighbour) {
                    continue;
                }
                let first = positions.len() as u32;
                for [s, t] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                    let mut q = p;
                    q[axis] += side;
                    q[(axis + 1) % 3] += s;
                    q[(axis + 2) % 3] += t;
                    positions.push(q.map(|x| x as f32));
                }
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| first + i);
                indices.extend(if side == 1 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
    }
    (positions, indices, solid)
}

fn crossings(bvh: &Bvh, ray: &Ray) -> (Vec<Hit>, Vec<HitF64>) {
    let (mut hits, mut fine) = (Vec::new(), Vec::new());
    bvh.query().crossings(ray, &mut hits);
    bvh.query().crossings(&RayF64::from(*ray), &mut fine);
    (hits, fine)
}

#[test]
fn an_odd_number_inside_and_an_even_one_outside() {
    let mut random = Random::new(31);
    let (mut inside, mut outside, mut doubled) = (0, 0, 0);
    for _ in 0..40 {
        let (positions, indices, solid) = blocks(&mut random);
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        let bvh = Arc::new(builder.build().unwrap());
        let mut placed = Builder::new();
        placed.instance(bvh.clone(), Affine { translation: [8.0, 0.0, 0.0], ..Affine::IDENTITY });
        let placed = placed.build().unwrap();
        for _ in 0..2000 {
            // From the middle of a cube, to points of the grid and halfway between them: through edges and corners.
            let cell = [0; 3].map(|_| random.below(4));
            let from = cell.map(|x| x as f32 + 0.5);
            let direction = [0; 3].map(|_| random.below(9) as f32 - 4.0);
            if direction == [0.0; 3] {
                continue;
            }
            let is_inside = solid[((cell[2] * 4 + cell[1]) * 4 + cell[0]) as usize];
            let ray = Ray::new(from, direction);
            let (hits, fine) = crossings(&bvh, &ray);
            assert_eq!(hits.len() % 2 == 1, is_inside, "{ray:?}");
            let ids = |geometry, primitive| (geometry, primitive);
            let (mut coarse, mut exact): (Vec<_>, Vec<_>) = (
                hits.iter().map(|hit| ids(hit.geometry, hit.primitive)).collect(),
                fine.iter().map(|hit| ids(hit.geometry, hit.primitive)).collect(),
            );
            coarse.sort_unstable();
            exact.sort_unstable();
            assert_eq!(coarse, exact, "{ray:?}");
            let moved = Ray::new([from[0] + 8.0, from[1], from[2]], direction);
            assert_eq!(crossings(&placed, &moved).0.len(), hits.len(), "{ray:?} in an instance");
            let mut all = Vec::new();
            bvh.query().all_hits(&ray, &mut all);
            doubled += usize::from(all.len() != hits.len());
            inside += usize::from(is_inside);
            outside += usize::from(!is_inside);
        }
    }
    assert!(inside > 10_000 && outside > 10_000 && doubled > 10_000, "{inside}, {outside}, {doubled}");
}

#[test]
fn a_tangent_touches_a_sphere() {
    let mut builder = Builder::new();
    builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    let bvh = builder.build().unwrap();
    for (x, times) in [(0.0, 2), (0.5, 2), (1.0, 0), (1.5, 0)] {
        let (hits, fine) = crossings(&bvh, &Ray::new([x, 0.0, 3.0], [0.0, 0.0, -1.0]));
        assert_eq!(hits.len(), times, "at {x}");
        // In f64 the roots may differ by their rounding: a tangent crosses twice, or not at all.
        assert!(fine.len() == times || x == 1.0 && fine.len() == 2, "at {x}");
    }
}
