//! Numbers and colours by the place: formulas in a box, grids of files and arrays, pbrt's clouds.

use std::sync::Arc;

use glam::{DMat4, DVec3, IVec3, Vec3};

use super::Reader;
use super::evaluate::{Allowance, evaluate};
use super::expression::{Fault, parse};
use super::quantity::Quantity;
use super::shape::point;
use super::table::Table;
use super::value::Value;
use crate::error::{Location, Result};
use crate::grid::{Grid, Placed};
use crate::medium::{Density, Temperature};
use crate::npy;
use crate::vdb::VdbFile;
use crate::volume::GridClass;

/// The keys of numbers that are an array of NumPy in a box.
pub(super) const ARRAY: &[&str] = &["npy", "min", "max"];

/// The keys of temperatures besides those of their numbers.
pub(super) const KELVIN: &[&str] = &["offset", "factor"];

/// The keys of densities of colours, by the coefficients that they multiply.
pub(super) const COLORS: &[&str] = &["absorption", "scattering", "emission"];

/// The keys of pbrt's clouds.
pub(super) const CLOUD: &[&str] = &["cloud", "wispiness", "frequency"];

/// The keys of numbers by the place.
pub(super) const VOLUME: &[&str] = &["formula", "min", "max", "cells"];

/// The keys of numbers that are those of a file.
pub(super) const FILE: &[&str] = &["file", "grid"];

/// Number of cells along the longest side of a box where a file does not set it.
const CELLS: u64 = 64;

/// The names of coordinates in formulas.
const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// Numbers by the place, in a space of their own.
pub(super) struct Volume {
    pub(super) placed: Placed<f32>,
    pub(super) world_from_medium: DMat4,
    /// The box outside of which there are none.
    pub(super) bounds: [Vec3; 2],
}

/// Temperatures by the place.
pub(super) struct Hot {
    pub(super) volume: Volume,
    offset: f32,
    scale: f32,
}

impl Hot {
    pub(super) fn temperature(self) -> Temperature {
        Temperature { grid: self.volume.placed, offset: self.offset, scale: self.scale }
    }
}

impl Reader<'_, '_> {
    /// Temperatures by the place.
    pub(super) fn temperature(&mut self, value: Value<'_>) -> Result<Hot> {
        let table = value.table("temperatures by the place")?;
        let number = |key, default| table.or(key, default, Value::single);
        Ok(Hot { offset: number("offset", 0.0), scale: number("factor", 1.0), volume: self.volume(value)? })
    }

    /// Densities of colours.
    pub(super) fn colors(&mut self, table: &Table<'_>) -> Result<Density> {
        table.allow(&[COLORS]);
        let mut of = |key| {
            table.maybe(key, |value| {
                let table = value.table("colours by the place")?;
                table.allow(&[ARRAY]);
                self.placed(&table, |[r, g, b]: [f32; 3]| [r, g, b])
            })
        };
        Ok(Density::Colors {
            absorption: of("absorption"),
            scattering: of("scattering"),
            emission: of("emission"),
        })
    }

    /// The values of an array in a box: at least 0.
    fn placed<T: Copy + Default + PartialEq, const N: usize>(
        &mut self,
        table: &Table<'_>,
        of: impl Fn([f32; N]) -> T,
    ) -> Result<Placed<T>> {
        let file = table.find("npy").ok_or_else(|| table.missing("npy", "\"density.npy\""))?;
        let corner = |key, default| table.or(key, default, point);
        let bounds = [corner("min", Vec3::NEG_ONE), corner("max", Vec3::ONE)];
        table.sound(&["min", "max"])?;
        if !bounds[0].cmple(bounds[1]).all() {
            return Err(table.error_at("max", "`max` lies before `min` along an axis"));
        }
        let path = self.resolve(file, "the name of a .npy file")?;
        let bytes = self.context.read(&path).map_err(|error| file.blame(error))?;
        let (size, values) = npy::grid::<N>(&bytes, &Location::file(&path), self.context.limits.elements)?;
        let values = values.into_iter().map(|row| row.map(|number| number as f32));
        let values: Vec<[f32; N]> = values.collect();
        if values.as_flattened().iter().any(|value| !(*value >= 0.0 && value.is_finite())) {
            return Err(file.error("the array has numbers that are below 0 or not finite"));
        }
        let values: Vec<T> = values.into_iter().map(of).collect();
        let grid = Grid::from_values(size, &values);
        let grid = grid.ok_or_else(|| file.error("the array has no cells, or too many along an axis"))?;
        self.context.keep(grid.bytes() as u64, "the grid", &table.at())?;
        Ok(Placed { grid: Arc::new(grid), bounds })
    }

