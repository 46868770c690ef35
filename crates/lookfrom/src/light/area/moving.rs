//! Area lights that move: sampled where they are when the shutter opens, by a point that moves with them.
//!
//! Rigid motions keep solid angles, and so densities. Other lights that move are not sampled: paths find them.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Affine, Point};

use super::{AreaDensity, AreaLight, LightSample, Target};
use crate::shading::interaction::SurfaceInteraction;

/// The motion of a light: maps of render space at equally spaced times from the opening to the closing of the shutter, linear in
/// between; the first is the identity.
#[derive(Clone, Debug)]
pub(crate) struct LightMotion {
    maps: Arc<[Affine]>,
    is_rigid: bool,
}

impl LightMotion {
    pub(crate) fn new(maps: &[Affine]) -> Self {
        Self { maps: maps.into(), is_rigid: maps.iter().all(is_rotation) }
    }

    /// The motion of a light that changes its form where it is.
    pub(crate) fn deforming() -> Self {
        Self { maps: [Affine::IDENTITY; 2].into(), is_rigid: false }
    }

    /// Whether it keeps lengths.
    pub(super) fn is_rigid(&self) -> bool {
        self.is_rigid
    }

    /// The box around a box at all times.
    pub(super) fn bounds(&self, corners: [DVec3; 2]) -> [DVec3; 2] {
        let places = self.maps.iter().flat_map(|map| {
            (0..8).map(move |corner| {
                let pick = |axis: usize| corners[corner >> axis & 1][axis];
                DVec3::from_array(map.point([pick(0), pick(1), pick(2)]))
            })
        });
        places.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], p| [min.min(p), max.max(p)])
    }
}

/// Whether a map is a rotation and a translation, up to 10⁻⁶.
fn is_rotation(map: &Affine) -> bool {
    let m = &map.matrix;
    let dot = |i: usize, j: usize| (0..3).map(|k| m[k][i] * m[k][j]).sum::<f64>();
    let is_even = (0..3).all(|i| (i..3).all(|j| (dot(i, j) - f64::from(i == j)).abs() < 1e-6));
    let [x, y, z] = [0, 1, 2].map(|j| DVec3::new(m[0][j], m[1][j], m[2][j]));
    is_even && x.cross(y).dot(z) > 0.0
}

/// The place of a light at a time: the map from where it was, and back.
pub(crate) struct LightPlace {
    now: Affine,
    back: Affine,
}

impl AreaLight {
    /// The place of a light that moves, at a time of the shutter (0 … 1); `None` for one that stands still.
    pub(crate) fn place_at(&self, time: f32) -> Option<LightPlace> {
        let now = Affine::at_time(&self.motion.as_ref()?.maps, time);
        let back = now.inverse()?;
        Some(LightPlace { now, back })
    }
}

impl LightPlace {
    /// A sample from a point, by `sample` where the light was.
    pub(crate) fn sample(
        &self,
        from: DVec3,
        sample: impl FnOnce(DVec3) -> Option<LightSample>,
    ) -> Option<LightSample> {
        let there = sample(point(&self.back, from))?;
        let target = match there.target {
            Target::Surface(Point { position, error }, normal) => {
                // A rotation carries the errors of all axes to each; rounding adds to them.
                let position = self.now.point(position);
                let largest = position.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
                let error = error.iter().sum::<f64>() + 16.0 * f64::EPSILON * largest;
                let here = Point { position, error: [error; 3] };
                Target::Surface(here, direction(&self.now, normal))
            }
            other => other,
        };
        Some(LightSample { wi: direction(&self.now, there.wi.as_dvec3()).as_vec3(), target, ..there })
    }

    /// The density of a direction from a point to the light's surface, by `pdf` where the light was.
    pub(crate) fn pdf(
        &self,
        from: DVec3,
        surface: &SurfaceInteraction,
        wi: Vec3,
        pdf: impl FnOnce(DVec3, &SurfaceInteraction, Vec3) -> f32,
    ) -> f32 {
        let Point { position, error } = surface.point;
        let there = SurfaceInteraction {
            point: Point { position: self.back.point(position), error },
            ng: direction(&self.back, surface.ng),
            ns: direction(&self.back, surface.ns.as_dvec3()).as_vec3(),
            ..*surface
        };
        pdf(point(&self.back, from), &there, direction(&self.back, wi.as_dvec3()).as_vec3())
    }

    /// The operands of the density of a point of the light as seen from another, by `density` where the light was; they are told
    /// where it is now.
    pub(super) fn density(
        &self,
        from: DVec3,
        at: DVec3,
        density: impl FnOnce(DVec3, DVec3) -> AreaDensity,
    ) -> AreaDensity {
        let now = |corners: [DVec3; 3]| corners.map(|corner| point(&self.now, corner));
        match density(point(&self.back, from), point(&self.back, at)) {
            AreaDensity::Area { area, probability, corners } => {
                AreaDensity::Area { area, probability, corners: corners.map(now) }
            }
            AreaDensity::SolidAngle { solid_angle, probability, corners } => {
                AreaDensity::SolidAngle { solid_angle, probability, corners: now(corners) }
            }
            unmoved @ (AreaDensity::Cone { .. } | AreaDensity::Patch { .. }) => unmoved,
        }
    }
}

fn point(map: &Affine, p: DVec3) -> DVec3 {
    map.point(p.to_array()).into()
}

/// A unit vector under a rigid map.
fn direction(map: &Affine, v: DVec3) -> DVec3 {
    DVec3::from_array(map.vector(v.to_array())).normalize()
}
