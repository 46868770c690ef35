//! A turntable: the camera's orbit around a scene, and a framing that fits at every angle.
//!
//! The axis goes through the point that the camera looks at, if the scene gives one, and else through the centre of the
//! visible subject: lights, backdrops and endless floors would move it away from the subject of the image.

use glam::{DMat4, DVec3};

use super::framing::Framing;
use super::surroundings::rotation;
use super::viewpoint::{target, up_of_camera};
use super::{Viewpoint, aspect, basis, bounds_of, corners, sane, visit_instance, visit_shape};
use crate::camera::{Camera, View};
use crate::material::MaterialKind;
use crate::scene::{Bounds, Instance, Object, Scene, SourceFormat};
use crate::shape::{Geometry, Shape};

/// The ratio of sizes above which a flat item counts as a backdrop or an endless floor: its radius over that of the bounds
/// of the other items.
const LARGEST_FLAT: f64 = 3.0;
/// The thickness of a flat mesh relative to its extent.
const FLAT: f64 = 1e-3;

/// A turntable: its axis and orientation.
#[derive(Clone, Debug)]
pub struct Turntable {
    /// A point on the axis.
    pivot: DVec3,
    /// Right, up (the direction of the axis) and towards the viewer: unit vectors.
    basis: [DVec3; 3],
}

impl Turntable {
    /// The turntable of a scene to which nothing has been added yet. The axis goes through `lookat`; if that is `None`,
    /// through the point that the scene's own camera looks at, or else through the centre of the visible subject. `up` is the
    /// axis' direction (of any length); if it is `None`, the camera's, or else y.
    pub fn new(scene: &Scene, up: Option<DVec3>, lookat: Option<DVec3>) -> Self {
        let target = target(scene);
        let up = up.or_else(|| up_of_camera(scene));
        let lookat = lookat.or(target.map(|target| target.lookat));
        let pivot = lookat.unwrap_or_else(|| sane(bounds(scene, &visible(scene))).center());
        Self { pivot, basis: basis(up.unwrap_or(DVec3::Y)) }
    }

    /// Adds a camera, if there is none, that shows the whole subject at every angle, at the same size, first from `viewpoint`.
    pub fn frame(&self, scene: &mut Scene, viewpoint: &Viewpoint) {
        if scene.camera.is_some() {
            return;
        }
        let mut framing = Framing::new(self.pivot, self.basis, aspect(scene), viewpoint);
        let items = visible(scene);
        let written = bounds(scene, &items);
        if sane(written) == written {
            items.iter().for_each(|item| item.visit(scene, &mut |point| framing.include_turning(point)));
        } else {
            corners(sane(written)).into_iter().for_each(|corner| framing.include_turning(corner));
        }
        scene.camera = Some(framing.camera());
    }

    /// The camera after an orbit around the axis by degrees, counter-clockwise as seen from above.
    pub fn turned(&self, camera: &Camera, degrees: f64) -> Camera {
        let orbit = DMat4::from_translation(self.pivot)
            * self.rotation(degrees)
            * DMat4::from_translation(-self.pivot);
        let view = match camera.view {
            View::Look { lookfrom, lookat, up } => View::Look {
                lookfrom: orbit.transform_point3(lookfrom),
                lookat: orbit.transform_point3(lookat),
                up: orbit.transform_vector3(up),
            },
            View::Matrix(matrix) => View::Matrix(orbit * matrix),
        };
        Camera { view, ..camera.clone() }
    }

    /// The rotation about the axis' direction by degrees, counter-clockwise as seen from above: environment maps are rotated
    /// by it along with the camera, as if everything else rotated the other way.
    pub fn rotation(&self, degrees: f64) -> DMat4 {
        rotation(self.basis[1], degrees)
    }
}

