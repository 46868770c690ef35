//! Observers of a traversal: counters, trace logs, or none.

/// Is notified of the nodes and candidates of a traversal. The default methods do nothing.
///
/// ```
/// use lookfrom_bvh::{Builder, Ray, Sphere, Observer};
///
/// /// Counts nodes.
/// struct Nodes(u32);
///
/// impl Observer for Nodes {
///     fn node(&mut self, _instance: u32, _node: u32) {
///         self.0 += 1;
///     }
/// }
///
/// let mut builder = Builder::new();
/// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// let mut nodes = Nodes(0);
/// builder.build()?.query().observer(&mut nodes).closest_hit(&Ray::new([0.0; 3], [0.0, 0.0, 1.0]));
/// assert_eq!(nodes.0, 1);
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
pub trait Observer {
    /// The ray visits a node of a tree; `instance` is [`NONE`](crate::NONE) in the outer tree.
    fn node(&mut self, instance: u32, node: u32) {
        let _ = (instance, node);
    }

    /// The ray was tested against the boxes of the node's children: it enters `entered` of `tested`. The others are
    /// culled: it misses them, or has a hit before them.
    fn boxes(&mut self, instance: u32, tested: u32, entered: u32) {
        let _ = (instance, tested, entered);
    }

    /// The ray is about to be tested against a primitive.
    fn candidate(&mut self, instance: u32, geometry: u32, primitive: u32) {
        let _ = (instance, geometry, primitive);
    }
}

/// The recipient of a traversal's notifications: a type-erased [`Observer`], so that the kernel has one instance for all types, or
/// nobody, `()`, at no cost.
pub trait Listener {
    /// The observer, if there is one.
    fn observer(&mut self) -> Option<&mut dyn Observer>;
}

impl Listener for () {
    #[inline(always)]
    fn observer(&mut self) -> Option<&mut dyn Observer> {
        None
    }
}

impl Listener for &mut dyn Observer {
    #[inline(always)]
    fn observer(&mut self) -> Option<&mut dyn Observer> {
        Some(&mut **self)
    }
}
