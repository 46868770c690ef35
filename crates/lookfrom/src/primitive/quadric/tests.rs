//! Tests of the capsules around quadrics, and of rays eight at a time.

use lookfrom_bvh::{Procedural, ProceduralHit};

use super::*;
use crate::core::hash;

/// A number in −1 … 1.
pub(super) fn number(seed: u64) -> f64 {
    (hash::mix(seed) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

pub(super) fn vector(seed: u64) -> DVec3 {
    [0, 1, 2].map(|k| number(3 * seed + k)).into()
}

/// 2 to a random power of at most ± `most`.
pub(super) fn power(seed: u64, most: f64) -> f64 {
    libm::exp2(most * number(seed))
}

fn alone(quadric: Quadric) -> Quadrics {
    Quadrics { quadrics: vec![quadric], bindings: vec![MaterialBinding::NONE], ..Quadrics::default() }
}

/// Hits are in the capsules: cylinders and rays of random sizes, rays aimed at them, maps that turn, shear and mirror.
#[test]
fn hits_are_in_capsules() {
    let (mut hits, mut thin) = (0, 0);
    for index in 0..60_000_u64 {
        let seed = index * 40;
        let size = power(seed + 1, 20.0);
        let kind = QuadricKind::Cylinder {
            radius: size * power(seed + 2, 6.0),
            z: [size * number(seed + 3), size * number(seed + 4)],
        };
        let [x, y, z] = [5, 6, 7].map(|axis| vector(seed + axis));
        let place = size * power(seed + 8, 10.0) * vector(seed + 9);
        let matrix = DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), place.extend(1.0));
        let Some(quadric) = Quadric::new(kind, 360.0, &matrix, false) else { continue };
        let Some(around) = quadric.capsule() else { continue };
        thin += 1;

        let target =
            quadric.point_in_render(quadric.sample_in_object([0.5, 0.5 * number(seed + 10) as f32 + 0.5]));
        let direction = power(seed + 11, 10.0) * vector(seed + 12);
        let [origin, direction] = [target - direction, direction].map(|v| v.as_vec3().to_array());
        let ray = Ray::new(origin, direction);
        let quadrics = alone(quadric);
        let Some(hit) = quadrics.intersect(0, &ray) else { continue };
        hits += 1;

        let distance = capsule::distance_to_hit(&around, &ray, hit.t);
        assert!(
            distance <= f64::from(around.radius),
            "{index}: {quadric:?} {ray:?} {hit:?}: {distance} of {around:?}"
        );
    }
    assert!(thin > 10_000 && hits > 5_000, "{thin} thin, {hits} hits");
}

#[test]
fn eight_rays_meet_what_they_meet_one_by_one() {
    let (mut hits, mut misses) = (0, 0);
    for index in 0..20_000_u64 {
        let seed = index * 100;
        let size = power(seed + 1, 20.0);
        let z = [size * number(seed + 2), size * number(seed + 3)];
        let kind = match index % 5 {
            0 => QuadricKind::Sphere { radius: size, z },
            1 => QuadricKind::Cylinder { radius: size * power(seed + 4, 2.0), z },
            2 => QuadricKind::Disk { height: z[0], radius: size, inner_radius: 0.2 * size },
            3 => QuadricKind::Rectangle { size: [size, size * power(seed + 4, 3.0)] },
            _ => QuadricKind::Torus(Torus { radius: size, tube: size * power(seed + 4, 3.0) }),
        };
        let phi_max = if index % 2 == 0 { 360.0 } else { 180.0 + 180.0 * number(seed + 5) };
        let [x, y, axis] = [6, 7, 8].map(|axis| vector(seed + axis));
        let place = size * power(seed + 9, 5.0) * vector(seed + 10);
        let matrix = DMat4::from_cols(x.extend(0.0), y.extend(0.0), axis.extend(0.0), place.extend(1.0));
        let Some(quadric) = Quadric::new(kind, phi_max, &matrix, false) else { continue };
        let rays: [Ray; 8] = std::array::from_fn(|lane| {
            let seed = seed + 20 + 8 * lane as u64;
            let u = [number(seed), number(seed + 1)].map(|x| 0.5 * x as f32 + 0.5);
            let target = quadric.point_in_render(quadric.sample_in_object(u));
            let direction = size * power(seed + 2, 5.0) * vector(seed + 3);
            let [origin, direction] = [target - direction, direction].map(|v| v.as_vec3().to_array());
            Ray { t_max: if lane == 7 { 1.0 } else { f32::INFINITY }, ..Ray::new(origin, direction) }
        });
        let quadrics = alone(quadric);
        let wanted = (index % 256) as u32;
        let together = quadrics.intersect_eight(0, &rays.into(), wanted);
        for lane in (0..8).filter(|lane| wanted >> lane & 1 != 0) {
            let one = quadrics.intersect(0, &rays[lane]);
            let bits = |hit: Option<ProceduralHit>| hit.map(|hit| hit.t.to_bits());
            assert_eq!(bits(together[lane]), bits(one), "{index}: {quadric:?} {:?}", rays[lane]);
            *if one.is_some() { &mut hits } else { &mut misses } += 1;
        }
    }
    assert!(hits > 30_000 && misses > 5_000, "{hits} hits, {misses} misses");
}
