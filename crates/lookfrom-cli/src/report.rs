//! Summaries of a render: text on stderr, JSON on stdout.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use lookfrom::film::SampleId;
use lookfrom::render::{Rays, StopReason};
use lookfrom::session::{Finished, Outlier, Outliers, Session};
use lookfrom_scene::WarningKind;
use serde::Serialize;

use crate::exit::{self, Failure};
use lookfrom_scene::json;
use lookfrom_scene::plural::{are, counted};

/// Number of fireflies that are listed.
const MOST_FIREFLIES: usize = 3;

/// Summary of the render of one scene. The names are those of the JSON object, which docs/guide/command.md explains.
#[derive(Debug, Serialize)]
pub(crate) struct Summary {
    pub(crate) scene: String,
    /// The number of the picture in the call, from 1, and the number of all, if there are several.
    #[serde(skip)]
    pub(crate) place: Option<[usize; 2]>,
    /// `None` where the render was stopped before there was a picture.
    pub(crate) output: Option<String>,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) samples: u32,
    pub(crate) samples_taken: u64,
    pub(crate) ended_by: &'static str,
    /// `None` where there are too few samples for an estimate.
    pub(crate) relative_error: Option<f64>,
    pub(crate) integrator: &'static str,
    pub(crate) denoised: bool,
    /// A hash of the light of all pixels, before development. `None` until it is asked for.
    pub(crate) hash: Option<String>,
    pub(crate) seconds: Seconds,
    pub(crate) rays: RayCounts,
    pub(crate) mrays_per_s: f64,
    pub(crate) peak_memory_bytes: Option<u64>,
    pub(crate) triangles: u64,
    pub(crate) spheres: u64,
    pub(crate) instances: u64,
    /// Warnings: the picture may differ from what was meant.
    pub(crate) warnings: Vec<String>,
    /// Notes: harmless warnings.
    pub(crate) notices: Vec<String>,
    pub(crate) cancelled: bool,
    pub(crate) dropped_samples: Dropped,
    pub(crate) fireflies: Outliers,
}

/// Wall-clock times.
#[derive(Debug, Serialize)]
pub(crate) struct Seconds {
    pub(crate) read: f64,
    pub(crate) build: f64,
    pub(crate) render: f64,
    /// The part of `render` after the last sample: fireflies, denoising.
    pub(crate) develop: f64,
    /// After that: encoding, and writing the file.
    pub(crate) write: f64,
}

/// Rays by kind.
#[derive(Debug, Serialize)]
pub(crate) struct RayCounts {
    pub(crate) camera: u64,
    pub(crate) secondary: u64,
    pub(crate) shadow: u64,
    pub(crate) total: u64,
}

/// Samples that were not finite and were left out.
#[derive(Debug, Serialize)]
pub(crate) struct Dropped {
    pub(crate) count: u64,
    pub(crate) first: Option<DroppedAddress>,
}

/// Pixel and index of a dropped sample.
#[derive(Debug, Serialize)]
pub(crate) struct DroppedAddress {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) sample: u32,
}

impl From<Rays> for RayCounts {
    fn from(rays: Rays) -> Self {
        Self { camera: rays.camera, secondary: rays.secondary, shadow: rays.shadow, total: rays.total() }
    }
}

impl From<SampleId> for DroppedAddress {
    fn from(id: SampleId) -> Self {
        Self { x: id.pixel[0], y: id.pixel[1], sample: id.sample }
    }
}

impl Summary {
    /// The summary without the output's name, the times of render and write, and the fireflies.
    pub(crate) fn new(session: &Session, finished: &Finished) -> Self {
        let (info, rendered) = (session.info(), &finished.rendered);
        let film = &rendered.film;
        let is_cancelled = rendered.reason == StopReason::Cancelled;
        Self {
            scene: session.name().to_owned(),
            place: None,
            output: None,
            width: session.image().width,
            height: session.image().height,
            samples: if is_cancelled { session.settings().samples } else { rendered.samples },
            samples_taken: finished.samples_taken(),
            ended_by: rendered.reason.word(),
            relative_error: rendered.error.is_finite().then_some(rendered.error),
            integrator: session.renderer().integrator(),
            denoised: finished.denoised,
            hash: None,
            seconds: Seconds {
                read: seconds(info.read),
                build: seconds(info.build),
                render: 0.0,
                develop: seconds(finished.developing),
                write: 0.0,
            },
            rays: rendered.rays.into(),
            mrays_per_s: 0.0,
            peak_memory_bytes: None,
            triangles: info.counts.triangles,
            spheres: info.counts.spheres,
            instances: info.counts.instances,
            warnings: exit::lines(session.warnings(), WarningKind::Warning),
            notices: exit::lines(session.warnings(), WarningKind::Notice),
            cancelled: is_cancelled,
            dropped_samples: Dropped { count: film.dropped(), first: film.first_dropped().map(Into::into) },
            fireflies: Outliers::default(),
        }
    }

