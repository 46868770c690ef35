//! `lookfrom info`: contents of scenes and models, their settings, and statistics of the BVH; contents of pictures and films.

mod object;
mod picture;

use std::fmt::Write;
use std::path::Path;

use glam::DVec3;
use lookfrom::session::{Format, Options, Session};
use lookfrom_scene::Inputs;
use lookfrom_scene::camera::{Camera, Projection, View};
use lookfrom_scene::contents::{AnimationEntry, CameraEntry, Contents};
use lookfrom_scene::count::Counts;
use lookfrom_scene::settings::PixelBounds;
use lookfrom_scene::watertight::Watertightness;
use serde::Serialize;

use self::object::Object;

use crate::args::{InfoArguments, Overrides};
use crate::exit::{self, DONE, Failure, answer};
use crate::prepare::{self, prepare};
use crate::report::{self, bytes, thousands};
use crate::scenes;
use lookfrom_scene::json;
use lookfrom_scene::plural::counted;

/// Names of objects that are shown.
const MOST_NAMES: usize = 8;

/// Describes every scene and returns the exit code. A scene that fails does not stop the others; its code is kept.
pub(crate) fn run(arguments: &InfoArguments) -> u8 {
    if let Err(failure) = prepare::use_threads(&arguments.common) {
        return failure.report();
    }
    let scenes = match scenes::expanded(&arguments.scenes) {
        Ok(scenes) => scenes,
        Err(failure) => return failure.report(),
    };
    let mut code = DONE;
    for scene in &scenes {
        if let Err(failure) = info(scene, arguments) {
            let of_failure = failure.report();
            if arguments.json {
                let _ = answer(&report::failure(scene, &failure)).map_err(|failure| failure.report());
            }
            if code == DONE {
                code = of_failure;
            }
        }
    }
    code
}

fn info(path: &Path, arguments: &InfoArguments) -> Result<(), Failure> {
    if Format::of_path(path) == Some(Format::Exr) {
        return picture::info(path, arguments.json, &arguments.common.memory.budget());
    }
    let overrides = Overrides { variables: arguments.variables.clone(), ..Overrides::default() };
    let options = overrides.options(&arguments.common, None);
    let options = Options { keep_scene: true, ..options };
    let session = prepare(path, &arguments.common, &options, &Inputs::default())?;
    if arguments.json {
        return answer(&json::line(&Object::new(path, &session)));
    }
    exit::say_warnings(session.warnings());
    answer(&for_people(path, &session))
}

/// Statistics of the top-level BVH. The trees of objects, which instances share, are not included.
#[derive(Serialize)]
struct Tree {
    nodes: usize,
    leaves: usize,
    depth: usize,
    memory_bytes: usize,
    left_out: usize,
}

fn tree(session: &Session) -> Tree {
    let bvh = session.world().bvh();
    let statistics = bvh.statistics();
    Tree {
        nodes: statistics.nodes,
        leaves: statistics.leaves,
        depth: statistics.depth,
        memory_bytes: bvh.memory(),
        left_out: statistics.left_out,
    }
}

