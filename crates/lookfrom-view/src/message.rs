//! Messages between page and server: JSON texts, and binary frames with a JSON header. Keys are in `snake_case`, as in
//! `lookfrom inspect --json`.

use serde::{Deserialize, Serialize};

use lookfrom_scene::count::Counts;
use lookfrom_scene::excerpt::Excerpts;
use lookfrom_scene::{Error, Files, json};

/// The longest message from a page, in bytes.
pub(crate) const LONGEST: usize = 1 << 16;

/// A message from the page.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Request {
    /// The view to show; replaces the whole view before.
    View(Box<ViewRequest>),
    /// All samples of a pixel.
    Pixel { id: u64, x: u32, y: u32 },
    /// One sample of a pixel, with all events.
    Inspect { id: u64, x: u32, y: u32, sample: u32, depth: Option<u32>, min_contribution: Option<f32> },
    /// The scene from an observer's camera.
    Space { id: u64, camera: CameraRequest, size: [u32; 2] },
    /// The numbers of a pixel of the film as it is.
    Value { id: u64, x: u32, y: u32 },
    /// The scattering at a vertex of a sample.
    Lobe { id: u64, x: u32, y: u32, sample: u32, address: u64 },
    /// A file of the picture.
    Save { id: u64, format: FileFormat },
    /// The view in words.
    Words { id: u64 },
    /// The page as a file that holds a pixel, by default the middle one; the sample is shown first, by default the brightest.
    Handout { id: u64, pixel: Option<[u32; 2]>, sample: Option<u32> },
    /// The tables and keys of the scene format.
    Vocabulary { id: u64 },
    /// Stop rendering, or go on.
    Pause { paused: bool },
}

/// The view that a page requests; `None` is the scene's own.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub(crate) struct ViewRequest {
    pub(crate) id: u64,
    pub(crate) camera: Option<CameraRequest>,
    pub(crate) size: Option<[u32; 2]>,
    /// Whether a hand is moving it: only coarse pictures, as fast as possible.
    #[serde(default)]
    pub(crate) moving: bool,
    pub(crate) integrator: Option<String>,
    pub(crate) depth: Option<u32>,
    pub(crate) samples: Option<u32>,
    pub(crate) min_contribution: Option<f32>,
    pub(crate) turn: Option<f64>,
    pub(crate) rotate_environment: Option<f64>,
    pub(crate) animation: Option<usize>,
    pub(crate) at: Option<f64>,
    pub(crate) variant: Option<String>,
    #[serde(default)]
    pub(crate) exposure: f32,
    pub(crate) tonemap: Option<String>,
    #[serde(default)]
    pub(crate) denoise: bool,
    pub(crate) layer: Option<String>,
    pub(crate) compare: Option<CompareRequest>,
}

/// Position and orientation, and the vertical field of view in degrees.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
pub(crate) struct CameraRequest {
    pub(crate) lookfrom: [f64; 3],
    pub(crate) lookat: [f64; 3],
    pub(crate) up: [f64; 3],
    pub(crate) fov: Option<f64>,
}

/// A comparison of the picture with the reference.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
pub(crate) struct CompareRequest {
    pub(crate) mode: Comparing,
}

/// A way to compare.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Comparing {
    /// Both pictures.
    Wipe,
    /// The reference alone.
    Reference,
    /// The absolute difference.
    Difference,
    /// The perceived difference.
    Flip,
    /// The difference in standard errors.
    Z,
}

/// A format of files to save.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum FileFormat {
    Png,
    Exr,
}

