//! The message that tells a page of a scene.

use glam::DVec3;
use lookfrom::inspect::{self, LightPlace};
use lookfrom::session::Session;
use lookfrom::world::World;
use lookfrom_scene::camera::{Look, Projection};
use lookfrom_scene::contents::AnimationEntry;
use lookfrom_scene::settings::{Integrator, Tonemap};
use lookfrom_scene::{WarningGroup, WarningKind};

use crate::develop;
use crate::document::Loaded;
use crate::message::{AnimationAnswer, BoundsAnswer, CameraAnswer, LayerAnswer, LightAnswer, SceneAnswer};

/// The most lights that are listed: a mesh may have millions.
const MOST_LIGHTS: usize = 256;

impl Loaded {
    /// The message of this scene, with the camera and the settings of a session of it.
    pub(crate) fn told(&self, session: &Session) -> SceneAnswer {
        let (image, settings, info) = (session.image(), session.settings(), session.info());
        let numbered =
            |(number, name): (usize, Option<&String>)| name.cloned().unwrap_or_else(|| number.to_string());
        let warnings = WarningGroup::of(session.warnings());
        SceneAnswer {
            generation: self.generation,
            name: session.name().to_owned(),
            size: [image.width, image.height],
            is_sized: self.options.width.is_some() || self.options.height.is_some(),
            camera: camera(session),
            bounds: BoundsAnswer { min: info.bounds.min.into(), max: info.bounds.max.into() },
            integrator: settings.integrator.word(),
            integrators: Integrator::WORDS.iter().map(|&(word, _)| word).collect(),
            depth: settings.depth,
            samples: settings.samples,
            min_contribution: settings.min_contribution,
            exposure: image.exposure,
            tonemap: image.tonemap.word(),
            tonemaps: Tonemap::WORDS.iter().map(|&(word, _)| word).collect(),
            denoise: image.denoise,
            layers: develop::layers().map(|(name, title)| LayerAnswer { name, title }).collect(),
            variants: info.contents.variants.iter().map(Option::as_ref).enumerate().map(numbered).collect(),
            animations: info
                .contents
                .animations
                .iter()
                .enumerate()
                .map(|(number, animation)| AnimationAnswer {
                    name: numbered((number, animation.name.as_ref())),
                    seconds: animation.duration.unwrap_or(0.0),
                })
                .collect(),
            duration: info.contents.duration,
            turntable: self.options.turn.is_some(),
            turn: self.options.turn,
            rotate_environment: self.options.rotate_environment,
            at: self.options.import.at,
            variant: self.options.import.variant.clone(),
            animation: self.options.import.animation.as_ref().and_then(|typed| {
                let named = |animation: &AnimationEntry| animation.name.as_ref() == Some(typed);
                info.contents.animations.iter().position(named).or_else(|| typed.parse().ok())
            }),
            counts: info.counts.clone(),
            lights: lights(session.world()),
            reference: self.reference.as_ref().map(|image| image.name.clone()),
            warnings: warnings
                .iter()
                .filter(|group| group.kind() == WarningKind::Warning)
                .map(ToString::to_string)
                .collect(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

/// The camera of a session.
pub(crate) fn camera(session: &Session) -> CameraAnswer {
    let (camera, middle) = (session.camera(), session.info().bounds.center());
    let look = camera.nearest_look(middle).unwrap_or_else(|| {
        let lookfrom = camera.view.lookfrom();
        Look { lookfrom, lookat: lookfrom + DVec3::Z, up: DVec3::Y }
    });
    let (fov, projection) = match camera.projection {
        Projection::Perspective { fov } => (Some(fov), "perspective"),
        Projection::Orthographic { .. } => (None, "orthographic"),
        Projection::Equirectangular | Projection::EquirectangularPbrt => (None, "equirectangular"),
        Projection::Octahedral => (None, "octahedral"),
        Projection::LensSystem(_) => (None, "lens"),
        Projection::Irradiance { .. } => (None, "irradiance"),
    };
    CameraAnswer {
        lookfrom: look.lookfrom.into(),
        lookat: look.lookat.into(),
        up: look.up.into(),
        fov,
        projection,
        is_mirrored: camera.is_mirrored(),
    }
}

fn lights(world: &World) -> Vec<LightAnswer> {
    let told = |LightPlace { kind, position, .. }: LightPlace| LightAnswer { name: kind, position };
    inspect::lights(world).take(MOST_LIGHTS).map(told).collect()
}
