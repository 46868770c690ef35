//! Materials of the type "hair".

use super::Reader;
use super::table::Table;
use crate::material::{Color, Hair, Pigment, Scalar};

/// The keys of such a material.
pub(super) const KEYS: &[&str] = &[
    "eumelanin",
    "pheomelanin",
    "melanin",
    "melanin_redness",
    "reflectance",
    "absorption",
    "ior",
    "roughness",
    "radial_roughness",
    "offset",
];

/// Absorption per radius by a unit of eumelanin and of pheomelanin in Cycles, for red, green and blue: what its `melanin` counts.
const OF_MELANIN: [[f32; 3]; 2] = [[0.506, 0.841, 1.653], [0.343, 0.733, 1.924]];

impl Reader<'_, '_> {
    pub(super) fn hair(&mut self, table: &Table<'_>) -> Hair {
        let share = |reader: &mut Self, key: &str| {
            table.or(key, Scalar::Value(Hair::ROUGHNESS), |value| {
                reader.scalar_where(value, "a number from 0 to 1", |n| (0.0..=1.0).contains(&n))
            })
        };
        let (beta_m, beta_n) = (share(self, "roughness"), share(self, "radial_roughness"));
        Hair {
            pigment: self.pigment(table),
            eta: table.or("ior", Scalar::Value(Hair::ETA), |value| {
                self.scalar_where(value, "a number greater than 0", |n| n > 0.0)
            }),
            beta_m,
            beta_n,
            alpha: table.or("offset", Scalar::Value(Hair::ALPHA), |value| {
                self.scalar_where(value, "a number of degrees from -45 to 45", |n| n.abs() <= 45.0)
            }),
        }
    }

    /// The pigment by concentrations, by Cycles' one number, by the colour of much hair, or by its absorption.
    fn pigment(&mut self, table: &Table<'_>) -> Pigment {
        table.one_of(&["eumelanin", "melanin", "reflectance", "absorption"]);
        table.one_of(&["pheomelanin", "melanin", "reflectance", "absorption"]);
        if table.has("melanin_redness") && !table.has("melanin") {
            self.ineffective(table, "melanin_redness", "`melanin`");
        }
        if table.has("reflectance") {
            return Pigment::Reflectance(
                table.or("reflectance", Color::gray(0.5), |value| self.color(value)),
            );
        }
        if table.has("absorption") {
            return Pigment::Absorption(
                table.or("absorption", Color::BLACK, |value| self.optical_color(value)),
            );
        }
        if table.has("melanin") {
            let share = |key, usual| {
                table.or(key, usual, |value| {
                    value.single_where("a number from 0 to 1", |n| (0.0..=1.0).contains(&n))
                })
            };
            let amount = -libm::logf((1.0 - share("melanin", 0.0)).max(1e-4));
            let redness = share("melanin_redness", 0.0);
            let [brown, red] = OF_MELANIN;
            let mixed = std::array::from_fn(|k| amount * (brown[k] + redness * (red[k] - brown[k])));
            return Pigment::Absorption(Color::Value(mixed));
        }
        if !table.has("eumelanin") && !table.has("pheomelanin") {
            return Pigment::BROWN;
        }
        let mut concentration = |key| {
            table.or(key, Scalar::Value(0.0), |value| {
                self.scalar_where(value, "a number of at least 0", |n| n >= 0.0)
            })
        };
        Pigment::Melanin { eumelanin: concentration("eumelanin"), pheomelanin: concentration("pheomelanin") }
    }
}
