//! A hand-out: the page with one picture and one pixel as a single file, which is opened without a server and asks nobody.
//!
//! Its answers are those of a [`Desk`], asked for as the page would ask.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use lookfrom_scene::Result;
use lookfrom_scene::files::SharedFiles;
use serde_json::{Value, json};

use crate::bundle;
use crate::view::refused;
use crate::{Desk, Outgoing, Settings};

/// The most samples whose rays are held, unless one is named: the brightest.
const MOST_SAMPLES: usize = 8;

/// The longest scene file whose text is held, in bytes.
const LONGEST_SOURCE: u64 = 1 << 20;

/// The time of a turn of the desk.
const SLICE: Duration = Duration::from_millis(500);

/// Renders a scene, follows the samples of a pixel (by default the middle one), and returns the page as HTML. With the number of a sample
/// that one is held, otherwise the brightest ones.
///
/// # Errors
/// What is wrong with the scene; `Request` for a pixel or a sample that it does not have.
pub fn handout(
    settings: Settings,
    files: SharedFiles,
    pixel: Option<[u32; 2]>,
    sample: Option<u32>,
) -> Result<String> {
    let source = source(&settings.scene, &files);
    let mut asker = Asker { desk: Desk::new(SLICE), last_id: 0, progress: String::new(), picture: None };
    asker.desk.open(settings, files);
    let scene = asker.scene()?;
    let told: Value = parsed(&scene)?;
    let size = [&told["size"][0], &told["size"][1]].map(|side| side.as_u64().unwrap_or(1) as u32);
    let [x, y] = pixel.unwrap_or(size.map(|side| side / 2));
    if x >= size[0] || y >= size[1] {
        let [width, height] = size;
        return Err(refused(format!("pixel {x} {y} is outside of the picture of {width} × {height} pixels")));
    }
    let (header, png) = asker.rendered(&told)?;
    let report = asker.ask(json!({ "type": "pixel", "x": x, "y": y }))?;
    let value = asker.ask(json!({ "type": "value", "x": x, "y": y }))?;
    let words = asker.ask(json!({ "type": "words" }))?;
    let rows = parsed(&report)?;
    let brightest =
        rows["report"]["all"].as_array().into_iter().flatten().filter_map(|row| row["sample"].as_u64());
    let held: Vec<u64> = match sample {
        Some(sample) => vec![sample.into()],
        None => brightest.take(MOST_SAMPLES).collect(),
    };
    let mut samples = Vec::new();
    for sample in &held {
        samples.push(format!("\"{sample}\":{}", asker.sample([x, y], *sample)?));
    }
    // Answers stand here as they are: numbers that are read and written again could lose bits.
    let kept = format!(
        r#"{{"pixel":[{x},{y}],"sample":{},"scene":{scene},"progress":{},"picture":{header},"png":"{}","words":{words},"report":{report},"value":{value},"samples":{{{}}},"source":{}}}"#,
        held.first().copied().unwrap_or_default(),
        asker.progress,
        STANDARD.encode(&png),
        samples.join(","),
        Value::from(source)
    );
    bundle::page("handout.js", "handout", &kept)
}

/// The text of the scene's file, if it is one.
fn source(scene: &Path, files: &SharedFiles) -> Option<String> {
    String::from_utf8(files.read(scene, LONGEST_SOURCE).ok()?).ok().filter(|text| !text.contains('\0'))
}

fn parsed(text: &str) -> Result<Value> {
    serde_json::from_str(text).map_err(|error| refused(format!("not JSON: {error}")))
}

/// A desk that is asked one thing after the other.
struct Asker {
    desk: Desk,
    last_id: u64,
    progress: String,
    /// The header and the bytes of the last picture.
    picture: Option<(String, Vec<u8>)>,
}

impl Asker {
    /// The scene, as the page is told of it.
    fn scene(&mut self) -> Result<String> {
        self.desk.turn();
        self.until(|message| message["type"] == "scene")
    }

    /// The finished picture in the scene's own view.
    fn rendered(&mut self, scene: &Value) -> Result<(String, Vec<u8>)> {
        let view = json!({ "type": "view", "id": 0, "exposure": scene["exposure"], "tonemap": scene["tonemap"], "denoise": scene["denoise"], "layer": "color" });
        self.desk.hear(&view.to_string());
        while self.desk.turn() {
            self.take()?;
        }
        self.take()?;
        self.picture.take().ok_or_else(|| refused("the scene has no picture"))
    }

    /// The answer to a question.
    fn ask(&mut self, mut question: Value) -> Result<String> {
        self.last_id += 1;
        let id = Value::from(self.last_id);
        question["id"] = id.clone();
        self.desk.hear(&question.to_string());
        self.desk.turn();
        self.until(|message| message["id"] == id)
    }

    /// The rays of a sample, and the scattering at each of their ends that has a lobe.
    fn sample(&mut self, [x, y]: [u32; 2], sample: u64) -> Result<String> {
        let of = |kind: &str| json!({ "type": kind, "x": x, "y": y, "sample": sample });
        let inspection = self.ask(of("inspect"))?;
        let mut lobes = String::new();
        for ray in parsed(&inspection)?["inspection"]["rays"].as_array().into_iter().flatten() {
            let mut question = of("lobe");
            question["address"] = ray["address"].clone();
            // Mirrors and rays that leave the scene have none.
            if ray["met"].is_object()
                && let Ok(lobe) = self.ask(question)
            {
                let comma = if lobes.is_empty() { "" } else { "," };
                let _ = write!(lobes, "{comma}\"{}\":{lobe}", ray["address"]);
            }
        }
        Ok(format!(r#"{{"inspection":{inspection},"lobes":{{{lobes}}}}}"#))
    }

    /// The first text among what is said that fits; errors that come before it are errors.
    fn until(&mut self, fits: impl Fn(&Value) -> bool) -> Result<String> {
        let mut found = None;
        for (text, message) in self.take()? {
            if message["type"] == "error" {
                let excerpt =
                    message["excerpt"].as_str().map(|excerpt| format!("\n{excerpt}")).unwrap_or_default();
                return Err(refused(format!("{}{excerpt}", message["message"].as_str().unwrap_or_default())));
            }
            if fits(&message) {
                found = found.or(Some(text));
            }
        }
        found.ok_or_else(|| refused("internal error: a question has no answer; please report it"))
    }

    /// All texts that are said; progress and pictures are kept aside.
    fn take(&mut self) -> Result<Vec<(String, Value)>> {
        let mut texts = Vec::new();
        while let Some(message) = self.desk.say() {
            match message {
                Outgoing::Text(text) => {
                    let message = parsed(&text)?;
                    if message["type"] == "progress" {
                        self.progress = text;
                    } else {
                        texts.push((text, message));
                    }
                }
                Outgoing::Binary(bytes) => {
                    if let Some((length, rest)) = bytes.split_first_chunk()
                        && let Some((header, payload)) =
                            rest.split_at_checked(u32::from_le_bytes(*length) as usize)
                    {
                        self.picture = Some((String::from_utf8_lossy(header).into_owned(), payload.to_vec()));
                    }
                }
            }
        }
        Ok(texts)
    }
}
