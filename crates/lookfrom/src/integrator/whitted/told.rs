//! Events of Whitted's step for a probe, by lane: from the vectors that make the light and the paths.

use lookfrom_simd::LaneMask;

use super::RayTree;
use crate::core::lanes::width::{Lanes, Mask, Width};
use crate::core::lanes::{LANES, row, store};
use crate::core::spectrum::Spectrum;
use crate::integrator::wavefront::LightSamples;
use crate::integrator::{Branch, Event, Path};
use crate::shading::bsdf::whitted::{Branches, WhittedCoefficients};

/// Coefficients and events of the lanes of a group.
#[derive(Clone, Debug)]
pub(super) struct Told {
    pub(super) coefficients: Vec<WhittedCoefficients>,
    /// The events of lights and branches, in their order.
    pub(super) events: [Vec<Event>; LANES],
}

impl Told {
    /// The events of a group with these coefficients: none yet.
    #[inline(always)]
    pub(super) fn new<W: Width>(width: W, k: &WhittedCoefficients<W::Real>) -> Self {
        let (ambient, diffuse, specular) =
            (width.spectra(k.ambient), width.spectra(k.diffuse), width.spectra(k.specular));
        let (mirror, transmission) = (width.spectra(k.mirror), width.spectra(k.transmission));
        let (shininess, ior, fresnel) = (k.shininess.column(), k.ior.column(), width.bits(k.fresnel));
        let of = |lane: usize| WhittedCoefficients {
            ambient: ambient[lane],
            diffuse: diffuse[lane],
            specular: specular[lane],
            shininess: shininess[lane],
            mirror: mirror[lane],
            transmission: transmission[lane],
            ior: ior[lane],
            fresnel: fresnel & 1 << lane != 0,
        };
        Self { coefficients: (0..LANES).map(of).collect(), events: Default::default() }
    }

    /// Adds a light, in the lanes of a mask: what arrives, in those of another, and what is reflected of it.
    #[inline(always)]
    pub(super) fn add_light<W: Width>(
        &mut self,
        width: W,
        (paths, is_lit): (&[&Path; LANES], Mask<W>),
        lights: &LightSamples,
        exists: Mask<W>,
        reflected: [Spectrum<W::Real>; 2],
    ) {
        let (diffuse, specular) = (width.spectra(reflected[0]), width.spectra(reflected[1]));
        let exists = width.bits(exists);
        for lane in LaneMask(width.bits(is_lit)) {
            self.events[lane].push(Event::LocalLight {
                address: paths[lane].address,
                light: lights.of_all(),
                sample: (exists & 1 << lane != 0).then(|| lights.light_sample(lane)),
                diffuse: diffuse[lane],
                specular: specular[lane],
            });
        }
    }

    /// Adds the branches, as they are before rays are kept on their sides of the surface.
    #[inline(always)]
    pub(super) fn add_branches<W: Width>(
        &mut self,
        width: W,
        (paths, tree): (&[&Path; LANES], &RayTree),
        beta: Spectrum<W::Real>,
        branches: &Branches<W::Real>,
        [exist, is_refracted]: [Mask<W>; 2],
    ) {
        let (fresnel, total) = (branches.fresnel.column(), width.bits(branches.total_reflection));
        for (branch, (direction, weight), exist) in [
            (Branch::Mirrored, branches.mirrored, exist),
            (Branch::Refracted, branches.refracted, is_refracted),
        ] {
            let (directions, weights) = (store(direction), width.spectra(weight));
            let betas = width.spectra(beta * weight);
            for lane in LaneMask(width.bits(exist)) {
                self.events[lane].push(Event::Grew {
                    address: paths[lane].address,
                    branch,
                    direction: row(&directions, lane).into(),
                    weight: weights[lane],
                    fresnel: self.coefficients[lane].fresnel.then_some(fresnel[lane]),
                    total_reflection: total & 1 << lane != 0,
                    cut: tree.cut(paths[lane], betas[lane]),
                });
            }
        }
    }
}
