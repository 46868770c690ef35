//! Do two levels answer as one level with everything in its place?

use std::sync::Arc;

use lookfrom_bvh::{Affine, Builder, Hit, NONE, Ray, Sphere, Triangles, reference};

use crate::testing::Random;

fn random_map(random: &mut Random) -> Affine {
    loop {
        let scale = random.size(-1, 1);
        let matrix = [0; 3].map(|_| [0; 3].map(|_| f64::from(scale * (2.0 * random.unit() - 1.0))));
        let translation = [0; 3].map(|_| f64::from(20.0 * random.unit() - 10.0));
        let map = Affine { matrix, translation };
        if map.inverse().is_some_and(|back| back.matrix.iter().flatten().all(|x| x.abs() < 100.0)) {
            return map;
        }
    }
}

#[test]
fn instances_answer_as_the_flattened_scene() {
    let mut random = Random::new(41);
    let (mut hits, mut misses, mut doubtful) = (0, 0, 0);
    for _ in 0..60 {
        let corners: Vec<[[f32; 3]; 3]> =
            (0..30).map(|_| [0; 3].map(|_| random.near([0.0; 3], 2.0))).collect();
        let positions: Vec<[f32; 3]> = corners.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut object = Builder::new();
        object.spheres(&[]);
        object.triangles(Triangles { positions: &positions, indices: &indices });
        let object = Arc::new(object.build().unwrap());

        let maps: Vec<Affine> = (0..10).map(|_| random_map(&mut random)).collect();
        let mut scene = Builder::new();
        scene.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
        for map in &maps {
            scene.instance(object.clone(), *map);
        }
        let scene = scene.build().unwrap();
        scene.validate().unwrap();

        // Everything in its place, in f64: the sphere, then the triangles of each instance.
        let mut flat = vec![reference::Shape::Sphere([0.0; 3], 1.0)];
        for map in &maps {
            flat.extend(
                corners.iter().map(|c| reference::Shape::Triangle(c.map(|p| map.point(p.map(f64::from))))),
            );
        }
        for _ in 0..300 {
            let ray = Ray::new(random.near([0.0; 3], 15.0), random.direction());
            let [a, d] = [ray.origin, ray.direction].map(|v| v.map(f64::from));
            let hit = scene.closest_hit(&ray);
            assert_eq!(scene.occluded(&ray), hit.is_hit());
            let expected = reference::closest(&flat, a, d, 0.0, f64::INFINITY);
            match expected {
                None if !hit.is_hit() => misses += 1,
                Some((index, t)) if hit.is_hit() => {
                    assert!((f64::from(hit.t) / t - 1.0).abs() < 1e-6, "{hit:?} {expected:?}");
                    let found = match hit.instance {
                        NONE => 0,
                        instance => 1 + 30 * instance as usize + hit.primitive as usize,
                    };
                    assert_eq!(found, index);
                    assert_eq!(hit.geometry, u32::from(hit.instance != NONE));
                    hits += 1;
                }
                _ => doubtful += 1,
            }
        }
    }
    assert!(hits > 3000 && misses > 1000 && doubtful == 0, "{hits} {misses} {doubtful}");
}

#[test]
fn ties_go_to_the_lowest_ids_with_instances_last() {
    let mut object = Builder::new();
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let indices = [[0, 1, 2], [0, 2, 3]];
    object.triangles(Triangles { positions: &square, indices: &indices });
    object.triangles(Triangles { positions: &square, indices: &indices });
    let object = Arc::new(object.build().unwrap());
    // On the diagonal all triangles are hit at the same t.
    let ray = Ray::new([0.5, 0.5, 2.0], [0.0, 0.0, -1.0]);

    let mut twice = Builder::new();
    twice.instance(object.clone(), Affine::IDENTITY);
    twice.instance(object.clone(), Affine::IDENTITY);
    let ids = |hit: &Hit| (hit.instance, hit.geometry, hit.primitive);
    let mut hits = Vec::new();
    let scene = twice.build().unwrap();
    assert_eq!(ids(&scene.closest_hit(&ray)), (0, 0, 0));
    scene.query().all_hits(&ray, &mut hits);
    let expected: Vec<_> = (0..8).map(|i| (i / 4, i / 2 % 2, i % 2)).collect();
    assert_eq!(hits.iter().map(ids).collect::<Vec<_>>(), expected);

    twice.spheres(&[]);
    twice.triangles(Triangles { positions: &square, indices: &indices });
    assert_eq!(
        ids(&twice.build().unwrap().closest_hit(&ray)),
        (NONE, 1, 0),
        "geometry of its own comes first"
    );
}

#[test]
fn t_and_scale_are_kept() {
    // Directions are not normalised on the way, whatever the scale.
    let mut ball = Builder::new();
    ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    let ball = Arc::new(ball.build().unwrap());
    for exponent in -8..=8 {
        let s = 10.0_f64.powi(exponent);
        let mut scene = Builder::new();
        let matrix = [[-s, 0.0, 0.0], [0.0, s, 0.0], [0.0, 0.0, s]];
        scene.instance(ball.clone(), Affine { matrix, translation: [0.0, 0.0, 5.0 * s] });
        let scene = scene.build().unwrap();
        for length in [1e-8, 1.0, 1e8] {
            let hit = scene.closest_hit(&Ray::new([0.0; 3], [0.0, 0.0, (s * length) as f32]));
            assert!((f64::from(hit.t) * length / 4.0 - 1.0).abs() < 1e-6, "{s} {length}: {hit:?}");
        }
    }
}
