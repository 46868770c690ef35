//! A glTF document and its bytes: the JSON, alone or in a GLB container, and the buffers in the container, in other files
//! or in the JSON (specification, §2.7, §3.6.1, §4).

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::draco::{self, Compressed, Decoded};
use super::json::{self, Animation, Root, Whole};
use super::meshopt::{self, CompressedView};
use super::uri::{self, Uri};
use crate::budget::{Budget, Reservation, Reserved};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Limits, LoadContext};
use crate::model::surface::beside;

/// The first bytes of a GLB container.
pub(super) const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;

/// The number of attribute and index values allowed per element of [`Limits::elements`]: a vertex has several.
const VALUES_AN_ELEMENT: u64 = 8;

/// The maximum number of elements of accessors without a buffer view, which are zeros, in a file: otherwise a file of a
/// few bytes could exhaust the memory.
const MOST_ZEROS: u64 = 1 << 26;

/// A file with its buffers.
pub(crate) struct Document {
    /// The parsed JSON.
    pub(crate) root: Root,
    /// The path of the file.
    pub(crate) path: PathBuf,
    /// The limits.
    pub(crate) limits: Limits,
    at: Location,
    content: Reserved<Vec<u8>>,
    /// The bytes of `content` that are the JSON.
    json: Range<usize>,
    buffers: Vec<Bytes>,
    /// The memory for all that is read.
    pub(crate) budget: Budget,
    /// The memory of what this document holds, besides its files.
    held: Mutex<Vec<Reservation>>,
    /// Decompressed buffer views, filled at the first request.
    decoded: Vec<OnceLock<Result<Vec<u8>>>>,
    /// Decoded Draco meshes.
    pub(super) compressed: Compressed,
    /// The number of accessor elements read so far.
    values: AtomicU64,
    /// The number of elements without bytes in a buffer so far.
    zeros: AtomicU64,
}

/// The location of a buffer's bytes.
enum Bytes {
    /// A part of the container.
    Chunk(Range<usize>),
    Own(Arc<Reserved<Vec<u8>>>),
    /// The bytes could not be read; an error only where they are used.
    Missing(Error),
}

/// The bytes of a buffer view.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    /// Its bytes.
    pub(crate) bytes: &'a [u8],
    /// Distance from element to element in bytes, where the file gives one.
    pub(crate) stride: Option<usize>,
}

impl Document {
    /// Splits a file's content into JSON and binary chunk, and reads the buffers that it names.
    ///
    /// # Errors
    /// `Syntax` if it is not glTF, `Unsupported` if it is another version.
    pub(crate) fn open(
        content: Reserved<Vec<u8>>,
        path: &Path,
        context: &mut LoadContext<'_>,
    ) -> Result<Self> {
        let at = Location::file(path);
        let (what, (json, binary)) = match content.starts_with(MAGIC) {
            true => ("the JSON of the GLB container", chunks(&content, &at, context)?),
            false => ("the file", (0..content.len(), None)),
        };
        let memory = json::memory(&content[json.clone()]);
        let memory = context.budget.reserve(memory, what, &at)?;
        let root = parse(&content[json.clone()], what, &at, context)?;
        check_version(&root, &at, context)?;
        let decoded = root.buffer_views.iter().map(|_| OnceLock::new()).collect();
        let limits = context.limits;
        // Text may be long; it is read once more only if an animation changes it.
        let is_needed = binary.is_some() || root.animations.iter().any(Animation::has_pointers);
        let (content, json) = if is_needed { (content, json) } else { (Vec::new().into(), 0..0) };
        let compressed = Compressed::new(&root);
        let mut document = Self {
            root,
            path: path.to_owned(),
            limits,
            at,
            content,
            json,
            buffers: Vec::new(),
            budget: context.budget.clone(),
            held: Mutex::new(vec![memory]),
            decoded,
            compressed,
            values: AtomicU64::new(0),
            zeros: AtomicU64::new(0),
        };
        document.read_buffers(binary.as_ref(), context);
        Ok(document)
    }

    /// The bytes of the JSON, if the file is a container or an animation has pointers.
    pub(super) fn json(&self) -> &[u8] {
        &self.content[self.json.clone()]
    }

    /// The location of a JSON pointer in this file.
    pub(crate) fn at(&self, pointer: &str) -> Location {
        self.at.pointer(pointer)
    }

    /// An error of kind `Invalid` at a JSON pointer.
    pub(crate) fn invalid(&self, pointer: &str, message: impl Into<String>) -> Error {
        Error::invalid(&self.at(pointer), message)
    }

