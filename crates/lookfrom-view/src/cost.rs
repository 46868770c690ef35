//! Heat maps of the cost of pixels: rays, nodes and primitives of their first samples.

use std::thread::ScopedJoinHandle;

use lookfrom::render::{Cost, SampleId};
use lookfrom::session::Session;
use lookfrom_scene::Result;
use lookfrom_scene::image::{Pixels, encode_png_to_show};

use crate::heat::{byte, heat};

/// The most pixels of a map; larger views have a coarser one.
const MOST_PIXELS: f64 = 150_000.0;

/// The quantity that a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Counted {
    Rays,
    Nodes,
    Candidates,
}

/// The costs of a view.
#[derive(Debug)]
pub(crate) struct CostMap {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Pixels of the view per pixel of the map.
    pub(crate) scale: u32,
    costs: Vec<Cost>,
}

impl CostMap {
    /// Measures the costs of a view, on all threads that there are.
    ///
    /// # Errors
    /// As [`Session::set_image`].
    pub(crate) fn new(session: &Session) -> Result<Self> {
        let mut session = session.clone();
        let mut image = session.image().clone();
        let pixels = f64::from(image.width) * f64::from(image.height);
        let scale = (pixels / MOST_PIXELS).sqrt().ceil().max(1.0) as u32;
        image.resize(image.width.div_ceil(scale), image.height.div_ceil(scale));
        let (width, height) = (image.width, image.height);
        session.set_image(image)?;
        let ids: Vec<SampleId> = (0..height)
            .flat_map(|y| (0..width).map(move |x| SampleId { pixel: [x, y], sample: 0 }))
            .collect();
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let renderer = session.renderer();
        if threads == 1 {
            return Ok(Self { width, height, scale, costs: by_rows(&ids, width, renderer) });
        }
        let costs = std::thread::scope(|scope| {
            let parts = ids.chunks(ids.len().div_ceil(threads).max(1));
            let parts: Vec<_> = parts.map(|part| scope.spawn(|| by_rows(part, width, renderer))).collect();
            let joined = parts.into_iter().map(ScopedJoinHandle::join);
            joined.flat_map(|part| part.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
        });
        Ok(Self { width, height, scale, costs })
    }

    /// The map as a PNG: black is 0, the brightest colour the largest count.
    ///
    /// # Errors
    /// As [`encode_png_to_show`].
    pub(crate) fn png(&self, counted: Counted) -> Result<Vec<u8>> {
        let count = |cost: &Cost| match counted {
            Counted::Rays => cost.rays,
            Counted::Nodes => cost.nodes,
            Counted::Candidates => cost.candidates,
        };
        let most = self.costs.iter().map(count).max().unwrap_or(0).max(1);
        let color = |cost: &Cost| heat(count(cost) as f32 / most as f32).map(byte);
        let rgb: Vec<u8> = self.costs.iter().flat_map(color).collect();
        encode_png_to_show([self.width, self.height], Pixels::Rgb8(&rgb))
    }
}

/// Costs row by row, so that the events of few samples are in memory at once.
fn by_rows(ids: &[SampleId], width: u32, renderer: &lookfrom::render::Renderer) -> Vec<Cost> {
    ids.chunks(width.max(1) as usize).flat_map(|row| renderer.costs(row)).collect()
}
