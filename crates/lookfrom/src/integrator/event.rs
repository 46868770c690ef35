//! Events in the computation of a sample, for probes such as the inspector.

use glam::Vec3;
use lookfrom_bvh::Hit;

use crate::core::spectrum::Spectrum;
use crate::integrator::{Flight, Path, PreviousVertex, Shadow, SubsurfaceProbe};
use crate::medium::Tracking;
use crate::shading::bsdf::BsdfSample;
use crate::shading::bsdf::phase::Phase;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::material::Shading;

/// The reason why light is added.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Term {
    /// The ray left the scene.
    Sky,
    /// The surface emits light.
    Emission,
    /// The medium on the way emits light.
    Medium,
    /// `k_a I_a`.
    Ambient,
    /// A light, by its index, reached the surface.
    Light(u32),
    /// A path hit a light by its own direction.
    Found {
        /// Index of the light.
        light: u32,
        /// Its multiple importance sampling weight.
        weight: f32,
    },
    /// Ambient occlusion: nothing is near.
    Unoccluded,
    /// A view's false colour.
    View,
}

/// A branch of Whitted's tree of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Reflected: `S`.
    Mirrored,
    /// Refracted: `T`.
    Refracted,
}

/// The reason why a branch was not followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cut {
    /// Its throughput is below `min_contribution`.
    Contribution,
    /// The maximum depth was reached.
    Depth,
}

/// A step in the computation of a sample.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Event {
    /// A path was traced.
    Hit {
        /// The path.
        path: Path<PreviousVertex>,
        /// Its hit, or a miss.
        hit: Hit,
    },
    /// A medium absorbed light on the way to the hit.
    Absorbed {
        /// Address of the path.
        address: u64,
        /// The media that the path is inside of.
        interior: InteriorStack,
        /// Length of the way; infinite for a miss.
        length: f32,
        /// Beer's factor.
        transmittance: Spectrum,
        /// The throughput after it.
        beta: Spectrum,
    },
    /// A path has travelled in a homogeneous medium that scatters.
    Flown {
        /// Address of the path.
        address: u64,
        /// Free flight, with the throughput at its end.
        flight: Box<Flight>,
        /// The point where it is scattered, if it is.
        point: Option<Vec3>,
    },
    /// A path has travelled in a medium that varies.
    Tracked {
        /// Address of the path.
        address: u64,
        /// Its collisions, with the throughput at their end.
        tracking: Box<Tracking>,
        /// The point where it is scattered, if it is.
        point: Option<Vec3>,
    },
    /// A direction was sampled by a medium's phase function; the path goes on, or Russian roulette ends it.
    ScatteredInMedium {
        /// Address of the path that is scattered.
        address: u64,
        /// The direction.
        sample: PhaseSample,
    },
    /// A path has entered a medium below a surface; the point where it leaves was looked for.
    Probed {
        /// Address of the path that has arrived at the surface. The one that leaves follows it, as if it had come along the
        /// line that was searched.
        address: u64,
        /// The search.
        probe: Box<SubsurfaceProbe>,
    },
    /// The surface that was hit was evaluated.
    Surface {
        /// Address of the path.
        address: u64,
        /// The surface interaction.
        surface: Box<SurfaceInteraction>,
        /// Whitted's coefficients, where the integrator evaluates them.
        coefficients: Option<Box<crate::shading::bsdf::whitted::WhittedCoefficients>>,
    },
    /// A light was sampled, in Whitted's model.
    LocalLight {
        /// Address of the path.
        address: u64,
        /// Index of the light.
        light: u32,
        /// The light sample; `None` when no light can come from there.
        sample: Option<crate::light::LightSample>,
        /// `k_d (N·L)`.
        diffuse: Spectrum,
        /// `k_s (N·H)ⁿ`.
        specular: Spectrum,
    },
    /// A path's hit is shaded by a BSDF.
    Shaded {
        /// Address of the path.
        address: u64,
        /// The surface interaction.
        surface: Box<SurfaceInteraction>,
        /// Its BSDF in its shading frame.
        shading: Box<Shading>,
        /// The path throughput here, after absorption on the way.
        beta: Spectrum,
    },
    /// A path hit a light by its own direction.
    Found {
        /// Address of the path.
        address: u64,
        /// Index of the light.
        light: u32,
        /// Radiance toward the ray's origin.
        radiance: Spectrum,
        /// The density of this direction in light sampling.
        light_pdf: f32,
        /// The multiple importance sampling weight.
        weight: f32,
        /// The path throughput there, after absorption on the way.
        beta: Spectrum,
    },
    /// A light was sampled and contributes nothing.
    LightSampleFailed {
        /// Address of the path.
        address: u64,
        /// Index of the light.
        light: u32,
        /// The probability of choosing this light.
        probability: f32,
        /// The light sample, which the BSDF does not scatter toward the viewer; `None` when no light can come from
        /// there.
        sample: Option<crate::light::LightSample>,
    },
    /// One light of many was sampled.
    LightSampled {
        /// Address of the path.
        address: u64,
        /// Index of the light.
        light: u32,
        /// The probability of choosing this light.
        probability: f32,
        /// The light sample.
        sample: crate::light::LightSample,
        /// The BSDF times the cosine.
        f: Spectrum,
        /// The density of this direction in BSDF sampling.
        bsdf_pdf: f32,
        /// The multiple importance sampling weight.
        weight: f32,
    },
    /// The BSDF was sampled; the path goes on, or Russian roulette ends it.
    Bounced {
        /// Address of the path that arrives.
        address: u64,
        /// The sampled direction and its weights.
        bounce: Box<Bounce>,
    },
    /// A shadow ray was traced.
    Shadow {
        /// The ray, with its contribution as it was before this hit.
        shadow: Shadow,
        /// Its hit, or a miss.
        hit: Hit,
        /// Transmittance: black when blocked, one when nothing was hit.
        passed: Spectrum,
    },
    /// The tree may grow.
    Grew {
        /// Address of the path that branches.
        address: u64,
        /// The branch.
        branch: Branch,
        /// Its direction, unit length, whether it is followed or not.
        direction: Vec3,
        /// The branch's weight relative to its parent.
        weight: Spectrum,
        /// Fresnel reflectance, where it is evaluated.
        fresnel: Option<f32>,
        /// Whether total internal reflection sent all light into the reflected branch.
        total_reflection: bool,
        /// The reason why the branch was not followed, if it was not.
        cut: Option<Cut>,
    },
    /// Light was added to the sample.
    Add {
        /// Address of the path.
        address: u64,
        /// The reason.
        term: Term,
        /// The light that was added.
        value: Spectrum,
    },
}

