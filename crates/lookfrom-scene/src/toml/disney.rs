//! Materials of the type "disney".

use super::Reader;
use super::table::Table;
use crate::material::{Disney, Scalar};

/// The keys of such a material.
pub(super) const KEYS: &[&str] = &[
    "base_color",
    "roughness",
    "anisotropic",
    "metallic",
    "spec_trans",
    "ior",
    "spec_tint",
    "sheen",
    "sheen_tint",
    "flatness",
    "clearcoat",
    "clearcoat_gloss",
    "diff_trans",
    "thin",
];

impl Reader<'_, '_> {
    pub(super) fn disney(&mut self, table: &Table<'_>) -> Disney {
        let usual = Disney::default();
        let is_thin = table.or("thin", false, super::value::Value::boolean);
        for (key, of) in
            [("metallic", false), ("clearcoat", false), ("clearcoat_gloss", false), ("diff_trans", true)]
        {
            if of != is_thin && table.has(key) {
                self.ineffective(table, key, if of { "`thin = true`" } else { "`thin = false`" });
            }
        }
        let mut number = |key: &str, usual: Scalar, expected: &str, holds: fn(f32) -> bool| {
            table.or(key, usual, |value| self.scalar_where(value, expected, holds))
        };
        let mut share = |key: &str, usual| {
            number(key, usual, "a number from 0 to 1", |share| (0.0..=1.0).contains(&share))
        };
        let usual = Disney {
            roughness: share("roughness", usual.roughness),
            anisotropic: share("anisotropic", usual.anisotropic),
            metallic: share("metallic", usual.metallic),
            spec_trans: share("spec_trans", usual.spec_trans),
            spec_tint: share("spec_tint", usual.spec_tint),
            sheen_tint: share("sheen_tint", usual.sheen_tint),
            flatness: share("flatness", usual.flatness),
            clearcoat: share("clearcoat", usual.clearcoat),
            clearcoat_gloss: share("clearcoat_gloss", usual.clearcoat_gloss),
            ..usual
        };
        let (eta, sheen, diff_trans) = (
            number("ior", usual.eta, "a number greater than 0", |eta| eta > 0.0),
            number("sheen", usual.sheen, "a number of at least 0", |sheen| sheen >= 0.0),
            number("diff_trans", usual.diff_trans, "a number from 0 to 2", |n| (0.0..=2.0).contains(&n)),
        );
        Disney {
            base_color: self.color_or(table, "base_color", 0.5),
            eta,
            sheen,
            diff_trans,
            is_thin,
            ..usual
        }
    }
}
