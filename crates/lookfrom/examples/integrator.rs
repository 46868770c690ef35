//! An integrator of one's own: direct lighting by one light for each sample, with alpha, media, AOVs and the surroundings as
//! the built-in ones have them.
//!
//! `cargo run --release -p lookfrom --example integrator -- scenes/hero.toml hero.png`

use std::error::Error;

use lookfrom::bvh::Hit;
use lookfrom::integrator::{Integrator, Path, Probe, SampleStream, StepOutput, Term};
use lookfrom::light::LightSampleContext;
use lookfrom::session::{Options, Session};
use lookfrom::shading::material::ShadingContext;
use lookfrom::world::World;

/// Numbers of the random numbers that a step takes.
mod dimension {
    pub(crate) const MATERIAL: u32 = 0;
    pub(crate) const LIGHT: u32 = 1;
}

/// The light that surfaces emit, and that they reflect or transmit from lights directly. Skies that are the same in all
/// directions are not sampled, and only seen.
#[derive(Debug)]
pub(crate) struct DirectLighting;

impl Integrator for DirectLighting {
    type State = ();

    fn name(&self) -> &'static str {
        "direct_lighting"
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        // The medium absorbs on the way; a path that leaves the scene sees the surroundings.
        let mut path = output.absorbed(world, path, hit);
        if !hit.is_hit() {
            return output.add_surroundings(world, &path);
        }

        // Holes, by alpha: the path goes on as if there were nothing.
        let surface = world.surface_at(&path.ray, hit, output.time(&path));
        if path.goes_through(world, &surface, stream.presence(world, &surface)) {
            return output.paths.push(path.passed(&surface));
        }

        // Light of the surface's own.
        let mode = output.mode(&path);
        if let Some(light) = surface.light {
            let emitted = world.emitted(&surface, &mode);
            output.add(&path, Term::Found { light, weight: 1.0 }, path.beta * emitted);
        }
        if let Some(radiance) = world.unlit(&surface, &mode) {
            output.add(&path, Term::Emission, path.beta * radiance);
        }

        // The material, as a function of directions. Where there is none, the surface only separates media.
        let [u, seed] = stream.two(dimension::MATERIAL);
        let mode = &mut output.queues.modes[path.slot as usize];
        let arrival = ShadingContext { mode, throughput: &mut path.beta, interior: path.interior, u, seed };
        let Some(shading) = world.shading(&surface, arrival) else {
            return output.paths.push(path.passed_interface(world, &surface));
        };
        output.leave_first_surface(world, &path, &surface, || None);

        // One of the lights, if nothing is in the way.
        let at = LightSampleContext {
            point: surface.point.position.into(),
            n: shading.n(),
            time: output.time(&path),
        };
        let u = stream.two_with_pixel(dimension::LIGHT);
        if let Some((light, sample)) = world.sample_light(&at, u, &output.mode(&path)) {
            let f = shading.f_toward(surface.wo)(sample.wi);
            let weight = shading.cos(sample.wi).abs() / sample.pdf;
            output.cast_shadow(world, &path, &surface, (light, &sample), path.beta * f * sample.li * weight);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(scene), Some(picture)) = (arguments.next(), arguments.next()) else {
        return Err("usage: integrator SCENE PICTURE.png".into());
    };
    let mut session = Session::open(&scene, &Options::default())?;
    session.set_integrator(DirectLighting);
    session.render(&())?.save(picture)?;
    Ok(())
}