/// A text message to the page.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Answer {
    Scene(Box<SceneAnswer>),
    Error {
        id: Option<u64>,
        message: String,
        /// Its location in a text file.
        place: Option<PlaceAnswer>,
        /// The line of the file that the error points at, with carets.
        excerpt: Option<String>,
    },
    Progress {
        view: u64,
        samples: u32,
        of: u32,
        seconds: f64,
        rays_per_second: f64,
        done: bool,
        /// Of a finished picture, [`Film::hash`](lookfrom::film::Film::hash).
        hash: Option<String>,
    },
    Pixel {
        id: u64,
        report: Box<lookfrom::inspect::PixelInspection>,
    },
    Inspection {
        id: u64,
        inspection: Box<lookfrom::inspect::Inspection>,
        text: String,
    },
    Value {
        id: u64,
        x: u32,
        y: u32,
        rgb: [f32; 3],
        samples: u64,
        /// Standard deviation of one sample's luminance; infinite of fewer than two.
        deviation: f32,
        reference: Option<[f32; 3]>,
    },
    Lobe(Box<LobeAnswer>),
    Words {
        id: u64,
        toml: String,
        command: String,
    },
    Vocabulary {
        id: u64,
        tables: Vec<TableAnswer>,
    },
}

/// A table of the scene format, as messages name it: `[camera]`, `[[light]] point`, `[materials.NAME] whitted`, `rotate`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct TableAnswer {
    pub(crate) title: String,
    pub(crate) keys: Vec<&'static str>,
}

/// A place in a text file; line and column are counted from 1.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PlaceAnswer {
    pub(crate) file: String,
    pub(crate) line: u32,
    pub(crate) column: u32,
}

