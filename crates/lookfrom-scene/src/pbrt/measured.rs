//! `Material "measured"`.

use std::sync::Arc;

use super::Reader;
use super::params::Parameters;
use crate::error::{ErrorKind, Result};
use crate::material::{Color, MaterialKind};
use crate::measured::Measured;

impl Reader<'_, '_> {
    /// The material of a file; of several materials of one file the tables are shared.
    pub(super) fn measured(&mut self, p: &Parameters) -> Result<MaterialKind> {
        let Some(file) = p.file_name()? else {
            let error = p.place.invalid("the material has no \"filename\"");
            return Err(error.hint("give \"string filename\" the name of a .bsdf or .binary file"));
        };
        let path = self.resolve(file);
        if let Some(known) = self.measured.get(&path) {
            return Ok(MaterialKind::Measured(known.clone()));
        }
        match Measured::read(&path, self.context).map_err(|error| p.place.blame(error)) {
            Err(error) if error.kind == ErrorKind::Io => {
                self.missing.add(&path, error)?;
                Ok(MaterialKind::Diffuse { reflectance: Color::BLACK })
            }
            read => {
                let measured = Arc::new(read?);
                self.measured.insert(path, measured.clone());
                Ok(MaterialKind::Measured(measured))
            }
        }
    }
}
