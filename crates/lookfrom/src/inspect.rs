//! What happened on the way of one sample: every matrix, every determinant, every root, the whole tree of rays.
//!
//! This is the render itself with a watcher listening: [`inspect`] traces the one sample through [`Frame::trace`], as a
//! tile would, and arranges what the watcher heard. What it shows adds up, bit for bit, to what the film received.
//! Points are shown in the world (not in render space).

mod candidate;
mod report;
mod svg;
mod text;

use std::collections::BTreeMap;

use glam::{DMat4, DVec3, DVec4, Vec3};
use lookfrom_bvh::{Hit, NONE};

use crate::integrator::{Branch, Cut, Event, Path, Shadow, Term};
use crate::material::Coefficients;
use crate::render::{Frame, SampleId};
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::world::World;

pub use candidate::{Candidate, Number, Test};
pub use report::{
    Addition, BranchReport, CameraSteps, CoefficientsReport, Inspection, LightReport, MatrixStep, MetReport,
    RayReport,
};
pub use svg::svg;

/// Follows one sample and reports all that happens on its way.
pub fn inspect(frame: &Frame<'_>, id: SampleId) -> Inspection {
    let world = frame.world();
    let mut events: Vec<Event> = Vec::new();
    let (traced, _) = frame.trace(&[id], &mut events);
    let traced = traced[0];

    let mut rays: BTreeMap<u64, RayReport> = BTreeMap::new();
    let mut sum = Spectrum::BLACK;
    let mut additions = Vec::new();
    for event in &events {
        match event {
            Event::Met { path, hit } => {
                rays.insert(path.address, ray_report(world, path, hit));
            }
            Event::Add { address, term, value } => {
                sum += *value;
                additions.push(Addition {
                    address: *address,
                    term: term_name(world, *term),
                    value: value.rgb(),
                });
                if let Some(ray) = rays.get_mut(address) {
                    add(&mut ray.added, value.rgb());
                    if let Term::Light(light) = term
                        && let Some(report) = ray.light_mut(*light)
                    {
                        add(&mut report.added, value.rgb());
                    }
                }
            }
            Event::Surface { address, surface, coefficients } => {
                if let Some(ray) = rays.get_mut(address) {
                    ray.met = Some(met_report(world, &ray.hit, surface, coefficients.as_deref()));
                }
            }
            Event::Asked { address, light, sample, diffuse, specular } => {
                if let Some(ray) = rays.get_mut(address) {
                    let intensity = sample.map(|sample| sample.li / (std::f32::consts::PI * sample.pdf));
                    ray.lights.push(LightReport {
                        index: *light,
                        light: world.names.lights[*light as usize].clone(),
                        wi: sample.map(|sample| sample.wi.to_array()),
                        intensity: intensity.unwrap_or_default().rgb(),
                        diffuse: diffuse.rgb(),
                        specular: specular.rgb(),
                        shadow_ray: None,
                        blockers: Vec::new(),
                        added: [0.0; 3],
                    });
                }
            }
            Event::Shadow { shadow, hit, passed } => {
                if let Some(ray) = rays.get_mut(&shadow.address)
                    && let Term::Light(light) = shadow.term
                    && let Some(report) = ray.light_mut(light)
                {
                    report.shadow(world, shadow, hit, *passed);
                }
            }
            Event::Shaded { address, surface, .. } => {
                if let Some(ray) = rays.get_mut(address) {
                    ray.met = Some(met_report(world, &ray.hit, surface, None));
                }
            }
            Event::AskedOne { .. } | Event::Bounced { .. } => {}
            Event::Grew { address, branch, weight, fresnel, total_reflection, cut } => {
                if let Some(ray) = rays.get_mut(address) {
                    let (kind, bit) = match branch {
                        Branch::Mirrored => ("mirrored", 0),
                        Branch::Refracted => ("refracted", 1),
                    };
                    ray.branches.push(BranchReport {
                        address: address << 1 | bit,
                        kind,
                        weight: weight.rgb(),
                        fresnel: *fresnel,
                        total_reflection: *total_reflection,
                        cut: cut.map(|cut| match cut {
                            Cut::Contribution => "can no longer change the pixel",
                            Cut::Depth => "the greatest depth is reached",
                        }),
                    });
                }
            }
        }
    }
    sum_up_subtrees(&mut rays);
    let film = frame.rgb(sum * traced.weight, &traced.lanes);
    Inspection {
        pixel: id.pixel,
        sample: id.sample,
        camera: camera_steps(frame, id),
        rays: rays.into_values().collect(),
        radiance: sum.rgb(),
        additions,
        weight: traced.weight,
        film: traced.rgb,
        adds_up: film.map(f32::to_bits) == traced.rgb.map(f32::to_bits),
    }
}

fn add(sum: &mut [f32; 3], value: [f32; 3]) {
    for (sum, value) in sum.iter_mut().zip(value) {
        *sum += value;
    }
}

