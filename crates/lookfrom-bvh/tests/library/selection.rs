//! Do masks and faces leave out just what they should? All hits, told apart one by one, say what is to be seen.

use std::sync::Arc;

use lookfrom_bvh::{
    Aabb, Affine, BuildError, Builder, Bvh, Faces, Hit, HitF64, NONE, Procedural, ProceduralHit, Query, Ray,
    RayF64, Sphere, Triangles,
};

use crate::testing::Random;
use crate::vector::{cross, dot, minus};

/// A mask and faces.
#[derive(Clone, Copy, Debug)]
struct Selection {
    mask: u32,
    faces: Faces,
}

impl Selection {
    fn of(self, bvh: &Bvh) -> Query<'_> {
        bvh.query().mask(self.mask).faces(self.faces)
    }
}

type Corners = [[f32; 3]; 3];

/// Unit squares across the z axis, one above the other.
#[derive(Debug)]
struct Steps(u32);

impl Procedural for Steps {
    fn count(&self) -> u32 {
        self.0
    }
    fn bounds(&self, primitive: u32) -> Aabb {
        Aabb { min: [-1.0, -1.0, primitive as f32], max: [1.0, 1.0, primitive as f32] }
    }
    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let t = (primitive as f32 - ray.origin[2]) / ray.direction[2];
        let inside = (0..2).all(|i| (ray.origin[i] + t * ray.direction[i]).abs() <= 0.99);
        (inside && t > ray.t_min && t < ray.t_max).then_some(ProceduralHit { t, u: 0.0, v: 0.0 })
    }
}

/// What was told to a builder.
struct Told {
    corners: Vec<Corners>,
    spheres: Vec<Sphere>,
    /// By geometry.
    masks: [u32; 3],
    /// By geometry and primitive, where there are any.
    primitive_masks: [Vec<u32>; 3],
}

const STEPS: u32 = 5;

impl Told {
    fn random(random: &mut Random) -> Self {
        let whole = random.unit() < 0.5;
        let point = |random: &mut Random| match whole {
            true => [0; 3].map(|_| random.below(7) as f32 - 3.0),
            false => random.near([0.0; 3], 3.0),
        };
        let corners: Vec<Corners> = (0..40).map(|_| [0; 3].map(|_| point(random))).collect();
        let spheres: Vec<Sphere> = (0..8).map(|_| Sphere { center: point(random), radius: 1.0 }).collect();
        let mask = |random: &mut Random| random.below(16);
        let masks = [0; 3].map(|_| mask(random) | mask(random));
        let counts = [corners.len(), spheres.len(), STEPS as usize];
        let primitive_masks = counts.map(|count| match random.below(2) {
            0 => Vec::new(),
            _ => (0..count).map(|_| mask(random)).collect(),
        });
        Self { corners, spheres, masks, primitive_masks }
    }

    fn build(&self) -> Bvh {
        let mut builder = Builder::new();
        let positions: Vec<[f32; 3]> = self.corners.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> = (0..40).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        builder.spheres(&self.spheres);
        builder.procedural(Arc::new(Steps(STEPS)));
        for (geometry, masks) in self.primitive_masks.iter().enumerate() {
            builder.geometry_mask(geometry as u32, self.masks[geometry]);
            if !masks.is_empty() {
                builder.primitive_masks(geometry as u32, masks);
            }
        }
        builder.build().unwrap()
    }

    /// Whether a hit of a ray (in the object's space) is to be seen.
    fn shows(&self, selection: Selection, hit: &Hit, origin: [f64; 3], direction: [f64; 3]) -> bool {
        let own = self.primitive_masks[hit.geometry as usize].get(hit.primitive as usize);
        let mask = selection.mask;
        if self.masks[hit.geometry as usize] & mask == 0 || own.copied().unwrap_or(NONE) & mask == 0 {
            return false;
        }
        // The normal is on the front; where it and the ray are at right angles, rounding decides, and `doubtful` says so.
        let towards = match hit.geometry {
            0 => dot(normal(&self.corners[hit.primitive as usize]), direction),
            1 => {
                let sphere = &self.spheres[hit.primitive as usize];
                let at = [0, 1, 2].map(|i| origin[i] + f64::from(hit.t) * direction[i]);
                dot(minus(at, sphere.center.map(f64::from)), direction)
            }
            _ => return true,
        };
        match selection.faces {
            Faces::Both => true,
            Faces::Front => towards < 0.0,
            Faces::Back => towards > 0.0,
        }
    }

