//! Node transforms and morph weights at one time of an animation, or at rest (specification, §3.11).

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3, DVec4};

use super::animation::{Animated, channel_value};
use super::file::Document;
use super::json::Node;
use super::node::{affine, placed};
use crate::error::Result;
use crate::files::LoadContext;

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

/// The pose at the time of [`LoadContext::import`], by the animation with this index if there is one.
///
/// # Errors
/// If an object that the animation refers to does not exist.
pub(crate) fn pose(
    document: &Document,
    animation: Option<usize>,
    context: &mut LoadContext<'_>,
) -> Result<Pose> {
    let nodes = &document.root.nodes;
    let mut pose = Pose {
        local: nodes.iter().map(|node| affine(&node.at_rest())).collect(),
        weights: nodes
            .iter()
            .enumerate()
            .filter_map(|(index, node)| Some((index, node.weights.as_deref()?.to_vec())))
            .collect(),
    };
    if let Some(animation) = animation {
        animate(document, animation, &mut pose, context)?;
    }
    Ok(pose)
}

fn animate(document: &Document, index: usize, pose: &mut Pose, context: &mut LoadContext<'_>) -> Result<()> {
    let root = &document.root;
    let animation = &root.animations[index];
    let mut placements: BTreeMap<usize, Placement> = BTreeMap::new();
    for (place, channel) in animation.channels.iter().enumerate() {
        let pointer = format!("/animations/{index}/channels/{place}");
        let Some(target) = channel.target.node else {
            if channel.target.extensions.pointer.is_none() {
                context.warn(&document.at(&pointer), "the channel moves no node and is ignored");
            }
            continue;
        };
        let node = document.one_of(&root.nodes, target, "node", &format!("{pointer}/target/node"))?;
        let target = target.index();
        let animated = match channel.target.path.as_str() {
            "translation" | "scale" => Animated::Numbers(3),
            "rotation" => Animated::Rotation,
            "weights" => Animated::Weights,
            path => {
                let message = format!("the channel moves {path:?}, which is not known, and is ignored");
                context.warn(&document.at(&pointer), message);
                continue;
            }
        };
        let Some(numbers) = channel_value(document, index, place, animated, context)? else { continue };
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
