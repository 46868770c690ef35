//! Media, and the grids of those that vary.

use std::sync::Arc;

use glam::Vec3;

use super::Writer;
use super::cannot;
use super::color::Of;
use super::placing::put_transform;
use super::text::Fields;
use crate::error::Result;
use crate::grid::{Grid, Placed};
use crate::material::{Color, Scalar};
use crate::medium::{Density, DraineLobe, Medium, Temperature, Variation};
use crate::npy;

/// The most cells of a grid, all of which are written.
const MOST_CELLS: u64 = 1 << 28;

impl Writer<'_> {
    pub(super) fn medium(&mut self, medium: &Medium) -> Result<Fields> {
        let Medium {
            name,
            at: _,
            extinction,
            g,
            droplets,
            draine,
            scale,
            emission,
            emission_scale,
            variation,
        } = medium;
        let mut fields = Fields::default();
        for (key, color) in extinction.colors() {
            if color != Color::BLACK {
                let item = self.color(color, Of::Optics)?;
                fields.put(key, item);
            }
        }
        fields.put_unless("g", *g, 0.0);
        if let Some(diameter) = droplets {
            fields.put("droplets", *diameter);
        }
        if let Some(DraineLobe { g, alpha, share }) = draine {
            let mut lobe = Fields::default();
            lobe.put("g", *g);
            lobe.put("alpha", *alpha);
            lobe.put("share", *share);
            fields.put("draine", lobe);
        }
        fields.put_unless(if variation.is_some() { "density_scale" } else { "density" }, *scale, 1.0);
        let is_hot = variation.as_ref().is_some_and(|variation| variation.temperature.is_some());
        if *emission != Color::BLACK {
            if is_hot {
                return Err(cannot(format!(
                    "the medium {name:?}: it has both a temperature and an emission"
                )));
            }
            let item = self.color(*emission, Of::Color)?;
            fields.put("emission", item);
        }
        fields.put_unless("emission_scale", *emission_scale, if is_hot { Medium::ABSOLUTE } else { 1.0 });
        if let Some(variation) = variation {
            self.variation(&mut fields, name, variation)?;
        }
        Ok(fields)
    }

    fn variation(&mut self, fields: &mut Fields, name: &str, variation: &Variation) -> Result<()> {
        let Variation { world_from_medium, bounds, density, emission_scale, temperature } = variation;
        match density {
            Density::Grid(placed) => {
                let grid = self.numbers(name, placed)?;
                fields.put("density", grid);
            }
            Density::Colors { absorption, scattering, emission } => {
                let mut table = Fields::default();
                for (key, of) in
                    [("absorption", absorption), ("scattering", scattering), ("emission", emission)]
                {
                    if let Some(placed) = of {
                        let grid = self.colors(&format!("{name}-{key}"), placed)?;
                        table.put(key, grid);
                    }
                }
                fields.put("density", table);
            }
            Density::Cloud { density, wispiness, frequency } => {
                let mut table = Fields::one("cloud", *density);
                table.put("wispiness", *wispiness);
                table.put("frequency", *frequency);
                fields.put("density", table);
            }
            Density::Texture { of: Scalar::Texture(id), most } => {
                fields.put("density", self.texture_name(*id));
                fields.put_unless("max_density", *most, 1.0);
            }
            Density::Texture { of: Scalar::Value(value), most } => {
                let is_plain =
                    (*value, *most) == (1.0, 1.0) && (temperature.is_some() || emission_scale.is_some());
                if !is_plain {
                    return Err(cannot(format!(
                        "the medium {name:?}: its density is a texture of one value"
                    )));
                }
            }
        }
        if let Some(placed) = emission_scale {
            let grid = self.numbers(&format!("{name}-emission"), placed)?;
            fields.put("emission_density", grid);
        }
        if let Some(Temperature { grid, offset, scale }) = temperature {
            let mut table = self.numbers(&format!("{name}-temperature"), grid)?;
            table.put_unless("offset", *offset, 0.0);
            table.put_unless("factor", *scale, 1.0);
            fields.put("temperature", table);
        }
        let is_boundless =
            matches!(density, Density::Texture { .. } | Density::Cloud { .. } | Density::Colors { .. })
                && temperature.is_none();
        match bounds {
            Some(corners) => fields.put("bounds", *corners),
            None if is_boundless => {}
            None => fields.put("bounds", "none"),
        }
        put_transform(fields, world_from_medium);
        Ok(())
    }

    fn numbers(&mut self, name: &str, placed: &Placed<f32>) -> Result<Fields> {
        let cells = cells(&placed.grid, name)?;
        let [x, y, z] = placed.grid.size().map(|cells| cells as usize);
        let bytes = npy::write_f32(&[z, y, x], cells.into_iter());
        Ok(self.grid(name, bytes, placed.bounds))
    }

    fn colors(&mut self, name: &str, placed: &Placed<[f32; 3]>) -> Result<Fields> {
        let cells = cells(&placed.grid, name)?;
        let [x, y, z] = placed.grid.size().map(|cells| cells as usize);
        let bytes = npy::write_f32(&[z, y, x, 3], cells.into_iter().flatten());
        Ok(self.grid(name, bytes, placed.bounds))
    }

    /// The table of a grid in a box.
    fn grid(&mut self, name: &str, bytes: Vec<u8>, [min, max]: [Vec3; 2]) -> Fields {
        let mut table = Fields::one("npy", self.file(name, "npy", bytes));
        table.put_unless("min", min, Vec3::NEG_ONE);
        table.put_unless("max", max, Vec3::ONE);
        table
    }
}

/// All cells of a grid, x fastest.
fn cells<T: Copy + Default + PartialEq>(grid: &Arc<Grid<T>>, name: &str) -> Result<Vec<T>> {
    let count = grid.size().into_iter().map(u64::from).product::<u64>();
    if count > MOST_CELLS {
        return Err(cannot(format!(
            "the grid of {name:?}: it has {count} cells; at most {MOST_CELLS} are written"
        )));
    }
    let [width, height, _] = grid.size().map(|cells| cells as usize);
    let mut values = vec![T::default(); count as usize];
    grid.for_each(|cell, value| {
        let [x, y, z] = cell.map(|coordinate| coordinate as usize);
        values[x + width * (y + height * z)] = value;
    });
    Ok(values)
}
