//! What a ray's hit means for the pixel: the step that every integrator is.
//!
//! An integrator turns one [`Path`] and its hit into contributions, shadow rays and further paths. Steps run in stages
//! over batches (see `render`): all paths of a batch are traced, then stepped, then their shadow rays are traced, and the
//! further paths are the next batch. Whitted's tree of rays thus grows breadth first, and the contributions to one
//! sample are added in one fixed order, whatever else is in the batch.

mod direct;
mod raycast;
mod shadow;
mod view;
mod whitted;

use lookfrom_bvh::{Hit, Ray};

use crate::hash;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;
use crate::world::World;

pub use raycast::Raycast;
pub use shadow::Shadow;
pub(crate) use shadow::resolve as resolve_shadows;
pub use view::View;
pub use whitted::Whitted;

/// How one ray's hit is turned into light.
pub trait Integrator: Sync {
    /// Adds to `next` what follows from `path` having met `hit`.
    fn step<P: Probe>(
        &self,
        world: &World,
        numbers: &Numbers<'_>,
        path: &Path,
        hit: &Hit,
        next: &mut Next<'_, P>,
    );
}

/// A ray on its way, and all that is remembered of where it came from.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// In render space; not of unit length: from the camera, `t = 1` is the image plane.
    pub ray: Ray,
    /// The share of the sample that light along this ray has.
    pub beta: Spectrum,
    /// Which sample of the batch.
    pub slot: u32,
    /// How many mirrors and refractions lie behind.
    pub depth: u32,
    /// Its place in the tree: 1 is the camera's ray, the mirrored child of n is 2n, the refracted one 2n + 1.
    pub address: u64,
    /// What it travels in.
    pub media: Media,
}

impl Path {
    /// The address of the root of the tree.
    pub const ROOT: u64 = 1;
}

/// The materials that a ray is inside of, the innermost last: at most four, of the first 65,535.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media(u64);

impl Media {
    /// After entering a material.
    pub fn entered(self, material: u32) -> Self {
        Self(self.0 << 16 | u64::from(material + 1).min(0xffff))
    }

    /// After leaving the innermost.
    pub fn left(self) -> Self {
        Self(self.0 >> 16)
    }

    /// The innermost material.
    pub fn innermost(self) -> Option<u32> {
        ((self.0 & 0xffff) as u32).checked_sub(1)
    }

    /// What is left of light after `distance` (Beer's law).
    pub fn transmittance(self, world: &World, distance: f32) -> Spectrum {
        let absorption =
            self.innermost().and_then(|index| world.materials.get(index as usize)).map(|m| m.absorption);
        match absorption {
            Some(absorption) if absorption != [0.0; 3] => {
                Spectrum::from_rgb(absorption.map(|sigma| libm::expf(-sigma * distance)))
            }
            _ => Spectrum::ONE,
        }
    }
}

/// Random numbers for one ray: a pure function of pixel, sample, seed and the ray's place in its tree.
#[derive(Clone, Copy, Debug)]
pub struct Numbers<'a> {
    /// Where they come from.
    pub sampler: &'a Sampler,
    /// Column and row of the pixel.
    pub pixel: [u32; 2],
    /// Which sample of the pixel.
    pub sample: u32,
    /// [`Path::address`].
    pub address: u64,
}

impl Numbers<'_> {
    /// Two numbers in `[0, 1)` for one purpose at this ray.
    pub fn two(&self, purpose: u32) -> [f32; 2] {
        self.sampler.two(self.pixel, self.sample, hash::pair(self.address, u64::from(purpose)) as u32)
    }
}

/// What a step leaves behind.
#[derive(Debug)]
pub struct Next<'a, P: Probe> {
    /// Light gathered so far, by slot.
    pub radiance: Vec<Spectrum>,
    /// To be traced next.
    pub paths: Vec<Path>,
    /// To be traced before that.
    pub shadows: Vec<Shadow>,
    /// Who listens.
    pub probe: &'a mut P,
}

impl<P: Probe> Next<'_, P> {
    /// Adds light to a path's sample.
    pub fn add(&mut self, path: &Path, term: Term, value: Spectrum) {
        if !value.is_black() {
            self.radiance[path.slot as usize] += value;
            self.probe.notice(|| Event::Add { address: path.address, term, value });
        }
    }
}

/// Why light is added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// The ray left the scene.
    Sky,
    /// The surface shines.
    Emission,
    /// `k_a I_a`.
    Ambient,
    /// A light, by its index, reached the surface.
    Light(u32),
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
pub enum Cut {
    /// It could no longer change the pixel.
    Contribution,
    /// The greatest depth was reached.
    Depth,
}

/// Something that happened on the way of a sample.
#[derive(Clone, Debug)]
pub enum Event {
    /// A path met `hit` (or nothing).
    Met {
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
        surface: Box<crate::surface::Surface>,
        /// The look, where the integrator asks for it.
        coefficients: Option<Box<crate::material::Coefficients>>,
    },
    /// A light was asked.
    Asked {
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
        /// The branch's share of its parent.
        weight: Spectrum,
        /// The part that Fresnel's equations mirror, where they are asked.
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

/// Who listens. `()` listens to nothing and compiles to nothing.
pub trait Probe {
    /// Something happened.
    fn notice(&mut self, event: impl FnOnce() -> Event);
}

impl Probe for () {
    fn notice(&mut self, _: impl FnOnce() -> Event) {}
}

impl Probe for Vec<Event> {
    fn notice(&mut self, event: impl FnOnce() -> Event) {
        self.push(event());
    }
}
