//! Motion: at any time a tree is hit as one that is built for that time is.

use std::sync::Arc;

use lookfrom_bvh::{
    Affine, BuildError, Builder, Bvh, ClosestPoint, Hit, HitF64, OriginPrimitive, Ray, RayF64, Sphere,
    Triangles,
};

use crate::testing::Random;

/// A scene that moves, at a number of times.
struct Scene {
    standing: Vec<[f32; 3]>,
    ball: Sphere,
    /// Positions of triangles that move, by time.
    moving: Vec<Vec<[f32; 3]>>,
    /// Positions of triangles that move in an object, by time.
    in_object: Vec<Vec<[f32; 3]>>,
    /// Maps of instances: of a ball that moves, and of the moving triangles, which move and stand still.
    ball_maps: Vec<Affine>,
    object_maps: Vec<Affine>,
    still_map: Affine,
    indices: Vec<[u32; 3]>,
}

fn map(random: &mut Random, shift: [f32; 3]) -> Affine {
    loop {
        let matrix = [0; 3].map(|_| [0; 3].map(|_| f64::from(2.0 * random.unit() - 1.0)));
        let map = Affine { matrix, translation: shift.map(f64::from) };
        if map.inverse().is_some() {
            return map;
        }
    }
}

impl Scene {
    /// Of triangles at so many times, and instances with maps at others, if all are 2ᵏ + 1.
    fn new(random: &mut Random, times: usize) -> Self {
        const VERTICES: u32 = 120;
        let (center, size) = (random.point_with_exponents(-3, 3), random.size(-2, 3));
        let mut cloud = |center: [f32; 3], size: f32| -> Vec<[f32; 3]> {
            (0..VERTICES).map(|_| random.near(center, size)).collect()
        };
        let standing = cloud(center, size);
        let moving = (0..times).map(|_| cloud(center, size)).collect();
        let in_object = (0..times).map(|_| cloud([0.0; 3], size)).collect();
        let ball = Sphere { center: [0.1 * size; 3], radius: 0.4 * size };
        let indices = (0..90).map(|_| [0; 3].map(|_| random.below(VERTICES))).collect();
        let mut maps = || -> Vec<Affine> {
            let has_halves = (times - 1).is_power_of_two();
            let times = if has_halves { [2, 3, 5, 33][random.below(4) as usize] } else { times };
            let slides = random.unit() < 0.3;
            let mut maps: Vec<Affine> = Vec::new();
            for _ in 0..times {
                let shift = random.near(center, size);
                let place = map(random, shift);
                let matrix = maps.first().filter(|_| slides).map_or(place.matrix, |first| first.matrix);
                maps.push(Affine { matrix, ..place });
            }
            maps
        };
        let (ball_maps, object_maps) = (maps(), maps());
        let still_map = map(random, center);
        Self { standing, ball, moving, in_object, ball_maps, object_maps, still_map, indices }
    }

    fn ball(&self) -> Arc<Bvh> {
        let mut builder = Builder::new();
        builder.spheres(&[self.ball]);
        Arc::new(builder.build().unwrap())
    }

