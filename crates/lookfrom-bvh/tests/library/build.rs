//! Hostile, extreme and empty input; and one tree for any number of threads.

use std::sync::Arc;
use std::time::Instant;

use lookfrom_bvh::{Aabb, Affine, BuildError, Builder, Bvh, Hit, Observer, Quality, Ray, Sphere, Triangles};

use crate::testing::Random;

fn of_triangles(corners: &[[[f32; 3]; 3]]) -> Bvh {
    let positions: Vec<[f32; 3]> = corners.iter().flatten().copied().collect();
    let indices: Vec<[u32; 3]> = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut builder = Builder::new();
    builder.triangles(Triangles { positions: &positions, indices: &indices });
    let bvh = builder.build().unwrap();
    bvh.validate().unwrap();
    bvh
}

#[test]
fn nothing_and_one_triangle() {
    let empty = Builder::new().build().unwrap();
    empty.validate().unwrap();
    let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
    assert!(empty.bounds().is_empty());
    assert_eq!(empty.closest_hit(&ray), Hit::MISS);
    assert!(!empty.occluded(&ray));
    let mut scene = Builder::new();
    scene.instance(Arc::new(empty), Affine::IDENTITY);
    let scene = scene.build().unwrap();
    assert_eq!((scene.statistics().left_out, scene.closest_hit(&ray)), (1, Hit::MISS));

    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let one = of_triangles(&[corners]);
    let statistics = one.statistics();
    assert_eq!((statistics.triangles, statistics.nodes, statistics.leaves, statistics.depth), (1, 1, 1, 1));
    assert_eq!(one.bounds(), Aabb::around(&corners));
    let hit = one.closest_hit(&ray);
    assert_eq!((hit.t, hit.u, hit.v, hit.primitive), (1.0, 0.2, 0.2, 0));
    assert!(one.memory() > 256);
}

#[test]
fn what_no_ray_can_meet_is_left_out() {
    let good = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bad = |value: f32| [[0.0, value, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let line = [[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]];
    let point = [[1.0; 3]; 3];
    let bvh = of_triangles(&[bad(f32::NAN), good, bad(f32::INFINITY), bad(3e38), line, point]);
    assert_eq!((bvh.statistics().triangles, bvh.statistics().left_out), (1, 5));
    assert_eq!(bvh.closest_hit(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0])).primitive, 1);
}

#[test]
fn errors_say_what_and_where() {
    let mut builder = Builder::new();
    builder.spheres(&[]);
    builder.triangles(Triangles { positions: &[[0.0; 3]; 3], indices: &[[0, 1, 2], [0, 3, 1]] });
    let error = builder.build().unwrap_err();
    assert_eq!(error, BuildError::IndexOutOfRange { geometry: 1, triangle: 1, index: 3, positions: 3 });
    assert!(error.to_string().contains("triangle 1 of geometry 1 names position 3"), "{error}");

    let mut inner = Builder::new();
    inner.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    let inner = Arc::new(inner.build().unwrap());
    let mut middle = Builder::new();
    middle.instance(inner.clone(), Affine::IDENTITY);
    let mut outer = Builder::new();
    outer.instance(inner.clone(), Affine::IDENTITY);
    outer.instance(Arc::new(middle.build().unwrap()), Affine::IDENTITY);
    assert_eq!(outer.build().unwrap_err(), BuildError::NestedInstance { instance: 1 });

    for matrix in [[[0.0; 3]; 3], [[1e-80, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[f64::NAN; 3]; 3]] {
        let mut builder = Builder::new();
        builder.instance(inner.clone(), Affine { matrix, translation: [0.0; 3] });
        assert_eq!(builder.build().unwrap_err(), BuildError::SingularMatrix { instance: 0 });
    }
}

/// Builds, and fails where that takes more time than any build that is linear would.
fn built_soon(name: &str, corners: &[[[f32; 3]; 3]]) -> Bvh {
    let start = Instant::now();
    let bvh = of_triangles(corners);
    let seconds = start.elapsed().as_secs_f64();
    let statistics = bvh.statistics();
    println!("{name}: {seconds:.2} s, {statistics:?}");
    assert!(seconds < 30.0, "{name}: {seconds} s");
    assert!(statistics.depth < 110, "{name}: {statistics:?}");
    bvh
}

#[test]
fn a_million_triangles_in_one_place() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bvh = built_soon("one place", &vec![corners; 1_000_000]);
    let hit = bvh.closest_hit(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]));
    assert_eq!((hit.t, hit.primitive), (1.0, 0), "the first of them wins the tie");
    let mut hits = Vec::new();
    bvh.query().all_hits(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]), &mut hits);
    assert!(hits.len() == 1_000_000 && hits.iter().enumerate().all(|(i, hit)| hit.primitive == i as u32));
}