    /// Whether the ray grazes something, so that its face is not sure.
    fn doubtful(&self, hit: &Hit, origin: [f64; 3], direction: [f64; 3]) -> bool {
        let [n, d] = match hit.geometry {
            0 => [normal(&self.corners[hit.primitive as usize]), direction],
            1 => {
                let sphere = &self.spheres[hit.primitive as usize];
                let at = [0, 1, 2].map(|i| origin[i] + f64::from(hit.t) * direction[i]);
                [minus(at, sphere.center.map(f64::from)), direction]
            }
            _ => return false,
        };
        dot(n, d).abs() < 1e-3 * (dot(n, n) * dot(d, d)).sqrt()
    }
}

fn normal(corners: &Corners) -> [f64; 3] {
    let [p0, p1, p2] = corners.map(|p| p.map(f64::from));
    cross(minus(p1, p0), minus(p2, p0))
}

fn random_selection(random: &mut Random) -> Selection {
    let faces = [Faces::Both, Faces::Front, Faces::Back][random.below(3) as usize];
    Selection { mask: [NONE, random.below(16), 1 << random.below(4)][random.below(3) as usize], faces }
}

/// Rays between points, often whole ones, of any length and with any range.
fn random_ray(random: &mut Random) -> Ray {
    let whole = random.unit() < 0.3;
    let point = |random: &mut Random| match whole {
        true => [0; 3].map(|_| random.below(11) as f32 - 5.0),
        false => random.near([0.0; 3], 5.0),
    };
    let [from, to] = [point(random), point(random)];
    let stretch = if whole { 1.0 } else { random.size(-6, 6) };
    let mut ray = Ray::new(from, [0, 1, 2].map(|i| (to[i] - from[i]) * stretch));
    match random.below(4) {
        0 => ray.t_max = 1.0 / stretch,
        1 => ray.t_min = -1.0 / stretch,
        _ => {}
    }
    ray
}

/// All questions agree with the hits that are expected; returns how many of those there are.
fn check(bvh: &Bvh, selection: Selection, ray: &Ray, expected: &[Hit]) -> usize {
    let selected = selection.of(bvh);
    let mut found = vec![Hit::MISS];
    selected.all_hits(ray, &mut found);
    assert_eq!(found, expected, "{selection:?} {ray:?}");
    let closest = expected.first().copied().unwrap_or(Hit::MISS);
    assert_eq!(selected.closest_hit(ray), closest, "{selection:?} {ray:?}");
    assert_eq!(selected.occluded(ray), closest.is_hit(), "{selection:?} {ray:?}");
    let (mut hits, mut occluded) = ([Hit::MISS], [!closest.is_hit()]);
    selected.closest_hits(&[*ray], &mut hits);
    selected.occluded_many(&[*ray], &mut occluded);
    assert_eq!((hits[0], occluded[0]), (closest, closest.is_hit()));
    check_f64(&selected, ray, expected);
    expected.len()
}

/// The same ray in f64 has the same hits, rounded: but for both roots of a sphere that are one in f32, and but for hits that f32
/// rounds to an end of the range.
fn check_f64(selected: &Query<'_>, ray: &Ray, expected: &[Hit]) {
    let fine = RayF64::from(*ray);
    let mut found = Vec::new();
    selected.all_hits(&fine, &mut found);
    let closest = found.first().copied();
    let sorted = |mut hits: Vec<(u32, u32, u32, u32)>| {
        hits.sort_unstable();
        hits.dedup();
        hits
    };
    let in_range = found.iter().filter(|hit| hit.t as f32 > ray.t_min && (hit.t as f32) < ray.t_max);
    let rounded =
        in_range.map(|hit| (hit.instance, hit.geometry, hit.primitive, (hit.t as f32).to_bits())).collect();
    let expected = expected.iter().map(|hit| (hit.instance, hit.geometry, hit.primitive, hit.t.to_bits()));
    assert_eq!(sorted(rounded), sorted(expected.collect()), "{selected:?} {ray:?}");
    assert_eq!(selected.occluded(&fine), closest.is_some());
    assert_eq!(Some(selected.closest_hit(&fine)).filter(HitF64::is_hit), closest);
}

