//! Media, and those on the sides of shapes.

use std::rc::Rc;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};

use super::Reader;
use super::plugin::Plugin;
use super::volume::even_color;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{Grid, Placed};
use crate::material::Color;
use crate::medium::{Density, Extinction, Medium, Sides, Variation};
use crate::scene::MediumId;

impl Reader<'_, '_> {
    /// The media that a shape bounds.
    pub(super) fn sides(&mut self, shape: &Plugin) -> Result<Option<Sides>> {
        let (inside, outside) =
            (self.medium_named(shape, "interior")?, self.medium_named(shape, "exterior")?);
        Ok((inside.is_some() || outside.is_some()).then_some(Sides { inside, outside }))
    }

    fn medium_named(&mut self, shape: &Plugin, name: &str) -> Result<Option<MediumId>> {
        let Some(property) = shape.find(name) else { return Ok(None) };
        match property.plugin(&self.ids)?.filter(|plugin| plugin.class == "medium") {
            Some(medium) => self.medium(&medium).map(Some),
            None => Err(property.wrong("a <medium>")),
        }
    }

    pub(super) fn medium(&mut self, plugin: &Rc<Plugin>) -> Result<MediumId> {
        if let Some(&id) = self.media.get(&Rc::as_ptr(plugin)) {
            return Ok(id);
        }
        plugin.ignore(&["sample_emitters", "has_spectral_extinction"]);
        let scale = plugin.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)?;
        let name = plugin.id.clone().unwrap_or_else(|| plugin.kind.clone());
        let own = Medium { scale: scale as f32, ..Medium::clear(name, plugin.at.clone()) };
        let medium = match &*plugin.kind {
            "homogeneous" => {
                let sum = Color::Value(self.coefficient(plugin, "sigma_t", 1.0)?);
                let albedo = Color::Value(self.albedo(plugin)?);
                Medium { extinction: Extinction::Sum { sum, albedo }, ..own }
            }
            "heterogeneous" => self.heterogeneous(plugin, own)?,
            _ => return Err(plugin.unsupported(&["heterogeneous", "homogeneous"])),
        };
        let (g, draine) = match plugin.part("phase", &self.ids)? {
            None => (0.0, None),
            Some(phase) => self.phase(&phase)?,
        };
        self.scene.media.push(Medium { g, draine, ..medium });
        let id = MediumId(self.scene.media.len() as u32 - 1);
        self.media.insert(Rc::as_ptr(plugin), id);
        Ok(id)
    }

    fn albedo(&mut self, plugin: &Plugin) -> Result<[f32; 3]> {
        let albedo = self.coefficient(plugin, "albedo", 0.75)?;
        check_albedo(plugin, albedo)?;
        Ok(albedo)
    }

    /// A medium in the box of its extinction coefficient.
    fn heterogeneous(&mut self, plugin: &Plugin, own: Medium) -> Result<Medium> {
        let sigma_t = self.volume(plugin, "sigma_t", 1.0)?;
        let albedo = self.volume(plugin, "albedo", 0.75)?;
        let frame = sigma_t.world_from_cube;
        let axes = [frame.x_axis, frame.y_axis, frame.z_axis];
        if axes.iter().any(|axis| axis.to_array().iter().filter(|part| part.abs() > 1e-6).count() > 1) {
            let message = "a turned volume ends at its cube; in Mitsuba at the box around it, along the axes of the world";
            self.warn_once(&plugin.at, message);
        }
        let variation = |density| {
            let bounds = Some([Vec3::ZERO, Vec3::ONE]);
            Some(Variation {
                world_from_medium: frame,
                bounds,
                density,
                emission_scale: None,
                temperature: None,
            })
        };
        if albedo.lattice.is_even() && (sigma_t.lattice.channels == 1 || sigma_t.lattice.is_even()) {
            let albedo = albedo.lattice.cell([0; 3]);
            check_albedo(plugin, albedo)?;
            // What is even has its colour in the coefficients.
            let of = if sigma_t.lattice.is_even() { sigma_t.lattice.cell([0; 3]) } else { [1.0; 3] };
            let is_even = sigma_t.lattice.is_even();
            let number = |rgb: [f32; 3]| if is_even { 1.0 } else { rgb[0] };
            let density = padded(sigma_t.lattice.size, |cell| number(sigma_t.lattice.cell(cell)));
            let density = density.ok_or_else(|| too_large(plugin))?;
            return Ok(Medium {
                extinction: Extinction::Sum { sum: Color::Value(of), albedo: Color::Value(albedo) },
                variation: variation(Density::Grid(density)),
                ..own
            });
        }
        let albedo_from_cube = albedo.world_from_cube.inverse() * frame;
        let size = if sigma_t.lattice.is_even() { albedo.lattice.size } else { sigma_t.lattice.size };
        let is_resampled =
            !albedo.lattice.is_even() && (albedo_from_cube != DMat4::IDENTITY || size != albedo.lattice.size);
        if is_resampled || !(albedo.lattice.is_even() || sigma_t.lattice.is_even()) {
            let message = "the product of `albedo` and `sigma_t` is interpolated between cells of the latter, in Mitsuba each of them";
            self.warn_once(&plugin.at, message);
        }
        let at = |cell: [i64; 3]| {
            let center = DVec3::from_array(std::array::from_fn(|axis| {
                (cell[axis].clamp(0, i64::from(size[axis]) - 1) as f64 + 0.5) / f64::from(size[axis])
            }));
            let albedo = albedo.lattice.at(albedo_from_cube.transform_point3(center));
            (sigma_t.lattice.at(center), albedo)
        };
        for z in 0..i64::from(size[2]) {
            for y in 0..i64::from(size[1]) {
                for x in 0..i64::from(size[0]) {
                    check_albedo(plugin, at([x, y, z]).1)?;
                }
            }
        }
        let part = |of: fn(f32) -> f32| {
            padded(size, |cell| {
                let (sigma_t, albedo) = at(cell);
                std::array::from_fn(|c| sigma_t[c] * of(albedo[c]))
            })
        };
        let (absorption, scattering) = (part(|albedo| 1.0 - albedo), part(|albedo| albedo));
        if absorption.is_none() || scattering.is_none() {
            return Err(too_large(plugin));
        }
        Ok(Medium {
            extinction: Extinction::Parts { absorption: Color::gray(1.0), scattering: Color::gray(1.0) },
            variation: variation(Density::Colors { absorption, scattering, emission: None }),
            ..own
        })
    }

    /// A colour, or that of a volume that is the same everywhere.
    pub(super) fn coefficient(&mut self, plugin: &Plugin, name: &str, default: f32) -> Result<[f32; 3]> {
        let Some(property) = plugin.find(name) else { return Ok([default; 3]) };
        if let Some(rgb) = even_color(property) {
            return Ok(rgb);
        }
        match property.plugin(&self.ids)? {
            Some(volume) if volume.kind == "constvolume" => self.coefficient(&volume, "value", 1.0),
            Some(volume) => Err(volume.unsupported(&["constvolume"])),
            None => Err(property.wrong("a colour of at least 0")),
        }
    }
}

