//! The requested animation, and the values of its channels at the requested time (specification, §3.11).
//!
//! [`LoadContext::import`] selects both.

use super::choose::choose;
use super::file::Document;
use super::json::AnimationSampler;
use super::track::{Interpolation, Track};
use crate::error::Result;
use crate::files::{ImportOptions, LoadContext};

/// The type of a channel's value.
#[derive(Clone, Copy)]
pub(super) enum Animated {
    /// A quaternion: x, y, z, w.
    Rotation,
    /// An element of this many components.
    Numbers(usize),
    /// A scalar for each morph target.
    Weights,
}

/// The index of the requested animation.
///
/// # Errors
/// If there is no such animation.
pub(super) fn chosen(document: &Document, context: &mut LoadContext<'_>) -> Result<Option<usize>> {
    let animations = &document.root.animations;
    match &context.import.animation {
        Some(name) => {
            let names = animations.iter().map(|animation| animation.name.as_deref());
            choose(document, "animation", "/animations", name, names).map(Some)
        }
        None if context.import.at.is_none() => Ok(None),
        None if animations.is_empty() => {
            context.warn(&document.at(""), ImportOptions::AT_REST);
            Ok(None)
        }
        None => Ok(Some(0)),
    }
}

/// The value of a channel of an animation at the requested time. `None`, with a warning, if it is not finite.
///
/// # Errors
/// If the channel has no sampler, or not the values of what is animated.
pub(super) fn channel_value(
    document: &Document,
    animation: usize,
    channel: usize,
    animated: Animated,
    context: &mut LoadContext<'_>,
) -> Result<Option<Vec<f64>>> {
    let pointer = format!("/animations/{animation}/channels/{channel}");
    let animated_by = &document.root.animations[animation];
    let index = animated_by.channels[channel].sampler;
    let sampler = document.one_of(&animated_by.samplers, index, "sampler", &format!("{pointer}/sampler"))?;
    let asked = format!("/animations/{animation}/samplers/{}", index.0);
    let value = sample(document, sampler, animated, context.import.at.unwrap_or(0.0), &asked)?;
    if value.is_none() {
        let message = "the channel's values are infinite or not numbers, and it is ignored";
        context.warn(&document.at(&pointer), message);
    }
    Ok(value)
}

/// The value of a sampler at a time; `None` if a component is not finite. `pointer` is the sampler's.
fn sample(
    document: &Document,
    sampler: &AnimationSampler,
    animated: Animated,
    time: f64,
    pointer: &str,
) -> Result<Option<Vec<f64>>> {
    let word = sampler.interpolation.as_deref().unwrap_or("LINEAR");
    let interpolation = Interpolation::of(word).ok_or_else(|| {
        document
            .invalid(&format!("{pointer}/interpolation"), format!("the interpolation {word:?} is not known"))
            .hint("LINEAR, STEP and CUBICSPLINE are possible")
    })?;
    let times = document.scalars(sampler.input, &format!("{pointer}/input"))?;
    let asked = format!("{pointer}/output");
    let values = match animated {
        Animated::Numbers(2) => document.vectors::<2>(sampler.output, &asked)?.into_flattened(),
        Animated::Numbers(3) => document.vectors::<3>(sampler.output, &asked)?.into_flattened(),
        Animated::Rotation | Animated::Numbers(4) => {
            document.vectors::<4>(sampler.output, &asked)?.into_flattened()
        }
        Animated::Numbers(9) => document.vectors::<9>(sampler.output, &asked)?.into_flattened(),
        Animated::Numbers(16) => document.vectors::<16>(sampler.output, &asked)?.into_flattened(),
        Animated::Numbers(_) | Animated::Weights => document.scalars(sampler.output, &asked)?,
    };
    let elements = times.len() * interpolation.elements();
    if elements == 0 {
        return Ok(None);
    }
    let width = match animated {
        Animated::Rotation => 4,
        Animated::Numbers(count) => count,
        Animated::Weights => values.len() / elements,
    };
    if values.len() != elements * width || width == 0 {
        let message = format!(
            "{} for {}: each has {word} values",
            crate::plural::counted(values.len(), "number"),
            crate::plural::counted(times.len(), "key")
        );
        return Err(document.invalid(&asked, message).hint("the file was written wrongly: export it again"));
    }
    let track = Track { times: &times, values: &values, width, interpolation };
    let numbers = match animated {
        Animated::Rotation => track.rotation(time).to_array().to_vec(),
        _ => track.vector(time),
    };
    Ok(numbers.iter().all(|number| number.is_finite()).then_some(numbers))
}
