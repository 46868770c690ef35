//! The camera `realistic`: a lens file, its aperture and its focus (Pharr, Jakob, Humphreys 2023, 5.4).

use std::sync::Arc;

use super::Reader;
use super::params::{ParameterType, Parameters};
use crate::camera::Projection;
use crate::error::{ErrorKind, Result};
use crate::image::{self, By, Encoding, Reading};
use crate::lens::{self, ApertureShape, LensConvention, LensSurface, LensSystem};

impl Reader<'_, '_> {
    /// The lens system of a realistic camera; without its lens file, which is recorded as missing, any one.
    pub(super) fn realistic(&mut self, p: &Parameters) -> Result<Projection> {
        let name = p.string("lensfile")?.unwrap_or_default().to_owned();
        if name.is_empty() {
            return Err(p.refuse("lensfile", "the name of a lens file"));
        }
        p.find("lensfile", &[ParameterType::String])?;
        let diameter = f64::from(p.positive("aperturediameter", 1.0)?);
        let focus_distance = f64::from(p.positive("focusdistance", 10.0)?);
        let path = self.resolve(&name);
        let surfaces = match lens::read(&path, self.context).map_err(|error| p.place.blame(error)) {
            Err(error) if error.kind == ErrorKind::Io => {
                self.missing.add(&path, error)?;
                let [index, diameter] = [1.5, 20.0];
                vec![LensSurface { curvature_radius: 25.0, thickness: 50.0, index, diameter }]
            }
            read => read?,
        };
        let mut shape = self.aperture_shape(p)?;
        let widest = lens::stop_diameter(&surfaces);
        match widest {
            Some(widest) if diameter > widest => {
                let message = format!(
                    "\"aperturediameter\" is {diameter}, more than that of the lens file: its {widest} is used instead"
                );
                self.context.warn(&p.place.location(), message);
            }
            None if shape != ApertureShape::Circle => {
                let message = "\"aperture\" has no effect: the lens file has no aperture stop";
                self.context.warn(&p.place.location(), message);
                shape = ApertureShape::Circle;
            }
            _ => {}
        }
        Ok(Projection::LensSystem(Arc::new(LensSystem {
            // Without its folders, as in our own scenes.
            name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            surfaces,
            stop_diameter: widest.map(|widest| diameter.min(widest)),
            shape,
            focus_distance,
            film_diagonal: self.film_diagonal,
            millimetre: 1e-3,
            convention: LensConvention::Pbrt,
        })))
    }

    fn aperture_shape(&mut self, p: &Parameters) -> Result<ApertureShape> {
        let Some(name) = p.string("aperture")?.filter(|name| !name.is_empty()) else {
            return Ok(ApertureShape::Circle);
        };
        // A circle has no name in pbrt.
        let named = ApertureShape::NAMED.into_iter().skip(1).find(|(word, _)| *word == name);
        if let Some((_, shape)) = named {
            return Ok(shape);
        }
        let path = self.resolve(name);
        let reading = Reading { by: By::PbrtTexture, ..Reading::new(Encoding::Srgb) };
        match image::read_as(&path, &reading, self.context).map_err(|error| p.place.blame(error)) {
            Err(error) if error.kind == ErrorKind::Io => {
                let hint = "there are also the shapes \"gaussian\", \"square\", \"pentagon\" and \"star\"";
                self.missing.add(&path, error.hint(hint))?;
                Ok(ApertureShape::Circle)
            }
            read => Ok(ApertureShape::Image(Arc::new(read?))),
        }
    }
}
