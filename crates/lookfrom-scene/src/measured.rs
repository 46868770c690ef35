//! Measured materials: tables of the RGL material database (`.bsdf`), and of MERL's (`.binary`).

mod adaptive;
mod half_angle;
mod tensor;

use std::fmt;
use std::path::Path;

pub use self::adaptive::{Adaptive, Table};
pub use self::half_angle::HalfAngle;
use crate::digest::digest;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;

/// A measured material.
#[derive(Clone, PartialEq)]
pub struct Measured {
    /// The measured values.
    pub tables: Tables,
    /// The digest of the file: equal tables have the same.
    pub digest: String,
}

/// The tables of a database, in the parameterization that it has.
#[derive(Clone, PartialEq)]
pub enum Tables {
    /// RGL's: spectra over numbers that choose visible normals.
    Adaptive(Box<Adaptive>),
    /// MERL's: colours by the half vector and the angle to it.
    HalfAngle(HalfAngle),
}

impl fmt::Debug for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Measured({})", self.digest)
    }
}

impl Measured {
    /// Whether it looks the same when the surface is turned.
    pub fn is_isotropic(&self) -> bool {
        match &self.tables {
            Tables::Adaptive(tables) => tables.is_isotropic(),
            Tables::HalfAngle(_) => true,
        }
    }

    /// Whether there are as many tables, and numbers in them, as the parameters and sizes say.
    pub fn is_consistent(&self) -> bool {
        match &self.tables {
            Tables::Adaptive(tables) => tables.is_consistent(),
            Tables::HalfAngle(tables) => tables.is_consistent(),
        }
    }

    /// Reads a file of either database.
    ///
    /// # Errors
    /// `Io`; `Syntax` for what is no such file; `Invalid` for tables that are missing, of other sizes, or have values that they cannot
    /// have; `Unsupported` for materials measured in a part of all azimuths; `Limit`.
    pub fn read(path: &Path, context: &LoadContext<'_>) -> Result<Self> {
        let bytes = context.read(path)?;
        let at = Location::file(path);
        // The file has little but its tables, which are copied.
        let _memory = context.budget.reserve(bytes.len() as u64, "the measured material", &at)?;
        Self::from_bytes(&bytes, &at)
    }

    /// As [`Self::read`], of bytes of which `at` is the file.
    ///
    /// # Errors
    /// As those of [`Self::read`].
    pub fn from_bytes(bytes: &[u8], at: &Location) -> Result<Self> {
        let tables = if tensor::is_tensor_file(bytes) {
            Tables::Adaptive(Box::new(Adaptive::from_bytes(bytes, at)?))
        } else if half_angle::is_half_angle_file(bytes) {
            Tables::HalfAngle(HalfAngle::from_bytes(bytes, at)?)
        } else {
            return Err(Error::new(ErrorKind::Syntax, at, "not a file of measured tables").hint(
                "one begins with \"tensor_file\", as the .bsdf files of the RGL material database do, or with three numbers of cells that \
                 its length confirms, as MERL's .binary",
            ));
        };
        Ok(Self { tables, digest: digest(bytes) })
    }
}

#[cfg(test)]
pub(crate) mod tests;
