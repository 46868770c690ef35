//! Where the numbers of a light sample come from: formulas of its radiance, its density and its choice, with their operands,
//! for people who compute them anew.

use glam::DVec3;
use serde::Serialize;

use super::area::AreaDensity;
use super::{Light, LightSample, Target, fade, smooth_step, toward};
use crate::core::spectrum::Spectrum;
use crate::shading::texture::{SpectralMode, Textures};

/// A formula, and its operands by name: each is a number, or one number for each lane or child.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Derivation {
    /// The formula.
    pub formula: &'static str,
    /// The operands.
    pub numbers: Vec<(&'static str, Vec<f64>)>,
}

impl Derivation {
    pub(super) fn new(formula: &'static str, numbers: Vec<(&'static str, Vec<f64>)>) -> Self {
        Self { formula, numbers }
    }
}

impl Light {
    /// How the sample's radiance (of point lights: the light that arrives) or its density follows from the light; `from` is
    /// the point that is lit. `None` where there is no short formula.
    pub(crate) fn derivation(
        &self,
        textures: &Textures,
        from: DVec3,
        sample: &LightSample,
        mode: &SpectralMode,
    ) -> Option<Derivation> {
        let lanes = |light: Spectrum| -> Vec<f64> {
            let used = if matches!(mode, SpectralMode::Rgb) { 3 } else { 4 };
            light.0[..used].iter().map(|lane| f64::from(*lane)).collect()
        };
        match self {
            Self::Point { position, intensity, falloff } => {
                let (_, distance) = toward(from, *position)?;
                let numbers = vec![
                    ("I", lanes(intensity.even(textures, mode))),
                    ("d", vec![distance]),
                    ("fall-off", vec![f64::from(fade::<f32>(*falloff, distance))]),
                ];
                Some(Derivation::new("L = I · fall-off(d)", numbers))
            }
            Self::Spot { position, axis, intensity, cos_outer, cos_inner, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                let cos = axis.dot(-wi);
                let [cos_outer, cos_inner] = [*cos_outer, *cos_inner];
                let cone = smooth_step(cos_outer, cos_inner, cos);
                let numbers = vec![
                    ("I", lanes(intensity.even(textures, mode))),
                    ("d", vec![distance]),
                    ("fall-off", vec![f64::from(fade::<f32>(*falloff, distance))]),
                    ("cos to the axis", vec![f64::from(cos)]),
                    ("cos outer, inner", vec![f64::from(cos_outer), f64::from(cos_inner)]),
                    ("S", vec![f64::from(cone)]),
                ];
                Some(Derivation::new(
                    "L = I · fall-off(d) · S; S = x² (3 − 2x), x = (cos − outer) / (inner − outer), from 0 to 1",
                    numbers,
                ))
            }
            Self::Area(light) => {
                let Target::Surface(point, normal) = sample.target else { return None };
                let to = DVec3::from_array(point.position) - from;
                let cos = normal.dot(sample.wi.as_dvec3()).abs();
                let of_area = [("d", vec![to.length()]), ("cos at the light", vec![cos])];
                Some(match light.density(from, point.position.into()) {
                    AreaDensity::Area { area, probability } => Derivation::new(
                        "pdf = P d² / (A cos): a point of the area A",
                        [("P", vec![probability]), ("A", vec![area])].into_iter().chain(of_area).collect(),
                    ),
                    AreaDensity::SolidAngle { solid_angle, probability } => Derivation::new(
                        "pdf = P / Ω: a direction of a triangle's solid angle",
                        vec![("P", vec![probability]), ("Ω", vec![solid_angle])],
                    ),
                    AreaDensity::Cone { radius, distance } => Derivation::new(
                        "pdf = 1 / (2π (1 − cos θ)), sin θ = R / D: a direction of the cone around a sphere",
                        vec![("R", vec![radius]), ("D", vec![distance])],
                    ),
                })
            }
            Self::Distant { .. } | Self::Projection(_) | Self::Goniometric(_) | Self::Environment(_) => None,
        }
    }
}
