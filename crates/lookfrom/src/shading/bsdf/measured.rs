//! Measured materials: Dupuy & Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering"; with the
//! conventions of pbrt-v4.
//!
//! Directions are sampled as in the paper: two numbers become others, u, by the luminance that tables have over them, and those choose a
//! visible normal ω_m. RGL's tables have `f = s(u, λ) D(ω_m) / (4 σ(ω_o) cos θ_i)`; MERL's have f itself, and the densities are made of it
//! (`half_angle`).

mod half_angle;
mod interpolant;

use std::f32::consts::{FRAC_2_PI, PI};
use std::fmt;
use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use lookfrom_scene::measured as written;
use lookfrom_scene::measured::Tables;

use self::half_angle::HalfAngleValues;
use self::interpolant::{Between, Interpolant};
use super::{BsdfSample, Description, Lobes, Mode, ScatteringFunction, same_side};
use crate::core::elementary::{angle_in_turns, sin_cos_of_turns};
use crate::core::spectrum::Spectrum;

/// The tables of a measured material, compiled.
pub struct MeasuredTables {
    is_isotropic: bool,
    /// The density of visible normals.
    vndf: Interpolant<2>,
    /// The density of the numbers that choose one.
    luminance: Interpolant<2>,
    values: Values,
    digest: String,
}

/// From directions to `f`.
enum Values {
    Adaptive(Box<Reflectances>),
    HalfAngle(HalfAngleValues),
}

/// The reflectance s over the numbers that choose a normal, and what makes `f` of it.
struct Reflectances {
    ndf: Interpolant<0>,
    sigma: Interpolant<0>,
    spectra: Interpolant<3>,
    /// Reflectances of red, green and blue, as wavelengths 0, 1 and 2 of a table.
    colors: Interpolant<3>,
}

impl fmt::Debug for MeasuredTables {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MeasuredTables({})", self.digest)
    }
}

impl MeasuredTables {
    /// Compiles tables. For each wavelength of RGL's there is the colour, in linear Rec. 709, of what is 1 there and 0 at its neighbours.
    pub fn new(written: &written::Measured, of_wavelengths: &[[f32; 3]]) -> Self {
        let (is_isotropic, digest) = (written.is_isotropic(), written.digest.clone());
        match &written.tables {
            Tables::Adaptive(tables) => {
                let written::Adaptive { phi, theta, wavelengths, .. } = &**tables;
                Self {
                    is_isotropic,
                    vndf: Interpolant::density(&tables.vndf, [phi, theta]),
                    luminance: Interpolant::density(&tables.luminance, [phi, theta]),
                    values: Values::Adaptive(Box::new(Reflectances {
                        ndf: Interpolant::plain(&tables.ndf, []),
                        sigma: Interpolant::plain(&tables.sigma, []),
                        spectra: Interpolant::plain(&tables.spectra, [phi, theta, wavelengths]),
                        colors: Interpolant::plain(
                            &colors(tables, of_wavelengths),
                            [phi, theta, &[0.0, 1.0, 2.0]],
                        ),
                    })),
                    digest,
                }
            }
            Tables::HalfAngle(tables) => {
                let values = HalfAngleValues::new(tables);
                let [vndf, luminance] = values.densities();
                Self { is_isotropic, vndf, luminance, values: Values::HalfAngle(values), digest }
            }
        }
    }

    /// The compiled tables of a file, which are kept as long as the process, once for each content: BSDFs are copied, and refer to them.
    /// As [`Self::new`].
    pub fn kept(written: &written::Measured, of_wavelengths: &[[f32; 3]]) -> &'static Self {
        static KEPT: Mutex<Vec<&'static MeasuredTables>> = Mutex::new(Vec::new());
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        match kept.iter().find(|tables| tables.digest == written.digest) {
            Some(tables) => tables,
            None => {
                let tables: &'static Self = Box::leak(Box::new(Self::new(written, of_wavelengths)));
                kept.push(tables);
                tables
            }
        }
    }

    /// The fraction of light from all around that is reflected straight up, in linear Rec. 709.
    pub(crate) fn albedo(&'static self) -> [f32; 3] {
        const COUNT: u32 = 256;
        let bsdf = Measured::new(self, None);
        let numbers =
            |index: u32| [(index as f32 + 0.5) / COUNT as f32, index.reverse_bits() as f32 * 2_f32.powi(-32)];
        let mut sum = Spectrum::BLACK;
        for sample in (0..COUNT)
            .filter_map(|index| bsdf.sample(Vec3::Z, 0.0, numbers(index), Mode::Radiance, Lobes::ALL))
            .filter(|sample| sample.pdf > 0.0)
        {
            sum += sample.f * (sample.wi.z.abs() / sample.pdf / COUNT as f32);
        }
        sum.rgb()
    }
}

