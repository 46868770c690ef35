//! Refitting: a tree follows geometry that moves.
//!
//! The topology stays and the boxes are refitted from the leaves up: Wald, Boulos, Shirley (2007), "Ray Tracing
//! Deformable Scenes Using Dynamic Bounding Volume Hierarchies". Results are exact after any motion; tracing gets
//! slower the farther neighbours move apart, which [`Statistics::cost`](crate::Statistics::cost) shows, and then
//! building a new tree pays off.

use std::fmt;

use crate::build::{Triangles, has_area, has_surface};
use crate::bvh::Bvh;
use crate::conservative::TriangleBlock;
use crate::sphere::{Sphere, SphereBlock};

/// The new positions of a geometry: all of its primitives, in the order in which they were added.
///
/// ```
/// use lookfrom_bvh::{Builder, Moved, Sphere};
/// let ball = Sphere { center: [0.0; 3], radius: 1.0 };
/// let mut builder = Builder::new();
/// let balls = builder.spheres(&[ball]);
/// let mut bvh = builder.build()?;
/// bvh.refit(&[(balls, Moved::Spheres(&[Sphere { radius: 2.0, ..ball }]))])?;
/// assert!(bvh.bounds().max[0] >= 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub enum Moved<'a> {
    /// Triangles. They may refer to other corners than before.
    Triangles(Triangles<'a>),
    /// Spheres. Radii may change too.
    Spheres(&'a [Sphere]),
}

/// Reason why a tree cannot follow; it must be built again.
///
/// ```
/// use lookfrom_bvh::{Builder, Moved, RefitError, Sphere};
/// let ball = Sphere { center: [0.0; 3], radius: 1.0 };
/// let mut builder = Builder::new();
/// let balls = builder.spheres(&[ball]);
/// let error = builder.build()?.refit(&[(balls, Moved::Spheres(&[ball; 2]))]).unwrap_err();
/// assert_eq!(error, RefitError::OtherPrimitives { geometry: balls, primitive: 1 });
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RefitError {
    /// A triangle refers to a position that does not exist.
    IndexOutOfRange {
        /// The geometry.
        geometry: u32,
        /// The triangle in it.
        triangle: u32,
        /// Number of positions.
        positions: usize,
    },
    /// The tree does not contain exactly those primitives of a geometry that rays can hit after the motion: there
    /// are more or fewer, or of another kind, or some were left out of the tree (see
    /// [`Builder::build`](crate::Builder::build)) or now would be.
    OtherPrimitives {
        /// The geometry.
        geometry: u32,
        /// The first primitive that is either in the tree or can be hit by rays, but not both.
        primitive: u32,
    },
}

impl fmt::Display for RefitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IndexOutOfRange { geometry, triangle, positions } => write!(
                f,
                "triangle {triangle} of geometry {geometry} names a position that is not there; there are {positions}, \
                 counted from 0"
            ),
            Self::OtherPrimitives { geometry, primitive } => write!(
                f,
                "primitive {primitive} of geometry {geometry} can be hit by rays only before or only after the motion, or \
                 its kind has changed; build the tree again"
            ),
        }
    }
}

impl std::error::Error for RefitError {}

