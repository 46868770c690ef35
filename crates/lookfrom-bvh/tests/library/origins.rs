//! Do rays that leave a surface ever meet the primitive they left?
//!
//! `LOOKFROM_RAYS=10000000 cargo test --release -p lookfrom-bvh origins -- --nocapture` tries more and prints counts.

use std::sync::Arc;

use lookfrom_bvh::{Affine, Builder, Bvh, Hit, OriginPrimitive, Point, Ray, Sphere, Triangles};

use crate::testing::Random;
use crate::vector::{cross, dot, minus};

fn rays() -> usize {
    std::env::var("LOOKFROM_RAYS").ok().and_then(|text| text.parse().ok()).unwrap_or(100_000)
}

fn wide(a: [f32; 3]) -> [f64; 3] {
    a.map(f64::from)
}

/// A direction off a surface: anywhere, or close along it.
fn leaving(random: &mut Random, normal: [f64; 3]) -> [f32; 3] {
    let direction = random.direction();
    if random.unit() < 0.5 {
        return direction;
    }
    let length = dot(normal, normal).sqrt();
    let n = normal.map(|x| x / length);
    let d = wide(direction);
    let along = dot(n, d);
    let rest =
        dot(d, d).sqrt() * f64::from(random.size(-9, 0)) * if random.unit() < 0.5 { 1.0 } else { -1.0 };
    [0, 1, 2].map(|i| (d[i] - along * n[i] + rest * n[i]) as f32)
}

/// Rotations, scales, shears and mirrors of random size, anywhere.
fn random_map(random: &mut Random) -> Affine {
    let scale = random.size(-4, 4);
    loop {
        let stretch = [0; 3].map(|_| random.size(-1, 1));
        let matrix =
            [0; 3].map(|_| [0, 1, 2].map(|i| f64::from(scale * stretch[i] * (2.0 * random.unit() - 1.0))));
        let map = Affine { matrix, translation: wide(random.point_with_exponents(-8, 8)) };
        if map.inverse().is_some() {
            return map;
        }
    }
}

fn in_world(bvh: Bvh, map: Affine) -> Bvh {
    let mut builder = Builder::new();
    builder.instance(Arc::new(bvh), map);
    builder.build().unwrap()
}

/// The first hit of rays towards points of the object, and the direction it was hit from.
fn hit(random: &mut Random, bvh: &Bvh, target: [f64; 3], size: f64) -> Option<(Ray, Hit)> {
    let distance = size * f64::from(random.size(-2, 4));
    let away = wide(random.direction());
    let length = dot(away, away).sqrt();
    let origin = [0, 1, 2].map(|i| (target[i] + distance * away[i] / length) as f32);
    let stretch = f64::from(random.size(-8, 8)) / distance;
    let direction = [0, 1, 2].map(|i| ((target[i] - f64::from(origin[i])) * stretch) as f32);
    let ray = Ray::new(origin, direction);
    let hit = bvh.closest_hit(&ray);
    hit.is_hit().then_some((ray, hit))
}

fn random_triangle(random: &mut Random) -> ([[f32; 3]; 3], Bvh, f64) {
    loop {
        let size = random.size(-8, 8);
        let center = random.point_with_exponents(-8, 8).map(|x| x.clamp(-1e6 * size, 1e6 * size));
        let mut corners = [0; 3].map(|_| random.near(center, size));
        if random.below(4) == 0 {
            let axis = random.below(3) as usize;
            corners.iter_mut().for_each(|corner| corner[axis] = center[axis]);
        }
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &corners, indices: &[[0, 1, 2]] });
        let bvh = builder.build().unwrap();
        if bvh.statistics().triangles == 1 {
            return (corners, bvh, f64::from(size));
        }
    }
}

#[test]
fn rays_leaving_triangles() {
    let mut random = Random::new(21);
    let (mut left, mut again) = (0, 0);
    while left < rays() {
        let (corners, bvh, size) = random_triangle(&mut random);
        for _ in 0..8 {
            let target = wide(random.on_triangle(&corners));
            let Some((_, hit)) = hit(&mut random, &bvh, target, size) else { continue };
            let [p0, p1, p2] = corners;
            let normal = cross(minus(wide(p1), wide(p0)), minus(wide(p2), wide(p0)));
            let direction = leaving(&mut random, normal);
            let origin = Point::on_triangle(p0, p1, p2, hit.u, hit.v).origin(normal, direction);
            left += 1;
            again += usize::from(bvh.closest_hit(&Ray::new(origin, direction)).is_hit());
        }
    }
    println!("triangles: {again} of {left} hit again");
    assert_eq!(again, 0);
}