    fn whole(&self) -> Bvh {
        let slices = |times: &[Vec<[f32; 3]>], builder: &mut Builder| {
            let slices: Vec<&[[f32; 3]]> = times.iter().map(|positions| &**positions).collect();
            builder.moving_triangles(&slices, &self.indices);
        };
        let mut object = Builder::new();
        slices(&self.in_object, &mut object);
        let object = Arc::new(object.build().unwrap());
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &self.standing, indices: &self.indices });
        slices(&self.moving, &mut builder);
        builder.moving_instance(self.ball(), &self.ball_maps);
        builder.instance(self.ball(), self.still_map);
        builder.moving_instance(object.clone(), &self.object_maps);
        builder.instance(object, self.still_map);
        builder.build().unwrap()
    }

    /// The tree that is built for one time.
    fn at(&self, time: f32) -> Bvh {
        let steps = self.moving.len() - 1;
        let place = time * steps as f32;
        let earlier = (place as usize).min(steps - 1);
        let fraction = place - earlier as f32;
        let positions = |times: &[Vec<[f32; 3]>]| -> Vec<[f32; 3]> {
            let pairs = times[earlier].iter().zip(&times[earlier + 1]);
            pairs
                .map(|(a, b)| [0, 1, 2].map(|axis| a[axis] * (1.0 - fraction) + b[axis] * fraction))
                .collect()
        };
        let map = |maps: &[Affine]| Affine::at_time(maps, time);
        let mut object = Builder::new();
        object.triangles(Triangles { positions: &positions(&self.in_object), indices: &self.indices });
        let object = Arc::new(object.build().unwrap());
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &self.standing, indices: &self.indices });
        builder.triangles(Triangles { positions: &positions(&self.moving), indices: &self.indices });
        builder.instance(self.ball(), map(&self.ball_maps));
        builder.instance(self.ball(), self.still_map);
        builder.instance(object.clone(), map(&self.object_maps));
        builder.instance(object, self.still_map);
        builder.build().unwrap()
    }

    fn rays(&self, random: &mut Random, count: usize) -> Vec<Ray> {
        let ray = |_| {
            let target = self.standing[random.below(self.standing.len() as u32) as usize];
            let size = 3.0 * self.ball.radius;
            let origin = random.near(target, 3.0 * size);
            let near = random.near(target, 0.5 * size);
            let t_max = if random.unit() < 0.3 { 1.0 } else { f32::INFINITY };
            let t_min = if random.unit() < 0.2 { -1.0 } else { 0.0 };
            Ray { origin, t_min, direction: [0, 1, 2].map(|axis| near[axis] - origin[axis]), t_max }
        };
        (0..count).map(ray).collect()
    }
}

fn widened(ray: &Ray) -> RayF64 {
    RayF64 {
        origin: ray.origin.map(f64::from),
        direction: ray.direction.map(f64::from),
        t_min: ray.t_min.into(),
        t_max: ray.t_max.into(),
    }
}

#[test]
fn every_query_sees_what_is_there_at_its_time() {
    let mut random = Random::new(21);
    let (mut hits_of_moving, mut hits_of_standing) = (0, 0);
    for round in 0..24 {
        let scene = Scene::new(&mut random, 2 + round % 4);
        let whole = scene.whole();
        assert!(whole.is_moving());
        let time_of =
            |index: u32, random: &mut Random| [0.0, 1.0, random.unit(), random.unit()][index as usize];
        for index in 0..4 {
            let time = time_of(index, &mut random);
            let at = scene.at(time);
            let rays = scene.rays(&mut random, 200);
            let origins: Vec<OriginPrimitive> =
                rays.iter().map(|ray| OriginPrimitive::of(&at.closest_hit(ray))).collect();
            let (mut hits, mut expected) = ([[Hit::MISS; 200]; 2], [[Hit::MISS; 200]; 2]);
            let (mut occluded, mut blocked) = ([false; 200], [false; 200]);
            let times = [time; 200];
            whole.query().times(&times).closest_hits(&rays, &mut hits[0]);
            whole.query().times(&times).origins(&origins).closest_hits(&rays, &mut hits[1]);
            whole.query().times(&times).occluded_many(&rays, &mut occluded);
            at.closest_hits(&rays, &mut expected[0]);
            at.query().origins(&origins).closest_hits(&rays, &mut expected[1]);
            at.occluded_many(&rays, &mut blocked);
            assert_eq!(hits, expected, "at {time}");
            assert_eq!(occluded, blocked, "at {time}");
            let (mut all, mut all_expected) = (Vec::new(), Vec::new());
            let (mut fine, mut fine_expected) = (Vec::<HitF64>::new(), Vec::new());
            for (ray, hit) in rays.iter().zip(hits[0]) {
                assert_eq!(whole.query().time(time).closest_hit(ray), hit);
                assert_eq!(whole.query().time(time).occluded(ray), hit.is_hit());
                whole.query().time(time).all_hits(ray, &mut all);
                at.query().all_hits(ray, &mut all_expected);
                assert_eq!(all, all_expected);
                whole.query().time(time).all_hits(&widened(ray), &mut fine);
                at.query().all_hits(&widened(ray), &mut fine_expected);
                assert_eq!(fine, fine_expected);
                let moves = hit.geometry == 1 || [0, 2, 3].contains(&hit.instance);
                hits_of_moving += usize::from(hit.is_hit() && moves);
                hits_of_standing += usize::from(hit.is_hit() && !moves);
            }
        }
    }
    assert!(hits_of_moving > 2000 && hits_of_standing > 2000, "{hits_of_moving}, {hits_of_standing}");
}

