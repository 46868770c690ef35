//! Benchmark of the kernel. Reads a mesh and files of rays, builds, traces, and prints one JSON object per
//! measurement.
//!
//! The formats and keys are those of the project's comparison with Embree:
//! `kernel_bench MESH.bin NAME --rays DIR [--reps N] [--threads N] [--save DIR] [--quality fast|balanced|best]
//! [--kinds primary,primary16,...]`. Where kinds of rays are named, the tree is built once only.
//! CPU time is read from /proc, and taken to be wall time where there is none.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use lookfrom_bvh::{Builder, Bvh, Hit, NONE, Observer, Quality, Ray, Triangles};

/// Number of rays in one task of a thread.
const CHUNK: usize = 4096;

type Answer = (f32, u32);

/// Positions and indices.
type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

struct Options {
    mesh: PathBuf,
    name: String,
    rays: Option<PathBuf>,
    save: Option<PathBuf>,
    reps: usize,
    threads: usize,
    quality: Quality,
    quality_name: String,
    /// The kinds of rays to trace; empty for all.
    kinds: String,
}

fn options() -> Result<Options, Box<dyn Error>> {
    let mut options = Options {
        mesh: PathBuf::new(),
        name: String::new(),
        rays: None,
        save: None,
        reps: 3,
        threads: 1,
        quality: Quality::Best,
        quality_name: "high".into(),
        kinds: String::new(),
    };
    let mut places = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--rays" => options.rays = Some(value()?.into()),
            "--save" => options.save = Some(value()?.into()),
            "--reps" => options.reps = value()?.parse()?,
            "--threads" => options.threads = value()?.parse()?,
            "--kinds" => options.kinds = value()?,
            "--quality" => {
                options.quality_name = value()?;
                options.quality = match options.quality_name.as_str() {
                    "low" | "fast" => Quality::Fast,
                    "medium" | "balanced" => Quality::Balanced,
                    "high" | "best" => Quality::Best,
                    other => return Err(format!("unknown quality {other}").into()),
                };
            }
            _ => places.push(argument),
        }
    }
    let [mesh, name] = <[String; 2]>::try_from(places)
        .map_err(|_| "usage: kernel_bench MESH.bin NAME --rays DIR [--reps N] [--threads N] [--save DIR]")?;
    options.mesh = mesh.into();
    options.name = name;
    Ok(options)
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
}

fn triples(words: impl Iterator<Item = u32>) -> Vec<[u32; 3]> {
    let words: Vec<u32> = words.collect();
    words.chunks_exact(3).map(|w| [w[0], w[1], w[2]]).collect()
}

fn read_mesh(path: &Path) -> Result<Mesh, Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    let header: Vec<u32> = words(&bytes).take(2).collect();
    let &[triangles, vertices] = header.as_slice() else { return Err("the mesh has no header".into()) };
    let positions = triples(words(&bytes).skip(2).take(3 * vertices as usize));
    let indices = triples(words(&bytes).skip(2 + 3 * vertices as usize));
    if indices.len() != triangles as usize {
        return Err("the mesh's size does not match its header".into());
    }
    Ok((positions.into_iter().map(|p| p.map(f32::from_bits)).collect(), indices))
}

fn read_rays(path: &Path) -> Result<Vec<Ray>, Box<dyn Error>> {
    let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let values: Vec<f32> = words(&bytes).skip(1).map(f32::from_bits).collect();
    Ok(values
        .chunks_exact(8)
        .map(|r| Ray { origin: [r[0], r[1], r[2]], t_min: r[3], direction: [r[4], r[5], r[6]], t_max: r[7] })
        .collect())
}

fn write_hits(path: &Path, hits: &[Answer]) -> std::io::Result<()> {
    let mut bytes = (hits.len() as u32).to_le_bytes().to_vec();
    for (t, primitive) in hits {
        bytes.extend(t.to_le_bytes());
        bytes.extend(primitive.to_le_bytes());
    }
    std::fs::write(path, bytes)
}

/// CPU seconds of this thread. Yielding first updates the operating system's account, which otherwise lags
/// by a tick.
fn thread_seconds() -> Option<f64> {
    std::thread::yield_now();
    schedstat(Path::new("/proc/thread-self/schedstat"))
}

/// CPU seconds of all current threads.
fn process_seconds() -> Option<f64> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    Some(tasks.flatten().filter_map(|task| schedstat(&task.path().join("schedstat"))).sum())
}

fn schedstat(path: &Path) -> Option<f64> {
    let text = std::fs::read_to_string(path).ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| nanoseconds * 1e-9)
}

/// The way in which rays are traced.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Closest,
    Any,
    /// Closest hits in a batch.
    Batch,
}

#[inline(never)]
fn trace(bvh: &Bvh, rays: &[Ray], way: Way, answers: &mut [Answer]) {
    if way == Way::Batch {
        let mut hits = [Hit::MISS; 256];
        for (rays, answers) in rays.chunks(hits.len()).zip(answers.chunks_mut(hits.len())) {
            bvh.closest_hits(rays, &mut hits);
            for (hit, answer) in hits.iter().zip(answers) {
                *answer = (hit.t, hit.primitive);
            }
        }
        return;
    }
    for (ray, answer) in rays.iter().zip(answers) {
        *answer = if way == Way::Any {
            (0.0, if bvh.occluded(ray) { 0 } else { NONE })
        } else {
            let hit = bvh.closest_hit(ray);
            (hit.t, hit.primitive)
        };
    }
}

