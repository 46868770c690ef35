//! `lookfrom render`: pictures of scenes and models.

use std::path::{Path, PathBuf};

use lookfrom::session::{Exposure, Format, Options, Series, Session, Sheet};
use lookfrom_scene::Inputs;
use lookfrom_scene::image::{Animation, Image};
use lookfrom_scene::load::PIPE;
use lookfrom_scene::plural::counted;
use lookfrom_scene::stamps::Stamps;

use crate::args::RenderArguments;
use crate::exit::{self, DONE, Failure, INTERRUPTED, answer, say};
use crate::output::Target;
use crate::picture::{self, Job, Outlet};
use crate::pipe::Piped;
use crate::prepare::{self, prepare};
use crate::report;
use crate::terminal::{self, Show, Way};
use crate::{files, film, info, interrupt, naming, scenes};

/// Failed scenes that are named at the end of a call.
const MOST_FAILED: usize = 20;

/// A call of the command: its scenes, targets and series, checked as far as can be before scenes are read.
struct Call<'a> {
    arguments: &'a RenderArguments,
    /// The arguments by which sessions can be opened again, for films.
    typed: &'a [String],
    scenes: Vec<PathBuf>,
    /// One for each scene; that of the sheet if there is one.
    targets: Vec<Target>,
    series: Series,
}

/// Renders every scene and returns the exit code. A scene that fails does not stop the others; its code is kept. Films keep
/// `typed`, the arguments by which their sessions can be opened again.
pub(crate) fn run(arguments: &RenderArguments, typed: &[String]) -> u8 {
    let ready = Call::new(arguments, typed).and_then(|call| {
        prepare::use_threads(&arguments.common)?;
        Ok(call)
    });
    let call = match ready {
        Ok(call) => call,
        Err(failure) => return failure.report(),
    };
    interrupt::listen();
    if arguments.watch { call.watch() } else { call.render(&Inputs::default()) }
}

impl<'a> Call<'a> {
    /// # Errors
    /// `Usage` for options that do not go together; as [`naming::targets`].
    fn new(arguments: &'a RenderArguments, typed: &'a [String]) -> Result<Self, Failure> {
        let RenderArguments { several, keep, encoding, .. } = arguments;
        let usage = |message: String| Err(Failure::Usage(message));
        let scenes = scenes::expanded(&arguments.scenes)?;
        let output = arguments.output.as_deref();
        let targets = match several.sheet {
            Some(_) => vec![naming::sheet(output, encoding.format(), arguments.json)?; scenes.len()],
            None => naming::targets(&scenes, output, encoding.format(), arguments.json)?,
        };
        let targets = encoding.apply(targets)?;
        let series = several.series(arguments.overrides.variables.fps);
        let call = Self { arguments, typed, scenes, targets, series };
        let is_piped = call.targets.iter().any(Target::is_stdout);
        let is_several = call.series != Series::One;
        if is_piped && arguments.write_every.is_some() {
            return usage("--write-every needs an output file; -o - is stdout".to_owned());
        }
        if is_piped && arguments.show.is_some_and(|show| show != Show::Off) {
            return usage("--show is for pictures in files; -o - is stdout".to_owned());
        }
        let is_stream = is_piped && is_several && several.sheet.is_none();
        if is_stream && call.targets.iter().any(|target| !target.format().is_for_screens()) {
            return usage(
                "several pictures on stdout are an animation (--format gif, apng or webp) or one after the other (png, \
                 ppm, jpg); files of linear light need names of their own"
                    .to_owned(),
            );
        }
        if keep.film && call.targets.iter().any(|target| target.format() != Format::Exr) {
            return usage(
                "--film needs an .exr of 32 bits: -o NAME.exr; make other pictures of it by lookfrom develop"
                    .to_owned(),
            );
        }
        if keep.film && is_piped {
            return usage("a film needs a file; -o - is stdout".to_owned());
        }
        if keep.film && arguments.write_every.is_some() {
            return usage(
                "--film keeps the picture so far, with its samples, by --checkpoint; --write-every would replace it by a picture alone"
                    .to_owned(),
            );
        }
        if keep.film && call.scenes.iter().any(|scene| scene == Path::new(PIPE)) {
            return usage("--film needs a scene in a file, which can be read again; - is stdin".to_owned());
        }
        if arguments.write_every.is_some() && call.targets.iter().any(|target| call.is_animation(target)) {
            return usage("--write-every is for single pictures, not for an animation".to_owned());
        }
        if let Some((columns, Some(rows))) = several.sheet {
            let (cells, pictures) = (columns as usize * rows as usize, call.count());
            if pictures > cells {
                return usage(format!(
                    "{pictures} pictures do not fit into the {} of --sheet {columns}x{rows}; --sheet {columns} \
                     has as many rows as it takes",
                    counted(cells, "cell")
                ));
            }
        }
        Ok(call)
    }

    /// The number of all pictures.
    fn count(&self) -> usize {
        self.scenes.len() * self.series.count()
    }

