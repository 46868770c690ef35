//! Blocks of a film that a thread adds a tile to, while others work on the film.
//!
//! To unpack and to pack a block takes as long as a few samples of its pixels. So the film is only locked while blocks are moved out of
//! it, and back. Sums may be added in any order: if there are other sums in their place meanwhile, they are added to these.

use lookfrom_scene::Result;
use lookfrom_scene::settings::PixelBounds;

use super::plane::{change, count_of_blocks};
use super::stored::{Sums, for_each_plane};
use super::{Film, FilmTile, twice};

/// The blocks that a tile touches, plane by plane.
#[derive(Debug)]
pub(crate) struct Detached {
    /// Width and height of the picture.
    size: [u32; 2],
    area: PixelBounds,
    blocks: Vec<Box<[u8]>>,
}

impl Film {
    /// Moves the sums of the blocks that a tile touches out of the film, to [add](Detached::add) the tile's to them. Its samples are
    /// recorded, so the film is wrong until they are [back](Film::attach).
    ///
    /// # Errors
    /// As [`Film::merge`]; then nothing has changed.
    pub(crate) fn detach(&mut self, tile: &FilmTile) -> Result<Detached> {
        let area = tile.area;
        self.check_same(area, tile.layout)?;
        self.ledger.merge(&tile.ledger).map_err(|overlap| twice(&overlap))?;
        self.drop_samples(tile.dropped, tile.first_dropped);
        let mut blocks = Vec::new();
        for_each_plane!([&mut] self => plane; blocks.extend(plane.take(area)));
        Ok(Detached { size: [self.width, self.height], area, blocks })
    }

    /// Adds the sums of blocks.
    pub(crate) fn attach(&mut self, Detached { area, blocks, .. }: Detached) {
        let mut blocks = blocks.into_iter();
        for_each_plane!([&mut] self => plane; plane.put(area, &mut blocks));
    }
}

impl Detached {
    /// Adds the sums of the tile that they were detached for.
    pub(crate) fn add(&mut self, tile: &FilmTile) {
        let Self { size, area, blocks } = self;
        let index = |x: u32, y: u32| area.index(x, y);
        let mut left = &mut blocks[..];
        for_each_plane!([&] tile => theirs; {
            if !theirs.is_empty() {
                let (mine, others) = std::mem::take(&mut left).split_at_mut(count_of_blocks(*area));
                left = others;
                // Of denoiser features, only the first samples of a pixel have any.
                if theirs.iter().any(|sums| *sums != Default::default()) {
                    change(*size, *area, mine, |x, y, sums| Sums::merge(sums, &theirs[index(x, y)]));
                }
            }
        });
    }
}
