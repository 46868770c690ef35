//! Events of Whitted's step for a probe, by lane: from the vectors that make the light and the paths.

use lookfrom_bvh::Point;
use lookfrom_simd::LaneMask;

use super::Whitted;
use super::arriving::{Arriving, Targets};
use crate::core::lanes::width::{Lanes, Mask, Width};
use crate::core::lanes::{LANES, row, store, store_f64};
use crate::core::spectrum::Spectrum;
use crate::integrator::{Branch, Event, Path};
use crate::light::{LightSample, Target};
use crate::shading::material::{Branches, Coefficients};

/// Coefficients and events of the lanes of a group.
#[derive(Clone, Debug)]
pub(super) struct Told {
    pub(super) coefficients: Vec<Coefficients>,
    /// The events of lights and branches, in their order.
    pub(super) events: [Vec<Event>; LANES],
}

impl Told {
    /// The events of a group with these coefficients: none yet.
    pub(super) fn new<W: Width>(width: W, k: &Coefficients<W::Real>) -> Self {
        let [ambient, diffuse, specular, mirror, transmission] =
            [k.ambient, k.diffuse, k.specular, k.mirror, k.transmission].map(|k| width.spectra(k));
        let (shininess, ior, fresnel) = (k.shininess.column(), k.ior.column(), width.bits(k.fresnel));
        let of = |lane: usize| Coefficients {
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
    pub(super) fn add_light<W: Width>(
        &mut self,
        width: W,
        (paths, is_lit): (&[&Path; LANES], Mask<W>),
        light: u32,
        arriving: Option<(&Arriving<W::Real>, u32)>,
        reflected: [Spectrum<W::Real>; 2],
    ) {
        let [diffuse, specular] = reflected.map(|part| width.spectra(part));
        let samples = arriving.map(|(arriving, exists)| (arriving.samples(width), exists));
        for lane in LaneMask(width.bits(is_lit)) {
            self.events[lane].push(Event::LocalLight {
                address: paths[lane].address,
                light,
                sample: samples.filter(|(_, exists)| exists & 1 << lane != 0).map(|(of, _)| of[lane]),
                diffuse: diffuse[lane],
                specular: specular[lane],
            });
        }
    }

    /// Adds the branches, as they are before rays are kept on their sides of the surface.
    pub(super) fn add_branches<W: Width>(
        &mut self,
        width: W,
        (paths, tree): (&[&Path; LANES], &Whitted),
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

impl<R: Lanes> Arriving<R> {
    /// The light sample of each lane.
    fn samples(&self, width: impl Width<Real = R>) -> [LightSample; LANES] {
        let (wi, li, pdf) = (store(self.wi), width.spectra(self.li), self.pdf.column());
        let target: &dyn Fn(usize) -> Target = match self.target {
            Targets::Infinity => &|_| Target::Infinity,
            Targets::Points(points) => {
                let points = store_f64(points);
                &move |lane| Target::Point(row(&points, lane).into())
            }
            Targets::Surfaces(points, normals) => {
                let [position, error, normal] = [points.position, points.error, normals].map(store_f64);
                &move |lane| {
                    let point = Point { position: row(&position, lane), error: row(&error, lane) };
                    Target::Surface(point, row(&normal, lane).into())
                }
            }
        };
        std::array::from_fn(|lane| LightSample {
            wi: row(&wi, lane).into(),
            li: li[lane],
            pdf: pdf[lane],
            target: target(lane),
        })
    }
}
