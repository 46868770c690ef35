//! Films in files: the same bytes from one thread and many, from any parts merged in any order, stopped and resumed.

use std::io::Cursor;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use lookfrom::film::Film;
use lookfrom::render::{Progress, StopCriteria, TileDone};
use lookfrom::session::{Exposure, FilmFile, FilmParts, Finished, Fireflies, Format, Options, Session};
use lookfrom_scene::settings::{
    Allocation, Background, ColorMode, Integrator, Layers, LightPathLayer, PixelBounds,
};
use lookfrom_scene::{Budget, ErrorKind, Location, Memory};

const SCENE: &[u8] = br#"
[camera]
lookfrom = [0, 1, 5]
lookat = [0, 0.5, 0]

[image]
width = 71
height = 45

[render]
samples = 20

[materials.glass]
transmission = 0.9
ior = 1.5

[[sphere]]
center = [0, 0.5, 0]
radius = 0.5
material = "glass"

[[sphere]]
center = [1, 0.3, 0.5]
radius = 0.3

[[quad]]
corner = [-5, 0, 5]
edge_u = [10, 0, 0]
edge_v = [0, 0, -10]

[[light]]
type = "point"
position = [3, 4, 5]
intensity = 20
"#;

/// A session of the scene with a number of threads.
fn session(options: &Options, threads: usize) -> Session {
    let options = Options { film: true, threads: Some(threads), ..options.clone() };
    Session::from_bytes("s.toml", SCENE.to_vec(), &options).expect("a scene")
}

fn bytes(session: &Session, finished: &Finished) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    let provenance = session.provenance().expect("a film is kept");
    provenance.write(&finished.rendered.film, &finished.developed, &mut out).expect("memory");
    out.into_inner()
}

fn rendered(options: &Options, threads: usize) -> Vec<u8> {
    let session = session(options, threads);
    bytes(&session, &session.render(&()).expect("a picture"))
}

fn read(bytes: &[u8]) -> FilmFile {
    FilmFile::read(bytes, Path::new("film.exr"), &Budget::default()).expect("a film")
}

#[test]
fn crops_are_merged_in_bands_of_rows_to_the_film_of_one_render() {
    const WIDTH: u32 = 23;
    const HEIGHT: u32 = 1500;
    for (layers, spectral_buckets) in [(Layers::None, None), (Layers::Geometry, Some(3))] {
        let options = Options {
            width: Some(WIDTH),
            height: Some(HEIGHT),
            samples: Some(2),
            layers: Some(layers),
            color: spectral_buckets.map(|_| ColorMode::Spectral),
            spectral_buckets,
            background: Some(if layers == Layers::None {
                Background::Environment
            } else {
                Background::Transparent
            }),
            denoise: Some(false),
            ..Options::default()
        };
        let whole = rendered(&options, 2);
        // Rows, of which some are of two crops; blocks of 32 rows have pixels of several parts.
        let crops = [(0, 0, WIDTH, 419), (0, 419, 9, 911), (9, 419, WIDTH, 911), (0, 911, WIDTH, HEIGHT)];
        let crops = crops.map(|(x0, y0, x1, y1)| PixelBounds { x0, y0, x1, y1 });
        let films = crops.map(|crop| rendered(&Options { crop: Some(crop), ..options.clone() }, 1));
        let paths = ["0.exr", "1.exr", "2.exr", "3.exr"].map(Path::new);
        let files = Memory(paths.into_iter().map(Path::to_owned).zip(films.iter().cloned()).collect());
        let budget = Budget::new(500 << 20);
        let mut parts = FilmParts::new(&files, &budget);
        for path in [3, 1, 0, 2].map(|index| paths[index]) {
            parts.add(path, |_| ()).expect("of the same picture");
        }
        assert!(parts.are_bands(), "{layers:?}");
        let mut out = Cursor::new(Vec::new());
        parts.write(|provenance, _| provenance.clone(), &mut out).expect("memory");
        assert!(out.get_ref() == &merged(&films.each_ref().map(Vec::as_slice)), "{layers:?}");
        let (of_one, of_parts) = (read(&whole), read(out.get_ref()));
        assert!(of_one.film == of_parts.film, "{layers:?}");
        let development = of_one.provenance.development;
        let developed = parts.develop(&development).expect("a plain picture");
        assert_eq!(developed.picture, of_one.develop(&development).picture);
        // The same pixels twice.
        let error = parts.add(paths[1], |_| ()).expect_err("samples that are there");
        assert!(error.message.contains("samples 0..2 of pixel 0 419"), "{error}");
    }
}