/// The contents and settings of a scene, a line each.
pub(crate) fn for_people(path: &Path, session: &Session) -> String {
    let info = session.info();
    let mut lines = vec![path.display().to_string()];
    let mut line = |name: &str, text: String| lines.push(format!("  {name:<10} {text}"));
    contents(&info.counts, &mut line);
    if let Some(found) = session.scene().and_then(Watertightness::of) {
        line("watertight", watertight(&found));
    }
    line("names", names(session.world().objects().names()));
    let bounds = info.bounds;
    let size = bounds.max - bounds.min;
    line(
        "bounds",
        if bounds.is_empty() {
            "nothing".to_owned()
        } else {
            format!("{} to {}, size {}", numbers(bounds.min), numbers(bounds.max), numbers(size))
        },
    );
    choices(&info.contents, &mut line);
    line("camera", camera_in_words(session.camera()));
    if let Some(lens) = &session.renderer().view().camera().lens_system {
        let [focal_length, f_number] = [lens.focal_length(), lens.f_number()].map(digits);
        line("lens", format!("focal length {focal_length}, working f/{f_number}"));
    }
    if !info.contents.variables.is_empty() {
        let entry = |(name, value): &(String, String)| format!("{name} = {value}");
        let entries: Vec<String> = info.contents.variables.iter().map(entry).collect();
        line("variables", entries.join(", "));
    }
    if let Some(duration) = info.contents.duration {
        let until = match duration {
            0.0 => "expressions".to_owned(),
            _ => format!("keyframes until {} s", digits(duration)),
        };
        line("changes", format!("with time: {until}"));
    }
    let image = session.image();
    let mut picture = format!(
        "{} × {} pixels, filter {}, exposure {}, tonemap {}",
        image.width,
        image.height,
        image.filter,
        image.exposure,
        image.tonemap.word()
    );
    if let Some(PixelBounds { x0, y0, x1, y1 }) = image.crop {
        let _ = write!(picture, ", crop {x0},{y0},{x1},{y1}");
    }
    if image.denoise {
        picture.push_str(", denoised");
    }
    line("image", picture);
    let render = session.settings();
    line(
        "render",
        format!(
            "{}, {}, depth {}, min contribution {}, sampler {}, seed {}",
            render.integrator.word(),
            counted(render.samples, "sample"),
            render.depth,
            render.min_contribution,
            render.sampler.word(),
            render.seed
        ),
    );
    if !info.added.is_empty() {
        line("added", format!("{} (the file has none)", info.added.join(", ")));
    }
    let Tree { nodes, leaves, depth, memory_bytes, left_out } = tree(session);
    let (nodes, leaves) = (counted(nodes, "node"), counted(leaves, "leaf"));
    let mut tree = format!("{nodes}, {leaves}, depth {depth}, {}", bytes(memory_bytes as u64));
    if left_out > 0 {
        let _ = write!(tree, "; {} left out", counted(left_out, "degenerate or non-finite primitive"));
    }
    line("bvh", tree);
    line(
        "time",
        format!("read {:.2} s, build {:.2} s", report::seconds(info.read), report::seconds(info.build)),
    );
    lines.join("\n")
}

/// Whether the meshes are closed, and their volume, or what is wrong.
fn watertight(found: &Watertightness) -> String {
    let &Watertightness { open_edges, turned_edges, volume } = found;
    let faults = [
        (open_edges, format!("{} open", counted(open_edges as usize, "edge"))),
        (
            turned_edges,
            format!("{} between faces that look to opposite sides", counted(turned_edges as usize, "edge")),
        ),
    ];
    let faults: Vec<String> =
        faults.into_iter().filter(|(count, _)| *count > 0).map(|(_, text)| text).collect();
    match faults.is_empty() {
        false => format!("no: {}", faults.join(", ")),
        true if volume < 0.0 => format!("yes, but faces look inwards: volume {}", digits(volume)),
        true => format!("yes, volume {}", digits(volume)),
    }
}

/// How many objects masks tell apart, and the names of the first of them.
fn names(names: &[String]) -> String {
    let shown = names.iter().take(MOST_NAMES).map(String::as_str);
    let more = (names.len() > MOST_NAMES).then_some("…");
    let listed = shown.chain(more).collect::<Vec<_>>().join(", ");
    if names.is_empty() { "none".to_owned() } else { format!("{}: {listed}", thousands(names.len() as u64)) }
}

