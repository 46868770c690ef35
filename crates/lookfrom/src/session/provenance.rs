//! The provenance of a film: what decides its samples, and what is needed to go on with it and to develop it.

use std::ops::Range;

use lookfrom_scene::image::compare::CHANNELS_ATTRIBUTE;
use lookfrom_scene::settings::{Background, PixelBounds, Tonemap};
use lookfrom_scene::{Error, Location, Result};

use super::{Development, Fireflies, header};
use crate::film::{Film, SampleId};
use crate::render::SAMPLING_VERSION;

/// The version of the format, in the attribute `film`.
pub(super) const FORMAT: &str = "1";

/// The prefix of our attributes and channels, and the name of the attribute with the version.
pub(super) const PREFIX: &str = "film";

/// The origin of a film, and what its reader needs besides the sums.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// The texts of the header that any number of samples has in common, sorted by name.
    pub(super) header: Vec<(String, String)>,
    /// The files of the scene by name and their SHA-256, in hexadecimal digits.
    pub(super) inputs: Vec<(String, String)>,
    /// The digest of the other options that decide samples.
    pub(super) options: String,
    /// [`SAMPLING_VERSION`].
    pub(super) sampling: u32,
    /// The settings by which the picture is developed.
    pub development: Development,
    /// The path of the scene, as its maker tells: of an unfinished film relative to its folder.
    pub scene: Option<String>,
    /// Arguments by which its maker can open the same session again, for its own use.
    pub arguments: Vec<String>,
    /// The samples that every pixel was to have, if some are not there yet.
    pub goal: Option<Range<u32>>,
}

/// The texts of a film's file.
pub(super) struct Texts<'a> {
    pub(super) attributes: &'a [(String, String)],
    pub(super) at: &'a Location,
}

impl Texts<'_> {
    /// A text, if there is one of this name.
    pub(super) fn find(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(known, _)| known == name);
        found.map(|(_, text)| text.as_str())
    }

    /// The value of a text, as `read` understands it.
    ///
    /// # Errors
    /// `Syntax` where there is none, or it cannot be understood.
    pub(super) fn read<'a, T>(&'a self, name: &str, read: impl FnOnce(&'a str) -> Option<T>) -> Result<T> {
        let text = self.find(name).ok_or_else(|| self.damaged(&format!("it has no attribute {name}")))?;
        read(text).ok_or_else(|| self.damaged(&format!("{name} cannot be understood")))
    }

    /// The error that a film is damaged.
    pub(super) fn damaged(&self, what: &str) -> Error {
        Error::syntax(self.at, format!("this film is damaged: {what}"))
    }
}

impl Provenance {
    /// The provenance in the texts of a film's file.
    ///
    /// # Errors
    /// `Syntax` where they are damaged.
    pub(super) fn of_texts(texts: &Texts<'_>) -> Result<Self> {
        let header = texts.attributes.iter().filter(|(name, _)| !is_ours(name)).cloned();
        let input =
            |line: &str| line.split_once(' ').map(|(digest, name)| (name.to_owned(), digest.to_owned()));
        let goal = texts.find("film.goal").map(|_| texts.read("film.goal", range)).transpose()?;
        Ok(Self {
            header: header::common(header.collect()),
            inputs: texts
                .read("film.inputs", |text| unfolded(text).iter().map(|line| input(line)).collect())?,
            options: texts.read("film.options", |text| Some(text.to_owned()))?,
            sampling: texts.read("film.sampling", |text| text.parse().ok())?,
            development: texts.read("film.develop", development_of)?,
            scene: texts.find("film.scene").map(str::to_owned),
            arguments: unfolded(texts.find("film.arguments").unwrap_or_default()),
            goal,
        })
    }

    /// The files of the scene: names and SHA-256, in hexadecimal digits.
    pub fn inputs(&self) -> impl Iterator<Item = (&str, &str)> {
        self.inputs.iter().map(|(name, digest)| (name.as_str(), digest.as_str()))
    }

    /// The limit of noise of adaptive sampling.
    pub fn noise(&self) -> Option<&str> {
        self.text(header::NOISE)
    }

    /// Whether the picture decides how many samples a pixel gets.
    pub(super) fn is_adaptive(&self) -> bool {
        [header::NOISE, header::ALLOCATION].iter().any(|name| self.text(name).is_some())
    }

