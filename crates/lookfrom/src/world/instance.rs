//! Instances of objects in their places, at a time of the shutter.

use glam::{DMat4, DVec3};
use lookfrom_bvh::{Affine, Point};

use super::World;
use crate::core::math;
use crate::core::points::{Points, StoredPlacement, amplification};
use crate::primitive::SurfacePoint;

/// An instance of an object: what the kernel does not know of it. There may be millions.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    /// Index into the world's objects.
    pub(crate) object: u32,
    /// Replaces the materials of the object.
    pub(crate) material: Option<u32>,
    /// Whether it moves, or something in its object does.
    pub(crate) moves: bool,
    /// From render space to the object's; of an instance that moves when the shutter opens.
    object_from_render: Affine,
    /// The amplification of errors by both maps.
    amplification: [[f64; 3]; 3],
}

/// An instance in its place, at a time.
#[derive(Clone, Copy, Debug)]
pub struct PlacedInstance<'a> {
    pub(crate) instance: &'a Instance,
    render_from_object: Affine,
    object_from_render: Affine,
    amplification: [[f64; 3]; 3],
}

impl World {
    /// An instance, by the kernel's id, at a time.
    pub(crate) fn instance(&self, id: u32, time: f32) -> PlacedInstance<'_> {
        let instance = &self.instances[id as usize];
        match self.bvh.instance_map_at(id, time) {
            None => {
                let Instance { object_from_render, amplification, .. } = *instance;
                let render_from_object = *self.bvh.instance_map(id);
                PlacedInstance { instance, render_from_object, object_from_render, amplification }
            }
            Some(render_from_object) => {
                let object_from_render = inverse(&render_from_object);
                let amplification = amplification(&render_from_object);
                PlacedInstance { instance, render_from_object, object_from_render, amplification }
            }
        }
    }

    /// The placement of an instance that stands still.
    #[inline]
    pub(super) fn standing_placement(&self, id: u32) -> StoredPlacement<'_> {
        let Instance { object_from_render, amplification, .. } = &self.instances[id as usize];
        let affine = self.bvh.instance_map(id);
        StoredPlacement { affine, inverse: &object_from_render.matrix, amplification }
    }
}

impl Instance {
    /// An instance with a map from the object's space to render space.
    pub(super) fn new(object: u32, material: Option<u32>, render_from_object: &Affine, moves: bool) -> Self {
        let object_from_render = inverse(render_from_object);
        Self { object, material, moves, object_from_render, amplification: amplification(render_from_object) }
    }
}

fn inverse(map: &Affine) -> Affine {
    math::affine(&math::matrix(map).inverse())
}

impl PlacedInstance<'_> {
    /// From the object's space to render space.
    pub fn render_from_object(&self) -> DMat4 {
        math::matrix(&self.render_from_object)
    }

    /// The inverse.
    pub fn object_from_render(&self) -> DMat4 {
        math::matrix(&self.object_from_render)
    }

    /// A ray's origin and direction in the object's space; its t stays the same.
    pub fn in_object(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        let to_object = self.object_from_render();
        (to_object.transform_point3(origin), to_object.transform_vector3(direction))
    }

    /// A surface point of the object, in render space.
    pub(super) fn place(&self, of_object: SurfacePoint) -> SurfacePoint {
        let stored = StoredPlacement {
            affine: &self.render_from_object,
            inverse: &self.object_from_render.matrix,
            amplification: &self.amplification,
        };
        let placement = stored.placement();
        let vector = |v: DVec3| placement.vector(v.into()).into();
        let normal = |n: DVec3| placement.normal(n.into()).normalize().into();
        let mut binding = of_object.binding;
        binding.material = self.instance.material.unwrap_or(binding.material);
        let Point { position, error } = of_object.point;
        let points = Points { position: position.into(), error: error.into() }.placed(&placement);
        SurfacePoint {
            point: Point { position: points.position.into(), error: points.error.into() },
            ng: normal(of_object.ng),
            ns: normal(of_object.ns),
            dpdu: vector(of_object.dpdu),
            dpdv: vector(of_object.dpdv),
            shading_dpdu: vector(of_object.shading_dpdu),
            shading_dpdv: vector(of_object.shading_dpdv),
            lift: vector(of_object.lift),
            binding,
            ..of_object
        }
    }
}
