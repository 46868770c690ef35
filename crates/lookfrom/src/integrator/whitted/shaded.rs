//! Shaded hits, up to eight side by side: their ambient light, the light of sources and the branches of the tree.

use lookfrom_bvh::Ray;

use super::told::Told;
use crate::core::lanes::LANES;
use crate::core::spectrum::Spectrum;
use crate::integrator::wavefront::LightSamples;

/// The results of a step, by lane: memory that is reused.
#[derive(Debug)]
pub(in crate::integrator) struct Shaded {
    /// `k_a I_a` times the throughput.
    pub(super) ambient: [Spectrum; LANES],
    /// The samples of the light under way.
    pub(super) samples: LightSamples,
    /// The lights that illuminate any of them, in the order of the world's, and memory for others.
    pub(super) lights: Vec<FromLight>,
    /// Number of those that count.
    pub(super) light_count: usize,
    /// The reflected rays, and the refracted ones.
    pub(super) branches: [BranchRays; 2],
    /// Bit i for lane i: whether the ray hit the outside.
    pub(super) front: u32,
    /// Events for a probe.
    pub(super) told: Option<Told>,
}

/// The rays of a branch of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct BranchRays {
    /// Bit i for lane i: whether there is a ray at all.
    pub(super) exist: u32,
    /// The throughputs of the paths that go on.
    pub(super) beta: [Spectrum; LANES],
    pub(super) rays: [Ray; LANES],
}

/// The light of one source.
#[derive(Clone, Copy, Debug)]
pub(super) struct FromLight {
    pub(super) light: u32,
    /// Bit i for lane i: whether it contributes light, unless it is occluded.
    pub(super) lit: u32,
    pub(super) contribution: [Spectrum; LANES],
    /// The shares of diffuse reflection, where layers need them.
    pub(super) diffuse: [Spectrum; LANES],
    /// To the light.
    pub(super) rays: [Ray; LANES],
}

impl BranchRays {
    const NONE: Self =
        Self { exist: 0, beta: [Spectrum::BLACK; LANES], rays: [Ray::new([0.0; 3], [0.0; 3]); LANES] };
}

impl FromLight {
    pub(super) const NONE: Self = Self {
        light: 0,
        lit: 0,
        contribution: [Spectrum::BLACK; LANES],
        diffuse: [Spectrum::BLACK; LANES],
        rays: [Ray::new([0.0; 3], [0.0; 3]); LANES],
    };
}

impl Default for Shaded {
    fn default() -> Self {
        Self {
            ambient: [Spectrum::BLACK; LANES],
            samples: LightSamples::default(),
            lights: Vec::new(),
            light_count: 0,
            branches: [BranchRays::NONE; 2],
            front: 0,
            told: None,
        }
    }
}
