//! Previews: the picture so far, written at intervals by a separate thread.

use std::sync::Mutex;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use lookfrom::film::Picture;
use lookfrom::render::TileDone;
use lookfrom_scene::settings::{ImageSettings, PixelBounds};

/// A picture, and its mean number of samples per pixel, rounded down.
pub(crate) type SoFar = (Picture, u64);

/// Assembles the picture from its tiles and sends it to the writer at intervals.
pub(crate) struct Preview {
    every: Duration,
    /// The number of pixels in the crop window.
    pixels: u64,
    so_far: Mutex<(Picture, Instant)>,
    sender: SyncSender<SoFar>,
}

impl Preview {
    /// Starts the clock. The writer receives pictures until the channel closes.
    pub(crate) fn start(every: Duration, image: &ImageSettings) -> (Self, Receiver<SoFar>) {
        let (sender, receiver) = sync_channel(0);
        let &ImageSettings { width, height, crop, .. } = image;
        let pixels = crop.unwrap_or(PixelBounds::of_size(width, height)).pixels();
        let black = vec![[0.0; 3]; width as usize * height as usize];
        let picture = Picture { width, height, pixels: black, alpha: Vec::new() };
        (Self { every, pixels, so_far: Mutex::new((picture, Instant::now())), sender }, receiver)
    }

    /// Adds a tile, and sends the picture if the interval has passed and the writer is not busy with the last one.
    pub(crate) fn add(&self, tile: TileDone) {
        let Some(of_tile) = tile.picture else { return };
        let mut so_far = self.so_far.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let (picture, last) = &mut *so_far;
        picture.replace(tile.area.x0, tile.area.y0, &of_tile);
        if last.elapsed() >= self.every
            && self.sender.try_send((picture.clone(), tile.done / self.pixels.max(1))).is_ok()
        {
            *last = Instant::now();
        }
    }
}