    /// Whether both decide alike how many samples a pixel gets: by a limit of noise, by an allocation, or by none.
    pub(super) fn adapts_as(&self, other: &Self) -> bool {
        let texts =
            |of: &Self| [header::NOISE, header::ALLOCATION].map(|name| of.text(name).map(str::to_owned));
        texts(self) == texts(other)
    }

    fn text(&self, name: &str) -> Option<&str> {
        let found = self.header.iter().find(|(known, _)| known == name);
        found.map(|(_, text)| text.as_str())
    }

    /// Compares what two films are of, but for what decides about numbers of samples.
    ///
    /// # Errors
    /// `Invalid` with the first difference.
    pub fn check_same(&self, other: &Self) -> Result<()> {
        let differ = |message: String| {
            Err(Error::invalid(&Location::default(), format!("a film of another picture: {message}"))
                .hint("only films of the same scene with the same settings belong together"))
        };
        if self.sampling != other.sampling {
            return differ(format!(
                "its samples are those of version {} of the program's sampling, not {}",
                other.sampling, self.sampling
            ));
        }
        let settings = |of: &Self| {
            // The name of the scene's file does not matter either, only its content.
            let named = |(name, _): &&(String, String)| {
                !matches!(name.as_str(), "software" | header::SCENE | header::NOISE | header::ALLOCATION)
            };
            of.header.iter().filter(named).cloned().collect::<Vec<_>>()
        };
        let (mine, theirs) = (settings(self), settings(other));
        let value = |of: &[(String, String)], name: &str| {
            let found = of.iter().find(|(known, _)| known == name);
            found.map_or_else(|| "not set".to_owned(), |(_, text)| text.clone())
        };
        let is_set = |of: &[(String, String)], name: &str| of.iter().any(|(known, _)| known == name);
        if let Some((name, _)) =
            theirs.iter().chain(&mine).find(|(name, _)| value(&mine, name) != value(&theirs, name))
        {
            if name == CHANNELS_ATTRIBUTE && [&mine, &theirs].iter().any(|of| !is_set(of, name)) {
                let layers = |of: &[(String, String)]| if is_set(of, name) { "geometry" } else { "none" };
                return differ(format!("layers is {} there, {} here", layers(&theirs), layers(&mine)));
            }
            let called = match header::light_path_of(name) {
                Some(layer) => format!("light-path {layer}"),
                None => name.clone(),
            };
            return differ(format!(
                "{called} is {} there, {} here",
                value(&theirs, name),
                value(&mine, name)
            ));
        }
        // Files are compared by content: their names may differ between machines.
        let digests = |of: &Self| {
            let mut digests: Vec<String> = of.inputs.iter().map(|(_, digest)| digest.clone()).collect();
            digests.sort();
            digests
        };
        let (mine, theirs) = (digests(self), digests(other));
        if mine != theirs {
            let odd = |of: &Self, others: &[String]| {
                of.inputs.iter().find(|(_, digest)| !others.contains(digest)).map(|(name, _)| name.clone())
            };
            let name =
                odd(other, &mine).or_else(|| odd(self, &theirs)).unwrap_or_else(|| "a file".to_owned());
            return differ(format!("{name} has another content"));
        }
        if self.options != other.options {
            return differ(
                "other options for the surroundings, the floor, the turntable or the selected parts of the file".to_owned(),
            );
        }
        Ok(())
    }

    /// Orders provenances of the same picture, whose texts may differ.
    pub(super) fn order(&self) -> impl Ord {
        (
            self.header.clone(),
            self.inputs.clone(),
            self.scene.clone(),
            self.arguments.clone(),
            text_of(&self.development),
        )
    }

    /// Whether a film has all the samples that it was to have.
    pub fn is_complete(&self, film: &Film) -> bool {
        self.goal.as_ref().is_none_or(|goal| film.ledger().is_complete(film.area(), goal))
    }