/// The file of the sum of films, in this order.
fn merged(parts: &[&[u8]]) -> Vec<u8> {
    let mut whole = read(parts[0]);
    for part in &parts[1..] {
        whole.merge(&read(part)).expect("of the same picture");
    }
    let mut out = Cursor::new(Vec::new());
    whole.write(&whole.develop(&whole.provenance.development), &mut out).expect("memory");
    out.into_inner()
}

fn light_paths() -> Vec<LightPathLayer> {
    let layer = |(name, expression): (&str, &str)| LightPathLayer {
        name: name.into(),
        expression: expression.into(),
        at: Location::default(),
    };
    [("diffuse", "CD.*"), ("direct", "C.L")].map(layer).to_vec()
}

/// Renders that differ in what their films hold.
fn kinds() -> Vec<(&'static str, Options)> {
    let path = Options { integrator: Some(Integrator::Path), ..Options::default() };
    vec![
        ("whitted", Options { integrator: Some(Integrator::Whitted), ..Options::default() }),
        ("path", path.clone()),
        ("spectral", Options { color: Some(ColorMode::Spectral), ..path.clone() }),
        ("layers", Options { layers: Some(Layers::Geometry), ..path.clone() }),
        (
            "buckets",
            Options {
                color: Some(ColorMode::Spectral),
                spectral_buckets: Some(5),
                wavelengths: Some([400.0, 700.0]),
                ..path.clone()
            },
        ),
        ("light paths", Options { light_paths: light_paths(), ..path.clone() }),
        ("alpha", Options { background: Some(Background::Transparent), ..path.clone() }),
        (
            "denoised",
            Options {
                denoise: Some(true),
                background: Some(Background::Color([0.1, 0.2, 0.3])),
                ..path.clone()
            },
        ),
        ("fireflies", Options { fireflies: Fireflies::Spread, exposure: Some(Exposure::Stops(0.3)), ..path }),
    ]
}

#[test]
fn any_threads_parts_and_order_make_the_same_bytes() {
    for (name, options) in kinds() {
        let whole = rendered(&options, 1);
        assert!(whole == rendered(&options, 3), "{name}: three threads");
        let part = |part| rendered(&Options { part: Some([part, 3]), ..options.clone() }, 2);
        let [a, b, c] = [1, 2, 3].map(part);
        assert!(merged(&[&c, &a, &b]) == whole, "{name}: samples c a b");
        assert!(merged(&[&b, &c, &a]) == whole, "{name}: samples b c a");
        let crop = |x0, y0, x1, y1| {
            rendered(&Options { crop: Some(PixelBounds { x0, y0, x1, y1 }), ..options.clone() }, 2)
        };
        let crops = [crop(0, 0, 33, 45), crop(33, 0, 71, 20), crop(33, 20, 71, 45)];
        assert!(merged(&[&crops[1], &crops[2], &crops[0]]) == whole, "{name}: crops");
        // A film that is read and written again is the same, too.
        assert!(merged(&[&whole]) == whole, "{name}: read and written");
    }
}

/// Stops after a number of tiles.
struct Stop {
    left: AtomicUsize,
}

impl Progress for Stop {
    fn tile(&self, _: TileDone) {
        let _ = self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
    }

    fn cancelled(&self) -> bool {
        self.left.load(Ordering::Relaxed) == 0
    }
}

#[test]
fn stopped_and_resumed_again_and_again_it_is_the_same() {
    let adaptive = Options {
        stop: StopCriteria { noise: Some(0.05), time: None },
        samples: Some(200),
        integrator: Some(Integrator::Path),
        ..Options::default()
    };
    let allocated = Options {
        allocation: Some(Allocation::Adaptive),
        samples: Some(40),
        integrator: Some(Integrator::Path),
        ..Options::default()
    };
    let adaptive = [("adaptive", adaptive), ("allocated", allocated)];
    for (name, options) in kinds().into_iter().chain(adaptive) {
        let whole = rendered(&options, 2);
        let mut so_far: Option<Vec<u8>> = None;
        let mut stops = 0;
        for tiles in [1, 2, 5, 3, 9, 4, 17, 1, 7].into_iter().cycle() {
            let session = session(&options, 1 + stops % 2);
            let stop = Stop { left: AtomicUsize::new(tiles) };
            let finished = match &so_far {
                None => session.render(&stop),
                Some(film) => session.resume(read(film), &stop),
            };
            let finished = finished.expect("a picture");
            so_far = Some(bytes(&session, &finished));
            if finished.rendered.reason != lookfrom::render::StopReason::Cancelled {
                break;
            }
            stops += 1;
        }
        assert!(stops > 3, "{name}: {stops} stops");
        assert!(so_far.as_ref() == Some(&whole), "{name}: after {stops} stops");
    }
}