#[test]
fn rays_leaving_triangles_in_instances() {
    let mut random = Random::new(22);
    let (mut left, mut again) = (0, 0);
    while left < rays() {
        let (corners, bvh, size) = random_triangle(&mut random);
        let map = random_map(&mut random);
        let back = map.inverse().unwrap();
        let world_size = size * dot(map.matrix[0], map.matrix[0]).sqrt();
        let bvh = in_world(bvh, map);
        for _ in 0..8 {
            let target = map.point(wide(random.on_triangle(&corners)));
            let Some((_, hit)) = hit(&mut random, &bvh, target, world_size) else { continue };
            let [p0, p1, p2] = corners;
            let normal = back.normal_back(cross(minus(wide(p1), wide(p0)), minus(wide(p2), wide(p0))));
            let direction = leaving(&mut random, normal);
            let point = Point::on_triangle(p0, p1, p2, hit.u, hit.v).transformed(&map);
            let origin = point.origin(normal, direction);
            left += 1;
            again += usize::from(bvh.closest_hit(&Ray::new(origin, direction)).is_hit());
        }
    }
    println!("triangles in instances: {again} of {left} hit again");
    assert_eq!(again, 0);
}

fn random_sphere(random: &mut Random, least: f32) -> (Sphere, Bvh) {
    let radius = random.size(-8, 8);
    let center = random.point_with_exponents(-8, 8).map(|x| x.clamp(-radius / least, radius / least));
    let sphere = Sphere { center, radius };
    let mut builder = Builder::new();
    builder.spheres(&[sphere]);
    (sphere, builder.build().unwrap())
}

/// The point where a ray hits a sphere, as a renderer calculates it.
fn point_at(ray: &Ray, t: f32) -> [f64; 3] {
    [0, 1, 2].map(|i| f64::from(ray.origin[i]) + f64::from(t) * f64::from(ray.direction[i]))
}

#[test]
fn rays_leaving_spheres() {
    let mut random = Random::new(23);
    let (mut outside, mut inside, mut again, mut lost) = (0, 0, 0, 0);
    while outside + inside < 2 * rays() {
        let (sphere, bvh) = random_sphere(&mut random, 1e-7);
        let radius = f64::from(sphere.radius);
        for _ in 0..8 {
            let target = wide(random.near(sphere.center, 0.6 * sphere.radius));
            let Some((ray, hit)) = hit(&mut random, &bvh, target, radius) else { continue };
            let point = Point::on_sphere(sphere.center, sphere.radius, point_at(&ray, hit.t));
            let normal = minus(point.position, wide(sphere.center));
            let direction = leaving(&mut random, normal);
            let d = wide(direction);
            let found = bvh.closest_hit(&Ray::new(point.origin(normal, direction), direction));
            let cosine = dot(normal, d) / radius / dot(d, d).sqrt();
            if cosine >= 0.0 {
                outside += 1;
                again += usize::from(found.is_hit());
            } else {
                // Through the inside: not the near side again, but the far one, which is there.
                inside += 1;
                lost += usize::from(!found.is_hit());
                let largest = sphere.center.iter().fold(sphere.radius, |m, x| m.max(x.abs()));
                let chord = -2.0 * radius * cosine;
                if chord > 1e-5 * f64::from(largest) {
                    again += usize::from(f64::from(found.t) * dot(d, d).sqrt() < 0.9 * chord);
                }
            }
        }
    }
    println!("spheres: {again} hit again, {lost} lost, of {outside} outside and {inside} inside");
    assert_eq!((again, lost), (0, 0));
}

