//! Volumes: constant ones, and grids of `.vol` files of version 3.

use std::path::Path;
use std::rc::Rc;

use glam::{DMat4, DVec3};

use super::Reader;
use super::plugin::{Plugin, Property, Value};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::spectrum::Curve;

const KINDS: &[&str] = &["constvolume", "gridvolume"];

/// Numbers or colours in space.
pub(super) struct Volume {
    /// From the unit cube, which it fills, to the world.
    pub(super) world_from_cube: DMat4,
    /// Its cells; a single one is the same everywhere.
    pub(super) lattice: Lattice,
}

/// Values at the centres of cells of the unit cube, trilinear in between, those of the outermost cells beyond them.
pub(super) struct Lattice {
    pub(super) size: [u32; 3],
    /// Numbers, or colours in linear Rec. 709: 1 or 3.
    pub(super) channels: usize,
    /// x fastest, then y and z.
    values: Vec<f32>,
}

impl Lattice {
    #[cfg(test)]
    pub(super) fn new(size: [u32; 3], channels: usize, values: Vec<f32>) -> Self {
        Self { size, channels, values }
    }

    pub(super) fn even(rgb: [f32; 3]) -> Self {
        Self { size: [1; 3], channels: 3, values: rgb.to_vec() }
    }

    pub(super) fn is_even(&self) -> bool {
        self.size == [1; 3]
    }

    /// The colour of a cell, that of the nearest one outside of the cube.
    pub(super) fn cell(&self, cell: [i64; 3]) -> [f32; 3] {
        let [x, y, z] = std::array::from_fn(|axis| cell[axis].clamp(0, i64::from(self.size[axis]) - 1));
        let index = x + i64::from(self.size[0]) * (y + i64::from(self.size[1]) * z);
        let first = index as usize * self.channels;
        std::array::from_fn(|channel| self.values[first + channel.min(self.channels - 1)])
    }

    /// The colour at a point of the unit cube.
    pub(super) fn at(&self, point: DVec3) -> [f32; 3] {
        let place: [f64; 3] = std::array::from_fn(|axis| point[axis] * f64::from(self.size[axis]) - 0.5);
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let step = |axis: usize| i64::from(corner >> axis & 1);
            let weight: f64 = (0..3)
                .map(|axis| 1.0 - (place[axis] - place[axis].floor() - step(axis) as f64).abs())
                .product();
            let rgb = self.cell(std::array::from_fn(|axis| place[axis].floor() as i64 + step(axis)));
            sum = std::array::from_fn(|c| sum[c] + weight * f64::from(rgb[c]));
        }
        sum.map(|value| value as f32)
    }
}

impl Reader<'_, '_> {
    /// A volume, or a colour that is the same everywhere.
    pub(super) fn volume(&mut self, plugin: &Plugin, name: &str, default: f32) -> Result<Volume> {
        let even = |rgb| Volume { world_from_cube: DMat4::IDENTITY, lattice: Lattice::even(rgb) };
        let Some(property) = plugin.find(name) else { return Ok(even([default; 3])) };
        if let Some(rgb) = even_color(property) {
            return Ok(even(rgb));
        }
        match property.plugin(&self.ids)? {
            Some(volume) => self.volume_plugin(&volume),
            None => Err(property.wrong("a colour of at least 0, or a <volume>")),
        }
    }

    fn volume_plugin(&mut self, plugin: &Rc<Plugin>) -> Result<Volume> {
        let world_from_cube = plugin.to_world()?;
        match &*plugin.kind {
            "constvolume" => {
                let Volume { lattice, .. } = self.volume(plugin, "value", 1.0)?;
                Ok(Volume { world_from_cube, lattice })
            }
            "gridvolume" => {
                plugin.ignore(&["accel", "raw"]);
                plugin.choice("filter_type", (), &[("trilinear", ())])?;
                plugin.choice("wrap_mode", (), &[("clamp", ())])?;
                let (path, at) = self.file(plugin)?;
                let grid = self.volume_grid(&path, &at, 0.0)?;
                let has_own_box = plugin.boolean("use_grid_bbox", false)?;
                let cube = if has_own_box { grid.world_from_cube } else { DMat4::IDENTITY };
                Ok(Volume { world_from_cube: world_from_cube * cube, lattice: grid.lattice })
            }
            _ => Err(plugin.unsupported(KINDS)),
        }
    }

