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
use crate::world::World;

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
        let names = |kind| names(&self.world, kind).map(|name| (CryptomatteId::of(&name), name));
        let mattes = kinds.iter().zip(pixels);
        mattes.map(|(&kind, pixels)| Cryptomatte::new(kind, pixels, names(kind))).collect()
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
    Objects {
        shapes: Vec<CryptomatteId>,
        /// `None` for those that are no instances of the scene.
        instances: Vec<Option<CryptomatteId>>,
    },
    Materials(Vec<CryptomatteId>),
}

impl Ids {
    fn new(world: &World, kind: CryptomatteKind) -> Self {
        let of_all =
            |names: &mut dyn Iterator<Item = &String>| names.map(|name| CryptomatteId::of(name)).collect();
        match kind {
            CryptomatteKind::Object => Self::Objects {
                shapes: of_all(&mut world.names.shapes.iter().map(|label| &label.name)),
                instances: instance_names(world).map(|name| name.as_deref().map(CryptomatteId::of)).collect(),
            },
            CryptomatteKind::Material => Self::Materials(of_all(&mut world.names.materials.iter())),
        }
    }

    /// The identifier of what a surface is part of, by its hit.
    fn of(&self, surface: &SurfaceInteraction, hit: &Hit) -> CryptomatteId {
        match self {
            Self::Materials(ids) => ids[surface.material as usize],
            Self::Objects { shapes, instances } => {
                let instance = if hit.instance == NONE { None } else { instances[hit.instance as usize] };
                instance.unwrap_or_else(|| shapes[surface.shape as usize])
            }
        }
    }
}

/// The names of all things of a kind.
fn names(world: &World, kind: CryptomatteKind) -> Box<dyn Iterator<Item = String> + '_> {
    let names = &world.names;
    match kind {
        CryptomatteKind::Object => {
            let shapes = names.shapes.iter().map(|label| label.name.clone());
            Box::new(shapes.chain(instance_names(world).flatten()))
        }
        CryptomatteKind::Material => Box::new(names.materials.iter().cloned()),
    }
}

/// The names of instances. One that the scene does not name has the name of its object, with a number where there are several of it;
/// those that are made for shapes which emit light and move have none.
fn instance_names(world: &World) -> impl Iterator<Item = Option<String>> {
    let names = &world.names;
    let mut counts = vec![0_u32; names.objects.len()];
    for instance in &*world.instances {
        counts.get_mut(instance.object as usize).into_iter().for_each(|count| *count += 1);
    }
    let mut numbers = vec![0_u32; names.objects.len()];
    world.instances.iter().enumerate().map(move |(index, instance)| {
        let object = instance.object as usize;
        let name = names.objects.get(object)?;
        numbers[object] += 1;
        let own = names.instances.get(index).and_then(Option::as_ref);
        Some(match (own, counts[object]) {
            (Some(own), _) => own.to_string(),
            (None, 1) if !name.is_empty() => name.clone(),
            (None, _) if name.is_empty() => format!("object {} {}", object + 1, numbers[object]),
            (None, _) => format!("{name} {}", numbers[object]),
        })
    })
}