#[test]
fn what_is_selected_is_seen() {
    let mut random = Random::new(51);
    let (mut seen, mut hidden) = (0, 0);
    for _ in 0..60 {
        let told = Told::random(&mut random);
        let bvh = told.build();
        let mut all = Vec::new();
        for _ in 0..400 {
            let (ray, selection) = (random_ray(&mut random), random_selection(&mut random));
            bvh.query().all_hits(&ray, &mut all);
            let [origin, direction] = [ray.origin, ray.direction].map(|x| x.map(f64::from));
            if selection.faces != Faces::Both && all.iter().any(|hit| told.doubtful(hit, origin, direction)) {
                continue;
            }
            let before = all.len();
            all.retain(|hit| told.shows(selection, hit, origin, direction));
            seen += check(&bvh, selection, &ray, &all);
            hidden += before - all.len();
        }
    }
    assert!(seen > 5000 && hidden > 5000, "{seen} seen, {hidden} hidden");
}

#[test]
fn instances_have_masks_and_keep_their_objects_faces() {
    let mut random = Random::new(52);
    let (mut seen, mut hidden, mut mirrored) = (0, 0, 0);
    for _ in 0..60 {
        let told = Told::random(&mut random);
        let object = Arc::new(told.build());
        let mut scene = Builder::new();
        let mut placed: Vec<(Affine, u32)> = Vec::new();
        for instance in 0..4 {
            let matrix = [0; 3].map(|_| [0; 3].map(|_| f64::from(2.0 * random.unit() - 1.0)));
            let map = Affine { matrix, translation: random.near([0.0; 3], 3.0).map(f64::from) };
            if map.inverse().is_none_or(|back| back.matrix.iter().flatten().any(|x| x.abs() > 20.0)) {
                continue;
            }
            let [a, b, c] = matrix;
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            mirrored += usize::from(dot(cross, c) < 0.0);
            let number = scene.instance(object.clone(), map);
            let mask = if instance == 0 { NONE } else { random.below(16) };
            if mask != NONE {
                scene.instance_mask(number, mask);
            }
            placed.push((map, mask));
        }
        // And one that is not in an instance, with a mask of its own.
        let ball = scene.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
        scene.geometry_mask(ball, 0b1);
        let scene = scene.build().unwrap();
        let mut all = Vec::new();
        for _ in 0..300 {
            let (ray, selection) = (random_ray(&mut random), random_selection(&mut random));
            scene.query().all_hits(&ray, &mut all);
            let in_object = |hit: &Hit| {
                let back = placed[hit.instance as usize].0.inverse().unwrap();
                (back.point(ray.origin.map(f64::from)), back.vector(ray.direction.map(f64::from)))
            };
            // Where a hit is on the ball, seen along the ray from its middle.
            let on_ball = |hit: &Hit| {
                let [a, d] = [ray.origin, ray.direction].map(|x| x.map(f64::from));
                dot([0, 1, 2].map(|i| a[i] + f64::from(hit.t) * d[i]), d) / dot(d, d).sqrt()
            };
            let doubtful = all.iter().any(|hit| {
                if hit.instance == NONE {
                    return on_ball(hit).abs() < 1e-3;
                }
                let (origin, direction) = in_object(hit);
                told.doubtful(hit, origin, direction)
            });
            if selection.faces != Faces::Both && doubtful {
                continue;
            }
            let before = all.len();
            all.retain(|hit| {
                if hit.instance == NONE {
                    let face = match selection.faces {
                        Faces::Both => true,
                        Faces::Front => on_ball(hit) < 0.0,
                        Faces::Back => on_ball(hit) > 0.0,
                    };
                    return face && selection.mask & 1 != 0;
                }
                let (origin, direction) = in_object(hit);
                placed[hit.instance as usize].1 & selection.mask != 0
                    && told.shows(selection, hit, origin, direction)
            });
            seen += check(&scene, selection, &ray, &all);
            hidden += before - all.len();
        }
    }
    assert!(seen > 5000 && hidden > 5000 && mirrored > 50, "{seen} seen, {hidden} hidden, {mirrored}");
}

