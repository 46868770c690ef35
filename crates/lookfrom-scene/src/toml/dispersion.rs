//! Indices of refraction: numbers, glasses by name, curves and formulas.

use super::Reader;
use super::spectrum::KEYS;
use super::table::Table;
use super::value::Value;
use crate::error::Result;
use crate::material::Ior;
use crate::spectrum::{self, Dispersion};

/// The keys of formulas; with `abbe` goes `n_d`.
const FORMULAS: &[&str] = &["abbe", "cauchy", "sellmeier"];

const PAIRS: &str = "pairs of B and C in µm², such as [[1.0396, 0.0060], [0.2318, 0.0200], [1.0105, 103.56]]";

impl Reader<'_, '_> {
    /// An index of refraction: a number, the name of a glass, a formula or a curve.
    pub(super) fn ior(&mut self, value: Value<'_>) -> Result<Ior> {
        let expected = "a number greater than 0, the name of a glass such as \"BK7\", a formula of dispersion, or a curve";
        if value.is_table() {
            let table = value.table("an index of refraction")?;
            if let Some(formula) = table.one_of(FORMULAS) {
                return self.formula(value, &table, formula);
            }
            if !KEYS.iter().any(|key| table.has(key)) {
                let hint = "write `{ n_d = 1.5168, abbe = 64.17 }`, `{ cauchy = [1.5046, 0.0042] }`, `{ sellmeier = [[B, C], …] }` or \
                            `{ curve = [[400, 1.531], [700, 1.513]] }`";
                return Err(value.wrong(expected).hint(hint));
            }
            let id = self.curve(value, &[])?;
            return self.optical(value, id).map(Ior::Curve);
        }
        if value.as_text().is_some() {
            let glasses: Vec<(&str, &'static str)> =
                spectrum::names().filter_map(|name| Some((name.strip_prefix("glass-")?, name))).collect();
            let name = value.choice(&glasses)?;
            return Ok(Ior::Curve(self.known_curve(name)));
        }
        value.single_where(expected, |eta| eta > 0.0).map(Ior::Value)
    }

    /// The curve of a formula of dispersion.
    fn formula(&mut self, value: Value<'_>, table: &Table<'_>, formula: Value<'_>) -> Result<Ior> {
        let dispersion = match formula.key() {
            "abbe" => {
                table.allow(&[&["abbe", "n_d"]]);
                let n_d = table.need("n_d", "1.5168", 1.5, |index| {
                    index.number_where("the index at 587.6 nm, greater than 1", |index| index > 1.0)
                });
                Dispersion::of_abbe(n_d, formula.positive()?)
            }
            "cauchy" => {
                table.allow(&[&["cauchy"]]);
                let terms = formula
                    .list("the numbers A, B, … of A + B / λ² + …, λ in µm, such as [1.5046, 0.0042]")?;
                Dispersion::Cauchy(terms.map(Value::number).collect::<Result<_>>()?)
            }
            _ => {
                table.allow(&[&["sellmeier"]]);
                let pairs = formula.list(PAIRS)?;
                Dispersion::Sellmeier(pairs.map(|pair| pair.numbers(PAIRS)).collect::<Result<_>>()?)
            }
        };
        match dispersion.curve() {
            Ok(curve) => Ok(Ior::Curve(self.keep_curve(format!("{dispersion:?}"), curve))),
            Err(nm) => Err(value
                .error(format!("`{}` has no index above 0 at {nm} nm by its formula", value.key()))
                .hint("wavelengths are in µm in the formulas, and C of Sellmeier's in µm²")),
        }
    }
}
