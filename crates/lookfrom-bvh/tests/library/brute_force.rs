//! Does a tree answer as its primitives do, one by one? And do they answer as the reference does?

use std::sync::Arc;

use lookfrom_bvh::{Builder, Bvh, Hit, Quality, Ray, Sphere, Triangles, reference};

use crate::shapes::Squares;
use crate::testing::Random;

/// A coordinate: often a small whole number, so that planes, edges and corners are met exactly.
fn coordinate(random: &mut Random, scale: f32, whole: bool) -> f32 {
    if whole { scale * (random.below(9) as f32 - 4.0) } else { scale * 4.0 * (2.0 * random.unit() - 1.0) }
}

fn bad_number(random: &mut Random) -> f32 {
    [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE / 4.0][random.below(5) as usize]
}

/// Geometry of all kinds: three of triangles, spheres and squares, mixed with what no ray can meet.
struct Soup {
    triangles: Vec<[[f32; 3]; 3]>,
    spheres: Vec<Sphere>,
    squares: Vec<([f32; 3], f32)>,
}

impl Soup {
    fn random(random: &mut Random, count: u32, scale: f32) -> Self {
        let whole = random.unit() < 0.5;
        let bad = if random.unit() < 0.5 { 0.1 } else { 0.0 };
        let point = |random: &mut Random| [0; 3].map(|_| coordinate(random, scale, whole));
        let mut soup = Self { triangles: Vec::new(), spheres: Vec::new(), squares: Vec::new() };
        for _ in 0..count {
            let mut corners = [0; 3].map(|_| point(random));
            match random.below(12) {
                0 => corners = soup.triangles.last().copied().unwrap_or(corners),
                1 => corners[2] = corners[1],
                2 => corners.iter_mut().for_each(|corner| corner[1] = scale),
                _ => {}
            }
            if random.unit() < bad {
                corners[random.below(3) as usize][random.below(3) as usize] = bad_number(random);
            }
            soup.triangles.push(corners);
        }
        for _ in 0..count / 4 {
            let mut radius = scale * (1.0 + random.below(2) as f32);
            if random.unit() < bad {
                radius = [0.0, -1.0, f32::NAN, f32::INFINITY][random.below(4) as usize];
            }
            soup.spheres.push(Sphere { center: point(random), radius });
            let half = if random.unit() < bad { bad_number(random) } else { scale };
            soup.squares.push((point(random), half));
        }
        soup
    }

