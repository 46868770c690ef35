//! Spectral films: the means of buckets are those of the spectrum, and together they are the picture.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use crate::support::{Compiled, scene};
use lookfrom::film::Film;
use lookfrom::session::{FilmFile, Format, Options, Session};
use lookfrom_scene::image::read_exr;
use lookfrom_scene::settings::{ColorMode, Integrator, SpectralFilm};
use lookfrom_scene::spectrum::observer::{self, SAMPLES, Y_INTEGRAL};
use lookfrom_scene::spectrum::space::XYZ_FROM_RGB;
use lookfrom_scene::{Budget, LoadContext, Memory};

/// A spectrum with edges, by wavelength in nm.
const SPECTRUM: [(f64, f64); 6] =
    [(360.0, 0.2), (450.0, 1.0), (480.0, 0.1), (600.0, 2.0), (601.0, 0.4), (830.0, 1.5)];

/// The spectrum at each whole nm, where the renderer knows it, with the luminance 1.
fn curve() -> [f64; SAMPLES] {
    let at = |nm: f64| {
        let next = SPECTRUM.iter().position(|(end, _)| *end >= nm).expect("in the range").max(1);
        let ((x0, y0), (x1, y1)) = (SPECTRUM[next - 1], SPECTRUM[next]);
        y0 + (y1 - y0) * (nm - x0) / (x1 - x0)
    };
    let curve: [f64; SAMPLES] = std::array::from_fn(|i| at(360.0 + i as f64));
    let luminance: f64 = curve.iter().zip(&observer::matching()[1]).map(|(l, y)| l * f64::from(*y)).sum();
    curve.map(|value| value * Y_INTEGRAL / luminance)
}

/// The mean and the variance of the spectrum within a range of wavelengths in nm.
fn moments([from, to]: [f64; 2]) -> [f64; 2] {
    const STEPS: usize = 20_000;
    let curve = curve();
    let values = (0..STEPS).map(|k| {
        let nm = from + (to - from) * (k as f64 + 0.5) / STEPS as f64;
        curve[(nm - 360.0).round() as usize]
    });
    let [sum, squares] = values.fold([0.0; 2], |[sum, squares], v| [sum + v, squares + v * v]);
    let mean = sum / STEPS as f64;
    [mean, squares / STEPS as f64 - mean * mean]
}

/// A picture of 8 × 8 pixels, lit by the spectrum from all around.
fn lit(image: &str, rest: &str) -> Compiled {
    let curve: Vec<String> = SPECTRUM.iter().map(|(nm, value)| format!("[{nm:?}, {value:?}]")).collect();
    Compiled::new(scene(&format!(
        r#"
        [camera]
        lookfrom = [0, 0.3, 4]
        lookat = [0, 0.3, 0]
        fov = 24
        [image]
        width = 8
        height = 8
        {image}
        [render]
        integrator = "path"
        samples = 512
        color = "spectral"
        [[light]]
        type = "environment"
        color = {{ curve = [{}] }}
        {rest}
        "#,
        curve.join(", ")
    )))
}

/// Glass that disperses, where samples are left with one wavelength, and paint that does not.
const OBJECTS: &str = r#"
    [materials.glass]
    type = "dielectric"
    ior = "SF11"
    [materials.paint]
    type = "diffuse"
    reflectance = [0.8, 0.3, 0.1]
    [[sphere]]
    radius = 0.8
    material = "glass"
    [[sphere]]
    center = [0.8, 1, 0]
    radius = 0.6
    material = "paint"
"#;

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..8).flat_map(|y| (0..8).map(move |x| (x, y)))
}

/// The mean spectrum of all pixels.
fn spectrum(film: &Film) -> Vec<f64> {
    let mut means = vec![0.0; film.buckets()];
    for (x, y) in pixels() {
        means.iter_mut().zip(film.spectrum(x, y)).for_each(|(mean, value)| *mean += f64::from(value) / 64.0);
    }
    means
}

