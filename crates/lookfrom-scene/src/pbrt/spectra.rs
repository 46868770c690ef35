//! Colours and spectra of parameters.
//!
//! `rgb` values are converted from the scene's colour space to linear Rec. 709; `spectrum` values (inline, from a file, or
//! named measured ones) and `blackbody` values become functions of wavelength.

use super::Reader;
use super::params::{Parameter, ParameterType, Parameters, SPECTRA};
use super::text::Place;
use crate::error::{ErrorKind, Result};
use crate::material::{Color, Scalar};
use crate::scene::CurveId;
use crate::spectrum::{self, Curve, space};
use crate::suggest::nearest;

/// The name of a colour space.
pub(super) type Space = &'static str;

/// The default colour space of scenes.
pub(super) const SRGB: Space = "srgb";

/// The role of a colour: albedo, illuminant or unbounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    /// A reflectance or transmittance, in [0, 1].
    Reflectance,
    /// An unbounded value at each wavelength.
    Unbounded,
    /// An emission spectrum.
    Light,
}

impl Reader<'_, '_> {
    /// A colour that may vary over the surface.
    pub(super) fn color_or_none(
        &mut self,
        parameters: &Parameters,
        name: &'static str,
        meaning: Meaning,
    ) -> Result<Option<Color>> {
        const KINDS: &[ParameterType] =
            &[ParameterType::Rgb, ParameterType::Spectrum, ParameterType::Blackbody, ParameterType::Texture];
        let Some(parameter) = parameters.find(name, KINDS)? else { return Ok(None) };
        if parameter.kind == ParameterType::Texture {
            return self.spectrum_texture(parameter).map(Some);
        }
        self.uniform(parameter, parameters.space, meaning).map(Some)
    }

    /// A colour, with a default.
    pub(super) fn color(
        &mut self,
        parameters: &Parameters,
        name: &'static str,
        default: Color,
        meaning: Meaning,
    ) -> Result<Color> {
        Ok(self.color_or_none(parameters, name, meaning)?.unwrap_or(default))
    }

    /// The colour of a light, which is constant.
    pub(super) fn light_color(
        &mut self,
        parameters: &Parameters,
        name: &'static str,
    ) -> Result<Option<Color>> {
        let Some(parameter) = parameters.find(name, SPECTRA)? else { return Ok(None) };
        self.uniform(parameter, parameters.space, Meaning::Light).map(Some)
    }

    /// A number that may vary over the surface.
    pub(super) fn scalar_or_none(
        &mut self,
        parameters: &Parameters,
        name: &'static str,
    ) -> Result<Option<Scalar>> {
        let Some(parameter) = parameters.find(name, &[ParameterType::Float, ParameterType::Texture])? else {
            return Ok(None);
        };
        if parameter.kind == ParameterType::Texture {
            return self.float_texture(parameter).map(Some);
        }
        parameters.float_or_none(name).map(|value| value.map(Scalar::Value))
    }

    /// A number, with a default.
    pub(super) fn scalar(
        &mut self,
        parameters: &Parameters,
        name: &'static str,
        default: f32,
    ) -> Result<Scalar> {
        Ok(self.scalar_or_none(parameters, name)?.unwrap_or(Scalar::Value(default)))
    }

    /// A spectrum by name, from a file or inline, or a blackbody's.
    fn uniform(&mut self, parameter: &Parameter, scene_space: Space, meaning: Meaning) -> Result<Color> {
        match parameter.kind {
            ParameterType::Rgb => {
                rgb(parameter, parameter.space.get().unwrap_or(scene_space), (meaning, self.is_old()))
            }
            ParameterType::Blackbody => match parameter.numbers() {
                &[kelvin] if kelvin > 0.0 => Ok(self.curve(Curve::Blackbody { kelvin })),
                _ => Err(parameter.wrong("one temperature in kelvin, greater than 0")),
            },
            _ => match parameter.strings() {
                [] => inline(parameter).map(|curve| self.curve(curve)),
                [name] => self.named_curve(name, &parameter.place).map(Color::Curve),
                names => Err(parameter.wrong(format!("one name, found {}", names.len()))),
            },
        }
    }

    fn curve(&mut self, curve: Curve) -> Color {
        Color::Curve(self.push_curve(curve))
    }