#[test]
fn a_million_triangles_around_one_center() {
    // Equal centroids, sizes that differ.
    let corners: Vec<_> = (0..1_000_000)
        .map(|i| {
            let r = 1.0 + i as f32;
            [[-r, -r, 0.0], [r, r, 0.0], [r, -r, 0.0]]
        })
        .collect();
    let bvh = built_soon("one center", &corners);
    assert_eq!(bvh.closest_hit(&Ray::new([0.5, -0.5, 1.0], [0.0, 0.0, -1.0])).primitive, 0);
}

#[test]
fn long_thin_triangles_and_sizes_that_double() {
    let mut random = Random::new(31);
    let needles: Vec<_> = (0..100_000)
        .map(|_| {
            let start = random.near([0.0; 3], 1.0);
            let end = random.near([0.0; 3], 1e6);
            [start, end, [start[0] + 1e-6, start[1], start[2]]]
        })
        .collect();
    built_soon("needles", &needles);

    // Each twice as far away as the one before, again and again: the heuristic peels off one at a time.
    let doubling: Vec<_> = (0..200_000)
        .map(|i| {
            let x = 2.0_f32.powi(i % 120 - 60) * (1.0 + (i / 120) as f32 * 1e-6);
            [[x, 0.0, 0.0], [x * 1.1, 0.0, 0.0], [x, x, 0.0]]
        })
        .collect();
    built_soon("doubling", &doubling);
}

/// `cargo test --release -p lookfrom-bvh ten_million -- --ignored --nocapture`: two gigabytes, and some seconds.
#[test]
#[ignore = "takes two gigabytes"]
fn ten_million_triangles() {
    let side = 2237;
    let height = |i: u32, j: u32| ((i * 7 + j * 13) % 11) as f32 * 0.1;
    let positions: Vec<[f32; 3]> =
        (0..=side).flat_map(|j| (0..=side).map(move |i| [i as f32, j as f32, height(i, j)])).collect();
    let mut indices = Vec::new();
    for corner in (0..side).flat_map(|j| (0..side).map(move |i| j * (side + 1) + i)) {
        indices.extend([
            [corner, corner + 1, corner + side + 2],
            [corner, corner + side + 2, corner + side + 1],
        ]);
    }
    for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
        let mut builder = Builder::new();
        builder.quality(quality).triangles(Triangles { positions: &positions, indices: &indices });
        let start = Instant::now();
        let bvh = builder.build().unwrap();
        let seconds = start.elapsed().as_secs_f64();
        println!("{quality:?}: {seconds:.1} s, {} bytes, {:?}", bvh.memory(), bvh.statistics());
        assert_eq!((bvh.statistics().triangles, bvh.statistics().left_out), (indices.len(), 0));
        assert!(seconds < 120.0 && bvh.statistics().depth < 30);
        bvh.validate().unwrap();
        // Straight down, everywhere.
        let mut random = Random::new(33);
        for _ in 0..100_000 {
            let [x, y] = [0; 2].map(|_| random.below(side) as f32 + 0.01 + 0.98 * random.unit());
            let hit = bvh.closest_hit(&Ray::new([x, y, 10.0], [0.0, 0.0, -1.0]));
            let quad = (y as u32 * side + x as u32) * 2;
            assert!((hit.primitive == quad || hit.primitive == quad + 1) && hit.t >= 9.0, "{x} {y}: {hit:?}");
        }
    }
}