#[test]
fn buckets_are_the_means_of_the_spectrum() {
    for (buckets, range) in [(16, [360.0_f32, 830.0]), (5, [430.0, 655.0]), (3, [599.0, 602.0])] {
        let [from, to] = range.map(f64::from);
        let image =
            format!("filter = \"box\"\nspectral_buckets = {buckets}\nwavelengths = [{from:?}, {to:?}]");
        let film = lit(&image, "").film();
        let found = spectrum(&film);
        assert_eq!(found.len(), buckets as usize);
        let width = (to - from) / f64::from(buckets);
        let per_bucket = 64.0 * 512.0 * 4.0 / f64::from(buckets);
        for (index, found) in found.into_iter().enumerate() {
            let start = from + width * index as f64;
            let [mean, variance] = moments([start, start + width]);
            let error = (variance / per_bucket).sqrt() + 1e-6;
            assert!(
                (found - mean).abs() < 4.0 * error,
                "bucket {index} of {buckets}: {found} ≠ {mean} ± {error}"
            );
        }
    }
}

#[test]
fn light_of_all_wavelengths_alike_has_no_noise() {
    let toml = r#"
        [image]
        width = 8
        height = 8
        filter = "box"
        spectral_buckets = 7
        [render]
        integrator = "path"
        samples = 16
        color = "spectral"
        [[light]]
        type = "environment"
        color = { curve = [[300, 1], [900, 1]], scale = 3 }
    "#;
    let film = Compiled::new(scene(toml)).film();
    for (x, y) in pixels() {
        for value in film.spectrum(x, y) {
            assert!((value - 3.0).abs() < 1e-5, "{value}");
        }
    }
}

/// X, Y and Z of a spectrum of the buckets of a film, each constant over its width.
fn xyz(film: &SpectralFilm, spectrum: &[f64]) -> [f64; 3] {
    const STEPS: usize = 200_000;
    let [from, to] = film.range.map(f64::from);
    let mut xyz = [0.0; 3];
    for step in 0..STEPS {
        let nm = from + (to - from) * (step as f64 + 0.5) / STEPS as f64;
        let radiance = spectrum[film.bucket_of(nm as f32)];
        for (sum, function) in xyz.iter_mut().zip(observer::matching()) {
            let index = (nm - 360.0).round() as usize;
            *sum += f64::from(function[index]) * radiance * (to - from) / STEPS as f64 / Y_INTEGRAL;
        }
    }
    xyz
}

#[test]
fn buckets_by_the_matching_functions_are_the_picture() {
    for (buckets, range, limit) in
        [(94, [360.0_f32, 830.0], ""), (60, [500.0, 650.0], ""), (94, [360.0, 830.0], "max_component = 2")]
    {
        let [from, to] = range;
        let film = format!("spectral_buckets = {buckets}\nwavelengths = [{from:?}, {to:?}]");
        // This filter has negative weights.
        let film = lit(&format!("filter = \"mitchell\"\n{film}\n{limit}"), OBJECTS).film();
        let found = xyz(&SpectralFilm { buckets, range, ..SpectralFilm::NONE }, &spectrum(&film));
        let mut rgb = [0.0; 3];
        let mut variance = [0.0; 3];
        for (x, y) in pixels() {
            for c in 0..3 {
                rgb[c] += f64::from(film.mean(x, y)[c]) / 64.0;
                variance[c] += f64::from(film.variance(x, y)[c]) / (64.0 * 64.0 * 512.0);
            }
        }
        let expected = XYZ_FROM_RGB.map(|row| (0..3).map(|c| row[c] * rgb[c]).sum::<f64>());
        for c in 0..3 {
            // The noise of both, and the light that varies within a bucket.
            let error = variance[c].sqrt();
            let tolerance = 5.0 * error + 2e-3 * expected[c];
            assert!(
                (found[c] - expected[c]).abs() < tolerance,
                "{buckets} of {range:?}, {limit}: {found:?} ≠ {expected:?} ± {error}"
            );
        }
    }
}

/// A table of TOML: the values at each nm from 360.
fn table(values: impl Iterator<Item = f64>) -> String {
    let entries: Vec<String> =
        values.enumerate().map(|(index, value)| format!("[{}, {value:?}]", 360 + index)).collect();
    format!("{{ curve = [{}] }}", entries.join(", "))
}