    /// Adds the fireflies, whose samples are traced again.
    pub(crate) fn find_fireflies(&mut self, session: &Session, finished: &Finished) {
        self.fireflies = session.fireflies(&finished.rendered.film, MOST_FIREFLIES);
    }

    /// Adds the times of render and write, in seconds, and the memory.
    pub(crate) fn measured(&mut self, render: f64, write: f64) {
        (self.seconds.render, self.seconds.write) = (render, write);
        self.mrays_per_s = self.rays.total as f64 * 1e-6 / render.max(1e-6);
        self.peak_memory_bytes = peak_memory();
    }

    /// The summary as one line of JSON.
    pub(crate) fn as_json(&self) -> String {
        json::line(self)
    }

    /// The times of all steps, and the mean number of samples, for a person.
    pub(crate) fn steps(&self) -> String {
        let Seconds { read, build, render, develop, write } = self.seconds;
        let steps = [
            ("read", read, "files to a scene"),
            ("build", build, "scene to a world, its trees, the exposure"),
            ("sample", render - develop, "paths of light"),
            (
                "develop",
                develop,
                if self.denoised { "film to a picture, denoised" } else { "film to a picture" },
            ),
            ("write", write, "encoding, the file"),
        ];
        let mut lines = vec![format!("  steps of {}:", self.scene)];
        lines.extend(steps.map(|(name, time, what)| format!("    {name:<8} {time:>9.3} s  {what}")));
        lines.join("\n")
    }

    /// The summary for a person; of one of several pictures only a line, and what is remarkable.
    pub(crate) fn for_people(&self) -> String {
        let Self { scene, width, height, samples, integrator, .. } = self;
        let RayCounts { camera, secondary, shadow, total } = self.rays;
        let Seconds { read, build, render, write, .. } = self.seconds;
        let output = self.output.as_deref().unwrap_or("nothing");
        let memory = self.peak_memory_bytes.map_or("unknown".to_owned(), bytes);
        let [camera, secondary, shadow, total] = [camera, secondary, shadow, total].map(thousands);
        let is_one_of_several = self.place.is_some();
        let mut text = String::new();
        // Writing to a string cannot fail.
        if let Some([number, count]) = self.place {
            let _ = write!(text, "{number} of {count}: ");
        }
        let is_allocated = self.ended_by == "samples" && self.samples_taken != u64::from(*samples);
        let each = match is_allocated && !self.cancelled {
            true => {
                format!("{} per pixel in the mean, at most {samples}", counted(self.samples_taken, "sample"))
            }
            false => format!("{} per pixel", counted(*samples, "sample")),
        };
        let _ = write!(
            text,
            "{scene} → {output}: {width} × {height} pixels, {each}, {integrator}{}",
            if self.denoised { ", denoised" } else { "" }
        );
        if is_one_of_several {
            let _ = write!(text, ", {:.2} s", read + build + render + write);
        } else {
            let _ = write!(
                text,
                "\n  rays    {total} ({camera} camera, {secondary} secondary, {shadow} shadow), {:.2} Mrays/s\n  time    \
                 read {read:.2} s, build {build:.2} s, render {render:.2} s, write {write:.2} s\n  memory  {memory} at \
                 the peak",
                self.mrays_per_s
            );
        }
        let _ = match &self.output {
            None => {
                write!(text, "\nstopped after {render:.1} s, before the first samples; nothing is written")
            }
            Some(output) if self.cancelled => write!(
                text,
                "\nstopped after {render:.1} s; {output} holds the picture so far: {} of {}",
                self.samples_taken,
                counted(*samples, "sample"),
            ),
            Some(_) if self.ended_by == "samples" => Ok(()),
            Some(_) => {
                let error = self.relative_error.map_or("unknown".to_owned(), |error| format!("{error:.4}"));
                write!(
                    text,
                    "\n  stopped by {}: at most {} per pixel, {} on average; relative error {error}",
                    self.ended_by,
                    counted(*samples, "sample"),
                    self.samples_taken
                )
            }
        };
        // The inspector knows the scene's number of samples, not the number that a limit or an allocation led to.
        let of = match is_allocated || matches!(self.ended_by, "time" | "noise") {
            true => format!(" --samples {samples}"),
            false => String::new(),
        };
        if let Dropped { count, first: Some(DroppedAddress { x, y, sample }) } = self.dropped_samples {
            let _ = write!(
                text,
                "\nwarning: {} not finite and left out; to replay {}, with the same options:\n  \
                 lookfrom inspect {scene} {x} {y} --sample {sample}{of}",
                are(count, "sample"),
                if count == 1 { "it" } else { "the first" }
            );
        }
        // The denoiser removes them.
        let Outliers { count, brightest } = &self.fireflies;
        if *count > 0 && !self.denoised {
            let (pixels, are) = if *count == 1 { ("pixel", "is") } else { ("pixels", "are") };
            let _ = write!(
                text,
                "\n  noise   {} {pixels} {are} made far brighter by single samples",
                thousands(*count as u64)
            );
            if let Some(Outlier { x, y, sample, .. }) = brightest.first() {
                let _ =
                    write!(text, "; the brightest: lookfrom inspect {scene} {x} {y} --sample {sample}{of}");
            }
        }
        text
    }
}