#[test]
fn what_is_hidden_ends_no_ray() {
    // A wall in front of a wall: the nearer is surely hit, and is not to be seen.
    let mut random = Random::new(53);
    for _ in 0..2000 {
        let size = random.size(-8, 8);
        let wall = |z: f32| [[-size, -size, z * size], [size, -size, z * size], [0.0, size, z * size]];
        let positions: Vec<[f32; 3]> = [wall(1.0), wall(2.0)].concat();
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2], [3, 4, 5]] });
        builder.primitive_masks(0, &[0b01, 0b10]);
        let bvh = builder.build().unwrap();
        let ray = Ray::new([0.1 * size, 0.0, 3.0 * size], [0.0, 0.0, -random.size(-8, 8)]);
        for (mask, primitive) in [(0b01, 0), (0b10, 1), (0b11, 1)] {
            let selected = bvh.query().mask(mask).faces(Faces::Front);
            assert_eq!(selected.closest_hit(&ray).primitive, primitive);
            assert!(selected.occluded(&ray));
            let behind = bvh.query().mask(mask).faces(Faces::Back);
            assert_eq!((behind.closest_hit(&ray), behind.occluded(&ray)), (Hit::MISS, false));
        }
        let nothing = bvh.query().mask(0b100);
        assert_eq!((nothing.closest_hit(&ray), nothing.occluded(&ray)), (Hit::MISS, false));
    }
}

#[test]
fn closed_meshes_are_left_through_backs_and_entered_through_fronts() {
    // An octahedron, its corners counter-clockwise from outside; rays through edges and corners, of any size.
    let mut random = Random::new(54);
    for _ in 0..3000 {
        let size = random.size(-8, 8);
        let center = random.point_with_exponents(-3, 3).map(|x| x * size);
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let positions: Vec<[f32; 3]> = [1.0, -1.0]
            .iter()
            .flat_map(|sign| axes.map(|axis| [0, 1, 2].map(|i| center[i] + sign * size * axis[i])))
            .collect();
        let indices =
            [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        let bvh = builder.build().unwrap();
        let [fronts, backs] = [Faces::Front, Faces::Back].map(|faces| bvh.query().faces(faces));
        let [a, b] = [random.below(6), random.below(6)].map(|i| positions[i as usize]);
        let s = if random.below(2) == 0 { 0.0 } else { random.unit() };
        let target =
            [0, 1, 2].map(|i| if a[i] + b[i] == 2.0 * center[i] { a[i] } else { a[i] + s * (b[i] - a[i]) });
        let inside = random.near(center, 0.2 * size);
        let ray = Ray::new(inside, [0, 1, 2].map(|i| target[i] - inside[i]));
        if ray.direction.iter().all(|x| x.abs() < 0.2 * size) {
            continue;
        }
        assert!(backs.occluded(&ray) && backs.closest_hit(&ray).is_hit(), "{ray:?}");
        assert!(!fronts.occluded(&ray) && !fronts.closest_hit(&ray).is_hit(), "{ray:?}");
        // The whole line, backwards: now it comes from outside.
        let through = Ray { t_min: f32::NEG_INFINITY, t_max: 0.0, ..ray };
        assert!(fronts.occluded(&through) && !backs.occluded(&through), "{ray:?}");
    }
}

#[test]
fn masks_for_nothing_are_errors() {
    let balls = [Sphere { center: [0.0; 3], radius: 1.0 }; 3];
    let fails = |told: &dyn Fn(&mut Builder)| {
        let mut builder = Builder::new();
        builder.spheres(&balls);
        told(&mut builder);
        builder.build().unwrap_err()
    };
    let error = fails(&|builder| _ = builder.geometry_mask(1, 1));
    assert_eq!(error, BuildError::NoSuchGeometry { geometry: 1, geometries: 1 });
    let error = fails(&|builder| _ = builder.primitive_masks(7, &[]));
    assert_eq!(error, BuildError::NoSuchGeometry { geometry: 7, geometries: 1 });
    let error = fails(&|builder| _ = builder.primitive_masks(0, &[1, 2]));
    assert_eq!(error, BuildError::MaskCount { geometry: 0, masks: 2, primitives: 3 });
    assert!(error.to_string().contains("3 primitives, but 2 masks"), "{error}");
    let error = fails(&|builder| _ = builder.instance_mask(0, 1));
    assert_eq!(error, BuildError::NoSuchInstance { instance: 0, instances: 0 });
}
