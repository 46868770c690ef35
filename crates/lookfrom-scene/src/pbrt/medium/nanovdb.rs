//! Media of the type `nanovdb`: densities and temperatures of a file.

use std::sync::Arc;

use glam::{DMat4, DVec3, IVec3, Vec3};

use super::super::Reader;
use super::super::params::Parameters;
use super::{UNSCALED, temperature};
use crate::error::{ErrorKind, Location, Result};
use crate::grid::Placed;
use crate::medium::{Density, Medium, Temperature, Variation};
use crate::nanovdb::{NanoVdb, Volume};

/// A map that moves the corners of a grid by less than this part of a cell from where scale and offset place them turns nothing.
const LEAST_TURN: f64 = 1.0 / 1024.0;

impl Reader<'_, '_> {
    /// How a medium varies, in index space of the densities; `None` if its file is missing.
    pub(super) fn nano_vdb(&mut self, p: &Parameters, medium: &mut Medium) -> Result<Option<Variation>> {
        let scale = p.float_where("Lescale", 1.0, "a number of at least 0", |v| v >= 0.0)?;
        let name = p.string("gridname")?.unwrap_or("density");
        let Some(file) = p.string("filename")?.filter(|file| !file.is_empty()) else {
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
        let file = NanoVdb::new(&bytes, &at).map_err(|error| p.place.blame(error))?;
        let density = file.volume(name, self.context).map_err(|error| p.place.blame(error))?;
        let density = density.ok_or_else(|| file.without(name))?;
        let mut bounds = density.bounds.map(IVec3::as_vec3);
        let mut temperature = None;
        if let Some((hot, [low, high])) = self.temperatures(p, &file, &density)? {
            bounds = [bounds[0].min(low), bounds[1].max(high)];
            temperature = Some(hot);
        }
        medium.emission_scale = scale * UNSCALED;
        Ok(Some(Variation {
            world_from_medium: self.state.matrix * density.world_from_index,
            bounds: Some(bounds),
            density: Density::Grid(self.densities(density, &at)),
            emission_scale: None,
            temperature,
        }))
    }

    /// The temperatures of a file, if it has them, and the box of their grid; both in index space of the densities.
    fn temperatures(
        &mut self,
        p: &Parameters,
        file: &NanoVdb<'_>,
        density: &Volume,
    ) -> Result<Option<(Temperature, [Vec3; 2])>> {
        let name = p.string("temperaturename")?.unwrap_or("temperature");
        let Some(volume) = file.volume(name, self.context).map_err(|error| p.place.blame(error))? else {
            if p.has("temperaturename") {
                let message = format!("{}: the medium does not emit", file.without(name).message);
                self.context.warn(&p.place.location(), message);
            }
            p.ignore(&["temperatureoffset", "temperaturecutoff", "temperaturescale"]);
            return Ok(None);
        };
        let place = placement(density, &volume)
            .ok_or_else(|| p.refuse("temperaturename", "a grid whose axes are those of the densities"))?;
        let (bounds, faces) =
            (volume.bounds.map(|corner| place(corner.as_vec3())), volume.faces().map(place));
        let grid = Placed { grid: Arc::new(volume.grid), bounds: faces };
        Ok(Some((temperature(p, grid)?, bounds)))
    }

    /// The values of a grid of densities, of which those below zero become zero.
    fn densities(&mut self, volume: Volume, at: &Location) -> Placed<f32> {
        let bounds = volume.faces();
        let mut grid = volume.grid;
        if grid.stored().iter().any(|value| *value < 0.0) {
            self.context.warn(at, "densities below 0 are read as 0");
            grid = grid.map(|value| value.max(0.0));
        }
        Placed { grid: Arc::new(grid), bounds }
    }
}

/// From the index space of a grid to that of another; `None` if that is more than a scale, which mirrors nothing, and an offset.
fn placement(into: &Volume, from: &Volume) -> Option<impl Fn(Vec3) -> Vec3> {
    let map = if into.world_from_index == from.world_from_index {
        DMat4::IDENTITY
    } else {
        into.world_from_index.inverse() * from.world_from_index
    };
    let scale = DVec3::new(map.x_axis.x, map.y_axis.y, map.z_axis.z);
    let offset = map.w_axis.truncate();
    let straight = |corner: IVec3| {
        let corner = corner.as_dvec3();
        (map.transform_point3(corner) - (corner * scale + offset)).abs().max_element() < LEAST_TURN
    };
    let [low, high] = from.bounds;
    let corners = (0..8).map(|bits| IVec3::new(bits & 1, bits >> 1 & 1, bits >> 2) * (high - low) + low);
    let is_straight = scale.cmpgt(DVec3::ZERO).all() && corners.into_iter().all(straight);
    is_straight.then_some(move |point: Vec3| (point.as_dvec3() * scale + offset).as_vec3())
}
