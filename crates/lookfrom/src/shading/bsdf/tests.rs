//! Tests of BSDFs: densities, reciprocity, energy, Fresnel.

#[expect(unreachable_pub, reason = "as CONTRIBUTING.md has it")]
mod clay;
#[expect(unreachable_pub, reason = "as the table makes it")]
mod example;

use super::microfacet::TrowbridgeReitz;
use super::whitted::WhittedCoefficients;
use super::*;
use crate::core::hash;
use crate::core::parallel;
use crate::core::statistics::{chi_square_deviate, corrected_bound};
use lookfrom_scene::material::{self as written, Distribution, Masking};
use std::f32::consts::PI;
use std::f64::consts::TAU;

/// Numbers in [0, 1), a function of the seed and the index.
pub(super) fn number(seed: u64, index: u64) -> f32 {
    (hash::pair(seed, index) >> 40) as f32 / 16_777_216.0
}

/// Three numbers for the `index`-th sample.
pub(super) fn numbers(seed: u64, index: u64) -> (f32, [f32; 2]) {
    let of = |k| number(seed, index * 3 + k);
    (of(0), [of(1), of(2)])
}

/// The direction at these angles to the z and x axes.
pub(super) fn direction(theta_degrees: f32, phi_degrees: f32) -> Vec3 {
    let (sin_theta, cos_theta) = theta_degrees.to_radians().sin_cos();
    let (sin_phi, cos_phi) = phi_degrees.to_radians().sin_cos();
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta).normalize()
}

/// A uniform direction of the sphere.
pub(super) fn uniform_direction(u: [f32; 2]) -> Vec3 {
    crate::core::warp::uniform_sphere(u)
}

/// A positive number of any magnitude: its exponent is uniform in ±`size`.
fn any_size(seed: u64, index: u64, size: i32) -> f32 {
    let bits = hash::pair(seed, index);
    let exponent = (bits % (2 * size as u64 + 1)) as i32 - size;
    2_f32.powi(exponent) * (1.0 + (bits >> 41) as f32 / 8_388_608.0)
}

fn grey(value: f32) -> Spectrum {
    Spectrum([value; 4])
}

fn gold() -> (Spectrum, Spectrum) {
    (Spectrum([0.143, 0.374, 1.442, 0.2]), Spectrum([3.983, 2.385, 1.603, 3.0]))
}

fn rough(x: f32, y: f32) -> TrowbridgeReitz {
    TrowbridgeReitz::new(x, y)
}

/// Facets of a distribution, with a masking.
fn of_kind(x: f32, y: f32, distribution: Distribution, masking: Masking) -> Microfacets {
    Microfacets::new(rough(x, y), written::Microfacets { distribution, masking })
}

fn beckmann(x: f32, y: f32) -> Microfacets {
    of_kind(x, y, Distribution::Beckmann, Masking::Correlated)
}

fn separable(x: f32, y: f32) -> Microfacets {
    of_kind(x, y, Distribution::TrowbridgeReitz, Masking::Separable)
}

fn stained(eta: f32, facets: Microfacets) -> Bsdf {
    let tint = tinted::Tint {
        reflectance: Spectrum([0.9, 0.6, 0.3, 0.5]),
        transmittance: Spectrum([0.2, 0.5, 0.8, 0.4]),
    };
    Bsdf::TintedDielectric(tinted::TintedDielectric { boundary: Dielectric::new(eta, facets), tint })
}

fn plastic(reflectance: f32, is_nonlinear: bool, facets: Microfacets) -> Bsdf {
    let interface = plastic::Interface::kept(1.5, facets);
    Bsdf::Plastic(plastic::Plastic::new(grey(reflectance), grey(0.8), is_nonlinear, interface))
}

fn hair(h: f32, betas: [f32; 2]) -> Bsdf {
    Bsdf::Hair(hair::Hair::new(h, 1.55, Spectrum([0.2, 0.4, 0.8, 0.1]), betas, 2.0))
}

/// A material of tables made here, seen from so many azimuths: facets of several slopes, most of them flat.
pub(super) fn measured(azimuths: usize) -> Bsdf {
    use lookfrom_scene::measured::{Adaptive, Measured, Table, Tables};
    let theta = vec![0.0, 0.7, 1.5];
    let phi: Vec<f32> =
        (0..azimuths).map(|k| -PI + TAU as f32 * k as f32 / (azimuths.max(2) - 1) as f32).collect();
    let table = |size: [usize; 2], count: usize, value: &dyn Fn(u64, usize, usize) -> f32| Table {
        size,
        values: (0..count)
            .flat_map(|k| (0..size[0] * size[1]).map(move |place| (k, place)))
            .map(|(k, place)| value(k as u64, place % size[0], place / size[0]))
            .collect(),
    };
    let count = azimuths * theta.len();
    let seed = azimuths as u64;
    // The last azimuth is the first.
    let around = |k: u64| k % (count as u64 - if azimuths > 1 { 3 } else { 0 }).max(1);
    let tables = Adaptive {
        ndf: table([9, 4], 1, &|_, x, _| 0.4 - 0.04 * x as f32),
        sigma: table([5, 2], 1, &|_, x, _| 1.0 - 0.2 * x as f32),
        vndf: table([7, 6], count, &|k, x, y| {
            let rings = x as f32 * (7.0 - x as f32);
            rings * (0.5 + number(seed, around(k) + 90 * (x as u64 + 9 * (y as u64 % 5))))
        }),
        luminance: table([4, 5], count, &|k, x, y| {
            0.4 + number(seed + 1, around(k) + 90 * (x + 9 * y) as u64)
        }),
        spectra: table([4, 5], 2 * count, &|k, x, y| {
            0.1 * number(seed + 2, around(k / 2) + 90 * (x + 9 * y) as u64)
        }),
        phi,
        theta,
        wavelengths: vec![400.0, 700.0],
    };
    let written = Measured {
        tables: Tables::Adaptive(Box::new(tables)),
        digest: format!("made for tests, {azimuths}"),
    };
    assert!(written.is_consistent());
    let tables = measured::MeasuredTables::kept(&written, &[[0.2, 0.3, 0.9], [0.8, 0.7, 0.1]]);
    Bsdf::Measured(measured::Measured::new(tables, None))
}

