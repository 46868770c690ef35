//! Spectra: blackbodies, tables, `.spd` files, and named spectra.

use super::Reader;
use super::settings::kelvin;
use super::value::Value;
use crate::error::{Error, ErrorKind, Result};
use crate::material::Color;
use crate::scene::CurveId;
use crate::spectrum::{self, Curve};

/// The keys of a spectrum; lights also have `scale`.
pub(super) const KEYS: &[&str] = &["kelvin", "curve", "spd", "illuminant", "constant"];

/// The words for what is beyond the ends of a table, and whether that is its first and its last value.
pub(super) const ENDS: &[(&str, bool)] = &[("extended", true), ("zero", false)];

/// Names of metals, in addition to their chemical symbols.
const METALS: &[(&str, &str)] = &[
    ("silver", "Ag"),
    ("aluminium", "Al"),
    ("aluminum", "Al"),
    ("gold", "Au"),
    ("copper", "Cu"),
    ("brass", "CuZn"),
];

impl Reader<'_, '_> {
    /// A spectrum: a table with one of [`KEYS`], and possibly `others`.
    pub(super) fn curve(&mut self, value: Value<'_>, others: &[&'static str]) -> Result<CurveId> {
        let table = value.table("a colour by wavelength")?;
        let Some(one) = table.one_of(KEYS) else {
            return Err(value.error(format!("`{}` is a table without a `type`, so it is not a texture", value.key())).hint(
                "add `type = \"checker\"` or another; a colour by wavelength has `kelvin`, `curve`, `spd`, `illuminant` or `constant`",
            ));
        };
        table.allow(&[KEYS, &["ends"], others]);
        // Only indices and coefficients have any: `extended`.
        table.maybe("ends", |ends| ends.choice(ENDS));
        match one.key() {
            "kelvin" => {
                let kelvin = kelvin(one)?;
                Ok(self.keep_curve(format!("kelvin {kelvin}"), Curve::Blackbody { kelvin }))
            }
            "curve" => {
                let curve = inline(one, self.context.limits.elements)?;
                Ok(self.add_curve(curve))
            }
            "spd" => self.spd(one),
            "constant" => {
                let value = one.single_where("a number of at least 0", |value| value >= 0.0)?;
                Ok(self.keep_curve(format!("constant {value}"), Curve::Constant(value)))
            }
            _ => {
                let short =
                    |name: &'static str| name.strip_prefix("stdillum-").or(name.strip_prefix("illum-"));
                let words: Vec<(&str, &'static str)> =
                    spectrum::names().filter_map(|name| Some((short(name)?, name))).collect();
                match (one.choice(&words)?, spectrum::d50()) {
                    ("stdillum-D50", Some(curve)) => Ok(self.keep_curve("the CIE's D50".to_owned(), curve)),
                    (name, _) => Ok(self.known_curve(name)),
                }
            }
        }
    }

    /// η and k of a metal by its name.
    pub(super) fn metal(&mut self, value: Value<'_>) -> Result<[Color; 2]> {
        let symbol = |name: &'static str| name.strip_prefix("metal-")?.strip_suffix("-eta");
        let symbols = spectrum::names().filter_map(symbol).map(|symbol| (symbol, symbol));
        let words: Vec<(&str, &str)> = symbols.chain(METALS.iter().copied()).collect();
        let symbol = value.choice(&words)?;
        Ok(["eta", "k"].map(|part| Color::Curve(self.known_curve(&format!("metal-{symbol}-{part}")))))
    }

    /// η or k of a metal: a colour, whose spectrum is extended beyond the ends of its table.
    pub(super) fn optical_color(&mut self, value: Value<'_>) -> Result<Color> {
        match self.color(value)? {
            Color::Curve(id) if value.key() == "eta" => self.optical(value, id).map(Color::Curve),
            Color::Curve(id) => Ok(Color::Curve(self.extended(value, id)?)),
            color => Ok(color),
        }
    }

    /// A spectral index of refraction, which must be positive, extended beyond the ends of its table.
    pub(super) fn optical(&mut self, value: Value<'_>, id: CurveId) -> Result<CurveId> {
        let is_usable = match &self.scene.curves[id.index()] {
            Curve::Tabulated { values, .. } => values.iter().all(|&eta| eta > 0.0),
            Curve::Constant(eta) => *eta > 0.0,
            Curve::Blackbody { .. } => false,
        };
        if !is_usable {
            return Err(value
                .error(format!(
                    "`{}` is not an index of refraction: it has to be above 0 everywhere",
                    value.key()
                ))
                .hint("give a number, or a curve of numbers such as 1.5"));
        }
        self.extended(value, id)
    }

    /// A spectrum with its first and last values extended to the ends of the visible range, unless the value says that it is 0 beyond
    /// them.
    fn extended(&mut self, value: Value<'_>, id: CurveId) -> Result<CurveId> {
        let is_extended = match value.is_table() {
            true => value.table("a colour by wavelength")?.or("ends", true, |ends| ends.choice(ENDS)),
            false => true,
        };
        Ok(match &self.scene.curves[id.index()] {
            curve @ Curve::Tabulated { .. } if is_extended => {
                let extended = curve.clone().extended();
                self.keep_curve(format!("extended {}", id.0), extended)
            }
            _ => id,
        })
    }

    /// A spectrum from a file; each is read once.
    fn spd(&mut self, value: Value<'_>) -> Result<CurveId> {
        let path = self.resolve(value, "the name of an .spd file")?;
        let name = format!("spd {}", path.display());
        if let Some(&id) = self.curves.get(&name) {
            return Ok(id);
        }
        let curve = spectrum::read_spd(&path, self.context).map_err(|error| value.blame(error))?;
        Ok(self.keep_curve(name, curve))
    }

    /// One of [`spectrum::names`].
    pub(super) fn known_curve(&mut self, name: &str) -> CurveId {
        match self.curves.get(name) {
            Some(&id) => id,
            None => self.keep_curve(name.to_owned(), spectrum::named(name).unwrap_or(Curve::Constant(1.0))),
        }
    }

    pub(super) fn keep_curve(&mut self, name: String, curve: Curve) -> CurveId {
        if let Some(&id) = self.curves.get(&name) {
            return id;
        }
        let id = self.add_curve(curve);
        self.curves.insert(name, id);
        id
    }

    fn add_curve(&mut self, curve: Curve) -> CurveId {
        self.scene.curves.push(curve);
        CurveId(self.scene.curves.len() as u32 - 1)
    }
}

/// `[[nm, value], …]`.
fn inline(value: Value<'_>, limit: u64) -> Result<Curve> {
    let expected = "a list of wavelengths and values, such as [[400, 0.1], [700, 0.8]]";
    let items = value.list(expected)?;
    let count = items.len() as u64;
    if count > limit {
        let error = value.error(format!("{count} entries are more than the limit of {limit}"));
        return Err(Error { kind: ErrorKind::Limit, ..error }.hint("use fewer"));
    }
    if count < 2 {
        return Err(value.wrong(expected));
    }
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    for item in items {
        let [nm, entry] = item.list_of("a wavelength in nm and a value")?;
        let nm_value = nm.single_where("a wavelength in nm, greater than 0", |nm| nm > 0.0)?;
        if let Some(&before) = wavelengths.last().filter(|&&before| nm_value <= before) {
            return Err(nm
                .error(format!("the wavelength {nm_value} is not above the previous one, {before}"))
                .hint("sort the entries by wavelength, each once"));
        }
        wavelengths.push(nm_value);
        values.push(entry.single_where("a number of at least 0", |value| value >= 0.0)?);
    }
    Ok(Curve::Tabulated { wavelengths, values })
}