    /// The numbers of a file, of which none is less than `least`, in the box that it names.
    pub(super) fn volume_grid(&mut self, path: &Path, at: &Location, least: f32) -> Result<Volume> {
        let bytes = self.context.read(path).map_err(|error| super::xml::blame(error, at))?;
        let grid = grid(&bytes, path, least)?;
        self.context.keep(grid.lattice.values.len() as u64 * 4, "cells of a volume", at)?;
        Ok(grid)
    }
}

/// The colour, at least 0, that a property is everywhere, unless it is a plugin.
pub(super) fn even_color(property: &Property) -> Option<[f32; 3]> {
    match &property.value {
        Value::Color(rgb) => Some(*rgb),
        Value::Curve(Curve::Constant(value)) => Some([*value; 3]),
        Value::Float(value) if *value >= 0.0 => Some([*value as f32; 3]),
        _ => None,
    }
}

/// The numbers of a file, in the box that it names.
///
/// # Errors
/// `Syntax` for bytes that are no such file or too few, `Invalid` for numbers below `least` or not finite, `Unsupported` for other
/// types of numbers.
fn grid(bytes: &[u8], path: &Path, least: f32) -> Result<Volume> {
    const HEADER: usize = 48;
    let at = Location::file(path);
    if bytes.len() < HEADER || !bytes.starts_with(b"VOL") {
        let error = Error::syntax(&at, "no volume: expected a file that begins with VOL");
        return Err(error.hint("Mitsuba's `VolumeGrid.write` makes such files"));
    }
    let word = |place: usize| -> [u8; 4] { std::array::from_fn(|byte| bytes[place + byte]) };
    let whole = |place| i32::from_le_bytes(word(place));
    let single = |place| f32::from_le_bytes(word(place));
    if (bytes[3], whole(4)) != (3, 1) {
        let message = format!("a volume of version {} with the encoding {}", bytes[3], whole(4));
        let error = Error::new(ErrorKind::Unsupported, &at, message);
        return Err(error.hint("version 3 with the encoding 1, numbers of 32 bits, is supported"));
    }
    let (size, channels) = ([8, 12, 16].map(whole), whole(20));
    let cells = size.iter().try_fold(1_u64, |product, &cells| {
        product.checked_mul(u64::try_from(cells).ok().filter(|cells| *cells > 0)?)
    });
    let Some(cells) = cells.filter(|_| matches!(channels, 1 | 3)) else {
        let message =
            format!("a volume of {size:?} cells with {channels} channels; expected 1 or 3 channels");
        return Err(Error::invalid(&at, message));
    };
    let data = &bytes[HEADER..];
    if cells.checked_mul(channels as u64 * 4) != Some(data.len() as u64) {
        let message = format!("{} bytes of numbers for {size:?} cells with {channels} channels", data.len());
        return Err(Error::syntax(&at, message).hint("the file is damaged: write it again"));
    }
    let values: Vec<f32> =
        data.chunks_exact(4).map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect();
    if let Some(value) = values.iter().find(|value| !(**value >= least && value.is_finite())) {
        return Err(Error::invalid(
            &at,
            format!(
                "a volume with the number {value}; expected finite ones{}",
                if least == 0.0 { " of at least 0" } else { "" }
            ),
        ));
    }
    let [low, high] =
        [24, 36].map(|place| DVec3::from([0, 4, 8].map(|step| f64::from(single(place + step)))));
    let world_from_cube = DMat4::from_translation(low) * DMat4::from_scale(high - low);
    if !(world_from_cube.is_finite() && (high - low).min_element() > 0.0) {
        return Err(Error::invalid(&at, format!("a volume with the box from {low} to {high}")));
    }
    let lattice = Lattice { size: size.map(|cells| cells as u32), channels: channels as usize, values };
    Ok(Volume { world_from_cube, lattice })
}
