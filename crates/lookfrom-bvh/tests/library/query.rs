//! Do queries with masks, faces and origin primitives answer as the slow reference does, in both precisions and in packets?

use lookfrom_bvh::{
    Builder, Bvh, Faces, Hit, HitF64, NONE, Observer, OriginPrimitive, Query, Ray, RayF64, Sphere, Triangles,
    reference,
};

use crate::testing::Random;

type Corners = [[f32; 3]; 3];

/// Triangles, geometry 0, and spheres, geometry 1, each primitive with a mask.
struct Soup {
    corners: Vec<Corners>,
    spheres: Vec<Sphere>,
    masks: [Vec<u32>; 2],
}

impl Soup {
    fn random(random: &mut Random, center: [f32; 3], size: f32) -> Self {
        let corners = (0..60).map(|_| [0; 3].map(|_| random.near(center, size))).collect::<Vec<_>>();
        let spheres = (0..random.below(8))
            .map(|_| Sphere { center: random.near(center, size), radius: size * random.size(-2, 0) })
            .collect::<Vec<_>>();
        let masks = [corners.len(), spheres.len()].map(|n| (0..n).map(|_| random.below(4)).collect());
        Self { corners, spheres, masks }
    }

    fn build(&self) -> Bvh {
        let positions: Vec<[f32; 3]> = self.corners.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> = (0..60).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        builder.spheres(&self.spheres);
        builder.primitive_masks(0, &self.masks[0]);
        if !self.spheres.is_empty() {
            builder.primitive_masks(1, &self.masks[1]);
        }
        builder.build().unwrap()
    }

    /// The closest hit by the slow formulas: geometry, primitive and t. None in place of an answer where rounding may decide: near
    /// edges, for grazing rays, and for two hits that are close together.
    fn closest(
        &self,
        asked: &Asked,
        ray: &RayF64,
        origin: OriginPrimitive,
    ) -> Option<Option<(u32, u32, f64)>> {
        let (a, d) = (ray.origin, ray.direction);
        let mut ts: Vec<(f64, u32, u32)> = Vec::new();
        for (primitive, corners) in self.corners.iter().enumerate() {
            if !asked.sees(self.masks[0][primitive])
                || origin.geometry == 0 && origin.primitive == primitive as u32
            {
                continue;
            }
            let [p0, p1, p2] = corners.map(|p| p.map(f64::from));
            let rule = reference::cramer(a, d, p0, p1, p2);
            let edges = [rule.beta, rule.gamma, 1.0 - rule.beta - rule.gamma];
            if edges.iter().any(|x| x.abs() < 1e-4) || edges.iter().all(|x| x.abs() > 1e4) {
                return None;
            }
            // The determinant is −n·d: positive where the ray meets the front.
            if edges.iter().all(|x| *x > 0.0) && asked.sees_face(rule.d > 0.0) {
                ts.push((rule.t, 0, primitive as u32));
            }
        }
        for (primitive, ball) in self.spheres.iter().enumerate() {
            if !asked.sees(self.masks[1][primitive]) {
                continue;
            }
            let roots = reference::sphere(a, d, ball.center.map(f64::from), f64::from(ball.radius));
            let size = roots.a * f64::from(ball.radius).powi(2);
            if roots.discriminant.abs() < 1e-3 * size {
                return None;
            }
            if roots.discriminant > 0.0 {
                let (near, far) = (roots.t1.min(roots.t2), roots.t1.max(roots.t2));
                for (t, is_front) in [(near, true), (far, false)] {
                    if asked.sees_face(is_front) {
                        ts.push((t, 1, primitive as u32));
                    }
                }
            }
        }
        if ts.iter().any(|(t, ..)| (t - ray.t_min).abs() < 1e-4 || (t / ray.t_max - 1.0).abs() < 1e-4) {
            return None;
        }
        ts.retain(|(t, ..)| ray.t_min < *t && *t < ray.t_max);
        ts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_close = |ts: &[(f64, u32, u32)]| ts[1].0 - ts[0].0 < 1e-5 * ts[1].0;
        if ts.len() > 1 && is_close(&ts[..2]) {
            return None;
        }
        Some(ts.first().map(|&(t, geometry, primitive)| (geometry, primitive, t)))
    }
}

/// A mask, where there is one, and faces.
#[derive(Clone, Copy, Debug)]
struct Asked {
    mask: Option<u32>,
    faces: Faces,
}

impl Asked {
    fn random(random: &mut Random) -> Self {
        let mask = [None, Some(1), Some(2), Some(3)][random.below(4) as usize];
        Self { mask, faces: [Faces::Both, Faces::Front, Faces::Back][random.below(3) as usize] }
    }

    fn query(self, bvh: &Bvh) -> Query<'_> {
        let query = bvh.query().faces(self.faces);
        self.mask.map_or(query, |mask| query.mask(mask))
    }

    fn sees(self, mask: u32) -> bool {
        self.mask.is_none_or(|asked| asked & mask != 0)
    }

    fn sees_face(self, is_front: bool) -> bool {
        match self.faces {
            Faces::Both => true,
            Faces::Front => is_front,
            Faces::Back => !is_front,
        }
    }
}

