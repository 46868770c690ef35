//! Scenes with each camera.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use lookfrom_scene::Scene;
use lookfrom_scene::camera::{Camera, Lens, Projection, Target, View, Window};
use lookfrom_scene::lens::{ApertureShape, LensConvention, LensSurface, LensSystem};
use lookfrom_scene::motion::Motion;
use lookfrom_scene::scene::MediumId;

use super::{base, each, here, shear};

pub(super) fn cameras() -> Vec<(String, Scene)> {
    let surface =
        |curvature_radius, index| LensSurface { curvature_radius, thickness: 1.25, index, diameter: 10.1 };
    let system = |shape, convention| {
        Projection::LensSystem(Arc::new(LensSystem {
            name: "lens".to_owned(),
            surfaces: vec![
                surface(35.98738, 1.54),
                surface(0.0, 1.54),
                surface(f64::INFINITY, 1.6),
                surface(-24.7, 1.0),
            ],
            stop_diameter: Some(5.7),
            shape,
            focus_distance: 1.0 / 3.0,
            film_diagonal: 43.3,
            millimetre: 0.0123,
            convention,
        }))
    };
    let picture = Arc::new(base().images[0].clone());
    let shapes = [
        ApertureShape::Circle,
        ApertureShape::Gaussian,
        ApertureShape::Square,
        ApertureShape::Pentagon,
        ApertureShape::Star,
        ApertureShape::Image(picture),
    ];
    let mut variants = vec![
        Projection::Perspective { fov: 33.3 },
        Projection::Orthographic { height: 3.3 },
        Projection::Equirectangular,
        Projection::EquirectangularPbrt,
        Projection::Octahedral,
        Projection::Irradiance { surface: "measured".to_owned() },
    ];
    variants.extend(shapes.map(|shape| system(shape, LensConvention::Pbrt)));
    let index = |projection: &Projection| match projection {
        Projection::Perspective { .. } => 0,
        Projection::Orthographic { .. } => 1,
        Projection::Equirectangular => 2,
        Projection::EquirectangularPbrt => 3,
        Projection::Octahedral => 4,
        Projection::LensSystem(system) => match system.shape {
            ApertureShape::Circle => 6,
            ApertureShape::Gaussian => 7,
            ApertureShape::Square => 8,
            ApertureShape::Pentagon => 9,
            ApertureShape::Star => 10,
            ApertureShape::Image(_) => 11,
        },
        Projection::Irradiance { .. } => 5,
    };
    let target = Target { lookat: DVec3::new(0.1, 0.2, 0.3), up: DVec3::Z };
    let views = [
        (View::Look { lookfrom: DVec3::new(0.1, 2.0, 3.0), lookat: DVec3::ZERO, up: DVec3::Z }, None),
        (View::Matrix(shear()), Some(target)),
        (View::Matrix(shear()), None),
        (Camera::default().view, None),
    ];
    let mut scenes = Vec::new();
    for (view, target) in views {
        scenes.extend(each("camera", variants.clone(), index, |scene, projection| {
            let is_flat =
                matches!(projection, Projection::Perspective { .. } | Projection::Orthographic { .. });
            let lens = Lens { radius: 0.1, focus_distance: 1.0 / 3.0 };
            scene.shapes[0].name = Some("measured".to_owned());
            scene.camera = Some(Camera {
                clip: Some([0.25, 1e4]),
                at: here(),
                view,
                target,
                projection,
                lens: is_flat.then_some(lens),
                window: is_flat.then_some(Window { x: [-0.1, 0.7], y: [-1.0, 1.0 / 3.0] }),
                distance: 2.0,
                medium: Some(MediumId(1)),
                shutter: 0.5,
                motion: Motion::of_maps(vec![DMat4::IDENTITY, shear()]).map(Arc::new),
            });
        }));
    }
    scenes
}
