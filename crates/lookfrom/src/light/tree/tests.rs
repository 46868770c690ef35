//! Tests of the light tree: probabilities, bounds, lanes.

use lookfrom_simd::{Kernel, dispatch, level};

use super::*;
use crate::core::hash;
use crate::core::lanes::gather;

fn bundles(count: u32) -> Vec<(u32, LightBounds)> {
    let mut seed = 7_u32;
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / 16_777_216.0
    };
    (0..count)
        .map(|light| {
            let min = Vec3::new(next(), next(), next()) * 10.0;
            let bounds = LightBounds {
                min,
                max: min + Vec3::new(next(), next(), next()),
                normals: Cone {
                    axis: crate::core::warp::uniform_sphere([next(), next()]),
                    cos: 1.0 - next(),
                },
                cos_emission: 0.0,
                two_sided: light % 3 == 0,
                power: 0.1 + next(),
            };
            (light, bounds)
        })
        .collect()
}

/// Choices at eight points.
struct Eight<'a>(&'a Tree, &'a [(Vec3, Vec3, f32); LANES], u32);

impl Kernel for Eight<'_> {
    type Output = [Option<ChosenLight>; LANES];
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self(tree, at, mask) = self;
        let p = gather(simd, &by_lane!(lane => at[lane].0.to_array()));
        let n = gather(simd, &by_lane!(lane => at[lane].1.to_array()));
        let u = f32x8::load_array(simd, by_lane!(lane => at[lane].2));
        tree.sample_lanes(simd, p, n, u, mask)
    }
}

#[test]
fn eight_choices_at_once_are_eight_one_by_one() {
    let number = |k: u64, of: u64| (hash::pair(k, of) >> 40) as f32 / 16_777_216.0;
    let (mut chosen, mut none) = (0, 0);
    for count in [1, 2, 9, 300] {
        let tree = Tree::new(&bundles(count), count as usize);
        for round in 0..2000 {
            let at: [(Vec3, Vec3, f32); LANES] = std::array::from_fn(|lane| {
                let k = 8 * round + lane as u64;
                // From inside the boxes to far away, and also without a normal.
                let size = libm::exp2(f64::from(number(k, 0)) * 80.0 - 20.0) as f32;
                let p = Vec3::new(number(k, 1), number(k, 2), number(k, 3)) * size;
                let n = if k.is_multiple_of(5) {
                    Vec3::ZERO
                } else {
                    crate::core::warp::uniform_sphere([number(k, 4), number(k, 5)])
                };
                (p, n, number(k, 6))
            });
            let mask = hash::pair(round, 7) as u32 & 0xff;
            let together = dispatch(level(), Eight(&tree, &at, mask));
            for (lane, (p, n, u)) in at.into_iter().enumerate() {
                let alone = (mask & 1 << lane != 0).then(|| tree.sample(p, n, u)).flatten();
                assert_eq!(together[lane], alone, "{p} {n} {u}");
                chosen += u32::from(alone.is_some());
                none += u32::from(alone.is_none());
            }
        }
    }
    assert!(chosen > 10_000 && none > 10_000, "{chosen} chosen, {none} not");
}