#[test]
fn bands_are_integrals_of_light_and_response() {
    // A triangle, one wavelength and its neighbours, and all that is 2 there.
    let responses: [fn(f64) -> f64; 3] =
        [|nm| (1.0 - (nm - 500.0).abs() / 60.0).max(0.0), |nm| f64::from(nm == 610.0), |_| 2.0];
    for wavelengths in ["", "wavelengths = [430, 700]", "spectral_buckets = 2"] {
        let [from, to] = if wavelengths.contains("430") { [430, 700] } else { [360, 830] };
        let table = |k: usize| table((360..=830).map(|nm| responses[k](f64::from(nm))));
        let bands = format!("bands = {{ a = {}, b = {}, c = {} }}", table(0), table(1), table(2));
        let film = lit(&format!("filter = \"box\"\n{wavelengths}\n{bands}"), "").film();
        let found = spectrum(&film);
        let buckets = found.len() - 3;
        assert_eq!(buckets, if wavelengths.contains("buckets") { 2 } else { 0 });
        let curve = curve();
        for (found, response) in found[buckets..].iter().zip(responses) {
            let width = f64::from(to - from);
            // In steps of 1/8 nm, since the response is linear between whole nm, and light constant around them.
            let values = (0..8 * (to - from)).map(|step| {
                let nm = f64::from(from) + (f64::from(step) + 0.5) / 8.0;
                let t = nm - nm.floor();
                let response = response(nm.floor()) * (1.0 - t) + response(nm.ceil()) * t;
                curve[(nm - 360.0).round() as usize] * response * width
            });
            let count = values.len() as f64;
            let [sum, squares] = values.fold([0.0; 2], |[sum, squares], v| [sum + v, squares + v * v]);
            let mean = sum / count;
            let error = ((squares / count - mean * mean) / (64.0 * 512.0 * 4.0)).sqrt() + 1e-4 * mean;
            assert!((found - mean).abs() < 4.0 * error, "{wavelengths}: {found} ≠ {mean} ± {error}");
        }
    }
}

#[test]
fn a_band_of_the_eye_is_the_luminance_of_the_picture() {
    // Glass leaves samples with one wavelength; the filter has negative weights.
    let response = table(observer::matching()[1].iter().map(|y| f64::from(*y)));
    for limit in ["", "max_component = 2"] {
        let film =
            lit(&format!("filter = \"mitchell\"\nbands = {{ y = {response} }}\n{limit}"), OBJECTS).film();
        for (x, y) in pixels() {
            let rgb = film.mean(x, y);
            let luminance: f64 = (0..3).map(|c| XYZ_FROM_RGB[1][c] * f64::from(rgb[c])).sum();
            let band = film.spectrum(x, y).next().map(f64::from).expect("a band") / Y_INTEGRAL;
            // The observer is a step function of 1 nm, the band linear in between.
            assert!((band - luminance).abs() < 2e-3 * luminance, "{x}, {y}: {band} ≠ {luminance}");
        }
    }
}

#[test]
fn the_picture_of_a_range_is_the_same_with_and_without_buckets() {
    let [with, without] =
        ["spectral_buckets = 9\nwavelengths = [400, 700]", "wavelengths = [400, 700]"].map(|image| {
            let film = lit(image, OBJECTS).film();
            (film.buckets(), film.picture().pixels)
        });
    assert_eq!((with.0, without.0), (9, 0));
    assert_eq!(with.1, without.1);
}

const SCENE: &[u8] = br#"
[image]
width = 5
height = 3
spectral_buckets = 4
wavelengths = [400, 700]
bands = { wide = { constant = 2 }, red = { curve = [[600, 0], [650, 1], [700, 0]] } }
[render]
integrator = "path"
color = "spectral"
samples = 2
[[light]]
type = "environment"
color = { kelvin = 3000 }
"#;

fn session(options: &Options) -> lookfrom_scene::Result<Session> {
    Session::from_bytes("s.toml", SCENE.to_vec(), options)
}

