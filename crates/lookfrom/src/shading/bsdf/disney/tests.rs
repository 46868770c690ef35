use super::*;
use crate::shading::bsdf::Bsdf;

const BASE: [f32; 3] = [0.6, 0.3, 0.1];

fn solid(metallic: f32, clearcoat: f32, gloss: f32) -> Disney {
    let base = Spectrum([BASE[0], BASE[1], BASE[2], 0.0]);
    Disney {
        base,
        tint: base * (1.0 / crate::core::math::luminance(BASE)),
        roughness: 0.5,
        aspect: 1.0,
        eta: 1.5,
        spec_tint: 0.0,
        spec_trans: 0.0,
        sheen: 0.0,
        sheen_tint: 0.0,
        flatness: 0.0,
        is_thin: false,
        metallic,
        clearcoat,
        clearcoat_alpha: 0.1 - 0.099 * gloss,
        diff_trans: 0.0,
    }
}

/// Surfaces with all lobes, by name.
fn surfaces() -> [(&'static str, Disney); 6] {
    let aspect = |anisotropic: f32| (1.0 - 0.9 * anisotropic).sqrt();
    let plain = solid(0.0, 0.0, 0.0);
    // Mitsuba's index by `specular` 0.5.
    let root = 0.04_f32.sqrt();
    let plain = Disney { eta: (1.0 + root) / (1.0 - root), ..plain };
    [
        ("plain", plain),
        ("metal", Disney { roughness: 0.3, aspect: aspect(0.6), ..solid(0.7, 0.0, 0.0) }),
        (
            "tint",
            Disney { spec_tint: 0.5, sheen: 0.8, sheen_tint: 0.4, flatness: 0.3, roughness: 0.8, ..plain },
        ),
        ("glass", Disney { spec_trans: 0.8, eta: 1.4, roughness: 0.4, ..solid(0.1, 0.0, 0.0) }),
        ("coat", Disney { roughness: 0.6, ..solid(0.0, 0.9, 0.3) }),
        (
            "thin",
            Disney {
                spec_trans: 0.4,
                eta: 1.3,
                spec_tint: 0.3,
                sheen: 0.5,
                sheen_tint: 0.7,
                flatness: 0.2,
                aspect: aspect(0.4),
                is_thin: true,
                diff_trans: 0.3,
                ..plain
            },
        ),
    ]
}

/// Subjects of the tests of all BSDFs.
pub(in crate::shading::bsdf) fn subjects() -> Vec<(&'static str, Bsdf)> {
    let names = ["disney plain", "disney metal", "disney tint", "disney glass", "disney coat", "disney thin"];
    let of = surfaces();
    names.into_iter().zip(of.map(|(_, surface)| Bsdf::Disney(surface))).collect()
}

/// Values and densities of Mitsuba 3.9 (`scalar_rgb`), for directions toward the viewer and the light that are not normalised. What is no
/// glass is black from behind there, but not here.
#[test]
fn values_are_those_of_mitsuba() {
    let close = |a: f32, b: f32| (a - b).abs() <= 2e-4 * b.abs() + 1e-5;
    for (name, wo, wi, f, pdf) in [
        ("plain", [0.3, 0.2, 0.8], [-0.4, 0.1, 0.7], [0.214572, 0.119078, 0.0554144], 0.388262),
        ("plain", [0.3, 0.2, 0.8], [-0.1, -0.3, 0.9], [0.227639, 0.132146, 0.068484], 0.58001),
        ("plain", [0.9, 0.1, 0.2], [-0.8, 0.3, 0.3], [0.203266, 0.122662, 0.0689255], 0.100484),
        ("plain", [0.3, 0.2, 0.8], [-0.2, -0.1, -0.9], [0.0, 0.0, 0.0], 0.0),
        ("metal", [0.3, 0.2, 0.8], [-0.4, 0.1, 0.7], [0.0988302, 0.0500017, 0.0174493], 0.12708),
        ("metal", [0.3, 0.2, 0.8], [-0.1, -0.3, 0.9], [0.868188, 0.445439, 0.163607], 1.43149),
        ("metal", [0.9, 0.1, 0.2], [-0.8, 0.3, 0.3], [0.0528053, 0.0271161, 0.00998997], 0.0272685),
        ("metal", [0.3, 0.2, 0.8], [-0.2, -0.1, -0.9], [0.0, 0.0, 0.0], 0.0),
        ("tint", [0.3, 0.2, 0.8], [-0.4, 0.1, 0.7], [0.185413, 0.0948137, 0.0344143], 0.229391),
        ("tint", [0.3, 0.2, 0.8], [-0.1, -0.3, 0.9], [0.183613, 0.0938984, 0.0340889], 0.249316),
        ("tint", [0.9, 0.1, 0.2], [-0.8, 0.3, 0.3], [0.389072, 0.245688, 0.150099], 0.141688),
        ("tint", [0.3, 0.2, 0.8], [-0.2, -0.1, -0.9], [0.0, 0.0, 0.0], 0.0),
        ("glass", [0.3, 0.2, 0.8], [-0.4, 0.1, 0.7], [0.0810722, 0.0475004, 0.0251193], 0.161893),
        ("glass", [0.3, 0.2, 0.8], [-0.1, -0.3, 0.9], [0.141791, 0.0867916, 0.050125], 0.348545),
        ("glass", [0.9, 0.1, 0.2], [-0.8, 0.3, 0.3], [0.0556214, 0.0375545, 0.02551], 0.0318702),
        ("glass", [0.3, 0.2, 0.8], [-0.2, -0.1, -0.9], [4.88895, 3.45701, 1.99591], 10.1784),
        ("glass", [0.3, 0.2, -0.8], [-0.4, -0.1, 0.9], [0.514928, 0.364109, 0.210218], 0.428838),
        ("glass", [0.3, 0.2, -0.8], [-0.25, -0.3, -0.9], [0.0601823, 0.0601823, 0.0601823], 0.0767716),
        ("coat", [0.3, 0.2, 0.8], [-0.4, 0.1, 0.7], [0.220396, 0.124901, 0.061237], 0.334986),
        ("coat", [0.3, 0.2, 0.8], [-0.1, -0.3, 0.9], [0.236802, 0.141308, 0.0776461], 0.443183),
        ("coat", [0.9, 0.1, 0.2], [-0.8, 0.3, 0.3], [0.224431, 0.142869, 0.0884939], 0.119958),
        ("coat", [0.3, 0.2, 0.8], [-0.2, -0.1, -0.9], [0.0, 0.0, 0.0], 0.0),
        ("thin", [0.3, 0.2, 0.8], [-0.4, 0.1, 0.7], [0.078971, 0.0405006, 0.0148537], 0.187443),
        ("thin", [0.3, 0.2, 0.8], [-0.1, -0.3, 0.9], [0.083497, 0.0442123, 0.0180225], 0.319501),
        ("thin", [0.9, 0.1, 0.2], [-0.8, 0.3, 0.3], [0.121791, 0.0668592, 0.0302378], 0.0522868),
        ("thin", [0.3, 0.2, 0.8], [-0.2, -0.1, -0.9], [0.514047, 0.257023, 0.0856745], 0.450335),
        // The facet that would let this light pass faces away from it.
        ("thin", [0.9, 0.1, 0.2], [0.5, 0.3, -0.1], [0.0343775, 0.0171887, 0.0057296], 0.00968475),
        ("thin", [0.3, 0.2, -0.8], [-0.4, -0.1, 0.9], [0.622455, 0.311227, 0.103742], 0.505636),
        ("thin", [0.3, 0.2, -0.8], [-0.25, -0.3, -0.9], [0.0862996, 0.0463911, 0.0197855], 0.368296),
    ] {
        let found = surfaces().into_iter().find(|(of, _)| *of == name).map(|(_, surface)| surface);
        let surface = found.expect("a surface");
        let [wo, wi] = [wo, wi].map(|w: [f32; 3]| Vec3::from(w).normalize());
        let value = Bsdf::Disney(surface).f(wo, wi);
        for lane in 0..3 {
            assert!(close(value.0[lane], f[lane]), "{name} {wo} {wi}: {value:?} is not {f:?}");
        }
        let density = Bsdf::Disney(surface).pdf(wo, wi);
        assert!(close(density, pdf), "{name} {wo} {wi}: density {density} is not {pdf}");
    }
}