    /// An item of a list, or the error that it does not exist.
    pub(crate) fn one_of<'a, T>(
        &self,
        list: &'a [T],
        index: Whole,
        what: &str,
        asked: &str,
    ) -> Result<&'a T> {
        list.get(index.index()).ok_or_else(|| {
            let message = match list.len() {
                0 => format!("{what} {} is used, but the file has none", index.0),
                count => {
                    format!("{what} {} is used, but the file has {count}, from 0 to {}", index.0, count - 1)
                }
            };
            self.invalid(asked, message).hint("the file is damaged or was written wrongly: export it again")
        })
    }

    /// Counts elements that are about to be read.
    ///
    /// # Errors
    /// `Limit` if their total exceeds the limits.
    pub(crate) fn count(&self, values: u64, asked: &str) -> Result<()> {
        let before = self.values.fetch_add(values, Ordering::Relaxed);
        let most = self.limits.elements.saturating_mul(VALUES_AN_ELEMENT);
        if values > self.limits.elements || before.saturating_add(values) > most {
            let message = format!(
                "{values} values, after {before} others, are more than the limits of {} and {most} in all",
                self.limits.elements
            );
            return Err(Error::new(ErrorKind::Limit, &self.at(asked), message)
                .hint("split the model into several files"));
        }
        Ok(())
    }

    /// Reserves memory for what the document holds until it is dropped, or for what is read from it.
    ///
    /// # Errors
    /// `Limit` if there is not so much left.
    fn hold(&self, bytes: u64, what: &str, asked: &str) -> Result<()> {
        let memory = self.budget.reserve(bytes, what, &self.at(asked))?;
        self.held.lock().unwrap_or_else(PoisonError::into_inner).push(memory);
        Ok(())
    }

    /// Counts zero-filled elements that are about to be created.
    ///
    /// # Errors
    /// `Limit` if their total is too large.
    pub(crate) fn count_zeros(&self, zeros: u64, asked: &str) -> Result<()> {
        let before = self.zeros.fetch_add(zeros, Ordering::Relaxed);
        if before.saturating_add(zeros) > MOST_ZEROS {
            let message = format!(
                "{zeros} elements without a buffer view, after {before} others, are more than the limit of {MOST_ZEROS}"
            );
            return Err(Error::new(ErrorKind::Limit, &self.at(asked), message)
                .hint("the file is damaged or was written wrongly: export it again"));
        }
        Ok(())
    }

    /// The bytes of a buffer view; `asked` is the JSON pointer of the property that refers to it.
    ///
    /// # Errors
    /// If the view, or its buffer, does not exist or is too short, or if it cannot be decompressed.
    pub(crate) fn view(&self, index: Whole, asked: &str) -> Result<View<'_>> {
        let view = self.one_of(&self.root.buffer_views, index, "buffer view", asked)?;
        let stride = view.byte_stride.map(Whole::index);
        if let Some(packed) = &view.extensions.meshopt {
            let place = format!("/bufferViews/{}/extensions/EXT_meshopt_compression", index.0);
            let unpack = || {
                let bytes = self.part(packed.buffer, packed.byte_offset, packed.byte_length, &place)?;
                self.unpack(bytes, packed, &place)
            };
            return match self.decoded[index.index()].get_or_init(unpack) {
                Ok(bytes) => Ok(View { bytes, stride: stride.or(Some(packed.byte_stride.index())) }),
                Err(error) => Err(error.clone()),
            };
        }
        let place = format!("/bufferViews/{}", index.0);
        Ok(View { bytes: self.part(view.buffer, view.byte_offset, view.byte_length, &place)?, stride })
    }

    fn unpack(&self, bytes: &[u8], packed: &json::Meshopt, place: &str) -> Result<Vec<u8>> {
        let at = self.at(place);
        let layout = CompressedView::new(packed, &at)?;
        // Elements can have hundreds of bytes, and a damaged file many views, so bytes count as well.
        self.count(layout.count.saturating_mul(layout.stride / 4), place)?;
        self.hold(layout.count.saturating_mul(layout.stride), "a compressed buffer view", place)?;
        meshopt::decode(bytes, &layout, &at, &self.limits)
    }

    /// The Draco mesh in a buffer view; `asked` is the JSON pointer of the property that refers to it.
    ///
    /// # Errors
    /// As [`Document::view`], and if it cannot be decoded.
    pub(super) fn unpacked(&self, view: Whole, asked: &str) -> Result<&Decoded> {
        self.one_of(&self.root.buffer_views, view, "buffer view", asked)?;
        self.compressed.get_or_decode(view, || {
            let place = format!("/bufferViews/{}", view.0);
            let mesh = draco::decode(self.view(view, asked)?.bytes, &self.at(&place), &self.limits)?;
            self.count(mesh.vertices as u64, &place)?;
            self.count(mesh.indices.len() as u64, &place)?;
            self.hold(mesh.bytes(), "a compressed mesh", &place)?;
            Ok(mesh)
        })
    }

    /// A part of a buffer.
    fn part(&self, buffer: Whole, offset: Option<Whole>, length: Whole, asked: &str) -> Result<&[u8]> {
        self.one_of(&self.root.buffers, buffer, "buffer", asked)?;
        let bytes = match &self.buffers[buffer.index()] {
            Bytes::Chunk(range) => &self.content[range.clone()],
            Bytes::Own(bytes) => bytes,
            Bytes::Missing(error) => return Err(error.clone()),
        };
        let (start, length) = (offset.unwrap_or_default().index(), length.index());
        let end = start.checked_add(length);
        end.and_then(|end| bytes.get(start..end)).ok_or_else(|| {
            let message = format!(
                "{} from byte {start} on {} beyond the end of buffer {}, which has {}",
                crate::plural::counted(length, "byte"),
                crate::plural::be(length as u64),
                buffer.0,
                bytes.len()
            );
            self.invalid(asked, message).hint("the file is cut off or was written wrongly: export it again")
        })
    }

    fn read_buffers(&mut self, binary: Option<&Range<usize>>, context: &mut LoadContext<'_>) {
        let mut files: BTreeMap<PathBuf, Arc<Reserved<Vec<u8>>>> = BTreeMap::new();
        let mut buffers = Vec::with_capacity(self.root.buffers.len());
        for (index, buffer) in self.root.buffers.iter().enumerate() {
            let place = format!("/buffers/{index}");
            let bytes = match (&buffer.uri, binary) {
                (None, Some(range)) if index == 0 => Bytes::Chunk(range.clone()),
                (None, _) => Bytes::Missing(
                    self.invalid(&place, "the buffer has no `uri`, and there is no binary chunk for it")
                        .hint("the file is cut off or was written wrongly: export it again"),
                ),
                (Some(uri), _) => match self.fetch(uri, &place, &mut files, context) {
                    Ok(bytes) => Bytes::Own(bytes),
                    Err(error) => Bytes::Missing(error),
                },
            };
            let length = match &bytes {
                Bytes::Chunk(range) => range.len(),
                Bytes::Own(bytes) => bytes.len(),
                Bytes::Missing(_) => buffer.byte_length.index(),
            };
            if (length as u64) < buffer.byte_length.0 {
                let expected = buffer.byte_length.0;
                context.notice(
                    &self.at(&place),
                    format!(
                        "the file announces {} for the buffer; it has {length}",
                        crate::plural::counted(expected, "byte")
                    ),
                );
            }
            buffers.push(bytes);
        }
        self.buffers = buffers;
    }

    fn fetch(
        &self,
        uri: &str,
        place: &str,
        files: &mut BTreeMap<PathBuf, Arc<Reserved<Vec<u8>>>>,
        context: &LoadContext<'_>,
    ) -> Result<Arc<Reserved<Vec<u8>>>> {
        match self.uri(uri, &format!("{place}/uri"))? {
            Uri::Data(bytes) => {
                let memory = context.budget.reserve(bytes.len() as u64, "a buffer", &self.at(place))?;
                Ok(Arc::new(Reserved::new(bytes, memory)))
            }
            Uri::Names(names) => {
                let (path, bytes) = self.first_of(&names, place, |path| match files.get(path) {
                    Some(bytes) => Ok(bytes.clone()),
                    None => context.read(path).map(Arc::new),
                })?;
                files.insert(path, bytes.clone());
                Ok(bytes)
            }
        }
    }

    /// The content of a `uri`.
    ///
    /// # Errors
    /// `Syntax` if its data is malformed, `Unsupported` if it is a network address.
    pub(crate) fn uri(&self, uri: &str, asked: &str) -> Result<Uri> {
        uri::read(uri, &self.at(asked))
    }

    /// The result for the first of these names, relative to this file, that can be read.
    ///
    /// # Errors
    /// The error of the first name, at the property that refers to it.
    pub(crate) fn first_of<T>(
        &self,
        names: &[String],
        asked: &str,
        mut read: impl FnMut(&Path) -> Result<T>,
    ) -> Result<(PathBuf, T)> {
        let mut first = None;
        for name in names {
            let path = beside(&self.path, name);
            match read(&path) {
                Ok(found) => return Ok((path, found)),
                Err(error) => {
                    first.get_or_insert(error);
                }
            }
        }
        let error = first.unwrap_or_else(|| self.invalid(asked, "this names no file"));
        Err(Error { message: format!("{}: {}", error.at, error.message), at: self.at(asked), ..error })
    }
}

