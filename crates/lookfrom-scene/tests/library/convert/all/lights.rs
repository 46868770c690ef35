//! Scenes with each light.

use glam::{DMat4, DVec3};
use lookfrom_scene::Scene;
use lookfrom_scene::light::{Edge, Falloff, Light, LightKind, MapRows, Power, Projected, Sky};
use lookfrom_scene::material::Color;
use lookfrom_scene::scene::{CurveId, ImageId};
use lookfrom_scene::shape::Emission;
use lookfrom_scene::texture::TexelFilter;

use super::{base, each, here, shear};

pub(super) fn lights() -> Vec<(String, Scene)> {
    let intensity = Color::Value([1.0, 2.0, 3.0]);
    let environment = |sky| LightKind::Environment { sky, portal: None, illuminates: true };
    let (scale, world_from_light) = ([0.5, 0.25, 1.0], shear());
    let image = ImageId(0);
    let portal = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(DVec3::from_array);
    let variants = vec![
        LightKind::Ambient { color: [0.1, 0.2, 0.3] },
        LightKind::Point { position: DVec3::Y, intensity, falloff: Falloff::None },
        LightKind::Distant { direction: DVec3::new(0.1, -0.2, 0.3), intensity: Color::Curve(CurveId(7)) },
        LightKind::Spot {
            position: DVec3::Y,
            direction: -DVec3::Y,
            intensity: Color::Curve(CurveId(8)),
            cone_angle: 33.3,
            inner_angle: 11.1,
            edge: Edge::Linear,
            falloff: Falloff::Linear,
        },
        LightKind::Projection {
            image,
            filter: TexelFilter::Bilinear,
            quantity: Projected::Irradiance,
            intensity: 2.0,
            cone: Some([40.0, 15.0]),
            fov: 33.0,
            world_from_light,
        },
        LightKind::Goniometric { intensity, image, filter: TexelFilter::Nearest, world_from_light },
        LightKind::Goniometric { intensity, image, filter: TexelFilter::Bilinear, world_from_light },
        LightKind::Environment { sky: Sky::Constant(intensity), portal: Some(portal), illuminates: false },
        environment(Sky::Gradient { zenith: [0.1; 3], horizon: [0.2; 3], nadir: [0.5, 0.25, 0.125] }),
        environment(Sky::Image { image: ImageId(3), scale, world_from_light, rows: MapRows::ToPoles }),
        environment(Sky::Image {
            image,
            scale: [1.0; 3],
            world_from_light: DMat4::IDENTITY,
            rows: MapRows::Bands,
        }),
        environment(Sky::Octahedral { image: ImageId(3), scale, world_from_light }),
    ];
    let index = |kind: &LightKind| match kind {
        LightKind::Ambient { .. } => 0,
        LightKind::Point { .. } => 1,
        LightKind::Distant { .. } => 2,
        LightKind::Spot { .. } => 3,
        LightKind::Projection { .. } => 4,
        LightKind::Goniometric { .. } => 5,
        LightKind::Environment { sky: Sky::Constant(_), .. } => 6,
        LightKind::Environment { sky: Sky::Gradient { .. }, .. } => 7,
        LightKind::Environment { sky: Sky::Image { .. }, .. } => 8,
        LightKind::Environment { sky: Sky::Octahedral { .. }, .. } => 9,
    };
    each("light", variants, index, |scene, kind| {
        scene.lights.push(Light {
            name: Some("a lamp".to_owned()),
            at: here(),
            kind,
            power: Power::AS_WRITTEN,
        });
    })
}

/// Powers of a light, and of a shape.
pub(super) fn powers() -> Vec<(String, Scene)> {
    let kinds = [Color::Value([1.0, 2.0, 3.0]), Color::Curve(CurveId(2))];
    let powers = [
        Power { scale: 0.3, total: None, absolute: false },
        Power { scale: 1.0, total: Some(7.0), absolute: false },
        Power { scale: 0.3, total: Some(7.0), absolute: false },
        Power { scale: 0.3, total: None, absolute: true },
    ];
    let scene = |color: Color, power: Power| {
        let mut scene = base();
        let kind = LightKind::Point { position: DVec3::Y, intensity: color, falloff: Falloff::Quadratic };
        scene.lights.push(Light { name: None, at: here(), kind, power });
        scene.shapes[0].emission = Some(Emission { radiance: color, power, two_sided: true });
        (format!("power {color:?} {power:?}"), scene)
    };
    kinds.iter().flat_map(|color| powers.iter().map(move |power| scene(*color, *power))).collect()
}
