//! Report of a comparison as one self-contained HTML file.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::Verdict;

/// A compared pair with the pictures to show.
pub(crate) struct Shown {
    /// The pictures of [`CAPTIONS`], as PNGs.
    pub(crate) pictures: Vec<Vec<u8>>,
    pub(crate) verdict: Verdict,
}

/// The names of the pictures, and their captions.
const CAPTIONS: [(&str, &str); 4] = [
    ("picture", "the picture"),
    ("reference", "the reference"),
    (
        "difference",
        "relative difference of luminance; red: the picture is brighter, blue: darker; saturated at a quarter",
    ),
    ("FLIP", "visible difference when the two alternate: black none, white the largest"),
];

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;margin:2rem;background:#1b1b1d;color:#ddd}\
h2{margin:2.5rem 0 .5rem}table{border-collapse:collapse;margin:.5rem 0 1rem}td,th{padding:.15rem .8rem;text-align:right;\
border-bottom:1px solid #444}th:first-child,td:first-child{text-align:left}figure{margin:0}figcaption{color:#999;font-size:.85rem}\
.row{display:grid;grid-template-columns:repeat(auto-fit,minmax(20rem,1fr));gap:1rem}img{width:100%;image-rendering:pixelated}\
.bad{color:#f77}.good{color:#7d7}";

/// The page.
pub(crate) fn report(pairs: &[Shown]) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>lookfrom compare</title>\
         <style>{STYLE}</style></head><body>\n<h1>lookfrom compare</h1>\n"
    );
    // Writing to a string cannot fail.
    let _ = page.write_str(&overview(pairs));
    for pair in pairs {
        let Verdict { picture, reference, .. } = &pair.verdict;
        let _ = writeln!(page, "<h2>{} against {}</h2>", escaped(picture), escaped(reference));
        let _ = writeln!(page, "<pre>{}</pre>\n<div class=\"row\">", escaped(&pair.verdict.for_people()));
        for ((name, caption), png) in CAPTIONS.iter().zip(&pair.pictures) {
            let data = STANDARD.encode(png);
            let _ = writeln!(
                page,
                "<figure><img alt=\"{name}\" src=\"data:image/png;base64,{data}\"><figcaption>{caption}</figcaption></figure>"
            );
        }
        let _ = writeln!(page, "</div>");
    }
    page + "</body></html>\n"
}

/// Table with one row per pair.
fn overview(pairs: &[Shown]) -> String {
    let mut table =
        "<table><tr><th>picture</th><th>red</th><th>green</th><th>blue</th><th>pixels within</th>\
                     <th>blocks within</th><th>FLIP</th><th>RMSE</th><th></th></tr>\n"
            .to_owned();
    for Shown { verdict, .. } in pairs {
        let [red, green, blue] = verdict.relative.map(|share| format!("{:+.3} %", share * 100.0));
        let share = |of: Option<f64>| of.map_or("–".to_owned(), |share| format!("{:.2} %", share * 100.0));
        let noise = verdict.noise.as_ref();
        let (class, word) = match verdict.passed {
            None => ("", "not judged"),
            Some(true) => ("good", "passed"),
            Some(false) => ("bad", "failed"),
        };
        let _ = writeln!(
            table,
            "<tr><td>{}</td><td>{red}</td><td>{green}</td><td>{blue}</td><td>{}</td><td>{}</td><td>{:.4}</td><td>{:.6}</td>\
             <td class=\"{class}\">{word}</td></tr>",
            escaped(&verdict.picture),
            share(noise.map(|noise| noise.pixels_within)),
            share(noise.map(|noise| noise.blocks_within)),
            verdict.flip,
            verdict.rmse,
        );
    }
    table + "</table>\n"
}

/// Signed relative difference of luminance, `a` − `b` over the mean of both plus a tenth of the picture's mean: -1 … 1.
pub(crate) fn signed_difference(a: [f32; 3], b: [f32; 3], mean: f32) -> f32 {
    let light = |rgb: [f32; 3]| 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    let (a, b) = (light(a), light(b));
    let scale = 0.5 * (a.abs() + b.abs()) + 0.1 * mean.abs();
    if scale > 0.0 { ((a - b) / scale).clamp(-1.0, 1.0) } else { 0.0 }
}

/// Red above 0, blue below, black at 0; saturated from ±¼ on.
pub(crate) fn signed_color(difference: f32) -> [u8; 3] {
    let level = (difference.abs() * 4.0).min(1.0);
    let full = (level * 255.0 + 0.5) as u8;
    let half = (level * 110.0 + 0.5) as u8;
    if difference > 0.0 { [full, half, 0] } else { [0, half, full] }
}

/// Heat map from black over violet, red and orange to white.
pub(crate) fn heat_color(error: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; 6] = [
        [0.0, 0.0, 0.0],
        [60.0, 20.0, 110.0],
        [140.0, 40.0, 125.0],
        [220.0, 70.0, 90.0],
        [250.0, 160.0, 90.0],
        [255.0, 250.0, 225.0],
    ];
    let place = error.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let stop = (place as usize).min(STOPS.len() - 2);
    let part = place - stop as f32;
    [0, 1, 2].map(|c| (STOPS[stop][c] + part * (STOPS[stop + 1][c] - STOPS[stop][c]) + 0.5) as u8)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_say_which_and_how_much() {
        assert_eq!((heat_color(0.0), heat_color(1.0)), ([0; 3], [255, 250, 225]));
        assert_eq!(
            (signed_color(0.0), signed_color(1.0), signed_color(-1.0)),
            ([0; 3], [255, 110, 0], [0, 110, 255])
        );
        assert!(
            signed_difference([1.0; 3], [0.9; 3], 1.0) > 0.0
                && signed_difference([0.0; 3], [0.0; 3], 0.0) == 0.0
        );
    }

    #[test]
    fn names_are_no_tags() {
        assert_eq!(escaped("<a&\"b\">"), "&lt;a&amp;&quot;b&quot;&gt;");
    }
}
