//! Node transforms and morph weights at one time of an animation, or at rest (specification, §3.11).
//!
//! [`LoadContext::import`] selects the animation and the time. Channels of extensions (`KHR_animation_pointer`) are
//! ignored with a warning.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3, DVec4};

use super::choose::choose;
use super::file::Document;
use super::json::{AnimationSampler, Node, Whole};
use super::node::{affine, placed};
use super::track::{Interpolation, Track};
use crate::error::Result;
use crate::files::{ImportOptions, LoadContext};

/// The pose of all nodes.
pub(crate) struct Pose {
    /// Transform of each node relative to its parent.
    pub(crate) local: Vec<DAffine3>,
    /// Morph target weights of each node, where the node or the animation gives any.
    pub(crate) weights: BTreeMap<usize, Vec<f64>>,
}

/// The local transform of a node: translation, rotation and scale.
#[derive(Clone, Copy)]
struct Placement {
    translation: DVec3,
    /// x, y, z, w.
    rotation: DVec4,
    scale: DVec3,
}

impl Placement {
    fn at_rest(node: &Node) -> Self {
        if node.matrix.is_some() {
            // Only nodes without a matrix are animated by the specification; others are decomposed where possible.
            let matrix = node.at_rest();
            if matrix.determinant().is_normal() && matrix.is_finite() {
                let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
                return Self { translation, rotation: rotation.into(), scale };
            }
        }
        Self { translation: node.translation(), rotation: node.rotation(), scale: node.scale() }
    }
}

/// The requested pose.
///
/// # Errors
/// If there is no such animation, or an object that it refers to does not exist.
pub(crate) fn pose(document: &Document, context: &mut LoadContext<'_>) -> Result<Pose> {
    let nodes = &document.root.nodes;
    let mut pose = Pose {
        local: nodes.iter().map(|node| affine(&node.at_rest())).collect(),
        weights: nodes
            .iter()
            .enumerate()
            .filter_map(|(index, node)| Some((index, node.weights.as_deref()?.to_vec())))
            .collect(),
    };
    if let Some(animation) = chosen(document, context)? {
        animate(document, animation, &mut pose, context)?;
    }
    Ok(pose)
}

/// The index of the requested animation.
fn chosen(document: &Document, context: &mut LoadContext<'_>) -> Result<Option<usize>> {
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

fn animate(document: &Document, index: usize, pose: &mut Pose, context: &mut LoadContext<'_>) -> Result<()> {
    let root = &document.root;
    let animation = &root.animations[index];
    let time = context.import.at.unwrap_or(0.0);
    let mut placements: BTreeMap<usize, Placement> = BTreeMap::new();
    for (place, channel) in animation.channels.iter().enumerate() {
        let pointer = format!("/animations/{index}/channels/{place}");
        let sampler = document.one_of(
            &animation.samplers,
            channel.sampler,
            "sampler",
            &format!("{pointer}/sampler"),
        )?;
        let asked = format!("/animations/{index}/samplers/{}", channel.sampler.0);
        let Some(target) = channel.target.node else {
            // `KHR_animation_pointer` may have many channels; the extension as a whole has one warning already.
            if channel.target.path != "pointer" {
                context.warn(&document.at(&pointer), "the channel moves no node and is ignored");
            }
            continue;
        };
        let node = document.one_of(&root.nodes, target, "node", &format!("{pointer}/target/node"))?;
        let target = target.index();
        let width = match channel.target.path.as_str() {
            "translation" | "scale" => Some(3),
            "rotation" => Some(4),
            "weights" => None,
            path => {
                let message = format!("the channel moves {path:?}, which is not known, and is ignored");
                context.warn(&document.at(&pointer), message);
                continue;
            }
        };
        let Some(numbers) = sample(document, sampler, width, time, &asked)? else {
            context.warn(
                &document.at(&pointer),
                "the channel's values are infinite or not numbers, and it is ignored",
            );
            continue;
        };
        let placement = placements.get(&target).copied().unwrap_or_else(|| Placement::at_rest(node));
        match (channel.target.path.as_str(), numbers.as_slice()) {
            ("translation", &[x, y, z]) => {
                placements.insert(target, Placement { translation: DVec3::new(x, y, z), ..placement });
            }
            ("scale", &[x, y, z]) => {
                placements.insert(target, Placement { scale: DVec3::new(x, y, z), ..placement });
            }
            ("rotation", &[x, y, z, w]) => {
                placements.insert(target, Placement { rotation: DVec4::new(x, y, z, w), ..placement });
            }
            _ => {
                pose.weights.insert(target, numbers);
            }
        }
    }
    for (node, Placement { translation, rotation, scale }) in placements {
        pose.local[node] = affine(&placed(translation, rotation, scale));
    }
    Ok(())
}

/// The value of a sampler with this number of components; `None` stands for one per morph target. The result is `None` if
/// a component is not finite.
fn sample(
    document: &Document,
    sampler: &AnimationSampler,
    width: Option<usize>,
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
    let flat = |output: Whole| match width {
        Some(3) => Ok(document.vectors::<3>(output, &asked)?.into_flattened()),
        Some(_) => Ok(document.vectors::<4>(output, &asked)?.into_flattened()),
        None => document.scalars(output, &asked),
    };
    let values = flat(sampler.output)?;
    let elements = times.len() * interpolation.elements();
    if elements == 0 {
        return Ok(None);
    }
    let is_rotation = width == Some(4);
    let width = width.unwrap_or(values.len() / elements);
    if values.len() != elements * width || width == 0 {
        let message = format!(
            "{} for {}: each has {word} values",
            crate::plural::counted(values.len(), "number"),
            crate::plural::counted(times.len(), "key")
        );
        return Err(document.invalid(&asked, message).hint("the file was written wrongly: export it again"));
    }
    let track = Track { times: &times, values: &values, width, interpolation };
    let numbers = if is_rotation { track.rotation(time).to_array().to_vec() } else { track.vector(time) };
    Ok(numbers.iter().all(|number| number.is_finite()).then_some(numbers))
}
