//! The identity of the samples of a session's picture: digests of its files and options. Films of equal identity
//! and header are of the same picture.

use std::fmt::Write as _;
use std::path::Path;

use lookfrom_scene::camera::Camera;
use lookfrom_scene::digest::{Digest, Digested};
use lookfrom_scene::settings::{Allocation, RenderSettings};
use lookfrom_scene::{ImportOptions, Scene, Variables};

use super::{Options, Provenance, Session, header};

/// The files and options of a session, digested when it was opened.
#[derive(Clone, Debug)]
pub(super) struct Identity {
    /// Names and digests of files.
    inputs: Vec<(String, String)>,
    /// Options that are in no settings: as text, the environment map as its digest.
    options: String,
    /// Whether the number of samples is that of the picture, and not only the most that a time limit allows.
    has_goal: bool,
}

/// Import options in the words that films have always known them by: without a time it was 0, at which nothing moved.
fn as_ever(import: &ImportOptions) -> String {
    let ImportOptions { animation, at, shutter, variant, scene, camera, subdivision, instanced_lights } =
        import;
    let begun = if *at == Some(0.0) { " begun" } else { "" };
    let subdivided = if *subdivision > 0 { format!(" subdivided {subdivision}") } else { String::new() };
    let lit = if *instanced_lights { " instanced lights" } else { "" };
    let open = shutter.map_or_else(String::new, |frames| format!(" open {frames:?}"));
    let at = at.unwrap_or(0.0);
    format!(
        "ImportOptions {{ animation: {animation:?}, at: {at:?}, variant: {variant:?}, scene: {scene:?}, camera: {camera:?} }}{begun}{subdivided}{lit}{open}"
    )
}

impl Identity {
    /// The identity of a scene read from files.
    pub(super) fn of_files(files: Digested<'_>, path: &Path, options: &Options) -> Self {
        let digests = files.digests(path.parent().unwrap_or(Path::new("")));
        let inputs = digests.into_iter().map(|(path, digest)| (path.display().to_string(), digest.sha256));
        Self::new(inputs.collect(), options)
    }

    /// The identity of a scene in memory.
    pub(super) fn of_scene(scene: &Scene, options: &Options) -> Self {
        let mut digest = Digest::default();
        // Writing to a digest does not fail.
        let _ = write!(digest, "{scene:?}");
        Self::new(vec![("scene".to_owned(), digest.finish())], options)
    }

    /// The identity with the same options of a scene that has been changed.
    pub(super) fn with_scene(&self, scene: &Scene) -> Self {
        let mut digest = Digest::default();
        let _ = write!(digest, "{scene:?}");
        Self { inputs: vec![("scene".to_owned(), digest.finish())], ..self.clone() }
    }

    fn new(inputs: Vec<(String, String)>, options: &Options) -> Self {
        let environment = options.environment.as_ref().map(|image| {
            let mut digest = Digest::default();
            let _ = write!(digest, "{} {} ", image.width, image.height);
            for texel in image.texels() {
                texel.iter().for_each(|value| digest.add(&value.to_le_bytes()));
            }
            digest.finish()
        });
        let &Options {
            up,
            view,
            azimuth,
            elevation,
            framed,
            rotate_environment,
            floor,
            ref import,
            ref variables,
            ..
        } = options;
        // Only where there are any: films that are older know of no view and no variables.
        let view = match options.chooses_view() || framed.is_some() {
            true => format!(" {view:?} {azimuth:?} {elevation:?} {framed:?}"),
            false => String::new(),
        };
        let import = as_ever(import);
        let variables = match *variables != Variables::default() {
            true => format!(" {variables:?}"),
            false => String::new(),
        };
        Self {
            inputs,
            options: format!(
                "{up:?} {rotate_environment:?} {floor} {import} {environment:?}{view}{variables}"
            ),
            has_goal: options.stop.time.is_none() || options.samples.is_some(),
        }
    }

    /// The provenance of the picture that a session has now.
    pub(super) fn provenance(&self, session: &Session) -> Provenance {
        let settings =
            RenderSettings { samples: 0, allocation: Allocation::Uniform, ..session.settings().clone() };
        // Named portals, lights that are seen and media with an end need no words: films that are older know of no others.
        let settings = format!("{settings:?}");
        let settings = ["portals: Named, ", "endless_media: false, ", ", hide_lights: false"]
            .into_iter()
            .fold(settings, |settings, words| settings.replace(words, ""));
        let camera = Camera { at: lookfrom_scene::Location::default(), ..session.camera.clone() };
        let turn = session.turntable.as_ref().map(|turning| turning.degrees);
        let mut digest = Digest::default();
        // A camera that sees all has no words for it, either.
        let camera = format!("{camera:?}").replace("clip: None, ", "");
        let _ = write!(digest, "{} {settings} {camera} {turn:?}", self.options);
        let common = header::header(session);
        let development = session.development();
        let mut provenance = Provenance::new(common, self.inputs.clone(), digest.finish(), development);
        provenance.goal = self.has_goal.then(|| session.first_sample..session.settings().samples);
        provenance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn films_that_are_older_are_known_again() {
        let none = ImportOptions::default();
        let before = "ImportOptions { animation: None, at: 0.0, variant: None, scene: None, camera: First }";
        assert_eq!(as_ever(&none), before);
        let later = ImportOptions { at: Some(1.5), animation: Some("Run".to_owned()), ..none.clone() };
        let before =
            "ImportOptions { animation: Some(\"Run\"), at: 1.5, variant: None, scene: None, camera: First }";
        assert_eq!(as_ever(&later), before);
        assert_ne!(as_ever(&ImportOptions { at: Some(0.0), ..none.clone() }), as_ever(&none));
    }
}
