//! Exact solids against a walk along each ray that asks at every step whether it is inside.

use std::sync::Arc;

use crate::support::forms::{Random, ray, scene_of, shape};
use glam::{DMat4, DVec3, Vec3};
use lookfrom::world::World;
use lookfrom_bvh::{Hit, Ray};
use lookfrom_scene::shape::Geometry;
use lookfrom_scene::solid::{Body, Combination, Form, Operation, Solid};

const STEPS: u32 = 3000;

fn random_body(random: &mut Random) -> Body {
    let form = match (4.0 * random.unit()) as u32 {
        0 => Form::Ball { center: 0.3 * random.direction(), radius: random.between(0.3, 0.9) },
        1 => Form::Cylinder { radius: random.between(0.1, 0.5), z: [-0.9, random.between(0.0, 1.2)] },
        2 => {
            let half = DVec3::new(random.between(0.2, 0.8), random.between(0.2, 0.8), 0.5);
            Form::Cuboid { min: -half, max: half * random.between(0.5, 1.0) }
        }
        _ => Form::Torus { radius: random.between(0.3, 0.7), tube: random.between(0.1, 0.4) },
    };
    let map = DMat4::from_translation(random.between(0.0, 0.4) * random.direction())
        * DMat4::from_axis_angle(random.direction(), random.between(0.0, 6.0))
        * DMat4::from_scale(DVec3::new(1.0, random.between(0.6, 1.3), 1.0));
    Body::new(form, map).expect("an inverse")
}

/// A combination of bodies from a number on, and how many they are.
fn random_combination(random: &mut Random, first: u32, depth: u32) -> (Combination, u32) {
    if depth == 0 || random.unit() < 0.3 {
        return (Combination::Body(first), 1);
    }
    let operations = [Operation::Union, Operation::Intersection, Operation::Difference];
    let operation = operations[(3.0 * random.unit()) as usize];
    let mut operands = Vec::new();
    let mut count = 0;
    for _ in 0..if random.unit() < 0.3 { 3 } else { 2 } {
        let (operand, more) = random_combination(random, first + count, depth - 1);
        operands.push(operand);
        count += more;
    }
    (Combination::Combined(operation, operands), count)
}

fn is_in(form: &Form, p: DVec3) -> bool {
    match *form {
        Form::Ball { center, radius } => p.distance(center) < radius,
        Form::Cylinder { radius, z: [low, high] } => p.x.hypot(p.y) < radius && p.z > low && p.z < high,
        Form::Cuboid { min, max } => (0..3).all(|axis| p[axis] > min[axis] && p[axis] < max[axis]),
        Form::Torus { radius, tube } => (p.x.hypot(p.y) - radius).hypot(p.z) < tube,
    }
}

fn contains(solid: &Solid, combination: &Combination, p: DVec3) -> bool {
    match combination {
        Combination::Body(number) => {
            let body = &solid.bodies()[*number as usize];
            is_in(body.form(), body.solid_from_body().inverse().transform_point3(p))
        }
        Combination::Combined(operation, operands) => {
            let inside: Vec<bool> = operands.iter().map(|operand| contains(solid, operand, p)).collect();
            match operation {
                Operation::Union => inside.contains(&true),
                Operation::Intersection => !inside.contains(&false),
                Operation::Difference => inside[0] && !inside[1..].contains(&true),
            }
        }
    }
}

/// A solid under a map.
struct Placed {
    solid: Arc<Solid>,
    map: DMat4,
    world: World,
}

impl Placed {
    fn random(random: &mut Random) -> Self {
        let (combination, count) = random_combination(random, 0, 3);
        let bodies = (0..count).map(|_| random_body(random)).collect();
        let solid = Arc::new(Solid::new(bodies, combination));
        assert!(solid.is_sound() && !solid.has_flush_surfaces());
        let map = random.map(2.0);
        let surface = |body: u32| shape(Geometry::SolidSurface { solid: solid.clone(), body }, map);
        let mut scene = scene_of(surface(0), vec![]);
        scene.shapes = (0..count).map(surface).collect();
        let world = World::compile(scene, &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"));
        Self { solid, map, world }
    }

    /// Whether a ray is inside at a parameter.
    fn inside<'a>(&'a self, ray: &Ray) -> impl Fn(f64) -> bool + 'a {
        let inverse = self.map.inverse();
        let origin = inverse.transform_point3(Vec3::from(ray.origin).as_dvec3());
        let direction = inverse.transform_vector3(Vec3::from(ray.direction).as_dvec3());
        move |t| contains(&self.solid, self.solid.combination(), origin + t * direction)
    }

    /// The parameter at which a ray is 8 units of the solid's space from its origin.
    fn end(&self, ray: &Ray) -> f64 {
        8.0 / self.map.inverse().transform_vector3(Vec3::from(ray.direction).as_dvec3()).length()
    }
}

impl Placed {
    /// The closest hit of a ray, and whether a walk along it agrees.
    fn walk(&self, ray: &Ray) -> (Hit, bool) {
        let (inside, end) = (self.inside(ray), self.end(ray));
        let hit = self.world.bvh().closest_hit(ray);
        let step = end / f64::from(STEPS);
        let change = (1..=STEPS).map(|k| f64::from(k) * step).find(|&t| inside(t) != inside(t - step));
        let is_same = match change {
            // In the last step of the walk, or in what it has stepped over.
            _ if hit.is_hit() && f64::from(hit.t) < change.unwrap_or(f64::INFINITY) => {
                let [before, after] = [-1.0, 1.0].map(|side| inside(f64::from(hit.t) + 2e-6 * side * end));
                before != after && self.world.surface(ray, &hit).front == after
            }
            Some(_) => false,
            None => !hit.is_hit(),
        };
        (hit, is_same)
    }
}

#[test]
fn rays_enter_and_leave_solids_where_a_walk_does() {
    let mut random = Random(7);
    let (mut hits, mut entered, mut different) = (0, 0, 0);
    for _ in 0..40 {
        let placed = Placed::random(&mut random);
        for number in 0..150 {
            let mut ray = ray(&mut random, &placed.map);
            if number % 3 == 0 {
                // From the middle on, which may be inside.
                ray.origin = placed.map.w_axis.truncate().as_vec3().to_array();
            }
            let (hit, is_same) = placed.walk(&ray);
            different += u32::from(!is_same);
            if hit.is_hit() {
                let surface = placed.world.surface(&ray, &hit);
                hits += 1;
                entered += u32::from(surface.front);
                let direction = placed.map.transform_vector3(random.direction()).as_vec3().to_array();
                let origin = surface.point.leave(surface.ng.to_array(), direction);
                different += u32::from(!placed.walk(&Ray::new(origin, direction)).1);
            }
        }
    }
    assert!(hits > 1500 && entered > 900 && hits - entered > 150, "{hits} hits, {entered} from outside");
    // A ray that grazes an edge.
    assert!(different * 500 <= hits, "{different} of {hits} differ");
}

#[test]
fn packets_find_the_same_bits() {
    let mut random = Random(8);
    let mut found = 0;
    for _ in 0..60 {
        let placed = Placed::random(&mut random);
        let rays: Vec<Ray> = (0..64).map(|_| ray(&mut random, &placed.map)).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        placed.world.bvh().closest_hits(&rays, &mut hits);
        for (ray, hit) in rays.iter().zip(&hits) {
            let one = placed.world.bvh().closest_hit(ray);
            assert_eq!((one.t.to_bits(), one.primitive), (hit.t.to_bits(), hit.primitive));
            found += u32::from(one.is_hit());
        }
    }
    assert!(found > 500, "{found}");
}