#[test]
fn each_ray_has_its_own_time() {
    let mut random = Random::new(22);
    let scene = Scene::new(&mut random, 3);
    let whole = scene.whole();
    let rays = scene.rays(&mut random, 300);
    let times: Vec<f32> = rays.iter().map(|_| random.unit()).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    whole.query().times(&times).closest_hits(&rays, &mut hits);
    for ((ray, time), hit) in rays.iter().zip(&times).zip(&hits) {
        assert_eq!(scene.at(*time).closest_hit(ray), *hit);
    }
}

#[test]
fn the_nearest_point_is_that_of_its_time() {
    let mut random = Random::new(23);
    let mut found_on_moving = 0;
    for round in 0..24 {
        let scene = Scene::new(&mut random, 2 + round % 4);
        let whole = scene.whole();
        let points: Vec<[f32; 3]> = scene.rays(&mut random, 100).iter().map(|ray| ray.origin).collect();
        let time_of = |index, random: &mut Random| if index < 2 { index as f32 } else { random.unit() };
        let times: Vec<f32> = (0..points.len()).map(|index| time_of(index, &mut random)).collect();
        let max = if round % 3 == 0 { scene.ball.radius } else { f32::INFINITY };
        let (mut nearest, mut near) = (vec![None; points.len()], vec![false; points.len()]);
        whole.query().times(&times).closest_points(&points, max, &mut nearest);
        whole.query().times(&times).are_near(&points, max, &mut near);
        for (((&point, &time), nearest), near) in points.iter().zip(&times).zip(nearest).zip(near) {
            let expected = scene.at(time).closest_point(point, max);
            assert_eq!(nearest, expected, "{point:?} at {time}");
            assert_eq!(whole.query().time(time).closest_point(point, max), expected);
            assert_eq!((near, whole.query().time(time).is_near(point, max)), (expected.is_some(), near));
            if time == 0.0 {
                assert_eq!((whole.closest_point(point, max), whole.is_near(point, max)), (expected, near));
            }
            let moves = |found: &ClosestPoint| found.geometry == 1 || [0, 2, 3].contains(&found.instance);
            found_on_moving += usize::from(expected.is_some_and(|found| moves(&found)));
        }
    }
    assert!(found_on_moving > 500, "{found_on_moving}");
}

#[test]
fn masks_hide_what_moves() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let up = positions.map(|[x, y, z]| [x, y, z + 1.0]);
    let mut builder = Builder::new();
    let triangle = builder.moving_triangles(&[&positions, &up], &[[0, 1, 2]]);
    builder.geometry_mask(triangle, 0b10);
    let bvh = builder.build().unwrap();
    let ray = Ray::new([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]);
    assert!(bvh.query().time(0.5).mask(0b10).occluded(&ray));
    assert!(!bvh.query().time(0.5).mask(0b01).occluded(&ray));
    let nearest = bvh.query().time(0.5).mask(0b10).closest_point([0.25; 3], 1.0);
    assert_eq!(nearest.map(|nearest| nearest.position), Some([0.25, 0.25, 0.5]));
    assert_eq!(bvh.query().time(0.5).mask(0b01).closest_point([0.25; 3], 1.0), None);
    assert_eq!((bvh.bounds().min[2], bvh.statistics().left_out), (bvh.bounds().min[2].min(0.0), 0));
    assert!(bvh.bounds().max[2] >= 1.0);
}

