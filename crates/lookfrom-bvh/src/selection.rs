//! Rays that see only some of the geometry: by masks, and by the faces of surfaces that they look at.
//!
//! A view of a tree, with the tree's own questions. Those that do not select are compiled apart and pay nothing.

use crate::Bvh;
use crate::exact::Exact;
use crate::filter::TriangleBlock;
use crate::masks::Masks;
use crate::query::{All, Any, Closest, Query};
use crate::ray::{Hit, Ray};
use crate::traverse::Trace;
use crate::triangle;
use crate::watch::Observer;
use lookfrom_simd::LaneMask;

/// Which faces of surfaces rays hit.
///
/// A triangle's front is where its corners are seen counter-clockwise, a sphere's is its outside. In an instance the
/// faces are those that the object has in its own space: the outside of a closed object stays its outside in a mirror.
/// Procedural shapes have no faces that the tree knows of and are hit whatever is asked; their
/// [`intersect`](crate::Procedural::intersect) may choose.
///
/// ```
/// # use lookfrom_bvh::{Builder, Faces, Ray, Selection, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// let inside = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
/// let sees = |faces| bvh.select(Selection { faces, ..Selection::ALL }).occluded(&inside);
/// assert_eq!([Faces::Both, Faces::Front, Faces::Back].map(sees), [true, false, true]);
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Faces {
    /// Both.
    #[default]
    Both,
    /// Only those that the ray meets from their front: back faces are culled.
    Front,
    /// Only those that the ray meets from behind: front faces are culled.
    Back,
}

/// What rays see.
///
/// ```
/// use lookfrom_bvh::{Builder, Faces, Ray, Selection, Sphere};
/// let mut builder = Builder::new();
/// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// let bvh = builder.build()?;
/// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
/// let backs = bvh.select(Selection { faces: Faces::Back, ..Selection::ALL });
/// assert_eq!((bvh.closest_hit(&ray).t, backs.closest_hit(&ray).t), (2.0, 4.0));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Selection {
    /// A primitive is seen where this has a bit in common with its mask, with its geometry's and with its instance's:
    /// see [`Builder::geometry_mask`](crate::Builder::geometry_mask). What was given no mask has all bits.
    pub mask: u32,
    /// And where it is met from this side.
    pub faces: Faces,
}

impl Selection {
    /// All bits and both faces: everything but what has a mask without bits.
    ///
    /// ```
    /// assert_eq!(lookfrom_bvh::Selection::ALL, lookfrom_bvh::Selection::default());
    /// ```
    pub const ALL: Self = Self { mask: u32::MAX, faces: Faces::Both };
}

impl Default for Selection {
    fn default() -> Self {
        Self::ALL
    }
}

/// A tree of which rays see only a [`Selection`]; made by [`Bvh::select`]. What they do not see neither is hit nor ends them.
///
/// ```
/// # use lookfrom_bvh::{Builder, Ray, Selection, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// let selected = bvh.select(Selection { mask: 0b1, ..Selection::ALL });
/// assert!(selected.occluded(&Ray::new([0.0; 3], [0.0, 0.0, 1.0])), "what was given no mask has all bits");
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Selected<'a> {
    bvh: &'a Bvh,
    selection: Selection,
}

impl Bvh {
    /// The same tree for rays that see only a part of it. The tree's own questions are about everything, masks or not.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Faces, Hit, Ray, Selection, Triangles};
    /// let mut builder = Builder::new();
    /// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let wall = builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// builder.geometry_mask(wall, 0b01);
    /// let bvh = builder.build()?;
    /// // From where the corners are seen counter-clockwise.
    /// let ray = Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
    /// let select = |mask, faces| bvh.select(Selection { mask, faces });
    /// assert_eq!(select(0b01, Faces::Front).closest_hit(&ray), bvh.closest_hit(&ray));
    /// assert_eq!(select(0b01, Faces::Back).closest_hit(&ray), Hit::MISS);
    /// assert_eq!(select(0b10, Faces::Both).closest_hit(&ray), Hit::MISS);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn select(&self, selection: Selection) -> Selected<'_> {
        Selected { bvh: self, selection }
    }
}

