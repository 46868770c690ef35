//! Is the nearest point found that all primitives, one by one, would name? And is it the nearest?

use std::sync::Arc;

use lookfrom_bvh::{Affine, Builder, Bvh, ClosestPoint, NONE, Quality, Sphere, Triangles, Unrounded};

use crate::testing::Random;

type Corners = [[f32; 3]; 3];

fn triangles(builder: &mut Builder, corners: &[Corners]) {
    let positions: Vec<[f32; 3]> = corners.iter().flatten().copied().collect();
    let indices: Vec<[u32; 3]> = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    builder.triangles(Triangles { positions: &positions, indices: &indices });
}

fn tree(corners: &[Corners], spheres: &[Sphere], quality: Quality) -> Bvh {
    let mut builder = Builder::new();
    builder.quality(quality);
    triangles(&mut builder, corners);
    builder.spheres(spheres);
    builder.build().unwrap()
}

fn placed(bvh: Bvh, map: Affine) -> Bvh {
    let mut builder = Builder::new();
    builder.instance(Arc::new(bvh), map);
    builder.build().unwrap()
}

/// The nearest of trees that hold one primitive each, named as in the tree of all.
fn one_by_one(trees: &[(u32, u32, Bvh)], point: [f32; 3], max_distance: f32) -> Option<ClosestPoint> {
    let mut best: Option<ClosestPoint> = None;
    for (geometry, primitive, bvh) in trees {
        if let Some(found) = bvh.closest_point(point, max_distance) {
            // Trees come in the order of ids.
            if best.is_none_or(|best| found.distance < best.distance) {
                best = Some(ClosestPoint { geometry: *geometry, primitive: *primitive, ..found });
            }
        }
    }
    best
}

/// Points with exponents of their own, thin and equal triangles, whole numbers that make ties.
fn soup(random: &mut Random, whole: bool) -> (Vec<Corners>, Vec<Sphere>) {
    let point = |random: &mut Random| match whole {
        true => [0; 3].map(|_| random.below(7) as f32 - 3.0),
        false => random.point_with_exponents(-4, 4),
    };
    let mut corners: Vec<Corners> = Vec::new();
    for i in 0..60 {
        let mut next = [0; 3].map(|_| point(random));
        if !whole && random.unit() < 0.5 {
            let size = random.size(-4, 2);
            next = [next[0], random.near(next[0], size), random.near(next[0], size)];
        }
        if random.unit() < 0.1 && i > 0 {
            next = corners[i - 1];
        }
        corners.push(next);
    }
    let radius = |random: &mut Random| if whole { 1.0 } else { random.size(-4, 2) };
    let spheres = (0..20).map(|_| Sphere { center: point(random), radius: radius(random) }).collect();
    (corners, spheres)
}

fn random_map(random: &mut Random) -> Affine {
    loop {
        let matrix = [[0; 3]; 3].map(|row| row.map(|_| f64::from(random.unit() - 0.5)));
        let stretch = [0; 3].map(|_| f64::from(random.size(-2, 2)));
        let matrix = matrix.map(|row| [0, 1, 2].map(|i| row[i] * stretch[i]));
        let map = Affine { matrix, translation: random.point_with_exponents(-3, 3).map(f64::from) };
        if map.inverse().is_some() {
            return map;
        }
    }
}

#[test]
fn trees_answer_as_their_primitives_do() {
    let mut random = Random::new(11);
    let mut found = 0;
    for round in 0..60 {
        let whole = round % 2 == 0;
        let (corners, spheres) = soup(&mut random, whole);
        let map = (round % 3 == 0).then(|| random_map(&mut random));
        let place = |bvh: Bvh| match map {
            Some(map) => placed(bvh, map),
            None => bvh,
        };
        let trees: Vec<Bvh> = [Quality::Fast, Quality::Balanced, Quality::Best]
            .map(|quality| place(tree(&corners, &spheres, quality)))
            .into();
        let mut single: Vec<(u32, u32, Bvh)> = Vec::new();
        for (i, corners) in corners.iter().enumerate() {
            single.push((0, i as u32, place(tree(&[*corners], &[], Quality::Fast))));
        }
        for (i, sphere) in spheres.iter().enumerate() {
            single.push((1, i as u32, place(tree(&[], &[*sphere], Quality::Fast))));
        }
        for _ in 0..300 {
            let point = match (random.below(3), whole) {
                (0, true) => [0; 3].map(|_| random.below(11) as f32 - 5.0),
                (1, _) => {
                    let number = random.below(60) as usize;
                    random.on_triangle(&corners[number])
                }
                _ => random.point_with_exponents(-5, 5),
            };
            let max = if random.unit() < 0.3 { random.size(-4, 4) } else { f32::INFINITY };
            let expected = one_by_one(&single, point, max);
            found += usize::from(expected.is_some());
            for bvh in &trees {
                assert_eq!(bvh.closest_point(point, max), expected, "{point:?} within {max}");
            }
        }
    }
    assert!(found > 10_000, "{found}");
}

