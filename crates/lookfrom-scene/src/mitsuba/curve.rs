//! Curves of text files: lines with a position and a radius, and an empty line between two curves.

use glam::Vec3;

use super::Reader;
use super::plugin::Plugin;
use super::xml::blame;
use crate::error::{Error, Location, Result};
use crate::shape::{Geometry, Profile, Strand, cubic_b_spline};

/// A control point with its radius.
type Knot = (Vec3, f32);

impl Reader<'_, '_> {
    /// The curves of a `bsplinecurve` or `linearcurve`.
    pub(super) fn curves(&mut self, plugin: &Plugin) -> Result<Geometry> {
        let (path, at) = self.file(plugin)?;
        let message = "curves are bands that face the ray, shaded as cylinders; their radius is linear along each segment";
        self.warn_once(&plugin.at, message);
        let bytes = self.context.read(&path).map_err(|error| blame(error, &at))?;
        let file = Location::file(&path);
        let text = std::str::from_utf8(&bytes).map_err(|_| Error::syntax(&file, "the text is not UTF-8"))?;
        let mut strands = Vec::new();
        let mut knots: Vec<Knot> = Vec::new();
        let is_cubic = plugin.kind == "bsplinecurve";
        for (number, line) in (1..).zip(text.lines().chain([""])) {
            let place = file.at(number, 1);
            match super::value::floats(line, &place)?[..] {
                [] => {
                    let own = if is_cubic { cubic(&knots) } else { linear(&knots) };
                    if own.is_empty() && !knots.is_empty() {
                        let least = if is_cubic { 4 } else { 2 };
                        let message = format!("a curve of {} points; expected at least {least}", knots.len());
                        return Err(Error::invalid(&place, message));
                    }
                    strands.extend(own);
                    knots.clear();
                }
                [x, y, z, radius] if radius >= 0.0 => {
                    knots.push((Vec3::new(x as f32, y as f32, z as f32), radius as f32));
                }
                ref numbers => {
                    let message = format!("expected x, y, z and a radius of at least 0, found {numbers:?}");
                    return Err(Error::invalid(&place, message));
                }
            }
        }
        if strands.is_empty() {
            return Err(Error::invalid(&file, "there are no curves"));
        }
        self.context.keep((strands.len() * size_of::<Strand>()) as u64, "curves", &at)?;
        Ok(Geometry::Curves(strands.into()))
    }
}

fn strand(points: [Vec3; 4], radii: [f32; 2]) -> Strand {
    // Curves that end in a point have a smallest width.
    let least = f32::max(1e-6 * radii[0].max(radii[1]), 1e-30);
    Strand { points, width: radii.map(|radius| 2.0 * radius.max(least)), profile: Profile::Cylinder }
}

/// The segments of a uniform cubic B-spline.
fn cubic(knots: &[Knot]) -> Vec<Strand> {
    let of = |segment: &[Knot]| {
        let points = cubic_b_spline(std::array::from_fn(|index| segment[index].0));
        let radius = |first: usize| {
            let [a, b, c] = [0, 1, 2].map(|step| segment[first + step].1);
            (a + 4.0 * b + c) / 6.0
        };
        strand(points, [radius(0), radius(1)])
    };
    knots.windows(4).map(of).collect()
}

/// The segments between points.
fn linear(knots: &[Knot]) -> Vec<Strand> {
    let of = |pair: &[Knot]| {
        let ((from, first), (to, last)) = (pair[0], pair[1]);
        let points = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|t| from.lerp(to, t));
        (from != to).then(|| strand(points, [first, last]))
    };
    knots.windows(2).filter_map(of).collect()
}