#[test]
fn rays_leaving_spheres_in_instances() {
    let mut random = Random::new(24);
    let (mut outside, mut inside, mut again, mut lost) = (0, 0, 0, 0);
    while outside + inside < 2 * rays() {
        let (sphere, bvh) = random_sphere(&mut random, 1e-6);
        let map = random_map(&mut random);
        let back = map.inverse().unwrap();
        let bvh = in_world(bvh, map);
        let size = f64::from(sphere.radius) * dot(map.matrix[0], map.matrix[0]).sqrt();
        for _ in 0..8 {
            let target = map.point(wide(random.near(sphere.center, 0.6 * sphere.radius)));
            let Some((ray, hit)) = hit(&mut random, &bvh, target, size) else { continue };
            let in_object = back.point(point_at(&ray, hit.t));
            let point = Point::on_sphere(sphere.center, sphere.radius, in_object);
            let object_normal = minus(point.position, wide(sphere.center));
            let normal = back.normal_back(object_normal);
            let point = point.transformed(&map);
            let direction = leaving(&mut random, normal);
            let d = wide(direction);
            let origin = point.origin(normal, direction);
            let found = bvh.closest_hit(&Ray::new(origin, direction));
            if dot(normal, d) >= 0.0 {
                outside += 1;
                again += usize::from(found.is_hit());
            } else {
                // Where the sphere is large against the spacing of f32 and the ray does not graze it.
                let object_direction = back.vector(d);
                let cosine = dot(object_normal, object_direction)
                    / f64::from(sphere.radius)
                    / dot(object_direction, object_direction).sqrt();
                let spacing = origin.iter().fold(0.0_f32, |m, x| m.max(x.abs())) * f32::EPSILON;
                if cosine < -1e-2 && size > 1e4 * f64::from(spacing) && is_roundish(&map) {
                    inside += 1;
                    lost += usize::from(!found.is_hit());
                }
            }
        }
    }
    println!(
        "spheres in instances: {again} hit again, {lost} lost, of {outside} outside and {inside} inside"
    );
    assert_eq!((again, lost), (0, 0));
}

/// Whether a map makes ellipsoids without sharp tips.
fn is_roundish(map: &Affine) -> bool {
    let back = map.inverse().unwrap();
    let norm = |m: &Affine| m.matrix.iter().map(|row| dot(*row, *row)).sum::<f64>().sqrt();
    norm(map) * norm(&back) < 30.0
}

#[test]
fn saying_what_rays_leave_changes_no_answer() {
    let mut random = Random::new(23);
    let (mut found, mut blocked) = (0, 0);
    for _ in 0..40 {
        let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
        let positions: Vec<[f32; 3]> = (0..300).map(|_| random.near(center, size)).collect();
        // Neighbours share edges, so that rays leave one and meet the next close by.
        let indices: Vec<[u32; 3]> = (0..298).map(|first| [first, first + 1, first + 2]).collect();
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        let bvh = builder.build().unwrap();
        let (mut rays, mut left) = (Vec::new(), Vec::new());
        for _ in 0..400 {
            let from = random.near(center, 3.0 * size);
            let to = random.near(center, size);
            let hit = bvh.closest_hit(&Ray::new(from, [0, 1, 2].map(|i| to[i] - from[i])));
            if hit.is_hit() {
                let [p0, p1, p2] = indices[hit.primitive as usize].map(|vertex| positions[vertex as usize]);
                let (point, normal) = Point::on_triangle_with_normal(p0, p1, p2, hit.u, hit.v);
                let direction = leaving(&mut random, normal);
                rays.push(Ray::new(point.origin(normal, direction), direction));
                left.push(OriginPrimitive::of(&hit));
            }
        }
        let (mut plain, mut told) = (vec![Hit::MISS; rays.len()], vec![Hit::MISS; rays.len()]);
        bvh.closest_hits(&rays, &mut plain);
        bvh.query().origins(&left).closest_hits(&rays, &mut told);
        assert_eq!(plain, told);
        let (mut any, mut any_told) = (vec![false; rays.len()], vec![false; rays.len()]);
        bvh.occluded_many(&rays, &mut any);
        bvh.query().origins(&left).occluded_many(&rays, &mut any_told);
        assert_eq!(any, any_told);
        for (ray, any) in rays.iter().zip(&any) {
            assert_eq!(bvh.occluded(ray), *any);
        }
        found += plain.iter().filter(|hit| hit.is_hit()).count();
        blocked += any.iter().filter(|any| **any).count();
    }
    assert!(found > 1000 && found == blocked, "{found} hits, {blocked} blocked");
}
