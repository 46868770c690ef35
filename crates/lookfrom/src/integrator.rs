//! What a ray's hit means for the pixel: the step that every integrator is.
//!
//! An integrator turns one [`Path`] and its hit into contributions, shadow rays and further paths. Steps run in stages
//! over batches (see `render`): all paths of a batch are traced, then stepped, then their shadow rays are traced, and the
//! further paths are the next batch. Whitted's tree of rays thus grows breadth first, and the contributions to one
//! sample are added in one fixed order, whatever else is in the batch.

mod direct;
mod occlusion;
mod path;
mod raycast;
mod shadow;
mod view;
mod whitted;

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};
use lookfrom_scene::material::MaterialKind;
use lookfrom_scene::medium::Sides;

use crate::bsdf::BsdfSample;
use crate::hash;
use crate::light::Reference;
use crate::material::{Material, Shading};
use crate::sampler::PixelSampler;
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::texture::{Lanes, TexturePoint, Usage};
use crate::world::World;

pub use occlusion::AmbientOcclusion;
pub use path::{Departure, PathTracer, Wisdom};
pub use raycast::Raycast;
pub use shadow::Shadow;
pub(crate) use shadow::{Passing, resolve as resolve_shadows};
pub use view::View;
pub use whitted::Whitted;

/// How one ray's hit is turned into light.
pub trait Integrator: Sync {
    /// Adds to `next` what follows from `path` having met `hit`.
    fn step<P: Probe>(
        &self,
        world: &World,
        numbers: &Numbers,
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
    /// How many mirrors, refractions and bounces lie behind.
    pub depth: u32,
    /// Its place among the rays of its sample: 1 is the camera's. In Whitted's tree the mirrored child of n is 2n, the
    /// refracted one 2n + 1; along a path the next ray of n is n + 1.
    pub address: u64,
    /// What it travels in.
    pub media: Media,
    /// What it remembers of the surface that it left.
    pub departure: Departure,
}

impl Path {
    /// The address of the root of the tree.
    pub const ROOT: u64 = 1;

    /// Where it left from, as lights are asked there.
    fn reference(&self) -> Reference {
        Reference { point: self.departure.point.as_dvec3(), n: self.departure.n }
    }

    /// The same path behind a surface that is not there.
    fn passed(&self, surface: &Surface) -> Self {
        let direction = Vec3::from_array(self.ray.direction);
        let ray = Ray::new(surface.origin(direction), self.ray.direction);
        Self { ray, address: self.address + 1, ..*self }
    }
}

/// What a ray is inside of, the innermost last: at most four bodies, whose media are among the first 65,534.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media(u64);

/// A body of which nothing is absorbed.
const CLEAR: u64 = 0xffff;

impl Media {
    /// After entering a body that is filled with a medium, or with none.
    pub fn entered(self, medium: Option<u32>) -> Self {
        let medium = medium.map_or(CLEAR, |medium| u64::from(medium) + 1);
        Self(self.0 << 16 | medium.min(CLEAR))
    }

    /// After leaving the innermost.
    pub fn left(self) -> Self {
        Self(self.0 >> 16)
    }

    /// The innermost medium.
    pub fn innermost(self) -> Option<u32> {
        let innermost = self.0 & 0xffff;
        (innermost != 0 && innermost != CLEAR).then(|| innermost as u32 - 1)
    }

    /// After going through a surface: to what it says is on its other side, or else in or out of the body that its
    /// material is.
    pub fn crossed(self, world: &World, surface: &Surface) -> Self {
        if let Some(Sides { inside, outside }) = surface.sides {
            let beyond = if surface.front { inside } else { outside };
            return beyond.map_or(Self::default(), |medium| Self::default().entered(Some(medium.0)));
        }
        match (&world.materials[surface.material as usize], surface.front) {
            (Material { kind: MaterialKind::Whitted(_), medium, .. }, true) => self.entered(*medium),
            (Material { kind: MaterialKind::Whitted(_), .. }, false) => self.left(),
            _ => self,
        }
    }