/// Neighbouring rays to a target, from one origin or from several close together.
fn neighbours(random: &mut Random, target: [f32; 3], size: f32) -> Vec<Ray> {
    let from = random.near(target, 3.0 * size);
    let lens = if random.below(2) == 0 { 0.0 } else { 0.01 * size };
    let opening = size * random.size(-2, 0);
    let ends = random.below(3) == 0;
    let mut ray = || {
        let origin = random.near(from, lens);
        let towards = random.near(target, opening);
        let direction = [0, 1, 2].map(|axis| towards[axis] - origin[axis]);
        Ray { t_max: if ends { 2.0 * random.unit() } else { f32::INFINITY }, ..Ray::new(origin, direction) }
    };
    (0..130).map(|_| ray()).collect()
}

#[test]
fn queries_answer_as_the_reference_does() {
    let mut random = Random::new(71);
    let (mut hits, mut misses, mut doubtful) = (0, 0, 0);
    for _ in 0..150 {
        let (center, size) = (random.point_with_exponents(-3, 3), random.size(-2, 3));
        let soup = Soup::random(&mut random, center, size);
        let bvh = soup.build();
        for _ in 0..4 {
            let asked = Asked::random(&mut random);
            let target = random.near(center, size);
            let rays = neighbours(&mut random, target, size);
            let fine: Vec<RayF64> = rays.iter().map(|ray| RayF64::from(*ray)).collect();
            // Exclude for some rays the triangle that they meet first, which the others do not miss.
            let origins: Vec<OriginPrimitive> = rays
                .iter()
                .map(|ray| match random.below(2) {
                    0 => OriginPrimitive::NONE,
                    _ => OriginPrimitive::of(&bvh.closest_hit(ray)),
                })
                .collect();
            let query = asked.query(&bvh).origins(&origins);
            let (mut found, mut occluded) = (vec![Hit::MISS; 130], vec![false; 130]);
            query.closest_hits(&rays, &mut found);
            query.occluded_many(&rays, &mut occluded);
            let (mut found_f64, mut occluded_f64) = (vec![HitF64::MISS; 130], vec![false; 130]);
            query.closest_hits(&fine, &mut found_f64);
            query.occluded_many(&fine, &mut occluded_f64);
            for number in 0..rays.len() {
                let Some(expected) = soup.closest(&asked, &fine[number], origins[number]) else {
                    doubtful += 1;
                    continue;
                };
                let (hit, hit_f64) = (found[number], found_f64[number]);
                let ids = expected.map_or((NONE, NONE), |(geometry, primitive, _)| (geometry, primitive));
                let told = format!("{asked:?} {:?} {:?} {expected:?}", rays[number], origins[number]);
                assert_eq!((hit.geometry, hit.primitive), ids, "{told}");
                assert_eq!((hit_f64.geometry, hit_f64.primitive), ids, "{told}");
                assert_eq!([occluded[number], occluded_f64[number]], [expected.is_some(); 2], "{told}");
                let alone = query.origins(&origins[number..]);
                assert_eq!(
                    (alone.closest_hit(&rays[number]), alone.closest_hit(&fine[number])),
                    (hit, hit_f64)
                );
                if let Some((.., t)) = expected {
                    assert!((f64::from(hit.t) / t - 1.0).abs() < 1e-6, "{told} {hit:?}");
                    assert!((hit_f64.t / t - 1.0).abs() < 1e-9, "{told} {hit_f64:?}");
                    hits += 1;
                } else {
                    misses += 1;
                }
            }
        }
    }
    assert!(hits > 10_000 && misses > 5000 && doubtful < hits, "{hits} hits, {misses} misses, {doubtful}");
}

/// Counts nodes and candidates.
#[derive(Default)]
struct Counts(u32, u32);

impl Observer for Counts {
    fn node(&mut self, _: u32, _: u32) {
        self.0 += 1;
    }
    fn candidate(&mut self, _: u32, _: u32, _: u32) {
        self.1 += 1;
    }
}

#[test]
fn observers_change_no_answer() {
    let mut random = Random::new(72);
    let soup = Soup::random(&mut random, [0.0; 3], 1.0);
    let bvh = soup.build();
    for _ in 0..20 {
        let asked = Asked::random(&mut random);
        let rays = neighbours(&mut random, [0.0; 3], 1.0);
        let query = asked.query(&bvh);
        let (mut plain, mut observed) = (vec![Hit::MISS; 130], vec![Hit::MISS; 130]);
        let mut counts = Counts::default();
        query.closest_hits(&rays, &mut plain);
        query.observer(&mut counts).closest_hits(&rays, &mut observed);
        assert_eq!(plain, observed);
        assert!(counts.0 >= 130 && counts.1 > 0);
        let (mut plain, mut observed) = (vec![false; 130], vec![false; 130]);
        query.occluded_many(&rays, &mut plain);
        query.observer(&mut counts).occluded_many(&rays, &mut observed);
        assert_eq!(plain, observed);
        let (mut plain, mut observed) = (Vec::new(), Vec::new());
        query.all_hits(&rays[0], &mut plain);
        query.observer(&mut counts).all_hits(&rays[0], &mut observed);
        assert_eq!(plain, observed);
        let (fine, before) = (RayF64::from(rays[0]), counts.1);
        assert_eq!(query.observer(&mut counts).closest_hit(&fine), query.closest_hit(&fine));
        assert!(counts.1 >= before);
    }
}
