//! Measured materials: Dupuy & Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering"; with the
//! conventions of pbrt-v4.
//!
//! Directions are sampled as in the paper: two numbers become others, u, by the luminance that tables have over them, and those choose a
//! visible normal ω_m. RGL's tables have `f = s(u, λ) D(ω_m) / (4 σ(ω_o) cos θ_i)`; MERL's have f itself, and the densities are made of it
//! (`half_angle`).

mod half_angle;
mod interpolant;
mod tables;

use std::f32::consts::{FRAC_2_PI, PI};

use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, prelude::*};

pub use self::tables::MeasuredTables;
use self::tables::Values;
use super::lanes::{ClassTraits, LaneBsdf, RowBsdf};
use super::{Description, DirectionSample, Lobes, ScatteringFunction, same_side};
use crate::core::elementary::{angle_in_turns, sin_cos_of_turns};
use crate::core::lanes::{LANES, by_lane, gather_four};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// A measured material, for the colours or wavelengths of a sample; `T` has tables for each lane.
#[derive(Clone, Copy, Debug)]
pub struct Measured<R = f32, T = [&'static MeasuredTables; 1]> {
    tables: T,
    /// 1 where the tables are of an isotropic material, else 0.
    is_isotropic: R,
    /// 1 where the tables are those of the paper, else 0.
    is_adaptive: R,
    /// The wavelengths of the lanes of spectra in nm; `None` for red, green and blue.
    wavelengths: Option<[R; 4]>,
}

impl PartialEq for Measured {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.tables[0], other.tables[0]) && self.wavelengths == other.wavelengths
    }
}

/// A measured material seen from an outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct SeenMeasured<R: Real> {
    /// Mirrored through the point to the outside, where it is inside.
    wo: Vector<R>,
    is_inside: R::Mask,
    theta: R,
    phi: R,
}

/// Directions on the outside, by the numbers that choose their half vector, and its place.
struct Reflected<R> {
    wi: Vector<R>,
    u: [R; 2],
    normal: [R; 2],
}

impl Measured {
    /// By its tables, for the wavelengths of a sample in nm; without them, for red, green and blue.
    pub fn new(tables: &'static MeasuredTables, wavelengths: Option<[f32; 4]>) -> Self {
        let is_adaptive = matches!(tables.values, Values::Adaptive(_));
        let [is_isotropic, is_adaptive] = [tables.is_isotropic, is_adaptive].map(f32::from);
        Self { tables: [tables], is_isotropic, is_adaptive, wavelengths }
    }

    /// The look at other wavelengths.
    #[cfg(test)]
    pub(super) fn at(self, wavelengths: Option<[f32; 4]>) -> Self {
        Self { wavelengths, ..self }
    }
}

