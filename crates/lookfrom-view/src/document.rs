//! The scene that all windows share. It is read again when one of its files changes; while it cannot be read, the last good
//! one stays, with the error.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
#[cfg(feature = "server")]
use std::sync::Weak;
use std::sync::{Arc, Mutex};

use lookfrom::session::{Options, Session};
use lookfrom_scene::files::SharedFiles;
use lookfrom_scene::image::{self, Image};
use lookfrom_scene::settings::Allocation;
#[cfg(feature = "server")]
use lookfrom_scene::stamps::Stamps;
use lookfrom_scene::{Error, ErrorKind, Inputs, LoadContext, Location, Result};

use crate::Settings;
use crate::mailbox::locked;
#[cfg(feature = "server")]
use crate::mailbox::{Mailbox, Task};
use crate::message::Answer;

/// The scene, its files and its windows.
pub(crate) struct Document {
    settings: Settings,
    files: SharedFiles,
    state: Mutex<State>,
    #[cfg(feature = "server")]
    windows: Mutex<Vec<Weak<Mailbox>>>,
}

impl fmt::Debug for Document {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Document").field("settings", &self.settings).field("state", &self.state).finish()
    }
}

#[derive(Debug, Default)]
struct State {
    scene: Option<Arc<Loaded>>,
    /// Why the files as they are cannot be shown.
    error: Option<Answer>,
}

/// A scene as it was read.
#[derive(Debug)]
pub(crate) struct Loaded {
    /// 1 for the first that was read, and so on.
    pub(crate) generation: u64,
    pub(crate) session: Session,
    /// The options of the session, with the environment map.
    pub(crate) options: Options,
    /// The picture to compare with.
    pub(crate) reference: Option<Image>,
}

impl Document {
    /// A document of these files, of which nothing is read yet.
    pub(crate) fn new(settings: Settings, files: SharedFiles) -> Self {
        Self {
            settings,
            files,
            state: Mutex::default(),
            #[cfg(feature = "server")]
            windows: Mutex::default(),
        }
    }

    /// The scene that is shown, and its options.
    pub(crate) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The files that its scene is read from.
    pub(crate) fn files(&self) -> &SharedFiles {
        &self.files
    }

    /// The last good scene, and the error of the files as they are.
    pub(crate) fn now(&self) -> (Option<Arc<Loaded>>, Option<Answer>) {
        let state = locked(&self.state);
        (state.scene.clone(), state.error.clone())
    }

    /// Tells a window of the scene, now and at each change.
    #[cfg(feature = "server")]
    pub(crate) fn add(&self, window: &Arc<Mailbox>) {
        let mut windows = locked(&self.windows);
        windows.retain(|window| window.strong_count() > 0);
        windows.push(Arc::downgrade(window));
        let state = locked(&self.state);
        if state.scene.is_some() || state.error.is_some() {
            window.put(Task::SceneChanged);
        }
    }

    /// Reads the scene, and again after each change of its files, until `stopped`.
    #[cfg(feature = "server")]
    pub(crate) fn watch(&self, stopped: &dyn Fn() -> bool) {
        let mut known = self.read_again(Stamps::default());
        while let Some(now) = known.wait(stopped) {
            known = self.read_again(now);
        }
    }

    /// Reads the scene, tells all windows, and returns the stamps of its files: as they were before, so that a change
    /// while it is read counts.
    #[cfg(feature = "server")]
    fn read_again(&self, before: Stamps) -> Stamps {
        let inputs = Inputs::default();
        let generation = self.now().0.map_or(0, |loaded| loaded.generation) + 1;
        self.read(generation, &inputs);
        let stamps = before.after_reading(&inputs.paths());
        let windows: Vec<_> = locked(&self.windows).iter().filter_map(Weak::upgrade).collect();
        windows.iter().for_each(|window| window.put(Task::SceneChanged));
        stamps
    }

    /// Reads the scene; every file that is read joins `inputs`.
    pub(crate) fn read(&self, generation: u64, inputs: &Inputs) {
        let read = catch_unwind(AssertUnwindSafe(|| self.load(generation, inputs)));
        let read = read.unwrap_or_else(|_| Err(panicked()));
        let mut state = locked(&self.state);
        match read {
            Ok(loaded) => *state = State { scene: Some(Arc::new(loaded)), error: None },
            Err(error) if self.files.length(&self.settings.scene).is_none() => {
                let error = error.hint("the page shows it as soon as it is saved");
                state.error = Some(Answer::of_error(None, &error, &*self.files));
            }
            Err(error) => state.error = Some(Answer::of_error(None, &error, &*self.files)),
        }
    }

    /// The scene as its files are now.
    ///
    /// # Errors
    /// As [`Session::open`], and those of the pictures beside it.
    pub(crate) fn load(&self, generation: u64, inputs: &Inputs) -> Result<Loaded> {
        let Settings { scene, options, environment, reference, .. } = &self.settings;
        let picture = |path: &PathBuf| {
            let files = inputs.record(&*self.files, scene.display().to_string());
            image::read(path, &mut LoadContext::within(&options.budget, &files))
        };
        let reference = reference.as_ref().map(picture).transpose()?;
        let options = Options {
            environment: environment.as_ref().map(picture).transpose()?,
            // A picture in a window gets finer everywhere, pass by pass.
            allocation: Some(Allocation::Uniform),
            ..options.clone()
        };
        let session = Session::open_on_record(scene, &self.files, &options, inputs)?;
        Ok(Loaded { generation, session, options, reference })
    }
}

/// The error for a panic, which is a fault of this program.
pub(crate) fn panicked() -> Error {
    Error::new(
        ErrorKind::Invalid,
        &Location::default(),
        "internal error: this program has a fault; please report it",
    )
}
