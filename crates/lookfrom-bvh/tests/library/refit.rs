//! Does a tree that followed its geometry answer as one that was built for it?

use std::sync::Arc;

use lookfrom_bvh::{
    Aabb, Affine, Builder, Bvh, Hit, Moved, Procedural, ProceduralHit, Quality, Ray, RefitError, Sphere,
    Triangles,
};

use crate::testing::Random;

/// Two geometries of triangles around one of spheres, and a ball in an instance that stays.
#[derive(Clone)]
struct Scene {
    first: Vec<[f32; 3]>,
    spheres: Vec<Sphere>,
    second: Vec<[f32; 3]>,
}

fn indices(positions: &[[f32; 3]]) -> Vec<[u32; 3]> {
    (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()
}

impl Scene {
    fn random(random: &mut Random, count: u32) -> Self {
        let mut corners = |count: u32| -> Vec<[f32; 3]> {
            (0..count)
                .flat_map(|_| {
                    let center = random.point_with_exponents(-2, 2);
                    let size = random.size(-3, 2);
                    [0; 3].map(|_| random.near(center, size))
                })
                .collect()
        };
        let (first, second) = (corners(count), corners(count / 2));
        let spheres = (0..count / 3)
            .map(|_| Sphere { center: random.point_with_exponents(-2, 2), radius: random.size(-3, 1) })
            .collect();
        Self { first, spheres, second }
    }

    fn build(&self, quality: Quality) -> Bvh {
        let mut ball = Builder::new();
        ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
        let mut builder = Builder::new();
        builder.quality(quality);
        builder.triangles(Triangles { positions: &self.first, indices: &indices(&self.first) });
        builder.spheres(&self.spheres);
        builder.triangles(Triangles { positions: &self.second, indices: &indices(&self.second) });
        builder.instance(Arc::new(ball.build().unwrap()), Affine::IDENTITY);
        builder.build().unwrap()
    }
}

fn answers(bvh: &Bvh, rays: &[Ray]) -> (Vec<Hit>, Vec<bool>, Vec<Vec<Hit>>) {
    let all = |ray: &Ray| {
        let mut hits = Vec::new();
        bvh.query().all_hits(ray, &mut hits);
        hits
    };
    (
        rays.iter().map(|ray| bvh.closest_hit(ray)).collect(),
        rays.iter().map(|ray| bvh.occluded(ray)).collect(),
        rays.iter().map(all).collect(),
    )
}

#[test]
fn a_moved_tree_answers_as_a_new_one() {
    let mut random = Random::new(21);
    let mut hits = 0;
    for round in 0..24 {
        let quality = [Quality::Fast, Quality::Balanced, Quality::Best][round % 3];
        let before = Scene::random(&mut random, 90);
        let mut moved = before.build(quality);
        for step in 0..3 {
            // All of another scene's places, or those of one geometry: the farthest motion that there is.
            let mut after = Scene::random(&mut random, 90);
            let first = indices(&after.first);
            let second = indices(&after.second);
            let first = (0, Moved::Triangles(Triangles { positions: &after.first, indices: &first }));
            let spheres = (1, Moved::Spheres(&after.spheres));
            let second = (2, Moved::Triangles(Triangles { positions: &after.second, indices: &second }));
            moved.refit(&[first, spheres, second]).unwrap();
            moved.validate().unwrap();
            if step == 2 {
                after.spheres.iter_mut().for_each(|sphere| sphere.radius *= 3.0);
                moved.refit(&[(1, Moved::Spheres(&after.spheres))]).unwrap();
                moved.validate().unwrap();
            }
            let new = after.build(quality);
            assert_eq!(moved.bounds(), new.bounds());
            let rays: Vec<Ray> = (0..400)
                .map(|_| {
                    let origin = random.point_with_exponents(-2, 3);
                    let number = 3 * random.below(90) as usize;
                    let corners = [0, 1, 2].map(|i| after.first[number + i]);
                    let target = random.on_triangle(&corners);
                    Ray::new(origin, [0, 1, 2].map(|axis| target[axis] - origin[axis]))
                })
                .collect();
            let expected = answers(&new, &rays);
            hits += expected.0.iter().filter(|hit| hit.is_hit()).count();
            assert_eq!(answers(&moved, &rays), expected);
            for ray in &rays {
                let point = ray.origin;
                assert_eq!(
                    moved.closest_point(point, f32::INFINITY),
                    new.closest_point(point, f32::INFINITY)
                );
            }
        }
    }
    assert!(hits > 10_000, "{hits}");
}

#[test]
fn a_small_motion_keeps_a_good_tree() {
    let mut random = Random::new(22);
    let scene = Scene::random(&mut random, 600);
    let mut moved = scene.build(Quality::Balanced);
    let cost = moved.statistics().cost;
    let mirrored: Vec<[f32; 3]> = scene.first.iter().map(|p| [-p[0], p[1], p[2]]).collect();
    let order = indices(&mirrored);
    let there = (0, Moved::Triangles(Triangles { positions: &mirrored, indices: &order }));
    let back = (0, Moved::Triangles(Triangles { positions: &scene.first, indices: &order }));
    moved.refit(&[there]).unwrap();
    assert!(moved.statistics().cost > 1.01 * cost, "a mirror image tears the tree apart");
    moved.refit(&[back]).unwrap();
    assert_eq!(moved.statistics(), scene.build(Quality::Balanced).statistics(), "there and back");
}

/// One unit cube that no ray meets.
#[derive(Debug)]
struct Nothing;

impl Procedural for Nothing {
    fn count(&self) -> u32 {
        1
    }
    fn bounds(&self, _: u32) -> Aabb {
        Aabb { min: [0.0; 3], max: [1.0; 3] }
    }
    fn intersect(&self, _: u32, _: &Ray) -> Option<ProceduralHit> {
        None
    }
}

#[test]
fn what_cannot_be_followed_is_an_error_and_changes_nothing() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    // The third triangle has no area.
    let order = [[0, 1, 2], [1, 3, 2], [1, 1, 2]];
    let mut builder = Builder::new();
    builder.triangles(Triangles { positions: &positions, indices: &order });
    builder.spheres(&[Sphere { center: [0.0; 3], radius: 0.5 }]);
    builder.procedural(Arc::new(Nothing));
    let mut bvh = builder.build().unwrap();
    let statistics = bvh.statistics();
    let up = positions.map(|p| [p[0], p[1], p[2] + 1.0]);
    let moved = |indices| Moved::Triangles(Triangles { positions: &up, indices });
    let other = |geometry, primitive| Err(RefitError::OtherPrimitives { geometry, primitive });
    let ball = Sphere { center: [3.0; 3], radius: 1.0 };

    let cases: [(u32, Moved<'_>, Result<(), RefitError>); 9] = [
        (0, moved(&[[0, 1, 2], [1, 3, 2], [1, 3, 2]]), other(0, 2)),
        (0, moved(&[[0, 1, 2], [1, 3, 3], [1, 1, 2]]), other(0, 1)),
        (0, moved(&[[0, 1, 2]]), other(0, 1)),
        (
            0,
            moved(&[[0, 1, 2], [1, 3, 4], [1, 1, 2]]),
            Err(RefitError::IndexOutOfRange { geometry: 0, triangle: 1, positions: 4 }),
        ),
        (0, Moved::Spheres(&[ball, ball, ball]), other(0, 0)),
        (1, Moved::Spheres(&[Sphere { radius: f32::NAN, ..ball }]), other(1, 0)),
        (1, Moved::Spheres(&[ball, ball]), other(1, 1)),
        (2, Moved::Spheres(&[ball]), other(2, 0)),
        (3, Moved::Spheres(&[ball]), other(3, 0)),
    ];
    for (geometry, moved_to, expected) in cases {
        // Even where another motion is possible.
        let possible = (1, Moved::Spheres(&[ball]));
        assert_eq!(bvh.refit(&[possible, (geometry, moved_to)]), expected);
        assert_eq!((bvh.statistics(), bvh.validate()), (statistics, Ok(statistics)));
        assert_eq!(bvh.closest_hit(&Ray::new([0.0, 0.0, 4.0], [0.0, 0.0, -1.0])).t, 3.5, "the ball is there");
    }
    bvh.refit(&[(0, moved(&order))]).unwrap();
    bvh.validate().unwrap();
    assert_eq!(bvh.closest_hit(&Ray::new([0.2, 0.2, 4.0], [0.0, 0.0, -1.0])).t, 3.0);
    Bvh::default().refit(&[]).unwrap();
}