    /// What is left of light after `distance` (Beer's law).
    pub fn transmittance(self, world: &World, distance: f32, lanes: &Lanes) -> Spectrum {
        let Some(medium) = self.innermost().and_then(|index| world.media.get(index as usize)) else {
            return lanes.one();
        };
        let sigma =
            world.textures.spectrum(medium.absorption, Usage::Unbounded, &TexturePoint::NOWHERE, lanes);
        let length = medium.scale * distance;
        lanes.one() * sigma.map(|sigma| libm::expf(-sigma * length))
    }
}

/// Random numbers for one ray: a pure function of pixel, sample, seed and the ray's place in its tree.
#[derive(Clone, Copy, Debug)]
pub struct Numbers {
    /// Where they come from: the pixel's.
    pub sampler: PixelSampler,
    /// Which sample of the pixel.
    pub sample: u32,
    /// [`Path::address`].
    pub address: u64,
}

impl Numbers {
    /// Two numbers in `[0, 1)` for one purpose at this ray.
    pub fn two(&self, purpose: u32) -> [f32; 2] {
        self.sampler.two(self.sample, hash::pair(self.address, u64::from(purpose)) as u32)
    }
}

/// The samples of a batch under way.
#[derive(Debug, Default)]
pub struct Samples {
    /// Light gathered so far, by slot.
    pub radiance: Vec<Spectrum>,
    /// What the lanes mean, by slot.
    pub lanes: Vec<Lanes>,
    /// To be traced next.
    pub paths: Vec<Path>,
    /// To be traced before that.
    pub shadows: Vec<Shadow>,
    /// The rays of `shadows`, and whether they are blocked: memory.
    rays: Vec<Ray>,
    blocked: Vec<bool>,
}

impl Samples {
    /// Forgets all samples.
    pub fn clear(&mut self) {
        self.radiance.clear();
        self.lanes.clear();
        self.paths.clear();
        self.shadows.clear();
    }

    /// One sample more, in the next slot.
    pub fn start(&mut self, lanes: Lanes) {
        self.radiance.push(Spectrum::BLACK);
        self.lanes.push(lanes);
    }
}

/// What a step leaves behind, and who listens.
#[derive(Debug)]
pub struct Next<'a, P: Probe> {
    /// The samples that steps add to.
    pub samples: Samples,
    /// Who listens.
    pub probe: &'a mut P,
}

impl<P: Probe> Next<'_, P> {
    /// What the lanes of a path mean.
    fn lanes(&self, path: &Path) -> Lanes {
        self.samples.lanes[path.slot as usize]
    }

    /// Adds light to a path's sample.
    pub fn add(&mut self, path: &Path, term: Term, value: Spectrum) {
        self.add_to(path.slot, path.address, term, value);
    }

    fn add_to(&mut self, slot: u32, address: u64, term: Term, value: Spectrum) {
        if !value.is_black() {
            self.samples.radiance[slot as usize] += value;
            self.probe.notice(|| Event::Add { address, term, value });
        }
    }
}

/// Why light is added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// The ray left the scene.
    Sky,
    /// The surface shines.
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
        surface: Box<Surface>,
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
    /// A path is shaded by a scattering function.
    Shaded {
        /// Of the path.
        address: u64,
        /// The place.
        surface: Box<Surface>,
        /// What it does with light.
        shading: Box<Shading>,
        /// The path's share here, after what was absorbed on the way.
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
        /// The density with which asking lights would have chosen the direction.
        light_pdf: f32,
        /// The share that this way of finding the light has.
        weight: f32,
    },
    /// One light of many was asked in vain.
    AskedInVain {
        /// Of the path.
        address: u64,
        /// Which.
        light: u32,
        /// The probability of having chosen it.
        probability: f32,
        /// What it said, of which the material sends nothing on; `None` when no light can come from there.
        sample: Option<crate::light::LightSample>,
    },
    /// One light of many was asked.
    AskedOne {
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

/// How a path goes on.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// In render space.
    pub wi: Vec3,
    /// To the shading normal.
    pub cos: f32,
    /// What the scattering function chose.
    pub sample: BsdfSample,
    /// The share of the sample that light from there has, before the roulette.
    pub beta: Spectrum,
    /// The probability of going on.
    pub survival: f32,
    /// Whether it goes on.
    pub survives: bool,
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