    fn push_curve(&mut self, curve: Curve) -> CurveId {
        self.scene.curves.push(curve);
        CurveId(self.scene.curves.len() as u32 - 1)
    }

    /// A named measured spectrum, or one from a file.
    pub(super) fn named_curve(&mut self, name: &str, place: &Place) -> Result<CurveId> {
        if let Some(&id) = self.curves.get(name) {
            return Ok(id);
        }
        let curve = match spectrum::named(name) {
            Some(curve) => curve,
            None => {
                let path = self.resolve(name);
                match spectrum::read_spd(&path, self.context) {
                    Err(error) if error.kind == ErrorKind::Io => {
                        let file = path.display();
                        let error =
                            place.invalid(format!("there is no spectrum named {name:?}, and no file {file}"));
                        let hint = match nearest(name, spectrum::names()) {
                            Some(meant) => format!("did you mean {meant:?}?"),
                            None => {
                                "names are those of pbrt-v4: \"metal-Cu-eta\", \"glass-BK7\", …".to_owned()
                            }
                        };
                        self.missing.add(&path, error.hint(hint))?;
                        Curve::Constant(1.0)
                    }
                    read => read?,
                }
            }
        };
        let id = self.push_curve(curve);
        self.curves.insert(name.to_owned(), id);
        Ok(id)
    }
}

/// Luminance of a light's colour relative to white: pbrt normalises spectra by their own luminance, but rgb colours by
/// that of white.
pub(super) fn brightness(color: Color) -> f32 {
    match color {
        Color::Value([red, green, blue]) => 0.2126 * red + 0.7152 * green + 0.0722 * blue,
        Color::Texture(_) | Color::Curve(_) => 1.0,
    }
}

/// A colour. Where it `clamps`, as pbrt-v3 does, none is out of range.
fn rgb(parameter: &Parameter, space: Space, (meaning, clamps): (Meaning, bool)) -> Result<Color> {
    let &[red, green, blue] = parameter.numbers() else {
        return Err(parameter.wrong(format!("3 numbers, found {}", parameter.numbers().len())));
    };
    let most = if meaning == Meaning::Reflectance { 1.0 } else { f32::INFINITY };
    if clamps {
        return Ok(Color::Value([red, green, blue].map(|part| part.clamp(0.0, most))));
    }
    let found = format!("found [ {red} {green} {blue} ]");
    if red < 0.0 || green < 0.0 || blue < 0.0 {
        return Err(parameter.wrong(format!("no negative number, {found}")));
    }
    if meaning == Meaning::Reflectance && (red > 1.0 || green > 1.0 || blue > 1.0) {
        let hint = "a surface cannot reflect more light than it receives: divide by the largest of the three";
        return Err(parameter.wrong(format!("numbers from 0 to 1, {found}")).hint(hint));
    }
    if space == SRGB {
        return Ok(Color::Value([red, green, blue]));
    }
    let matrix = match meaning {
        Meaning::Light => space::rec709_from(space),
        Meaning::Reflectance | Meaning::Unbounded => space::reflectance_rec709_from(space),
    };
    let rows = matrix.unwrap_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    // Colours outside the gamut of Rec. 709 are clamped.
    let convert = |row: [f32; 3]| (row[0] * red + row[1] * green + row[2] * blue).clamp(0.0, most);
    Ok(Color::Value(rows.map(convert)))
}

/// Pairs of wavelength and value.
fn inline(parameter: &Parameter) -> Result<Curve> {
    let numbers = parameter.numbers();
    if !numbers.len().is_multiple_of(2) {
        return Err(parameter.wrong(format!(
            "pairs of a wavelength and a value, found {}",
            crate::plural::counted(numbers.len(), "number")
        )));
    }
    let wavelengths: Vec<f32> = numbers.iter().copied().step_by(2).collect();
    if let Some(pair) = wavelengths.windows(2).find(|pair| pair[1] <= pair[0]) {
        return Err(parameter.wrong(format!("rising wavelengths, found {} after {}", pair[1], pair[0])));
    }
    Ok(Curve::Tabulated { wavelengths, values: numbers.iter().copied().skip(1).step_by(2).collect() })
}
