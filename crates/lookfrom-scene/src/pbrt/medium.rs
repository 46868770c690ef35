//! The `MakeNamedMedium` directive, and the media of shapes and cameras.

mod nanovdb;

use std::rc::Rc;
use std::sync::Arc;

use glam::Vec3;

use super::lexer::{Lexer, Token};
use super::params::{ParameterType, Parameters};
use super::spectra::Meaning::Unbounded;
use super::text::Place;
use super::{NamedMedium, Reader};
use crate::error::Result;
use crate::grid::{Grid, Placed};
use crate::material::Color;
use crate::medium::presets::Preset;
use crate::medium::{Density, Extinction, Medium, Sides, Temperature, Variation};
use crate::scene::MediumId;

const KINDS: &[&str] = &["cloud", "homogeneous", "nanovdb", "rgbgrid", "uniformgrid"];

/// The integrators that support media; the others treat all media as a vacuum.
const KNOWING: &[&str] = &["volpath", "simplevolpath", "bdpt", "mlt"];

impl Reader<'_, '_> {
    pub(super) fn make_medium(&mut self, name: &str, p: &Parameters) -> Result<()> {
        let kind = match p.string("type")?.unwrap_or_default() {
            "heterogeneous" if self.is_old() => "uniformgrid".to_owned(),
            kind => kind.to_owned(),
        };
        if !KINDS.contains(&kind.as_str()) {
            return Err(Self::unknown(&p.place, "medium", &kind, KINDS.iter().copied()));
        }
        if let Some(named) = self.media.get(name).filter(|named| named.is_made) {
            let before = &self.scene.media[named.id.index()].at;
            let error = p.place.invalid(format!("medium {name:?} is already defined, at {before}"));
            return Err(error.hint("give one of them another name"));
        }
        let mut medium = self.even_medium(name.to_owned(), &kind, p)?;
        medium.variation = match &*kind {
            "uniformgrid" => Some(self.uniform_grid(p, &mut medium)?),
            "rgbgrid" => Some(self.rgb_grid(p, &mut medium)?),
            "cloud" => Some(self.cloud(p)?),
            "nanovdb" => self.nano_vdb(p, &mut medium)?,
            _ => None,
        };
        let id = self.medium_named(name, &p.place);
        self.scene.media[id.index()] = medium;
        if let Some(named) = self.media.get_mut(name) {
            named.is_made = true;
        }
        Ok(())
    }

    /// A medium of a kind, without its variation.
    fn even_medium(&mut self, name: String, kind: &str, p: &Parameters) -> Result<Medium> {
        let one = Color::Value([1.0; 3]);
        let [absorption, scattering] = match kind {
            "rgbgrid" => [one; 2],
            "homogeneous" if p.has("preset") => self.preset(p)?,
            _ => [self.color(p, "sigma_a", one, Unbounded)?, self.color(p, "sigma_s", one, Unbounded)?],
        };
        let has_emission = matches!(kind, "homogeneous" | "uniformgrid");
        let emission = if has_emission { self.light_color(p, "Le")? } else { None };
        let at_least_zero =
            |name, default| p.float_where(name, default, "a number of at least 0", |v| v >= 0.0);
        let emission_scale = if kind == "homogeneous" { at_least_zero("Lescale", 1.0)? } else { 1.0 };
        let scale = if kind == "cloud" { 1.0 } else { at_least_zero("scale", 1.0)? };
        Ok(Medium {
            extinction: Extinction::Parts { absorption, scattering },
            g: p.float_where("g", 0.0, "a number between -1 and 1", |g| g.abs() < 1.0)?,
            scale,
            emission: emission.unwrap_or(Color::BLACK),
            emission_scale,
            ..Medium::clear(name, p.place.location())
        })
    }

    /// The coefficients of a medium that was measured, per mm.
    fn preset(&self, p: &Parameters) -> Result<[Color; 2]> {
        let preset = Self::preset_named(p.string("preset")?.unwrap_or_default(), "preset", &p.place)?;
        p.ignore(&["sigma_a", "sigma_s"]);
        Ok([preset.absorption, preset.scattering].map(Color::Value))
    }

