//! A viewpoint: the side from which an automatic framing shows a scene, and the lens.

use glam::DVec3;

use super::{FOV, TAN_HALF_FOV, TO_CAMERA};
use crate::camera::{Target, View};
use crate::scene::{Scene, SourceFormat};

/// The side from which a scene is shown, and the lens: a perspective, or parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Degrees around the up vector, counter-clockwise as seen from above: 0 is the front, 90 the right side.
    pub azimuth: f64,
    /// Degrees above the horizon, −90 to 90.
    pub elevation: f64,
    /// The vertical field of view in degrees, in (0, 180); `None` for parallel rays.
    pub fov: Option<f64>,
}

impl Viewpoint {
    /// From the right, the front and slightly above, in perspective: the view of models that nobody has chosen a view of.
    pub const THREE_QUARTER: Self =
        Self { azimuth: 30.465_544_919_459_877, elevation: 23.069_004_851_333_656, fov: Some(FOV) };

    /// Views by name. All but `persp` have parallel rays; in `iso` the axes are equally long.
    pub const WORDS: &'static [(&'static str, Self)] = &[
        ("front", Self::parallel(0.0, 0.0)),
        ("right", Self::parallel(90.0, 0.0)),
        ("back", Self::parallel(180.0, 0.0)),
        ("left", Self::parallel(270.0, 0.0)),
        ("top", Self::parallel(0.0, 90.0)),
        ("bottom", Self::parallel(0.0, -90.0)),
        ("iso", Self::parallel(45.0, 35.264_389_682_754_654)),
        ("persp", Self::THREE_QUARTER),
    ];

    const fn parallel(azimuth: f64, elevation: f64) -> Self {
        Self { azimuth, elevation, fov: None }
    }

    /// The unit vector towards the camera, and the up vector of the picture; `basis` is right, up and towards the viewer.
    pub(super) fn axes(&self, basis: [DVec3; 3]) -> [DVec3; 2] {
        let place = |[right, up, back]: [f64; 3]| right * basis[0] + up * basis[1] + back * basis[2];
        let Self { azimuth, elevation, .. } = Self::THREE_QUARTER;
        if (self.azimuth, self.elevation) == (azimuth, elevation) {
            return [place(TO_CAMERA).normalize(), basis[1]];
        }
        let (sin_azimuth, cos_azimuth) = libm::sincos(self.azimuth.to_radians());
        let (sin, cos) = libm::sincos(self.elevation.to_radians());
        let to_camera = place([cos * sin_azimuth, sin, cos * cos_azimuth]).normalize();
        // Straight from above or below, the scene's up vector would be no direction of the picture.
        let up = place([-sin * sin_azimuth, cos, -sin * cos_azimuth]);
        [to_camera, if cos.abs() < 1e-3 { up } else { basis[1] }]
    }

    /// The tangent of half the field of view; 0 for parallel rays.
    pub(super) fn slope(&self) -> f64 {
        match self.fov {
            None => 0.0,
            Some(FOV) => TAN_HALF_FOV,
            Some(fov) => libm::tan(0.5 * fov.to_radians()),
        }
    }
}

/// The up vector (of any length) that the camera of a scene gives, by the point that it looks at or else its orientation.
pub fn up_of_camera(scene: &Scene) -> Option<DVec3> {
    let camera = scene.camera.as_ref()?;
    target(scene).map(|target| target.up).or(match camera.view {
        // In these formats the camera's y axis is the up vector.
        View::Matrix(matrix) if scene.source_format != SourceFormat::Gltf => Some(matrix.y_axis.truncate()),
        _ => None,
    })
}

