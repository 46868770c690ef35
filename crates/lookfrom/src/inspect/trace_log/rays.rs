//! Events of rays: hits, surfaces, bounces.

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, NONE, Ray};

use super::TraceLogBuilder;
use crate::core::spectrum::Spectrum;
use crate::inspect::candidate;
use crate::inspect::report::{
    Amount, CoefficientsReport, Departure, ExitReport, FootprintReport, LiftReport, MetReport, ProbeReport,
    ProbeSegmentReport, RayReport,
};
use crate::inspect::scatter::{self, BounceReport};
use crate::inspect::segments::RayKind;
use crate::integrator::{Bounce, Path, PreviousVertex, SubsurfaceProbe};
use crate::primitive::Primitives;
use crate::shading::bsdf::whitted::WhittedCoefficients;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::Shading;
use crate::shading::texture::SpectralMode;
use crate::world::World;

impl TraceLogBuilder<'_> {
    pub(super) fn ray(
        &self,
        path: &Path<PreviousVertex>,
        hit: &Hit,
        surface: Option<&SurfaceInteraction>,
    ) -> RayReport {
        let kind = match (path.address, path.address & 1) {
            (Path::ROOT, _) => RayKind::Camera,
            (_, 0) => RayKind::Reflected,
            _ => RayKind::Refracted,
        };
        let (traversal, candidates) = match self.is_whole {
            true => candidate::candidates(self.world, (&path.ray, self.time), hit),
            false => Default::default(),
        };
        let pdf = path.state.pdf;
        RayReport {
            address: path.address,
            parent: None,
            kind,
            depth: path.depth,
            a: in_world(self.world, path.ray.origin),
            origin: path.ray.origin,
            direction: path.ray.direction,
            departure: None,
            throughput: self.factor(path.beta),
            // Infinite stands for a specular bounce or a camera ray.
            pdf: (pdf != f32::INFINITY).then_some(pdf),
            traversal,
            candidates,
            met: surface.map(|surface| met_report(self.world, (hit, self.time), surface)),
            absorption: None,
            flight: None,
            tracking: None,
            medium_emission: None,
            phase: None,
            eta_scale: path.state.eta_scale,
            throughput_there: None,
            only_color: None,
            found: Vec::new(),
            scattering: None,
            lights: Vec::new(),
            light_sample: None,
            openness: None,
            bounce: None,
            probe: None,
            branches: Vec::new(),
            ends: None,
            added: Amount::default(),
            subtree: Amount::default(),
        }
    }

    /// The step from the hit of a ray to the origin of another.
    pub(super) fn departure(&self, address: u64, ray: &Ray) -> Option<Departure> {
        let (_, Some(surface)) = self.hits.get(&address)? else { return None };
        let direction = Vec3::from_array(ray.direction);
        if surface.origin(direction) != ray.origin {
            return None;
        }
        let (lift, step) = surface.way_out(direction);
        Some(Departure { lift: lift.map(|lift| lift.to_array()), step })
    }

    pub(super) fn coefficients(&self, k: &WhittedCoefficients) -> CoefficientsReport {
        CoefficientsReport {
            ambient: self.factor(k.ambient),
            diffuse: self.factor(k.diffuse),
            specular: self.factor(k.specular),
            shininess: k.shininess,
            mirror: self.factor(k.mirror),
            transmission: self.factor(k.transmission),
            ior: k.ior,
        }
    }

    /// The search for the point where a path leaves a medium below a surface.
    pub(super) fn probe(&self, probe: &SubsurfaceProbe) -> ProbeReport {
        ProbeReport {
            throughput_before: self.factor(probe.before),
            choice: self.factor(probe.choice),
            segment: probe.segment.map(|segment| ProbeSegmentReport {
                axis: ["first tangent", "second tangent", "normal"][segment.axis as usize],
                lane: segment.lane,
                radius: segment.radius,
                from: in_world(self.world, segment.start.to_array()),
                direction: segment.direction.to_array(),
                length: segment.length,
            }),
            count: probe.count,
            exit: probe.exit.map(|exit| ExitReport {
                point: (self.world.origin + exit.point).to_array(),
                sp: self.factor(exit.sp),
                pdf: exit.pdf,
                probability: exit.probability,
                throughput: self.factor(exit.after),
            }),
        }
    }

    pub(super) fn shaded(&mut self, address: u64, shading: &Shading, beta: Spectrum) {
        let report = scatter::scattering(shading, |value| self.factor(value));
        let throughput = self.factor(beta);
        let only = match self.mode {
            SpectralMode::Rgb => beta.only_lane().map(|lane| ["red", "green", "blue", ""][lane]),
            SpectralMode::Spectral(_) => None,
        };
        self.at(address, |ray| {
            let had_others = ray.throughput.iter().filter(|lane| **lane != 0.0).count() > 1;
            ray.only_color = only.filter(|_| had_others);
            ray.scattering = Some(report);
            ray.throughput_there = Some(throughput);
        });
    }

    pub(super) fn bounce(&self, address: u64, bounce: &Bounce) -> BounceReport {
        let sample = &bounce.sample;
        let before = self.rays.get(&address).map_or(1.0, |ray| ray.eta_scale);
        let refracted = if sample.lobe.is_transmission() { sample.eta * sample.eta } else { 1.0 };
        BounceReport {
            lobe: scatter::words(sample.lobe),
            letters: scatter::letters(sample.lobe),
            wi: bounce.wi.to_array(),
            f: self.factor(sample.f),
            microfacets: self.microfacets(address, bounce.wi, sample.lobe.is_specular()),
            cos: bounce.cos,
            pdf: sample.pdf,
            pdf_is_proportional: sample.pdf_is_proportional,
            eta: sample.eta,
            eta_scale: before * refracted,
            throughput_before: self
                .rays
                .get(&address)
                .and_then(|ray| ray.throughput_there.clone())
                .unwrap_or_default(),
            throughput_after: self.factor(bounce.beta),
            survival: bounce.survival,
            survives: bounce.survives,
            next_throughput: None,
        }
    }
}