/// A material by half vectors: gloss with a colour on a matte ground, without light beside its horizon.
pub(super) fn merl() -> Bsdf {
    use lookfrom_scene::measured::{HalfAngle, Measured, Tables};
    let counts = [12, 9, 10];
    let value = |cell: usize| {
        let (h, d, phi) = (cell / 90, cell / 10 % 9, cell % 10);
        let gloss = 0.3 * (-(h as f32).powi(2) / 18.0).exp() * (1.0 + 0.1 * d as f32);
        [0.1 + gloss, 0.1 + 0.7 * gloss, if h > 9 { 0.0 } else { 0.05 + 0.01 * phi as f32 }]
    };
    let values = (0..counts.iter().product()).map(value).collect();
    let tables = Tables::HalfAngle(HalfAngle { counts, values });
    let written = Measured { tables, digest: "made for tests, half vectors".into() };
    Bsdf::Measured(measured::Measured::new(measured::MeasuredTables::kept(&written, &[]), None))
}

fn whitted() -> WhittedCoefficients {
    WhittedCoefficients {
        ambient: Spectrum::BLACK,
        diffuse: Spectrum([0.5, 0.2, 0.1, 0.0]),
        specular: grey(0.4),
        shininess: 30.0,
        mirror: grey(0.1),
        transmission: grey(0.2),
        ior: 1.5,
        fresnel: true,
    }
}

/// BSDFs that have a density, and their names for failure messages.
fn with_density() -> Vec<(&'static str, Bsdf)> {
    let (eta, k) = gold();
    let of_gold = |x, y| Bsdf::conductor(eta, k, rough(x, y));
    let mut subjects = vec![
        ("diffuse", Bsdf::diffuse(Spectrum([0.7, 0.5, 0.3, 0.0]))),
        ("leaf", Bsdf::diffuse_transmission(grey(0.3), grey(0.6))),
        ("white metal 0.5", Bsdf::conductor(grey(1.0), grey(1e8), rough(0.5, 0.5))),
        ("gold 0.1", of_gold(0.1, 0.1)),
        ("gold 0.4 × 0.1", of_gold(0.4, 0.1)),
        ("gold 1 × 0.3", of_gold(1.0, 0.3)),
        (
            "green gold 0.5",
            Bsdf::Conductor(
                Conductor::new(eta, k, rough(0.5, 0.5))
                    .with_specular_reflectance(Spectrum([0.3, 0.9, 0.2, 0.5])),
            ),
        ),
        ("glass 0.5", Bsdf::dielectric(1.5, rough(0.5, 0.5))),
        ("stained glass 0.4", stained(1.5, rough(0.4, 0.4).into())),
        ("glass 0.15", Bsdf::dielectric(1.5, rough(0.15, 0.15))),
        ("glass 0.3 × 0.6", Bsdf::dielectric(1.5, rough(0.3, 0.6))),
        ("bubble 0.4", Bsdf::dielectric(1.0 / 1.33, rough(0.4, 0.4))),
        ("conserving gold 0.7 × 0.2", of_gold(0.7, 0.2).with_energy(Energy::Conserved)),
        ("conserving glass 0.6", Bsdf::dielectric(1.5, rough(0.6, 0.6)).with_energy(Energy::Conserved)),
        ("conserving bubble 0.3", Bsdf::dielectric(0.75, rough(0.3, 0.3)).with_energy(Energy::Conserved)),
        ("beckmann gold 0.4 × 0.1", Bsdf::conductor(eta, k, beckmann(0.4, 0.1))),
        ("beckmann glass 0.3", Bsdf::dielectric(1.5, beckmann(0.3, 0.3))),
        ("beckmann bubble 0.6", Bsdf::dielectric(0.7, beckmann(0.6, 0.6))),
        (
            "conserving beckmann glass",
            Bsdf::dielectric(1.5, beckmann(0.4, 0.2)).with_energy(Energy::Conserved),
        ),
        ("separable gold 0.6", Bsdf::conductor(eta, k, separable(0.6, 0.6))),
        (
            "separable beckmann glass",
            Bsdf::dielectric(1.5, of_kind(0.5, 0.5, Distribution::Beckmann, Masking::Separable)),
        ),
        ("smooth plastic", plastic(0.6, true, rough(0.0, 0.0).into())),
        ("plastic 0.2", plastic(0.6, true, rough(0.2, 0.2).into())),
        ("beckmann plastic 0.4", plastic(0.3, false, beckmann(0.4, 0.4))),
        ("black plastic 0.5", plastic(0.0, false, separable(0.5, 0.5))),
        ("hair", hair(0.3, [0.3, 0.3])),
        ("hair rough", hair(-0.8, [0.6, 0.8])),
        ("measured", measured(1)),
        ("measured grain", measured(5)),
        ("half vectors", merl()),
        ("whitted", Bsdf::Whitted(whitted())),
        ("whitted dull", Bsdf::Whitted(WhittedCoefficients { shininess: 2.0, fresnel: false, ..whitted() })),
    ];
    subjects.extend(principled::tests::subjects());
    subjects.extend(open_pbr::tests::subjects());
    subjects.extend(disney::tests::subjects());
    subjects
}

/// A roughness with one of all kinds of facets.
pub(super) fn of_any_kind(index: u64, roughness: TrowbridgeReitz) -> Microfacets {
    let distribution =
        if index.is_multiple_of(2) { Distribution::TrowbridgeReitz } else { Distribution::Beckmann };
    let masking = if (index / 2).is_multiple_of(2) { Masking::Correlated } else { Masking::Separable };
    Microfacets::new(roughness, written::Microfacets { distribution, masking })
}

