//! Cryptomattes of a picture: its camera rays are traced once more, to the first surfaces.

use lookfrom_bvh::{Hit, NONE};
use lookfrom_scene::settings::{CryptomatteKind, ImageSettings};

use super::start::Start;
use super::{Renderer, SampleId};
use crate::aov::{Cover, Cryptomatte, CryptomatteId, PixelMatte, RayHit};
use crate::core::parallel;
use crate::film;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::world::{Objects, World};

/// The most samples of a pixel whose rays are traced for mattes: coverage is about as exact as 8 bits.
pub const MOST_MATTE_SAMPLES: u32 = 256;

impl Renderer {
    /// The Cryptomattes that the image settings ask for, by the first samples of each pixel of the picture: the same rays as those of its
    /// light, weighted as they are, but at most [`MOST_MATTE_SAMPLES`] of a pixel. Surfaces of fractional alpha count by what they cover,
    /// as do media, which have no names. Nothing is seen in a measurement.
    pub fn cryptomattes(&self, samples: u32) -> Vec<Cryptomatte> {
        let ImageSettings { cryptomattes: kinds, width, height, .. } = self.image();
        if kinds.is_empty() {
            return Vec::new();
        }
        let area = film::area_of(self.image());
        let all: Vec<Ids> = kinds.iter().map(|&kind| Ids::new(&self.world, kind)).collect();
        let media = self.luminous_media();
        let samples = if self.surface.is_some() { 0 } else { samples.min(MOST_MATTE_SAMPLES) };
        let rows = parallel::collect(*height as usize, |y| {
            let mut row = vec![vec![PixelMatte::default(); *width as usize]; kinds.len()];
            let mut rays = PixelRays::default();
            for pixel in (0..*width).map(|x| [x, y as u32]).filter(|[x, y]| area.contains(*x, *y)) {
                rays.trace(self, pixel, samples);
                for (row, matte) in row.iter_mut().zip(rays.mattes(&self.world, media, &all)) {
                    row[pixel[0] as usize] = matte;
                }
            }
            row
        });
        let count = *width as usize * *height as usize;
        let mut pixels: Vec<Vec<PixelMatte>> = kinds.iter().map(|_| Vec::with_capacity(count)).collect();
        for row in rows {
            pixels.iter_mut().zip(row).for_each(|(pixels, row)| pixels.extend(row));
        }
        let mattes = kinds.iter().zip(&all).zip(pixels);
        mattes.map(|((&kind, ids), pixels)| Cryptomatte::new(kind, pixels, ids.named(&self.world))).collect()
    }
}

/// The camera rays of a pixel's samples and what they meet, in memory that is reused.
#[derive(Default)]
struct PixelRays {
    ids: Vec<SampleId>,
    start: Start,
    hits: Vec<Hit>,
    /// For each Cryptomatte.
    weighted: Vec<Vec<(CryptomatteId, f32)>>,
}

impl PixelRays {
    /// Traces the rays of a pixel's first samples.
    fn trace(&mut self, renderer: &Renderer, pixel: [u32; 2], samples: u32) {
        let Self { ids, start, hits, .. } = self;
        ids.clear();
        ids.extend((0..samples).map(|sample| SampleId { pixel, sample }));
        renderer.start(ids, start);
        hits.clear();
        hits.resize(ids.len(), Hit::MISS);
        renderer.world.bvh.query().times(start.times.as_slice()).closest_hits(&start.rays, hits);
    }

    /// The pixel of each Cryptomatte.
    fn mattes(
        &mut self,
        world: &World,
        media: Option<InteriorStack>,
        ids: &[Ids],
    ) -> impl Iterator<Item = PixelMatte> {
        let Self { start, hits, weighted, .. } = self;
        weighted.resize_with(ids.len(), Vec::new);
        weighted.iter_mut().for_each(Vec::clear);
        let mut all = 0.0;
        for (slot, (&ray, &hit)) in start.rays.iter().zip(hits.iter()).enumerate() {
            let weight = start.weights[slot];
            all += f64::from(weight);
            world.covers(media, RayHit { ray, hit }, start.times.of(slot), |part, cover| {
                if let Cover::Surface { surface, hit, .. } = cover {
                    for (weighted, ids) in weighted.iter_mut().zip(ids) {
                        weighted.push((ids.of(surface, hit), weight * part));
                    }
                }
            });
        }
        weighted.iter_mut().map(move |weighted| PixelMatte::new(weighted, all))
    }
}

/// The identifiers of one kind of things.
enum Ids {
    Objects { objects: Objects, ids: Vec<CryptomatteId> },
    Materials(Vec<CryptomatteId>),
}

impl Ids {
    fn new(world: &World, kind: CryptomatteKind) -> Self {
        let of_all = |names: &[String]| names.iter().map(|name| CryptomatteId::of(name)).collect();
        match kind {
            CryptomatteKind::Object => {
                let objects = world.objects();
                Self::Objects { ids: of_all(objects.names()), objects }
            }
            CryptomatteKind::Material => Self::Materials(of_all(&world.names.materials)),
        }
    }

    /// The identifier of what a surface is part of, by its hit.
    fn of(&self, surface: &SurfaceInteraction, hit: &Hit) -> CryptomatteId {
        match self {
            Self::Materials(ids) => ids[surface.material as usize],
            Self::Objects { objects, ids } => {
                let instance = (hit.instance != NONE).then_some(hit.instance);
                ids[objects.of(surface.shape, surface.primitive, instance) as usize]
            }
        }
    }

    /// All names with their identifiers.
    fn named<'a>(&'a self, world: &'a World) -> impl Iterator<Item = (CryptomatteId, String)> + 'a {
        let (ids, names) = match self {
            Self::Materials(ids) => (ids, &*world.names.materials),
            Self::Objects { objects, ids } => (ids, objects.names()),
        };
        ids.iter().copied().zip(names.iter().cloned())
    }
}