impl<R: Real, T: AsRef<[&'static MeasuredTables]>> Measured<R, T> {
    #[inline(always)]
    fn seen_from(&self, wo: Vector<R>) -> SeenMeasured<R> {
        let is_inside = wo.z.lt(wo.z.like(0.0));
        let wo = wo.negate_where(is_inside);
        let (theta, phi) = angles(wo);
        SeenMeasured { wo, is_inside, theta, phi }
    }

    /// The angle by which normals are turned in tables: those of isotropic materials are all seen from φ = 0.
    #[inline(always)]
    fn turn(&self, seen: &SeenMeasured<R>) -> R {
        let zero = seen.phi.like(0.0);
        R::select(self.is_isotropic.gt(zero), seen.phi, zero)
    }

    /// The place of a normal in tables that are seen from a direction.
    #[inline(always)]
    fn place_of_normal(&self, seen: &SeenMeasured<R>, wm: Vector<R>) -> [R; 2] {
        let (theta, phi) = angles(wm);
        let [x, y] = place(theta, phi - self.turn(seen));
        [x, y - Float::floor(y)]
    }

    /// `f` in the lanes of a mask; any numbers in others.
    #[inline(always)]
    fn value(&self, seen: &SeenMeasured<R>, reflected: &Reflected<R>, mask: R::Mask) -> Spectrum<R> {
        let Reflected { wi, u, normal } = *reflected;
        let (zero, one) = (wi.z.like(0.0), wi.z.like(1.0));
        let is_adaptive = self.is_adaptive.gt(zero);
        let of_wo = place(seen.theta, seen.phi);
        let halves = match is_adaptive.all() {
            true => [zero; 3],
            false => half_angle::place(seen.wo, wi),
        };
        let [nm0, nm1, nm2, nm3] = self.wavelengths.unwrap_or([zero; 4]);
        let is_spectral = self.wavelengths.is_some();
        let is_wanted = R::select(mask, one, zero);
        let [a, b, c, d, ndf, sigma] = R::by_lane(
            [
                is_wanted, seen.phi, seen.theta, u[0], u[1], normal[0], normal[1], of_wo[0], of_wo[1],
                halves[0], halves[1], halves[2], nm0, nm1, nm2, nm3,
            ],
            #[inline(always)]
            |lane, [is_wanted, phi, theta, u, v, x, y, s, t, p, q, r, nm @ ..]| {
                if is_wanted == 0.0 {
                    return [0.0; 6];
                }
                let wavelengths = is_spectral.then_some(nm);
                match &self.tables.as_ref()[lane].values {
                    Values::Adaptive(values) => {
                        let Spectrum([a, b, c, d]) = values.reflectances([phi, theta], [u, v], wavelengths);
                        let [ndf, sigma] = values.facets([x, y], [s, t]);
                        [a, b, c, d, ndf, sigma]
                    }
                    Values::HalfAngle(values) => {
                        let Spectrum([a, b, c, d]) = values.value([p, q, r], wavelengths);
                        [a, b, c, d, 0.0, 0.0]
                    }
                }
            },
        );
        let f = Spectrum([a, b, c, d]);
        let sigma = Float::max(sigma, zero.like(f32::MIN_POSITIVE));
        let factor = ndf / (sigma * 4.0 * Float::abs(wi.z));
        Spectrum::select(is_adaptive, f * factor, f)
    }

    /// The BSDF and the density. Not inlined, since it is needed several times.
    #[inline(never)]
    fn scattered(&self, seen: &SeenMeasured<R>, wi: Vector<R>) -> (Spectrum<R>, R) {
        wi.z.at_level(
            #[inline(always)]
            || {
                let (zero, one) = (wi.z.like(0.0), wi.z.like(1.0));
                let wi = wi.negate_where(seen.is_inside);
                let (wm, exists) = (seen.wo + wi).try_normalize();
                // By rounding the facet between opposite directions may face away.
                let is_lit = exists & same_side(seen.wo, wi) & seen.wo.dot(wm).gt(zero);
                if !is_lit.any() {
                    return (Spectrum::splat(zero), zero);
                }
                let normal = self.place_of_normal(seen, wm);
                let is_wanted = R::select(is_lit, one, zero);
                let [u, v, density] = R::by_lane(
                    [seen.phi, seen.theta, normal[0], normal[1], is_wanted],
                    #[inline(always)]
                    |lane, [phi, theta, x, y, is_wanted]| match is_wanted == 0.0 {
                        true => [0.0; 3],
                        false => self.tables.as_ref()[lane].invert([phi, theta], [x, y]),
                    },
                );
                let f = self.value(seen, &Reflected { wi, u: [u, v], normal }, is_lit);
                let pdf = density / jacobian(seen.wo, wm, normal);
                (Spectrum::select(is_lit, f, Spectrum::splat(zero)), R::select(is_lit, pdf, zero))
            },
        )
    }

    #[inline(always)]
    fn sampled(&self, seen: &SeenMeasured<R>, u: [R; 2]) -> DirectionSample<R> {
        let (zero, one) = (u[0].like(0.0), u[0].like(1.0));
        let [x, y, u, v, density] = R::by_lane(
            [seen.phi, seen.theta, u[0], u[1]],
            #[inline(always)]
            |lane, [phi, theta, u, v]| self.tables.as_ref()[lane].sample([phi, theta], [u, v]),
        );

        // The normal, and what it reflects.
        let normal = [x, y];
        let wm = normal_at(normal, self.turn(seen));
        let wi = wm * (seen.wo.dot(wm) * 2.0) - seen.wo;
        let is_valid = density.gt(zero) & same_side(seen.wo, wi);
        let no = is_valid.like(false);
        DirectionSample {
            f: self.value(seen, &Reflected { wi, u: [u, v], normal }, is_valid),
            wi: wi.normalize().negate_where(seen.is_inside),
            pdf: density / jacobian(seen.wo, wm, normal),
            eta: one,
            is_specular: no,
            is_diffuse: no,
            is_transmission: no,
            is_valid,
        }
    }
}