/// From above, from the side, nearly grazing, and from inside.
fn views() -> [Vec3; 6] {
    [
        Vec3::Z,
        direction(35.0, 20.0),
        direction(70.0, 130.0),
        direction(87.0, 250.0),
        direction(125.0, 60.0),
        direction(170.0, 300.0),
    ]
}

/// The integral over a cell of the sphere in z and φ, by four-point Gaussian quadrature, subdivided adaptively.
fn integrate(f: &dyn Fn(Vec3) -> f64, z: [f64; 2], phi: [f64; 2], tolerance: f64, depth: u32) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_8),
        (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_8),
    ];
    let rule = |z: [f64; 2], phi: [f64; 2]| {
        let mut sum = 0.0;
        for (a, weight_a) in NODES {
            for (b, weight_b) in NODES {
                let at = 0.5 * (z[0] + z[1] + a * (z[1] - z[0]));
                let turn = 0.5 * (phi[0] + phi[1] + b * (phi[1] - phi[0]));
                let sin = (1.0 - at * at).max(0.0).sqrt();
                let w = Vec3::new((sin * turn.cos()) as f32, (sin * turn.sin()) as f32, at as f32);
                sum += weight_a * weight_b * f(w);
            }
        }
        0.25 * sum * (z[1] - z[0]) * (phi[1] - phi[0])
    };
    let (zm, phim) = (0.5 * (z[0] + z[1]), 0.5 * (phi[0] + phi[1]));
    let quarters = [
        ([z[0], zm], [phi[0], phim]),
        ([z[0], zm], [phim, phi[1]]),
        ([zm, z[1]], [phi[0], phim]),
        ([zm, z[1]], [phim, phi[1]]),
    ];
    let fine: f64 = quarters.iter().map(|&(z, phi)| rule(z, phi)).sum();
    if depth == 0 || (fine - rule(z, phi)).abs() < tolerance {
        return fine;
    }
    quarters.iter().map(|&(z, phi)| integrate(f, z, phi, 0.5 * tolerance, depth - 1)).sum()
}

const ROWS: usize = 24;
const COLUMNS: usize = 24;

/// The integral over each cell of the sphere: rows in z, columns in φ.
fn over_cells(f: &dyn Fn(Vec3) -> f64, tolerance: f64) -> Vec<f64> {
    let z = |row: usize| 1.0 - 2.0 * row as f64 / ROWS as f64;
    let phi = |column: usize| TAU * column as f64 / COLUMNS as f64;
    (0..ROWS * COLUMNS)
        .map(|cell| {
            let (row, column) = (cell / COLUMNS, cell % COLUMNS);
            integrate(f, [z(row + 1), z(row)], [phi(column), phi(column + 1)], tolerance, 9)
        })
        .collect()
}