/// An item of the world.
#[derive(Clone, Copy)]
enum Item<'a> {
    Shape(&'a Shape),
    /// With the bounding box of the visible shapes of its object, in their space.
    Instance(&'a Instance, Bounds),
}

impl Item<'_> {
    fn visit(self, scene: &Scene, see: &mut dyn FnMut(DVec3)) {
        match self {
            Self::Shape(shape) => visit_shape(scene, shape, see),
            Self::Instance(instance, object) => visit_instance(instance, object, see),
        }
    }

    fn bounds(self, scene: &Scene) -> Bounds {
        match self {
            Self::Shape(shape) => shape.bounds(&scene.meshes),
            Self::Instance(instance, object) => object.transformed(&instance.world_from_object),
        }
    }

    /// Whether the item lies in a plane.
    fn is_flat(self, scene: &Scene) -> bool {
        match self {
            Self::Shape(shape) => match &shape.geometry {
                Geometry::Quad { .. } | Geometry::Disk { .. } | Geometry::PartialDisk { .. } => true,
                Geometry::Mesh(id) => {
                    let mesh = &scene.meshes[id.index()];
                    is_coplanar(|| {
                        mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize].as_dvec3())
                    })
                }
                Geometry::Bilinear(patches) => {
                    is_coplanar(|| patches.positions.iter().map(|position| position.as_dvec3()))
                }
                _ => false,
            },
            Self::Instance(_, Bounds { min, max }) => {
                (max - min).min_element() <= FLAT * (max - min).max_element()
            }
        }
    }
}

fn bounds(scene: &Scene, items: &[Item<'_>]) -> Bounds {
    items.iter().map(|item| item.bounds(scene)).fold(Bounds::EMPTY, Bounds::union)
}

/// The subject of the image. If nothing else is left, all items are.
fn visible(scene: &Scene) -> Vec<Item<'_>> {
    let shapes = scene.shapes.iter().map(Item::Shape);
    let of_object =
        |object: &Object| bounds_of(scene, object.shapes.iter().filter(|shape| !is_hidden(scene, shape)));
    let objects: Vec<Bounds> = scene.objects.iter().map(of_object).collect();
    let instances = scene.instances.iter().map(|one| Item::Instance(one, objects[one.object.index()]));
    let all: Vec<Item<'_>> = shapes.chain(instances).collect();
    let shown: Vec<Item<'_>> = all
        .iter()
        .copied()
        .filter(|item| match item {
            Item::Shape(shape) => !is_hidden(scene, shape),
            Item::Instance(..) => !item.bounds(scene).is_empty(),
        })
        .collect();
    if shown.is_empty() {
        return all;
    }
    let (surfaces, solids): (Vec<Item<'_>>, Vec<Item<'_>>) =
        shown.iter().partition(|item| item.is_flat(scene) || surrounds_the_eye(scene, item));
    if solids.is_empty() {
        return shown;
    }
    let largest = LARGEST_FLAT * bounds(scene, &solids).radius();
    let small = surfaces.into_iter().filter(|item| item.bounds(scene).radius() <= largest);
    solids.iter().copied().chain(small).collect()
}

/// Whether a shape is an area light or only a medium interface. In a model, emissive shapes are parts of it.
fn is_hidden(scene: &Scene, shape: &Shape) -> bool {
    let is_lamp = scene.source_format == SourceFormat::Scene && shape.emission.is_some();
    let material = scene.materials.get(shape.material.index());
    is_lamp || material.is_some_and(|material| matches!(material.kind, MaterialKind::Interface))
}

/// Whether an item is a sphere around the camera: a sky dome.
fn surrounds_the_eye(scene: &Scene, item: &Item<'_>) -> bool {
    let Item::Shape(Shape { geometry: Geometry::Sphere(_) | Geometry::PartialSphere { .. }, .. }) = item
    else {
        return false;
    };
    let eye = match scene.camera.as_ref().map(|camera| camera.view) {
        Some(View::Look { lookfrom, .. }) => lookfrom,
        Some(View::Matrix(matrix)) => matrix.w_axis.truncate(),
        None => return false,
    };
    let Bounds { min, max } = item.bounds(scene);
    eye.cmpgt(min).all() && eye.cmplt(max).all()
}

/// Whether points lie in a plane, relative to their extent.
fn is_coplanar<P: Iterator<Item = DVec3>>(points: impl Fn() -> P) -> bool {
    let farthest = |measure: &dyn Fn(DVec3) -> f64| {
        points().fold((0.0, DVec3::ZERO), |(most, at), point| {
            let value = measure(point);
            if value > most { (value, point) } else { (most, at) }
        })
    };
    let Some(first) = points().next() else { return true };
    let (extent, second) = farthest(&|point| point.distance(first));
    let axis = (second - first).normalize_or_zero();
    let (_, third) = farthest(&|point| (point - first).cross(axis).length());
    let normal = (third - first).cross(axis).normalize_or_zero();
    farthest(&|point| (point - first).dot(normal).abs()).0 <= FLAT * extent
}

#[cfg(test)]
mod tests;