    /// Numbers by the place: by a formula, or a grid of a file.
    pub(super) fn volume(&mut self, value: Value<'_>) -> Result<Volume> {
        let table = value.table("numbers by the place")?;
        let more: &[&str] = if value.key() == "temperature" { KELVIN } else { &[] };
        if table.has("npy") {
            table.allow(&[ARRAY, more]);
            let placed = self.placed(&table, |[number]| number)?;
            return Ok(Volume { bounds: placed.bounds, placed, world_from_medium: DMat4::IDENTITY });
        }
        let Some(file) = table.find("file") else {
            table.allow(&[VOLUME, more]);
            let placed = formula(&table)?;
            return Ok(Volume { bounds: placed.bounds, placed, world_from_medium: DMat4::IDENTITY });
        };
        table.allow(&[FILE, more]);
        let path = self.resolve(file, "the name of a NanoVDB or OpenVDB file")?;
        let name = table.or("grid", value.key(), |value| value.text("the name of a grid"));
        let bytes = self.context.read(&path).map_err(|error| file.blame(error))?;
        let at = Location::file(&path);
        let content = VdbFile::new(&bytes, &at).map_err(|error| file.blame(error))?;
        let volume = content.volume(name, GridClass::Fog, self.context).map_err(|error| file.blame(error))?;
        // The name of the grid is written, or else that of the file with other grids.
        let named = table.find("grid").unwrap_or(file);
        let volume = volume.ok_or_else(|| named.locate(content.without(name)))?;
        Ok(Volume {
            bounds: volume.bounds.map(IVec3::as_vec3),
            world_from_medium: volume.world_from_index,
            placed: volume.into_densities(),
        })
    }
}

/// pbrt's clouds.
pub(super) fn cloud(table: &Table<'_>) -> Density {
    table.allow(&[CLOUD]);
    let number = |key, default| table.or(key, default, Value::single);
    Density::Cloud {
        density: number("cloud", 1.0),
        wispiness: number("wispiness", 1.0),
        frequency: number("frequency", 5.0),
    }
}

/// A formula in a box, at the centres of its cells.
fn formula(table: &Table<'_>) -> Result<Placed<f32>> {
    let min = table.or("min", DVec3::NEG_ONE, Value::vector);
    let max = table.or("max", DVec3::ONE, Value::vector);
    let cells = table.or("cells", CELLS, |value| value.integer(1, 256));
    let formula =
        table.need("formula", "\"1 - sqrt(x*x + y*y + z*z)\"", "0", |value| value.text("a formula"));
    table.sound(&["min", "max", "cells", "formula"])?;
    if min.cmpge(max).any() {
        return Err(table.error_at("max", format!("`max` {max} is not beyond `min` {min} along every axis")));
    }
    let size = max - min;
    let side = size.max_element() / cells as f64;
    let count = size.to_array().map(|length| (length / side).ceil().clamp(1.0, cells as f64) as u32);
    let fault = |Fault { at, message, hint }| {
        let error = table.error_at("formula", format!("at byte {at}: {message}"));
        match hint {
            Some(hint) => error.hint(hint),
            None => error.hint("x, y and z are the coordinates; functions are those of variables"),
        }
    };
    let expression = parse(formula, 0).map_err(fault)?;
    let mut values = Vec::with_capacity(count.iter().product::<u32>() as usize);
    for z in 0..count[2] {
        for y in 0..count[1] {
            for x in 0..count[0] {
                let cell = [x, y, z];
                let place: [f64; 3] = std::array::from_fn(|axis| {
                    min[axis] + size[axis] * (f64::from(cell[axis]) + 0.5) / f64::from(count[axis])
                });
                let named = |name: &str, at: usize| match COORDINATES.iter().position(|axis| *axis == name) {
                    Some(axis) => Ok(Quantity::Number(place[axis])),
                    None => Err(Fault::new(at, format!("{name:?} is no coordinate"))),
                };
                match evaluate(&expression, &named, &Allowance::default()).map_err(fault)? {
                    // What is negative, or no number, is nothing.
                    Quantity::Number(number) if number > 0.0 => values.push((number as f32).min(f32::MAX)),
                    Quantity::Number(_) => values.push(0.0),
                    other => {
                        let message = format!("it is {}; expected a number", other.what());
                        return Err(table.error_at("formula", message));
                    }
                }
            }
        }
    }
    let grid = Grid::from_values(count, &values)
        .ok_or_else(|| table.error_at("cells", "the box has too many cells".to_owned()))?;
    Ok(Placed { grid: Arc::new(grid), bounds: [min.as_vec3(), max.as_vec3()] })
}