    /// Whether the pictures of a scene become one that moves.
    fn is_animation(&self, target: &Target) -> bool {
        self.series != Series::One
            && self.arguments.several.sheet.is_none()
            && target.format().animation().is_ok()
            && !target.has_number()
    }

    /// Targets of the pictures of one scene.
    fn pictures(&self, target: &Target) -> Vec<Target> {
        match self.arguments.several.sheet.is_some() || self.is_animation(target) {
            true => vec![target.clone(); self.series.count()],
            false => (0..self.series.count()).map(|index| target.of_series(&self.series, index)).collect(),
        }
    }

    /// Renders all scenes, again after each change of their files, until Ctrl-C.
    fn watch(&self) -> u8 {
        let mut before = Stamps::default();
        loop {
            let inputs = Inputs::default();
            let code = self.render(&inputs);
            if interrupt::asked() {
                return code;
            }
            let written: Vec<Target> = self.targets.iter().flat_map(|target| self.pictures(target)).collect();
            let paths: Vec<PathBuf> = inputs.paths();
            let paths: Vec<PathBuf> =
                paths.into_iter().filter(|path| !written.iter().any(|target| target.is(path))).collect();
            before = before.after_reading(&paths);
            if !self.arguments.quiet {
                say("waiting for changes; Ctrl-C ends this");
            }
            // Nothing is lost by Ctrl-C now, which ends the process.
            let Some(now) = before.wait(&interrupt::asked) else { return INTERRUPTED };
            before = now;
        }
    }

    /// Renders all scenes and returns the exit code. Every file that is read joins `inputs`.
    fn render(&self, inputs: &Inputs) -> u8 {
        let Self { arguments, scenes, targets, .. } = self;
        let environment = match prepare::environment(&arguments.overrides, &arguments.common, inputs) {
            Ok(environment) => environment,
            Err(failure) => return failure.report(),
        };
        // A picture may overwrite an input of a later scene. Where no output file exists yet, nothing can be lost.
        if scenes.len() > 1 && targets.iter().flat_map(|target| self.pictures(target)).any(|t| t.exists()) {
            prepare::read_ahead(scenes, &arguments.common, &arguments.overrides, inputs);
        }
        let mut sheet = arguments.several.sheet.map(|(columns, rows)| {
            let needed = self.count().div_ceil(columns as usize) as u32;
            Sheet::new(columns, rows.unwrap_or(needed))
        });
        let (mut code, mut failed) = (DONE, Vec::new());
        for (index, scene) in scenes.iter().enumerate() {
            let of_scene = match self.render_scene(index, environment.as_ref(), inputs, sheet.as_mut()) {
                Ok(of_scene) => of_scene,
                Err(failure) => {
                    failed.push(scene.display().to_string());
                    let of_failure = failure.report();
                    if arguments.json {
                        let _ = answer(&report::failure(scene, &failure)).map_err(|failure| failure.report());
                    }
                    of_failure
                }
            };
            if code == DONE || of_scene == INTERRUPTED {
                code = of_scene;
            }
            if interrupt::asked() && (of_scene == INTERRUPTED || index + 1 < scenes.len()) {
                code = INTERRUPTED;
                break;
            }
        }
        if let Some(sheet) = sheet
            && let Err(failure) = write_sheet(&sheet, &targets[0], arguments.way(), inputs)
        {
            // Where nothing could be rendered, that has been told.
            code = if failed.len() == scenes.len() { code } else { failure.report() };
        }
        if scenes.len() > 1 && !failed.is_empty() && !arguments.quiet {
            let named = failed.iter().take(MOST_FAILED).map(String::as_str).collect::<Vec<_>>().join(", ");
            let more = if failed.len() > MOST_FAILED { ", …" } else { "" };
            say(&format!("{} of {} scenes failed: {named}{more}", failed.len(), scenes.len()));
        }
        code
    }

    /// Renders all pictures of one scene, prints the summaries and returns the exit code.
    fn render_scene(
        &self,
        index: usize,
        environment: Option<&Image>,
        inputs: &Inputs,
        sheet: Option<&mut Sheet>,
    ) -> Result<u8, Failure> {
        let target = &self.targets[index];
        if let Some(sheet) = sheet {
            // Cells without a picture stay empty, so that each picture is where it belongs.
            let mut shown = Vec::new();
            let code = self.render_series(
                index,
                environment,
                inputs,
                &mut Outlet::Gathered(&mut |finished| {
                    shown.push(finished.shown());
                    Ok(())
                }),
            );
            let count = self.series.count();
            shown
                .into_iter()
                .map(Some)
                .chain(std::iter::repeat(None))
                .take(count)
                .for_each(|cell| sheet.add(cell));
            return code;
        }
        if !self.is_animation(target) {
            return self.render_series(index, environment, inputs, &mut Outlet::Target);
        }
        if self.arguments.several.skip_existing && target.exists() {
            return self.skipped(&self.scenes[index], target).map(|()| DONE);
        }
        let (format, fps) = (target.format().animation()?, self.arguments.overrides.variables.fps);
        let mut animation: Option<Animation> = None;
        let mut outlet = |finished: &lookfrom::session::Finished| {
            let shown = finished.shown();
            let animation = match &mut animation {
                Some(animation) => animation,
                none => {
                    none.insert(Animation::new(format, [shown.width, shown.height], fps, shown.has_alpha)?)
                }
            };
            animation.add(&shown.rgba).map_err(|error| {
                let size =
                    format!("all are as large as the first, and one is {} × {}", shown.width, shown.height);
                Failure::Output(format!("{}: {}: {size}", target.name(), error.message))
            })
        };
        let code = self.render_series(index, environment, inputs, &mut Outlet::Gathered(&mut outlet));
        let is_half_done = self.arguments.several.skip_existing && interrupt::asked();
        if let Some(animation) = animation.filter(|_| !is_half_done) {
            let bytes = animation.finish().map_err(|error| target.cannot_encode(&error))?;
            target.write_finished(&bytes, inputs)?;
        }
        code
    }

