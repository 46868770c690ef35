//! Is the point of a hit on the surface that the ray meets, with the normal that it has there?

use std::sync::Arc;

use lookfrom_bvh::{Affine, Builder, Hit, NONE, Ray, Sphere, Triangles};

use crate::testing::Random;
use crate::vector::{cross, dot, minus};

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// A shear and scale of moderate size, in half of the cases with a reflection.
fn random_map(random: &mut Random) -> Affine {
    loop {
        let matrix = [0; 3].map(|_| [0; 3].map(|_| f64::from(2.0 * random.unit() - 1.0)));
        let map = Affine { matrix, translation: [0; 3].map(|_| f64::from(8.0 * random.unit() - 4.0)) };
        if map.inverse().is_some_and(|back| back.matrix.iter().flatten().all(|x| x.abs() < 10.0)) {
            return map;
        }
    }
}

#[test]
fn points_and_normals_are_those_of_the_primitives_computed_directly() {
    let mut random = Random::new(77);
    let (mut triangles, mut spheres) = (0, 0);
    for _ in 0..200 {
        let corners: Vec<[[f32; 3]; 3]> =
            (0..40).map(|_| [0; 3].map(|_| random.near([0.0; 3], 2.0))).collect();
        let positions: Vec<[f32; 3]> = corners.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> = (0..40).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let balls: Vec<Sphere> = (0..10)
            .map(|_| Sphere { center: random.near([0.0; 3], 2.0), radius: 0.1 + 0.5 * random.unit() })
            .collect();
        let fill = |builder: &mut Builder| {
            builder.triangles(Triangles { positions: &positions, indices: &indices });
            builder.spheres(&balls);
        };
        let mut object = Builder::new();
        fill(&mut object);
        let object = Arc::new(object.build().unwrap());
        let maps: Vec<Affine> = (0..4).map(|_| random_map(&mut random)).collect();
        let mut builder = Builder::new();
        fill(&mut builder);
        for map in &maps {
            builder.instance(object.clone(), *map);
        }
        let bvh = builder.build().unwrap();

        for _ in 0..300 {
            let ray = Ray::new(random.near([0.0; 3], 10.0), random.direction());
            let hit = bvh.closest_hit(&ray);
            if !hit.is_hit() {
                assert_eq!(bvh.hit_point(&ray, &hit), None);
                continue;
            }
            let at = bvh.hit_point(&ray, &hit).unwrap();
            let map = if hit.instance == NONE { Affine::IDENTITY } else { maps[hit.instance as usize] };
            let back = map.inverse().unwrap();
            let mirrored = dot(map.matrix[0], cross(map.matrix[1], map.matrix[2])) < 0.0;

            // It is where the ray is at t.
            let [o, d] = [ray.origin, ray.direction].map(|v| v.map(f64::from));
            let along = [0, 1, 2].map(|i| o[i] + f64::from(hit.t) * d[i]);
            let off = minus(at.point.position, along);
            assert!(dot(off, off).sqrt() < 1e-4, "{off:?}");

            let n = if hit.geometry == 0 {
                triangles += 1;
                let [p0, p1, p2] =
                    corners[hit.primitive as usize].map(|corner| map.point(corner.map(f64::from)));
                let n = unit(cross(minus(p1, p0), minus(p2, p0)));
                // On the plane, up to the bound of the error.
                let height = dot(n, minus(at.point.position, p0)).abs();
                assert!(height <= dot(n.map(f64::abs), at.point.error), "{height}");
                if mirrored { n.map(|x| -x) } else { n }
            } else {
                spheres += 1;
                let Sphere { center, radius } = balls[hit.primitive as usize];
                let offset = minus(back.point(at.point.position), center.map(f64::from));
                assert!((dot(offset, offset).sqrt() - f64::from(radius)).abs() < 1e-13);
                unit(back.normal_back(offset))
            };
            let turn = minus(n, at.normal);
            assert!(dot(turn, turn).sqrt() < 1e-9, "{n:?} {:?}", at.normal);
            // A ray that leaves it does not meet the surface again.
            let facing = if dot(n, d) > 0.0 { n.map(|x| -x) } else { n };
            let leaving = facing.map(|x| x as f32);
            let again = bvh.closest_hit(&Ray::new(at.origin(leaving), leaving));
            let same = |hit: &Hit| (hit.instance, hit.geometry, hit.primitive);
            assert!(hit.geometry == 1 || same(&again) != same(&hit));
        }
    }
    assert!(triangles > 1000 && spheres > 300, "{triangles} {spheres}");
}

/// Triangles, spheres and instances at random times, against the tree of that moment, in which all stands still.
#[test]
fn points_of_what_moves_are_where_it_is_at_the_time() {
    let mut random = Random::new(78);
    let mut counts = [0; 3];
    for _ in 0..60 {
        let indices: Vec<[u32; 3]> = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let ends: Vec<Vec<[f32; 3]>> =
            (0..2).map(|_| (0..60).map(|_| random.near([0.0; 3], 3.0)).collect()).collect();
        let balls: Vec<Sphere> = (0..5)
            .map(|_| Sphere { center: random.near([0.0; 3], 2.0), radius: 0.1 + 0.5 * random.unit() })
            .collect();
        let maps: Vec<[Affine; 2]> = (0..3).map(|_| [0; 2].map(|_| random_map(&mut random))).collect();
        let mut object = Builder::new();
        object.triangles(Triangles { positions: &ends[0], indices: &indices });
        object.spheres(&balls);
        let object = Arc::new(object.build().unwrap());
        let mut builder = Builder::new();
        builder.moving_triangles(&[&ends[0], &ends[1]], &indices);
        builder.spheres(&balls);
        maps.iter().for_each(|maps| _ = builder.moving_instance(object.clone(), maps));
        let moving = builder.build().unwrap();

        let time = random.unit();
        let between = |a: f32, b: f32| a + time * (b - a);
        let positions: Vec<[f32; 3]> = ends[0]
            .iter()
            .zip(&ends[1])
            .map(|(a, b)| [0, 1, 2].map(|axis| between(a[axis], b[axis])))
            .collect();
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        builder.spheres(&balls);
        maps.iter().for_each(|maps| _ = builder.instance(object.clone(), Affine::at_time(maps, time)));
        let still = builder.build().unwrap();

        let query = moving.query().time(time);
        for _ in 0..200 {
            let ray = Ray::new(random.near([0.0; 3], 10.0), random.direction());
            let hit = query.closest_hit(&ray);
            let (found, expected) =
                (query.hit_point(&ray, &hit), still.hit_point(&ray, &still.closest_hit(&ray)));
            assert_eq!(found.is_some(), hit.is_hit());
            let (Some(found), Some(expected)) = (found, expected) else { continue };
            counts[usize::from(hit.instance != NONE) + usize::from(hit.geometry == 1)] += 1;
            let [off, turn] =
                [minus(found.point.position, expected.point.position), minus(found.normal, expected.normal)];
            assert!(dot(off, off).sqrt() < 1e-4 && dot(turn, turn).sqrt() < 1e-4, "{found:?} {expected:?}");
        }
    }
    assert!(counts.iter().all(|&count| count > 10), "{counts:?}");
}
