//! File names of pictures, from the names of their scenes and the pattern after `-o`.

use std::collections::HashMap;
use std::ffi::{OsStr, OsString};
use std::io::IsTerminal;
use std::path::{Component, Path, PathBuf};

use lookfrom::session::Format;
use lookfrom_scene::load::PIPE;
use lookfrom_scene::plural::counted;
use lookfrom_scene::suggest::nearest;
use lookfrom_scene::{Disk, Files};

use crate::exit::Failure;
use crate::output::{Target, folder_or_here};

/// A placeholder of a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    /// The scene's name without folder and extension.
    Name,
    /// Its folder, as typed.
    Dir,
    /// The name of its folder.
    Parent,
    /// Its number in the call, from 1, with as many digits as the number of the last.
    Number,
}

/// The placeholders by name.
const WORDS: [(&str, Word); 4] =
    [("name", Word::Name), ("dir", Word::Dir), ("parent", Word::Parent), ("n", Word::Number)];

/// A part of a pattern.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(String),
    Word(Word),
}

/// A scene among those of a call.
#[derive(Clone, Copy)]
struct Numbered<'a> {
    scene: &'a Path,
    /// From 0.
    index: usize,
    count: usize,
}

/// Targets of the pictures of all scenes, from the argument of `-o`. Checks everything that can be known before scenes are
/// read.
///
/// # Errors
/// `Usage` for an unknown format, several scenes for one file, an invalid pattern, or a picture to a terminal;
/// `Output` where a folder cannot be written to.
pub(crate) fn targets(
    scenes: &[PathBuf],
    output: Option<&Path>,
    format: Option<&str>,
    json: bool,
) -> Result<Vec<Target>, Failure> {
    let count = scenes.len();
    let numbered =
        |(index, scene): (usize, &'_ PathBuf)| target(Numbered { scene, index, count }, output, format);
    let targets = scenes.iter().enumerate().map(numbered).collect::<Result<Vec<_>, _>>()?;
    if targets.iter().any(Target::is_stdout) {
        check_stdout(json)?;
    }
    let mut taken = HashMap::new();
    for (index, target) in targets.iter().enumerate() {
        let Target::File(path, _) = target else { continue };
        for identity in Disk.identities(path) {
            match taken.insert(identity, index) {
                Some(other) if other != index => {
                    return Err(same_name(&scenes[other], &scenes[index], path));
                }
                _ => {}
            }
        }
        target.check()?;
    }
    Ok(targets)
}

/// Target of the one picture of all scenes. Checks everything that can be known before scenes are read.
///
/// # Errors
/// As [`targets`].
pub(crate) fn sheet(output: Option<&Path>, format: Option<&str>, json: bool) -> Result<Target, Failure> {
    let of = Numbered { scene: Path::new("sheet"), index: 0, count: 1 };
    let target = target(of, output, format)?;
    if !target.format().is_for_screens() {
        return Err(Failure::Usage(format!(
            "a sheet is for a screen, not of linear light: {} as .png, .jpg, .webp or .ppm",
            target.name()
        )));
    }
    if target.is_stdout() {
        check_stdout(json)?;
    }
    target.check()?;
    Ok(target)
}

/// Refuses pictures to a terminal, or between lines of JSON.
fn check_stdout(json: bool) -> Result<(), Failure> {
    let usage = |message: &str| Err(Failure::Usage(message.to_owned()));
    if json {
        return usage("-o - and --json cannot both write to stdout; write the picture to a file");
    }
    if std::io::stdout().is_terminal() {
        return usage(
            "a picture cannot be written to a terminal; give -o a file, or redirect stdout to a pipe or file",
        );
    }
    Ok(())
}

/// The error that two pictures would have the same file name.
fn same_name(first: &Path, second: &Path, path: &Path) -> Failure {
    let extension = path.extension().unwrap_or_default().display();
    Failure::Usage(format!(
        "the pictures of {} and {} would both be {}\n  help: tell them apart by the folders of the scenes or by number: \
         -o 'pictures/{{parent}}-{{name}}.{extension}', 'pictures/{{dir}}/{{name}}.{extension}' or 'pictures/{{n}}-{{name}}.{extension}'",
        first.display(),
        second.display(),
        path.display(),
    ))
}

/// Target of the picture of one scene.
fn target(of: Numbered<'_>, output: Option<&Path>, extension: Option<&str>) -> Result<Target, Failure> {
    let mut default_name = stem(of.scene).to_owned();
    default_name.push(format!(".{}", extension.unwrap_or("png")));
    let file = |path: PathBuf| {
        let format = format(&path)?;
        match extension.map(|extension| Format::of_path(Path::new(&format!("x.{extension}")))) {
            Some(other) if other != Some(format) => Err(Failure::Usage(format!(
                "{} is not of --format {}; give -o a folder or -, or leave out --format",
                path.display(),
                extension.unwrap_or_default()
            ))),
            _ => Ok(Target::File(path, format)),
        }
    };
    let Some(output) = output else { return file(default_name.into()) };
    if output == Path::new("-") {
        return match of.count {
            1 => Ok(Target::Stdout(format(Path::new(&default_name))?)),
            _ => Err(Failure::Usage(
                "-o - is for one scene; give several a folder or a pattern with {name}".to_owned(),
            )),
        };
    }
    // A name that is not Unicode has no placeholders.
    let pieces = output.to_str().map(pieces).transpose()?;
    let has_words = pieces.iter().flatten().any(|piece| matches!(piece, Piece::Word(_)));
    let output = pieces.map_or_else(|| output.to_owned(), |pieces| filled(&pieces, of));
    // Several scenes go into a folder; one scene does if the folder exists or its name ends with a separator.
    let ends_like_folder = output.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
    if output.is_dir() || ends_like_folder {
        return file(output.join(default_name));
    }
    if of.count == 1 || has_words {
        return file(output);
    }
    if output.exists()
        || Format::EXTENSIONS.iter().any(|(extension, _)| Some(OsStr::new(extension)) == output.extension())
    {
        return Err(Failure::Usage(format!(
            "{} do not fit into the one file {}; give -o a folder or a pattern with {{name}}",
            counted(of.count, "picture"),
            output.display()
        )));
    }
    file(output.join(default_name))
}

/// The parts of a pattern: `{word}` is a placeholder, `{{` and `}}` are literal braces.
fn pieces(typed: &str) -> Result<Vec<Piece>, Failure> {
    let wrong = |what: String, hint: String| {
        Err(Failure::Usage(format!("-o {typed}: {what}\n  help: {hint}; {{{{ and }}}} stand for braces")))
    };
    let known = || WORDS.map(|(word, _)| format!("{{{word}}}")).join(", ");
    let mut pieces = Vec::new();
    let mut text = String::new();
    let mut rest = typed;
    while let Some(at) = rest.find(['{', '}']) {
        text.push_str(&rest[..at]);
        let (brace, behind) = rest[at..].split_at(1);
        if let Some(behind) = behind.strip_prefix(brace) {
            text.push_str(brace);
            rest = behind;
            continue;
        }
        let Some((word, behind)) = behind.split_once('}').filter(|_| brace == "{") else {
            return wrong(format!("a single {brace}"), format!("the placeholders are {}", known()));
        };
        let Some(&(_, found)) = WORDS.iter().find(|(known, _)| *known == word) else {
            let near = nearest(word, WORDS.map(|(word, _)| word));
            let meant = near.map_or(String::new(), |near| format!("did you mean {{{near}}}? "));
            return wrong(
                format!("there is no {{{word}}}"),
                format!("{meant}the placeholders are {}", known()),
            );
        };
        pieces.extend([Piece::Text(std::mem::take(&mut text)), Piece::Word(found)]);
        rest = behind;
    }
    pieces.push(Piece::Text(text + rest));
    Ok(pieces)
}

/// The file name that a pattern gives for a scene.
fn filled(pieces: &[Piece], Numbered { scene, index, count }: Numbered<'_>) -> PathBuf {
    let mut name = OsString::new();
    let folder = folder_or_here(scene.parent());
    for piece in pieces {
        match piece {
            Piece::Text(text) => name.push(text),
            Piece::Word(Word::Name) => name.push(stem(scene)),
            Piece::Word(Word::Dir) => name.push(folder),
            Piece::Word(Word::Parent) => name.push(name_of_folder(folder)),
            Piece::Word(Word::Number) => {
                let digits = count.to_string().len();
                name.push(format!("{:0digits$}", index + 1));
            }
        }
    }
    name.into()
}

/// The last component of a folder's path; where that is `.` or `..`, the folder's name in the file system.
fn name_of_folder(folder: &Path) -> OsString {
    if let Some(Component::Normal(name)) = folder.components().next_back() {
        return name.to_owned();
    }
    let resolved = folder.canonicalize().unwrap_or_default();
    resolved.file_name().unwrap_or_default().to_owned()
}

fn stem(scene: &Path) -> &OsStr {
    if scene == Path::new(PIPE) {
        return OsStr::new("stdin");
    }
    // Of `...toml` the stem is `..`, which as a part of a path would be another folder.
    let is_name = |stem: &&OsStr| !matches!(stem.to_str(), Some("." | ".."));
    scene.file_stem().filter(is_name).unwrap_or(OsStr::new("picture"))
}

/// The format of a file by its extension.
fn format(path: &Path) -> Result<Format, Failure> {
    Format::of_path(path).ok_or_else(|| {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let all: Vec<String> =
            Format::EXTENSIONS.iter().map(|(extension, _)| format!(".{extension}")).collect();
        let all = all.join(", ");
        let found = if extension.is_empty() {
            "no extension".to_owned()
        } else {
            format!("the extension .{extension}")
        };
        Failure::Usage(format!("{} has {found}; pictures are written as {all}", path.display()))
    })
}

#[cfg(test)]
mod tests {
    use lookfrom::session::Series;

    use super::*;

    fn of(scenes: &[&str], output: Option<&str>) -> Result<Vec<String>, u8> {
        let count = scenes.len();
        let numbered = |(index, scene): (usize, &&str)| {
            let target =
                target(Numbered { scene: Path::new(scene), index, count }, output.map(Path::new), None);
            target.map(|target| target.name()).map_err(|failure| failure.code())
        };
        scenes.iter().enumerate().map(numbered).collect()
    }

    #[test]
    fn names_of_pictures() {
        assert_eq!(of(&["a/b.toml"], None).unwrap(), ["b.png"]);
        assert_eq!(of(&["a/b.toml", "c.ply"], None).unwrap(), ["b.png", "c.png"]);
        assert_eq!(of(&["a/b.toml"], Some("x/y.EXR")).unwrap(), ["x/y.EXR"]);
        assert_eq!(
            of(&["a/b.toml", "c.ply"], Some("x/{name}/{name}.hdr")).unwrap(),
            ["x/b/b.hdr", "x/c/c.hdr"]
        );
        assert_eq!(of(&["b.toml"], Some("x/")).unwrap(), ["x/b.png"]);
        assert_eq!(of(&["b.toml", "c.ply"], Some("x")).unwrap(), ["x/b.png", "x/c.png"]);
        assert_eq!(of(&["b.toml"], Some("-")).unwrap(), ["-"]);
        for wrong in ["x", "x.toml", "x.bmp", ".png", "{name}"] {
            assert_eq!(of(&["b.toml"], Some(wrong)), Err(2), "{wrong}");
        }
        for wrong in ["-", "x.png"] {
            assert_eq!(of(&["b.toml", "c.ply"], Some(wrong)), Err(2), "{wrong}");
        }
    }

    #[test]
    fn words_of_patterns() {
        let scenes = ["a/b/s.toml", "/c/s.toml", "s.toml"];
        let names = |output: &str| of(&scenes, Some(output)).unwrap();
        assert_eq!(names("{dir}/{name}.png"), ["a/b/s.png", "/c/s.png", "./s.png"]);
        assert_eq!(names("{parent}-{name}.png")[..2], ["b-s.png", "c-s.png"]);
        assert_eq!(names("x/{parent}/")[..2], ["x/b/s.png", "x/c/s.png"]);
        assert_eq!(names("{n}.exr"), ["1.exr", "2.exr", "3.exr"]);
        assert_eq!(of(&["s.toml"; 10], Some("{n}-{name}.png")).unwrap()[8..], ["09-s.png", "10-s.png"]);
        // A folder without a name of its own has that of the file system: tests run in the folder of the crate.
        assert_eq!(names("{parent}.png")[2], "lookfrom-cli.png");
        assert_eq!(of(&["./s.toml"], Some("{parent}.png")).unwrap(), ["lookfrom-cli.png"]);
        assert_eq!(of(&["../s.toml"], Some("{parent}.png")).unwrap(), ["crates.png"]);
    }

    #[test]
    fn braces_are_doubled() {
        assert_eq!(of(&["{n}.toml"], Some("{{{name}}}-{{name}}.png")).unwrap(), ["{{n}}-{name}.png"]);
        for wrong in
            ["{nam}.png", "{}.png", "{name.png", "name}.png", "{{name}.png", "{Name}.png", "{ n }.png"]
        {
            assert_eq!(of(&["a.toml"], Some(wrong)), Err(2), "{wrong}");
        }
        let message = |typed: &str| pieces(typed).unwrap_err().to_string();
        let all = "the placeholders are {name}, {dir}, {parent}, {n}; {{ and }} stand for braces";
        assert_eq!(
            message("{nam}.png"),
            format!("-o {{nam}}.png: there is no {{nam}}\n  help: did you mean {{name}}? {all}")
        );
        assert_eq!(message("{width}"), format!("-o {{width}}: there is no {{width}}\n  help: {all}"));
        assert!(message("a}").starts_with("-o a}: a single }\n  help: the placeholders are {name}, "));
    }

    #[test]
    fn numbers_of_pictures() {
        let numbered = Numbered { scene: Path::new("a.b.toml"), index: 0, count: 1 };
        let named = |output: &str| target(numbered, Some(Path::new(output)), None).unwrap();
        let [of_36, of_10001] = [Series::Turntable(36), Series::Turntable(10_001)];
        assert_eq!(named("x/").of_series(&of_36, 7).name(), "x/a.b-007.png");
        assert_eq!(named("x/").of_series(&of_10001, 7).name(), "x/a.b-00007.png");
        let frames = Series::Frames { frames: 99..101, fps: 24.0 };
        assert_eq!(named("x/").of_series(&frames, 0).name(), "x/a.b-0099.png");
        assert_eq!(named("x/f-#####.{name}.png").of_series(&frames, 1).name(), "x/f-00100.a.b.png");
        assert_eq!(named("#.png").of_series(&frames, 0).name(), "099.png");
        assert_eq!(named("#.png").of_series(&Series::One, 0).name(), "#.png");
        assert_eq!(named("x/f-%04d.exr").of_series(&frames, 0).name(), "x/f-0099.exr");
        assert_eq!(named("100%-%01d.exr").of_series(&frames, 1).name(), "100%-100.exr");
        assert_eq!(named("100%dark.%0.png").of_series(&frames, 0).name(), "100%dark.%0-0099.png");
    }

    #[test]
    fn formats_by_option() {
        let numbered = Numbered { scene: Path::new("a.toml"), index: 0, count: 1 };
        let named = |output: &str| target(numbered, Some(Path::new(output)), Some("jpg"));
        assert_eq!(named("x/").unwrap().name(), "x/a.jpg");
        assert_eq!(named("-").unwrap(), Target::Stdout(Format::Jpeg(Format::JPEG_QUALITY)));
        assert_eq!(named("x.jpeg").unwrap().name(), "x.jpeg");
        assert_eq!(named("x.png").map_err(|failure| failure.code()), Err(2));
        assert_eq!(
            target(Numbered { scene: Path::new("-"), ..numbered }, None, None).unwrap().name(),
            "stdin.png"
        );
    }
}
