//! Rays through interfaces of media ([`World::interface`](crate::world::World::interface)), eight side by side.

use lookfrom_bvh::{Hit, Ray};
use lookfrom_simd::{Kernel, Mask as _, Simd, prelude::*};

use super::bare_hits::BareHits;
use super::surfaces::Surfaces;
use crate::core::lanes::{LANES, are_shaded_together, by_lane, gather_rays, scatter, shade_together};
use crate::primitive::MaterialBinding;
use crate::shading::interior_stack::InteriorStack;
use crate::world::{ShapeClass, World};

/// Rays that go straight on through interfaces, by their places in a list.
#[derive(Debug, Default)]
pub(in crate::integrator) struct Interfaces {
    /// By kind of shape.
    on_shapes: [Vec<u32>; ShapeClass::ALL.len()],
}

/// The kind of shape that an interface is.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct InterfaceKind(ShapeClass);

/// A ray behind an interface.
pub(in crate::integrator) struct Behind {
    pub(in crate::integrator) place: u32,
    pub(in crate::integrator) origin: [f32; 3],
    pub(in crate::integrator) interior: InteriorStack,
}

impl Interfaces {
    /// The kind of the interface that a ray has hit; `None` where that is no such interface.
    #[inline]
    pub(in crate::integrator) fn kind(world: &World, hit: &Hit) -> Option<InterfaceKind> {
        world.interface(hit).filter(|_| are_shaded_together()).map(InterfaceKind)
    }

    /// Adds the ray at a place, which has hit an interface of a kind.
    #[inline]
    pub(in crate::integrator) fn push(&mut self, InterfaceKind(shape): InterfaceKind, place: usize) {
        self.on_shapes[shape as usize].push(place as u32);
    }

    /// Brings all rays behind their interfaces, and forgets them. `of` tells of a place the ray, its hit, and the media that it is in.
    pub(in crate::integrator) fn cross<'a>(
        &mut self,
        world: &World,
        of: impl Fn(u32) -> (&'a Ray, &'a Hit, InteriorStack),
    ) -> Vec<Behind> {
        let mut behind = Vec::new();
        for (places, shape) in self.on_shapes.iter_mut().zip(ShapeClass::ALL) {
            for chunk in places.chunks(LANES) {
                // Unused lanes repeat the last ray.
                let eight = by_lane!(lane => of(chunk[lane.min(chunk.len() - 1)]));
                let (rays, hits) = (by_lane!(lane => eight[lane].0), by_lane!(lane => eight[lane].1));
                let bare = BareHits { rays, hits, shape };
                let Crossed { origins, front, outside } = Cross { world, bare }.cross();
                for (lane, &place) in chunk.iter().enumerate() {
                    let (_, hit, before) = eight[lane];
                    let sides = (front & 1 << lane != 0, outside & 1 << lane != 0);
                    let interior = interior_behind(world, before, hit, sides);
                    behind.push(Behind { place, origin: origins[lane], interior });
                }
            }
            places.clear();
        }
        behind
    }
}

/// The media behind an interface that was met from its outside or not, on its outside or not.
#[inline]
fn interior_behind(
    world: &World,
    before: InteriorStack,
    hit: &Hit,
    (front, is_outside): (bool, bool),
) -> InteriorStack {
    let MaterialBinding { material, medium_interface, .. } =
        world.primitives[hit.geometry as usize].binding(hit.primitive as usize);
    let interface = medium_interface.map(|index| world.medium_interfaces[index as usize]);
    before.beside(&world.materials, (*material, interface), || is_outside, (true, front))
}

struct Cross<'a> {
    world: &'a World,
    bare: BareHits<'a>,
}

impl Cross<'_> {
    #[inline(never)]
    fn cross(self) -> Crossed {
        shade_together(self)
    }
}

/// Origins of rays, and masks: whether each has met the outside, and whether it goes on there.
struct Crossed {
    origins: [[f32; 3]; LANES],
    front: u32,
    outside: u32,
}

impl Kernel for Cross<'_> {
    type Output = Crossed;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Crossed {
        let Self { world, bare } = self;
        let surfaces = Surfaces::of_eight(simd, world, &bare, false);
        let [_, directions] = gather_rays(simd, &bare.rays);
        let crosses = surfaces.cross(directions);
        Crossed {
            origins: scatter(surfaces.exits().toward(directions)),
            front: surfaces.front.to_bitmask() as u32,
            outside: crosses.choose(!surfaces.front, surfaces.front).to_bitmask() as u32,
        }
    }
}
