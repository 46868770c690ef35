//! Materials of the type "subsurface".

use super::Reader;
use super::medium::preset;
use super::table::Table;
use crate::material::{Color, Subsurface, SubsurfaceMedium};

/// The keys of such a material.
pub(super) const KEYS: &[&str] = &[
    "preset",
    "absorption",
    "scattering",
    "reflectance",
    "mean_free_path",
    "scale",
    "g",
    "ior",
    "roughness",
];

impl Reader<'_, '_> {
    pub(super) fn subsurface(&mut self, table: &Table<'_>) -> Subsurface {
        for keys in [["preset", "absorption", "reflectance"], ["preset", "scattering", "reflectance"]] {
            table.one_of(&keys);
        }
        if table.has("mean_free_path") && !table.has("reflectance") {
            self.ineffective(table, "mean_free_path", "`reflectance`");
        }
        if table.has("g") && table.has("preset") {
            self.ineffective(table, "g", "`absorption` and `scattering`, or `reflectance`");
        }
        let g = table
            .or("g", 0.0, |value| value.single_where("a number between -1 and 1", |g| g > -1.0 && g < 1.0));
        Subsurface {
            medium: self.medium_below(table),
            scale: table.or("scale", 1.0, |value| value.single_where("a number of at least 0", |n| n >= 0.0)),
            g: if table.has("preset") { 0.0 } else { g },
            eta: table.or("ior", Subsurface::ETA, |value| {
                value.single_where("a number greater than 0", |n| n > 0.0)
            }),
            roughness: self.roughness(table, "roughness"),
        }
    }

    /// The medium by its name, by its coefficients, or by its effect.
    fn medium_below(&mut self, table: &Table<'_>) -> SubsurfaceMedium {
        if table.has("preset") {
            return table
                .or("preset", SubsurfaceMedium::MILK, |value| preset(value).map(SubsurfaceMedium::from));
        }
        if table.has("reflectance") {
            return SubsurfaceMedium::Reflectance {
                reflectance: table.or("reflectance", Color::gray(1.0), |value| self.color(value)),
                mean_free_path: table
                    .or("mean_free_path", Color::gray(1.0), |value| self.optical_color(value)),
            };
        }
        if !table.has("absorption") && !table.has("scattering") {
            return SubsurfaceMedium::MILK;
        }
        let example = "[0.1, 0.2, 0.3]";
        SubsurfaceMedium::Coefficients {
            absorption: table.need("absorption", example, Color::BLACK, |value| self.optical_color(value)),
            scattering: table.need("scattering", example, Color::BLACK, |value| self.optical_color(value)),
        }
    }
}