    /// Renders the pictures of one scene one by one.
    fn render_series(
        &self,
        index: usize,
        environment: Option<&Image>,
        inputs: &Inputs,
        outlet: &mut Outlet<'_>,
    ) -> Result<u8, Failure> {
        let Self { arguments, series, .. } = self;
        let (path, target) = (self.scenes[index].as_path(), &self.targets[index]);
        let in_scene = exit::in_scene(path);
        let targets = self.pictures(target);
        let skips = arguments.several.skip_existing && matches!(outlet, Outlet::Target);
        let mut options: Option<Options> = None;
        let mut session: Option<Session> = None;
        for (number, target) in targets.iter().enumerate() {
            if skips && target.exists() {
                self.skipped(path, target)?;
                continue;
            }
            let options = match &mut options {
                Some(options) => options,
                None => {
                    let files = inputs.record(&Piped, path.display().to_string());
                    let of_all = self::options(arguments, target, environment);
                    options.insert(series.framed(path, &files, &of_all).map_err(&in_scene)?)
                }
            };
            let is_there = match &mut session {
                Some(session) => series.go_to(number, options, session).map_err(&in_scene)?,
                None => false,
            };
            if !is_there {
                // The memory of the last one is needed for the next.
                let is_first = session.take().is_none();
                let next = prepare(path, &arguments.common, &series.options(number, options), inputs)?;
                if is_first && !arguments.quiet {
                    exit::say_warnings(next.warnings());
                }
                if is_first && arguments.verbose > 0 {
                    say(&info::for_people(path, &next));
                }
                if is_first && arguments.verbose > 1 {
                    say(&files::in_words(&inputs.paths()));
                }
                keep_inputs(path, &targets, inputs)?;
                // All pictures of a scene have the exposure of the first.
                options.exposure = Some(Exposure::Stops(next.image().exposure));
                session = Some(next);
            }
            let Some(session) = &session else { continue };
            let place = (self.count() > 1).then(|| [index * series.count() + number + 1, self.count()]);
            let typed = film::arguments_of_picture(self.typed, series, number, options);
            let job = Job { arguments, typed: &typed, inputs, place };
            let code = interrupt::keeping(|| -> Result<u8, Failure> {
                let film = if arguments.keep.go_on { film::existing(target, &options.budget)? } else { None };
                let summary = picture::render(path, target, session, film, &job, outlet)?;
                picture::told(&summary, arguments)
            })?;
            if code != DONE {
                return Ok(code);
            }
        }
        Ok(DONE)
    }

    /// Tells that a picture is there already.
    fn skipped(&self, scene: &Path, target: &Target) -> Result<(), Failure> {
        if !self.arguments.quiet {
            say(&format!("{} exists; not rendered", target.name()));
        }
        if self.arguments.json {
            answer(&report::skipped(scene, &target.name()))?;
        }
        Ok(())
    }
}

/// Writes a sheet, and draws it in the terminal if there is a way.
fn write_sheet(sheet: &Sheet, target: &Target, way: Option<Way>, inputs: &Inputs) -> Result<(), Failure> {
    let cannot_encode = |error| target.cannot_encode(&error);
    let shown = sheet.shown().map_err(cannot_encode)?;
    target.write_finished(&shown.encode(target.format()).map_err(cannot_encode)?, inputs)?;
    way.map_or(Ok(()), |way| terminal::draw(&shown, way))
}

/// Refuses pictures that would overwrite an input, and a scene that reads a picture of this call.
fn keep_inputs(path: &Path, targets: &[Target], inputs: &Inputs) -> Result<(), Failure> {
    targets.iter().try_for_each(|target| target.keep_inputs(inputs))?;
    let scene = path.display().to_string();
    match inputs.own_output(&scene) {
        None => Ok(()),
        Some(input) => Err(Failure::Output(format!(
            "{scene} reads {}, which this call has just written as the picture of another scene\n  help: render them \
             in two calls, or give the pictures a folder of their own with -o",
            input.path.display()
        ))),
    }
}

/// The options of a session for one target.
pub(crate) fn options(arguments: &RenderArguments, target: &Target, environment: Option<&Image>) -> Options {
    Options { format: Some(target.format()), ..arguments.options(environment) }
}