/// Keeps the file of each checkpoint, as often as there can be one.
struct Checkpoints<'a> {
    session: &'a Session,
    files: Mutex<Vec<Vec<u8>>>,
}

impl Progress for Checkpoints<'_> {
    fn wants_checkpoint(&self) -> bool {
        true
    }

    fn checkpoint(&self, film: &Film) {
        let mut out = Cursor::new(Vec::new());
        self.session.provenance().expect("a film is kept").write_checkpoint(film, &mut out).expect("memory");
        self.files.lock().expect("a lock").push(out.into_inner());
    }
}

#[test]
fn every_checkpoint_leads_to_the_same_end() {
    let adaptive = Options {
        stop: StopCriteria { noise: Some(0.08), time: None },
        samples: Some(70),
        integrator: Some(Integrator::Path),
        denoise: Some(true),
        ..Options::default()
    };
    let whitted = Options { integrator: Some(Integrator::Whitted), samples: Some(5), ..Options::default() };
    let allocated = Options {
        allocation: Some(Allocation::Adaptive),
        samples: Some(24),
        integrator: Some(Integrator::Path),
        layers: Some(Layers::Geometry),
        denoise: Some(true),
        ..Options::default()
    };
    for options in [adaptive, whitted, allocated] {
        let session = session(&options, 2);
        let whole = bytes(&session, &session.render(&()).expect("a picture"));
        let checkpoints = Checkpoints { session: &session, files: Mutex::default() };
        let finished = session.render(&checkpoints).expect("a picture");
        assert!(bytes(&session, &finished) == whole);
        let files = checkpoints.files.into_inner().expect("a lock");
        assert!(files.len() > 4, "{}", files.len());
        for file in files.iter().step_by(files.len().div_ceil(7)) {
            let film = read(file);
            assert!(film.provenance.goal.is_some());
            assert!(bytes(&session, &session.resume(film, &()).expect("a picture")) == whole);
        }
    }
}

/// A small picture by one thread has one part in each pass.
#[test]
fn pictures_of_one_tile_have_checkpoints() {
    let options = Options { width: Some(16), height: Some(16), samples: Some(200), ..Options::default() };
    let session = session(&options, 1);
    let checkpoints = Checkpoints { session: &session, files: Mutex::default() };
    let finished = session.render(&checkpoints).expect("a picture");
    let files = checkpoints.files.into_inner().expect("a lock");
    assert!(files.len() > 2, "{}", files.len());
    let resumed = session.resume(read(&files[2]), &()).expect("a picture");
    assert!(bytes(&session, &resumed) == bytes(&session, &finished));
}

#[test]
fn more_samples_are_those_of_one_render() {
    let of = |samples| Options { samples: Some(samples), ..Options::default() };
    let more = session(&of(33), 2);
    let finished = more.resume(read(&rendered(&of(7), 1)), &()).expect("a picture");
    assert!(bytes(&more, &finished) == rendered(&of(33), 2));
    // Of an adaptive picture the samples that are there count, and the rest is allocated anew.
    let adaptive = |samples| Options { allocation: Some(Allocation::Adaptive), ..of(samples) };
    let more = session(&adaptive(32), 1);
    let finished = more.resume(read(&rendered(&adaptive(8), 2)), &()).expect("a picture");
    assert!((28..=33).contains(&finished.samples_taken()), "{}", finished.samples_taken());
    assert!(session(&of(8), 1).resume(read(&bytes(&more, &finished)), &()).is_err());
}

#[test]
fn a_developed_film_is_the_rendered_picture() {
    for (name, options) in kinds() {
        let session = session(&options, 2);
        let finished = session.render(&()).expect("a picture");
        let file = read(&bytes(&session, &finished));
        let developed = file.develop(&file.provenance.development);
        for format in [Format::Png, Format::Exr] {
            let mut out = Cursor::new(Vec::new());
            developed.write(Some(&file.film), format, &mut out).expect("a picture");
            assert!(finished.encode(format).expect("a picture") == out.into_inner(), "{name}");
        }
    }
}

