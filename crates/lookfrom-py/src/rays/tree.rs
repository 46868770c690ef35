//! A tree with its geometry in f64: building, refitting, and finding primitives again.

use std::sync::{Arc, OnceLock};

use lookfrom_bvh::{
    Affine, BuildError, Builder, Bvh, Faces, Hit, Moved, NONE, Quality, Query, Sphere, Triangles,
};

use super::frame::{Bounds, Frame};
use super::geometry::{Geometry, Instance, Masks, Part, Primitive};
use super::inside::Boundary;
use super::refine::FineHit;

/// A tree. Immutable but for [`Self::refit`].
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) parts: Vec<Part>,
    pub(super) instances: Vec<Instance>,
    pub(super) frame: Frame,
    pub(super) bvh: Arc<Bvh>,
    quality: Quality,
    bounds: Bounds,
    /// Found when it is first asked for.
    pub(super) boundary: OnceLock<Boundary>,
}

/// The part of a tree that rays see.
#[derive(Clone, Copy, Debug)]
pub(super) struct Selection {
    pub(super) mask: Option<u32>,
    pub(super) faces: Faces,
}

impl Selection {
    pub(super) fn of<'a>(&self, bvh: &'a Bvh) -> Query<'a> {
        let query = bvh.query().faces(self.faces);
        match self.mask {
            Some(mask) => query.mask(mask),
            None => query,
        }
    }
}

impl Tree {
    /// Builds a tree, by rayon.
    ///
    /// # Errors
    /// Too many primitives, instances of trees that hold instances, maps without an inverse.
    pub(super) fn build(
        parts: Vec<Part>,
        instances: Vec<Instance>,
        quality: Quality,
    ) -> Result<Self, BuildError> {
        let bounds = bounds_of(&parts, &instances);
        let frame = Frame::around(&bounds);
        let mut builder = Builder::new();
        builder.quality(quality);
        for part in &parts {
            let number = match &part.geometry {
                Geometry::Triangles { vertices, faces } => builder
                    .triangles(Triangles { positions: &rounded_vertices(vertices, &frame), indices: faces }),
                Geometry::Spheres { centers, radii } => {
                    builder.spheres(&rounded_spheres(centers, radii, &frame))
                }
            };
            match &part.masks {
                Masks::Everyone => {}
                Masks::OfAll(mask) => _ = builder.geometry_mask(number, *mask),
                Masks::OfEach(masks) => _ = builder.primitive_masks(number, masks),
            }
        }
        for instance in &instances {
            let number = builder.instance(instance.tree.bvh.clone(), map_of_frames(instance, &frame));
            if let Some(mask) = instance.mask {
                builder.instance_mask(number, mask);
            }
        }
        let bvh = Arc::new(builder.build()?);
        Ok(Self { parts, instances, frame, bvh, quality, bounds, boundary: OnceLock::new() })
    }

    /// The box around everything; `None` if there is nothing.
    pub(super) fn bounds(&self) -> Option<&Bounds> {
        (!self.bounds.is_empty()).then_some(&self.bounds)
    }

    /// The tree after one of its geometries has moved. It is refitted, or built anew: where another tree shares it, where the
    /// frame no longer fits, and where triangles have lost or gained their area.
    ///
    /// # Errors
    /// As for [`Self::build`].
    pub(super) fn refit(self: &mut Arc<Self>, number: usize, moved: Geometry) -> Result<(), BuildError> {
        if let Some(tree) = Arc::get_mut(self)
            && let Some(bvh) = Arc::get_mut(&mut tree.bvh)
        {
            tree.parts[number].geometry = moved;
            let bounds = bounds_of(&tree.parts, &tree.instances);
            if tree.frame.still_fits(&bounds) {
                let frame = &tree.frame;
                let refitted = match &tree.parts[number].geometry {
                    Geometry::Triangles { vertices, faces } => {
                        let positions = rounded_vertices(vertices, frame);
                        let triangles = Triangles { positions: &positions, indices: faces };
                        bvh.refit(&[(number as u32, Moved::Triangles(triangles))])
                    }
                    Geometry::Spheres { centers, radii } => {
                        let spheres = rounded_spheres(centers, radii, frame);
                        bvh.refit(&[(number as u32, Moved::Spheres(&spheres))])
                    }
                };
                if refitted.is_ok() {
                    tree.bounds = bounds;
                    tree.boundary = OnceLock::new();
                    return Ok(());
                }
            }
            *self = Arc::new(Self::build(
                std::mem::take(&mut tree.parts),
                std::mem::take(&mut tree.instances),
                tree.quality,
            )?);
            return Ok(());
        }
        let mut parts = self.parts.clone();
        parts[number].geometry = moved;
        *self = Arc::new(Self::build(parts, self.instances.clone(), self.quality)?);
        Ok(())
    }