#[test]
fn motions_that_do_not_fit_together_are_errors() {
    let positions = [[0.0_f32; 3]; 3];
    let mut builder = Builder::new();
    builder.moving_triangles(&[&positions], &[]);
    assert_eq!(builder.build().unwrap_err(), BuildError::TimeCount { times: 1, expected: 2 });
    let mut builder = Builder::new();
    builder.moving_triangles(&[&positions, &positions[1..]], &[]);
    assert_eq!(builder.build().unwrap_err(), BuildError::PositionCount { geometry: 0 });
    let mut builder = Builder::new();
    builder.moving_instance(Arc::default(), &[Affine::IDENTITY; 2]);
    builder.moving_instance(Arc::default(), &[Affine::IDENTITY; 3]);
    assert!(builder.build().is_ok());
    builder.moving_instance(Arc::default(), &[Affine::IDENTITY; 4]);
    assert_eq!(builder.build().unwrap_err(), BuildError::TimeCount { times: 4, expected: 2 });
    let mut builder = Builder::new();
    builder.moving_triangles(&[&positions, &positions], &[]);
    builder.moving_instance(Arc::default(), &[Affine::IDENTITY; 5]);
    assert!(builder.build().is_ok());
    builder.moving_triangles(&[&positions, &positions, &positions], &[]);
    assert_eq!(builder.build().unwrap_err(), BuildError::TimeCount { times: 3, expected: 2 });
    let flat = Affine { matrix: [[0.0; 3]; 3], translation: [0.0; 3] };
    let mut builder = Builder::new();
    builder.moving_instance(Arc::default(), &[Affine::IDENTITY, flat]);
    assert_eq!(builder.build().unwrap_err(), BuildError::SingularMatrix { instance: 0 });
}

#[test]
fn what_turns_costs_nothing_where_others_slide() {
    let mut random = Random::new(24);
    let scene = Scene::new(&mut random, 2);
    let mut motions: Vec<Vec<Affine>> = Vec::new();
    for _ in 0..400 {
        let place = map(&mut random, [0.0; 3]);
        let mut end = || random.near([0.0; 3], 40.0).map(f64::from);
        motions.push([end(), end()].map(|translation| Affine { translation, ..place }).into());
    }
    let built = |motions: &[Vec<Affine>]| {
        let mut builder = Builder::new();
        motions.iter().for_each(|maps| _ = builder.moving_instance(scene.ball(), maps));
        builder.build().unwrap()
    };
    let without = built(&motions).memory();
    // Around a circle, once while the shutter is open.
    let on_circle = |step: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(step) / 256.0).sin_cos();
        Affine {
            matrix: [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]],
            translation: [20.0 * cos, 20.0 * sin, 0.0],
        }
    };
    motions.push((0..=256).map(on_circle).collect());
    let whole = built(&motions);
    assert!(whole.memory() < without + without / 4 + 257 * size_of::<Affine>());
    let mut hits = 0;
    for _ in 0..40 {
        let time = random.unit();
        let mut at = Builder::new();
        motions.iter().for_each(|maps| _ = at.instance(scene.ball(), Affine::at_time(maps, time)));
        let at = at.build().unwrap();
        // Toward the one that turns, whose box is the one that bends.
        let target = Affine::at_time(&motions[400], time).translation.map(|x| x as f32);
        for _ in 0..50 {
            let origin = random.near([0.0; 3], 60.0);
            let near = random.near(target, 2.0 * scene.ball.radius);
            let ray = Ray::new(origin, [0, 1, 2].map(|axis| near[axis] - origin[axis]));
            let hit = whole.query().time(time).closest_hit(&ray);
            assert_eq!(hit, at.closest_hit(&ray), "at {time}");
            hits += usize::from(hit.instance == 400);
        }
    }
    assert!(hits > 150, "{hits}");
}
