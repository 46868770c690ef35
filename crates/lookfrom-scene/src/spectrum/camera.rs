//! Spectral responses of digital cameras, and the reflectances used to calibrate them.
//!
//! The numbers are in `sensors.txt` and `swatches.txt`, which name their sources. The crate `lookfrom` applies the sensors
//! to light.

use super::Curve;

const SENSORS: &str = include_str!("sensors.txt");
const SWATCHES: &str = include_str!("swatches.txt");

/// First wavelength and wavelength step of both tables, in nm.
const FIRST: f32 = 380.0;
const STEP: f32 = 10.0;
/// Number of wavelengths of a response.
const SAMPLES: usize = 35;

/// A camera sensor with known spectral responses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CameraSensor {
    name: &'static str,
    numbers: &'static str,
}

impl CameraSensor {
    /// All known sensors.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        let tables = SENSORS.split("\n\n").skip(1).filter_map(|table| table.split_once('\n'));
        tables.map(|(name, numbers)| Self { name, numbers })
    }

    /// The sensor with this name, such as `canon_eos_5d_mkiv`.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|sensor| sensor.name == name)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Responses of red, green and blue pixels to light of spectral density 1 at a wavelength; that of green at 520 nm is 1.
    pub fn responses(self) -> [Curve; 3] {
        let values = numbers(self.numbers);
        std::array::from_fn(|channel| curve(values[channel * SAMPLES..][..SAMPLES].to_vec()))
    }
}

/// The reflectances of the 24 swatches of a ColorChecker.
pub fn swatches() -> impl Iterator<Item = Curve> {
    SWATCHES.lines().filter(|line| !line.starts_with('#')).map(|line| curve(numbers(line)))
}

/// A table, extended with its first and last value to all visible wavelengths, as in pbrt-v4.
fn curve(values: Vec<f32>) -> Curve {
    let wavelengths = (0..values.len()).map(|i| FIRST + STEP * i as f32).collect();
    Curve::Tabulated { wavelengths, values }.extended()
}

fn numbers(text: &str) -> Vec<f32> {
    text.split_whitespace().map(|word| word.parse().expect("a number of our own")).collect()
}
