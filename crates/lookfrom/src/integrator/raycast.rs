//! Ray casting (Appel 1968): the nearest surface, local shading, one shadow ray to each light, no recursion.

use lookfrom_bvh::Hit;

use crate::integrator::direct::local_light;
use crate::integrator::{Integrator, Next, Numbers, Passing, Path, Probe, Term};
use crate::world::World;

/// Ray casting.
#[derive(Clone, Copy, Debug)]
pub struct Raycast {
    /// Whether shadow rays pass transparent materials, coloured by them.
    pub transparent_shadows: bool,
}

impl Integrator for Raycast {
    fn name(&self) -> &'static str {
        "raycast"
    }

    fn passing(&self) -> Passing {
        Passing::of_whitted(self.transparent_shadows)
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        numbers: &Numbers,
        path: &Path,
        hit: &Hit,
        next: &mut Next<'_, P>,
    ) {
        let path = &path.absorbed(world, hit, &next.lanes(path));
        if !hit.is_hit() {
            if !next.shows_background(path) {
                next.add(path, Term::Sky, path.beta * world.sky(&path.ray, &next.lanes(path)));
            }
            return;
        }
        let surface = world.surface(&path.ray, hit);
        if path.goes_through(world, &surface, numbers.presence(world, &surface)) {
            next.samples.paths.push(path.passed(&surface));
            return;
        }
        local_light(world, numbers, path, &surface, next);
    }
}