/// Spectra as colours, in place of three wavelengths.
fn colors(written: &written::Adaptive, of_wavelengths: &[[f32; 3]]) -> written::Table {
    let area = written.spectra.area();
    let count = written.wavelengths.len();
    let mut values = Vec::with_capacity(written.spectra.values.len() / count * 3);
    for tables in written.spectra.values.chunks(area * count) {
        for channel in 0..3 {
            values.extend((0..area).map(|place| {
                let terms = of_wavelengths.iter().enumerate();
                terms.map(|(k, color)| color[channel] * tables[k * area + place]).sum::<f32>().max(0.0)
            }));
        }
    }
    written::Table { size: written.spectra.size, values }
}

/// A measured material, for the colours or wavelengths of a sample.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    tables: &'static MeasuredTables,
    /// The wavelengths of the lanes in nm; `None` for red, green and blue.
    wavelengths: Option<[f32; 4]>,
}

impl PartialEq for Measured {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.tables, other.tables) && self.wavelengths == other.wavelengths
    }
}

/// An outgoing direction of tables: of a material seen from outside.
struct Seen {
    phi: f32,
    theta: f32,
    by_direction: [Between<2>; 2],
}

impl Measured {
    /// By its tables, for the wavelengths of a sample in nm; without them, for red, green and blue.
    pub fn new(tables: &'static MeasuredTables, wavelengths: Option<[f32; 4]>) -> Self {
        Self { tables, wavelengths }
    }

    fn seen(&self, wo: Vec3) -> Seen {
        let (theta, phi) = angles(wo);
        let by_direction =
            [self.tables.vndf.between([phi, theta]), self.tables.luminance.between([phi, theta])];
        Seen { phi, theta, by_direction }
    }

    /// The place of a normal in tables that are seen from a direction.
    fn place_of_normal(&self, seen: &Seen, wm: Vec3) -> [f32; 2] {
        let (theta, phi) = angles(wm);
        let [x, y] = place(theta, if self.tables.is_isotropic { phi - seen.phi } else { phi });
        [x, y - y.floor()]
    }

    /// `f` for directions on the outside, by the numbers that choose their half vector, and its place.
    fn value(&self, seen: &Seen, u: [f32; 2], normal: [f32; 2], [wo, wi]: [Vec3; 2]) -> Spectrum {
        match &self.tables.values {
            Values::Adaptive(values) => values.value(seen, u, normal, wi, self.wavelengths),
            Values::HalfAngle(values) => values.value(wo, wi, self.wavelengths),
        }
    }
}

impl Reflectances {
    fn value(
        &self,
        seen: &Seen,
        u: [f32; 2],
        normal: [f32; 2],
        wi: Vec3,
        wavelengths: Option<[f32; 4]>,
    ) -> Spectrum {
        let reflected = match wavelengths {
            Some(wavelengths) => {
                let at = |nm| self.spectra.value(u, &self.spectra.between([seen.phi, seen.theta, nm]));
                Spectrum(wavelengths.map(|nm| at(nm).max(0.0)))
            }
            None => {
                let at = |channel: f32| {
                    self.colors.value(u, &self.colors.between([seen.phi, seen.theta, channel]))
                };
                Spectrum::from_rgb([0.0, 1.0, 2.0].map(at))
            }
        };
        let sigma = self.sigma.value(place(seen.theta, seen.phi), &self.sigma.between([]));
        let ndf = self.ndf.value(normal, &self.ndf.between([]));
        reflected * (ndf / (4.0 * sigma.max(f32::MIN_POSITIVE) * wi.z.abs()))
    }
}

