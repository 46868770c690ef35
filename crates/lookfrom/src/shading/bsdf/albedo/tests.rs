//! Tests of the tables of albedos against finer integration.

use super::*;
use crate::shading::bsdf::tests::number;

#[test]
fn tables_agree_with_finer_integration() {
    let mut worst = [0.0_f64; 2];
    for trial in 0..24 {
        let cos = number(31, trial).powi(2).max(0.01);
        let sin = (1.0 - cos * cos).sqrt();
        let wo = Vec3::new(sin, 0.0, cos);
        let roughness = 0.1 + 0.9 * number(32, trial);
        let alpha = roughness * roughness;
        let fibres = sheen::Sheen::new(roughness);
        // By many uniform directions.
        const N: usize = 250;
        let mut sums = [0.0_f64; 2];
        for k in 0..N * N {
            let u = [((k % N) as f32 + 0.5) / N as f32, ((k / N) as f32 + 0.5) / N as f32];
            let wi = Vec3::from(crate::core::warp::uniform_cone(u, 1.0));
            sums[0] += f64::from(fibres.f(wo, wi) * wi.z) * std::f64::consts::TAU;
            let facets = TrowbridgeReitz::new(alpha, alpha);
            let wm = facets.sample(wo.into(), u).into();
            let mirrored = math::reflect(wo, wm);
            if mirrored.z > 0.0 {
                sums[1] += f64::from(facets.g(wo.into(), mirrored.into()) / facets.g1(wo.into()));
            }
        }
        let [of_sheen, of_mirror] = sums.map(|sum| sum / (N * N) as f64);
        let error = [
            (f64::from(sheen(cos, roughness)) - of_sheen).abs(),
            (f64::from(mirror(cos, alpha).all()) - of_mirror).abs(),
        ];
        assert!(error[0] < 0.01, "sheen {cos} {roughness}: {of_sheen} ± {}", error[0]);
        assert!(error[1] < 0.006, "mirror {cos} {roughness}: {of_mirror} ± {}", error[1]);
        worst = std::array::from_fn(|k| worst[k].max(error[k]));
        assert!(of_sheen < 1.001, "sheen {cos} {roughness}: {of_sheen}");
    }
    assert!(worst[0] > 0.0);
}

#[test]
fn the_table_of_grain_agrees_with_finer_integration() {
    for trial in 0..200 {
        let cos = number(41, trial).powi(2).max(0.02);
        let sin = (1.0 - cos * cos).sqrt();
        let (s, c) = libm::sincosf(std::f32::consts::TAU * number(42, trial));
        let wo = Vec3::new(sin * c, sin * s, cos);
        let [along, across] = [43, 44].map(|seed| (0.1 + 0.9 * number(seed, trial)).powi(2));
        let facets = TrowbridgeReitz { alpha_x: along, alpha_y: across };
        const N: usize = 100;
        let seen = |k: usize| {
            let u = [((k % N) as f32 + 0.5) / N as f32, ((k / N) as f32 + 0.5) / N as f32];
            let wi = math::reflect(wo, facets.sample(wo.into(), u).into());
            match wi.z > 0.0 {
                true => f64::from(facets.g(wo.into(), wi.into()) / facets.g1(wo.into())),
                false => 0.0,
            }
        };
        let expected = (0..N * N).map(seen).sum::<f64>() / (N * N) as f64;
        let found = f64::from(anisotropic::mirror(wo.into(), facets).all());
        assert!((found - expected).abs() < 0.02, "{wo} {facets:?}: {found}, expected {expected}");
    }
    // Of equal roughness along both axes it is an isotropic reflector.
    for alpha in [0.04, 0.2, 0.7] {
        let facets = TrowbridgeReitz { alpha_x: alpha, alpha_y: alpha };
        let mean = [anisotropic::mirror_mean(facets), mirror_mean(alpha)].map(Split::all);
        assert!((mean[0] - mean[1]).abs() < 0.006, "{alpha}: {mean:?}");
    }
}
