//! Benchmark of the kernel with small scenes: a box of 36 triangles with two blocks in it, and three spheres, or 54 in a grid,
//! on a plane of two triangles. Prints million rays per second, one by one and in batches: `small_bench [TURNS [WORD]]`; with a word
//! only those that contain it.

use std::time::Instant;

use lookfrom_bvh::{Builder, Bvh, Hit, OriginPrimitive, Ray, Sphere, Triangles};

/// Width and height of the picture whose camera rays are traced.
const SIDE: usize = 512;

/// Number of rays in a batch, that of a tile of 32 × 32 pixels.
const BATCH: usize = 1024;

type Point = [f32; 3];

fn along(ray: &Ray, t: f32) -> Point {
    [0, 1, 2].map(|axis| ray.origin[axis] + t * ray.direction[axis])
}

/// The twelve triangles of a box, less those of the side towards the camera where it is open.
fn block(min: Point, max: Point, is_open: bool, positions: &mut Vec<Point>, indices: &mut Vec<[u32; 3]>) {
    let first = positions.len() as u32;
    positions
        .extend((0..8).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { min[axis] } else { max[axis] })));
    let sides = [[4, 5, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2]];
    for [a, b, c, d] in &sides[usize::from(is_open)..] {
        indices.extend([[a, b, c], [a, c, d]].map(|corners| corners.map(|corner| first + corner)));
    }
}

fn cornell_box() -> Bvh {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    block([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], true, &mut positions, &mut indices);
    block([-0.6, -1.0, -0.5], [-0.1, 0.2, 0.1], false, &mut positions, &mut indices);
    block([0.2, -1.0, 0.0], [0.7, -0.4, 0.5], false, &mut positions, &mut indices);
    block([-0.2, 0.98, -0.2], [0.2, 0.99, 0.2], true, &mut positions, &mut indices);
    indices.truncate(36);
    let mut builder = Builder::new();
    builder.triangles(Triangles { positions: &positions, indices: &indices });
    builder.build().expect("a box")
}

fn on_a_plane(spheres: &[Sphere]) -> Bvh {
    let mut builder = Builder::new();
    builder.triangles(Triangles {
        positions: &[[-9.0, -1.0, -9.0], [9.0, -1.0, -9.0], [9.0, -1.0, 9.0], [-9.0, -1.0, 9.0]],
        indices: &[[0, 1, 2], [0, 2, 3]],
    });
    builder.spheres(spheres);
    builder.build().expect("spheres")
}

fn three_spheres() -> Bvh {
    on_a_plane(&[
        Sphere { center: [-1.1, 0.0, 0.0], radius: 1.0 },
        Sphere { center: [1.1, 0.0, 0.3], radius: 1.0 },
        Sphere { center: [0.0, -0.6, 1.5], radius: 0.4 },
    ])
}

fn grid() -> Bvh {
    let at = |i: usize| [(i % 6) as f32, (i / 6 % 3) as f32, (i / 18) as f32];
    let ball = |[x, y, z]: Point| Sphere { center: [0.4 * x - 1.0, 0.4 * y - 0.8, 0.4 * z], radius: 0.17 };
    on_a_plane(&(0..54).map(|i| ball(at(i))).collect::<Vec<_>>())
}

/// Camera rays of a picture, tile by tile.
fn camera() -> Vec<Ray> {
    let pixel = |i: usize| {
        let (tile, place) = (i / BATCH, i % BATCH);
        let x = 32 * (tile % (SIDE / 32)) + place % 32;
        let y = 32 * (tile / (SIDE / 32)) + place / 32;
        let at = |x: usize| (x as f32 + 0.5) / SIDE as f32 - 0.5;
        Ray::new([0.0, 0.1, 3.4], [0.8 * at(x), -0.8 * at(y), -1.0])
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

/// From the hits of rays in random directions, and towards a light.
fn further(rays: &[Ray], hits: &[Hit]) -> (Vec<Ray>, Vec<Ray>, Vec<OriginPrimitive>) {
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f32 / 8_388_608.0 - 1.0
    };
    let (mut bounces, mut shadows, mut origins) = (Vec::new(), Vec::new(), Vec::new());
    for (ray, hit) in rays.iter().zip(hits).filter(|(_, hit)| hit.is_hit()) {
        let point = along(ray, 0.9999 * hit.t);
        bounces.push(Ray::new(point, [0; 3].map(|_| random())));
        let light = [0.1 * random(), 0.9, 0.1 * random()];
        let to_light = [0, 1, 2].map(|axis| light[axis] - point[axis]);
        shadows.push(Ray::new(point, to_light).with_t_max(0.999));
        origins.push(OriginPrimitive::of(hit));
    }
    (bounces, shadows, origins)
}

fn main() {
    let turns = std::env::args().nth(1).and_then(|turns| turns.parse().ok()).unwrap_or(5);
    let word = std::env::args().nth(2).unwrap_or_default();
    for (name, bvh) in [("box", cornell_box()), ("spheres", three_spheres()), ("grid", grid())] {
        let rays = camera();
        let mut hits = vec![Hit::MISS; rays.len()];
        bvh.closest_hits(&rays, &mut hits);
        let (bounces, shadows, origins) = further(&rays, &hits);
        let mut occluded = vec![false; shadows.len()];
        let measure = |what: &str, count: usize, work: &mut dyn FnMut()| {
            let what = format!("{name} {what}");
            if !what.contains(&word) {
                return;
            }
            let mut best = f64::INFINITY;
            for _ in 0..turns {
                let start = Instant::now();
                work();
                best = best.min(start.elapsed().as_secs_f64());
            }
            println!("{what:24} {:6.2}", count as f64 * 1e-6 / best);
        };
        for (what, rays) in [("camera", &rays), ("bounce", &bounces)] {
            measure(what, rays.len(), &mut || {
                for (ray, hit) in rays.iter().zip(&mut hits) {
                    *hit = bvh.closest_hit(ray);
                }
            });
            measure(&format!("{what} batch"), rays.len(), &mut || {
                for (rays, hits) in rays.chunks(BATCH).zip(hits.chunks_mut(BATCH)) {
                    bvh.closest_hits(rays, hits);
                }
            });
        }
        measure("shadow", shadows.len(), &mut || {
            for (ray, occluded) in shadows.iter().zip(&mut occluded) {
                *occluded = bvh.occluded(ray);
            }
        });
        measure("shadow batch", shadows.len(), &mut || {
            for (number, (rays, occluded)) in
                shadows.chunks(BATCH).zip(occluded.chunks_mut(BATCH)).enumerate()
            {
                bvh.query().origins(&origins[number * BATCH..]).occluded_many(rays, occluded);
            }
        });
    }
}