    fn build(&self, quality: Quality) -> Bvh {
        let mut builder = Builder::new();
        builder.quality(quality);
        let positions: Vec<[f32; 3]> = self.triangles.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> =
            (0..self.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        builder.spheres(&self.spheres);
        builder.procedural(Arc::new(Squares(self.squares.clone())));
        let bvh = builder.build().unwrap();
        bvh.validate().unwrap();
        bvh
    }

    /// One tree for each primitive, with the ids that it has in the soup.
    fn one_by_one(&self) -> Vec<(u32, u32, Bvh)> {
        let mut trees = Vec::new();
        for (i, &corners) in self.triangles.iter().enumerate() {
            let mut builder = Builder::new();
            builder.triangles(Triangles { positions: &corners, indices: &[[0, 1, 2]] });
            trees.push((0, i as u32, builder.build().unwrap()));
        }
        for (i, sphere) in self.spheres.iter().enumerate() {
            let mut builder = Builder::new();
            builder.spheres(&[*sphere]);
            trees.push((1, i as u32, builder.build().unwrap()));
        }
        for (i, square) in self.squares.iter().enumerate() {
            let mut builder = Builder::new();
            builder.procedural(Arc::new(Squares(vec![*square])));
            trees.push((2, i as u32, builder.build().unwrap()));
        }
        trees
    }
}

fn random_ray(random: &mut Random, scale: f32) -> Ray {
    let whole = random.unit() < 0.5;
    let origin = [0; 3].map(|_| 2.0 * coordinate(random, scale, whole));
    let mut ray = if random.unit() < 0.5 {
        let target = [0; 3].map(|_| coordinate(random, scale, whole));
        Ray::new(origin, [0, 1, 2].map(|i| target[i] - origin[i]))
    } else {
        Ray::new(origin, random.direction())
    };
    match random.below(12) {
        0 => ray.t_max = random.size(-3, 3),
        1 => ray.t_min = random.size(-3, 3),
        2 => (ray.t_min, ray.t_max) = (0.5, 1.0),
        3 => ray.t_min = f32::NEG_INFINITY,
        4 => (ray.t_min, ray.t_max) = (2.0, 1.0),
        5 => ray.origin[random.below(3) as usize] = bad_number(random),
        6 => ray.direction[random.below(3) as usize] = bad_number(random),
        7 if random.unit() < 0.1 => ray.direction = [0.0, -0.0, 0.0],
        8 if random.unit() < 0.1 => ray.t_max = f32::NAN,
        _ => {}
    }
    ray
}

#[test]
fn a_tree_answers_as_its_primitives_one_by_one() {
    let mut random = Random::new(1);
    let (mut rays, mut hit_rays, mut ties) = (0, 0, 0);
    for round in 0..240 {
        let scale = if round % 3 == 0 { 1.0 } else { random.size(-8, 8) };
        let count = [0, 1, 4, 9, 40, 160][round % 6];
        let soup = Soup::random(&mut random, count, scale);
        let trees = [Quality::Fast, Quality::Balanced, Quality::Best].map(|quality| soup.build(quality));
        let single = soup.one_by_one();
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        let mut one = Vec::new();
        for _ in 0..60 {
            let ray = random_ray(&mut random, scale);
            expected.clear();
            for (geometry, primitive, tree) in &single {
                tree.query().all_hits(&ray, &mut one);
                assert!(one.iter().all(|hit| ray.t_min < hit.t && hit.t < ray.t_max));
                expected.extend(one.iter().map(|hit| Hit {
                    geometry: *geometry,
                    primitive: *primitive,
                    ..*hit
                }));
            }
            expected.sort_by(|a, b| {
                a.t.total_cmp(&b.t).then((a.geometry, a.primitive).cmp(&(b.geometry, b.primitive)))
            });
            let closest = expected.first().copied().unwrap_or(Hit::MISS);
            rays += 1;
            hit_rays += usize::from(closest.is_hit());
            ties += usize::from(expected.len() > 1 && expected[0].t == expected[1].t);
            for tree in &trees {
                tree.query().all_hits(&ray, &mut found);
                assert_eq!(found, expected, "{ray:?}");
                assert_eq!(tree.closest_hit(&ray), closest, "{ray:?}");
                assert_eq!(tree.occluded(&ray), closest.is_hit(), "{ray:?}");
            }
        }
    }
    assert!(hit_rays > rays / 8 && hit_rays < rays && ties > 50, "{hit_rays} of {rays} hit, {ties} ties");
}

#[test]
fn whole_numbers_agree_exactly_with_cramers_rule() {
    // With small whole numbers all determinants are exact, so there is no doubt about any edge or corner.
    let mut random = Random::new(2);
    let (mut hits, mut on_edges) = (0, 0);
    for _ in 0..200 {
        let corners: Vec<[[f32; 3]; 3]> =
            (0..20).map(|_| [0; 3].map(|_| [0; 3].map(|_| random.below(9) as f32 - 4.0))).collect();
        let positions: Vec<[f32; 3]> = corners.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        let bvh = builder.build().unwrap();
        let mut found = Vec::new();
        for _ in 0..200 {
            let origin = [0; 3].map(|_| random.below(17) as f32 - 8.0);
            let direction = [0; 3].map(|_| random.below(9) as f32 - 4.0);
            bvh.query().all_hits(&Ray::new(origin, direction), &mut found);
            let mut expected = Vec::new();
            for (primitive, triangle) in corners.iter().enumerate() {
                let [p0, p1, p2] = triangle.map(|p| p.map(f64::from));
                let rule = reference::cramer(origin.map(f64::from), direction.map(f64::from), p0, p1, p2);
                let sign = rule.d.signum();
                let weights = [rule.d - rule.d1 - rule.d2, rule.d1, rule.d2].map(|weight| weight * sign);
                if rule.d != 0.0 && weights.iter().all(|&weight| weight >= 0.0) && rule.d3 * sign > 0.0 {
                    expected.push(((rule.d3 / rule.d) as f32, primitive as u32));
                    on_edges += usize::from(weights.contains(&0.0));
                }
            }
            expected.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let found: Vec<(f32, u32)> = found.iter().map(|hit| (hit.t, hit.primitive)).collect();
            assert_eq!(found, expected, "{origin:?} {direction:?}");
            hits += found.len();
        }
    }
    assert!(hits > 10_000 && on_edges > 300, "{hits} hits, {on_edges} on edges");
}

#[test]
fn random_exponents_agree_with_the_reference_in_double_precision() {
    let mut random = Random::new(3);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..30_000 {
        let size = random.size(-8, 8);
        let center = random.point_with_exponents(-8, 8).map(|x| x.clamp(-1e4 * size, 1e4 * size));
        // How far away a ray starts, in sizes of what it is aimed at.
        let distance = random.size(-1, 4);
        let origin = random.near(center, size * distance);
        let corners = [0; 3].map(|_| random.near(center, size));
        let target = random.on_triangle(&corners);
        let length = random.size(-8, 8);
        let direction = [0, 1, 2].map(|i| (target[i] - origin[i]) * length / size);
        let [a, d] = [origin, direction].map(|v| v.map(f64::from));
        let [p0, p1, p2] = corners.map(|p| p.map(f64::from));

        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &corners, indices: &[[0, 1, 2]] });
        builder.spheres(&[Sphere { center, radius: 0.5 * size }]);
        let bvh = builder.build().unwrap();
        let mut found = Vec::new();
        bvh.query().all_hits(&Ray::new(origin, direction), &mut found);

