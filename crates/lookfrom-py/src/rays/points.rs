//! The points and normals of hits, from their ids and weights.

use super::chunk::WorldRay;
use super::closest::weighted;
use super::frame::{cross, dot, largest, subtract, times, to_unit};
use super::geometry::Primitive;
use super::refine::FineHit;
use super::tree::Tree;

impl Tree {
    /// The point of a hit, and the unit normal there: to the side from which a triangle's corners are seen counter-clockwise,
    /// out of a sphere. NaN for a triangle without area.
    pub(super) fn point_and_normal(&self, hit: &FineHit, ray: &WorldRay) -> ([f64; 3], [f64; 3]) {
        let (place, instance) = self.place(hit.instance);
        let ray = match instance {
            None => *ray,
            Some(instance) => WorldRay {
                origin: instance.object_from_world.point(ray.origin),
                direction: instance.object_from_world.vector(ray.direction),
            },
        };
        let (point, normal) = match place.primitive(hit.geometry, hit.primitive) {
            Primitive::Triangle(corners) => {
                let [a, b, c] = corners.map(|p| times(p, place.frame.scale));
                (weighted(&corners, hit.u, hit.v), cross(subtract(b, a), subtract(c, a)))
            }
            Primitive::Sphere { center, radius } => {
                let p = [0, 1, 2].map(|axis| ray.origin[axis] + hit.t * ray.direction[axis]);
                let out = unit(subtract(p, center));
                ([0, 1, 2].map(|axis| center[axis] + radius * out[axis]), out)
            }
        };
        match instance {
            None => (point, unit(normal)),
            Some(instance) => (
                instance.world_from_object.point(point),
                unit(instance.object_from_world.normal_back(normal)),
            ),
        }
    }
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let v = times(v, to_unit(largest(v)));
    times(v, 1.0 / dot(v, v).sqrt())
}
