//! Points of hits: where on a surface a ray has met it, and the normal there.
//!
//! A hit has ids; its primitive is found again by a descent through the boxes around the point, so that trees need no table of
//! their primitives.

use crate::bvh::{Bvh, Instance, Part};
use crate::exact::ExactRay;
use crate::item::Leaf;
use crate::node::{Child, Content};
use crate::origin::Point;
use crate::ray::{Hit, Ray};
use crate::sphere::Sphere;
use crate::vector::{dot, subtract, wide};

/// Relative error of the position along a ray at a t in f32, with a large margin: 2⁻²⁰.
const ROOM: f64 = 9.536_743_164_062_5e-7;

/// A point where a ray has hit a surface: made by [`Bvh::hit_point`].
///
/// Position and error bound are in the space of the tree that was asked, in its unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HitPoint {
    /// The position with the bound of its error.
    pub point: Point,
    /// The geometric normal, of unit length: of a triangle on the side that sees its corners counter-clockwise, of a sphere
    /// to the outside, whichever side was hit. In an instance it is that of the object, transformed as normals are: a mirror
    /// does not change the side.
    pub normal: [f64; 3],
}

impl HitPoint {
    /// An origin for a ray that leaves the surface in a direction, to whichever side: as [`Point::leave`].
    pub fn origin<D: Copy + Into<f64>>(&self, direction: [D; 3]) -> [f32; 3] {
        self.point.leave(self.normal, direction)
    }
}

/// A primitive with a known surface.
enum Primitive {
    Triangle([[f32; 3]; 3]),
    Sphere(Sphere),
}

impl Bvh {
    /// The point of `hit`, which is one of `ray` with this tree. `None` for a miss, and for procedural shapes, which do not
    /// define their surfaces. What moves is where it is at time 0: [`Query::hit_point`](crate::Query::hit_point) has a time.
    ///
    /// The position is on the surface up to its error bound: of a triangle at the hit's u and v, of a sphere (in an instance
    /// an ellipsoid) where the ray is at the hit's t.
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Builder, Hit, Ray, Sphere};
    /// use std::sync::Arc;
    /// let mut object = Builder::new();
    /// object.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let mut builder = Builder::new();
    /// builder.instance(Arc::new(object.build()?), Affine { translation: [0.0, 0.0, 5.0], ..Affine::IDENTITY });
    /// let bvh = builder.build()?;
    ///
    /// let ray = Ray::new([0.0; 3], [0.0, 0.0, 2.0]);
    /// let at = bvh.hit_point(&ray, &bvh.closest_hit(&ray)).unwrap();
    /// assert_eq!((at.point.position, at.normal), ([0.0, 0.0, 4.0], [0.0, 0.0, -1.0]));
    ///
    /// // A ray from there, back, does not hit the sphere again.
    /// let back = [0.1_f32, 0.0, -1.0];
    /// assert_eq!(bvh.closest_hit(&Ray::new(at.origin(back), back)), Hit::MISS);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn hit_point(&self, ray: &Ray, hit: &Hit) -> Option<HitPoint> {
        self.hit_point_at(ray, hit, 0.0)
    }

    /// [`Self::hit_point`] at a time.
    pub(crate) fn hit_point_at(&self, ray: &Ray, hit: &Hit, time: f32) -> Option<HitPoint> {
        let in_world =
            ExactRay { origin: wide(ray.origin), direction: wide(ray.direction), t_min: ray.t_min };
        let (point, normal) = match self.instances.get(hit.instance as usize) {
            None => self.point_in_place(&in_world, hit, time)?,
            Some(instance) => {
                let moved = match self.instance_map_at(hit.instance, time) {
                    Some(map) => &Instance::new(instance.bvh.clone(), map)?,
                    None => instance,
                };
                let in_object = moved.ray_in_object(&in_world);
                let (point, n) = moved.bvh.point_in_place(&in_object, hit, time)?;
                let columns = moved.object_from_world;
                let normal = [0, 1, 2].map(|axis| (0..3).map(|row| columns[row][axis] * n[row]).sum());
                (point.transformed(&moved.world_from_object), normal)
            }
        };
        let length = dot(normal, normal).sqrt();
        Some(HitPoint { point, normal: normal.map(|x| x / length) })
    }

    /// The point and a normal of any length, for a ray in the space of this tree, of a hit outside of instances.
    fn point_in_place(&self, ray: &ExactRay, hit: &Hit, time: f32) -> Option<(Point, [f64; 3])> {
        let way = ray.direction.map(|d| d * f64::from(hit.t));
        let position = [0, 1, 2].map(|axis| ray.origin[axis] + way[axis]);
        let size = ray.origin.iter().chain(&way).fold(0.0_f64, |most, x| most.max(x.abs()));
        let ids = (hit.geometry, hit.primitive);
        let primitive = self
            .primitive_near(position, ROOM * size, ids, time)
            // A triangle seen edge-on: its hit's t is less exact.
            .or_else(|| self.primitive_near(position, f64::INFINITY, ids, time))?;
        Some(match primitive {
            Primitive::Triangle([p0, p1, p2]) => Point::on_triangle_with_normal(p0, p1, p2, hit.u, hit.v),
            Primitive::Sphere(Sphere { center, radius }) => {
                let point = Point::on_sphere(center, radius, position);
                (point, subtract(point.position, wide(center)))
            }
        })
    }

    /// The primitive with these ids, if it is in boxes that are at most `room` from a position along each axis.
    fn primitive_near(&self, position: [f64; 3], room: f64, ids: (u32, u32), time: f32) -> Option<Primitive> {
        let standing = (!self.nodes.is_empty()).then_some(Part::Standing(self));
        let moving = self.moving.as_deref().filter(|moving| !moving.is_empty());
        let moving = moving.map(|moving| Part::Moving(moving, moving.moment(time)));
        standing.into_iter().chain(moving).find_map(|part| self.primitive_of(part, position, room, ids))
    }

    fn primitive_of(
        &self,
        part: Part<'_>,
        position: [f64; 3],
        room: f64,
        ids: (u32, u32),
    ) -> Option<Primitive> {
        let mut children = vec![Child::ROOT];
        while let Some(child) = children.pop() {
            match child.content() {
                Content::Node(number) => {
                    let node = part.node(number);
                    let near = node.children().filter(|(_, bounds, _)| {
                        (0..3).all(|axis| {
                            let [min, max] = [bounds.min, bounds.max].map(|side| f64::from(side[axis]));
                            min - room <= position[axis] && position[axis] <= max + room
                        })
                    });
                    children.extend(near.map(|(slot, ..)| node.child(slot)));
                }
                Content::Triangles(block) => {
                    let block = part.block(block);
                    if let Some(lane) = (0..block.count()).find(|&lane| block.ids(lane) == ids) {
                        return Some(Primitive::Triangle(block.corners(lane)));
                    }
                }
                Content::Leaf(leaf) => {
                    if let Leaf::Spheres { block } = part.leaf(leaf) {
                        let mut items = self.spheres[block as usize].items();
                        if let Some(item) = items.find(|item| (item.geometry, item.primitive) == ids) {
                            return Some(Primitive::Sphere(item.shape));
                        }
                    }
                }
            }
        }
        None
    }
}
