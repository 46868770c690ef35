//! The scene that all windows share. It is read again when one of its files changes; while it cannot be read, the last good
//! one stays, with the error.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, Weak};

use lookfrom::session::{Options, Session};
use lookfrom_scene::image::{self, Image};
use lookfrom_scene::settings::Allocation;
use lookfrom_scene::stamps::Stamps;
use lookfrom_scene::{Disk, Error, ErrorKind, Inputs, LoadContext, Location, Result};

use crate::Settings;
use crate::mailbox::{Mailbox, Task, locked};
use crate::message::Answer;

/// The scene, its files and its windows.
#[derive(Debug)]
pub(crate) struct Document {
    settings: Settings,
    state: Mutex<State>,
    windows: Mutex<Vec<Weak<Mailbox>>>,
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
    /// A document of which nothing is read yet.
    pub(crate) fn new(settings: Settings) -> Self {
        Self { settings, state: Mutex::default(), windows: Mutex::default() }
    }

    /// The scene that is shown, and its options.
    pub(crate) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The last good scene, and the error of the files as they are.
    pub(crate) fn now(&self) -> (Option<Arc<Loaded>>, Option<Answer>) {
        let state = locked(&self.state);
        (state.scene.clone(), state.error.clone())
    }

    /// Tells a window of the scene, now and at each change.
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
    pub(crate) fn watch(&self, stopped: &dyn Fn() -> bool) {
        let mut known = self.read_again(Stamps::default());
        while let Some(now) = known.wait(stopped) {
            known = self.read_again(now);
        }
    }

    /// Reads the scene, tells all windows, and returns the stamps of its files: as they were before, so that a change
    /// while it is read counts.
    fn read_again(&self, before: Stamps) -> Stamps {
        let inputs = Inputs::default();
        let generation = self.now().0.map_or(0, |loaded| loaded.generation) + 1;
        let read = catch_unwind(AssertUnwindSafe(|| self.read(generation, &inputs)));
        let read = read.unwrap_or_else(|_| Err(panicked()));
        let stamps = before.after_reading(&inputs.paths());
        {
            let mut state = locked(&self.state);
            match read {
                Ok(loaded) => *state = State { scene: Some(Arc::new(loaded)), error: None },
                Err(error) if !self.settings.scene.exists() => {
                    let error = error.hint("the page shows it as soon as it is saved");
                    state.error = Some(Answer::of_error(None, &error));
                }
                Err(error) => state.error = Some(Answer::of_error(None, &error)),
            }
        }
        let windows: Vec<_> = locked(&self.windows).iter().filter_map(Weak::upgrade).collect();
        windows.iter().for_each(|window| window.put(Task::SceneChanged));
        stamps
    }

    fn read(&self, generation: u64, inputs: &Inputs) -> Result<Loaded> {
        let Settings { scene, options, environment, reference, .. } = &self.settings;
        let picture = |path: &PathBuf| {
            image::read(path, &mut LoadContext::new(&inputs.record(&Disk, scene.display().to_string())))
        };
        let reference = reference.as_ref().map(picture).transpose()?;
        let options = Options {
            environment: environment.as_ref().map(picture).transpose()?,
            // A picture in a window gets finer everywhere, pass by pass.
            allocation: Some(Allocation::Uniform),
            ..options.clone()
        };
        let session = Session::open_on_record(scene, &options, inputs)?;
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
