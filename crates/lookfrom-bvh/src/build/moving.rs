//! The builder's methods for what moves.

use std::sync::Arc;

use crate::affine::Affine;
use crate::bvh::{Bvh, Instance};

use super::primitives::Geometry;
use super::{BuildError, Builder, Triangles};

impl Builder {
    /// Adds triangles that move, and returns their geometry's number: the positions of their vertices at equally spaced times
    /// from 0 to 1, linear in between. [`Query::times`](crate::Query::times) has the times of rays.
    ///
    /// All triangles that move have the same number of times in one builder, at least two; another number, lists of different
    /// lengths, and an index out of range make [`Self::build`] fail.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Ray};
    /// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let up = positions.map(|[x, y, z]| [x, y, z + 4.0]);
    /// let mut builder = Builder::new();
    /// builder.moving_triangles(&[&positions, &up], &[[0, 1, 2]]);
    /// let ray = Ray::new([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]);
    /// assert_eq!(builder.build()?.query().time(0.25).closest_hit(&ray).t, 2.0);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn moving_triangles(&mut self, positions: &[&[[f32; 3]]], indices: &[[u32; 3]]) -> u32 {
        let geometry = self.geometries.len() as u32;
        let least = positions.iter().map(|positions| positions.len()).min().unwrap_or(0);
        let is_complete = positions.iter().all(|positions| positions.len() == least);
        if !is_complete {
            self.fail(BuildError::PositionCount { geometry });
        }
        let times = positions.len();
        let expected = *self.triangle_times.get_or_insert(times);
        let is_same = self.fits(times, expected);
        if !(is_same && self.has_times(times) && is_complete) {
            self.geometries.push(Geometry::MovingTriangles(Vec::new()));
            return geometry;
        }
        let at_time = |positions: &&[[f32; 3]]| self.corners(Triangles { positions, indices });
        let times: Vec<_> = positions.iter().map(at_time).collect();
        self.geometries.push(Geometry::MovingTriangles(times));
        geometry
    }

    /// Adds an instance that moves, and returns its number: its maps, world from object, at equally spaced times from 0 to 1,
    /// every entry linear in between. Otherwise as [`Self::instance`].
    ///
    /// It has as many times as all that moves in the builder, at least two; or 2ᵏ + 1, if all else has such a number, too, not
    /// necessarily the same: then what turns fast costs nothing where other things slide. Another number makes [`Self::build`] fail.
    ///
    /// Between two times the map may have no inverse, and then the instance is not hit.
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Builder, Ray, Sphere};
    /// use std::sync::Arc;
    /// let mut ball = Builder::new();
    /// ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let [near, far] = [5.0, 9.0].map(|z| Affine { translation: [0.0, 0.0, z], ..Affine::IDENTITY });
    /// let mut builder = Builder::new();
    /// builder.moving_instance(Arc::new(ball.build()?), &[near, far]);
    /// let (bvh, ray) = (builder.build()?, Ray::new([0.0; 3], [0.0, 0.0, 1.0]));
    /// assert_eq!([0.0, 0.5, 1.0].map(|time| bvh.query().time(time).closest_hit(&ray).t), [4.0, 6.0, 8.0]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn moving_instance(&mut self, bvh: Arc<Bvh>, world_from_object: &[Affine]) -> u32 {
        let id = self.instances.len() as u32;
        if !self.has_times(world_from_object.len()) {
            return id;
        }
        if world_from_object.iter().any(|map| map.inverse().is_none()) {
            self.fail(BuildError::SingularMatrix { instance: id });
        }
        self.instance(bvh, world_from_object[0]);
        self.motions.insert(id, world_from_object.into());
        id
    }

    /// Whether so many times fit those of all else that moves.
    fn has_times(&mut self, times: usize) -> bool {
        let expected = *self.times.get_or_insert(times.max(2));
        let has_halves = |times: usize| times > 1 && (times - 1).is_power_of_two();
        has_halves(times) && has_halves(expected) || self.fits(times, expected)
    }

    fn fits(&mut self, times: usize, expected: usize) -> bool {
        if times != expected {
            self.fail(BuildError::TimeCount { times, expected });
        }
        times == expected
    }

    /// The maps of all instances at each of their times, by id; of those that stand still none. Instances of trees in which something
    /// moves belong to what moves, too. Then also the number of times at which there are boxes, if anything moves.
    pub(super) fn maps(&self) -> (Vec<Box<[Affine]>>, Option<usize>) {
        let is_moving = |instance: &Instance| instance.bvh.moving.is_some();
        let times = self.times.or_else(|| self.instances.iter().any(is_moving).then_some(2));
        let Some(times) = times else { return (Vec::new(), None) };
        let of = |(id, instance): (u32, &Instance)| match self.motions.get(&id) {
            Some(maps) => maps.clone(),
            None if is_moving(instance) => vec![instance.world_from_object; times].into(),
            None => Box::default(),
        };
        let maps: Vec<Box<[Affine]>> = (0..).zip(&**self.instances).map(of).collect();
        let times = self.triangle_times.unwrap_or_else(|| times_of_boxes(&maps).unwrap_or(times));
        (maps, Some(times))
    }
}

/// The number of times at which instances with these maps have boxes: that of the maps if it is the same for all, else the largest
/// with at most twice as many boxes as there are maps. `None` where nothing moves.
fn times_of_boxes(maps: &[Box<[Affine]>]) -> Option<usize> {
    let parts = || maps.iter().filter(|maps| !maps.is_empty()).map(|maps| maps.len() - 1);
    let (least, most) = (parts().min()?, parts().max()?);
    let twice_the_mean = 2 * parts().sum::<usize>() / parts().count();
    Some(1 + if least == most { most } else { most.min(1 << twice_the_mean.ilog2()) })
}
