//! Media of the type `nanovdb`: densities and temperatures of a file.

use std::sync::Arc;

use glam::{IVec3, Vec3};

use super::super::Reader;
use super::super::params::Parameters;
use super::temperature;
use crate::error::{ErrorKind, Location, Result};
use crate::grid::Placed;
use crate::medium::{Density, Medium, Temperature, Variation};
use crate::vdb::VdbFile;
use crate::volume::{GridClass, Volume, placement};

impl Reader<'_, '_> {
    /// Variation of a medium, in index space of the densities; `None` if its file is missing.
    pub(super) fn nano_vdb(&mut self, p: &Parameters, medium: &mut Medium) -> Result<Option<Variation>> {
        let scale = p.float_where("Lescale", 1.0, "a number of at least 0", |v| v >= 0.0)?;
        let name = p.string("gridname")?.unwrap_or("density");
        let Some(file) = p.file_name()? else {
            return Err(p.place.invalid("the medium has no \"filename\""));
        };
        let path = self.resolve(file);
        let bytes = match self.context.read(&path) {
            Err(error) if error.kind == ErrorKind::Io => {
                self.missing.add(&path, p.place.blame(error))?;
                return Ok(None);
            }
            bytes => bytes.map_err(|error| p.place.blame(error))?,
        };
        let at = Location::file(&path);
        let file = VdbFile::new(&bytes, &at).map_err(|error| p.place.blame(error))?;
        let density =
            file.volume(name, GridClass::Fog, self.context).map_err(|error| p.place.blame(error))?;
        let density = density.ok_or_else(|| p.place.locate(file.without(name)))?;
        let mut bounds = density.bounds.map(IVec3::as_vec3);
        let mut temperature = None;
        if let Some((hot, [low, high])) = self.temperatures(p, &file, &density)? {
            bounds = [bounds[0].min(low), bounds[1].max(high)];
            temperature = Some(hot);
        }
        if density.has_negatives() {
            self.context.warn(&at, "densities below 0 are read as 0");
        }
        medium.emission_scale = scale * Medium::ABSOLUTE;
        Ok(Some(Variation {
            world_from_medium: self.state.matrix * density.world_from_index,
            bounds: Some(bounds),
            density: Density::Grid(density.into_densities()),
            emission_scale: None,
            temperature,
        }))
    }

    /// The temperatures of a file, if it has them, and the box of their grid; both in index space of the densities.
    fn temperatures(
        &mut self,
        p: &Parameters,
        file: &VdbFile<'_>,
        density: &Volume,
    ) -> Result<Option<(Temperature, [Vec3; 2])>> {
        let name = p.string("temperaturename")?.unwrap_or("temperature");
        let Some(volume) =
            file.volume(name, GridClass::Fog, self.context).map_err(|error| p.place.blame(error))?
        else {
            if p.has("temperaturename") {
                let message = format!("{}: the medium does not emit", file.without(name).message);
                self.context.warn(&p.place.location(), message);
            }
            p.ignore(&["temperatureoffset", "temperaturecutoff", "temperaturescale"]);
            return Ok(None);
        };
        let corners = volume.bounds.map(IVec3::as_vec3);
        let place = placement(&density.world_from_index, &volume.world_from_index, corners)
            .ok_or_else(|| p.refuse("temperaturename", "a grid whose axes are those of the densities"))?;
        let (bounds, faces) =
            (volume.bounds.map(|corner| place(corner.as_vec3())), volume.faces().map(place));
        let grid = Placed { grid: Arc::new(volume.grid), bounds: faces };
        Ok(Some((temperature(p, grid)?, bounds)))
    }
}