    /// The measured medium with a name.
    pub(super) fn preset_named(name: &str, kind: &str, place: &Place) -> Result<&'static Preset> {
        let known = Preset::all().iter().map(|preset| preset.name);
        Preset::named(name).ok_or_else(|| Self::unknown(place, kind, name, known))
    }

    /// A medium that varies in its own space, by default in the unit cube there.
    fn variation(&self, p: &Parameters, density: Density) -> Result<Variation> {
        Ok(Variation {
            world_from_medium: self.state.matrix,
            bounds: Some(bounds(p)?),
            density,
            emission_scale: None,
            temperature: None,
        })
    }

    fn uniform_grid(&self, p: &Parameters, medium: &mut Medium) -> Result<Variation> {
        let required = || p.place.invalid("the medium has no \"density\"".to_owned());
        let density = numbers(p, "density")?.ok_or_else(required)?;
        let mut variation = self.variation(p, Density::Grid(density))?;
        // Without a grid pbrt has one of a single cell, which fades from its centre to half outside of it.
        let bounds = bounds(p)?;
        let even = || Grid::from_values([1; 3], &[1.0]).map(|grid| Placed { grid: Arc::new(grid), bounds });
        variation.emission_scale = numbers(p, "Lescale")?.or_else(even);
        let Some(grid) = numbers(p, "temperature")? else { return Ok(variation) };
        if p.has("Le") {
            return Err(p.refuse("Le", "no \"Le\" beside \"temperature\""));
        }
        // pbrt does not divide blackbodies by their luminance …
        medium.emission_scale = Medium::ABSOLUTE;
        variation.temperature = Some(temperature(p, grid)?);
        Ok(variation)
    }

    fn rgb_grid(&mut self, p: &Parameters, medium: &mut Medium) -> Result<Variation> {
        let [absorption, scattering, emission] =
            [colors(p, "sigma_a")?, colors(p, "sigma_s")?, colors(p, "Le")?];
        if absorption.is_none() && scattering.is_none() {
            return Err(p.place.invalid("the medium has neither \"sigma_a\" nor \"sigma_s\"".to_owned()));
        }
        if emission.is_some() && absorption.is_none() {
            return Err(p.refuse("Le", "\"sigma_a\" beside \"Le\""));
        }
        let scale = p.float_where("Lescale", 1.0, "a number of at least 0", |v| v >= 0.0)?;
        // … nor this emission.
        medium.emission_scale = scale * Medium::ABSOLUTE;
        self.variation(p, Density::Colors { absorption, scattering, emission })
    }

    fn cloud(&self, p: &Parameters) -> Result<Variation> {
        let finite = |name, default| p.float_where(name, default, "a finite number", f32::is_finite);
        let (density, wispiness) = (finite("density", 1.0)?, finite("wispiness", 1.0)?);
        let frequency = finite("frequency", 5.0)?;
        self.variation(p, Density::Cloud { density, wispiness, frequency })
    }

    pub(super) fn medium_interface(&mut self, lexer: &mut Lexer<'_>) -> Result<()> {
        let inside = lexer.string("a quoted name of a medium, or \"\"")?;
        let mut outside = inside.clone();
        if matches!(lexer.peek()?, Some(Token::Quoted(_))) {
            outside = lexer.string("a quoted name of a medium")?;
        }
        self.state.media = Some(Rc::new([inside, outside]));
        Ok(())
    }

    /// Records whether the scene's integrator supports media.
    pub(super) fn settle_media(&mut self, integrator: &str, place: &Place) {
        self.scene.render.media = KNOWING.contains(&integrator);
        self.without_media = (!self.scene.render.media).then(|| (integrator.to_owned(), place.clone()));
    }

    /// The media on both sides of the next shape.
    pub(super) fn sides(&mut self, place: &Place) -> Result<Option<Sides>> {
        let Some(names) = self.state.media.clone() else { return Ok(None) };
        let [inside, outside] = [0, 1].map(|side| self.medium(&names[side], place));
        // Equal media on both sides need no interface.
        if names[0] == names[1] {
            return Ok(None);
        }
        names.iter().for_each(|name| self.use_medium(name));
        Ok(Some(Sides { inside, outside }))
    }

    /// The medium around the camera: the outside medium at its definition.
    pub(super) fn medium_around(&mut self, name: &str, camera: &Place) -> Result<Option<MediumId>> {
        let medium = self.medium(name, camera);
        self.use_medium(name);
        Ok(medium)
    }

    /// A medium by its name; the vacuum has an empty name.
    fn medium(&mut self, name: &str, place: &Place) -> Option<MediumId> {
        (!name.is_empty()).then(|| self.medium_named(name, place))
    }

    /// A medium by its name, which may be defined later.
    fn medium_named(&mut self, name: &str, place: &Place) -> MediumId {
        if let Some(named) = self.media.get(name) {
            return named.id;
        }
        let id = MediumId(self.scene.media.len() as u32);
        self.scene.media.push(Medium::clear(name.to_owned(), place.location()));
        self.media.insert(name.to_owned(), NamedMedium { id, first: place.clone(), is_made: false });
        id
    }

    /// Warns once, where a medium is first used, of an integrator that does not support them.
    fn use_medium(&mut self, name: &str) {
        if name.is_empty() {
            return;
        }
        if let Some((integrator, place)) = self.without_media.take() {
            let message = format!(
                "the integrator {integrator:?} does not support media, as in pbrt: they are treated as a vacuum; \"volpath\" supports them"
            );
            self.context.warn(&place.location(), message);
        }
    }
}

