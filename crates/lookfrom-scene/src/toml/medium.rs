//! `[media]`: participating media, and the bodies that they fill.

use std::sync::Arc;

use glam::{DMat4, DVec3, IVec3, Vec3};

use super::evaluate::{Allowance, evaluate};
use super::expression::{Fault, parse};
use super::quantity::Quantity;
use super::table::Table;
use super::value::Value;
use super::{Reader, transform};
use crate::error::Result;
use crate::grid::{Grid, Placed};
use crate::material::{Color, Material, MaterialKind, Scalar};
use crate::medium::presets::Preset;
use crate::medium::{DROPLETS, Density, Medium, Temperature, Variation};
use crate::nanovdb;
use crate::scene::{MaterialId, MediumId};

/// The keys of media, besides those of transforms.
pub(super) const KEYS: &[&str] = &[
    "preset",
    "absorption",
    "scattering",
    "g",
    "droplets",
    "density",
    "max_density",
    "emission",
    "temperature",
];

/// The keys of numbers by the place.
pub(super) const VOLUME: &[&str] = &["formula", "min", "max", "cells"];

/// The keys of numbers that are those of a file.
pub(super) const FILE: &[&str] = &["file", "grid"];

/// Number of cells along the longest side of a box where a file does not set it.
const CELLS: u64 = 64;

/// The names of coordinates in formulas.
const COORDINATES: [&str; 3] = ["x", "y", "z"];

impl Reader<'_, '_> {
    /// Reads `[media]`.
    pub(super) fn read_media(&mut self, value: Value<'_>) {
        self.knows_all_names &= value.is_table();
        for entry in value.named("[media]") {
            let name = entry.key();
            let id = MediumId(self.scene.media.len() as u32);
            if let Some(before) = self.media.insert(name.to_owned(), id) {
                entry.note(super::twice(entry, "medium", &self.scene.media[before.index()].at));
            }
            let table = entry.table(format!("[media.{name}]"));
            let medium = match entry.noting(table.map(Some), None) {
                Some(table) => self.medium(name, &table),
                None => Medium::clear(name, entry.at()),
            };
            self.scene.media.push(medium);
        }
    }

    fn medium(&mut self, name: &str, table: &Table<'_>) -> Medium {
        table.allow(&[KEYS, transform::KEYS]);
        let mut medium = Medium::clear(name, table.at());
        let preset = table.maybe("preset", preset);
        let [absorption, scattering] =
            preset.map_or([[0.0; 3]; 2], |preset| [preset.absorption, preset.scattering]).map(Color::Value);
        medium.absorption = table.or("absorption", absorption, |value| self.coefficient(value));
        medium.scattering = table.or("scattering", scattering, |value| self.coefficient(value));
        table.one_of(&["g", "droplets"]);
        medium.g = table.or("g", 0.0, |value| {
            value.single_where("a number between -1 and 1, exclusive", |g| g.abs() < 1.0)
        });
        medium.droplets = table.maybe("droplets", |value| {
            let what = "a diameter in micrometres, of 0.1 to 50";
            value.single_where(what, |diameter| DROPLETS.contains(&diameter))
        });
        let density = table.maybe("density", |value| self.density(value, table));
        let temperature = table.maybe("temperature", |value| self.volume(value));
        (medium.emission, medium.emission_scale) = match temperature {
            None => table.or("emission", (Color::BLACK, 1.0), |value| self.light_color(value, false)),
            Some(_) => {
                let factor = table.or("emission", 1.0, |value| {
                    value.single_where("a factor of at least 0", |factor| factor >= 0.0)
                });
                (Color::BLACK, factor * Medium::ABSOLUTE)
            }
        };
        let density = match density {
            Some(Number::Volume(volume)) => {
                medium.variation = Some(variation(table, volume, temperature));
                return medium;
            }
            Some(Number::Varying(density)) => Some(density),
            Some(Number::Even(density)) => {
                medium.scale = density;
                None
            }
            None => None,
        };
        if density.is_none() && temperature.is_none() {
            return medium;
        }
        let own = temperature.as_ref().map_or(DMat4::IDENTITY, |volume| volume.world_from_medium);
        medium.variation = Some(Variation {
            world_from_medium: transform::world_from_object(table) * own,
            bounds: temperature.as_ref().map(|volume| volume.bounds),
            density: density.unwrap_or(Density::Texture { of: Scalar::Value(1.0), most: 1.0 }),
            emission_scale: None,
            temperature: temperature.map(Volume::temperature),
        });
        medium
    }

