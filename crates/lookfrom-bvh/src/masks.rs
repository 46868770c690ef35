//! The masks of a tree's geometries, primitives and instances.
//!
//! Stored apart from the primitives, since most trees have none. They are applied in `visibility`.

/// Masks by id. Every ray sees a primitive without a mask.
#[derive(Clone, Debug, Default)]
pub(crate) struct Masks {
    /// By geometry; those beyond the end have all bits.
    pub(crate) geometries: Vec<u32>,
    /// By instance, likewise.
    pub(crate) instances: Vec<u32>,
    /// By geometry and primitive; an empty list means that all primitives have all bits.
    pub(crate) primitives: Vec<Vec<u32>>,
}

impl Masks {
    pub(crate) fn shows_instance(&self, instance: u32, mask: u32) -> bool {
        of(&self.instances, instance) & mask != 0
    }

    pub(crate) fn shows(&self, geometry: u32, primitive: u32, mask: u32) -> bool {
        let own = self.primitives.get(geometry as usize).map_or(u32::MAX, |masks| of(masks, primitive));
        of(&self.geometries, geometry) & mask != 0 && own & mask != 0
    }

    /// Memory in bytes.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(&*self.geometries)
            + size_of_val(&*self.instances)
            + size_of_val(&*self.primitives)
            + self.primitives.iter().map(|masks| size_of_val(&**masks)).sum::<usize>()
    }
}

fn of(masks: &[u32], number: u32) -> u32 {
    masks.get(number as usize).copied().unwrap_or(u32::MAX)
}