fn met_report(world: &World, (hit, time): (&Hit, f32), surface: &SurfaceInteraction) -> MetReport {
    MetReport {
        shape: world.names.shapes[surface.shape as usize].of(surface.primitive),
        primitive: hit.primitive,
        instance: (hit.instance != NONE).then_some(hit.instance),
        t: hit.t,
        point: (world.origin + DVec3::from_array(surface.point.position)).to_array(),
        error: surface.point.error,
        lift: lift_report(world, (hit, time), surface),
        ng: surface.ng.to_array(),
        n: surface.ns_facing().to_array(),
        uv: surface.uv.to_array(),
        footprint: world.shading_point(surface).footprint.map(|seen| FootprintReport {
            dpdx: seen.p[0].to_array(),
            dpdy: seen.p[1].to_array(),
            duv_dx: seen.uv[0].to_array(),
            duv_dy: seen.uv[1].to_array(),
        }),
        wo: surface.wo.to_array(),
        cos_viewer: surface.ns_facing().dot(surface.wo),
        front: surface.front,
        alpha: surface.alpha.map(|alpha| world.textures.float(alpha, &world.texture_point(surface))),
        material: world.names.materials[surface.material as usize].clone(),
        coefficients: None,
    }
}

/// The way to the smooth surface that a triangle stands for, and its operands.
fn lift_report(world: &World, (hit, time): (&Hit, f32), surface: &SurfaceInteraction) -> Option<LiftReport> {
    let lift = surface.lift()?.way.into();
    let (Primitives::Mesh(mesh), placed) = world.primitives(hit, time) else { return None };
    let triangle = mesh.triangle_at(hit.primitive as usize, time);
    let from_object = placed.map(|placed| {
        let [x, y, z, _] = placed.render_from_object().transpose().to_cols_array_2d();
        [x, y, z].map(|[a, b, c, _]| [a, b, c])
    });
    Some(LiftReport {
        corners: triangle.positions.map(<[f32; 3]>::from),
        normals: triangle.normals.map(<[f32; 3]>::from),
        weights: [1.0 - hit.u - hit.v, hit.u, hit.v],
        from_object,
        lift,
    })
}

pub(super) fn in_world(world: &World, point: [f32; 3]) -> [f64; 3] {
    (world.origin + Vec3::from_array(point).as_dvec3()).to_array()
}
