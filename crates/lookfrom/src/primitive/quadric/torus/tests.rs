//! Tests of tori: meetings against a search along the line, areas against a sum over small parts.

use super::super::UNIT;
use super::super::tests::{number, power, vector};
use super::*;

/// A torus of any size and thickness.
fn torus(seed: u64) -> Torus {
    let radius = power(seed, 30.0);
    Torus { radius, tube: radius * power(seed + 1, 8.0) }
}

/// Meetings on a line whose parameters ascend, found by small steps: each to a part of the size, with nothing between.
fn search(torus: &Torus, origin: DVec3, direction: DVec3, steps: u32) -> Vec<f64> {
    let at = |s: f64| torus.distance(origin + s * direction).0;
    // From the sphere around it to its other side.
    let (middle, half) = (-origin.dot(direction), 1.001 * torus.size());
    let place = |step: u32| middle + half * (2.0 * f64::from(step) / f64::from(steps) - 1.0);
    let mut found = Vec::new();
    for step in 0..steps {
        let (mut low, mut high) = (place(step), place(step + 1));
        if (at(low) > 0.0) == (at(high) > 0.0) {
            continue;
        }
        for _ in 0..60 {
            let between = 0.5 * (low + high);
            *(if (at(low) > 0.0) == (at(between) > 0.0) { &mut low } else { &mut high }) = between;
        }
        found.push(low);
    }
    found
}

#[test]
fn meetings_are_those_that_a_search_finds() {
    let mut by_count = [0; 5];
    for index in 0..30_000_u64 {
        let seed = 100 * index;
        let torus = torus(seed);
        let size = torus.size();
        // Towards a point of the tube, or of the sphere around it.
        let angle = PI * number(seed + 2);
        let middle = torus.radius * DVec3::new(libm::cos(angle), libm::sin(angle), 0.0);
        let aimed = middle + 1.5 * torus.tube * vector(seed + 3);
        let target = if index % 3 == 0 { size * vector(seed + 4) } else { aimed };
        let direction = vector(seed + 5).normalize();
        let origin = target - size * power(seed + 6, 4.0) * direction;
        let speed = power(seed + 7, 20.0);

        let found: Vec<f64> =
            torus.meetings(origin, speed * direction).into_iter().map(|t| speed * t).collect();
        let expected = search(&torus, origin, direction, 600);
        // The search sees no grazing, and none of the gap that is smaller than its steps.
        let step = 2.002 * size / 600.0;
        let is_fine = found.windows(2).all(|pair| pair[1] - pair[0] > step);
        if is_fine || expected.len() > found.len() {
            assert_eq!(
                found.len(),
                expected.len(),
                "{index}: {torus:?} {origin} {direction}: {found:?} {expected:?}"
            );
        }
        by_count[found.len()] += 1;
        // The first of those from a place on, as a ray finds it.
        let t_min = (size * power(seed + 8, 4.0)) / speed;
        let line = [origin, speed * direction];
        let FirstMeetings { t, exist, are_unclear } = torus.first_meetings(line.map(Vector::from), t_min);
        let first = match are_unclear {
            true => torus.first_accepted(line, t_min, |t| *t > t_min),
            false => exist.then_some(t).filter(|t| *t > t_min),
        };
        let of_all = found.iter().map(|s| s / speed).find(|t| *t > t_min);
        match (first, of_all) {
            (Some(first), Some(of_all)) => assert!((first - of_all).abs() <= 1e-9 * size / speed, "{index}"),
            _ => assert_eq!(first, of_all, "{index}: {torus:?} {origin} {direction} {speed} {t_min}"),
        }
        assert!(found.is_sorted(), "{found:?}");
        for s in found {
            // On the surface, to the last step and units of rounding of the size and the distance.
            let off = torus.distance(origin + s * direction).0.abs();
            assert!(
                off <= FOUND * size + 16.0 * UNIT * (size + origin.length()),
                "{index}: {torus:?}: {off}"
            );
        }
    }
    assert!([0, 2, 4].iter().all(|&count| by_count[count] > 200), "{by_count:?}");
    assert_eq!([by_count[1], by_count[3]], [0, 0], "a line that comes from outside leaves again");
}

#[test]
fn points_are_on_the_surface_and_their_normals_across_it() {
    for index in 0..20_000_u64 {
        let seed = 50 * index;
        let torus = torus(seed);
        let [ring, z] = torus.sample(0.5 + 0.5 * number(seed + 2));
        let angle = PI * number(seed + 3);
        let near = DVec3::new(ring * libm::cos(angle), ring * libm::sin(angle), z)
            + 1e-9 * torus.tube * vector(seed + 4);
        let p = torus.refined(near);
        assert!(torus.distance(p).0.abs() <= 16.0 * UNIT * torus.size(), "{index}: {torus:?} {p}");
        assert!(p.distance(near) <= 4e-9 * torus.tube + 16.0 * UNIT * torus.size());
        assert!((torus.outward(p).length() - 1.0).abs() < 1e-14);
    }
}

#[test]
fn samples_are_uniform_over_the_area() {
    for index in 0..40_u64 {
        let torus = torus(50 * index);
        // The sum over thin rings of what is outside: not where the tube has crossed the axis.
        const RINGS: u32 = 20_000;
        let around = |ring: u32| TAU * (f64::from(ring) + 0.5) / f64::from(RINGS) - PI;
        let distance = |angle: f64| (torus.radius + torus.tube * libm::cos(angle)).max(0.0);
        let width = torus.tube * TAU / f64::from(RINGS);
        let area: f64 = (0..RINGS).map(|ring| distance(around(ring)) * width).sum();
        assert!((torus.area_by_angle() / area - 1.0).abs() < 1e-6, "{torus:?}");
        // The area up to a sample is its part of the whole.
        for u in [0.0, 1e-9, 0.1, 0.3, 0.5, 0.77, 0.999, 1.0 - 1e-12] {
            let [ring, z] = torus.sample(u);
            let end = libm::atan2(z, ring - torus.radius);
            let below: f64 = (0..RINGS)
                .map(around)
                .filter(|angle| *angle < end)
                .map(|angle| distance(angle) * width)
                .sum();
            assert!((below / area - u).abs() < 1e-3, "{torus:?}: {u}: {}", below / area);
        }
    }
}
