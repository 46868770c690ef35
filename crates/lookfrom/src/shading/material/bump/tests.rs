//! Tests of shading normals: reflections stay outside, valid normals stay as they are.

use lookfrom_simd::{Kernel, Level, Simd, dispatch, f32x8, mask32x8, prelude::*};

use super::*;
use crate::core::hash;
use crate::core::lanes::{LANES, bitmask, by_lane, gather, scatter};
use crate::core::math;

fn surface(wo: Vec3, ng: Vec3, ns: Vec3) -> ShadingGeometry {
    ShadingGeometry {
        ng,
        ns,
        dpdu: Vec3::X,
        dpdv: Vec3::Y,
        derivatives: [Vec3::X, Vec3::Y],
        wo,
        front: ng.dot(wo) > 0.0,
    }
}

#[test]
fn mirrored_directions_stay_outside() {
    let mut kept = 0;
    for trial in 0..20_000 {
        let direction = |k: u64| {
            let number = |j: u64| (hash::pair(k * 8 + j, trial) >> 40) as f32 / 16_777_216.0;
            warp::uniform_sphere([number(0), number(1)])
        };
        let (wo, ng, n) = (direction(1), direction(2), direction(3));
        let surface = surface(wo, ng, n);
        let n = if n.dot(ng) < 0.0 && trial % 4 > 0 { -n } else { n };
        let got = valid(n, &surface);
        let height = |n: Vec3| math::reflect(wo, n).dot(surface.ng_facing());
        let least = (0.9 * wo.dot(surface.ng_facing())).min(0.01);
        assert!(got.is_normalized() && got.dot(ng) > 0.0, "{wo} {ng} {n}: {got}");
        assert!(height(got) > least - 1e-4, "{wo} {ng} {n}: {got} {}", height(got));
        assert!(got.dot(if surface.front { wo } else { -wo }) > 0.0);
        if n.dot(ng) > 0.0 && height(n) >= least {
            assert_eq!(got, n);
            kept += 1;
        } else if wo.dot(surface.ng_facing()) > 0.05 {
            // It is turned no further than needed: with a small step toward n, the reflected direction is
            // too low.
            let toward = (got + 0.01 * n * if n.dot(ng) > 0.0 { 1.0 } else { 0.0 }).normalize();
            assert!(n.dot(ng) <= 0.0 || height(toward) < least + 1e-3, "{wo} {ng} {n}: {got}");
        }
    }
    assert!(kept > 2000, "{kept}");
}

/// Bends eight frames, by the normals of normal maps and by limits.
struct Eight<'a> {
    surfaces: &'a [ShadingGeometry; LANES],
    locals: &'a [LocalNormal; LANES],
    limits: &'a [NormalLimit; LANES],
}

impl Kernel for Eight<'_> {
    type Output = [[[f32; 3]; LANES]; 3];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let alone = by_lane!(lane => Bending::from(&self.surfaces[lane]));
        let bending = Bending {
            ng_facing: gather(simd, &by_lane!(lane => alone[lane].ng_facing.into())),
            facing: f32x8::load_array(simd, by_lane!(lane => alone[lane].facing)),
            ns: gather(simd, &by_lane!(lane => alone[lane].ns.into())),
            dpdu: gather(simd, &by_lane!(lane => alone[lane].dpdu.into())),
            dpdv: gather(simd, &by_lane!(lane => alone[lane].dpdv.into())),
            wo: gather(simd, &by_lane!(lane => alone[lane].wo.into())),
        };
        let mask = |of: fn(&Self, usize) -> bool| {
            mask32x8::from_bitmask(simd, bitmask(&by_lane!(lane => of(&self, lane))).into())
        };
        let follow_dpdv = mask(|eight, lane| eight.locals[lane].follows_dpdv);
        let are_valid = mask(|eight, lane| eight.limits[lane].keeps_valid());
        let turn = mask(|eight, lane| eight.limits[lane].turns());
        let n = bending.mapped(gather(simd, &by_lane!(lane => self.locals[lane].n)), follow_dpdv);
        let n = bending.limited(n, are_valid, turn);
        let (s, t) = frame_about(n, bending.dpdu);
        [scatter(s), scatter(t), scatter(n)]
    }
}