/// The JSON and the binary chunk of a GLB container.
fn chunks(
    content: &[u8],
    at: &Location,
    context: &mut LoadContext<'_>,
) -> Result<(Range<usize>, Option<Range<usize>>)> {
    let bad = |message: String| {
        Error::syntax(at, message)
            .hint("the file is cut off or was written wrongly: export or download it again")
    };
    let number =
        |offset: usize| content.get(offset..offset + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let (Some(version), Some(length)) = (number(4), number(8)) else {
        return Err(bad(format!("a GLB header has 12 bytes, the file only {}", content.len())));
    };
    if version != 2 {
        return Err(unsupported(at, &format!("version {version} of the GLB container")));
    }
    if length as usize != content.len() {
        context.notice(
            at,
            format!(
                "the GLB header announces {}; the file has {}",
                crate::plural::counted(length, "byte"),
                content.len()
            ),
        );
    }

    let mut json = None;
    let mut binary = None;
    let mut start = 12;
    while let (Some(length), Some(kind)) = (number(start), number(start + 4)) {
        let first = start + 8;
        let end = first.checked_add(length as usize).filter(|&end| end <= content.len());
        let Some(end) = end else {
            let left = content.len() - first;
            return Err(bad(format!(
                "a chunk of {} starts at byte {start}, but only {left} follow",
                crate::plural::counted(length, "byte")
            )));
        };
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(first..end),
            _ if json.is_none() => {
                return Err(bad("the first chunk of the GLB container is not its JSON".to_owned()));
            }
            BINARY_CHUNK if binary.is_none() => binary = Some(first..end),
            JSON_CHUNK | BINARY_CHUNK => {
                context.warn(at, "the GLB container has a chunk twice: the first one counts");
            }
            // Chunks of other types are ignored.
            _ => {}
        }
        start = end;
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => Err(bad("the GLB container has no JSON".to_owned())),
    }
}

