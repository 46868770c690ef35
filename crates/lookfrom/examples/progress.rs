//! Progress and cancellation: a picture is rendered in the background, and stopped after a time limit.
//!
//! `cargo run --release -p lookfrom --example progress -- scenes/hero.toml hero.png 5`

use std::error::Error;
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

use lookfrom::render::{Progress, TileDone};
use lookfrom::session::{Options, Session};

/// Sends every tile through a channel. The render does not wait for the receiver: no lock is held during the call.
struct Tiles(Sender<TileDone>);

impl Progress for Tiles {
    fn tile(&self, done: TileDone) {
        // An error means that the receiver is gone, which does no harm.
        let _ = self.0.send(done);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(scene), Some(picture)) = (arguments.next(), arguments.next()) else {
        return Err("usage: progress SCENE PICTURE.png [SECONDS]".into());
    };
    let limit = Duration::from_secs_f64(arguments.next().map_or(Ok(5.0), |seconds| seconds.parse())?);

    let session = Session::open(&scene, &Options::default())?;
    let (sender, tiles) = channel();
    let started = Instant::now();
    let running = session.start(Tiles(sender))?;
    for tile in tiles {
        let share = 100.0 * tile.done as f64 / tile.total as f64;
        eprint!("\r{share:5.1} %, {:.1} million rays", 1e-6 * tile.rays as f64);
        if started.elapsed() > limit {
            running.cancel();
        }
    }
    let finished = running.finish()?;
    eprintln!("\nended by {}, {} samples a pixel", finished.rendered.reason.word(), finished.samples_taken());
    finished.save(picture)?;
    Ok(())
}
