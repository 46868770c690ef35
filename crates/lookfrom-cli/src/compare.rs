//! `lookfrom compare`: differences between pictures and references, as the library computes them.

use std::path::Path;

use lookfrom::core::color;
use lookfrom::film::Picture;
use lookfrom::post::develop::srgb8;
use lookfrom_scene::image::compare::{Comparison, Sampled, channels_of_both, compare};
use lookfrom_scene::image::flip::{PIXELS_PER_DEGREE, flip};
use lookfrom_scene::image::{self, Encoding, Reading};
use lookfrom_scene::settings::Tonemap;
use lookfrom_scene::spectrum::space::XYZ_FROM_RGB;
use lookfrom_scene::{Disk, Inputs, LoadContext, Location};
use rayon::prelude::*;
use serde::Serialize;

use crate::args::CompareArguments;
use crate::exit::{self, BAD_SCENE, DONE, Failure, answer, say};
use crate::output;
use lookfrom_scene::json;
use lookfrom_scene::plural::{are, counted};

mod html;

use html::Shown;

/// A difference of means up to this many standard errors is explained by noise.
const MOST_STANDARD_ERRORS_OF_MEAN: f64 = 3.5;

/// Result of the comparison of a pair; docs/guide/command.md explains the keys.
#[derive(Debug, Serialize)]
pub(crate) struct Verdict {
    pub(crate) picture: String,
    pub(crate) reference: String,
    pub(crate) means: [[f64; 3]; 2],
    pub(crate) relative: [f64; 3],
    pub(crate) rmse: f64,
    pub(crate) relative_mse: f64,
    pub(crate) flip: f64,
    pub(crate) noise: Option<Noise>,
    pub(crate) not_finite: usize,
    /// Whether it passed the criteria; `None` without any.
    pub(crate) passed: Option<bool>,
    /// Why it failed.
    pub(crate) reasons: Vec<String>,
}

/// Result of the z-tests against the measured variances.
#[derive(Debug, Serialize)]
pub(crate) struct Noise {
    pub(crate) channels: NoiseChannels,
    pub(crate) pixels_within: f64,
    pub(crate) blocks_within: f64,
    pub(crate) mean: [f64; 3],
    pub(crate) relative_error_of_mean: f64,
}

/// Channels of the variances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) enum NoiseChannels {
    /// X, Y and Z of the standard observer.
    #[serde(rename = "XYZ")]
    Xyz,
    /// Channels of the sensor that a picture or the command line names.
    #[serde(rename = "sensor")]
    Sensor,
}

