//! The formats of scenes and models: how names and content tell them.

use std::path::Path;

use crate::model::{number, scan, text};
use crate::{hair, packed, stl, vdb};

/// A format of scenes or models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Toml,
    Pbrt,
    Mitsuba,
    Gltf,
    Ply,
    Stl,
    Obj,
    Hair,
    Vdb,
}

/// A row of the table of formats.
struct Row {
    format: Format,
    /// Extensions in lower case.
    extensions: &'static [&'static str],
    /// Whether files may be compressed, with `.gz` after the extension.
    may_be_packed: bool,
    /// Whether a content is of this format.
    sniff: fn(&[u8]) -> bool,
}

/// All formats; where the content decides, the first that it suits.
const FORMATS: &[Row] = &[
    Row { format: Format::Toml, extensions: &["toml"], may_be_packed: false, sniff: |_| false },
    Row { format: Format::Pbrt, extensions: &["pbrt"], may_be_packed: true, sniff: is_pbrt },
    Row { format: Format::Mitsuba, extensions: &["xml"], may_be_packed: false, sniff: is_mitsuba },
    Row { format: Format::Gltf, extensions: &["gltf", "glb"], may_be_packed: false, sniff: is_gltf },
    Row { format: Format::Ply, extensions: &["ply"], may_be_packed: true, sniff: is_ply },
    Row { format: Format::Hair, extensions: &["hair"], may_be_packed: true, sniff: hair::is_hair },
    Row { format: Format::Stl, extensions: &["stl"], may_be_packed: true, sniff: stl::is_stl },
    Row { format: Format::Vdb, extensions: &["vdb", "nvdb"], may_be_packed: false, sniff: vdb::is_vdb },
    Row { format: Format::Obj, extensions: &["obj"], may_be_packed: true, sniff: looks_like_obj },
];

/// The kinds of files that can be read, `scene`, `model` and `volume`, each with its extensions: `.toml, .pbrt, .xml`.
pub fn known_files() -> [(&'static str, String); 3] {
    ["scene", "model", "volume"].map(|content| {
        let rows = FORMATS.iter().filter(|row| row.format.content() == content);
        let extensions: Vec<String> =
            rows.flat_map(|row| row.extensions).map(|name| format!(".{name}")).collect();
        (content, extensions.join(", "))
    })
}

impl Format {
    /// The format that a name tells, by its extension in upper or lower case.
    pub(crate) fn of_name(path: &Path) -> Option<Self> {
        let unpacked = packed::unpacked_name(path);
        let has_name = |row: &&Row| {
            let name = if row.may_be_packed { &unpacked } else { path };
            let extension = name.extension().map(|extension| extension.to_string_lossy().to_lowercase());
            extension.is_some_and(|extension| row.extensions.contains(&&*extension))
        };
        FORMATS.iter().find(has_name).map(|row| row.format)
    }

    /// The format of a content, given the one that the name tells. Names of scenes are believed; a model may have the
    /// name of another format, unless the content only looks like an OBJ file.
    pub(crate) fn of_content(content: &[u8], named: Option<Self>) -> Option<Self> {
        let may_be = |row: &&Row| match named {
            None => true,
            Some(named) => named.is_model() && row.format.is_model() && row.format != Self::Obj,
        };
        let found = FORMATS.iter().filter(may_be).find(|row| (row.sniff)(content));
        found.map(|row| row.format).or(named)
    }

    /// The kind of content: `scene`, `model` or `volume`.
    fn content(self) -> &'static str {
        match self {
            Self::Toml | Self::Pbrt | Self::Mitsuba => "scene",
            Self::Gltf | Self::Ply | Self::Stl | Self::Obj | Self::Hair => "model",
            Self::Vdb => "volume",
        }
    }

    /// Whether it is one of models that have neither a camera nor lights.
    pub(crate) fn is_model(self) -> bool {
        matches!(self, Self::Obj | Self::Ply | Self::Stl | Self::Hair)
    }

    /// Whether files may be compressed.
    pub(crate) fn may_be_packed(self) -> bool {
        FORMATS.iter().any(|row| row.format == self && row.may_be_packed)
    }
}

/// Whether a text is a scene of pbrt: one of its first words is a directive that such files begin with.
fn is_pbrt(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1 << 16)];
    let lines = head.split(|&byte| byte == b'\n' || byte == b'\r');
    lines.map(<[u8]>::trim_ascii).filter(|line| !line.is_empty() && line[0] != b'#').take(100).any(|line| {
        let word = line.split(|byte| byte.is_ascii_whitespace() || *byte == b'"').next().unwrap_or_default();
        matches!(word, b"WorldBegin" | b"LookAt" | b"Integrator" | b"PixelFilter" | b"AttributeBegin")
    })
}

/// Whether a text is a scene of Mitsuba: its first element is a `scene`.
fn is_mitsuba(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1 << 16)];
    let head = head.strip_prefix("\u{feff}".as_bytes()).unwrap_or(head);
    let is_element = |tag: &[u8]| tag.first().is_some_and(u8::is_ascii_alphabetic);
    head.trim_ascii_start().starts_with(b"<")
        && head
            .split(|&byte| byte == b'<')
            .find(|tag| is_element(tag))
            .is_some_and(|tag| tag.starts_with(b"scene"))
}

/// Whether a file's content is that of a glTF file: the signature of a GLB container, or JSON with an `asset`.
fn is_gltf(content: &[u8]) -> bool {
    let text = content.strip_prefix("\u{feff}".as_bytes()).unwrap_or(content).trim_ascii_start();
    // `asset` may come later in the file; then only the file's extension identifies it.
    let beginning = &text[..text.len().min(1 << 16)];
    content.starts_with(b"glTF")
        || (text.starts_with(b"{") && beginning.windows(7).any(|word| word == b"\"asset\""))
}

fn is_ply(bytes: &[u8]) -> bool {
    matches!(bytes, [b'p', b'l', b'y', b'\n' | b'\r' | b' ', ..])
}

/// Whether there is a vertex among the first lines.
fn looks_like_obj(bytes: &[u8]) -> bool {
    let text = text::utf8(&bytes[..bytes.len().min(1 << 16)]).into_owned();
    let mut scanner = scan::Scanner::joining_lines(&text);
    loop {
        if scanner.word() == b"v" && (0..3).all(|_| number::parse_f32(scanner.word()).is_some()) {
            return true;
        }
        if !scanner.next_line() {
            return false;
        }
    }
}