/// Parses the bytes of the JSON; messages call them `what`.
fn parse(bytes: &[u8], what: &str, at: &Location, context: &mut LoadContext<'_>) -> Result<Root> {
    let text = json::text(bytes);
    if matches!(text, Cow::Owned(_)) {
        context.notice(at, "the JSON is not valid UTF-8; invalid bytes are read as �");
    }
    if text.is_empty() {
        let found = if bytes.is_empty() { "is empty" } else { "contains only spaces and zeros" };
        return Err(Error::syntax(at, format!("{what} {found}; expected the JSON of a glTF 2.0 model")));
    }
    json::parse(&text).map_err(|wrong| {
        let Some(pointer) = wrong.pointer else {
            let place = at.at(wrong.line, wrong.column);
            return Error::syntax(&place, format!("this is not valid glTF JSON: {}", wrong.message))
                .hint(instead_of_json(&text));
        };
        // Other versions have other names, so a JSON error may be due to the version.
        match json::version(&text) {
            Some(version) if !version.starts_with('2') => {
                unsupported(&at.pointer("/asset/version"), &format!("glTF {version}"))
            }
            _ => Error::invalid(&at.pointer(&pointer), wrong.message)
                .hint("Khronos' glTF validator shows everything that is wrong with the file"),
        }
    })
}

/// The hint for a file that is not JSON.
fn instead_of_json(text: &str) -> &'static str {
    if text.starts_with('<') {
        "this is a web page or XML: download the model itself"
    } else {
        "check that the file is whole"
    }
}

fn check_version(root: &Root, at: &Location, context: &mut LoadContext<'_>) -> Result<()> {
    let (asked, pointer) = match &root.asset.min_version {
        Some(version) => (version, "/asset/minVersion"),
        None => (&root.asset.version, "/asset/version"),
    };
    let mut numbers = asked.split('.').map(|number| number.parse::<u32>().ok());
    match (numbers.next().flatten(), numbers.next().flatten()) {
        (Some(2), Some(minor)) => {
            if minor > 0 && root.asset.min_version.is_some() {
                context.warn(&at.pointer(pointer), format!("glTF {asked} is read as if it were glTF 2.0"));
            }
            Ok(())
        }
        (Some(_), Some(_)) => Err(unsupported(&at.pointer(pointer), &format!("glTF {asked}"))),
        _ => Err(Error::invalid(&at.pointer(pointer), format!("the version {asked:?} is not like \"2.0\""))),
    }
}

fn unsupported(at: &Location, what: &str) -> Error {
    Error::new(ErrorKind::Unsupported, at, format!("{what} is not read, only glTF 2.0"))
        .hint("most programs can load it and write it as glTF 2.0")
}
