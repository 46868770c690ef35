//! Curve lights: they are not sampled; rays that meet them find their light.

use glam::DVec3;
use lookfrom_scene::shape::Profile;

use crate::primitive::Curves;

/// Curves that emit light.
#[derive(Clone, Copy, Debug)]
pub struct CurveLight {
    area: f64,
    bounds: [DVec3; 2],
}

impl CurveLight {
    /// A light of curves whose transform scales lengths by `scale`. None for curves without length.
    pub fn new(curves: &Curves, scale: f64) -> Option<Self> {
        let (mut area, mut bounds) = (0.0, [DVec3::INFINITY, DVec3::NEG_INFINITY]);
        for primitive in 0..curves.count() {
            let (strand, [from, to]) = curves.segment(primitive as u32);
            let [first, last] = strand.width.map(f64::from);
            let width = scale * (first + 0.5 * (from + to) * (last - first));
            let around = match strand.profile {
                Profile::Ribbon(_) => 1.0,
                // A half of a cylinder's surface.
                Profile::Flat | Profile::Cylinder | Profile::PbrtCylinder => 0.5 * std::f64::consts::PI,
            };
            let [start, end] = curves.ends(primitive);
            area += around * width * start.distance(end);
            bounds = [bounds[0].min(start).min(end) - width, bounds[1].max(start).max(end) + width];
        }
        (area > 0.0 && area.is_finite()).then_some(Self { area, bounds })
    }

    /// The area of one side, with each of the pieces of a curve as a straight one. A curve that faces all rays has that of half
    /// a cylinder, so that both sides emit what is seen of it from all around.
    pub(super) fn area(&self) -> f64 {
        self.area
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }
}
