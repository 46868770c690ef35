//! Selection of the camera, and its projection (specification, §3.10).
//!
//! Near and far planes are ignored: rays need no clipping.

use glam::{DMat4, DVec3, DVec4};

use super::choose::choose;
use super::file::Document;
use super::json;
use super::node::Tree;
use crate::camera::{Camera, Projection, View};
use crate::contents::CameraEntry;
use crate::error::Result;
use crate::files::{CameraChoice, LoadContext};

/// A camera of the file, and the aspect ratio (width over height) that it is meant for, where the file gives one.
pub(super) struct Eye {
    pub(super) camera: Camera,
    pub(super) aspect: Option<f64>,
}

/// The cameras of the scene.
pub(super) struct Cameras<'d> {
    document: &'d Document,
    /// Indices of the node and of the camera, for each.
    placed: Vec<(usize, usize)>,
}

impl<'d> Cameras<'d> {
    /// The cameras of the visible nodes.
    ///
    /// # Errors
    /// If a node names a camera that does not exist.
    pub(super) fn new(document: &'d Document, tree: &Tree) -> Result<Self> {
        let mut placed = Vec::new();
        for &node in &tree.shown {
            if let Some(index) = document.root.nodes[node].camera.as_deref().copied() {
                let asked = format!("/nodes/{node}/camera");
                document.one_of(&document.root.cameras, index, "camera", &asked)?;
                placed.push((node, index.index()));
            }
        }
        Ok(Self { document, placed })
    }

    /// Names and projections of the cameras.
    pub(super) fn entries(&self) -> Vec<CameraEntry> {
        let entry = |&(node, index): &(usize, usize)| {
            let camera = &self.document.root.cameras[index];
            let name = self.document.root.nodes[node].name.as_ref().or(camera.name.as_ref());
            CameraEntry {
                name: name.cloned(),
                projection: projection(camera).map(|(projection, _)| projection),
            }
        };
        self.placed.iter().map(entry).collect()
    }

    /// The requested camera, or else the first one.
    ///
    /// # Errors
    /// If the requested camera does not exist.
    fn chosen(&self, choice: &CameraChoice) -> Result<Option<(usize, usize)>> {
        let root = &self.document.root;
        Ok(match choice {
            CameraChoice::Named(name) => {
                let names = self.placed.iter().map(|&(node, index)| {
                    let own = root.cameras[index].name.as_deref();
                    own.filter(|own| own == name).or(root.nodes[node].name.as_deref()).or(own)
                });
                let chosen = choose(self.document, "camera in the scene", "/cameras", name, names)?;
                Some(self.placed[chosen])
            }
            CameraChoice::First => self.placed.first().copied(),
            CameraChoice::None => None,
        })
    }
}

/// The requested camera, or else the first one of the scene; `None`, with a warning, if its values are invalid.
///
/// # Errors
/// If the requested camera does not exist.
pub(super) fn eye(cameras: &Cameras<'_>, tree: &Tree, context: &mut LoadContext<'_>) -> Result<Option<Eye>> {
    let document = cameras.document;
    let chosen = cameras.chosen(&context.import.camera)?;
    let Some((node, index)) = chosen else { return Ok(None) };
    let pointer = format!("/cameras/{index}");
    let at = document.at(&pointer);
    let Some((projection, aspect)) = projection(&document.root.cameras[index]) else {
        context.warn(&at, "the camera's values are invalid; the scene is framed without it");
        return Ok(None);
    };
    let Some(matrix) = world_from_camera(&tree.world_from_node(node)) else {
        context.warn(&at, "the camera's node has a degenerate transform; the scene is framed without it");
        return Ok(None);
    };
    let camera = Camera { at, view: View::Matrix(matrix), projection, ..Camera::default() };
    Ok(Some(Eye { camera, aspect }))
}

fn projection(camera: &json::Camera) -> Option<(Projection, Option<f64>)> {
    if let Some(perspective) = &camera.perspective {
        let fov = perspective.yfov.to_degrees();
        let aspect = perspective.aspect_ratio.filter(|&aspect| aspect > 0.0);
        return (fov > 0.0 && fov < 180.0).then_some((Projection::Perspective { fov }, aspect));
    }
    let orthographic = camera.orthographic.as_ref()?;
    let (x, y) = (orthographic.xmag.abs(), orthographic.ymag.abs());
    (x > 0.0 && y > 0.0).then_some((Projection::Orthographic { height: 2.0 * y }, Some(x / y)))
}

/// The camera's orthonormal frame. A glTF camera has x to the right and looks along −z, ours has x to the left and looks
/// along z. Scales of nodes do not affect cameras.
fn world_from_camera(world_from_node: &DMat4) -> Option<DMat4> {
    let axis = |column: DVec4| column.truncate().try_normalize();
    let (x, y, z) =
        (axis(world_from_node.x_axis)?, axis(world_from_node.y_axis)?, axis(world_from_node.z_axis)?);
    let position: DVec3 = world_from_node.w_axis.truncate();
    let matrix = DMat4::from_cols((-x).extend(0.0), y.extend(0.0), (-z).extend(0.0), position.extend(1.0));
    (matrix.is_finite() && matrix.determinant().abs() > 1e-9).then_some(matrix)
}