/// A scene, and the settings it has by itself.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SceneAnswer {
    pub(crate) generation: u64,
    pub(crate) name: String,
    pub(crate) size: [u32; 2],
    /// Whether the options say the size.
    pub(crate) is_sized: bool,
    pub(crate) camera: CameraAnswer,
    pub(crate) bounds: BoundsAnswer,
    pub(crate) integrator: &'static str,
    pub(crate) integrators: Vec<&'static str>,
    pub(crate) depth: u32,
    pub(crate) samples: u32,
    pub(crate) min_contribution: f32,
    pub(crate) exposure: f32,
    pub(crate) tonemap: &'static str,
    pub(crate) tonemaps: Vec<&'static str>,
    pub(crate) denoise: bool,
    pub(crate) layers: Vec<LayerAnswer>,
    pub(crate) variants: Vec<String>,
    pub(crate) animations: Vec<AnimationAnswer>,
    /// Duration of keyframes and expressions of the scene, in seconds.
    pub(crate) duration: Option<f64>,
    pub(crate) turntable: bool,
    /// The options' turn of the turntable, in degrees.
    pub(crate) turn: Option<f64>,
    /// The options' turn of the surroundings, in degrees.
    pub(crate) rotate_environment: Option<f64>,
    /// The options' time, in seconds.
    pub(crate) at: Option<f64>,
    /// The options' variant, and the number of their animation.
    pub(crate) variant: Option<String>,
    pub(crate) animation: Option<usize>,
    pub(crate) counts: Counts,
    pub(crate) lights: Vec<LightAnswer>,
    pub(crate) reference: Option<String>,
    pub(crate) warnings: Vec<String>,
    pub(crate) version: &'static str,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct CameraAnswer {
    pub(crate) lookfrom: [f64; 3],
    pub(crate) lookat: [f64; 3],
    pub(crate) up: [f64; 3],
    /// `None` where rays do not leave a point into a frustum.
    pub(crate) fov: Option<f64>,
    pub(crate) projection: &'static str,
    /// Whether its picture is mirrored: `u` of the notes is to the right in it.
    pub(crate) is_mirrored: bool,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct BoundsAnswer {
    pub(crate) min: [f64; 3],
    pub(crate) max: [f64; 3],
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct LayerAnswer {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct AnimationAnswer {
    pub(crate) name: String,
    pub(crate) seconds: f64,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct LightAnswer {
    pub(crate) name: &'static str,
    /// Its position; of an area light the centre of its bounds; `None` for lights that are nowhere.
    pub(crate) position: Option<[f64; 3]>,
}

/// The scattering at a vertex, over rings of directions around the normal.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct LobeAnswer {
    pub(crate) id: u64,
    pub(crate) address: u64,
    pub(crate) point: [f64; 3],
    pub(crate) normal: [f32; 3],
    /// Toward the origin of the ray that arrives, for which the balloon is.
    pub(crate) wi: [f32; 3],
    /// Toward where the path goes on.
    pub(crate) chosen: Option<[f32; 3]>,
    pub(crate) theta: usize,
    pub(crate) phi: usize,
    pub(crate) values: Vec<f32>,
    pub(crate) directions: Vec<[f32; 3]>,
}

/// The header of a binary frame.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum Header {
    Picture {
        view: u64,
        width: u32,
        height: u32,
        /// Pixels of the view per pixel of this picture.
        scale: u32,
        samples: u32,
        of: u32,
        done: bool,
        layer: String,
        seconds: f64,
        /// The camera that made it.
        camera: CameraAnswer,
        /// From the world to the pixels of the view, as in `Space`; `None` where points have no single place in the picture.
        screen_from_world: Option<[f64; 16]>,
        /// Bytes of the pictures that follow.
        sizes: Vec<usize>,
    },
    Space {
        id: u64,
        width: u32,
        height: u32,
        screen_from_world: [f64; 16],
        sizes: [usize; 2],
    },
    File {
        id: u64,
        name: String,
        mime: &'static str,
    },
}

impl Request {
    /// The request of a text.
    ///
    /// # Errors
    /// The answer for a text that is none.
    pub(crate) fn of_text(text: &str) -> Result<Self, Answer> {
        let refused = Answer::refusal;
        if text.len() > LONGEST {
            let message = format!("a message of {} bytes; at most {LONGEST} are possible", text.len());
            return Err(refused(None, message));
        }
        let value: serde_json::Value =
            serde_json::from_str(text).map_err(|error| refused(None, format!("not JSON: {error}")))?;
        let id = value.get("id").and_then(serde_json::Value::as_u64);
        serde_json::from_value(value).map_err(|error| refused(id, format!("not a message: {error}")))
    }

    /// The number that an answer refers to.
    pub(crate) fn id(&self) -> Option<u64> {
        match *self {
            Self::View(ref request) => Some(request.id),
            Self::Pixel { id, .. }
            | Self::Inspect { id, .. }
            | Self::Space { id, .. }
            | Self::Value { id, .. }
            | Self::Save { id, .. }
            | Self::Words { id }
            | Self::Handout { id, .. }
            | Self::Vocabulary { id }
            | Self::Lobe { id, .. } => Some(id),
            Self::Pause { .. } => None,
        }
    }
}

impl Answer {
    /// The text of the message. Numbers that JSON lacks are the strings "NaN", "Infinity" and "-Infinity".
    pub(crate) fn text(&self) -> String {
        json::line(self)
    }

    /// An error that is in no file.
    pub(crate) fn refusal(id: Option<u64>, message: String) -> Self {
        Self::Error { id, message, place: None, excerpt: None }
    }

    /// An error of the library, with the line of one of these files that it points at.
    pub(crate) fn of_error(id: Option<u64>, error: &Error, files: &dyn Files) -> Self {
        let excerpt = Excerpts::new(files).of(&error.at).map(|excerpt| excerpt.to_string());
        // What the page itself asked for has no place in a file.
        let message = match (error.at.file.is_empty(), &error.hint) {
            (false, _) => error.to_string(),
            (true, None) => error.message.clone(),
            (true, Some(hint)) => format!("{}\n  help: {hint}", error.message),
        };
        let place = (error.at.line > 0).then(|| PlaceAnswer {
            file: error.at.file.to_string(),
            line: error.at.line,
            column: error.at.column,
        });
        Self::Error { id, message, place, excerpt }
    }
}

impl Header {
    /// The text of the header.
    pub(crate) fn text(&self) -> String {
        json::line(self)
    }

    /// The frame of this header with what follows it.
    pub(crate) fn frame(&self, payload: &[&[u8]]) -> Vec<u8> {
        let header = self.text();
        let mut frame =
            Vec::with_capacity(4 + header.len() + payload.iter().map(|part| part.len()).sum::<usize>());
        frame.extend((header.len() as u32).to_le_bytes());
        frame.extend(header.as_bytes());
        payload.iter().for_each(|part| frame.extend(*part));
        frame
    }
}