#[test]
fn probabilities_sum_to_one_and_are_those_of_samples() {
    for count in [1, 2, 3, 17, 200] {
        let lights = bundles(count);
        let tree = Tree::new(&lights, count as usize);
        for (p, n) in [(Vec3::splat(5.0), Vec3::Y), (Vec3::new(-30.0, 2.0, 1.0), Vec3::X)] {
            let sum: f32 = (0..count).map(|light| tree.probability(p, n, light)).sum();
            assert!((sum - 1.0).abs() < 1e-4 || sum == 0.0, "{count} {sum}");
            for k in 0..500 {
                let u = (k as f32 + 0.5) / 500.0;
                let Some(ChosenLight { light, probability, .. }) = tree.sample(p, n, u) else { continue };
                assert!((probability - tree.probability(p, n, light)).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn near_lights_are_chosen_more_often() {
    let at = |x: f32| LightBounds {
        min: Vec3::new(x, 3.0, 0.0),
        max: Vec3::new(x, 3.0, 0.0),
        normals: Cone::ALL,
        cos_emission: 0.0,
        two_sided: false,
        power: 1.0,
    };
    let tree = Tree::new(&[(0, at(0.0)), (1, at(10.0))], 2);
    assert!(tree.probability(Vec3::ZERO, Vec3::Y, 0) > 0.9);
}

#[test]
fn a_thousand_lights_in_one_place_are_no_trouble() {
    let one = bundles(1)[0].1;
    let lights: Vec<(u32, LightBounds)> = (0..1000).map(|light| (light, one)).collect();
    let tree = Tree::new(&lights, 1000);
    let p = one.center() + one.normals.axis * 3.0;
    assert!((tree.probability(p, Vec3::Y, 500) - 1e-3).abs() < 1e-4);
}

#[test]
fn at_lights_and_far_away_all_numbers_are_finite() {
    let point = |x: f32, power: f32| LightBounds {
        min: Vec3::X * x,
        max: Vec3::X * x,
        normals: Cone::ALL,
        cos_emission: 0.0,
        two_sided: false,
        power,
    };
    for (apart, powers) in [(1.0, [1.0, 1e-30]), (1e-25, [1.0, 1.0]), (1e25, [1e-20, 1.0])] {
        let tree = Tree::new(&[(0, point(0.0, powers[0])), (1, point(apart, powers[1]))], 2);
        for x in [0.0, apart, 0.5 * apart, 1e-30, 1e-10, 3.0, 1e10, 1e30] {
            for n in [Vec3::X, Vec3::Y, Vec3::ZERO] {
                let [a, b] = [0, 1].map(|light| tree.probability(Vec3::X * x, n, light));
                assert!(a > 0.0 && b > 0.0 && (a + b - 1.0).abs() < 1e-5, "{x} {n}: {a} {b}");
            }
        }
    }
}

/// Brute-force reference for positive importance: rays from points of the box along directions that a normal
/// allows.
#[test]
fn whoever_may_shine_on_a_point_is_chosen_sometimes() {
    let mut seed = 3_u32;
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / 16_777_216.0
    };
    let lights = bundles(60);
    let tree = Tree::new(&lights, 60);
    for _ in 0..20_000 {
        let (light, bounds) = lights[(next() * 60.0) as usize];
        // a normal in the cone, and a direction in which it emits light
        let (s, t) = crate::core::warp::orthonormal_basis(bounds.normals.axis);
        let local = Vec3::from(crate::core::warp::uniform_cone([next(), next()], 1.0 - bounds.normals.cos));
        let mut normal = s * local.x + t * local.y + bounds.normals.axis * local.z;
        if bounds.two_sided && next() < 0.5 {
            normal = -normal;
        }
        let direction = crate::core::warp::cosine_hemisphere([next(), next()], normal);
        let from = bounds.min + (bounds.max - bounds.min) * Vec3::new(next(), next(), next());
        let p = from + direction * libm::exp2f(20.0 * next() - 10.0);
        if direction.dot(normal) > 1e-3 {
            let probability = tree.probability(p, crate::core::warp::uniform_sphere([next(), next()]), light);
            assert!(probability > 0.0, "{p} {bounds:?}");
        }
    }
}

#[test]
fn a_row_of_lights_is_divided_well() {
    let lights: Vec<(u32, LightBounds)> = (0..1024)
        .map(|light| {
            let at = Vec3::X * light as f32;
            let normals = Cone { axis: Vec3::Y, cos: 1.0 };
            (
                light,
                LightBounds { min: at, max: at, normals, cos_emission: 0.0, two_sided: false, power: 1.0 },
            )
        })
        .collect();
    let tree = Tree::new(&lights, 1024);
    let deepest = tree.ways.iter().flatten().map(|way| 64 - way.leading_zeros()).max();
    assert!(deepest <= Some(16), "{deepest:?}");
}
