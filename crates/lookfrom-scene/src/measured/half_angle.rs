//! MERL's tables of isotropic materials (Matusik et al. 2003, "A Data-Driven Reflectance Model"): a `.binary` file.
//!
//! Directions are in the coordinates of Rusinkiewicz 1998: the angle θ_h of the half vector to the normal, in cells that grow as its
//! square, the angle θ_d of light to the half vector, and the azimuth φ_d of light around it, of which the other half is the same by
//! reciprocity. Three counts of cells, little endian, are followed by all numbers of red, of green and of blue in double precision.

use crate::error::{Error, Location, Result};

/// The cells of MERL's own files: θ_h, θ_d, φ_d.
const CELLS: [usize; 3] = [90, 90, 180];

/// By what the numbers of red, green and blue are to be multiplied.
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// Length of the three counts in bytes.
const HEADER: usize = 12;

/// Values of a BRDF by half vector and difference vector.
#[derive(Clone, PartialEq)]
pub struct HalfAngle {
    /// Numbers of cells for θ_h, θ_d and φ_d.
    pub counts: [usize; 3],
    /// The values of red, green and blue in 1/sr, ≥ 0, of each cell: φ_d grows first, θ_h last. 0 where nothing was measured.
    pub values: Vec<[f32; 3]>,
}

/// Whether the counts at the begin are those that the length confirms, or MERL's own.
pub(super) fn is_half_angle_file(bytes: &[u8]) -> bool {
    counts(bytes).is_some_and(|counts| counts == CELLS || length(counts) == Some(bytes.len()))
}

fn counts(bytes: &[u8]) -> Option<[usize; 3]> {
    let counts = bytes.get(..HEADER)?.as_chunks::<4>().0;
    let count = |k: usize| usize::try_from(u32::from_le_bytes(counts[k])).ok().filter(|&count| count > 0);
    Some([count(0)?, count(1)?, count(2)?])
}

/// The length of a file with so many cells.
fn length(counts: [usize; 3]) -> Option<usize> {
    let cells = counts[0].checked_mul(counts[1])?.checked_mul(counts[2])?;
    cells.checked_mul(24)?.checked_add(HEADER)
}

impl HalfAngle {
    /// Whether there is a value for each cell.
    pub fn is_consistent(&self) -> bool {
        let [h, d, phi] = self.counts;
        let cells = h.checked_mul(d).and_then(|cells| cells.checked_mul(phi));
        cells.is_some_and(|cells| cells > 0 && cells == self.values.len())
    }

    /// The values in the bytes of a file. Negative ones, which MERL has below the horizon, become 0.
    ///
    /// # Errors
    /// `Invalid` for a file of another length than its counts say, and for numbers that are not finite.
    pub(super) fn from_bytes(bytes: &[u8], at: &Location) -> Result<Self> {
        let counts = counts(bytes).ok_or_else(|| Error::invalid(at, "the file ends within its counts"))?;
        if length(counts) != Some(bytes.len()) {
            let [h, d, phi] = counts;
            let message = format!("{} bytes for {h} × {d} × {phi} cells of three numbers", bytes.len());
            let expected = length(counts).map_or("fewer cells".into(), |length| format!("{length} bytes"));
            return Err(
                Error::invalid(at, message).hint(format!("expected {expected}: is the file cut off?"))
            );
        }
        let numbers = bytes[HEADER..].as_chunks::<8>().0;
        let cells = numbers.len() / 3;
        let number = |channel: usize, cell: usize| {
            let value = f64::from_le_bytes(numbers[channel * cells + cell]) * SCALES[channel];
            value.max(0.0) as f32
        };
        // A NaN would become 0 above.
        if !numbers.iter().all(|bytes| (f64::from_le_bytes(*bytes) as f32).is_finite()) {
            return Err(Error::invalid(at, "the tables have numbers that are not finite"));
        }
        let values = (0..cells).map(|cell| [0, 1, 2].map(|channel| number(channel, cell))).collect();
        Ok(Self { counts, values })
    }
}
