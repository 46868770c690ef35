//! Pixel filters.

/// The pixel reconstruction filter: along each axis one curve, which ends at the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// The curve.
    pub shape: FilterShape,
    /// Its radius in pixels along x and y: > 0.
    pub radius: [f32; 2],
}

/// The curve of a filter along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterShape {
    /// A constant. With a radius of half a pixel it covers exactly the pixel.
    Box,
    /// A tent function.
    Triangle,
    /// A Gaussian, shifted down so that it is 0 at the radius.
    Gaussian {
        /// Standard deviation in pixels: > 0.
        sigma: f32,
    },
    /// Mitchell & Netravali 1988, with its parameters B and C.
    Mitchell {
        /// B: blurring.
        b: f32,
        /// C: ringing.
        c: f32,
    },
    /// The four-term Blackman–Harris window.
    BlackmanHarris,
    /// A sinc, under the central lobe of a wider one (Lanczos): sharp, with ringing.
    Sinc {
        /// Half the width of the wider one in pixels: > 0.
        tau: f32,
    },
}

impl FilterShape {
    /// The filter with the same radius along both axes.
    pub const fn of_radius(self, radius: f32) -> Filter {
        Filter { shape: self, radius: [radius; 2] }
    }

    /// The word for this shape.
    pub fn word(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Triangle => "triangle",
            Self::Gaussian { .. } => "gaussian",
            Self::Mitchell { .. } => "mitchell",
            Self::BlackmanHarris => "blackman_harris",
            Self::Sinc { .. } => "sinc",
        }
    }

    /// Whether it has negative lobes with some parameters, so that samples may have different weights.
    pub fn has_negative_lobes(self) -> bool {
        matches!(self, Self::Mitchell { .. } | Self::Sinc { .. })
    }

    /// The names and values of its parameters.
    pub fn parameters(self) -> Vec<(&'static str, f32)> {
        match self {
            Self::Box | Self::Triangle | Self::BlackmanHarris => Vec::new(),
            Self::Gaussian { sigma } => vec![("sigma", sigma)],
            Self::Mitchell { b, c } => vec![("b", b), ("c", c)],
            Self::Sinc { tau } => vec![("tau", tau)],
        }
    }
}

impl Filter {
    /// The largest radius, in pixels.
    pub const WIDEST: f32 = 16.0;

    /// The filter within [`Self::WIDEST`], with a warning of one that is wider.
    pub(crate) fn narrowed(self, warn: impl FnOnce(String)) -> Self {
        let radius = self.radius.map(|radius| radius.min(Self::WIDEST));
        if radius != self.radius {
            let [x, y] = self.radius;
            warn(format!("a filter of {x} × {y} pixels around each; {} are the most", Self::WIDEST));
        }
        Self { radius, ..self }
    }

    /// The words for the filters, in scene files and on the command line, with their default radii and parameters.
    pub const WORDS: &'static [(&'static str, Self)] = &[
        ("box", FilterShape::Box.of_radius(0.5)),
        ("triangle", FilterShape::Triangle.of_radius(1.0)),
        ("gaussian", FilterShape::Gaussian { sigma: 0.5 }.of_radius(1.5)),
        ("mitchell", FilterShape::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }.of_radius(2.0)),
        ("blackman_harris", FilterShape::BlackmanHarris.of_radius(1.5)),
        ("sinc", FilterShape::Sinc { tau: 3.0 }.of_radius(4.0)),
    ];
}

/// `name:radius`, or `name:x:y` where the radii differ, and further parameters.
impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y] = self.radius;
        write!(f, "{}:{x}", self.shape.word())?;
        if x != y {
            write!(f, ":{y}")?;
        }
        self.shape.parameters().into_iter().try_for_each(|(name, value)| write!(f, " {name} {value}"))
    }
}

impl Default for Filter {
    fn default() -> Self {
        FilterShape::BlackmanHarris.of_radius(1.5)
    }
}