    /// A coefficient per unit of length: the same everywhere.
    fn coefficient(&mut self, value: Value<'_>) -> Result<Color> {
        match self.optical_color(value)? {
            Color::Texture(_) => Err(value
                .error(format!("`{}` is a texture; expected a number or a colour", value.key()))
                .hint("what varies is the `density`")),
            color => Ok(color),
        }
    }

    /// A density: a number, a texture, or numbers by the place.
    fn density(&mut self, value: Value<'_>, table: &Table<'_>) -> Result<Number> {
        if value.is_table() && !value.table("a density")?.has("type") {
            return Ok(Number::Volume(self.volume(value)?));
        }
        let most = table.or("max_density", 1.0, |value| {
            value.single_where("a number greater than 0", |most| most > 0.0 && most.is_finite())
        });
        Ok(match self.scalar_where(value, "a number of at least 0", |density| density >= 0.0)? {
            Scalar::Value(density) => Number::Even(density),
            of => Number::Varying(Density::Texture { of, most }),
        })
    }

    /// Numbers by the place: by a formula, or a grid of a file.
    fn volume(&mut self, value: Value<'_>) -> Result<Volume> {
        let table = value.table("numbers by the place")?;
        let Some(file) = table.find("file") else {
            table.allow(&[VOLUME]);
            let placed = formula(&table)?;
            return Ok(Volume { bounds: placed.bounds, placed, world_from_medium: DMat4::IDENTITY });
        };
        table.allow(&[FILE]);
        let path = self.resolve(file, "the name of a NanoVDB file")?;
        let name = table.or("grid", value.key(), |value| value.text("the name of a grid"));
        let volume = nanovdb::read(&path, name, self.context).map_err(|error| file.blame(error))?;
        let (faces, bounds) = (volume.faces(), volume.bounds.map(IVec3::as_vec3));
        // What is negative is nothing.
        let grid = Arc::new(volume.grid.map(|number| number.max(0.0)));
        Ok(Volume {
            placed: Placed { grid, bounds: faces },
            world_from_medium: volume.world_from_index,
            bounds,
        })
    }

    /// The medium with the name in `value`.
    pub(super) fn medium_named(&self, value: Value<'_>) -> Result<MediumId> {
        let name = value.text("the name of a medium")?;
        self.named(&self.media, "medium", value, name)
    }

    /// A material, or where there is none an interface, of bodies that are filled with a medium.
    pub(super) fn filled(&mut self, material: Option<MaterialId>, medium: MediumId) -> MaterialId {
        if let Some(&id) = self.filled.get(&(material, medium)) {
            return id;
        }
        let written = match material {
            Some(id) => self.scene.materials[id.index()].clone(),
            None => {
                let Medium { name, at, .. } = &self.scene.media[medium.index()];
                Material::new(name.clone(), at.clone(), MaterialKind::Interface)
            }
        };
        let id = MaterialId(self.scene.materials.len() as u32);
        self.scene.materials.push(Material { medium: Some(medium), ..written });
        self.filled.insert((material, medium), id);
        id
    }
}

/// The measured medium with the name in `value`.
pub(super) fn preset(value: Value<'_>) -> Result<&'static Preset> {
    let known: Vec<_> = Preset::all().iter().map(|preset| (preset.name, preset)).collect();
    value.choice(&known)
}

/// A number that may vary.
enum Number {
    Even(f32),
    Varying(Density),
    Volume(Volume),
}

/// Numbers by the place, in a space of their own.
struct Volume {
    placed: Placed<f32>,
    world_from_medium: DMat4,
    /// The box outside of which there are none.
    bounds: [Vec3; 2],
}

impl Volume {
    /// As temperatures.
    fn temperature(self) -> Temperature {
        Temperature { grid: self.placed, offset: 0.0, scale: 1.0 }
    }
}

/// Densities of a grid, and temperatures of another.
fn variation(table: &Table<'_>, density: Volume, temperature: Option<Volume>) -> Variation {
    let mut bounds = density.bounds;
    let temperature = temperature.and_then(|mut hot| {
        let place = nanovdb::placement(&density.world_from_medium, &hot.world_from_medium, hot.bounds);
        if place.is_none() {
            table.note(table.error_at("temperature", "its axes are not those of `density`"));
        }
        let place = place?;
        let [low, high] = hot.bounds.map(&place);
        bounds = [bounds[0].min(low), bounds[1].max(high)];
        hot.placed.bounds = hot.placed.bounds.map(&place);
        Some(hot.temperature())
    });
    Variation {
        world_from_medium: transform::world_from_object(table) * density.world_from_medium,
        bounds: Some(bounds),
        density: Density::Grid(density.placed),
        emission_scale: None,
        temperature,
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
