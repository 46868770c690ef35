//! The faces of surfaces that a query sees.

/// The faces of surfaces that rays hit.
///
/// A triangle's front is the side from which its corners are seen counter-clockwise, a sphere's is its outside. In
/// an instance the faces are those of the object in its own space: the outside of a closed object remains its
/// outside under a reflection. Procedural shapes have no faces that the tree knows of and are hit from any side;
/// their [`intersect`](crate::Procedural::intersect) may choose.
///
/// ```
/// # use lookfrom_bvh::{Builder, Faces, Ray, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// let inside = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
/// let sees = |faces| bvh.query().faces(faces).occluded(&inside);
/// assert_eq!([Faces::Both, Faces::Front, Faces::Back].map(sees), [true, false, true]);
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Faces {
    /// Both faces.
    #[default]
    Both,
    /// Front faces only: back faces are culled.
    Front,
    /// Back faces only: front faces are culled.
    Back,
}

impl Faces {
    #[inline(always)]
    pub(crate) fn shows(self, is_front: impl FnOnce() -> bool) -> bool {
        match self {
            Self::Both => true,
            Self::Front => is_front(),
            Self::Back => !is_front(),
        }
    }
}
