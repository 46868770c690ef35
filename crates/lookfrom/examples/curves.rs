//! The speed of rays against a ball of curves: `cargo run --release --example curves -- 100000`.
//!
//! Prints the time to build the tree, and millions of rays per second of one thread: from a camera, and on from what those hit, away from
//! the middle.

use std::f32::consts::PI;
use std::path::PathBuf;
use std::time::Instant;

use glam::Vec3;
use lookfrom::world::World;
use lookfrom_bvh::Ray;
use lookfrom_scene::shape::{Geometry, Profile, Strand};
use lookfrom_scene::{LoadContext, Memory, load};

/// Rows and columns of the camera's rays.
const SIDE: u16 = 1024;

/// A scene with a curve, to be replaced.
const SCENE: &str = "[[curve]]\nwidth = 1\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]]\n";

/// A number in −1 … 1 (the finalizer of SplitMix64).
fn number(index: u64) -> f32 {
    let mut x = index.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 31)) >> 40) as f32 / 8_388_608.0 - 1.0
}

fn vector(index: u64) -> Vec3 {
    Vec3::new(number(index), number(index + 1), number(index + 2))
}

/// A strand that grows from the unit sphere, bends and hangs.
fn strand(index: u64) -> Strand {
    let seed = 16 * index;
    let (sin, cos) = (PI * number(seed + 1)).sin_cos();
    let z = number(seed);
    let out = Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
    let points = [
        out,
        1.12 * out + 0.03 * vector(seed + 2),
        1.22 * out + 0.08 * vector(seed + 5) - 0.04 * Vec3::Y,
        1.28 * out + 0.14 * vector(seed + 8) - 0.14 * Vec3::Y,
    ];
    Strand { points, width: [0.002, 0.0008], profile: Profile::Flat }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let count = std::env::args().nth(1).map_or(Ok(100_000), |count| count.parse())?;
    let name = PathBuf::from("ball.toml");
    let files = Memory([(name.clone(), SCENE.into())].into());
    let mut scene = load::scene(&name, &mut LoadContext::new(&files))?;
    scene.shapes[0].geometry = Geometry::Curves((0..count).map(strand).collect());

    let start = Instant::now();
    let world = World::compile(scene, &mut Vec::new())?;
    let (seconds, bytes) = (start.elapsed().as_secs_f64(), world.bvh().memory());
    println!("build: {seconds:.2} s, a tree of {} MB: {:?}", bytes / 1_000_000, world.bvh().statistics());

    let eye = Vec3::new(0.0, 0.0, 4.0) - world.origin().as_vec3();
    let across = |k: u16| 20_f32.to_radians().tan() * (2.0 * (f32::from(k) + 0.5) / f32::from(SIDE) - 1.0);
    let directions = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [x, y]));
    let rays: Vec<Ray> =
        directions.map(|[x, y]| Ray::new(eye.to_array(), [across(x), across(y), -1.0])).collect();
    let hits = timed("camera", &world, &rays);

    let bounces: Vec<Ray> = (0..)
        .zip(hits)
        .map(|(index, point)| {
            let direction = vector(4 * index + 7).normalize_or(Vec3::X);
            let inward = (point + world.origin().as_vec3()).dot(direction) < 0.0;
            let direction = if inward { -direction } else { direction };
            Ray::new((point + 0.01 * direction).to_array(), direction.to_array())
        })
        .collect();
    timed("bounce", &world, &bounces);
    Ok(())
}

/// Traces rays, prints how fast, and returns the points that they hit.
fn timed(name: &str, world: &World, rays: &[Ray]) -> Vec<Vec3> {
    let start = Instant::now();
    let hits: Vec<_> = rays.iter().map(|ray| (ray, world.bvh().closest_hit(ray))).collect();
    let speed = rays.len() as f64 / start.elapsed().as_secs_f64() / 1e6;
    let met = hits.iter().filter(|(_, hit)| hit.is_hit());
    let point = |ray: &Ray, t: f32| Vec3::from(ray.origin) + t * Vec3::from(ray.direction);
    let points: Vec<Vec3> = met.map(|(ray, hit)| point(ray, hit.t)).collect();
    println!("{name}: {} of {} rays hit, {speed:.3} million rays per second", points.len(), rays.len());
    points
}