/// Compares every pair and returns the exit code.
pub(crate) fn run(arguments: &CompareArguments) -> u8 {
    match compare_all(arguments) {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}

fn compare_all(arguments: &CompareArguments) -> Result<u8, Failure> {
    if !arguments.pictures.len().is_multiple_of(2) {
        return Err(Failure::Usage(format!(
            "{} are not pairs; give PICTURE REFERENCE for each comparison",
            counted(arguments.pictures.len(), "picture")
        )));
    }
    let inputs = Inputs::default();
    let mut shown = Vec::new();
    let mut code = DONE;
    for pair in arguments.pictures.chunks_exact(2) {
        let (verdict, pictures) = compare_pair(&pair[0], &pair[1], arguments, &inputs)?;
        if verdict.passed == Some(false) {
            code = BAD_SCENE;
        }
        if arguments.json {
            answer(&json::line(&verdict))?;
        } else {
            answer(&verdict.for_people())?;
        }
        if arguments.html.is_some() {
            shown.push(pictures.shown(verdict, arguments.exposure)?);
        }
    }
    if let Some(path) = &arguments.html {
        output::replace_file(path, html::report(&shown).as_bytes(), &inputs, "--html")?;
    }
    Ok(code)
}

/// A picture, its reference and their FLIP map.
struct Pictures {
    picture: Sampled,
    reference: Sampled,
    flip: Vec<f32>,
}

fn compare_pair(
    picture: &Path,
    reference: &Path,
    arguments: &CompareArguments,
    inputs: &Inputs,
) -> Result<(Verdict, Pictures), Failure> {
    let files = inputs.record(&Disk, "the comparison");
    let mut context = LoadContext::within(&arguments.memory.budget(), &files);
    let layer = arguments.layer.as_deref();
    let [of_picture, of_reference] = arguments.samples.map_or([None; 2], |samples| samples.map(Some));
    let (mut a, mut b) = (
        read(picture, layer, of_picture, &mut context)?,
        read(reference, layer, of_reference, &mut context)?,
    );
    if b.not_finite > 0 {
        let values = are(b.not_finite as u64, "value");
        say(&format!("warning: {}: {values} not finite, and count as 0", reference.display()));
    }
    if let Some(sensor) = &arguments.sensor {
        let said = *color::Sensor::new(sensor).variance_from_rgb();
        for side in [&mut a, &mut b] {
            side.channels_from_rgb.get_or_insert(said);
        }
    }
    let channels = channels_of_both(&a, &b);
    if channels.is_none() && a.variances.is_some() && b.variances.is_some() {
        let (picture, reference) = (picture.display(), reference.display());
        say(&format!(
            "warning: {picture} and {reference} have variances of different sensors: noise is not compared"
        ));
    }
    let Comparison { means, relative, rmse, relative_mse, noise } =
        compare(&a, &b).map_err(exit::in_scene(picture))?;
    let scale = 2.0_f32.powf(arguments.exposure);
    let map = flip([&a.pixels, &b.pixels], a.width, scale, PIXELS_PER_DEGREE);
    let mut verdict = Verdict {
        picture: picture.display().to_string(),
        reference: reference.display().to_string(),
        means,
        relative,
        rmse,
        relative_mse,
        flip: map.iter().map(|&error| f64::from(error)).sum::<f64>() / map.len() as f64,
        noise: noise.map(|noise| Noise {
            channels: if channels == Some(XYZ_FROM_RGB) { NoiseChannels::Xyz } else { NoiseChannels::Sensor },
            pixels_within: noise.pixels_within,
            blocks_within: noise.blocks_within,
            mean: noise.mean,
            relative_error_of_mean: noise.relative_error_of_mean,
        }),
        not_finite: a.not_finite,
        passed: None,
        reasons: Vec::new(),
    };
    verdict.judge(arguments);
    Ok((verdict, Pictures { picture: a, reference: b, flip: map }))
}

/// Bytes of a pixel of [`Sampled`].
const PIXEL: u64 = 12;

/// Reads a picture of any format, or a layer of it; only the picture of an EXR can have variances.
pub(crate) fn read(
    path: &Path,
    layer: Option<&str>,
    samples: Option<u64>,
    context: &mut LoadContext<'_>,
) -> Result<Sampled, Failure> {
    let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let sampled = if is_exr {
        let mut file = image::read_exr_layer(path, layer, context)?;
        if layer.is_some() {
            // The variances are those of the picture.
            file.channels.retain(|(name, _)| !name.starts_with("Variance."));
        }
        Sampled::new(&file, samples)
    } else {
        let reading = Reading { layer, keeps_not_finite: true, ..Reading::new(Encoding::Srgb) };
        let picture = image::read_as(path, &reading, context)?;
        context.keep(picture.len() as u64 * PIXEL, "the compared picture", &Location::file(path))?;
        Ok(Sampled::of_colors(picture.width, picture.texels().collect()))
    };
    exit::say_warnings(&std::mem::take(&mut context.warnings));
    sampled.map_err(exit::in_scene(path))
}

impl Pictures {
    /// The pictures as PNGs, for the report.
    fn shown(self, verdict: Verdict, exposure: f32) -> Result<Shown, Failure> {
        let Self { picture, reference, flip } = self;
        let (width, height) = (picture.width as u32, (picture.pixels.len() / picture.width) as u32);
        let developed = |of: &Sampled| {
            let picture = Picture { width, height, pixels: of.pixels.clone(), alpha: Vec::new() };
            srgb8(&picture, exposure, Tonemap::Clamp)
        };
        let mean = mean_light(&verdict);
        let difference =
            |(a, b): (&[f32; 3], &[f32; 3])| html::signed_color(html::signed_difference(*a, *b, mean));
        // In the order of their captions.
        let bytes: [&(dyn Fn() -> Vec<u8> + Sync); 4] = [
            &|| developed(&picture),
            &|| developed(&reference),
            &|| picture.pixels.iter().zip(&reference.pixels).flat_map(difference).collect(),
            &|| flip.iter().copied().flat_map(html::heat_color).collect(),
        ];
        let pictures: Result<Vec<_>, lookfrom_scene::Error> =
            bytes.par_iter().map(|bytes| image::encode_png(width, height, &bytes())).collect();
        Ok(Shown { pictures: pictures.map_err(|error| Failure::Output(error.message))?, verdict })
    }
}

fn mean_light(verdict: &Verdict) -> f32 {
    (verdict.means[1].iter().sum::<f64>() / 3.0) as f32
}

impl Verdict {
    /// Judges the pair by the tolerances that are asked for; values that are not finite are wrong in any case.
    fn judge(&mut self, arguments: &CompareArguments) {
        let mut reasons = Vec::new();
        let deviations = self.noise.as_ref().map(|noise| noise.mean);
        let explained =
            deviations.is_some_and(|mean| mean.iter().all(|z| z.abs() <= MOST_STANDARD_ERRORS_OF_MEAN));
        if let Some(tolerance) = arguments.tolerance.filter(|_| !explained) {
            let beyond = |(channel, share): (&str, &f64)| {
                // A difference that is no number is beyond every tolerance.
                let is_within = share.abs() <= tolerance;
                (!is_within).then(|| format!("{channel} by {:+.3} %", share * 100.0))
            };
            let far: Vec<String> =
                ["red", "green", "blue"].into_iter().zip(&self.relative).filter_map(beyond).collect();
            if !far.is_empty() {
                let noise = match deviations {
                    Some(mean) => {
                        format!("{:.1} standard errors", mean.iter().map(|z| z.abs()).fold(0.0, f64::max))
                    }
                    None => "noise unknown".to_owned(),
                };
                let allowed = tolerance * 100.0;
                reasons.push(format!(
                    "the means differ in {} ({noise}); allowed are {allowed} %",
                    far.join(", ")
                ));
            }
        }
        if let Some(least) = arguments.within {
            let least_percent = least * 100.0;
            match &self.noise {
                Some(noise) if noise.pixels_within >= least => {}
                Some(noise) => reasons.push(format!(
                    "{:.2} % of the pixels are within 3.5 standard errors; expected {least_percent} %",
                    noise.pixels_within * 100.0
                )),
                None => reasons.push(
                    "the noise is unknown, which --within needs: both pictures as .exr with --layers geometry".to_owned(),
                ),
            }
        }
        if self.not_finite > 0 {
            reasons.push(format!("{} not finite", are(self.not_finite as u64, "value")));
        }
        let has_criterion =
            arguments.tolerance.is_some() || arguments.within.is_some() || self.not_finite > 0;
        self.passed = has_criterion.then_some(reasons.is_empty());
        self.reasons = reasons;
    }

    /// The judgement in words, with its reasons.
    fn conclusion(&self) -> String {
        match self.passed {
            None => "not judged, without --tolerance or --within".to_owned(),
            Some(true) => "passed".to_owned(),
            Some(false) => format!("failed: {}", self.reasons.join("; ")),
        }
    }

    /// The result as text.
    pub(crate) fn for_people(&self) -> String {
        let percent = |share: f64| format!("{:+.3} %", share * 100.0);
        let mean = |mean: [f64; 3]| mean.map(|channel| format!("{channel:.6}")).join(" ");
        let noise = match &self.noise {
            Some(noise) => {
                let [channels, second] = match noise.channels {
                    NoiseChannels::Xyz => ["X, Y, Z", "Y"],
                    NoiseChannels::Sensor => ["the sensor's channels", "the second channel"],
                };
                format!(
                    "\n  noise       {:.2} % of the pixels and {:.2} % of the blocks within 3.5 standard errors; the means differ by \
                     {} standard errors ({channels}); one standard error is {:.3} % of {second}",
                    noise.pixels_within * 100.0,
                    noise.blocks_within * 100.0,
                    noise.mean.map(|z| format!("{z:+.2}")).join(" "),
                    noise.relative_error_of_mean * 100.0,
                )
            }
            None => String::new(),
        };
        let not_finite = match self.not_finite {
            0 => String::new(),
            count => format!("\n  not finite  {}", counted(count, "value")),
        };
        format!(
            "{} against {}: {}\n  means       {} against {}\n  difference  {}\n  errors      RMSE {:.6}, relative MSE {:.6}, FLIP {:.4}{noise}{not_finite}",
            self.picture,
            self.reference,
            self.conclusion(),
            mean(self.means[0]),
            mean(self.means[1]),
            self.relative.map(percent).join(" "),
            self.rmse,
            self.relative_mse,
            self.flip,
        )
    }
}
