//! Approximate powers of lights, by which they are chosen: brightness times extent, relative to the greatest.

use std::f64::consts::PI;

use super::derivation::{Derivation, vector};
use super::{EmissionSpectrum, Environment, Light, Sky};
use crate::shading::texture::{TexturePoint, Textures};

/// The powers of a world's lights.
#[derive(Clone, Debug)]
pub(super) struct Powers {
    /// By light: its largest radiance (or intensity), approximately.
    brightness: Vec<f32>,
    /// Radius of the scene, for lights infinitely far away.
    radius: f32,
    /// The greatest power of a light that is sampled.
    greatest: f64,
}

/// The power of a light of brightness 1, its formula, and the length or area that it contains.
struct UnitPower {
    value: f64,
    formula: &'static str,
    extent: Option<(&'static str, f64)>,
}

impl Powers {
    pub(super) fn new(lights: &[Light], brightness: Vec<f32>, radius: f32) -> Self {
        let mut powers = Self { brightness, radius, greatest: 0.0 };
        let sampled = (0..).zip(lights).filter(|(_, light)| light.is_sampled());
        powers.greatest = sampled.map(|(index, light)| powers.absolute(index, light)).fold(0.0, f64::max);
        powers
    }

    /// The powers of the same lights, of which others may be sampled.
    pub(super) fn among(&self, lights: &[Light]) -> Self {
        Self::new(lights, self.brightness.clone(), self.radius)
    }

    fn absolute(&self, index: u32, light: &Light) -> f64 {
        f64::from(self.brightness[index as usize]) * light.unit_power(self.radius).value
    }

    /// The power of a light, by its index; the greatest is 1. Thus any power fits an f32; a positive one stays positive.
    pub(super) fn relative(&self, index: u32, light: &Light) -> f32 {
        let power = self.absolute(index, light);
        if power > 0.0 { ((power / self.greatest) as f32).max(1e-30) } else { 0.0 }
    }

    /// The formula of [`Powers::relative`], with operands; `None` where no light has any power.
    pub(super) fn derivation(&self, textures: &Textures, index: u32, light: &Light) -> Option<Derivation> {
        if self.greatest == 0.0 {
            return None;
        }
        let UnitPower { formula, extent, .. } = light.unit_power(self.radius);
        let brightness = f64::from(self.brightness[index as usize]);
        let numbers = [
            ("power", vec![f64::from(self.relative(index, light))]),
            ("M", vec![self.greatest]),
            ("B", vec![brightness]),
        ];
        let extent = extent.map(|(name, size)| (name, vec![size]));
        let (of_brightness, color) = match light.even_spectrum() {
            Some(EmissionSpectrum { color, scale }) => (
                "B = s · the largest channel of C, its colour in linear Rec. 709",
                vec![
                    ("s", vec![f64::from(*scale)]),
                    ("C", vector(textures.rgb(color, &TexturePoint::NOWHERE))),
                ],
            ),
            None => ("B its mean brightness, by its picture", Vec::new()),
        };
        Some(Derivation::new(
            format!(
                "power = {formula} / M, if positive at least 10⁻³⁰; M the greatest of all lights; {of_brightness}"
            ),
            numbers.into_iter().chain(extent).chain(color).collect(),
        ))
    }
}

impl Light {
    /// Approximate; `radius` is that of the scene.
    fn unit_power(&self, radius: f32) -> UnitPower {
        let radius = f64::from(radius);
        let over = |area: f64| (PI * area, "π A B", Some(("A", area)));
        let (value, formula, extent) = match self {
            Self::Point { .. } | Self::Goniometric(_) | Self::Spot { .. } => (4.0 * PI, "4π B", None),
            Self::Projection(_) => (1.0, "B", None),
            Self::Area(light) => over(light.area()),
            Self::Environment(Environment { portal: Some(portal), .. }) => over(portal.area()),
            Self::Distant { .. } => (PI * radius * radius, "π R² B", Some(("R", radius))),
            Self::Environment(_) => (4.0 * PI * PI * radius * radius, "4π² R² B", Some(("R", radius))),
        };
        UnitPower { value, formula, extent }
    }

    /// The spectrum of which its brightness is the largest channel; `None` where that is a mean over a picture.
    fn even_spectrum(&self) -> Option<&EmissionSpectrum> {
        let spectrum = match self {
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Distant { irradiance, .. } => irradiance,
            Self::Area(light) => &light.radiance,
            Self::Environment(Environment { sky: Sky::Constant(radiance), .. }) => radiance,
            Self::Environment(Environment { sky: Sky::Gradient { horizon, .. }, .. }) => horizon,
            _ => return None,
        };
        (!spectrum.color.varies()).then_some(spectrum)
    }
}
