//! Participating media.

pub mod presets;

use std::ops::RangeInclusive;

use glam::{DMat4, Vec3};

use crate::error::Location;
use crate::grid::Placed;
use crate::material::{Color, Scalar};
use crate::scene::MediumId;
use crate::spectrum::observer;

/// Diameters of water droplets that have a phase function, in micrometres.
pub const DROPLETS: RangeInclusive<f32> = 0.1..=50.0;

/// A participating medium: the same everywhere, or varying in space.
#[derive(Clone, Debug)]
pub struct Medium {
    /// The name that interfaces use.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// Extinction coefficient σ_t = σ_a + σ_s, per unit of length.
    pub extinction: Extinction,
    /// Mean cosine of the angle between the directions before and after scattering, by the phase function of Henyey & Greenstein:
    /// between −1 and 1, 0 for all directions alike.
    pub g: f32,
    /// Diameter of the water droplets of a fog or cloud in micrometres, in [`DROPLETS`]: their phase function instead.
    pub droplets: Option<f32>,
    /// A second lobe of the phase function beside that of Henyey & Greenstein.
    pub draine: Option<DraineLobe>,
    /// Multiplies both coefficients: ≥ 0.
    pub scale: f32,
    /// The radiance that the medium emits, times its absorption coefficient, per unit of length …
    pub emission: Color,
    /// … and a factor of it: ≥ 0.
    pub emission_scale: f32,
    /// Variation in space; `None` for a homogeneous medium.
    pub variation: Option<Variation>,
}

/// A lobe of a phase function: (1 + α cos²θ) times that of Henyey & Greenstein with the same g, normalised (Draine 2003). Rayleigh's has g = 0
/// and α = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DraineLobe {
    /// Between −1 and 1.
    pub g: f32,
    /// ≥ 0.
    pub alpha: f32,
    /// Its share in the phase function, 0 … 1.
    pub share: f32,
}

/// Extinction coefficient σ_t = σ_a + σ_s of a medium: the transmittance of a length is e^(−σ_t · length), the Beer–Lambert law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extinction {
    /// By its parts.
    Parts {
        /// Absorption coefficient, per unit of length.
        absorption: Color,
        /// Scattering coefficient, per unit of length.
        scattering: Color,
    },
    /// By their sum. Of spectra made of colours the products are other ones than that of the products of colours.
    Sum {
        /// The sum of both coefficients, per unit of length.
        sum: Color,
        /// The part of it that is scattered, 0 … 1: the single-scattering albedo.
        albedo: Color,
    },
}

impl Extinction {
    /// That of a vacuum.
    pub const NONE: Self = Self::Parts { absorption: Color::BLACK, scattering: Color::BLACK };

    /// Both colours, with their keys in scene files.
    pub(crate) fn colors(self) -> [(&'static str, Color); 2] {
        match self {
            Self::Parts { absorption, scattering } => {
                [("absorption", absorption), ("scattering", scattering)]
            }
            Self::Sum { sum, albedo } => [("extinction", sum), ("albedo", albedo)],
        }
    }

    fn scatters(self) -> bool {
        match self {
            Self::Parts { scattering, .. } => !is_black(scattering),
            Self::Sum { sum, albedo } => !is_black(sum) && !is_black(albedo),
        }
    }
}

/// Variation of a medium in space.
#[derive(Clone, Debug)]
pub struct Variation {
    /// From medium space, in which everything here is told, to world space. Coefficients are per unit of length in the world.
    pub world_from_medium: DMat4,
    /// The corners of a box outside of which there is nothing of the medium; `None` where it has no end.
    pub bounds: Option<[Vec3; 2]>,
    /// Factor of the coefficients.
    pub density: Density,
    /// A factor of the emission.
    pub emission_scale: Option<Placed<f32>>,
    /// Blackbody emission, in the place of [`Medium::emission`].
    pub temperature: Option<Temperature>,
}

/// Density of a medium.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Density {
    /// Numbers of a grid, interpolated between the centres of its cells: ≥ 0.
    Grid(Placed<f32>),
    /// Colours of grids, in linear Rec. 709; what is missing is 1, or without emission.
    Colors {
        /// Factor of the absorption coefficient.
        absorption: Option<Placed<[f32; 3]>>,
        /// Factor of the scattering coefficient.
        scattering: Option<Placed<[f32; 3]>>,
        /// Emitted radiance, in the place of [`Medium::emission`].
        emission: Option<Placed<[f32; 3]>>,
    },
    /// pbrt-v4's cloud: noise that decreases with y.
    Cloud {
        /// Factor of the noise.
        density: f32,
        /// Strength of the displacement of the noise by other noise.
        wispiness: f32,
        /// Frequency of the noise over medium space.
        frequency: f32,
    },
    /// A number or texture by the position in space, clamped to 0 … `most`.
    Texture {
        /// The number at a point.
        of: Scalar,
        /// Its largest value.
        most: f32,
    },
}