/// The sine of a direction's angle to the normal.
#[inline(always)]
fn across<R: Real>(w: Vector<R>) -> R {
    Float::sqrt(w.x * w.x + w.y * w.y)
}

/// The angles θ to the normal and φ around it, −π … π.
#[inline(always)]
fn angles<R: Real>(w: Vector<R>) -> (R, R) {
    (angle_in_turns(across(w), w.z) * (2.0 * PI), angle_in_turns(w.y, w.x) * (2.0 * PI))
}

/// The place of a direction in tables.
#[inline(always)]
fn place<R: Real>(theta: R, phi: R) -> [R; 2] {
    [Float::sqrt(Float::max(theta * FRAC_2_PI, theta.like(0.0))), phi / (2.0 * PI) + 0.5]
}

/// The direction of a place in tables, turned by φ.
#[inline(always)]
fn normal_at<R: Real>([x, y]: [R; 2], phi: R) -> Vector<R> {
    let (sin_phi, cos_phi) = sin_cos_of_turns(y - 0.5 + phi / (2.0 * PI));
    let (sin, cos) = sin_cos_of_turns(x * 0.25 * x);
    Vector { x: sin * cos_phi, y: sin * sin_phi, z: cos }
}

/// The density over solid angle of incident directions that is one in tables of normals.
#[inline(always)]
fn jacobian<R: Real>(wo: Vector<R>, wm: Vector<R>, [x, _]: [R; 2]) -> R {
    let area = x * (2.0 * PI * PI) * across(wm);
    wo.dot(wm) * 4.0 * Float::max(area, area.like(1e-6))
}

impl<R: Real, T: AsRef<[&'static MeasuredTables]>> LaneBsdf<R> for Measured<R, T> {
    type Prepared = SeenMeasured<R>;

    #[inline(always)]
    fn traits(&self) -> ClassTraits {
        ClassTraits { needs_lobe: false, ..ClassTraits::PLAIN }
    }

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> SeenMeasured<R> {
        self.seen_from(wo)
    }

    #[inline(always)]
    fn f(&self, seen: &SeenMeasured<R>, wi: Vector<R>) -> Spectrum<R> {
        self.scattered(seen, wi).0
    }

    #[inline(always)]
    fn pdf(&self, seen: &SeenMeasured<R>, wi: Vector<R>) -> R {
        self.scattered(seen, wi).1
    }

    #[inline(always)]
    fn f_and_pdf(&self, seen: &SeenMeasured<R>, wi: Vector<R>) -> (Spectrum<R>, R) {
        self.scattered(seen, wi)
    }

    #[inline(always)]
    fn sample(&self, seen: &SeenMeasured<R>, _: R, u: [R; 2]) -> DirectionSample<R> {
        self.sampled(seen, u)
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.is_adaptive.lt(self.is_adaptive).like(true)
    }
}

impl ScatteringFunction for Measured {
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

impl RowBsdf for Measured {
    type Lanes<S: Simd> = Measured<f32x8<S>, [&'static MeasuredTables; LANES]>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        // All paths of a picture are of colours, or all of wavelengths.
        let wavelengths = rows[0].wavelengths.map(
            #[inline(always)]
            |_| gather_four(simd, &by_lane!(lane => rows[lane].wavelengths.unwrap_or_default())),
        );
        Measured {
            tables: by_lane!(lane => rows[lane].tables[0]),
            is_isotropic: f32x8::load_array(simd, by_lane!(lane => rows[lane].is_isotropic)),
            is_adaptive: f32x8::load_array(simd, by_lane!(lane => rows[lane].is_adaptive)),
            wavelengths,
        }
    }
}