impl Selected<'_> {
    #[inline(always)]
    fn ask<Q: Query>(&self, ray: &Ray, ask: impl FnOnce(&Ray) -> Q, watch: impl Observer) -> Q {
        let &Self { bvh, selection } = self;
        let ask = |ray: &Ray| Only { query: ask(ray), selection, outer: bvh, masks: &bvh.masks };
        Trace { bvh, ray, ask, watch }.go().query
    }

    /// [`Bvh::closest_hit`] among what is selected.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Selection, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(bvh.select(Selection::ALL).closest_hit(&ray), bvh.closest_hit(&ray));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hit(&self, ray: &Ray) -> Hit {
        self.ask(ray, Closest::new, ()).hit
    }

    /// [`Bvh::closest_hit_watched`] among what is selected. Primitives that are not are among the candidates.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Selection, Sphere, Observer};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// struct Nodes(u32);
    /// impl Observer for Nodes {
    ///     fn node(&mut self, _: u32, _: u32) {
    ///         self.0 += 1;
    ///     }
    /// }
    /// let mut nodes = Nodes(0);
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(bvh.select(Selection::ALL).closest_hit_watched(&ray, &mut nodes).t, 2.0);
    /// assert_eq!(nodes.0, 1);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hit_watched(&self, ray: &Ray, watch: &mut impl Observer) -> Hit {
        self.ask(ray, Closest::new, watch).hit
    }

    /// [`Bvh::occluded`] by what is selected.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Faces, Ray, Selection, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let fronts = bvh.select(Selection { faces: Faces::Front, ..Selection::ALL });
    /// assert!(!fronts.occluded(&Ray::new([0.0; 3], [0.0, 0.0, 1.0])), "from inside");
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.ask(ray, Any::new, ()).found
    }

    /// [`Bvh::all_hits`] with what is selected.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Faces, Ray, Selection, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let mut hits = Vec::new();
    /// let fronts = bvh.select(Selection { faces: Faces::Front, ..Selection::ALL });
    /// fronts.all_hits(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), &mut hits);
    /// assert_eq!(hits.len(), 1);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        let room = std::mem::take(hits);
        *hits = self.ask(ray, move |ray: &Ray| All::new(ray, room), ()).hits;
        crate::bvh::sort(hits);
    }

    /// [`Bvh::closest_hits`] among what is selected.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Hit, Ray, Selection, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let rays = [1.0, -1.0].map(|z| Ray::new([0.0, 0.0, 3.0 * z], [0.0, 0.0, -1.0]));
    /// let mut hits = [Hit::MISS; 2];
    /// bvh.select(Selection::ALL).closest_hits(&rays, &mut hits);
    /// assert_eq!(hits.map(|hit| hit.is_hit()), [true, false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) {
        crate::bvh::for_each(rays, hits, |ray, hit| *hit = self.closest_hit(ray));
    }

    /// [`Bvh::occluded_many`] by what is selected.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Selection, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let rays = [1.0, -1.0].map(|z| Ray::new([0.0, 0.0, 3.0 * z], [0.0, 0.0, -1.0]));
    /// let mut occluded = [false; 2];
    /// bvh.select(Selection::ALL).occluded_many(&rays, &mut occluded);
    /// assert_eq!(occluded, [true, false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded_many(&self, rays: &[Ray], occluded: &mut [bool]) {
        crate::bvh::for_each(rays, occluded, |ray, occluded| *occluded = self.occluded(ray));
    }
}

/// A question about what is selected.
struct Only<'a, Q> {
    query: Q,
    selection: Selection,
    outer: &'a Bvh,
    /// Those of the tree that the ray is in.
    masks: &'a Masks,
}

impl<Q: Query> Query for Only<'_, Q> {
    const NEAREST_FIRST: bool = Q::NEAREST_FIRST;
    const ANY_HIT: bool = Q::ANY_HIT;
    const SELECTS: bool = true;

    #[inline(always)]
    fn end(&self) -> f32 {
        self.query.end()
    }

    #[inline(always)]
    fn accept(&mut self, hit: Hit) -> bool {
        self.query.accept(hit)
    }

    fn enter_instance(&mut self, place: usize) -> bool {
        let instance = &self.outer.instances[place];
        let is_shown = self.outer.masks.shows_instance(instance.id, self.selection.mask);
        if is_shown {
            self.masks = &instance.bvh.masks;
        }
        is_shown
    }

    fn leave_instance(&mut self) {
        self.masks = &self.outer.masks;
    }

    fn shows(&self, geometry: u32, primitive: u32) -> bool {
        self.masks.shows(geometry, primitive, self.selection.mask)
    }

    fn shows_face(&self, is_front: impl FnOnce() -> bool) -> bool {
        match self.selection.faces {
            Faces::Both => true,
            Faces::Front => is_front(),
            Faces::Back => !is_front(),
        }
    }
}

/// Those of some lanes that a query is about. Not those that are missed: there the faces may be wrong.
#[inline(never)]
pub(crate) fn shown<Q: Query>(query: &Q, block: &TriangleBlock, ray: &Exact, lanes: LaneMask) -> u32 {
    let is_shown = |&lane: &usize| {
        let (geometry, primitive) = block.ids(lane);
        let is_front = || triangle::is_front(ray, &block.corners(lane));
        query.shows(geometry, primitive) && query.shows_face(is_front)
    };
    lanes.filter(is_shown).fold(0, |shown, lane| shown | 1 << lane)
}
