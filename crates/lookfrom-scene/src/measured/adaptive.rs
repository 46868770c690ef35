//! The adaptive parameterization of the RGL material database (Dupuy & Jakob 2018, "An Adaptive Parameterization for Efficient Material
//! Acquisition and Rendering"): tables of a `.bsdf` file.
//!
//! Directions are two numbers in 0 … 1: `√(2 θ / π)` by the angle to the normal, and `(φ + π) / 2π` around it. In rows of a table the second
//! grows, in columns the first.

use super::tensor::{Field, Tensors};
use crate::error::{Error, ErrorKind, Location, Result};

/// Tables over numbers that choose visible normals.
#[derive(Clone, PartialEq)]
pub struct Adaptive {
    /// Azimuths of outgoing directions for which there are tables, in radians: increasing. One or two where the material is isotropic.
    pub phi: Vec<f32>,
    /// Angles of outgoing directions to the normal, in radians: increasing.
    pub theta: Vec<f32>,
    /// Wavelengths of spectra in nm: increasing.
    pub wavelengths: Vec<f32>,
    /// The distribution of microfacet normals.
    pub ndf: Table,
    /// The projected area of microfacets, by the outgoing direction.
    pub sigma: Table,
    /// The density of visible normals, for each φ and θ.
    pub vndf: Table,
    /// The density of normals by what they reflect, over the numbers that choose one of [`Self::vndf`]; for each φ and θ.
    pub luminance: Table,
    /// The reflectance at each wavelength, over the same numbers; for each φ, θ and wavelength.
    pub spectra: Table,
}

/// Tables of numbers ≥ 0, one after another.
#[derive(Clone, PartialEq)]
pub struct Table {
    /// Columns and rows of each: at least two.
    pub size: [usize; 2],
    /// Row by row.
    pub values: Vec<f32>,
}

impl Table {
    /// Number of values in each.
    pub fn area(&self) -> usize {
        self.size[0] * self.size[1]
    }
}

impl Adaptive {
    /// Whether it looks the same when the surface is turned.
    pub fn is_isotropic(&self) -> bool {
        self.phi.len() <= 2
    }

    /// Whether there are as many tables, and numbers in them, as the parameters and sizes say.
    pub fn is_consistent(&self) -> bool {
        let directions = self.phi.len() * self.theta.len();
        let has = |table: &Table, count: usize| {
            table.size.iter().all(|&side| side >= 2)
                && table.values.len() == table.area() * count
                && count > 0
        };
        has(&self.ndf, 1)
            && has(&self.sigma, 1)
            && has(&self.vndf, directions)
            && has(&self.luminance, directions)
            && has(&self.spectra, directions * self.wavelengths.len())
    }

    /// The tables in the bytes of a file.
    ///
    /// # Errors
    /// `Syntax` for what is no such file; `Invalid` for tables that are missing, of other sizes, or have values that are negative or not
    /// finite; `Unsupported` for materials measured in a part of all azimuths.
    pub(super) fn from_bytes(bytes: &[u8], at: &Location) -> Result<Self> {
        let tensors = Tensors::new(bytes, at)?;
        let axis = |name| increasing(&tensors.floats(name, 1)?, name, at);
        let (phi, theta, wavelengths) = (axis("phi_i")?, axis("theta_i")?, axis("wavelengths")?);
        if phi.len() > 2 {
            let share = std::f32::consts::TAU / (phi[phi.len() - 1] - phi[0]);
            if share.round() != 1.0 {
                let message = format!("this material was measured in 1/{share:.0} of all azimuths");
                return Err(Error::new(ErrorKind::Unsupported, at, message).hint(
                    "the tables of all of them are needed, as most materials of the database have them",
                ));
            }
        }
        let directions = [phi.len(), theta.len()];
        let tables = Self {
            ndf: table(&tensors.floats("ndf", 2)?, "ndf", &[], at)?,
            sigma: table(&tensors.floats("sigma", 2)?, "sigma", &[], at)?,
            vndf: table(&tensors.floats("vndf", 4)?, "vndf", &directions, at)?,
            luminance: table(&tensors.floats("luminance", 4)?, "luminance", &directions, at)?,
            spectra: table(
                &tensors.floats("spectra", 5)?,
                "spectra",
                &[directions[0], directions[1], wavelengths.len()],
                at,
            )?,
            phi,
            theta,
            wavelengths,
        };
        if tables.luminance.size != tables.spectra.size {
            return Err(Error::invalid(at, "\"luminance\" and \"spectra\" have tables of different sizes"));
        }
        Ok(tables)
    }
}

fn increasing(field: &Field<'_>, name: &str, at: &Location) -> Result<Vec<f32>> {
    let numbers: Vec<f32> = field.values().collect();
    let is_increasing = numbers.windows(2).all(|pair| pair[0] < pair[1]);
    match !numbers.is_empty() && is_increasing && numbers.iter().all(|number| number.is_finite()) {
        true => Ok(numbers),
        false => Err(Error::invalid(at, format!("the numbers of {name:?} do not increase"))),
    }
}

/// The tables of a field, one for each combination of what its first dimensions count.
fn table(field: &Field<'_>, name: &str, of: &[usize], at: &Location) -> Result<Table> {
    let (first, last) = field.shape.split_at(field.shape.len() - 2);
    if first != of {
        let message = format!("{name:?} has tables for {first:?} parameters; expected {of:?}");
        return Err(Error::invalid(at, message));
    }
    if last.iter().any(|&count| count < 2) {
        return Err(Error::invalid(at, format!("a table of {name:?} has less than two rows or columns")));
    }
    let values: Vec<f32> = field.values().collect();
    match values.iter().all(|value| value.is_finite() && *value >= 0.0) {
        true => Ok(Table { size: [last[1], last[0]], values }),
        false => Err(Error::invalid(at, format!("{name:?} has numbers that are negative or not finite"))),
    }
}