fn check_albedo(plugin: &Plugin, albedo: [f32; 3]) -> Result<()> {
    match albedo.iter().any(|value| *value > 1.0) {
        true => Err(plugin.refuse("albedo", "numbers from 0 to 1")),
        false => Ok(()),
    }
}

fn too_large(plugin: &Plugin) -> Error {
    Error::new(ErrorKind::Limit, &plugin.at, "a volume of too many cells")
}

/// A grid that fills the unit cube and has a layer of cells around it: ours are zero beyond the outermost cells, Mitsuba's go on. `None`
/// if it is too large.
fn padded<T: Copy + Default + PartialEq>(size: [u32; 3], of: impl Fn([i64; 3]) -> T) -> Option<Placed<T>> {
    let with = size.map(|cells| cells + 2);
    let mut values = Vec::with_capacity(with.iter().map(|&cells| cells as usize).product());
    for z in 0..i64::from(with[2]) {
        for y in 0..i64::from(with[1]) {
            values.extend((0..i64::from(with[0])).map(|x| of([x - 1, y - 1, z - 1])));
        }
    }
    let cell = Vec3::from_array(size.map(|cells| 1.0 / cells as f32));
    let grid = Arc::new(Grid::from_values(with, &values)?);
    Some(Placed { grid, bounds: [-cell, Vec3::ONE + cell] })
}