/// Children have greater addresses than their parents: from the last to the first, each adds itself to its parent.
fn sum_up_subtrees(rays: &mut BTreeMap<u64, RayReport>) {
    let addresses: Vec<u64> = rays.keys().copied().collect();
    for address in addresses.into_iter().rev() {
        let Some(ray) = rays.get_mut(&address) else { continue };
        let (own, of_children) = (ray.added, ray.subtree);
        ray.subtree = std::array::from_fn(|c| own[c] + of_children[c]);
        let subtree = ray.subtree;
        if let Some(parent) = rays.get_mut(&(address >> 1)) {
            add(&mut parent.subtree, subtree);
        }
    }
}

fn ray_report(world: &World, path: &Path, hit: &Hit) -> RayReport {
    let kind = match (path.address, path.address & 1) {
        (Path::ROOT, _) => "camera",
        (_, 0) => "mirrored",
        _ => "refracted",
    };
    RayReport {
        address: path.address,
        kind,
        depth: path.depth,
        a: in_world(world, path.ray.origin),
        direction: path.ray.direction,
        share: path.beta.rgb(),
        candidates: candidate::candidates(world, &path.ray, hit),
        met: None,
        lights: Vec::new(),
        branches: Vec::new(),
        added: [0.0; 3],
        subtree: [0.0; 3],
        hit: *hit,
    }
}

fn met_report(world: &World, hit: &Hit, surface: &Surface, coefficients: Option<&Coefficients>) -> MetReport {
    MetReport {
        shape: world.names.shapes[surface.shape as usize].clone(),
        primitive: hit.primitive,
        instance: (hit.instance != NONE).then_some(hit.instance),
        t: hit.t,
        point: (world.origin + DVec3::from_array(surface.point.position)).to_array(),
        error: surface.point.error,
        ng: surface.ng.to_array(),
        n: surface.ns_facing().to_array(),
        uv: surface.uv.to_array(),
        front: surface.front,
        material: world.names.materials[surface.material as usize].clone(),
        coefficients: coefficients.map(|k| CoefficientsReport {
            ambient: k.ambient.rgb(),
            diffuse: k.diffuse.rgb(),
            specular: k.specular.rgb(),
            shininess: k.shininess,
            mirror: k.mirror.rgb(),
            transmission: k.transmission.rgb(),
            ior: k.ior,
        }),
    }
}

impl LightReport {
    fn shadow(&mut self, world: &World, shadow: &Shadow, hit: &Hit, passed: Spectrum) {
        let [origin, direction] =
            [shadow.ray.origin, shadow.ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        // t = 1 was the light when the ray began; behind a transparent surface less is left of it
        let end = origin + direction * f64::from(shadow.ray.t_max.min(1.0));
        let start = self.shadow_ray.map_or((world.origin + origin).to_array(), |[start, _]| start);
        self.shadow_ray = Some([start, (world.origin + end).to_array()]);
        if hit.is_hit() {
            let surface = world.surface(&shadow.ray, hit);
            self.blockers.push((world.names.shapes[surface.shape as usize].clone(), passed.rgb()));
        }
    }
}

fn term_name(world: &World, term: Term) -> String {
    match term {
        Term::Sky => "sky".into(),
        Term::Emission => "emission".into(),
        Term::Ambient => "ambient".into(),
        Term::View => "view".into(),
        Term::Found { light, .. } => world.names.lights[light as usize].clone(),
        Term::Unoccluded => "open sky".into(),
        Term::Light(light) => world.names.lights[light as usize].clone(),
    }
}

fn in_world(world: &World, point: [f32; 3]) -> [f64; 3] {
    (world.origin + Vec3::from_array(point).as_dvec3()).to_array()
}

fn camera_steps(frame: &Frame<'_>, id: SampleId) -> CameraSteps {
    let camera = &frame.world().camera;
    let (ray, _) = frame.camera_ray(id);
    let rows = |matrix: &DMat4| matrix.transpose().to_cols_array_2d();
    let mut product = DMat4::IDENTITY;
    let mut step = |name, does, matrix: &DMat4, point: DVec4| {
        product = *matrix * product;
        MatrixStep { name, does, matrix: rows(matrix), product: rows(&product), point: point.to_array() }
    };
    let steps = vec![
        step(
            "T1",
            "the middle of the image to the axis, the image plane to the distance d",
            &camera.t1,
            ray.after_t1,
        ),
        step("S2", "pixels to lengths; x turned round, since u points to the left", &camera.s2, ray.after_s2),
        step("R3", "view to world, around the eye: [u v w]", &camera.r3, ray.after_r3),
        step("T4", "the eye to lookfrom", &camera.t4, ray.p_world.extend(1.0)),
    ];
    let [u, v, w] =
        [camera.r3.x_axis, camera.r3.y_axis, camera.r3.z_axis].map(|axis| axis.truncate().to_array());
    let a = camera.lookfrom() + ray.a_from_eye;
    CameraSteps {
        lookfrom: camera.lookfrom().to_array(),
        u,
        v,
        w,
        p_k: ray.p_k.to_array(),
        steps,
        p_world: ray.p_world.to_array(),
        a: a.to_array(),
        b: if camera.lens.is_some() { a + ray.direction } else { ray.p_world }.to_array(),
        direction: ray.direction.to_array(),
        lens: camera.lens.is_some(),
    }
}