fn cell(w: Vec3) -> usize {
    let row = (0.5 * (1.0 - f64::from(w.z)) * ROWS as f64) as usize;
    let turn = f64::from(w.y).atan2(f64::from(w.x)) / TAU;
    let column = ((if turn < 0.0 { turn + 1.0 } else { turn }) * COLUMNS as f64) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

#[test]
fn samples_are_as_dense_as_they_say() {
    let subjects = with_density();
    let bound = corrected_bound(subjects.len() * views().len());
    let faults = parallel::collect(subjects.len(), |subject| {
        let (name, bsdf) = &subjects[subject];
        let mut faults = Vec::new();
        // BSDFs of many lobes are costly: fewer samples.
        let is_costly =
            ["principled", "openpbr", "disney", "conserving"].iter().any(|kind| name.starts_with(kind));
        // Refraction to the wrong side has a sharp ridge, of which quadrature misses a part.
        let missed = if name.starts_with("conserving") { 2e-4 } else { 1e-5 };
        let n: u64 = if is_costly { 300_000 } else { 1_000_000 };
        for (view, wo) in views().into_iter().enumerate() {
            if is_costly && (view + subject) % 2 == 1 {
                continue;
            }
            let seed = (subject * 100 + view) as u64;
            let what = format!("{name} from {wo}");
            let mut counts = vec![0_u64; ROWS * COLUMNS + 1];
            let (mut sum, mut squares) = (0.0, 0.0);
            for index in 0..n {
                let (uc, u) = numbers(seed, index);
                let sample = bsdf.sample(wo, uc, u, Mode::Importance, Lobes::ALL);
                let Some(sample) = sample.filter(|s| !s.lobe.is_specular()) else {
                    counts[ROWS * COLUMNS] += 1;
                    continue;
                };
                counts[cell(sample.wi)] += 1;
                let weight = f64::from(sample.f.0[0] * sample.wi.z.abs() / sample.pdf);
                sum += weight;
                squares += weight * weight;
            }
            // Counts against the density; samples without a density are counted in a cell of their own.
            let pdf = |wi| f64::from(bsdf.pdf(wo, wi, Mode::Importance, Lobes::ALL));
            let mut expected = over_cells(&pdf, 3e-7);
            expected.push((1.0 - expected.iter().sum::<f64>()).max(1e-9));
            expected.iter_mut().for_each(|e| *e *= n as f64);
            let deviate = chi_square_deviate(&counts, &expected);
            if !(deviate < bound) {
                faults.push(format!("{what}: {deviate:.1} standard deviations, {bound:.1} are allowed"));
            }
            // The mean weight against the integral that it estimates.
            let value = |wi: Vec3| f64::from(bsdf.f(wo, wi, Mode::Importance).0[0] * wi.z.abs());
            let integral: f64 = over_cells(&value, 3e-7).iter().sum();
            let mean = sum / n as f64;
            let error = ((squares / n as f64 - mean * mean).max(0.0) / n as f64).sqrt();
            if !((mean - integral).abs() < bound * error + missed) {
                faults.push(format!("{what}: mean weight {mean} ± {error}, integral {integral}"));
            }
            if !name.starts_with("whitted") && !(integral < 1.0 + 1e-4) {
                faults.push(format!("{what}: more light out than in: {integral}"));
            }
        }
        faults
    })
    .concat();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn samples_carry_the_values_of_f_and_pdf() {
    let close = |a: f32, b: f32| (a - b).abs() <= 4e-3 * a.abs().max(b.abs()) + 1e-6;
    let mut checked = 0;
    for (name, bsdf) in with_density() {
        for wo in views() {
            for lobes in [Lobes::ALL, Lobes::REFLECTION, Lobes::TRANSMISSION] {
                for mode in [Mode::Radiance, Mode::Importance] {
                    for index in 0..400 {
                        let (uc, u) = numbers(3, index);
                        let Some(sample) = bsdf.sample(wo, uc, u, mode, lobes) else { continue };
                        assert!(lobes.contains(sides(sample.lobe)), "{name}");
                        assert!((sample.wi.length() - 1.0).abs() < 1e-5, "{name} {}", sample.wi);
                        let through = wo.z * sample.wi.z < 0.0;
                        assert_eq!(through, sample.lobe.is_transmission(), "{name}");
                        if sample.lobe.is_specular() {
                            continue;
                        }
                        let f = bsdf.f(wo, sample.wi, mode);
                        let pdf = bsdf.pdf(wo, sample.wi, mode, lobes);
                        assert!(close(f.0[0], sample.f.0[0]), "{name} {wo} {sample:?}: f = {f:?}");
                        assert!(close(pdf, sample.pdf), "{name} {wo} {sample:?}: pdf = {pdf}");
                        checked += 1;
                    }
                }
            }
        }
    }
    assert!(checked > 50_000, "{checked}");
}

#[test]
fn light_goes_both_ways() {
    let mut non_zero = 0;
    // Not reciprocal: tables of numbers, hair, Whitted's highlight, a coat with a normal of its own (whose cosines are to another normal),
    // OpenPBR's fuzz and the darkening by its coat, the facets of Disney's sheet, which face light as Mitsuba has it, and rough surfaces that conserve energy, as the glass of principled bodies does.
    let is_not = |name: &str| {
        name.starts_with("whitted")
            || name.starts_with("conserving")
            || name.starts_with("hair")
            || name.starts_with("measured")
            || name.contains("tilted")
            || name.contains("fuzz")
            || name.contains("darkened")
            || ["principled body", "principled everything", "openpbr body", "disney thin"].contains(&name)
    };
    for (name, bsdf) in with_density().into_iter().filter(|(name, _)| !is_not(name)) {
        for index in 0..4000 {
            let of = |k: u64| uniform_direction([number(5, index * 4 + k), number(5, index * 4 + k + 2)]);
            let (wo, wi) = (of(0), of(1));
            let [there, back] = [
                bsdf.f(wo, wi, Mode::Importance).0[0],
                // Radiance through a boundary is the adjoint of importance; reflection does not
                // depend on the mode.
                bsdf.f(wi, wo, Mode::Radiance).0[0],
            ];
            // Where nearly all light is reflected, the transmitted part is a difference of almost
            // equal numbers.
            assert!(
                (there - back).abs() <= 2e-3 * there.max(back) + 1e-5,
                "{name} {wo} {wi}: {there} {back}"
            );
            non_zero += u32::from(there > 0.0);
        }
    }
    assert!(non_zero > 10_000);
}

#[test]
fn refraction_scales_radiance_by_the_index_squared() {
    for roughness in [TrowbridgeReitz::SMOOTH, rough(0.2, 0.2)] {
        let bsdf = Bsdf::dielectric(1.5, roughness);
        for (wo, eta) in [(direction(30.0, 10.0), 1.5_f32), (direction(160.0, 10.0), 1.0 / 1.5)] {
            let sample = |mode| bsdf.sample(wo, 0.999, [0.3, 0.7], mode, Lobes::ALL).unwrap();
            let (radiance, importance) = (sample(Mode::Radiance), sample(Mode::Importance));
            assert!(radiance.lobe.is_transmission());
            assert!((radiance.eta - eta).abs() < 1e-6);
            let ratio = importance.f.0[0] / radiance.f.0[0];
            assert!((ratio / (eta * eta) - 1.0).abs() < 1e-5, "{ratio}");
        }
    }
}

#[test]
fn nothing_is_lost_in_a_white_furnace() {
    let weight = |s: &BsdfSample| s.f.0[0] * s.wi.z.abs() / s.pdf;
    for wo in views() {
        // BSDFs that reflect all light have weights of one.
        let white = [
            Bsdf::diffuse(grey(1.0)),
            Bsdf::diffuse_transmission(grey(0.4), grey(0.6)),
            Bsdf::conductor(grey(1.0), grey(1e8), TrowbridgeReitz::SMOOTH),
            Bsdf::dielectric(1.5, TrowbridgeReitz::SMOOTH),
            Bsdf::dielectric(0.7, TrowbridgeReitz::SMOOTH),
            Bsdf::dielectric(1.0, rough(0.3, 0.3)),
            Bsdf::thin_dielectric(1.5),
        ];
        for bsdf in white {
            for index in 0..100 {
                let (uc, u) = numbers(7, index);
                let sample = bsdf.sample(wo, uc, u, Mode::Importance, Lobes::ALL).unwrap();
                assert!((weight(&sample) - 1.0).abs() < 1e-5, "{bsdf:?} {wo} {sample:?}");
            }
        }
    }
    // Sampling restricted to one side returns that side's part.
    for bsdf in [Bsdf::dielectric(1.5, TrowbridgeReitz::SMOOTH), Bsdf::thin_dielectric(1.5)] {
        let part = |side| {
            let sample = bsdf.sample(direction(60.0, 0.0), 0.5, [0.5; 2], Mode::Importance, side).unwrap();
            assert_eq!(sample.pdf, 1.0);
            weight(&sample)
        };
        let (r, t) = (part(Lobes::REFLECTION), part(Lobes::TRANSMISSION));
        assert!(r > 0.08 && r < 0.2 && (r + t - 1.0).abs() < 1e-6, "{r} {t}");
    }
}

#[test]
fn rough_surfaces_that_conserve_energy_stay_white() {
    const N: usize = 64;
    for trial in 0..60 {
        let of = |seed| number(seed, trial);
        let wo = uniform_direction([of(70), of(71)]);
        let roughness = rough(of(72).powi(2), if of(73) < 0.5 { of(72).powi(2) } else { of(74).powi(2) });
        let eta = 0.4 + 2.1 * of(75);
        let albedo = |bsdf: Bsdf, energy| {
            let bsdf = bsdf.with_energy(energy);
            let weight = |k: usize| {
                let u = [(k % N) as f32 + 0.5, (k / N) as f32 + 0.5].map(|x| x / N as f32);
                let sample = bsdf.sample(wo, number(76, k as u64), u, Mode::Importance, Lobes::ALL);
                sample.map_or(0.0, |s| f64::from(s.f.0[0] * s.wi.z.abs() / s.pdf))
            };
            (0..N * N).map(weight).sum::<f64>() / (N * N) as f64
        };
        // By a table, linear between its entries.
        let metal = Bsdf::conductor(grey(1.0), grey(1e8), roughness);
        let error = albedo(metal, Energy::Conserved) - 1.0;
        assert!(error.abs() < 0.02, "{roughness:?} {wo}: {error}");
        // Without a table.
        let error = albedo(Bsdf::dielectric(eta, roughness), Energy::Conserved) - 1.0;
        assert!(error.abs() < 1e-3, "{roughness:?} {eta} {wo}: {error}");
        for bsdf in [metal, Bsdf::dielectric(eta, roughness)] {
            assert!(albedo(bsdf, Energy::SingleScattering) < 1.0 + 1e-4);
        }
    }
    let dark = |energy| {
        let (eta, k) = gold();
        let bsdf = Bsdf::conductor(eta, k, rough(0.9, 0.9)).with_energy(energy);
        bsdf.f(direction(40.0, 0.0), direction(20.0, 180.0), Mode::Radiance)
    };
    // A factor of what facets reflect is one of all light that they reflect once.
    let (eta, k) = gold();
    let factor = Spectrum([0.3, 0.9, 0.2, 0.5]);
    let [plain, tinted] = [Spectrum([1.0; 4]), factor].map(|factor| {
        let bsdf = Bsdf::Conductor(Conductor::new(eta, k, rough(0.9, 0.9)).with_specular_reflectance(factor));
        bsdf.f(direction(40.0, 0.0), direction(20.0, 180.0), Mode::Radiance)
    });
    let close = |lane: usize| (tinted.0[lane] - plain.0[lane] * factor.0[lane]).abs() < 1e-6 * plain.0[lane];
    assert!((0..4).all(close), "{tinted:?} {plain:?}");
    // What facets reflect twice is twice coloured.
    let gains = [0, 2].map(|lane| dark(Energy::Conserved).0[lane] / dark(Energy::SingleScattering).0[lane]);
    assert!(gains[0] > gains[1] && gains[1] > 1.0, "{gains:?}");
}

#[test]
fn a_pane_reflects_the_sum_of_its_two_sides() {
    // R' = 2R / (1 + R) for two sides that reflect R each.
    let wo = direction(50.0, 0.0);
    let once = f64::from(fresnel::dielectric(wo.z, 1.5));
    let sample = Bsdf::thin_dielectric(1.5).sample(wo, 0.0, [0.0; 2], Mode::Radiance, Lobes::ALL).unwrap();
    assert!((f64::from(sample.pdf) - 2.0 * once / (1.0 + once)).abs() < 1e-6);
    let through = Bsdf::thin_dielectric(1.5).sample(wo, 0.9, [0.0; 2], Mode::Radiance, Lobes::ALL).unwrap();
    assert_eq!((through.wi, through.eta), (-wo, 1.0));
}

/// Fresnel's formulas in complex arithmetic, in f64.
fn fresnel_complex(cos: f64, eta: f64, k: f64) -> f64 {
    type Complex = (f64, f64);
    let mul = |a: Complex, b: Complex| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let div = |a: Complex, b: Complex| {
        let n = b.0 * b.0 + b.1 * b.1;
        ((a.0 * b.0 + a.1 * b.1) / n, (a.1 * b.0 - a.0 * b.1) / n)
    };
    let sqrt = |a: Complex| {
        let r = a.0.hypot(a.1);
        let re = (0.5 * (r + a.0.abs())).sqrt();
        let other = if re == 0.0 { 0.0 } else { 0.5 * a.1.abs() / re };
        if a.0 >= 0.0 { (re, other.copysign(a.1)) } else { (other, re.copysign(a.1)) }
    };
    let n: Complex = (eta, k);
    let sin2_t = div((1.0 - cos * cos, 0.0), mul(n, n));
    let cos_t = sqrt((1.0 - sin2_t.0, -sin2_t.1));
    let across = |a: Complex, b: Complex| {
        let r = div((a.0 - b.0, a.1 - b.1), (a.0 + b.0, a.1 + b.1));
        r.0 * r.0 + r.1 * r.1
    };
    let parallel = across((n.0 * cos, n.1 * cos), cos_t);
    let perpendicular = across((cos, 0.0), mul(n, cos_t));
    0.5 * (parallel + perpendicular)
}

#[test]
fn metals_mirror_what_complex_numbers_say() {
    for trial in 0..20_000 {
        let (eta, k) = (any_size(11, trial, 12), any_size(12, trial, 12));
        let cos = any_size(13, trial, 20).min(1.0);
        let got = fresnel::conductor(cos, grey(eta), grey(k)).0[2];
        let expected = fresnel_complex(f64::from(cos), f64::from(eta), f64::from(k));
        assert!((f64::from(got) - expected).abs() < 1e-5, "{eta} {k} {cos}: {got} {expected}");
    }
}

#[test]
fn known_reflectances() {
    // ((η − 1)² + k²) / ((η + 1)² + k²), at normal incidence.
    let (eta, k) = gold();
    let straight = fresnel::conductor(1.0, eta, k);
    for (lane, expected) in [0.9662, 0.8009, 0.3232].into_iter().enumerate() {
        let (eta, k) = (eta.0[lane], k.0[lane]);
        let formula = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
        assert!((straight.0[lane] - formula).abs() < 1e-5);
        assert!((formula - expected).abs() < 3e-3, "{formula}");
    }
    // All metals reflect all light at grazing incidence.
    assert!((fresnel::conductor(0.0, eta, k).0[1] - 1.0).abs() < 1e-6);
    // A metal made from a reflectance has that reflectance.
    for r in [0.0, 0.02, 0.5, 0.99] {
        let (eta, k) = fresnel::conductor_of_reflectance(grey(r));
        assert!((fresnel::conductor(1.0, eta, k).0[0] - r).abs() < 1e-5);
    }
    // An unused lane of zeros stays finite.
    assert!(fresnel::conductor(1.0, Spectrum::BLACK, Spectrum::BLACK).0[3].is_finite());
    // Glass from inside, at normal incidence and beyond the critical angle.
    assert!((fresnel::dielectric(-1.0, 1.5) - 0.04).abs() < 1e-6);
    assert_eq!(fresnel::dielectric(-0.5, 1.5), 1.0);
}

#[test]
fn roughness_is_as_in_pbrt() {
    let lobe = |x, y| Bsdf::conductor(grey(1.0), grey(3.0), rough(x, y)).lobes();
    assert!(lobe(0.0009, 0.0).is_specular());
    // One rough direction is sufficient.
    assert!(!lobe(0.0011, 0.0).is_specular());
    assert_eq!(TrowbridgeReitz::from_roughness([0.25, 0.04], true), rough(0.5, 0.2));
    assert_eq!(TrowbridgeReitz::from_roughness([0.25, 0.04], false), rough(0.25, 0.04));
    for (before, after) in [(0.0, 0.1), (0.04, 0.1), (0.1, 0.2), (0.2, 0.3), (0.29, 0.3), (0.5, 0.5)] {
        let mut roughness = rough(before, before);
        roughness.regularize();
        assert_eq!(roughness, rough(after, after));
    }
    let mut glass = Bsdf::dielectric(1.5, TrowbridgeReitz::SMOOTH);
    glass.regularize();
    assert_eq!(glass, Bsdf::dielectric(1.5, rough(0.1, 0.1)));
}

#[test]
fn facets_cover_the_surface_and_what_is_seen_of_it() {
    let usual = [rough(0.5, 0.5), rough(0.2, 0.7), rough(0.1, 0.1)].map(Microfacets::from);
    let others = [beckmann(0.5, 0.5), beckmann(0.2, 0.7), beckmann(0.1, 0.1)];
    for roughness in usual.into_iter().chain(others) {
        let projected = |wm: Vec3| f64::from(roughness.d(wm.into()) * wm.z.max(0.0));
        let sum: f64 = over_cells(&projected, 1e-6).iter().sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        for wo in [direction(20.0, 10.0), direction(75.0, 80.0)] {
            let seen = |wm: Vec3| {
                if wm.z <= 0.0 {
                    return 0.0;
                }
                f64::from(roughness.visible_per_cosine(wo.into(), wm.into()) * wo.dot(wm).max(0.0))
            };
            let sum: f64 = over_cells(&seen, 1e-6).iter().sum();
            assert!((sum - 1.0).abs() < 1e-4, "{wo}: {sum}");
        }
    }
}

#[test]
fn phases_are_normal_and_of_mean_cosine_g() {
    use henyey_greenstein::HenyeyGreenstein;
    for g in [-0.7, 0.0, 0.0005, 0.4, 0.9] {
        let phase = HenyeyGreenstein::new(g);
        let wo = direction(40.0, 70.0);
        let sum: f64 = over_cells(&|wi| f64::from(phase.p(wo.into(), wi.into())), 1e-6).iter().sum();
        assert!((sum - 1.0).abs() < 1e-4, "{g}: {sum}");
        let n = 100_000;
        let mean =
            (0..n).map(|i| f64::from(-phase.sample(wo.into(), numbers(17, i).1).dot(wo.into()))).sum::<f64>()
                / n as f64;
        assert!((mean - f64::from(g)).abs() < 0.01, "{g}: {mean}");
        let mut counts = vec![0; ROWS * COLUMNS];
        (0..n).for_each(|i| counts[cell(phase.sample(wo.into(), numbers(19, i).1).into())] += 1);
        let expected = over_cells(&|wi| f64::from(phase.p(wo.into(), wi.into())) * n as f64, 1e-2);
        assert!(chi_square_deviate(&counts, &expected) < corrected_bound(5), "{g}");
    }
}

#[test]
fn phases_of_two_lobes_are_normal_and_sampled_as_they_are() {
    use lookfrom_scene::medium::DraineLobe;
    use two_lobes::TwoLobes;
    let of_droplets = [0.1, 0.2, 0.7, 1.49, 1.5, 3.0, 5.0, 12.0, 50.0].map(TwoLobes::of_droplets);
    let rayleigh = TwoLobes::new(0.0, DraineLobe { g: 0.0, alpha: 1.0, share: 1.0 });
    let backward = TwoLobes::new(-0.6, DraineLobe { g: 0.5, alpha: 0.0, share: 0.25 });
    let forward = TwoLobes::new(0.3, DraineLobe { g: -0.75, alpha: 2.0, share: 0.5 });
    // Rayleigh's is 3 (1 + μ²) / 16 π.
    for mu in [-1.0, -0.3, 0.0, 0.8] {
        let wi = Vec3::new((1.0_f32 - mu * mu).sqrt(), 0.0, mu);
        let expected = 3.0 * (1.0 + mu * mu) / (16.0 * PI);
        assert!((rayleigh.p(Vec3::NEG_Z.into(), wi.into()) / expected - 1.0).abs() < 3e-3);
    }
    for phase in of_droplets.into_iter().chain([rayleigh, backward, forward]) {
        let diameter = format!("{phase:?}");
        // The integral and the mean cosine over 1 − μ = e^x, with peaks of any width.
        let steps = 40_000;
        let (mut sum, mut mean) = (0.0, 0.0);
        for step in 0..steps {
            let width = (2.0_f64.ln() + 30.0) / f64::from(steps);
            let apart = (-30.0 + (f64::from(step) + 0.5) * width).exp();
            let (mu, sin) = (1.0 - apart, (apart * (2.0 - apart)).sqrt());
            let wi = Vec3::new(sin as f32, 0.0, mu as f32);
            // As far apart as the sine says, which 1 − μ in single precision is not.
            let p = f64::from(phase.p(Vec3::NEG_Z.into(), wi.into()));
            let part = 2.0 * std::f64::consts::PI * p * apart * width;
            (sum, mean) = (sum + part, mean + part * mu);
        }
        assert!((sum - 1.0).abs() < 2e-4, "{diameter}: {sum}");
        let [ahead, g, alpha, weight] = [phase.ahead, phase.g, phase.alpha, phase.weight].map(f64::from);
        let draine =
            g * (1.0 + alpha * (3.0 + 2.0 * g * g) / 5.0) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0);
        let expected = (1.0 - weight) * ahead + weight * draine;
        assert!((mean - expected).abs() < 2e-4, "{diameter}: {mean}, expected {expected}");

        // Samples: their mean, and their numbers between directions of equal probability of each lobe.
        let wo = direction(40.0, 70.0);
        let n = 100_000;
        let cosines = |seed| (0..n).map(move |i| -phase.sample(wo.into(), numbers(seed, i).1).dot(wo.into()));
        let sampled = cosines(17).map(f64::from).sum::<f64>() / n as f64;
        assert!((sampled - expected).abs() < 0.005, "{diameter}: {sampled}, expected {expected}");
        let mut counts = vec![0; ROWS * COLUMNS];
        (0..n).for_each(|i| counts[cell(phase.sample(wo.into(), numbers(19, i).1).into())] += 1);
        let expected = over_cells(&|wi| f64::from(phase.p(wo.into(), wi.into())) * n as f64, 1e-2);
        assert!(chi_square_deviate(&counts, &expected) < corrected_bound(12), "{diameter}");
    }
}

#[test]
fn peaks_of_droplets_are_sampled_by_their_angle() {
    use two_lobes::TwoLobes;
    // Of the lobe ahead, the part F of the samples is within 1 − μ = (1 − g) F (s + 1 − g) / (1 + g − 2 g F).
    let phase = TwoLobes { weight: 1e-6, ..TwoLobes::of_droplets(50.0) };
    let g = f64::from(phase.ahead);
    let n = 50_000;
    let wo = direction(40.0, 70.0);
    let apart: Vec<f64> = (0..n)
        .map(|i| {
            let wi: Vec3 = phase.sample(wo.into(), numbers(23, i).1).into();
            f64::from((wi + wo).length_squared()) / 2.0
        })
        .collect();
    for part in [0.05, 0.3, 0.5, 0.8, 0.99] {
        let below = 1.0 + g - 2.0 * g * part;
        let bound = (1.0 - g) * part * ((1.0 - g * g) / below + 1.0 - g) / below;
        let found = apart.iter().filter(|apart| **apart <= bound).count() as f64 / n as f64;
        // Four standard errors of a share.
        let error = (part * (1.0 - part) / n as f64).sqrt();
        assert!((found - part).abs() < 4.0 * error, "{found}, expected {part}");
    }
}

#[test]
fn phases_of_eight_lanes_are_those_of_each() {
    use crate::core::lanes::width::{Lanes, One};
    use crate::core::lanes::{LANES, load, shade_together, store};
    use henyey_greenstein::HenyeyGreenstein;
    use lookfrom_simd::{Kernel, Simd, f32x8, prelude::*};
    use phase::{Phase, Phases};
    use two_lobes::TwoLobes;

    struct Eight<'a> {
        phases: &'a [Phase; LANES],
        wo: &'a [[f32; LANES]; 3],
        u: &'a [[f32; LANES]; 2],
    }
    impl Kernel for Eight<'_> {
        type Output = ([[f32; LANES]; 3], [f32; LANES], u32);
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let phases = Phases::by_lane(simd, |lane| self.phases[lane]);
            let (wo, u) = (load(simd, self.wo), self.u.map(|u| f32x8::load_array(simd, u)));
            let wi = phases.sample(wo, u);
            (store(wi), phases.p(wo, wi).column(), phases.choose_draine(u[0]).to_bitmask() as u32)
        }
    }
    for trial in 0..2000 {
        let phases: [Phase; LANES] = std::array::from_fn(|lane| match (trial + lane) % 3 {
            0 => Phase::HenyeyGreenstein(HenyeyGreenstein::new(
                number(41, (trial * 8 + lane) as u64) * 1.9 - 0.95,
            )),
            _ => Phase::TwoLobes(TwoLobes::of_droplets(50.0 * number(42, (trial * 8 + lane) as u64))),
        });
        let phases = if trial % 4 == 0 { [phases[trial % 8]; LANES] } else { phases };
        let rows: Vec<Vec3> =
            (0..LANES as u32).map(|lane| direction(20.0 * lane as f32, 31.0 * trial as f32)).collect();
        let wo = [0, 1, 2].map(|axis| std::array::from_fn(|lane| rows[lane][axis]));
        let u = [43, 44].map(|seed| std::array::from_fn(|lane| number(seed, (trial * 8 + lane) as u64)));
        let (wi, p, chosen) = shade_together(Eight { phases: &phases, wo: &wo, u: &u });
        for lane in 0..LANES {
            let one = Phases::by_lane(One, |_| phases[lane]);
            let u = u.map(|u| u[lane]);
            let expected = one.sample(rows[lane].into(), u);
            let found = [0, 1, 2].map(|axis| wi[axis][lane]);
            assert_eq!(
                found.map(f32::to_bits),
                <[f32; 3]>::from(expected).map(f32::to_bits),
                "{:?}",
                phases[lane]
            );
            assert_eq!(p[lane].to_bits(), one.p(rows[lane].into(), expected).to_bits());
            assert_eq!(chosen >> lane & 1 != 0, one.choose_draine(u[0]));
        }
    }
}

