//! Films of Mitsuba: the bands of a `specfilm`.

use lookfrom_scene::settings::{ColorMode, SpectralFilm};
use lookfrom_scene::spectrum::Curve;

use super::{error, told};

fn specfilm(parts: &str) -> String {
    format!(
        "<sensor type=\"perspective\"><film type=\"specfilm\">{parts}</film></sensor><shape type=\"sphere\"/>"
    )
}

#[test]
fn a_specfilm_has_bands_by_name() {
    let (scene, warnings) = told(&specfilm(
        r#"<integer name="width" value="4"/>
           <spectrum name="red" value="600:0, 650:1, 700:0"/>
           <spectrum name="blue" type="regular">
             <float name="wavelength_min" value="400"/><float name="wavelength_max" value="500"/>
             <string name="values" value="0, 0, 1, 0.5, 0"/>
           </spectrum>
           <spectrum name="green" type="irregular">
             <string name="wavelengths" value="500, 501"/><string name="values" value="1, 1"/>
           </spectrum>"#,
    ));
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.image.width, scene.render.color), (4, ColorMode::Spectral));
    let film = scene.image.spectral_film.expect("a spectral film");
    // All wavelengths at which any band has a response.
    assert_eq!((film.buckets, film.range), (0, [425.0, 700.0]));
    let widths: Vec<(&str, f64)> =
        film.bands.iter().map(|band| (&*band.name, band.width(SpectralFilm::ALL))).collect();
    assert_eq!(widths, [("blue", 37.5), ("green", 1.0), ("red", 50.0)]);
}

#[test]
fn bands_are_measured_where_there_is_light() {
    let (scene, warnings) = told(&specfilm(
        r#"<spectrum name="near" value="700:0, 800:1, 900:0"/>
           <spectrum name="far" value="850:1, 900:1"/>
           <spectrum name="all" value="0.5"/>"#,
    ));
    let film = scene.image.spectral_film.expect("a spectral film");
    assert_eq!(film.range, SpectralFilm::ALL);
    let names: Vec<&str> = film.bands.iter().map(|band| &*band.name).collect();
    assert_eq!(names, ["all", "near"]);
    assert_eq!(film.bands[0].response, Curve::Constant(0.5));
    let says = |part: &str| warnings.iter().any(|warning| warning.contains(part));
    assert!(says("without the rest of its response") && says("is left out"), "{warnings:?}");
}

#[test]
fn a_film_without_bands_is_refused() {
    for (film, expected) in [
        ("", "a spectrum for each of its bands"),
        (r#"<spectrum name="a b" value="1"/>"#, "no name of a band"),
        (r#"<spectrum name="x" type="srgb"><rgb name="color" value="1 0 0"/></spectrum>"#, "not a colour"),
    ] {
        let message = error(&specfilm(film)).to_string();
        assert!(message.contains(expected), "{message}");
    }
}