    /// The instance that a hit names, if it names one, and the tree that its geometry is in.
    #[inline]
    pub(super) fn place(&self, instance: u32) -> (&Self, Option<&Instance>) {
        match instance {
            NONE => (self, None),
            _ => {
                let instance = &self.instances[instance as usize];
                (&instance.tree, Some(instance))
            }
        }
    }

    #[inline]
    pub(super) fn primitive(&self, geometry: u32, primitive: u32) -> Primitive {
        self.parts[geometry as usize].geometry.primitive(primitive as usize)
    }

    /// Fetches what [`Self::fetch_vertices`] needs to the cache: to be called some time before it.
    #[inline]
    pub(super) fn fetch_face(&self, hit: &Hit) {
        if hit.is_hit() {
            let (place, _) = self.place(hit.instance);
            place.parts[hit.geometry as usize].geometry.fetch_face(hit.primitive as usize);
        }
    }

    /// Fetches a hit's primitive to the cache: to be called some time before it is needed.
    #[inline]
    pub(super) fn fetch_vertices(&self, hit: &Hit) {
        if hit.is_hit() {
            let (place, _) = self.place(hit.instance);
            place.parts[hit.geometry as usize].geometry.fetch_vertices(hit.primitive as usize);
        }
    }

    /// True if it has a primitive of these ids.
    pub(super) fn has(&self, hit: &FineHit) -> bool {
        let place = match hit.instance {
            NONE => Some(self),
            instance => self.instances.get(instance as usize).map(|instance| &*instance.tree),
        };
        place
            .and_then(|place| place.parts.get(hit.geometry as usize))
            .is_some_and(|part| (hit.primitive as usize) < part.geometry.len())
    }

    /// Whether ids of geometries, and of instances, distinguish hits.
    pub(super) fn kinds_of_ids(&self) -> (bool, bool) {
        let has_several = |tree: &Self| tree.parts.len() > 1;
        let several = has_several(self) || self.instances.iter().any(|instance| has_several(&instance.tree));
        (several, !self.instances.is_empty())
    }

    /// Memory in bytes, with all that instances share counted at each of them.
    pub(super) fn memory(&self) -> usize {
        let parts = self.parts.iter().map(|part| match &part.geometry {
            Geometry::Triangles { vertices, faces } => size_of_val(&**vertices) + size_of_val(&**faces),
            Geometry::Spheres { centers, radii } => size_of_val(&**centers) + size_of_val(&**radii),
        });
        parts.sum::<usize>() + self.bvh.memory()
    }
}

fn bounds_of(parts: &[Part], instances: &[Instance]) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    parts.iter().for_each(|part| part.geometry.grow(&mut bounds));
    instances.iter().for_each(|instance| instance.grow(&mut bounds));
    bounds
}

fn rounded_vertices(vertices: &[[f64; 3]], frame: &Frame) -> Vec<[f32; 3]> {
    vertices.iter().map(|&p| frame.rounded(p)).collect()
}

fn rounded_spheres(centers: &[[f64; 3]], radii: &[f64], frame: &Frame) -> Vec<Sphere> {
    let spheres = centers.iter().zip(radii);
    spheres
        .map(|(&center, radius)| Sphere {
            center: frame.rounded(center),
            radius: (radius * frame.scale) as f32,
        })
        .collect()
}

/// The map of an instance, from the frame of its tree to that of the tree around it.
fn map_of_frames(instance: &Instance, outer: &Frame) -> Affine {
    let (map, inner) = (&instance.world_from_object, &instance.tree.frame);
    let scale = outer.scale / inner.scale;
    Affine {
        matrix: map.matrix.map(|row| row.map(|x| x * scale)),
        translation: outer.point(map.point(inner.origin)),
    }
}
