//! Path tracing (Kajiya 1986): from each surface on in one direction, chosen by its material, and at each surface one
//! light is asked. Both ways of finding light share it by multiple importance sampling (Veach & Guibas 1995, the power
//! heuristic), and paths that carry little are ended by chance (Russian roulette, Arvo & Kirk 1990). The order of
//! things is pbrt-v4's, so that the same scene converges to the same picture.

mod eight;

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, OriginPrimitive, Ray};
use lookfrom_simd::{dispatch, level};

use eight::{Plain, Steps};

use crate::bsdf::BsdfSample;
use crate::eight::LANES;
use crate::integrator::{
    Bounce, Catcher, Event, Integrator, Next, Numbers, Path, Probe, Samples, Shadow, Term,
};
use crate::light::{Coverage, Reference};
use crate::material::{Arrival, Toward};
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::world::World;

/// Purposes of random numbers at a surface.
mod purpose {
    /// Whether the surface is there; which of two mixed materials is, which colour goes on.
    pub(super) const PRESENCE: u32 = 0;
    /// Which light, which lobe.
    pub(super) const CHOICE: u32 = 1;
    /// Where on the light.
    pub(super) const LIGHT: u32 = 2;
    /// Which direction.
    pub(super) const DIRECTION: u32 = 3;
    /// Whether the path goes on.
    pub(super) const ROULETTE: u32 = 4;
}

/// No path is ended by chance before it has bounced more often than this: what the first bounces find is most of the
/// picture, and their noise most of the noise. (pbrt-v4 begins after the first; the light is the same.)
const SAFE_BOUNCES: u32 = 4;

/// How much of what is known about light is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wisdom {
    /// Lights and materials are sampled together.
    Combined,
    /// Lights are asked, and found by chance only where nothing else can: pbrt's `simplepath`.
    Separate,
    /// Nothing is asked; directions are uniform all around: pbrt's `randomwalk`.
    None,
}

/// Path tracing.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer {
    /// How many times a path may be scattered.
    pub depth: u32,
    /// Whether sharp lobes are blurred after the first bounce that is not sharp.
    pub regularize: bool,
    /// What is used of what is known.
    pub wisdom: Wisdom,
}

/// What a path remembers of the surface that it left.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Density over solid angle of the direction that it took; infinite where that was the only one, or from the camera.
    pub pdf: f32,
    /// The triangle there.
    pub left: OriginPrimitive,
    /// Where, in render space.
    pub point: Vec3,
    /// Shading normal there.
    pub n: Vec3,
    /// Product of η² of what it has entered: radiance is not lost where it is only squeezed.
    pub eta_scale: f32,
    /// Whether any bounce so far was not a mirror's.
    pub blurred: bool,
}

impl Default for Departure {
    fn default() -> Self {
        Self {
            pdf: f32::INFINITY,
            left: OriginPrimitive::NONE,
            point: Vec3::ZERO,
            n: Vec3::Z,
            eta_scale: 1.0,
            blurred: false,
        }
    }
}

impl Integrator for PathTracer {
    fn name(&self) -> &'static str {
        match self.wisdom {
            Wisdom::Combined => "path",
            Wisdom::Separate => "simple_path",
            Wisdom::None => "random_walk",
        }
    }

    fn catcher(&self) -> Catcher {
        if self.wisdom == Wisdom::Combined { Catcher::ControlVariate } else { Catcher::Shaded }
    }

    fn step_all<P: Probe>(
        &self,
        world: &World,
        numbers: impl Fn(&Path) -> Numbers,
        paths: &[Path],
        hits: &[Hit],
        next: &mut Next<'_, P>,
    ) {
        let in_lanes = !P::LISTENS && self.wisdom == Wisdom::Combined;
        let mut waiting: Vec<Plain<'_>> = Vec::with_capacity(LANES);
        for (path, hit) in paths.iter().zip(hits) {
            let lanes = next.lanes(path);
            let plain =
                if in_lanes { Plain::of(self, world, path, hit, &lanes, || numbers(path)) } else { None };
            let Some(plain) = plain else {
                next.probe.notice(|| Event::Met { path: *path, hit: *hit });
                self.step(world, &numbers(path), path, hit, next);
                continue;
            };
            waiting.push(plain);
            if waiting.len() == LANES {
                self.step_plain(world, &waiting, &mut next.samples);
                waiting.clear();
            }
        }
        self.step_plain(world, &waiting, &mut next.samples);
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        numbers: &Numbers,
        path: &Path,
        hit: &Hit,
        next: &mut Next<'_, P>,
    ) {
        // Absorb on the way.
        let mut path = path.absorbed(world, hit, &next.lanes(path));

        // A path that leaves the scene sees the sky.
        if !hit.is_hit() {
            self.add_sky(world, &path, next);
            return;
        }
        let surface = world.surface(&path.ray, hit);

        // Light passes where the surface is not there.
        let [presence, u] = match world.is_chancy(&surface) {
            true => numbers.two(purpose::PRESENCE),
            false => [0.0; 2],
        };
        if path.goes_through(world, &surface, presence) {
            next.samples.paths.push(path.passed(&surface));
            return;
        }

        // Add what the surface itself shines.
        self.add_emission(world, &path, &surface, next);
        if let Some(radiance) = world.unlit(&surface, &next.lanes(&path)) {
            next.add(&path, Term::Emission, path.beta * radiance);
        }

        // What it does with light; dispersion leaves one wavelength, or one colour.
        let lanes = &mut next.samples.lanes[path.slot as usize];
        let arrival = Arrival { lanes, share: &mut path.beta, media: path.media, u };
        let Some(mut shading) = world.shading(&surface, arrival) else {
            let direction = Vec3::from_array(path.ray.direction);
            let media = path.media.leaving(&world.materials, &surface, direction, true);
            next.samples.paths.push(Path { media, ..path.passed(&surface) });
            return;
        };
        if self.regularize && path.departure.blurred {
            shading.bsdf.regularize();
        }
        next.probe.notice(|| Event::Shaded {
            address: path.address,
            surface: Box::new(surface),
            shading: Box::new(shading),
            beta: path.beta,
        });
        if path.depth >= self.depth {
            return;
        }

        shading.toward(surface.wo, |toward| self.scatter(world, numbers, &path, &surface, toward, next));
    }
}