        // A margin for what rounding decides.
        let rule = reference::cramer(a, d, p0, p1, p2);
        let margin = 1e-7;
        let least = rule.alpha.min(rule.beta).min(rule.gamma);
        let hit = found.iter().find(|hit| hit.geometry == 0);
        if least > margin && rule.t > 0.0 {
            let hit = hit.unwrap_or_else(|| panic!("{rule:?} is not hit"));
            assert!((f64::from(hit.t) / rule.t - 1.0).abs() < 1e-6, "{hit:?} {rule:?}");
            assert!((f64::from(hit.u) - rule.beta).abs() < 1e-6, "{hit:?} {rule:?}");
            assert!((f64::from(hit.v) - rule.gamma).abs() < 1e-6, "{hit:?} {rule:?}");
            hits += 1;
        } else if least < -margin || rule.t < 0.0 {
            assert!(hit.is_none(), "{hit:?} {rule:?}");
            misses += 1;
        }

        let quadratic = reference::sphere(a, d, center.map(f64::from), f64::from(0.5 * size));
        let found: Vec<f32> = found.iter().filter(|hit| hit.geometry == 1).map(|hit| hit.t).collect();
        let mut roots = [quadratic.t1 as f32, quadratic.t2 as f32].to_vec();
        roots.retain(|&t| t > 0.0);
        roots.sort_by(f32::total_cmp);
        assert_eq!(found, roots, "{quadratic:?}");
    }
    assert!(hits > 3000 && misses > 3000, "{hits} hits, {misses} misses");
}

#[test]
fn lists_of_shapes_by_brute_force() {
    let shapes = [
        reference::Shape::Triangle([[-1.0, -1.0, 2.0], [3.0, -1.0, 2.0], [-1.0, 3.0, 2.0]]),
        reference::Shape::Sphere([0.0, 0.0, 5.0], 1.0),
    ];
    let (a, d) = ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    assert_eq!(reference::closest(&shapes, a, d, 0.0, f64::INFINITY), Some((0, 2.0)));
    assert_eq!(reference::closest(&shapes, a, d, 2.0, f64::INFINITY), Some((1, 4.0)));
    assert_eq!(reference::all(&shapes, a, d, 0.0, f64::INFINITY), [(0, 2.0), (1, 4.0)]);
    assert!(reference::any(&shapes, a, d, 0.0, 2.5) && !reference::any(&shapes, a, d, 0.0, 2.0));
}