/// The point that the camera of a scene looks at, and its up vector.
pub(super) fn target(scene: &Scene) -> Option<Target> {
    let camera = scene.camera.as_ref()?;
    match camera.view {
        View::Look { lookat, up, .. } => Some(Target { lookat, up }),
        View::Matrix(_) => camera.target,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
    use crate::scene::Bounds;
    use crate::studio::{basis, corners, framing_from};
    use proptest::prelude::*;

    /// A point in the picture: x and y in [−1, 1], and the depth.
    fn project(camera: &crate::camera::Camera, aspect: f64, p: DVec3) -> [f64; 3] {
        let View::Look { lookfrom, lookat, up } = camera.view else { panic!("not a lookat") };
        let w = (lookat - lookfrom).normalize();
        let right = w.cross(up).normalize();
        let to = p - lookfrom;
        let depth = to.dot(w);
        let half = match &camera.projection {
            Projection::Perspective { fov } => depth * (0.5 * fov.to_radians()).tan(),
            Projection::Orthographic { height } => 0.5 * height,
            other => panic!("{other:?}"),
        };
        [to.dot(right) / (half * aspect), to.dot(right.cross(w)) / half, depth]
    }

    proptest! {
        #[test]
        fn every_view_shows_the_whole_box(
            azimuth in -720.0..720.0, elevation in -90.0..=90.0, named in 0..16_usize, fov in prop::option::of(0.5..170.0),
            size in prop::array::uniform3(-3..3_i32), scale in -30..30, flat in 0..4_usize, aspect in 0.2..5.0, z_up: bool,
        ) {
            let mut viewpoint = Viewpoint { azimuth, elevation, fov };
            if let Some((_, known)) = Viewpoint::WORDS.get(named) { viewpoint = *known; }
            let mut half = 2_f64.powi(scale) * DVec3::from_array(size.map(|exponent| 2_f64.powi(exponent)));
            if flat < 3 { half[flat] = 0.0; }
            let bounds = Bounds { min: -half, max: half };
            let up = if z_up { DVec3::Z } else { DVec3::Y };
            let camera = framing_from(bounds, aspect, basis(up), &viewpoint);
            let mut most = 0.0_f64;
            for corner in corners(bounds) {
                let [x, y, depth] = project(&camera, aspect, corner);
                prop_assert!(depth > 0.0, "{camera:?}");
                most = most.max(x.abs()).max(y.abs());
            }
            prop_assert!(most < 0.89, "{most} {camera:?}");
            // What is seen from its edge alone, or with the eye at its corner, may be smaller.
            let is_usual = flat == 3 && viewpoint.fov.is_none_or(|fov| fov < 60.0);
            prop_assert!(most > 0.87 || !is_usual, "{most} {camera:?}");
        }
    }

    #[test]
    fn sides_are_those_of_modelling_programs() {
        // The direction to the camera, and what is up in the picture, with y up and with z up.
        let known = [
            ("front", [DVec3::Z, DVec3::Y], [DVec3::NEG_Y, DVec3::Z]),
            ("right", [DVec3::X, DVec3::Y], [DVec3::X, DVec3::Z]),
            ("back", [DVec3::NEG_Z, DVec3::Y], [DVec3::Y, DVec3::Z]),
            ("left", [DVec3::NEG_X, DVec3::Y], [DVec3::NEG_X, DVec3::Z]),
            ("top", [DVec3::Y, DVec3::NEG_Z], [DVec3::Z, DVec3::Y]),
            ("bottom", [DVec3::NEG_Y, DVec3::Z], [DVec3::NEG_Z, DVec3::NEG_Y]),
        ];
        for (name, y_up, z_up) in known {
            let (_, viewpoint) = Viewpoint::WORDS.iter().find(|(word, _)| *word == name).expect("a view");
            for (up, expected) in [(DVec3::Y, y_up), (DVec3::Z, z_up)] {
                let axes = viewpoint.axes(basis(up));
                for (axis, expected) in axes.into_iter().zip(expected) {
                    assert!(axis.abs_diff_eq(expected, 1e-12), "{name}, {up}: {axis}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn three_quarters_are_known_in_degrees() {
        let exact = Viewpoint::THREE_QUARTER;
        let near = Viewpoint { azimuth: exact.azimuth + 1e-9, ..exact };
        let [exact, near] = [exact, near].map(|viewpoint| viewpoint.axes(basis(DVec3::Y))[0]);
        assert!(exact.abs_diff_eq(near, 1e-10), "{exact} {near}");
    }
}
