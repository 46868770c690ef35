//! The builder's methods for masks.

use super::{BuildError, Builder};

impl Builder {
    /// Sets the mask of a geometry; by default all bits are set. Rays with a mask
    /// ([`Query::mask`](crate::Query::mask)) see it where the two have a bit in common. An unknown geometry number
    /// makes [`Self::build`] fail.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Ray, Sphere};
    /// let mut builder = Builder::new();
    /// let glass = builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// builder.geometry_mask(glass, 0b10);
    /// let bvh = builder.build()?;
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert!(bvh.query().mask(0b110).occluded(&ray));
    /// assert!(!bvh.query().mask(0b101).occluded(&ray));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn geometry_mask(&mut self, geometry: u32, mask: u32) -> &mut Self {
        if self.has_geometry(geometry) {
            place(&mut self.masks.geometries, geometry, u32::MAX, mask);
        }
        self
    }

    /// Sets a mask for each primitive of a geometry, in addition to the geometry's: a ray sees a primitive where
    /// its mask has a bit in common with each of the two. A wrong number of masks makes [`Self::build`] fail.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Ray, Sphere};
    /// let mut builder = Builder::new();
    /// let [near, far] = [2.0, -2.0].map(|z| Sphere { center: [0.0, 0.0, z], radius: 1.0 });
    /// let balls = builder.spheres(&[near, far]);
    /// builder.primitive_masks(balls, &[0b01, 0b11]);
    /// let bvh = builder.build()?;
    /// let ray = Ray::new([0.0, 0.0, 5.0], [0.0, 0.0, -1.0]);
    /// let seen = |mask| bvh.query().mask(mask).closest_hit(&ray).primitive;
    /// assert_eq!((seen(0b01), seen(0b10)), (0, 1));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn primitive_masks(&mut self, geometry: u32, masks: &[u32]) -> &mut Self {
        if !self.has_geometry(geometry) {
            return self;
        }
        let primitives = self.geometries[geometry as usize].count() as u64;
        if masks.len() as u64 != primitives {
            let masks = masks.len();
            self.error.get_or_insert(BuildError::MaskCount { geometry, masks, primitives });
            return self;
        }
        place(&mut self.masks.primitives, geometry, Vec::new(), masks.to_vec());
        self
    }

    /// Sets the mask of an instance; by default all bits are set. A ray sees its content where the ray's mask has a
    /// bit in common with the instance's and with those of the geometry inside. An unknown instance number makes
    /// [`Self::build`] fail.
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Builder, Ray, Sphere};
    /// use std::sync::Arc;
    /// let mut ball = Builder::new();
    /// ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let mut scene = Builder::new();
    /// let instance = scene.instance(Arc::new(ball.build()?), Affine::IDENTITY);
    /// scene.instance_mask(instance, 0b10);
    /// let scene = scene.build()?;
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert!(!scene.query().mask(0b01).occluded(&ray));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn instance_mask(&mut self, instance: u32, mask: u32) -> &mut Self {
        let instances = self.instances.len();
        if (instance as usize) < instances {
            place(&mut self.masks.instances, instance, u32::MAX, mask);
        } else {
            self.error.get_or_insert(BuildError::NoSuchInstance { instance, instances });
        }
        self
    }

    /// True if there is a geometry of that number; otherwise the error is stored.
    fn has_geometry(&mut self, geometry: u32) -> bool {
        let geometries = self.geometries.len();
        let is_there = (geometry as usize) < geometries;
        if !is_there {
            self.error.get_or_insert(BuildError::NoSuchGeometry { geometry, geometries });
        }
        is_there
    }
}

/// Writes an element of a list, which grows as needed.
fn place<T: Clone>(list: &mut Vec<T>, number: u32, unset: T, value: T) {
    let number = number as usize;
    if list.len() <= number {
        list.resize(number + 1, unset);
    }
    list[number] = value;
}
