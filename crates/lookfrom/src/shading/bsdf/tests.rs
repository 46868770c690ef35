//! Tests of BSDFs: densities, reciprocity, energy, Fresnel.

#[expect(unreachable_pub, reason = "as CONTRIBUTING.md has it")]
mod clay;
mod energy;
#[expect(unreachable_pub, reason = "as the table makes it")]
mod example;
mod extremes;
mod phases;
mod reflectance;
mod sampling;

use std::f32::consts::PI;
use std::f64::consts::TAU;

use lookfrom_scene::material::{self as written, Distribution, Masking};

use super::microfacet::TrowbridgeReitz;
use super::whitted::WhittedCoefficients;
use super::*;
use crate::core::hash;

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

/// The index of refraction on the side of ω_i over that on the side of ω_o, of what is refracted.
fn index_between(bsdf: &Bsdf, wo: Vec3, wi: Vec3) -> f32 {
    let inside = match bsdf {
        Bsdf::Dielectric(boundary) => boundary.eta,
        Bsdf::TintedDielectric(tinted) => tinted.boundary.eta,
        Bsdf::Principled(look) if look.is_solid => look.eta,
        Bsdf::OpenPbr(look) if look.layers().is_solid => look.layers().eta,
        Bsdf::Disney(look) if !look.is_thin => look.eta,
        _ => 1.0,
    };
    if wo.z * wi.z < 0.0 { inside.powf(wo.z.signum()) } else { 1.0 }
}

/// The part of the light along ω_o that goes on along a sample: radiance that is refracted is scaled by 1/η², diffuse light that
/// passes is not.
pub(super) fn weight_of_energy(bsdf: &Bsdf, wo: Vec3, sample: &BsdfSample) -> Spectrum {
    let BsdfSample { wi, f, pdf, lobe, .. } = *sample;
    let eta = index_between(bsdf, wo, wi);
    let diffuse = match lobe.is_specular() {
        true => Spectrum::BLACK,
        false => f * bsdf.diffuse_share(&bsdf.prepare(wo.into()), wi.into(), f),
    };
    ((f - diffuse) * (eta * eta) + diffuse) * (wi.z.abs() / pdf)
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