/// The JSON object of a scene that could not be rendered.
pub(crate) fn failure(scene: &Path, failure: &Failure) -> String {
    #[derive(Serialize)]
    struct Failed {
        scene: String,
        error: String,
    }
    json::line(&Failed { scene: scene.display().to_string(), error: failure.to_string() })
}

/// The JSON object of a picture that is there already.
pub(crate) fn skipped(scene: &Path, output: &str) -> String {
    #[derive(Serialize)]
    struct Skipped<'a> {
        scene: String,
        output: &'a str,
        skipped: bool,
    }
    json::line(&Skipped { scene: scene.display().to_string(), output, skipped: true })
}

/// A duration in seconds, to the microsecond.
pub(crate) fn seconds(duration: Duration) -> f64 {
    duration.as_micros() as f64 / 1e6
}

/// Peak resident memory of this process so far, on systems that report it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| kilobytes * 1024)
}

/// A number with its digits in groups of three.
pub(crate) fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let mut grouped = String::with_capacity(digits.len() * 4 / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    grouped
}

/// A number of bytes in a suitable unit.
pub(crate) fn bytes(number: u64) -> String {
    match number {
        0..10_000 => format!("{number} bytes"),
        10_000..10_000_000 => format!("{:.1} kB", number as f64 * 1e-3),
        10_000_000..10_000_000_000 => format!("{:.1} MB", number as f64 * 1e-6),
        _ => format!("{:.1} GB", number as f64 * 1e-9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary() -> Summary {
        Summary {
            scene: "a.toml".into(),
            place: None,
            output: Some("a.png".into()),
            width: 4,
            height: 3,
            samples: 64,
            samples_taken: 64,
            ended_by: "samples",
            relative_error: None,
            integrator: "whitted",
            denoised: false,
            hash: Some("0123456789abcdef".into()),
            seconds: Seconds { read: 0.0, build: 0.0, render: 2.5, develop: 0.0, write: 0.0 },
            rays: Rays { camera: 1000, secondary: 20, shadow: 3 }.into(),
            mrays_per_s: 1.5,
            peak_memory_bytes: None,
            triangles: 0,
            spheres: 0,
            instances: 0,
            warnings: Vec::new(),
            notices: Vec::new(),
            cancelled: false,
            dropped_samples: Dropped { count: 0, first: None },
            fireflies: Outliers::default(),
        }
    }

    #[test]
    fn what_went_wrong_is_said() {
        let whole = summary().for_people();
        assert!(whole.contains("1\u{202f}023 (1\u{202f}000 camera, 20 secondary, 3 shadow)"), "{whole}");
        assert!(
            !whole.contains("stopped") && !whole.contains("inspect") && whole.contains("unknown"),
            "{whole}"
        );
        let first = Some(DroppedAddress { x: 3, y: 1, sample: 7 });
        let dropped = Summary { dropped_samples: Dropped { count: 5, first }, ..summary() }.for_people();
        assert!(dropped.contains("5 samples") && dropped.contains("lookfrom inspect a.toml 3 1 --sample 7"));
        let late = Dropped { count: 1, first: Some(DroppedAddress { x: 3, y: 1, sample: 63 }) };
        let late = Summary { dropped_samples: late, ended_by: "time", ..summary() }.for_people();
        assert!(late.ends_with("lookfrom inspect a.toml 3 1 --sample 63 --samples 64"), "{late}");
        let stopped = Summary { cancelled: true, samples_taken: 12, ..summary() }.for_people();
        assert!(stopped.ends_with("stopped after 2.5 s; a.png holds the picture so far: 12 of 64 samples"));
        let clean =
            Summary { ended_by: "noise", relative_error: Some(0.0199), samples_taken: 40, ..summary() };
        let words = "stopped by noise: at most 64 samples per pixel, 40 on average; relative error 0.0199";
        assert!(clean.for_people().contains(words), "{}", clean.for_people());
        let one = Summary { samples: 1, samples_taken: 1, ..summary() }.for_people();
        assert!(one.contains(" 1 sample per pixel,"), "{one}");
        let third = Summary { place: Some([3, 12]), ..summary() }.for_people();
        assert_eq!(third, "3 of 12: a.toml → a.png: 4 × 3 pixels, 64 samples per pixel, whitted, 2.50 s");
        let nothing = Summary { cancelled: true, output: None, ..summary() }.for_people();
        assert!(nothing.contains("a.toml → nothing") && nothing.ends_with("nothing is written"), "{nothing}");
    }

    #[test]
    fn numbers_for_people() {
        assert_eq!(thousands(7), "7");
        assert_eq!(thousands(123), "123");
        assert_eq!(thousands(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(bytes(999), "999 bytes");
        assert_eq!(bytes(12_345_678), "12.3 MB");
    }
}