/// The corners of the box that a medium is in.
fn bounds(p: &Parameters) -> Result<[Vec3; 2]> {
    let corner = |name, default: Vec3| p.vector(name, ParameterType::Point3, default.as_dvec3());
    let [p0, p1] = [corner("p0", Vec3::ZERO)?.as_vec3(), corner("p1", Vec3::ONE)?.as_vec3()];
    Ok([p0.min(p1), p0.max(p1)])
}

/// Number of cells along x, y and z.
fn size(p: &Parameters) -> Result<[u32; 3]> {
    let mut size = [1; 3];
    for (name, cells) in ["nx", "ny", "nz"].into_iter().zip(&mut size) {
        *cells = p.integer(name, 1, 1, i32::MAX)?.unsigned_abs();
    }
    Ok(size)
}

/// A grid of numbers.
fn numbers(p: &Parameters, name: &'static str) -> Result<Option<Placed<f32>>> {
    let Some(values) = p.floats(name, ParameterType::Float)? else { return Ok(None) };
    if name != "temperature" && values.iter().any(|value| *value < 0.0) {
        return Err(p.refuse(name, "numbers of at least 0"));
    }
    placed(p, name, values).map(Some)
}

/// A grid of colours.
fn colors(p: &Parameters, name: &'static str) -> Result<Option<Placed<[f32; 3]>>> {
    let Some(values) = p.floats(name, ParameterType::Rgb)? else { return Ok(None) };
    if values.iter().any(|value| *value < 0.0) {
        return Err(p.refuse(name, "colours without negative numbers"));
    }
    let values: Vec<[f32; 3]> = values.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect();
    placed(p, name, &values).map(Some)
}

fn placed<T: Copy + Default + PartialEq>(p: &Parameters, name: &str, values: &[T]) -> Result<Placed<T>> {
    let size @ [x, y, z] = size(p)?;
    let grid = Grid::from_values(size, values).ok_or_else(|| {
        let found = values.len();
        p.refuse(
            name,
            &format!(
                "{x}·{y}·{z} values by \"nx\", \"ny\", \"nz\", at most 2²⁰ along an axis; found {found}"
            ),
        )
    })?;
    Ok(Placed { grid: Arc::new(grid), bounds: bounds(p)? })
}

/// Temperatures, by their grid.
fn temperature(p: &Parameters, grid: Placed<f32>) -> Result<Temperature> {
    let finite = |name, default| p.float_where(name, default, "a finite number", f32::is_finite);
    let cutoff = finite("temperaturecutoff", 0.0)?;
    Ok(Temperature {
        grid,
        offset: finite("temperatureoffset", cutoff)?,
        scale: finite("temperaturescale", 1.0)?,
    })
}
