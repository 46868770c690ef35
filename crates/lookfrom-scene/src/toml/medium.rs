//! `[media]`: participating media, and the bodies that they fill.

use std::sync::Arc;

use glam::{DMat4, DVec3, IVec3, Vec3};

use super::evaluate::{Allowance, evaluate};
use super::expression::{Fault, parse};
use super::quantity::Quantity;
use super::table::Table;
use super::value::Value;
use super::{Reader, transform};
use crate::error::{Location, Result};
use crate::grid::{Grid, Placed};
use crate::material::{Color, Material, MaterialKind, Scalar};
use crate::medium::presets::Preset;
use crate::medium::{DROPLETS, Density, Medium, Temperature, Variation};
use crate::scene::{MaterialId, MediumId};
use crate::{nanovdb, npy};

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
    "density_scale",
    "emission_scale",
    "emission_density",
    "bounds",
];

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
        let temperature = table.maybe("temperature", |value| self.temperature(value));
        (medium.emission, medium.emission_scale) = match temperature {
            None => table.or("emission", (Color::BLACK, 1.0), |value| self.light_color(value, false)),
            Some(_) => {
                let factor = table.or("emission", 1.0, |value| {
                    value.single_where("a factor of at least 0", |factor| factor >= 0.0)
                });
                (Color::BLACK, factor * Medium::ABSOLUTE)
            }
        };
        let factor = |value: Value<'_>| value.single_where("a number of at least 0", |factor| factor >= 0.0);
        medium.emission_scale = table.or("emission_scale", medium.emission_scale, factor);
        medium.scale = table.or("density_scale", 1.0, factor);
        if let Some(Number::Even(density)) = density {
            medium.scale *= density;
        }
        let emission_density =
            table.maybe("emission_density", |value| self.volume(value)).map(|volume| volume.placed);
        medium.variation =
            varying(table, density, temperature, emission_density.is_some()).map(|variation| {
                let bounds = table.or("bounds", variation.bounds, box_or_none);
                Variation { emission_scale: emission_density, bounds, ..variation }
            });
        medium
    }

    /// Temperatures by the place.
    fn temperature(&mut self, value: Value<'_>) -> Result<Hot> {
        let table = value.table("temperatures by the place")?;
        let number = |key, default| table.or(key, default, Value::single);
        Ok(Hot { offset: number("offset", 0.0), scale: number("factor", 1.0), volume: self.volume(value)? })
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
            let of = value.table("a density")?;
            let has = |keys: &[&str]| keys.iter().any(|key| of.has(key));
            return Ok(match () {
                () if has(CLOUD) => Number::Varying(cloud(&of)),
                () if has(COLORS) => Number::Varying(self.colors(&of)?),
                () => Number::Volume(self.volume(value)?),
            });
        }
        let most = table.or("max_density", 1.0, |value| {
            value.single_where("a number greater than 0", |most| most > 0.0 && most.is_finite())
        });
        Ok(match self.scalar_where(value, "a number of at least 0", |density| density >= 0.0)? {
            Scalar::Value(density) => Number::Even(density),
            of => Number::Varying(Density::Texture { of, most }),
        })
    }

    /// Densities of colours.
    fn colors(&mut self, table: &Table<'_>) -> Result<Density> {
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
        let corner = |key, default| table.or(key, default, super::shape::point);
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
    fn volume(&mut self, value: Value<'_>) -> Result<Volume> {
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

/// Temperatures by the place.
struct Hot {
    volume: Volume,
    offset: f32,
    scale: f32,
}

impl Hot {
    fn temperature(self) -> Temperature {
        Temperature { grid: self.volume.placed, offset: self.offset, scale: self.scale }
    }
}

/// pbrt's clouds.
fn cloud(table: &Table<'_>) -> Density {
    table.allow(&[CLOUD]);
    let number = |key, default| table.or(key, default, Value::single);
    Density::Cloud {
        density: number("cloud", 1.0),
        wispiness: number("wispiness", 1.0),
        frequency: number("frequency", 5.0),
    }
}

/// Two corners, or `"none"`.
fn box_or_none(value: Value<'_>) -> Result<Option<[Vec3; 2]>> {
    if value.as_text() == Some("none") {
        return Ok(None);
    }
    let expected = "two corners, the lower and the upper one, or \"none\"";
    let [low, high] = value.list_of(expected)?;
    let [low, high] = [super::shape::point(low)?, super::shape::point(high)?];
    if low.cmple(high).all() { Ok(Some([low, high])) } else { Err(value.wrong(expected)) }
}

/// What varies of a medium, if anything does.
fn varying(
    table: &Table<'_>,
    density: Option<Number>,
    temperature: Option<Hot>,
    emits_by_place: bool,
) -> Option<Variation> {
    let density = match density {
        Some(Number::Volume(volume)) => return Some(variation(table, volume, temperature)),
        Some(Number::Varying(density)) => Some(density),
        Some(Number::Even(_)) | None => None,
    };
    if density.is_none() && temperature.is_none() && !emits_by_place {
        return None;
    }
    let own = temperature.as_ref().map_or(DMat4::IDENTITY, |hot| hot.volume.world_from_medium);
    Some(Variation {
        world_from_medium: transform::after(table, &transform::world_from_object(table), &own),
        bounds: temperature.as_ref().map(|hot| hot.volume.bounds),
        density: density.unwrap_or(Density::Texture { of: Scalar::Value(1.0), most: 1.0 }),
        emission_scale: None,
        temperature: temperature.map(Hot::temperature),
    })
}

/// Densities of a grid, and temperatures of another.
fn variation(table: &Table<'_>, density: Volume, temperature: Option<Hot>) -> Variation {
    let mut bounds = density.bounds;
    let temperature = temperature.and_then(|mut hot| {
        let of = &mut hot.volume;
        let place = nanovdb::placement(&density.world_from_medium, &of.world_from_medium, of.bounds);
        if place.is_none() {
            table.note(table.error_at("temperature", "its axes are not those of `density`"));
        }
        let place = place?;
        let [low, high] = of.bounds.map(&place);
        bounds = [bounds[0].min(low), bounds[1].max(high)];
        of.placed.bounds = of.placed.bounds.map(&place);
        Some(hot.temperature())
    });
    Variation {
        world_from_medium: transform::after(
            table,
            &transform::world_from_object(table),
            &density.world_from_medium,
        ),
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