#[test]
fn threads_and_batches_change_nothing() {
    let mut random = Random::new(32);
    let corners: Vec<_> = (0..30_000)
        .map(|_| {
            let center = random.near([0.0; 3], 10.0);
            [0; 3].map(|_| random.near(center, 0.3))
        })
        .collect();
    let positions: Vec<[f32; 3]> = corners.iter().flatten().copied().collect();
    let indices: Vec<[u32; 3]> = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let rays: Vec<Ray> =
        (0..10_000).map(|_| Ray::new(random.near([0.0; 3], 20.0), random.direction())).collect();
    let mut answers = Vec::new();
    for (threads, quality) in [(1, Quality::Best), (3, Quality::Best), (2, Quality::Fast)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (bvh, hits, occluded) = pool.install(|| {
            let mut builder = Builder::new();
            builder.quality(quality);
            builder.triangles(Triangles { positions: &positions, indices: &indices });
            let bvh = builder.build().unwrap();
            let mut hits = vec![Hit::MISS; rays.len()];
            let mut occluded = vec![false; rays.len()];
            bvh.closest_hits(&rays, &mut hits);
            bvh.occluded_many(&rays, &mut occluded);
            (bvh, hits, occluded)
        });
        let one_by_one: Vec<Hit> = rays.iter().map(|ray| bvh.closest_hit(ray)).collect();
        assert_eq!(hits, one_by_one);
        assert!(hits.iter().zip(&occluded).all(|(hit, occluded)| hit.is_hit() == *occluded));
        answers.push((hits, bvh.statistics()));
    }
    assert_eq!(answers[0], answers[1], "the same tree for any number of threads");
    assert_eq!(answers[0].0, answers[2].0, "the same hits for any quality");
    assert_ne!(answers[0].1, answers[2].1, "but not the same tree");
}

#[test]
fn the_best_trees_cost_no_more() {
    // Nothing can be gained where all boxes overlap, and much where long triangles cross a room.
    let mut random = Random::new(5);
    let everywhere = (0..4000).map(|_| [0; 3].map(|_| random.near([0.0; 3], 1.0))).collect();
    let mut beams = Vec::new();
    for _ in 0..2000 {
        let corner = random.near([0.0; 3], 10.0);
        let mut far = corner;
        far[random.below(3) as usize] += random.size(-1, 1);
        beams.push([corner, far, random.near(corner, 0.05)]);
    }
    for (name, corners, least_gain) in [("everywhere", everywhere, -0.01), ("beams", beams, 0.02)] {
        let corners: Vec<[[f32; 3]; 3]> = corners;
        let positions: Vec<[f32; 3]> = corners.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> =
            (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let [balanced, best] = [Quality::Balanced, Quality::Best].map(|quality| {
            let mut builder = Builder::new();
            builder.quality(quality);
            builder.triangles(Triangles { positions: &positions, indices: &indices });
            builder.build().unwrap().validate().unwrap().cost
        });
        assert!(best < (1.0 - least_gain) * balanced, "{name}: {best} after {balanced}");
    }
}

#[test]
fn observers_hear_of_every_visit() {
    #[derive(Default)]
    struct Count {
        nodes: Vec<(u32, u32)>,
        candidates: Vec<(u32, u32, u32)>,
    }
    impl Observer for Count {
        fn node(&mut self, instance: u32, node: u32) {
            self.nodes.push((instance, node));
        }
        fn candidate(&mut self, instance: u32, geometry: u32, primitive: u32) {
            self.candidates.push((instance, geometry, primitive));
        }
    }
    let mut ball = Builder::new();
    ball.triangles(Triangles { positions: &[], indices: &[] });
    ball.spheres(&[Sphere { center: [50.0; 3], radius: 1.0 }, Sphere { center: [0.0; 3], radius: 1.0 }]);
    let mut scene = Builder::new();
    scene.instance(Arc::new(ball.build().unwrap()), Affine::IDENTITY);
    let scene = scene.build().unwrap();
    let mut count = Count::default();
    let ray = Ray::new([0.0, 0.0, 9.0], [0.0, 0.0, -1.0]);
    let hit = scene.query().observer(&mut count).closest_hit(&ray);
    assert_eq!(hit, scene.closest_hit(&ray));
    assert_eq!(count.nodes, [(u32::MAX, 0), (0, 0)]);
    assert!(count.candidates.contains(&(0, 1, 1)), "{:?}", count.candidates);
}