impl PathTracer {
    /// Steps of paths that met the commonest surfaces, eight at a time.
    fn step_plain(&self, world: &World, plain: &[Plain<'_>], next: &mut Samples) {
        let Some(last) = plain.last() else { return };
        let eight: [Plain<'_>; LANES] = std::array::from_fn(|lane| *plain.get(lane).unwrap_or(last));
        let steps = Steps { tracer: self, world, plain: &eight, count: plain.len(), samples: next };
        dispatch(level(), steps);
    }

    /// What light does at a surface: from one lamp, and from one direction.
    fn scatter<P: Probe>(
        &self,
        world: &World,
        numbers: &Numbers,
        path: &Path,
        surface: &Surface,
        toward: &Toward<'_>,
        next: &mut Next<'_, P>,
    ) {
        let shading = toward.shading;

        // Ask one light.
        let [which_light, which_lobe] = numbers.two(purpose::CHOICE);
        if self.wisdom != Wisdom::None && shading.bsdf.lobes().is_non_specular() {
            let u = numbers.two(purpose::LIGHT);
            self.ask_light(world, path, (surface, toward), which_light, u, next);
        }

        // Go on in one direction.
        let u = numbers.two(purpose::DIRECTION);
        let Some(sample) = self.direction(toward, which_lobe, u) else { return };
        let wi = sample.wi;
        let cos = shading.cos(wi).abs();
        let beta = path.beta * sample.f * (cos / sample.pdf);
        let is_sharp = sample.lobe.is_specular();
        let pdf = match (is_sharp, sample.pdf_is_proportional) {
            (true, _) => f32::INFINITY,
            (false, true) => toward.pdf(wi),
            (false, false) => sample.pdf,
        };
        let transmitted = sample.lobe.is_transmission();
        let eta_scale = path.departure.eta_scale * if transmitted { sample.eta * sample.eta } else { 1.0 };

        // End paths that carry little, by chance.
        let depth = path.depth + 1;
        let (survival, survives) = self.roulette(numbers, beta, eta_scale, depth);
        next.probe.notice(|| Event::Bounced {
            address: path.address,
            bounce: Box::new(Bounce { wi, cos, sample, beta, survival, survives }),
        });
        if !survives || beta.is_black() {
            return;
        }
        let media = path.media.leaving(&world.materials, surface, wi, transmitted);
        next.samples.paths.push(Path {
            ray: Ray::new(surface.origin(wi), wi.to_array()),
            beta: beta / survival,
            slot: path.slot,
            depth,
            address: path.address + 1,
            media,
            departure: Departure {
                pdf,
                left: surface.left,
                point: DVec3::from_array(surface.point.position).as_vec3(),
                n: shading.n(),
                eta_scale,
                blurred: path.departure.blurred || !is_sharp,
            },
        });
    }

    fn add_sky<P: Probe>(&self, world: &World, path: &Path, next: &mut Next<'_, P>) {
        let direction = Vec3::from_array(path.ray.direction).normalize();
        for &index in &world.environments {
            // Some skies are only seen: by the camera, in mirrors and through glass.
            if path.departure.blurred && !world.lights[index as usize].illuminates() {
                continue;
            }
            let radiance = world.sky_of(index, &path.ray, &next.lanes(path));
            let pdf = || world.light_pdf(index, &path.reference(), direction, None);
            self.add_found(path, index, radiance, pdf, next);
        }
    }

    fn add_emission<P: Probe>(&self, world: &World, path: &Path, surface: &Surface, next: &mut Next<'_, P>) {
        let Some(light) = surface.light else { return };
        let radiance = world.emitted(surface, &next.lanes(path));
        if radiance.is_black() {
            return;
        }
        let pdf = || world.light_pdf(light, &path.reference(), -surface.wo, Some(surface));
        self.add_found(path, light, radiance, pdf, next);
    }

    /// Adds light that the direction of a path found, which asking the lights finds with density `light_pdf`.
    fn add_found<P: Probe>(
        &self,
        path: &Path,
        light: u32,
        radiance: Spectrum,
        light_pdf: impl Fn() -> f32,
        next: &mut Next<'_, P>,
    ) {
        let weight = self.weight_of_found(path, &light_pdf);
        let address = path.address;
        next.probe.notice(|| Event::Found {
            address,
            light,
            radiance,
            light_pdf: light_pdf(),
            weight,
            beta: path.beta,
        });
        next.add(path, Term::Found { light, weight }, path.beta * radiance * weight);
    }

    /// The weight of light that the direction of a path found, which asking the lights finds with density `light_pdf`.
    fn weight_of_found(&self, path: &Path, light_pdf: impl FnOnce() -> f32) -> f32 {
        match self.wisdom {
            _ if path.departure.pdf.is_infinite() => 1.0,
            Wisdom::Combined => power_heuristic(path.departure.pdf, light_pdf()),
            // What is asked is found already.
            Wisdom::Separate if light_pdf() > 0.0 => 0.0,
            Wisdom::Separate | Wisdom::None => 1.0,
        }
    }

    fn ask_light<P: Probe>(
        &self,
        world: &World,
        path: &Path,
        (surface, toward): (&Surface, &Toward<'_>),
        which: f32,
        u: [f32; 2],
        next: &mut Next<'_, P>,
    ) {
        let at = Reference { point: DVec3::from_array(surface.point.position), n: toward.shading.n() };
        let Some((index, probability)) = world.light_choice.sample(&at, which) else { return };
        let light = &world.lights[index as usize];
        let sample = light.sample(&world.textures, &at, u, &next.lanes(path), Coverage::Incomplete);
        let in_vain =
            |sample| Event::AskedInVain { address: path.address, light: index, probability, sample };
        let Some(sample) = sample else {
            next.probe.notice(|| in_vain(None));
            return;
        };
        let (f, bsdf_pdf) = toward.f_and_pdf(sample.wi);
        let f = f * toward.shading.cos(sample.wi).abs();
        if f.is_black() {
            next.probe.notice(|| in_vain(Some(sample)));
            return;
        }
        let light_pdf = probability * sample.pdf;
        let (weight, bsdf_pdf) = match (self.wisdom, light.is_delta()) {
            (Wisdom::Combined, false) => (power_heuristic(light_pdf, bsdf_pdf), bsdf_pdf),
            _ => (1.0, 0.0),
        };
        let contribution = path.beta * f * sample.li * (weight / light_pdf);
        next.probe.notice(|| Event::AskedOne {
            address: path.address,
            light: index,
            sample,
            probability,
            bsdf_pdf,
            weight,
            f,
        });
        if !contribution.is_black() {
            next.samples.shadows.push(Shadow::new(world, path, surface, &sample, index, contribution));
        }
    }

    fn direction(&self, toward: &Toward<'_>, lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if self.wisdom == Wisdom::None {
            return Some(toward.uniform(u));
        }
        let sample = toward.sample(lobe, u)?;
        (sample.pdf > 0.0).then_some(sample)
    }

    /// The probability with which a path goes on after its `depth`-th bounce, and whether it does.
    fn roulette(&self, numbers: &Numbers, beta: Spectrum, eta_scale: f32, depth: u32) -> (f32, bool) {
        let share = beta.max_lane() * eta_scale;
        if self.wisdom != Wisdom::Combined || depth <= SAFE_BOUNCES || share >= 1.0 {
            return (1.0, true);
        }
        let [u, _] = numbers.two(purpose::ROULETTE);
        (share, u < share)
    }
}

/// The weight of a way that finds light with density `this`, where another one finds it with `other` (Veach & Guibas
/// 1995, β = 2).
pub(crate) fn power_heuristic(this: f32, other: f32) -> f32 {
    // In this form nothing overflows.
    let ratio = other / this;
    1.0 / (1.0 + ratio * ratio)
}