/// Counts the nodes and candidates visited by closest-hit queries.
#[derive(Default)]
struct Counts {
    nodes: u64,
    triangles: u64,
}

impl Observer for Counts {
    fn node(&mut self, _instance: u32, _node: u32) {
        self.nodes += 1;
    }

    fn candidate(&mut self, _instance: u32, _geometry: u32, _primitive: u32) {
        self.triangles += 1;
    }
}

/// Distributes chunks of rays to threads; returns CPU seconds summed over them.
fn trace_all(bvh: &Bvh, rays: &[Ray], way: Way, answers: &mut [Answer], threads: usize) -> f64 {
    let measure = |work: &mut dyn FnMut()| {
        let (start, wall) = (thread_seconds(), Instant::now());
        work();
        match (start, thread_seconds()) {
            (Some(start), Some(end)) => end - start,
            _ => wall.elapsed().as_secs_f64(),
        }
    };
    if threads == 1 {
        return measure(&mut || {
            for (rays, answers) in rays.chunks(CHUNK).zip(answers.chunks_mut(CHUNK)) {
                trace(bvh, rays, way, answers);
            }
        });
    }
    let chunks: Vec<_> = rays
        .chunks(CHUNK)
        .zip(answers.chunks_mut(CHUNK))
        .map(|chunk| std::sync::Mutex::new(Some(chunk)))
        .collect();
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        let worker = || {
            measure(&mut || {
                while let Some(chunk) = chunks.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let taken = chunk.lock().ok().and_then(|mut chunk| chunk.take());
                    if let Some((rays, answers)) = taken {
                        trace(bvh, rays, way, answers);
                    }
                }
            })
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().filter_map(|worker| worker.join().ok()).sum()
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    if let Ok(level) = std::env::var("LOOKFROM_SIMD") {
        lookfrom_simd::choose_level(&level)?;
    }
    let options = options()?;
    let (positions, indices) = read_mesh(&options.mesh)?;
    let common = format!(
        "\"library\":\"lookfrom-bvh\",\"version\":\"{}\",\"mesh\":\"{}\",\"triangles\":{},\"quality\":\"{}\",\
         \"robust\":true,\"threads\":{}",
        env!("CARGO_PKG_VERSION"),
        options.name,
        indices.len(),
        options.quality_name,
        options.threads
    );

    // Build.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
    let (mut wall, mut cpu) = (f64::INFINITY, f64::INFINITY);
    let mut bvh = None;
    let builds = if options.kinds.is_empty() { options.reps.max(1) } else { 1 };
    for _ in 0..builds {
        let (start, cpu_start) = (Instant::now(), process_seconds());
        let built = pool.install(|| {
            let mut builder = Builder::new();
            builder.quality(options.quality);
            builder.triangles(Triangles { positions: &positions, indices: &indices });
            builder.build()
        })?;
        let elapsed = start.elapsed().as_secs_f64();
        wall = wall.min(elapsed);
        cpu = cpu.min(cpu_start.zip(process_seconds()).map_or(elapsed, |(start, end)| end - start));
        bvh = Some(built);
    }
    let bvh = bvh.ok_or("no tree")?;
    println!(
        "{{{common},\"kind\":\"build\",\"build_ms\":{:.3},\"build_cpu_ms\":{:.3},\"bytes\":{}}}",
        wall * 1e3,
        cpu * 1e3,
        bvh.memory()
    );
    eprintln!("{:?}", bvh.statistics());

    // Trace.
    let Some(folder) = &options.rays else { return Ok(()) };
    for (kind, file, way) in [
        ("primary", "primary", Way::Closest),
        ("bounce", "bounce", Way::Closest),
        ("shadow", "shadow", Way::Any),
        ("primary16", "primary", Way::Batch),
        ("bounce16", "bounce", Way::Batch),
    ] {
        if !options.kinds.is_empty() && options.kinds.split(',').all(|wanted| wanted != kind) {
            continue;
        }
        let rays = read_rays(&folder.join(format!("{}.{file}.rays", options.name)))?;
        if way == Way::Closest {
            let mut counts = Counts::default();
            for ray in &rays {
                bvh.query().observer(&mut counts).closest_hit(ray);
            }
            let per_ray = |count: u64| count as f64 / rays.len() as f64;
            eprintln!(
                "{kind}: {:.4} nodes, {:.4} triangles a ray",
                per_ray(counts.nodes),
                per_ray(counts.triangles)
            );
        }
        let mut answers = vec![(0.0, NONE); rays.len()];
        let (mut wall, mut cpu) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..options.reps.max(1) {
            let start = Instant::now();
            cpu = cpu.min(trace_all(&bvh, &rays, way, &mut answers, options.threads));
            wall = wall.min(start.elapsed().as_secs_f64());
        }
        let millions = rays.len() as f64 * 1e-6;
        println!(
            "{{{common},\"kind\":\"{kind}\",\"rays\":{},\"hits\":{},\"mrays_per_s_cpu\":{:.4},\"mrays_per_s_wall\":{:.4}}}",
            rays.len(),
            answers.iter().filter(|answer| answer.1 != NONE).count(),
            millions * options.threads as f64 / cpu,
            millions / wall
        );
        if let Some(save) = &options.save {
            write_hits(&save.join(format!("{}.{kind}.hits", options.name)), &answers)?;
        }
    }
    Ok(())
}