    /// The attributes of a film's file that tell what it is of.
    pub(super) fn attributes(&self, film: &Film) -> Vec<(String, String)> {
        let PixelBounds { x0, y0, x1, y1 } = film.area();
        let SampleId { pixel: [x, y], sample } =
            film.first_dropped().unwrap_or(SampleId { pixel: [0, 0], sample: 0 });
        let inputs: Vec<String> =
            self.inputs.iter().map(|(name, digest)| format!("{digest} {name}")).collect();
        let mut attributes = vec![
            (PREFIX, FORMAT.to_owned()),
            ("film.area", format!("{x0} {y0} {x1} {y1}")),
            ("film.ledger", film.ledger().to_string()),
            ("film.dropped", format!("{} {x} {y} {sample}", film.dropped())),
            ("film.inputs", folded(&inputs)),
            ("film.options", self.options.clone()),
            ("film.sampling", self.sampling.to_string()),
            ("film.develop", text_of(&self.development)),
        ];
        if let Some(scene) = &self.scene {
            attributes.push(("film.scene", scene.clone()));
        }
        if !self.arguments.is_empty() {
            attributes.push(("film.arguments", folded(&self.arguments)));
        }
        if let Some(goal) = &self.goal
            && !self.is_complete(film)
        {
            attributes.push(("film.goal", format!("{}..{}", goal.start, goal.end)));
        }
        attributes.into_iter().map(|(name, text)| (name.to_owned(), text)).collect()
    }

    /// The provenance of pictures that this program computes.
    pub(super) fn new(
        header: Vec<(String, String)>,
        inputs: Vec<(String, String)>,
        options: String,
        development: Development,
    ) -> Self {
        Self {
            header,
            inputs,
            options,
            sampling: SAMPLING_VERSION,
            development,
            scene: None,
            arguments: Vec::new(),
            goal: None,
        }
    }
}

fn is_ours(name: &str) -> bool {
    name == PREFIX || name.strip_prefix(PREFIX).is_some_and(|rest| rest.starts_with('.'))
}

/// Texts as lines. A line that begins with a tab goes on with the one before: names of files and values of variables may
/// have line feeds.
fn folded(texts: &[String]) -> String {
    texts.iter().map(|text| text.replace('\n', "\n\t")).collect::<Vec<_>>().join("\n")
}

/// The texts that were [`folded`].
fn unfolded(lines: &str) -> Vec<String> {
    let mut texts: Vec<String> = Vec::new();
    for line in lines.split('\n').filter(|_| !lines.is_empty()) {
        match (line.strip_prefix('\t'), texts.last_mut()) {
            (Some(more), Some(text)) => {
                text.push('\n');
                text.push_str(more);
            }
            _ => texts.push(line.to_owned()),
        }
    }
    texts
}

/// `START..END`.
fn range(text: &str) -> Option<Range<u32>> {
    let (start, end) = text.split_once("..")?;
    Some(start.parse().ok()?..end.parse().ok()?)
}

/// `EXPOSURE TONEMAP BACKGROUND DENOISE FIREFLIES`, exact.
fn text_of(development: &Development) -> String {
    let &Development { exposure, tonemap, background, denoise, fireflies } = development;
    let background = match background {
        Background::Color([r, g, b]) => format!("{r},{g},{b}"),
        Background::Environment | Background::Transparent => background.to_string(),
    };
    let word = |is_on: bool, word: &'static str| if is_on { word } else { "-" };
    format!(
        "{exposure} {} {background} {} {}",
        tonemap.word(),
        word(denoise, "denoise"),
        word(fireflies == Fireflies::Spread, "fireflies")
    )
}

/// The inverse of [`text_of`].
fn development_of(text: &str) -> Option<Development> {
    let [exposure, tonemap, background, denoise, fireflies]: [&str; 5] =
        text.split(' ').collect::<Vec<_>>().try_into().ok()?;
    let &(_, tonemap) = Tonemap::WORDS.iter().find(|(word, _)| *word == tonemap)?;
    let background = match background {
        "environment" => Background::Environment,
        "transparent" => Background::Transparent,
        color => {
            let color: Option<Vec<f32>> = color.split(',').map(|number| number.parse().ok()).collect();
            Background::Color(color?.try_into().ok()?)
        }
    };
    let fireflies = if fireflies == "fireflies" { Fireflies::Spread } else { Fireflies::Keep };
    Some(Development {
        exposure: exposure.parse().ok()?,
        tonemap,
        background,
        denoise: denoise == "denoise",
        fireflies,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_with_line_feeds_stay_whole() {
        let texts = |texts: &[&str]| texts.iter().map(|&text| text.to_owned()).collect::<Vec<_>>();
        for some in [texts(&[]), texts(&["a"]), texts(&["a\n\n\tb\r", "c d\n", "--define=x=\"\n--seed=1\""])]
        {
            assert_eq!(unfolded(&folded(&some)), some);
        }
        // Without line feeds they are plain lines.
        assert_eq!(folded(&texts(&["--size=8", "--seed=1"])), "--size=8\n--seed=1");
    }
}
