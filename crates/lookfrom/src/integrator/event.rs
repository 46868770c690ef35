//! Events of a sample, for probes such as the inspector.

use glam::Vec3;
use lookfrom_bvh::Hit;

use crate::core::spectrum::Spectrum;
use crate::integrator::{Path, Shadow};
use crate::shading::bsdf::BsdfSample;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::Shading;

/// Why light is added.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Term {
    /// The ray left the scene.
    Sky,
    /// The surface emits light.
    Emission,
    /// `k_a I_a`.
    Ambient,
    /// A light, by its index, reached the surface.
    Light(u32),
    /// A path found a light by itself.
    Found {
        /// Its index.
        light: u32,
        /// The share that this way of finding it has.
        weight: f32,
    },
    /// Nothing is near.
    Unoccluded,
    /// A view's false colour.
    View,
}

/// Which way a path goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Toward `S`.
    Mirrored,
    /// Toward `T`.
    Refracted,
}

/// Why a branch was not followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cut {
    /// It could no longer change the pixel.
    Contribution,
    /// The greatest depth was reached.
    Depth,
}

/// Something that happened on the way of a sample.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Event {
    /// A path met `hit` (or nothing).
    Hit {
        /// The path.
        path: Path,
        /// What it met.
        hit: Hit,
    },
    /// What was met has these properties.
    Surface {
        /// Of the path.
        address: u64,
        /// The place.
        surface: Box<SurfaceInteraction>,
        /// Whitted's coefficients, where the integrator evaluates them.
        coefficients: Option<Box<crate::shading::material::Coefficients>>,
    },
    /// A light was sampled, in Whitted's model.
    LocalLight {
        /// Of the path.
        address: u64,
        /// Which.
        light: u32,
        /// What it said; `None` when no light can come from there.
        sample: Option<crate::light::LightSample>,
        /// `k_d (N·L)`.
        diffuse: Spectrum,
        /// `k_s (N·H)ⁿ`.
        specular: Spectrum,
    },
    /// A path is shaded by a scattering function.
    Shaded {
        /// Of the path.
        address: u64,
        /// The place.
        surface: Box<SurfaceInteraction>,
        /// What it does with light.
        shading: Box<Shading>,
        /// The path throughput here, after what was absorbed on the way.
        beta: Spectrum,
    },
    /// A path's own direction found a light.
    Found {
        /// Of the path.
        address: u64,
        /// Which.
        light: u32,
        /// What it sends this way.
        radiance: Spectrum,
        /// The density with which light sampling would have chosen the direction.
        light_pdf: f32,
        /// The share that this way of finding the light has.
        weight: f32,
        /// The path throughput there, after what was absorbed on the way.
        beta: Spectrum,
    },
    /// The sample of one light brings nothing.
    LightSampleFailed {
        /// Of the path.
        address: u64,
        /// Which.
        light: u32,
        /// The probability of having chosen it.
        probability: f32,
        /// What it said, of which the material sends nothing on; `None` when no light can come from there.
        sample: Option<crate::light::LightSample>,
    },
    /// One light of many was sampled.
    LightSampled {
        /// Of the path.
        address: u64,
        /// Which.
        light: u32,
        /// The probability of having chosen it.
        probability: f32,
        /// What it said.
        sample: crate::light::LightSample,
        /// The scattering function times the cosine.
        f: Spectrum,
        /// The density with which the material would have chosen the direction.
        bsdf_pdf: f32,
        /// The share that this way of finding the light has.
        weight: f32,
    },
    /// A path goes on, or would have.
    Bounced {
        /// Of the path that arrives.
        address: u64,
        /// How.
        bounce: Box<Bounce>,
    },
    /// A shadow ray met something (or nothing).
    Shadow {
        /// The ray, with its contribution as it was before this meeting.
        shadow: Shadow,
        /// What it met.
        hit: Hit,
        /// What was let through: black when blocked, one when nothing was met.
        passed: Spectrum,
    },
    /// The tree may grow.
    Grew {
        /// Of the path that branches.
        address: u64,
        /// Which way.
        branch: Branch,
        /// The branch's weight relative to its parent.
        weight: Spectrum,
        /// The part that Fresnel's equations mirror, where they are evaluated.
        fresnel: Option<f32>,
        /// Whether total reflection sent all into the mirrored branch.
        total_reflection: bool,
        /// Why it was not followed, if so.
        cut: Option<Cut>,
    },
    /// Light was added to the sample.
    Add {
        /// Of the path.
        address: u64,
        /// Why.
        term: Term,
        /// How much.
        value: Spectrum,
    },
}

/// How a path goes on.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// In render space.
    pub wi: Vec3,
    /// To the shading normal.
    pub cos: f32,
    /// What the scattering function chose.
    pub sample: BsdfSample,
    /// The path throughput of light from there, before Russian roulette.
    pub beta: Spectrum,
    /// The probability of going on.
    pub survival: f32,
    /// Whether it goes on.
    pub survives: bool,
}

/// A listener to the events of samples. `()` listens to nothing and compiles to nothing.
pub trait Probe {
    /// Whether it wants to hear anything.
    const LISTENS: bool = true;

    /// Something happened.
    fn notice(&mut self, event: impl FnOnce() -> Event);

    /// Something may have happened.
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