#[test]
fn eight_frames_at_once_are_eight_one_by_one() {
    let mut levels = vec![Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    for round in 0..4000 {
        let number =
            |lane: usize, k: u64| (hash::pair(8 * round + lane as u64, k) >> 40) as f32 / 16_777_216.0;
        let direction = |lane: usize, k: u64| warp::uniform_sphere([number(lane, k), number(lane, k + 1)]);
        // Derivatives of any size, also none and along the normal; map normals of no length.
        let size = |lane: usize, k: u64| libm::exp2f(60.0 * number(lane, k) - 30.0);
        let surfaces: [_; LANES] = std::array::from_fn(|lane| {
            let (wo, ng) = (direction(lane, 0), direction(lane, 2));
            let ns = if number(lane, 4) < 0.7 {
                (ng + 0.5 * direction(lane, 5)).normalize()
            } else {
                direction(lane, 5)
            };
            let dpdu = match number(lane, 7) {
                u if u < 0.1 => Vec3::ZERO,
                u if u < 0.2 => ns,
                _ => size(lane, 8) * direction(lane, 9),
            };
            let dpdv = size(lane, 11) * direction(lane, 12);
            ShadingGeometry { ng, ns, dpdu, dpdv, derivatives: [dpdu, dpdv], wo, front: ng.dot(wo) > 0.0 }
        });
        let locals: [LocalNormal; LANES] = std::array::from_fn(|lane| {
            let n = match number(lane, 14) {
                u if u < 0.1 => [0.0; 3],
                u if u < 0.3 => [0.0, 0.0, 1.0],
                _ => [15, 16, 17].map(|k| 2.0 * number(lane, k) - 1.0),
            };
            LocalNormal { n, follows_dpdv: number(lane, 18) < 0.5 }
        });
        // Eight of one kind, and of several.
        let limits: [NormalLimit; LANES] = std::array::from_fn(|lane| {
            let lane = if round % 2 == 0 { 0 } else { lane };
            match number(lane, 19) {
                u if u < 0.25 => NormalLimit::Outward,
                u if u < 0.75 => NormalLimit::Guarded(BumpGuard { turns: u < 0.5, shadows: true }),
                _ => NormalLimit::Valid,
            }
        });
        for &level in &levels {
            let [s, t, n] = dispatch(level, Eight { surfaces: &surfaces, locals: &locals, limits: &limits });
            for lane in 0..LANES {
                let surface = &surfaces[lane];
                let (local, limit) = (locals[lane], limits[lane]);
                let bending = Bending::from(surface);
                let mapped = bending.mapped(local.n.into(), local.follows_dpdv);
                let limited = bending.limited(mapped, limit.keeps_valid(), limit.turns());
                let alone = around(limited.into(), surface.dpdu);
                let together = [s[lane], t[lane], n[lane]];
                assert_eq!(together, alone.axes(), "{surface:?} {local:?} {limit:?}");
            }
        }
    }
}

/// The neighbours of eight points, and their normals.
struct EightBumps<'a> {
    points: &'a [[f32; 14]; LANES],
}

/// The neighbours of a point and the normal there, of u and v, half a footprint, a step, two derivatives and three heights.
fn bumps<R: Real>(numbers: [R; 14], n: Vector<R>) -> [R; 7] {
    let [u, v, half_u, half_v, step, ux, uy, uz, vx, vy, vz, here, along_u, along_v] = numbers;
    let neighbours = Neighbours::new([u, v], [half_u, half_v], step);
    let derivatives = [Vector { x: ux, y: uy, z: uz }, Vector { x: vx, y: vy, z: vz }];
    let Neighbours { uv, steps } = neighbours;
    let n = displaced_normal(n, derivatives, steps, [here, along_u, along_v]);
    [uv[0], uv[1], steps[0], steps[1], n.x, n.y, n.z]
}

impl Kernel for EightBumps<'_> {
    type Output = [[f32; LANES]; 7];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let numbers = std::array::from_fn(
            #[inline(always)]
            |k| f32x8::load_array(simd, by_lane!(lane => self.points[lane][k])),
        );
        let n: Vector<f32x8<S>> = Vector::splat(numbers[0], [0.6, 0.0, 0.8]);
        bumps(numbers, n).map(Into::into)
    }
}

#[test]
fn eight_bumps_at_once_are_eight_one_by_one() {
    let mut levels = vec![Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    for round in 0..4000 {
        // Numbers of any size, now and then 0.
        let number = |lane: usize, k: u64| {
            let bits = hash::pair(8 * round + lane as u64, k);
            let size = libm::exp2f((bits % 41) as f32 - 20.0);
            if bits.is_multiple_of(23) { 0.0 } else { size * ((bits >> 40) as f32 / 8_388_608.0 - 1.0) }
        };
        let points: [[f32; 14]; LANES] = std::array::from_fn(|lane| {
            std::array::from_fn(|k| match k {
                2..=4 => number(lane, k as u64).abs(),
                _ => number(lane, k as u64),
            })
        });
        for &level in &levels {
            let together = dispatch(level, EightBumps { points: &points });
            for (lane, &numbers) in points.iter().enumerate() {
                let alone = bumps(numbers, Vector::from(Vec3::new(0.6, 0.0, 0.8)));
                let bits = |x: f32| if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() };
                assert_eq!(together.map(|column| bits(column[lane])), alone.map(bits), "{numbers:?}");
                if numbers[4] > 0.0 {
                    let [u, v, step_u, step_v, ..] = alone;
                    assert!(step_u > 0.0 && step_v > 0.0 && u > numbers[0] && v > numbers[1], "{numbers:?}");
                }
            }
        }
    }
}
