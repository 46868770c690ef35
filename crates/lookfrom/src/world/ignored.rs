//! Warnings of lights and media that the integrator or the camera of a scene ignores.

use lookfrom_scene::camera::Camera;
use lookfrom_scene::light::LightKind;
use lookfrom_scene::scene::Scene;
use lookfrom_scene::settings::Integrator;
use lookfrom_scene::{Location, Warning, studio};

/// Whether the camera and the middle of a scene are where a light with a portal is not seen.
fn is_turned_away(light: &LightKind, scene: &Scene, camera: &Camera) -> bool {
    let LightKind::Environment { portal: Some([a, b, _, d]), .. } = light else { return false };
    let inward = (*b - *a).cross(*d - *a);
    let middle = scene.bounds().center();
    let eye = camera.look(middle).map_or(middle, |look| look.lookfrom);
    [middle, eye].iter().all(|point| (*point - *a).dot(inward) < 0.0)
}

pub(super) fn warn(scene: &Scene, camera: &Camera, warnings: &mut Vec<Warning>) {
    let integrator = scene.render.integrator;
    let mut warn = |at: Option<&Location>, message: String| {
        warnings.extend(at.map(|at| Warning::new(at, message)));
    };
    let mut lights = scene.lights.iter().filter(|light| !studio::is_added(light));
    let ambient = lights.clone().find(|light| matches!(light.kind, LightKind::Ambient { .. }));
    let without_size = lights.clone().find(|light| !light.kind.has_size());
    let hidden = lights.find(|light| is_turned_away(&light.kind, scene, camera));
    let message = "no light comes through the `portal`: the scene is behind it; its corners are counter-clockwise as seen from inside";
    warn(hidden.map(|light| &light.at), message.to_owned());
    let at_work = scene.media.iter().find(|medium| medium.scatters() || medium.emits());
    if matches!(integrator, Integrator::Path | Integrator::SimplePath | Integrator::RandomWalk) {
        let message = "ambient light belongs to Whitted's model: path tracing ignores it";
        warn(ambient.map(|light| &light.at), message.to_owned());
    }
    if integrator == Integrator::RandomWalk {
        let message = "\"random_walk\" finds no light without a size, since no path meets it: use \"path\"";
        warn(without_size.map(|light| &light.at), message.to_owned());
    }
    if camera.projection.is_measurement() {
        let message = "a light without a size adds nothing to the irradiance that is measured, but by reflection, since no ray meets it";
        warn(without_size.map(|light| &light.at), message.to_owned());
    }
    if scene.render.media && matches!(integrator, Integrator::Whitted | Integrator::Raycast) {
        let word = integrator.word();
        let message = format!("media neither scatter light nor emit it with {word:?}: use \"path\"");
        warn(at_work.map(|medium| &medium.at), message);
    }
}
