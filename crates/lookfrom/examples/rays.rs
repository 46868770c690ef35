//! Ray queries against a mesh, without a picture: primitives and distances, as a laser scanner measures them.
//!
//! `cargo run --release -p lookfrom --example rays -- scenes/models/knot.obj`

use std::error::Error;

use lookfrom::bvh::{Hit, Ray};
use lookfrom::glam::DVec3;
use lookfrom::session::{Options, Session};

fn main() -> Result<(), Box<dyn Error>> {
    let model = std::env::args().nth(1).ok_or("usage: rays MODEL")?;
    let session = Session::open(&model, &Options::default())?;
    let (world, bounds) = (session.world(), session.info().bounds);
    let center = bounds.center() - world.origin();

    // A ring of rays from around the model to its centre, in one batch. Positions are relative to `World::origin`.
    let rays: Vec<Ray> = (0..24)
        .map(|k| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 24.0).sin_cos();
            let from = center + 2.0 * bounds.radius() * DVec3::new(cos, 0.0, sin);
            let towards = (center - from).normalize();
            Ray::new(from.as_vec3().to_array(), towards.as_vec3().to_array())
        })
        .collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    world.bvh().closest_hits(&rays, &mut hits);
    for (k, hit) in hits.iter().enumerate() {
        match hit.is_hit() {
            true => println!("{:3}°: triangle {} at {:.4}", 15 * k, hit.primitive, hit.t),
            false => println!("{:3}°: nothing", 15 * k),
        }
    }
    Ok(())
}
