//! Ray casting (Appel 1968): the nearest surface, local shading, one shadow ray to each light, no recursion.

use lookfrom_bvh::Hit;

use crate::integrator::wavefront::HitBatch;
use crate::integrator::whitted::{self, Shaded};
use crate::integrator::{
    BatchStreams, Integrator, Path, Probe, SampleStream, ShadowTransparency, StepOutput,
};
use crate::world::World;

/// Ray casting.
#[derive(Clone, Copy, Debug)]
pub struct Raycast {
    /// Whether shadow rays pass transparent materials, coloured by them.
    pub transparent_shadows: bool,
}

impl Integrator for Raycast {
    type State = ();

    fn name(&self) -> &'static str {
        "raycast"
    }

    fn shadow_transparency(&self) -> ShadowTransparency {
        ShadowTransparency::of_whitted(self.transparent_shadows)
    }

    fn step_all<P: Probe>(
        &self,
        world: &World,
        streams: &BatchStreams<'_>,
        paths: &[Path],
        hits: &[Hit],
        output: &mut StepOutput<'_, P>,
    ) {
        whitted::step_all(None, &HitBatch { world, streams, paths, hits }, output);
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        whitted::step(None, world, stream, (path, hit), &mut Shaded::default(), output);
    }
}