impl Bvh {
    /// Moves geometries of this tree and refits its boxes. Other geometries stay where they are, or move in time as before. Of
    /// several motions of one geometry the last counts.
    ///
    /// The results of queries are those of a new tree. The time is proportional to the whole tree, a small part of
    /// the build time.
    ///
    /// # Errors
    /// See [`RefitError`]. The tree is then unchanged.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Moved, Ray, Sphere};
    /// let mut builder = Builder::new();
    /// let balls = builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let mut bvh = builder.build()?;
    /// bvh.refit(&[(balls, Moved::Spheres(&[Sphere { center: [0.0, 5.0, 0.0], radius: 2.0 }]))])?;
    /// assert_eq!(bvh.closest_hit(&Ray::new([0.0; 3], [0.0, 1.0, 0.0])).t, 3.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn refit(&mut self, moved: &[(u32, Moved<'_>)]) -> Result<(), RefitError> {
        // Check everything before anything changes.
        for (geometry, moved) in moved {
            self.check(*geometry, moved)?;
        }
        for (geometry, moved) in moved {
            match moved {
                Moved::Triangles(triangles) => self.move_triangles(*geometry, triangles),
                Moved::Spheres(spheres) => self.move_spheres(*geometry, spheres),
            }
        }
        if self.nodes.is_empty() {
            return Ok(());
        }
        let instances = self.instances.clone();
        let [mut exact, _] = self.fit(0, &|id| instances[id].bounds());
        if let Some(moving) = &self.moving {
            exact.unite(&moving.bounds);
        }
        self.set_bounds(exact);
        self.statistics = self.count(self.statistics.left_out);
        Ok(())
    }

    /// Checks that the tree contains exactly those primitives that rays can hit after the motion.
    fn check(&self, geometry: u32, moved: &Moved<'_>) -> Result<(), RefitError> {
        let mut usable = match moved {
            Moved::Triangles(triangles) => usable_triangles(geometry, triangles)?,
            Moved::Spheres(spheres) => spheres.iter().map(has_surface).collect(),
        };
        let triangles =
            self.triangles.iter().flat_map(|block| (0..block.count()).map(|lane| block.ids(lane)));
        let spheres =
            self.spheres.iter().flat_map(SphereBlock::items).map(|item| (item.geometry, item.primitive));
        let procedurals = self.procedurals.iter().map(|item| (item.geometry, item.primitive));

        // Cross off the primitives of the tree; for those of another kind the refit fails.
        let is_triangles = matches!(moved, Moved::Triangles(_));
        let held = triangles
            .map(|ids| (ids, is_triangles))
            .chain(spheres.map(|ids| (ids, !is_triangles)))
            .chain(procedurals.map(|ids| (ids, false)))
            .filter(|((of, _), _)| *of == geometry);
        let mut other: Option<u32> = None;
        for ((_, primitive), right_kind) in held {
            match usable.get_mut(primitive as usize) {
                Some(usable) if *usable && right_kind => *usable = false,
                _ => other = Some(other.map_or(primitive, |least| least.min(primitive))),
            }
        }
        let added = usable.iter().position(|&usable| usable).map(|primitive| primitive as u32);
        match [other, added].into_iter().flatten().min() {
            Some(primitive) => Err(RefitError::OtherPrimitives { geometry, primitive }),
            None => Ok(()),
        }
    }

    fn move_triangles(&mut self, geometry: u32, triangles: &Triangles<'_>) {
        let mut lanes = Vec::new();
        for block in &mut self.triangles {
            lanes.clear();
            let mut touched = false;
            for lane in 0..block.count() {
                let (of, primitive) = block.ids(lane);
                let corners = if of == geometry {
                    touched = true;
                    triangles.indices[primitive as usize].map(|index| triangles.positions[index as usize])
                } else {
                    block.corners(lane)
                };
                lanes.push((corners, of, primitive));
            }
            if touched {
                *block = TriangleBlock::new(&lanes);
            }
        }
    }

    fn move_spheres(&mut self, geometry: u32, spheres: &[Sphere]) {
        for block in &mut self.spheres {
            for lane in 0..block.count() {
                let item = block.item(lane);
                if item.geometry == geometry {
                    block.set_shape(lane, &spheres[item.primitive as usize]);
                }
            }
        }
    }
}

/// For each triangle, whether rays can hit it.
fn usable_triangles(geometry: u32, triangles: &Triangles<'_>) -> Result<Vec<bool>, RefitError> {
    let positions = triangles.positions;
    let usable = |(triangle, indices): (usize, &[u32; 3])| {
        let corner = |i: usize| positions.get(indices[i] as usize).copied();
        match (corner(0), corner(1), corner(2)) {
            (Some(a), Some(b), Some(c)) => Ok(has_area(&[a, b, c])),
            _ => {
                let triangle = triangle as u32;
                Err(RefitError::IndexOutOfRange { geometry, triangle, positions: positions.len() })
            }
        }
    };
    triangles.indices.iter().enumerate().map(usable).collect()
}