/// Temperatures of a medium, which emits as a blackbody: Planck's law relative to its maximum, times the scales of the emission.
#[derive(Clone, Debug)]
pub struct Temperature {
    /// The numbers t of a temperature (t − offset) · scale in kelvin; below 100 K nothing is emitted.
    pub grid: Placed<f32>,
    /// Subtracted from the numbers.
    pub offset: f32,
    /// Multiplies the difference.
    pub scale: f32,
}

impl Medium {
    /// [`Medium::emission_scale`] of what emits 1 at a wavelength, as blackbodies relative to their maximum: other emission is relative to
    /// light of luminance 1.
    pub const ABSOLUTE: f32 = observer::Y_INTEGRAL as f32;

    /// A medium that does nothing.
    pub fn clear(name: impl Into<String>, at: Location) -> Self {
        Self {
            name: name.into(),
            at,
            extinction: Extinction::NONE,
            g: 0.0,
            droplets: None,
            draine: None,
            scale: 1.0,
            emission: Color::BLACK,
            emission_scale: 1.0,
            variation: None,
        }
    }

    /// Whether it may scatter light.
    pub fn scatters(&self) -> bool {
        let has_color = match self.variation.as_ref().map(|variation| &variation.density) {
            Some(Density::Colors { scattering: Some(placed), .. }) => {
                placed.grid.stored().iter().any(|rgb| *rgb != [0.0; 3])
            }
            _ => true,
        };
        self.scale > 0.0 && self.extinction.scatters() && has_color
    }

    /// Memory of its grids in bytes.
    pub fn bytes(&self) -> u64 {
        let Some(variation) = &self.variation else { return 0 };
        let density = match &variation.density {
            Density::Grid(placed) => placed.grid.bytes(),
            Density::Colors { absorption, scattering, emission } => [absorption, scattering, emission]
                .into_iter()
                .flatten()
                .map(|placed| placed.grid.bytes())
                .sum(),
            Density::Cloud { .. } | Density::Texture { .. } => 0,
        };
        let temperature = variation.temperature.as_ref().map_or(0, |of| of.grid.grid.bytes());
        let emission_scale = variation.emission_scale.as_ref().map_or(0, |placed| placed.grid.bytes());
        (density + emission_scale + temperature) as u64
    }

    /// Whether it may emit light.
    pub fn emits(&self) -> bool {
        let has_own = self.variation.as_ref().is_some_and(|variation| {
            variation.temperature.is_some()
                || matches!(&variation.density, Density::Colors { emission: Some(_), .. })
        });
        self.scale > 0.0 && self.emission_scale > 0.0 && (has_own || !is_black(self.emission))
    }
}

fn is_black(color: Color) -> bool {
    matches!(color, Color::Value(rgb) if rgb == [0.0; 3])
}

/// The media on both sides of a surface; `None` is a vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// On the side opposite to the outward normal.
    pub inside: Option<MediumId>,
    /// On the side of the outward normal.
    pub outside: Option<MediumId>,
}