#[test]
fn numbers_of_any_size_never_become_nan() {
    // Directions near the axes, the surface and each other, by components of random exponents.
    let direction = |seed: u64, trial: u64| {
        let component = |k: u64| {
            let sign = if hash::pair(seed + k, trial) >> 50 & 1 == 0 { 1.0 } else { -1.0 };
            f64::from(sign * any_size(seed + k, trial, 45))
        };
        glam::DVec3::new(component(0), component(1), component(2)).normalize().as_vec3()
    };
    for trial in 0..60_000 {
        let size = |seed| any_size(seed, trial, 60);
        let lanes = |seed| Spectrum(std::array::from_fn(|lane| any_size(seed + lane as u64, trial, 60)));
        let small = |seed| any_size(seed, trial, 12);
        let roughness = rough(small(21), small(22));
        let coat = CoatLayer {
            eta: if trial.is_multiple_of(3) { size(31) } else { 1.5 },
            roughness: of_any_kind(trial / 4, rough(small(32), small(33))),
            thickness: size(34),
            albedo: if trial.is_multiple_of(2) { lanes(35) } else { Spectrum::BLACK },
            g: 1.0 - 2.0 * number(36, trial),
            max_depth: 10,
            samples: 1,
            estimate: lookfrom_scene::material::CoatEstimate::Unbiased,
            interior: None,
        };
        let whitted = WhittedCoefficients {
            ambient: Spectrum::BLACK,
            diffuse: lanes(41),
            specular: lanes(42),
            shininess: any_size(43, trial, 20),
            mirror: lanes(44),
            transmission: lanes(45),
            ior: small(46),
            fresnel: trial.is_multiple_of(2),
        };
        let share = |seed| any_size(seed, trial, 20).min(1.0);
        let look = principled::Principled {
            base_color: lanes(80),
            metallic: share(81),
            roughness,
            eta: if trial.is_multiple_of(7) { 0.0 } else { size(82) },
            f0: lanes(83),
            f0_greatest: share(84),
            f90: share(85),
            transmission: share(86),
            is_solid: trial.is_multiple_of(2),
            diffuse_transmission: share(87),
            clearcoat: share(88),
            clearcoat_roughness: rough(small(89), small(89)),
            clearcoat_normal: direction(90, trial).with_z(direction(90, trial).z.abs()).into(),
            sheen_color: if trial.is_multiple_of(3) { lanes(91) } else { Spectrum::BLACK },
            sheen_greatest: share(92),
            sheen_roughness: share(93),
            iridescence: if trial.is_multiple_of(5) { share(94) } else { 0.0 },
            film: principled::film::ThinFilm {
                eta: size(95),
                thickness: size(96),
                wavelengths: trial.is_multiple_of(2).then_some([450.0, 500.0, 600.0, 700.0]),
            },
            ..principled::Principled::default()
        };
        let open_pbr = look.with_model(principled::open_pbr::OpenPbr {
            specular_color: lanes(110),
            specular_weight: share(111),
            transmission_color: lanes(112),
            diffuse_roughness: share(113),
            coat_color: lanes(114),
            coat_eta: size(115),
            coat_f0: 0.0,
            coat_f90: share(116),
            coat_tangent: direction(117, trial).into(),
            coat_darkening: share(118),
            darkened: grey(1.0),
        });
        let (wo, wi) = (direction(50, trial), direction(60, trial));
        let (uc, u) = numbers(70, trial);
        let u = if trial.is_multiple_of(5) { [0.0, u[1]] } else { u };
        let mode = if trial.is_multiple_of(2) { Mode::Radiance } else { Mode::Importance };
        for bsdf in [
            Bsdf::diffuse(lanes(71)),
            Bsdf::diffuse_transmission(lanes(71), lanes(72)),
            Bsdf::conductor(lanes(73), lanes(74), of_any_kind(trial, roughness)),
            Bsdf::dielectric(size(75), of_any_kind(trial, roughness)),
            Bsdf::dielectric(1.0 + any_size(76, trial, 24).min(1.0), roughness),
            Bsdf::thin_dielectric(size(75)),
            stained(size(75), of_any_kind(trial, roughness)),
            Bsdf::coated_diffuse(lanes(71), &coat),
            Bsdf::coated_conductor(lanes(73), lanes(74), roughness, &coat),
            Bsdf::Whitted(whitted),
            Bsdf::Principled(look.clamped()),
            Bsdf::OpenPbr(open_pbr::OpenPbrSurface::new(&open_pbr)),
        ] {
            let good = |x: f32| x.is_finite() && x >= 0.0;
            for lobes in [Lobes::ALL, Lobes::REFLECTION, Lobes::TRANSMISSION] {
                let sample = bsdf.sample(wo, uc, u, mode, lobes);
                let towards = sample.map_or(wi, |sample| sample.wi);
                assert!(towards.is_finite(), "{bsdf:?} {wo} {sample:?}");
                for wi in [wi, towards, -wo, Vec3::new(-wo.x, -wo.y, wo.z)] {
                    let (f, pdf) = (bsdf.f(wo, wi, mode), bsdf.pdf(wo, wi, mode, lobes));
                    assert!(f.0.into_iter().all(good), "{bsdf:?} {wo:?} {wi:?}: f = {f:?}");
                    assert!(good(pdf), "{bsdf:?} {wo:?} {wi:?}: pdf = {pdf}");
                }
            }
        }
    }
}

#[test]
fn a_bsdf_is_small() {
    assert!(size_of::<Bsdf>() <= 192, "{}", size_of::<Bsdf>());
}