/// Counts of the contents by kind; kinds with a count of 0 are left out.
fn contents(counts: &Counts, line: &mut impl FnMut(&str, String)) {
    let kinds = |kinds: &std::collections::BTreeMap<&'static str, u64>| {
        let each: Vec<String> =
            kinds.iter().map(|(kind, count)| format!("{} {kind}", thousands(*count))).collect();
        if each.is_empty() { "none".to_owned() } else { each.join(", ") }
    };
    line("shapes", kinds(&counts.shapes));
    let amounts = [
        ("triangles", counts.triangles),
        ("vertices", counts.vertices),
        ("spheres", counts.spheres),
        ("objects", counts.objects),
        ("instances", counts.instances),
        ("materials", counts.materials),
        ("media", counts.media),
        ("textures", counts.textures),
    ];
    for (name, amount) in amounts.into_iter().filter(|(_, amount)| *amount > 0) {
        line(name, thousands(amount));
    }
    for image in &counts.images {
        line("image", format!("{}, {} × {}", image.name, image.width, image.height));
    }
    line("lights", kinds(&counts.lights));
}

/// Lists of the scenes, animations, variants and cameras that can be selected by name or number; empty lists are left out.
fn choices(contents: &Contents, line: &mut impl FnMut(&str, String)) {
    let mut list = |kind: &str, entries: Vec<String>| {
        if !entries.is_empty() {
            let numbered = entries.iter().enumerate().map(|(number, entry)| format!("{number}{entry}"));
            line(kind, numbered.collect::<Vec<_>>().join(", "));
        }
    };
    let quoted = |name: &Option<String>| name.as_ref().map_or(String::new(), |name| format!(" {name:?}"));
    if contents.scenes.len() > 1 {
        let entry = |(number, name): (usize, &Option<String>)| {
            quoted(name) + if contents.scene == Some(number) { " (this one)" } else { "" }
        };
        list("scenes", contents.scenes.iter().enumerate().map(entry).collect());
    }
    let entry = |AnimationEntry { name, duration }: &AnimationEntry| match duration {
        Some(duration) => format!("{} {} s", quoted(name), digits(*duration)),
        None => format!("{} without keys", quoted(name)),
    };
    list("animations", contents.animations.iter().map(entry).collect());
    list("variants", contents.variants.iter().map(quoted).collect());
    let entry = |CameraEntry { name, projection }: &CameraEntry| {
        let projection = match projection {
            Some(seen @ Projection::Perspective { .. }) => {
                format!("perspective, {}", projection_in_words(seen))
            }
            Some(seen) => projection_in_words(seen),
            None => "values out of range".to_owned(),
        };
        format!("{} ({projection})", quoted(name))
    };
    list("cameras", contents.cameras.iter().map(entry).collect());
}

fn projection_in_words(projection: &Projection) -> String {
    match projection {
        Projection::Perspective { fov } => format!("fov {}°", digits(*fov)),
        Projection::Orthographic { height } => format!("orthographic, height {}", digits(*height)),
        Projection::Equirectangular | Projection::EquirectangularPbrt => "equirectangular".to_owned(),
        Projection::Octahedral => "octahedral".to_owned(),
        Projection::Irradiance { surface } => format!("irradiance of {surface:?}"),
        Projection::LensSystem(system) => format!(
            "lens {:?} of {}, film diagonal {} mm, focus distance {}",
            system.name,
            counted(system.surfaces.len(), "surface"),
            digits(system.film_diagonal),
            digits(system.focus_distance)
        ),
    }
}

fn camera_in_words(camera: &Camera) -> String {
    let mut text = match camera.view {
        View::Look { lookfrom, lookat, up } => {
            format!("lookfrom {}, lookat {}, up {}", numbers(lookfrom), numbers(lookat), numbers(up))
        }
        View::Matrix(matrix) => format!("lookfrom {}, given by a matrix", numbers(matrix.w_axis.truncate())),
    };
    let _ = write!(text, ", {}", projection_in_words(&camera.projection));
    if let Some(lens) = camera.lens {
        let _ = write!(
            text,
            ", lens radius {}, focus distance {}",
            digits(lens.radius),
            digits(lens.focus_distance)
        );
    }
    text
}

/// Three numbers as the command line takes them.
fn numbers(v: DVec3) -> String {
    format!("{},{},{}", digits(v.x), digits(v.y), digits(v.z))
}

/// A number to six significant digits.
fn digits(x: f64) -> String {
    format!("{x:.5e}").parse::<f64>().unwrap_or(x).to_string()
}