/// The sine of a direction's angle to the normal.
fn across(w: Vec3) -> f32 {
    (w.x * w.x + w.y * w.y).sqrt()
}

/// The angles θ to the normal and φ around it, −π … π.
fn angles(w: Vec3) -> (f32, f32) {
    let turns = |y, x| angle_in_turns::<f32>(y, x) * (2.0 * PI);
    (turns(across(w), w.z), turns(w.y, w.x))
}

/// The place of a direction in tables.
fn place(theta: f32, phi: f32) -> [f32; 2] {
    [(theta * FRAC_2_PI).max(0.0).sqrt(), phi / (2.0 * PI) + 0.5]
}

/// The direction of a place in tables, turned by φ.
fn normal_at([x, y]: [f32; 2], phi: f32) -> Vec3 {
    let (sin_phi, cos_phi) = sin_cos_of_turns(y - 0.5 + phi / (2.0 * PI));
    let (sin, cos) = sin_cos_of_turns(0.25 * x * x);
    Vec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// What one density of normals in tables is over solid angle of incident directions.
fn jacobian(wo: Vec3, wm: Vec3, [x, _]: [f32; 2]) -> f32 {
    4.0 * wo.dot(wm) * (2.0 * PI * PI * x * across(wm)).max(1e-6)
}

/// Both directions on the outside, and their half vector; `None` where light does not go.
fn on_the_outside(wo: Vec3, wi: Vec3) -> Option<(Vec3, Vec3, Vec3)> {
    if !same_side(wo, wi) {
        return None;
    }
    let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
    let wm = (wo + wi).try_normalize()?;
    Some((wo, wi, wm))
}

impl ScatteringFunction for Measured {
    fn f(&self, wo: Vec3, wi: Vec3, _: Mode) -> Spectrum {
        let Some((wo, wi, wm)) = on_the_outside(wo, wi) else { return Spectrum::BLACK };
        let seen = self.seen(wo);
        let normal = self.place_of_normal(&seen, wm);
        let (u, _) = self.tables.vndf.invert(normal, &seen.by_direction[0]);
        self.value(&seen, u, normal, [wo, wi])
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: Mode, _: Lobes) -> f32 {
        let Some((wo, _, wm)) = on_the_outside(wo, wi) else { return 0.0 };
        let seen = self.seen(wo);
        let normal = self.place_of_normal(&seen, wm);
        let (u, of_normal) = self.tables.vndf.invert(normal, &seen.by_direction[0]);
        of_normal * self.tables.luminance.pdf(u, &seen.by_direction[1]) / jacobian(wo, wm, normal)
    }

    fn sample(&self, wo: Vec3, _: f32, u: [f32; 2], _: Mode, _: Lobes) -> Option<BsdfSample> {
        let is_inside = wo.z < 0.0;
        let wo = if is_inside { -wo } else { wo };
        let seen = self.seen(wo);
        let (u, of_luminance) = self.tables.luminance.sample(u, &seen.by_direction[1])?;
        let (normal, of_normal) = self.tables.vndf.sample(u, &seen.by_direction[0])?;

        // The normal, and what it reflects.
        let wm = normal_at(normal, if self.tables.is_isotropic { seen.phi } else { 0.0 });
        let wi = wm * (2.0 * wo.dot(wm)) - wo;
        if !same_side(wo, wi) {
            return None;
        }
        let pdf = of_luminance * of_normal / jacobian(wo, wm, normal);
        let f = self.value(&seen, u, normal, [wo, wi]);
        let wi = wi.normalize();
        Some(BsdfSample::new(if is_inside { -wi } else { wi }, f, pdf, self.lobes()))
    }

    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | Lobes::GLOSSY
    }

    fn description(&self) -> Description {
        let lanes = self.wavelengths.map_or(Vec::new(), |wavelengths| {
            vec![("wavelengths", super::Parameter::Numbers(wavelengths.to_vec()))]
        });
        Description { kind: "measured", does: "reflects light as a material was measured", numbers: lanes }
    }
}
