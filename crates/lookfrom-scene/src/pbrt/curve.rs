//! The shape "curve", as cubic Bézier curves.

use glam::Vec3;

use super::Reader;
use super::params::{ParameterType, Parameters};
use crate::error::Result;
use crate::shape::{Geometry, Profile, Shape, Strand, cubic_b_spline};

#[derive(Clone, Copy, PartialEq)]
enum Basis {
    Bezier,
    BSpline,
}

#[derive(Clone, Copy, PartialEq)]
enum CurveShape {
    Flat,
    Cylinder,
    Ribbon,
}

impl Reader<'_, '_> {
    pub(super) fn curve_shape(&mut self, p: &Parameters) -> Result<Geometry> {
        p.ignore(&["splitdepth"]);
        let degree = p.integer("degree", 3, 2, 3)? as usize;
        let basis =
            p.choice("basis", Basis::Bezier, &[("bezier", Basis::Bezier), ("bspline", Basis::BSpline)])?;
        let forms =
            [("flat", CurveShape::Flat), ("cylinder", CurveShape::Cylinder), ("ribbon", CurveShape::Ribbon)];
        let form = p.choice("type", CurveShape::Flat, &forms)?;
        let width = p.float("width", 1.0)?;
        let widths = [p.float("width0", width)?, p.float("width1", width)?];
        if !(widths[0].max(widths[1]) > 0.0) || widths[0].min(widths[1]) < 0.0 {
            let name = if p.has("width0") { "width0" } else { "width" };
            return Err(p.refuse(name, "widths of at least 0, one of them greater than 0"));
        }

        let points = p.vectors("P", ParameterType::Point3)?;
        let count = points.len();
        let segments = match basis {
            Basis::Bezier if count > degree && (count - 1).is_multiple_of(degree) => (count - 1) / degree,
            Basis::BSpline if count > degree => count - degree,
            Basis::Bezier => {
                let expected = format!("{} control points and {degree} for each further segment", degree + 1);
                return Err(p.refuse("P", &format!("{expected}, found {count}")));
            }
            Basis::BSpline => {
                return Err(p.refuse("P", &format!("at least {} control points, found {count}", degree + 1)));
            }
        };
        let normals = p.vectors("N", ParameterType::Normal)?;
        if form == CurveShape::Ribbon && normals.len() != segments + 1 {
            let expected = format!(
                "{} normals for {} of a ribbon",
                segments + 1,
                crate::plural::counted(segments, "segment")
            );
            return Err(p.refuse("N", &format!("{expected}, found {}", normals.len())));
        }

        let at = |end: usize| widths[0] + (widths[1] - widths[0]) * (end as f32 / segments as f32);
        // The smallest width, for curves that end in a point.
        let thinnest = 1e-6 * widths[0].max(widths[1]);
        let strands = (0..segments).map(|segment| {
            let points = match (basis, degree) {
                (Basis::Bezier, 2) => elevated(corners(&points[2 * segment..])),
                (Basis::Bezier, _) => corners(&points[3 * segment..]),
                (Basis::BSpline, 2) => elevated(quadratic_b_spline(corners(&points[segment..]))),
                (Basis::BSpline, _) => cubic_b_spline(corners(&points[segment..])),
            };
            let profile = match form {
                CurveShape::Flat => Profile::Flat,
                CurveShape::Cylinder => Profile::PbrtCylinder,
                CurveShape::Ribbon => Profile::Ribbon(
                    [segment, segment + 1].map(|end| normals[end].try_normalize().unwrap_or(Vec3::Z)),
                ),
            };
            Strand { points, width: [at(segment).max(thinnest), at(segment + 1).max(thinnest)], profile }
        });
        Ok(Geometry::Curves(strands.collect()))
    }
}

/// Merges successive shapes of curves that differ only in geometry: files of hair have one shape per curve.
pub(super) fn join(shapes: &mut Vec<Shape>) {
    let mut joined: Vec<Shape> = Vec::new();
    let mut strands: Vec<Strand> = Vec::new();
    for shape in shapes.drain(..) {
        let Geometry::Curves(own) = &shape.geometry else {
            close(&mut joined, &mut strands);
            joined.push(shape);
            continue;
        };
        let is_like = |before: &Shape| {
            before.material == shape.material
                && before.emission == shape.emission
                && before.alpha == shape.alpha
                && before.sides == shape.sides
                && before.reverse_orientation == shape.reverse_orientation
                && before.world_from_object == shape.world_from_object
        };
        if strands.is_empty() || !joined.last().is_some_and(is_like) {
            close(&mut joined, &mut strands);
            strands.extend(own.iter());
            joined.push(shape);
        } else {
            strands.extend(own.iter());
        }
    }
    close(&mut joined, &mut strands);
    *shapes = joined;
}

/// Moves the collected curves into the last shape.
fn close(joined: &mut [Shape], strands: &mut Vec<Strand>) {
    if let (Some(last), false) = (joined.last_mut(), strands.is_empty()) {
        last.geometry = Geometry::Curves(std::mem::take(strands).into());
    }
}

fn corners<const N: usize>(points: &[Vec3]) -> [Vec3; N] {
    std::array::from_fn(|i| points[i])
}

/// Degree elevation from quadratic to cubic.
fn elevated([a, b, c]: [Vec3; 3]) -> [Vec3; 4] {
    [a, a + (b - a) * (2.0 / 3.0), c + (b - c) * (2.0 / 3.0), c]
}

/// The Bézier points of a segment of a uniform quadratic B-spline.
fn quadratic_b_spline([a, b, c]: [Vec3; 3]) -> [Vec3; 3] {
    [(a + b) * 0.5, b, (b + c) * 0.5]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bezier(p: &[Vec3], t: f32) -> Vec3 {
        match p {
            [one] => *one,
            _ => {
                let next: Vec<Vec3> = p.windows(2).map(|pair| pair[0].lerp(pair[1], t)).collect();
                bezier(&next, t)
            }
        }
    }

    /// Evaluation by the basis polynomials.
    fn b_spline(p: [Vec3; 4], t: f32) -> Vec3 {
        let s = 1.0 - t;
        (p[0] * s.powi(3)
            + p[1] * (3.0 * t.powi(3) - 6.0 * t * t + 4.0)
            + p[2] * (-3.0 * t.powi(3) + 3.0 * t * t + 3.0 * t + 1.0)
            + p[3] * t.powi(3))
            / 6.0
    }

    const POINTS: [Vec3; 4] = [
        Vec3::new(0.0, 1.0, 2.0),
        Vec3::new(-3.0, 0.5, 1.0),
        Vec3::new(2.0, 2.0, -1.0),
        Vec3::new(4.0, -5.0, 0.0),
    ];

    #[test]
    fn conversions_keep_the_curve() {
        let quadratic = [POINTS[0], POINTS[1], POINTS[2]];
        for i in 0..=8 {
            let t = i as f32 / 8.0;
            assert!(bezier(&elevated(quadratic), t).abs_diff_eq(bezier(&quadratic, t), 1e-5));
            assert!(bezier(&cubic_b_spline(POINTS), t).abs_diff_eq(b_spline(POINTS, t), 1e-5));
            let s = 1.0 - t;
            let blended =
                (quadratic[0] * s * s + quadratic[1] * (1.0 + 2.0 * t * s) + quadratic[2] * t * t) * 0.5;
            assert!(bezier(&quadratic_b_spline(quadratic), t).abs_diff_eq(blended, 1e-5));
        }
    }
}
