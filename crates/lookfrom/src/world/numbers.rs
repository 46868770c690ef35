//! Warnings about numbers of materials beyond what they may be: readers of other formats take them as they are written.

use lookfrom_scene::Warning;
use lookfrom_scene::material::{Number, Scalar};
use lookfrom_scene::scene::Scene;

/// Warns of each number of a material that is out of its range. Values of textures are not checked.
pub(super) fn check(scene: &Scene, warnings: &mut Vec<Warning>) {
    for material in &scene.materials {
        let mut outside: Vec<_> = material.kind.numbers().into_iter().filter_map(beyond).collect();
        // A roughness along u is most often that along v, too.
        outside.dedup();
        for (key, what) in outside {
            let message = format!("the {key} of material `{}` is {what}", material.name);
            warnings.push(Warning::new(&material.at, message));
        }
    }
}

/// The name of a number that is out of its range, and what is to be said of its value.
fn beyond((key, number, range): Number) -> Option<(&'static str, String)> {
    let Scalar::Value(value) = number else { return None };
    if range.contains(&value) {
        return None;
    }
    let (low, high) = range.into_inner();
    let expected = match high.is_finite() {
        true => format!("{low} to {high}"),
        false => format!("at least {low}"),
    };
    Some((key, format!("{value}; expected {expected}: it counts as {}", value.clamp(low, high))))
}
