//! The camera `realistic`: a perspective camera with the field of view, the focus and the exposure of its lens system.
//!
//! The lens file is a table of surfaces from the front to the film (Pharr, Jakob, Humphreys 2023, 5.4): radius of curvature, thickness and
//! index of refraction behind it, diameter of the aperture, in millimetres; a radius of 0 is the aperture stop. Rays near the axis cross
//! it by matrices (Gauss 1841). Distortion, vignetting and the shape of blur are left out.

use super::Reader;
use super::params::{ParameterType, Parameters};
use crate::error::Result;
use crate::packed;

/// Properties of a lens system that a perspective camera takes over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Optics {
    /// The tangent of half the field of view along the diagonal of the film.
    slope: f64,
    /// Sensor exposure relative to a camera that measures radiance: the solid angle of the exit pupil.
    exposure: f64,
}

/// A surface of a lens system.
#[derive(Clone, Copy, Debug)]
struct LensSurface {
    radius: f64,
    thickness: f64,
    index: f64,
    aperture: f64,
}

/// The most surfaces of a lens system.
const MOST_SURFACES: usize = 256;

impl Reader<'_, '_> {
    /// The optics of a realistic camera, with a warning; without a readable lens file, those of a perspective camera of 50°.
    pub(super) fn realistic(&mut self, p: &Parameters, diagonal: f64) -> Result<Option<Optics>> {
        let name = p.string("lensfile")?.unwrap_or_default().to_owned();
        p.find("lensfile", &[ParameterType::String])?;
        p.ignore(&["aperture"]);
        let stop = f64::from(p.positive("aperturediameter", 1.0)?);
        let focus = f64::from(p.positive("focusdistance", 10.0)?);
        let bytes = packed::read(&self.resolve(&name), self.context);
        let optics = bytes.ok().and_then(|bytes| surfaces(&bytes)).and_then(|mut lens| {
            for surface in lens.iter_mut().filter(|surface| surface.radius == 0.0) {
                surface.aperture = surface.aperture.min(stop);
            }
            optics(&lens, diagonal, focus * 1000.0)
        });
        let instead = match &optics {
            Some(Optics { slope, exposure }) => format!(
                "a \"perspective\" camera with its field of view ({:.1}° along the diagonal) and its exposure ({exposure:.3} of that of a \
                 pinhole) is used instead, without distortion, vignetting and blur",
                2.0 * libm::atan(*slope).to_degrees()
            ),
            None => "its lens file is not read, and a \"perspective\" camera of 50° with the exposure of a pinhole is used instead, whose \
                     pictures may be several times brighter"
                .to_owned(),
        };
        let message = format!("realistic cameras (lens systems) are not rendered yet: {instead}");
        self.context.warn(&p.place.location(), message);
        Ok(optics)
    }
}

impl Optics {
    /// The field of view in degrees along the shorter side of a film of this aspect ratio.
    pub(super) fn field_of_view(self, aspect: f64) -> f64 {
        let long = aspect.max(1.0 / aspect);
        2.0 * libm::atan(self.slope / (1.0 + long * long).sqrt()).to_degrees()
    }

    /// The factor of the sensor's values.
    pub(super) fn exposure(self) -> f32 {
        self.exposure as f32
    }
}

/// The surfaces of a lens file: four numbers each, and comments.
fn surfaces(bytes: &[u8]) -> Option<Vec<LensSurface>> {
    let text = String::from_utf8_lossy(bytes);
    let words = text.lines().flat_map(|line| line.split('#').next().unwrap_or_default().split_whitespace());
    let numbers: Option<Vec<f64>> = words.take(4 * MOST_SURFACES + 1).map(|word| word.parse().ok()).collect();
    let numbers = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()))?;
    if numbers.is_empty() || numbers.len() > 4 * MOST_SURFACES || !numbers.len().is_multiple_of(4) {
        return None;
    }
    let surface =
        |&[radius, thickness, index, aperture]: &[f64; 4]| LensSurface { radius, thickness, index, aperture };
    Some(numbers.as_chunks().0.iter().map(surface).collect())
}

/// Height and slope of a ray behind each surface, that enters the system so.
fn crossed(lens: &[LensSurface], [mut height, mut slope]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut before = 1.0;
    let mut rays = Vec::with_capacity(lens.len());
    for (place, surface) in lens.iter().enumerate() {
        let index = if surface.index == 0.0 { 1.0 } else { surface.index };
        if surface.radius != 0.0 {
            slope = (before * slope - height * (index - before) / surface.radius) / index;
        }
        before = index;
        rays.push([height, slope]);
        if place + 1 < lens.len() {
            height += slope * surface.thickness;
        }
    }
    rays
}

/// The optics of a lens focused at a distance before its first surface, with a film of this diagonal; lengths are millimetres.
fn optics(lens: &[LensSurface], diagonal: f64, distance: f64) -> Option<Optics> {
    // Rays through the axis at the distance: the film is where they meet again.
    let fan = crossed(lens, [distance, 1.0]);
    let [height, slope] = *fan.last()?;
    let to_film = -height / slope;
    // The image of a point at height 1, by the ray through the middle of the first surface.
    let [height, slope] = *crossed(lens, [0.0, -1.0 / distance]).last()?;
    let magnification = height + slope * to_film;
    let field = 0.5 * diagonal / magnification.abs() / distance;
    // The widest ray of the fan that passes all apertures.
    let widest = lens.iter().zip(&fan).map(|(surface, [height, _])| 0.5 * surface.aperture / height.abs());
    let widest = widest.fold(f64::INFINITY, f64::min);
    let last = fan.last()?[1] * widest;
    let exposure = std::f64::consts::PI * last * last;
    let is_usable = to_film > 0.0
        && field.is_finite()
        && field > 1e-3
        && field < 20.0
        && exposure > 1e-9
        && exposure.is_finite();
    is_usable.then_some(Optics { slope: field, exposure })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thin_lens_obeys_its_formula() {
        // f = 50 mm, f/2, of glass of index 1.5, focused at 10 m.
        let lens = surfaces(b"# thin\n50 0.001 1.5 25\n-50 50 1 25\n").unwrap();
        let Optics { slope, exposure } = optics(&lens, 43.27, 10_000.0).unwrap();
        let image = 1.0 / (1.0 / 50.0 - 1.0 / 10_000.0);
        assert!((slope - 0.5 * 43.27 / image).abs() < 1e-4, "{slope}");
        let expected = std::f64::consts::PI * (12.5 / image) * (12.5 / image);
        assert!((exposure / expected - 1.0).abs() < 1e-3, "{exposure} {expected}");
        let fov = Optics { slope, exposure }.field_of_view(1.5);
        assert!((fov - 27.0).abs() < 0.2, "a full frame has 27° along its short side, not {fov}");
    }

    #[test]
    fn files_that_are_no_lens_are_refused() {
        for bad in [&b""[..], b"1 2 3", b"a b c d", b"inf 1 1 1", b"0 0 0 0", b"50 1 1 1"] {
            assert!(surfaces(bad).and_then(|lens| optics(&lens, 35.0, 1e4)).is_none(), "{bad:?}");
        }
        assert!(surfaces(&b"1 1 1 1\n".repeat(300)).is_none());
    }
}
