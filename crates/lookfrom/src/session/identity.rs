//! The identity of the samples of a session's picture: digests of its files and options. Films of equal identity
//! and header are of the same picture.

use std::fmt::Write as _;
use std::path::Path;

use lookfrom_scene::Scene;
use lookfrom_scene::camera::Camera;
use lookfrom_scene::digest::{Digest, Digested};
use lookfrom_scene::settings::{Allocation, RenderSettings};

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

/// A scene in memory as an input: the digest of its text. (Writing to a digest does not fail.)
fn inputs_of(scene: &Scene) -> Vec<(String, String)> {
    let mut digest = Digest::default();
    let _ = write!(digest, "{scene:?}");
    vec![("scene".to_owned(), digest.finish())]
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
        Self::new(inputs_of(scene), options)
    }

    /// The identity with the same options of a scene that has been changed.
    pub(super) fn with_scene(&self, scene: &Scene) -> Self {
        Self { inputs: inputs_of(scene), ..self.clone() }
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
            bounds,
            rotate_environment,
            floor,
            ref import,
            ref variables,
            ..
        } = options;
        let view = (view, azimuth, elevation, bounds);
        Self {
            inputs,
            options: format!(
                "{up:?} {rotate_environment:?} {floor} {import:?} {environment:?} {view:?} {variables:?}"
            ),
            has_goal: options.stop.time.is_none() || options.samples.is_some(),
        }
    }

    /// The provenance of the picture that a session has now.
    pub(super) fn provenance(&self, session: &Session) -> Provenance {
        let settings =
            RenderSettings { samples: 0, allocation: Allocation::Uniform, ..session.settings().clone() };
        let camera = Camera { at: lookfrom_scene::Location::default(), ..session.camera.clone() };
        let turn = session.turntable.as_ref().map(|turning| turning.degrees);
        let mut digest = Digest::default();
        let _ = write!(digest, "{} {settings:?} {camera:?} {turn:?}", self.options);
        let common = header::header(session);
        let development = session.development();
        let mut provenance = Provenance::new(common, self.inputs.clone(), digest.finish(), development);
        provenance.goal = self.has_goal.then(|| session.first_sample..session.settings().samples);
        provenance
    }
}
