//! Tests of shading normals: reflections stay outside, valid normals stay as they are.

use super::*;
use crate::core::hash;
use crate::core::math;

fn surface(wo: Vec3, ng: Vec3, ns: Vec3) -> ShadingGeometry {
    ShadingGeometry { ng, ns, dpdu: Vec3::X, dpdv: Vec3::Y, wo, front: ng.dot(wo) > 0.0 }
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
