//! Selection of the camera, and its projection (specification, §3.10).
//!
//! Near and far planes cut nothing off: rays need none.

use glam::{DMat4, DVec3, DVec4};

use super::choose::choose;
use super::file::Document;
use super::json;
use super::node::Tree;
use crate::camera::{Camera, Projection, View};
use crate::contents::CameraEntry;
use crate::error::Result;
use crate::files::{CameraChoice, LoadContext};

/// A camera of the file, and width over height of the picture that it is meant for, where it says so.
pub(super) struct Eye {
    pub(super) camera: Camera,
    pub(super) aspect: Option<f64>,
}

/// The cameras of the scene.
pub(super) struct Cameras<'d> {
    document: &'d Document,
    /// The node and the number of each.
    placed: Vec<(usize, usize)>,
}

impl<'d> Cameras<'d> {
    /// Those of the nodes that are shown.
    ///
    /// # Errors
    /// If a node names a camera that does not exist.
    pub(super) fn new(document: &'d Document, tree: &Tree) -> Result<Self> {
        let mut placed = Vec::new();
        for &node in &tree.shown {
            if let Some(index) = document.root.nodes[node].camera {
                let asked = format!("/nodes/{node}/camera");
                document.one_of(&document.root.cameras, index, "camera", &asked)?;
                placed.push((node, index.index()));
            }
        }
        Ok(Self { document, placed })
    }

    /// Their names and projections.
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

    /// The requested camera, or else the first.
    ///
    /// # Errors
    /// If the one that is requested does not exist.
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

/// The requested camera, or else the first of the scene.
///
/// # Errors
/// If the one that is requested does not exist, or none of its numbers can be.
pub(super) fn eye(cameras: &Cameras<'_>, tree: &Tree, context: &mut LoadContext<'_>) -> Result<Option<Eye>> {
    let document = cameras.document;
    let chosen = cameras.chosen(&context.import.camera)?;
    let Some((node, index)) = chosen else { return Ok(None) };
    let pointer = format!("/cameras/{index}");
    let at = document.at(&pointer);
    let Some((projection, aspect)) = projection(&document.root.cameras[index]) else {
        context.warn(&at, "the camera's numbers cannot be; the scene is framed without it");
        return Ok(None);
    };
    let Some(matrix) = world_from_camera(&tree.world_from_node[node]) else {
        context.warn(&at, "the camera's node has no size; the scene is framed without it");
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

/// A glTF camera has x to the right and looks along −z, ours has x to the left and looks along z. Scales of nodes do not
/// count for cameras.
fn world_from_camera(world_from_node: &DMat4) -> Option<DMat4> {
    let axis = |column: DVec4| column.truncate().try_normalize();
    let (x, y, z) =
        (axis(world_from_node.x_axis)?, axis(world_from_node.y_axis)?, axis(world_from_node.z_axis)?);
    let position: DVec3 = world_from_node.w_axis.truncate();
    let matrix = DMat4::from_cols((-x).extend(0.0), y.extend(0.0), (-z).extend(0.0), position.extend(1.0));
    (matrix.is_finite() && matrix.determinant().abs() > 1e-9).then_some(matrix)
}
