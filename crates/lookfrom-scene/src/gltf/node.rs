//! Node hierarchy and world transforms (specification, §3.5).

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};

use super::choose::choose;
use super::file::Document;
use super::json::Node;
use crate::error::Result;
use crate::files::LoadContext;

/// The hierarchy of a file's nodes.
pub(crate) struct Tree {
    /// The world transform of each node, including unreachable ones: without the last row, which is that of all.
    world_from_node: Vec<DAffine3>,
    /// The nodes of the scene, parents before their children.
    pub(crate) shown: Vec<usize>,
    /// The index of the scene, if the file has any.
    pub(crate) scene: Option<usize>,
}

impl Node {
    /// The local transform at rest.
    pub(crate) fn at_rest(&self) -> DMat4 {
        if let Some(matrix) = &self.matrix {
            let mut matrix = DMat4::from_cols_array(matrix);
            // The last row of an affine transform.
            for (axis, w) in [(0, 0.0), (1, 0.0), (2, 0.0), (3, 1.0)] {
                matrix.col_mut(axis).w = w;
            }
            return matrix;
        }
        placed(self.translation(), self.rotation(), self.scale())
    }

    pub(crate) fn translation(&self) -> DVec3 {
        self.translation.as_deref().copied().map_or(DVec3::ZERO, DVec3::from_array)
    }

    /// x, y, z, w.
    pub(crate) fn rotation(&self) -> DVec4 {
        self.rotation.as_deref().copied().map_or(DVec4::W, DVec4::from_array)
    }

    pub(crate) fn scale(&self) -> DVec3 {
        self.scale.as_deref().copied().map_or(DVec3::ONE, DVec3::from_array)
    }
}

/// Scale, then rotation by a quaternion of any non-zero length, then translation.
pub(crate) fn placed(translation: DVec3, rotation: DVec4, scale: DVec3) -> DMat4 {
    let rotation = DQuat::from_vec4(rotation.normalize_or(DVec4::W));
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}

/// Whether all values of a transform are finite in single precision.
fn is_within_reach(matrix: &DMat4) -> bool {
    matrix.to_cols_array().iter().all(|&number| (number as f32).is_finite())
}

/// A transform without its last row, which is 0, 0, 0, 1.
pub(crate) fn affine(matrix: &DMat4) -> DAffine3 {
    let [x, y, z, w] = [matrix.x_axis, matrix.y_axis, matrix.z_axis, matrix.w_axis].map(DVec4::truncate);
    DAffine3::from_cols(x, y, z, w)
}

impl Tree {
    /// The world transform of a node.
    ///
    /// # Panics
    /// If there is no such node.
    pub(crate) fn world_from_node(&self, node: usize) -> DMat4 {
        self.world_from_node[node].into()
    }

    /// The hierarchy of the nodes, with one local transform for each.
    ///
    /// # Errors
    /// If a node is its own ancestor, or if a child, a node of the scene or the requested scene does not exist.
    pub(crate) fn new(
        document: &Document,
        local: Vec<DAffine3>,
        context: &mut LoadContext<'_>,
    ) -> Result<Self> {
        let nodes = &document.root.nodes;
        let mut parents: Vec<Option<u32>> = vec![None; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            for (place, &child) in node.children.iter().enumerate() {
                let pointer = || format!("/nodes/{index}/children/{place}");
                let slot = parents.get_mut(child.index());
                match slot {
                    Some(parent @ None) => *parent = Some(index as u32),
                    Some(Some(first)) => {
                        let message =
                            format!("node {} is already a child of node {first}, and stays there", child.0);
                        context.warn(&document.at(&pointer()), message);
                    }
                    None => {
                        document.one_of(nodes, child, "node", &pointer())?;
                    }
                }
            }
        }

        // Top-down from the roots; nodes that are not reached form cycles.
        let is_child =
            |parent: usize, child: usize| parents.get(child).is_some_and(|&p| p == Some(parent as u32));
        let mut world_from_node = local;
        let mut is_met = vec![false; nodes.len()];
        let mut waiting: Vec<usize> = (0..nodes.len()).filter(|&node| parents[node].is_none()).collect();
        while let Some(node) = waiting.pop() {
            is_met[node] = true;
            let parent =
                parents[node].map_or(DMat4::IDENTITY, |parent| world_from_node[parent as usize].into());
            world_from_node[node] = affine(&(parent * DMat4::from(world_from_node[node])));
            let children = nodes[node].children.iter().map(|child| child.index());
            waiting.extend(children.filter(|&child| is_child(node, child) && !is_met[child]));
        }
        if let Some(node) = is_met.iter().position(|is_met| !is_met) {
            return Err(document
                .invalid(&format!("/nodes/{node}"), "this node is its own ancestor")
                .hint("take it out of the children of one of its descendants"));
        }

        // The nodes of the scene.
        let (scene, mut waiting) = Self::roots(document, &parents, context)?;
        waiting.reverse();
        let mut shown = Vec::new();
        let mut is_shown = vec![false; nodes.len()];
        while let Some(node) = waiting.pop() {
            if nodes[node].is_visible() && !std::mem::replace(&mut is_shown[node], true) {
                if is_within_reach(&world_from_node[node].into()) {
                    shown.push(node);
                } else {
                    let message =
                        "the node is too far away or too large to be computed with, and is left out";
                    context.warn(&document.at(&format!("/nodes/{node}")), message);
                }
                let children = nodes[node].children.iter().rev().map(|child| child.index());
                waiting.extend(children.filter(|&child| is_child(node, child)));
            }
        }
        Ok(Self { world_from_node, shown, scene })
    }

    /// The index of the scene and its root nodes; all nodes without a parent if the file has no scene.
    fn roots(
        document: &Document,
        parents: &[Option<u32>],
        context: &LoadContext<'_>,
    ) -> Result<(Option<usize>, Vec<usize>)> {
        let root = &document.root;
        let scene = match (&context.import.scene, root.scene) {
            (Some(name), _) => {
                let names = root.scenes.iter().map(|scene| scene.name.as_deref());
                choose(document, "scene", "/scenes", name, names)?
            }
            (None, Some(index)) => {
                document.one_of(&root.scenes, index, "scene", "/scene")?;
                index.index()
            }
            (None, None) if root.scenes.is_empty() => {
                return Ok((None, (0..parents.len()).filter(|&node| parents[node].is_none()).collect()));
            }
            (None, None) => 0,
        };
        let mut roots = Vec::new();
        for (place, &node) in root.scenes[scene].nodes.iter().enumerate() {
            document.one_of(&root.nodes, node, "node", &format!("/scenes/{scene}/nodes/{place}"))?;
            roots.push(node.index());
        }
        Ok((Some(scene), roots))
    }
}
