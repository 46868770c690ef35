//! Spectral responses of digital cameras, and the reflectances by which cameras are calibrated.
//!
//! The numbers are in `sensors.txt` and `swatches.txt`, which name their sources. Crate `lookfrom` applies the sensors to
//! light.

use super::Curve;

const SENSORS: &str = include_str!("sensors.txt");
const SWATCHES: &str = include_str!("swatches.txt");

/// Wavelengths of both tables, in nm: the first, and from one to the next.
const FIRST: f32 = 380.0;
const STEP: f32 = 10.0;
/// Wavelengths of a response.
const SAMPLES: usize = 35;

/// The sensor of a camera whose spectral responses are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CameraSensor {
    name: &'static str,
    numbers: &'static str,
}

impl CameraSensor {
    /// Every sensor there is.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        let tables = SENSORS.split("\n\n").skip(1).filter_map(|table| table.split_once('\n'));
        tables.map(|(name, numbers)| Self { name, numbers })
    }

    /// The sensor of that name, as `canon_eos_5d_mkiv`.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|sensor| sensor.name == name)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// What red, green and blue pixels make of light of density 1 at a wavelength; the response of green at 520 nm is 1.
    pub fn responses(self) -> [Curve; 3] {
        let values = numbers(self.numbers);
        std::array::from_fn(|channel| curve(values[channel * SAMPLES..][..SAMPLES].to_vec()))
    }
}

/// The reflectances of the 24 swatches of a ColorChecker.
pub fn swatches() -> impl Iterator<Item = Curve> {
    SWATCHES.lines().filter(|line| !line.starts_with('#')).map(|line| curve(numbers(line)))
}

fn curve(values: Vec<f32>) -> Curve {
    Curve::Tabulated { wavelengths: (0..values.len()).map(|i| FIRST + STEP * i as f32).collect(), values }
}

fn numbers(text: &str) -> Vec<f32> {
    text.split_whitespace().map(|word| word.parse().expect("a number of our own")).collect()
}
