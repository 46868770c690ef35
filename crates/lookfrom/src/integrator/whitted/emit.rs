//! Events, light, shadow rays and branches of the tree from shaded hits, path by path (Whitted 1980).

use lookfrom_bvh::{Hit, Ray};
use lookfrom_simd::LaneMask;

use super::RayTree;
use super::shaded::Shaded;
use crate::core::spectrum::Spectrum;
use crate::integrator::wavefront::{Boundary, Departure};
use crate::integrator::{Branch, Event, Path, Probe, StepOutput, Term};
use crate::world::World;

/// A path, absorbed by media on its way, at what it has hit.
pub(super) struct PathHit<'a> {
    pub(super) departure: Departure<'a>,
    pub(super) hit: &'a Hit,
}

impl Shaded {
    /// Tells the probe of the surface and adds its emission, where it may have any.
    #[cold]
    fn tell_surface<P: Probe>(
        &self,
        world: &World,
        (path_hit, lane): (&PathHit<'_>, usize),
        output: &mut StepOutput<'_, P>,
    ) {
        let PathHit { departure: Departure { path, boundary, .. }, hit } = *path_hit;
        let surface = match boundary {
            Boundary::Surface(surface) => Some(surface),
            _ => None,
        };
        let time = output.time(path);
        output.probe.notice_some(|| {
            self.told.as_ref().map(|told| Event::Surface {
                address: path.address,
                surface: Box::new(surface.copied().unwrap_or_else(|| world.surface_at(&path.ray, hit, time))),
                coefficients: Some(Box::new(told.coefficients[lane])),
            })
        });
        if let Some(surface) = surface {
            let mode = output.mode(path);
            let emits = world.emitted(surface, &mode) + world.unlit(surface, &mode).unwrap_or_default();
            output.add(path, Term::Emission, path.beta * emits);
        }
    }

    /// Adds the ambient light of the surface in a lane to the sample of its path.
    #[inline(always)]
    pub(super) fn add_own_light<P: Probe>(
        &self,
        world: &World,
        (path_hit, lane): (&PathHit<'_>, usize),
        output: &mut StepOutput<'_, P>,
    ) {
        let Departure { path, boundary, .. } = path_hit.departure;
        if P::LISTENS || matches!(boundary, Boundary::Surface(_)) {
            self.tell_surface(world, (path_hit, lane), output);
        }
        output.add(path, Term::Ambient, self.ambient[lane]);
        if P::LISTENS
            && let Some(told) = &self.told
        {
            told.events[lane].iter().for_each(|event| output.probe.notice(|| event.clone()));
        }
    }

    /// Casts the shadow rays of the surfaces in some lanes, and adds the paths that go on in the tree, if there is one: light by
    /// light and branch by branch, so that neighbours go the same way.
    #[inline(always)]
    pub(super) fn go_on<'a, P: Probe>(
        &self,
        world: &World,
        (lanes, departure): (u32, impl Fn(usize) -> Departure<'a>),
        tree: Option<&RayTree>,
        output: &mut StepOutput<'_, P>,
    ) {
        for from in &self.lights[..self.light_count] {
            for lane in LaneMask(from.lit & lanes) {
                let departure = departure(lane);
                let interior = departure.interior_beside(world);
                let last_scattering = output.last_scattering(departure.path, false, || from.diffuse[lane]);
                let light = (from.light, from.contribution[lane]);
                let shadow = departure.shadow(from.rays[lane], light, interior, last_scattering);
                output.queues.shadows.push(shadow);
            }
        }
        let Some(tree) = tree else { return };
        for (branch, rays) in [Branch::Mirrored, Branch::Refracted].into_iter().zip(&self.branches) {
            for lane in LaneMask(rays.exist & lanes) {
                grow(world, &departure(lane), (tree, branch), (rays.rays[lane], rays.beta[lane]), output);
            }
        }
    }
}

/// Adds the path that goes on in a branch of the tree, if it is not cut.
#[inline(always)]
fn grow<P: Probe>(
    world: &World,
    departure: &Departure<'_>,
    (tree, branch): (&RayTree, Branch),
    (ray, beta): (Ray, Spectrum),
    output: &mut StepOutput<'_, P>,
) {
    let path = departure.path;
    if tree.cut(path, beta).is_some() {
        return;
    }
    let crosses = branch == Branch::Refracted;
    let interior = match branch {
        Branch::Refracted => departure.interior_behind(world, ray.direction.into()),
        Branch::Mirrored => departure.interior_beside(world),
    };
    let light_path = output.scattered(path, [true, false, crosses]);
    output.paths.push(Path {
        ray,
        beta,
        depth: path.depth + 1,
        address: path.address << 1 | u64::from(crosses),
        interior,
        light_path,
        ..*path
    });
}