#[test]
fn what_does_not_belong_together_is_told() {
    let film = |options: &Options| read(&rendered(options, 1));
    let plain = Options { samples: Some(2), ..Options::default() };
    let mut whole = film(&plain);
    let mut refused = |other: &Options, says: &[&str]| {
        let before = whole.clone();
        let error = whole.merge(&film(other)).expect_err("another picture");
        for word in says {
            assert!(error.message.contains(word), "{word:?} is not in: {error}");
        }
        assert!(whole == before);
    };
    refused(&plain, &["samples 0..2 of pixel 0 0", "twice"]);
    let later = Options { first_sample: 2, samples: Some(3), ..plain.clone() };
    refused(&Options { seed: Some(7), ..later.clone() }, &["seed is 7 there, 0 here"]);
    refused(
        &Options { width: Some(70), height: Some(45), ..later.clone() },
        &["size is 70 45 there, 71 45 here"],
    );
    refused(
        &Options { layers: Some(Layers::Geometry), ..later.clone() },
        &["layers is geometry there, none here"],
    );
    refused(
        &Options { background: Some(Background::Transparent), ..later.clone() },
        &["light and alpha", "light"],
    );
    refused(&Options { denoise: Some(true), ..later.clone() }, &["denoiser features"]);
    let spectral = Options { color: Some(ColorMode::Spectral), ..later.clone() };
    refused(&Options { spectral_buckets: Some(3), ..spectral }, &["color is spectral there, rgb here"]);
    refused(&Options { depth: Some(3), ..later.clone() }, &["depth is 3 there"]);
    refused(
        &Options { rotate_environment: Some(3.0), ..later.clone() },
        &["other options for the surroundings"],
    );
    // The same settings of another scene.
    let other = String::from_utf8_lossy(SCENE).replace("radius = 0.3", "radius = 0.4").into_bytes();
    let options = Options { film: true, ..later };
    let session = Session::from_bytes("s.toml", other, &options).expect("a scene");
    let other = read(&bytes(&session, &session.render(&()).expect("a picture")));
    let error = whole.merge(&other).expect_err("another scene");
    assert!(error.message.contains("s.toml has another content"), "{error}");
    assert!(session.resume(whole, &()).is_err());
}

#[test]
fn damaged_films_are_errors() {
    let options = Options {
        layers: Some(Layers::Geometry),
        samples: Some(1),
        width: Some(20),
        height: Some(9),
        ..Options::default()
    };
    let film = rendered(&options, 1);
    let error_of = |bytes: &[u8]| {
        FilmFile::read(bytes, Path::new("film.exr"), &Budget::default()).expect_err("a damaged film")
    };
    // Any byte of the first part, where the header is, and some of the others.
    for index in (0..3000).step_by(7).chain((3000..film.len()).step_by(97)) {
        let mut damaged = film.clone();
        damaged[index] ^= 1 << (index % 8);
        let error = error_of(&damaged);
        assert!(error.kind != ErrorKind::Io && !error.message.is_empty());
    }
    for length in [0, 1, 7, 8, 20, 300, 2000, film.len() / 2, film.len() - 1] {
        error_of(&film[..length]);
    }
    // A picture of terabytes in a small file: the checksum is that of the claim.
    let size = |bytes: &[u8]| {
        [b"dataWindow\0box2i\0", &16_u32.to_le_bytes()[..]].concat().len()
            + find(bytes, b"dataWindow\0box2i\0")
    };
    let mut huge = film.clone();
    let at = size(&huge);
    for edge in [8, 12] {
        huge[at + edge..at + edge + 4].copy_from_slice(&0x7fff_0000_u32.to_le_bytes());
    }
    assert!(matches!(error_of(&huge).kind, ErrorKind::Limit | ErrorKind::Syntax));
    let message = error_of(&rendered_without_film()).message;
    assert!(message.contains("no film"), "{message}");
}

fn find(bytes: &[u8], pattern: &[u8]) -> usize {
    bytes.windows(pattern.len()).position(|window| window == pattern).expect("the pattern")
}

fn rendered_without_film() -> Vec<u8> {
    let session = session(&Options { samples: Some(1), ..Options::default() }, 1);
    session.render(&()).expect("a picture").encode(Format::Exr).expect("an EXR")
}