#[test]
fn an_exr_has_the_layout_of_fichet_and_others() {
    let options = Options { film: true, ..Options::default() };
    let session_of_film = session(&options).expect("a scene");
    let finished = session_of_film.render(&()).expect("a picture");
    let mut film = Cursor::new(Vec::new());
    let provenance = session_of_film.provenance().expect("a film is kept");
    provenance.write(&finished.rendered.film, &finished.developed, &mut film).expect("memory");
    let file = FilmFile::read(film.get_ref(), Path::new("f.exr"), &Budget::default()).expect("a film");
    let mut developed = Cursor::new(Vec::new());
    file.develop(&file.provenance.development)
        .write(Some(&file.film), Format::Exr, &mut developed)
        .expect("memory");
    for bytes in [finished.encode(Format::Exr).expect("an EXR"), developed.into_inner(), film.into_inner()] {
        let path = PathBuf::from("p.exr");
        let files = Memory([(path.clone(), bytes)].into());
        let exr = read_exr(&path, &mut LoadContext::new(&files)).expect("an EXR");
        let names: Vec<&str> = exr.channels.iter().map(|(name, _)| &**name).collect();
        let of_spectrum: Vec<&str> = names.iter().copied().filter(|name| name.starts_with('S')).collect();
        assert_eq!(of_spectrum, ["S0.437,500nm", "S0.512,500nm", "S0.587,500nm", "S0.662,500nm"]);
        assert!(["R", "G", "B"].iter().all(|name| names.contains(name)), "{names:?}");
        let text = |name: &str| {
            let found = exr.attributes.iter().find(|(known, _)| known == name);
            found.map(|(_, text)| text.as_str())
        };
        assert_eq!(text("spectralLayoutVersion"), Some("1.0"));
        assert_eq!(text("emissiveUnits"), Some("W.m^-2.sr^-1"));
        assert_eq!((text("spectral_buckets"), text("wavelengths")), (Some("4"), Some("400 700")));
        let of_bands: Vec<&str> = names.iter().copied().filter(|name| name.starts_with("band")).collect();
        assert_eq!(of_bands, ["band.red", "band.wide"]);
        assert_eq!((text("band.red"), text("band.wide")), (Some("50 nm"), Some("600 nm")));
        // A light bulb is redder than white.
        let sum = |name: &str| -> f32 {
            let found = exr.channels.iter().find(|(known, _)| known == name);
            found.expect("a channel").1.iter().sum()
        };
        assert!(sum("S0.662,500nm") > 2.0 * sum("S0.437,500nm"));
        // 15 pixels of a light of luminance 1, of which there is twice as much at 600 nm and beyond.
        let (wide, red) = (sum("band.wide") / 15.0, sum("band.red") / 15.0);
        assert!((400.0..900.0).contains(&wide) && red > 50.0 && red < wide / 4.0, "{wide}, {red}");
    }
    // What cannot hold them has the same picture.
    let options = Options { format: Some(Format::Png), ..Options::default() };
    let png = session(&options).expect("a scene").render(&()).expect("a picture");
    assert_eq!((png.rendered.film.buckets(), &png.picture), (0, &finished.picture));
}

#[test]
fn options_change_the_film_of_a_scene() {
    let film = |spectral_buckets, wavelengths| {
        let options = Options { spectral_buckets, wavelengths, ..Options::default() };
        let session = session(&options).expect("a scene");
        let film = session.image().spectral_film.as_ref()?;
        assert_eq!(film.bands.is_empty(), spectral_buckets == Some(0));
        Some(SpectralFilm { bands: Vec::new(), ..film.clone() })
    };
    let of = |buckets, range| Some(SpectralFilm { buckets, range, ..SpectralFilm::NONE });
    assert_eq!(film(None, None), of(4, [400.0, 700.0]));
    assert_eq!(film(Some(30), None), of(30, [400.0, 700.0]));
    assert_eq!(film(None, Some([360.0, 830.0])), of(4, [360.0, 830.0]));
    assert_eq!(film(Some(0), None), None);
    assert_eq!(film(Some(0), Some([450.0, 460.0])), of(0, [450.0, 460.0]));
}

#[test]
fn a_spectral_film_needs_light_of_wavelengths() {
    let refused = |options: &Options| session(options).map(|_| ()).expect_err("no wavelengths").to_string();
    let rgb = Options { color: Some(ColorMode::Rgb), ..Options::default() };
    let message = refused(&rgb);
    assert!(message.contains("rendered in RGB") && message.contains("`color` = spectral"), "{message}");
    assert!(session(&Options { spectral_buckets: Some(0), ..rgb }).is_ok());
    let message = refused(&Options { integrator: Some(Integrator::Normals), ..Options::default() });
    assert!(message.contains("normals"), "{message}");
    let message = refused(&Options { wavelengths: Some([400.0, 500.0]), ..Options::default() });
    assert!(message.contains("\"red\" has no response between 400 and 500 nm"), "{message}");
    for (buckets, range) in [(u32::MAX, SpectralFilm::ALL), (3, [700.0, 400.0]), (3, [f32::NAN, 500.0])] {
        let options =
            Options { spectral_buckets: Some(buckets), wavelengths: Some(range), ..Options::default() };
        let message = refused(&options);
        assert!(message.contains("expected"), "{message}");
    }
}