/// The continuation of a path: a BSDF sample and the outcome of Russian roulette.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// In render space.
    pub wi: Vec3,
    /// Cosine of `wi` and the shading normal.
    pub cos: f32,
    /// The BSDF sample.
    pub sample: BsdfSample,
    /// The path throughput after the bounce, before Russian roulette.
    pub beta: Spectrum,
    /// The survival probability of Russian roulette.
    pub survival: f32,
    /// Whether the path goes on.
    pub survives: bool,
}

/// The continuation of a path by the phase function of a medium.
#[derive(Clone, Copy, Debug)]
pub struct PhaseSample {
    /// The phase function.
    pub phase: Phase,
    /// Whether the direction is of Draine's lobe, where the phase function has two.
    pub is_draine: bool,
    /// In render space.
    pub wi: Vec3,
    /// The phase function in that direction, which is also its density.
    pub pdf: f32,
    /// The path throughput, before Russian roulette.
    pub beta: Spectrum,
    /// The survival probability of Russian roulette.
    pub survival: f32,
    /// Whether the path goes on.
    pub survives: bool,
}

/// A listener to the events of samples. `()` ignores all events and compiles to nothing.
pub trait Probe {
    /// Whether the probe uses events at all.
    const LISTENS: bool = true;

    /// Called for each event.
    fn notice(&mut self, event: impl FnOnce() -> Event);

    /// Called for an event that may turn out not to exist.
    fn notice_some(&mut self, event: impl FnOnce() -> Option<Event>) {
        if Self::LISTENS
            && let Some(event) = event()
        {
            self.notice(|| event);
        }
    }
}

impl Probe for () {
    const LISTENS: bool = false;

    fn notice(&mut self, _: impl FnOnce() -> Event) {}
}

impl Probe for Vec<Event> {
    fn notice(&mut self, event: impl FnOnce() -> Event) {
        self.push(event());
    }
}