#[test]
fn batches_answer_as_points_one_by_one() {
    let mut random = Random::new(13);
    let (corners, spheres) = soup(&mut random, false);
    let bvh = tree(&corners, &spheres, Quality::Balanced);
    let points: Vec<[f32; 3]> = (0..10_000).map(|_| random.point_with_exponents(-4, 4)).collect();
    for max in [0.01, 3.0, f32::INFINITY, f32::NAN] {
        let expected: Vec<Option<ClosestPoint>> = points.iter().map(|&p| bvh.closest_point(p, max)).collect();
        let mut nearest = vec![None; points.len()];
        bvh.closest_points(&points, max, &mut nearest);
        assert_eq!(nearest, expected);
        let mut near = vec![false; points.len()];
        bvh.are_near(&points, max, &mut near);
        assert!(near.iter().zip(&expected).all(|(near, expected)| *near == expected.is_some()));
        let count = near.iter().filter(|&&near| near).count();
        assert_eq!(count == points.len(), max == f32::INFINITY);
        assert_eq!(count == 0, max.is_nan());
    }
    let mut rest = [None; 2];
    bvh.closest_points(&points[..1], f32::INFINITY, &mut rest);
    assert!(rest[0].is_some() && rest[1].is_none(), "what is left over is left alone");
}

#[test]
fn no_point_of_a_triangle_is_nearer() {
    let mut random = Random::new(12);
    for _ in 0..3000 {
        let center = random.point_with_exponents(-8, 8);
        let size = random.size(-8, 8);
        let corners = [0; 3].map(|_| random.near(center, size));
        let point = random.point_with_exponents(-8, 8);
        let Some(nearest) = tree(&[corners], &[], Quality::Fast).closest_point(point, f32::INFINITY) else {
            continue;
        };
        let apart = |a: [f64; 3]| {
            let squares = [0, 1, 2].map(|i| (a[i] - f64::from(point[i])) * (a[i] - f64::from(point[i])));
            (squares[0] + squares[1] + squares[2]).sqrt()
        };
        let at = |u: f64, v: f64| {
            [0, 1, 2].map(|i| {
                let [a, b, c] = [0, 1, 2].map(|corner| f64::from(corners[corner][i]));
                a + u * (b - a) + v * (c - a)
            })
        };
        let distance = f64::from(nearest.distance);
        let extent = f64::from(corners.iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs())));
        let error = 1e-7 * (distance + 1e-8 * extent);
        // The point that it names is on the triangle and as far as it says, up to the rounding of u and v.
        let (u, v) = (f64::from(nearest.u), f64::from(nearest.v));
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-7);
        assert!(
            (apart(at(u, v)) - distance).abs() <= error + 1e-6 * f64::from(size),
            "{corners:?} {point:?}"
        );
        for _ in 0..200 {
            let (mut u, mut v) = (f64::from(random.unit()), f64::from(random.unit()));
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            assert!(distance <= apart(at(u, v)) + error, "{corners:?} {point:?}");
        }
    }
}

#[test]
fn what_cannot_be_asked_is_none() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bvh = tree(&[corners], &[], Quality::Balanced);
    for point in [[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0], [0.0, 0.0, f32::MAX]] {
        assert_eq!(bvh.closest_point(point, f32::INFINITY), None);
    }
    for max in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        assert_eq!(bvh.closest_point([0.0; 3], max), None);
    }
    assert_eq!(Bvh::default().closest_point([0.0; 3], f32::INFINITY), None);
    let touching = bvh.closest_point([0.25, 0.25, 0.0], 0.0).unwrap();
    assert_eq!((touching.distance, touching.instance), (0.0, NONE));
    assert!(bvh.closest_point([0.0, 0.0, 2.0], 2.0).is_some(), "the end counts");
}

/// Corners in f64, and as the tree has them.
struct Fine(Vec<[[f64; 3]; 3]>);

impl Unrounded for Fine {
    fn triangle(&self, _: u32, _: u32, primitive: u32) -> [[f64; 3]; 3] {
        self.0[primitive as usize]
    }

    fn sphere(&self, _: u32, _: u32, _: u32) -> ([f64; 3], f64) {
        unreachable!("there are none")
    }

    fn error(&self) -> f64 {
        2.0_f64.powi(-22)
    }
}

#[test]
fn unrounded_shapes_decide_in_f64() {
    let mut random = Random::new(77);
    for _ in 0..30 {
        // Triangles nearer to each other than f32 can tell.
        let mut fine = Fine(Vec::new());
        for _ in 0..40 {
            let center = random.near([0.0; 3], 0.5);
            let size = random.size(-3, 0);
            let corners = [0; 3].map(|_| random.near(center, 0.5 * size).map(f64::from));
            for _ in 0..3 {
                let shift = 1e-9 * f64::from(random.unit());
                fine.0.push(corners.map(|p| p.map(|x| x + shift)));
            }
        }
        let rounded: Vec<Corners> =
            fine.0.iter().map(|corners| corners.map(|p| p.map(|x| x as f32))).collect();
        let bvh = tree(&rounded, &[], Quality::Balanced);
        let alone = |number: usize, point: [f64; 3]| {
            let one = Fine(vec![fine.0[number]]);
            tree(&[rounded[number]], &[], Quality::Fast)
                .closest_point_unrounded(point, f64::INFINITY, &one)
                .unwrap()
        };
        for _ in 0..20 {
            let point = random.near([0.0; 3], 1.0).map(|x| f64::from(x) + 1e-10);
            let found = bvh.closest_point_unrounded(point, f64::INFINITY, &fine).unwrap();
            let least = (0..fine.0.len()).map(|i| alone(i, point).distance).fold(f64::INFINITY, f64::min);
            assert_eq!(found.distance, least);
            assert!(bvh.closest_point_unrounded(point, least * 0.999, &fine).is_none());
        }
    }
}
