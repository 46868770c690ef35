//! The XML of scenes: parameters, includes and references, to a tree of plugins.
//!
//! Document type declarations are refused, and with them all entities of a file's own.

mod text;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use glam::DVec3;
use roxmltree::{Document, Node, ParsingOptions};

pub(super) use text::Text;

use super::plugin::{Ids, Plugin, Property, Value};
use super::{transform, value, version1};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::spectrum;
use crate::suggest::nearest;

/// Elements that are plugins if they have a type.
const CLASSES: &[&str] = &[
    "bsdf",
    "emitter",
    "film",
    "integrator",
    "medium",
    "phase",
    "rfilter",
    "sampler",
    "sensor",
    "shape",
    "spectrum",
    "subsurface",
    "texture",
    "volume",
];

/// Other elements.
const OTHERS: &[&str] = &[
    "alias",
    "boolean",
    "default",
    "float",
    "include",
    "integer",
    "path",
    "point",
    "ref",
    "rgb",
    "string",
    "transform",
    "vector",
];

/// Maximum depth of nested elements.
const DEEPEST: u32 = 64;
/// Maximum number of nodes of all files together.
const MOST_NODES: u32 = 1 << 22;
/// Maximum number of attributes of a tag: the parser compares each with all before it.
const MOST_ATTRIBUTES: usize = 1 << 10;
/// Maximum number of included files.
const MOST_FILES: u32 = 1 << 12;
/// Maximum number of bytes of all files together.
const MOST_BYTES: u64 = 1 << 30;
/// Maximum number of bytes that parameters are replaced by.
const MOST_EXPANDED: usize = 1 << 24;
/// Maximum length of a value after its parameters are replaced, in bytes.
const LONGEST_VALUE: usize = 1 << 16;

/// The state of reading the files of a scene.
pub(super) struct Reading<'c, 'f> {
    pub(super) context: &'c mut LoadContext<'f>,
    /// Folders in which files are looked up: that of the scene, then those of `path` elements.
    pub(super) folders: Vec<PathBuf>,
    /// Plugins by id.
    pub(super) ids: Ids,
    /// Parameters and their values.
    parameters: BTreeMap<String, String>,
    /// Names of parameters that the files have or use.
    known: BTreeSet<String>,
    files: u32,
    nodes: u32,
    bytes: u64,
    /// Bytes that parameters were replaced by.
    expanded: usize,
    /// Whether the file is of a version before 2: the names of properties are others.
    is_old: bool,
}

impl<'c, 'f> Reading<'c, 'f> {
    pub(super) fn new(path: &Path, context: &'c mut LoadContext<'f>) -> Self {
        let unquoted = |value: &String| match value.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'))
        {
            Some(inner) => inner.to_owned(),
            None => value.clone(),
        };
        let given = &context.variables.values;
        Self {
            folders: vec![path.parent().unwrap_or(Path::new("")).to_owned()],
            ids: Ids::new(),
            parameters: given.iter().map(|(name, value)| (name.clone(), unquoted(value))).collect(),
            known: BTreeSet::new(),
            files: 0,
            nodes: 0,
            bytes: 0,
            expanded: 0,
            is_old: false,
            context,
        }
    }

    /// The scene as a plugin.
    ///
    /// # Errors
    /// `Syntax`, `Invalid`, `Limit` and `Io` with locations; `Request` for values of parameters that the scene does not have.
    pub(super) fn scene(&mut self, bytes: &[u8], path: &Path) -> Result<Plugin> {
        let mut properties = Vec::new();
        let at = self.file(bytes, path, 0, &mut properties)?;
        let stranger = self.context.variables.values.keys().find(|name| !self.known.contains(*name));
        if let Some(name) = stranger {
            let error = Error::new(
                ErrorKind::Request,
                &Location::file(path),
                format!("there is no parameter `{name}`"),
            );
            let known = self.known.iter().map(String::as_str);
            return Err(match nearest(name, known) {
                Some(meant) => error.hint(format!("did you mean `{meant}`?")),
                None => error.hint("parameters are those of <default> elements"),
            });
        }
        Ok(Plugin::new("scene", "scene".to_owned(), None, at, properties))
    }

    /// The parameters with their values.
    pub(super) fn variables(&self) -> Vec<(String, String)> {
        self.parameters.iter().map(|(name, value)| (name.clone(), value.clone())).collect()
    }

    /// Reads a file, whose elements join `properties`.
    fn file(
        &mut self,
        bytes: &[u8],
        path: &Path,
        depth: u32,
        properties: &mut Vec<Property>,
    ) -> Result<Location> {
        let text = Text::new(path, bytes)?;
        self.bytes += bytes.len() as u64;
        if self.bytes > MOST_BYTES {
            let message = format!("the files of the scene are longer than {MOST_BYTES} bytes");
            return Err(Error::new(ErrorKind::Limit, &text.whole, message));
        }
        if let Some(start) = crowded_tag(&text.text) {
            let message = format!("a tag with more than {MOST_ATTRIBUTES} attributes");
            return Err(Error::new(ErrorKind::Limit, &text.at(start), message));
        }
        let options = ParsingOptions { nodes_limit: MOST_NODES - self.nodes, ..ParsingOptions::default() };
        // A node takes about a hundred bytes, and has at least four of the text.
        let _memory =
            self.context.budget.reserve(30 * bytes.len() as u64, "the parsed scene", &text.whole)?;
        let document =
            Document::parse_with_options(&text.text, options).map_err(|error| text.error(&error))?;
        self.nodes += document.descendants().len() as u32;
        let root = document.root_element();
        let at = text.at(root.range().start);
        if root.tag_name().name() != "scene" {
            if depth == 0 {
                let message = format!("the file begins with <{}>, not with <scene>", root.tag_name().name());
                return Err(Error::syntax(&at, message));
            }
            self.element(root, &text, depth, 0, properties)?;
            return Ok(at);
        }
        self.check_attributes(root, &["version", "type", "id"], &text)?;
        let was_old = self.is_old;
        if let Some((version, at)) = self.attribute(root, "version", &text)? {
            let major = version.trim().split('.').next().and_then(|major| major.parse::<u32>().ok());
            let major = major
                .ok_or_else(|| Error::invalid(&at, format!("{version:?} is not a version, such as 3.0.0")))?;
            self.is_old = major < 2;
        }
        self.elements(root, &text, depth, 0, properties)?;
        self.is_old = was_old;
        Ok(at)
    }

    fn elements(
        &mut self,
        node: Node<'_, '_>,
        text: &Text,
        includes: u32,
        depth: u32,
        properties: &mut Vec<Property>,
    ) -> Result<()> {
        for child in node.children() {
            if child.is_element() {
                self.element(child, text, includes, depth, properties)?;
            } else if child.is_text() && child.text().is_some_and(|words| !words.trim().is_empty()) {
                let at = text.at(child.range().start);
                return Err(
                    Error::syntax(&at, "unexpected text between elements").hint("comments are <!-- … -->")
                );
            }
        }
        Ok(())
    }

    fn element(
        &mut self,
        node: Node<'_, '_>,
        text: &Text,
        includes: u32,
        depth: u32,
        properties: &mut Vec<Property>,
    ) -> Result<()> {
        let at = text.at(node.range().start);
        if depth > DEEPEST {
            return Err(Error::new(ErrorKind::Limit, &at, format!("nested more than {DEEPEST} deep")));
        }
        let tag = node.tag_name().name();
        let kind = self.attribute(node, "type", text)?;
        if CLASSES.contains(&tag) && (tag != "spectrum" || kind.is_some()) {
            self.check_attributes(node, &["type", "id", "name"], text)?;
            let Some((kind, kind_at)) = kind else {
                return Err(Error::invalid(&at, format!("this <{tag}> has no `type`")));
            };
            let name = self.name(node, text)?.map_or_else(String::new, |(name, _)| name);
            let id = self.attribute(node, "id", text)?;
            let mut own = Vec::new();
            self.elements(node, text, includes, depth + 1, &mut own)?;
            if self.is_old {
                version1::upgrade(tag, &kind, &kind_at, &mut own);
            }
            if let Some(second) = repeated(&own) {
                return Err(Error::invalid(&second.at, format!("`{}` is given twice", second.name))
                    .hint("take one of the two out"));
            }
            let plugin = Rc::new(Plugin::new(tag, kind, id.as_ref().map(|(id, _)| id.clone()), kind_at, own));
            if let Some((id, id_at)) = id {
                self.define(id, plugin.clone(), &id_at)?;
            }
            properties.push(Property::new(name, at, Value::Plugin(plugin)));
            return Ok(());
        }
        if let Some(property) = self.directive_or_property(node, text, includes, &at, properties)? {
            properties.push(property);
        }
        if tag != "transform"
            && let Some(child) = node.children().find(Node::is_element)
        {
            let message = format!("a <{tag}> has no elements in it");
            return Err(Error::syntax(&text.at(child.range().start), message));
        }
        Ok(())
    }

    fn directive_or_property(
        &mut self,
        node: Node<'_, '_>,
        text: &Text,
        includes: u32,
        at: &Location,
        properties: &mut Vec<Property>,
    ) -> Result<Option<Property>> {
        let tag = node.tag_name().name();
        if !OTHERS.contains(&tag) && tag != "spectrum" {
            let error = Error::invalid(at, format!("<{tag}> is not a known element"));
            return Err(match nearest(tag, CLASSES.iter().chain(OTHERS).copied()) {
                Some(meant) => error.hint(format!("did you mean <{meant}>?")),
                None => error,
            });
        }
        let allowed: &[&str] = match tag {
            "default" => &["name", "value"],
            "path" => &["value"],
            "include" => &["filename"],
            "alias" => &["id", "as"],
            "ref" => &["id", "name"],
            "transform" => &["name"],
            "point" | "vector" => &["name", "value", "x", "y", "z"],
            "spectrum" => &["name", "value", "filename"],
            _ => &["name", "value"],
        };
        self.check_attributes(node, allowed, text)?;
        match tag {
            "default" => {
                let (name, _) = self.need(node, "name", text)?;
                let (value, _) = self.need(node, "value", text)?;
                self.known.insert(name.clone());
                self.parameters.entry(name).or_insert(value);
                return Ok(None);
            }
            "path" => {
                let (folder, at) = self.need(node, "value", text)?;
                let folder = text.folder.join(folder);
                if self.folders.len() >= DEEPEST as usize {
                    return Err(Error::new(ErrorKind::Limit, &at, format!("more than {DEEPEST} paths")));
                }
                // The last path is searched first, as in Mitsuba.
                self.folders.insert(0, folder);
                return Ok(None);
            }
            "include" => {
                let (name, at) = self.need(node, "filename", text)?;
                self.include(&name, &at, text, includes, properties)?;
                return Ok(None);
            }
            "alias" => {
                let (id, id_at) = self.need(node, "id", text)?;
                let (other, other_at) = self.need(node, "as", text)?;
                let Some(plugin) = self.ids.get(&id).cloned() else {
                    let known = self.ids.keys().map(String::as_str);
                    return Err(super::plugin::unknown(&id_at, "id", &id, known));
                };
                self.define(other, plugin, &other_at)?;
                return Ok(None);
            }
            _ => {}
        }
        let name = self.name(node, text)?;
        if tag == "ref" {
            let (id, id_at) = self.need(node, "id", text)?;
            let name = name.map_or_else(String::new, |(name, _)| name);
            return Ok(Some(Property::new(name, id_at, Value::Reference(id))));
        }
        let Some((name, _)) = name else {
            return Err(Error::invalid(at, format!("this <{tag}> has no `name`")));
        };
        let (value, value_at) = match tag {
            "transform" => (Value::Transform(transform::matrix(self, node, text)?), at.clone()),
            "point" | "vector" if !node.has_attribute("value") => {
                let mut component = |name: &str| {
                    let (written, at) = self.need(node, name, text)?;
                    value::float(&written, &at)
                };
                (Value::Vector(DVec3::new(component("x")?, component("y")?, component("z")?)), at.clone())
            }
            "spectrum" if node.has_attribute("filename") => {
                if node.has_attribute("value") {
                    return Err(Error::invalid(at, "a spectrum has a `value` or a `filename`, not both"));
                }
                let (file, at) = self.need(node, "filename", text)?;
                let path = resolve(&file, &self.folders, self.context);
                let curve = spectrum::read_spd(&path, self.context).map_err(|error| blame(error, &at))?;
                (Value::Curve(curve), at)
            }
            _ => {
                let (written, at) = self.need(node, "value", text)?;
                let value = match tag {
                    "float" => Value::Float(value::float(&written, &at)?),
                    "integer" => Value::Integer(value::integer(&written, &at)?),
                    "boolean" => Value::Boolean(value::boolean(&written, &at)?),
                    "string" => Value::String(written),
                    "point" | "vector" => Value::Vector(value::vector(&written, &at)?),
                    "rgb" => Value::Color(value::rgb(&written, &at)?),
                    _ => value::spectrum(&written, &at)?,
                };
                (value, at)
            }
        };
        Ok(Some(Property::new(name, value_at, value)))
    }

    fn define(&mut self, id: String, plugin: Rc<Plugin>, at: &Location) -> Result<()> {
        if let Some(before) = self.ids.get(&id) {
            let message = format!("the id {id:?} is taken already, at {}", before.at);
            return Err(Error::invalid(at, message).hint("give one of them another id"));
        }
        self.ids.insert(id, plugin);
        Ok(())
    }

    fn include(
        &mut self,
        name: &str,
        at: &Location,
        text: &Text,
        includes: u32,
        properties: &mut Vec<Property>,
    ) -> Result<()> {
        self.files += 1;
        let limit = self.context.limits.import_depth;
        if includes >= limit || self.files > MOST_FILES {
            let message = match includes >= limit {
                true => format!("files include each other more than {limit} deep"),
                false => format!("more than {MOST_FILES} files are included"),
            };
            return Err(Error::new(ErrorKind::Limit, at, message).hint("a file may not include itself"));
        }
        let beside = text.folder.join(name);
        let path = resolve(name, &self.folders, self.context);
        let path = if exists(&path, self.context) || !exists(&beside, self.context) { path } else { beside };
        let bytes = self.context.read(&path).map_err(|error| blame(error, at))?;
        self.file(&bytes, &path, includes + 1, properties)?;
        Ok(())
    }

    /// Whether the file is of a version before 2.
    pub(super) fn is_old(&self) -> bool {
        self.is_old
    }

    /// The name of a property, in the spelling of version 2 and later.
    fn name(&self, node: Node<'_, '_>, text: &Text) -> Result<Option<(String, Location)>> {
        let found = node.attribute_node("name").map(|name| (name.value(), text.at(name.range_value().start)));
        Ok(found.map(|(name, at)| (if self.is_old { snake_case(name) } else { name.to_owned() }, at)))
    }

    /// An attribute with its parameters replaced, and the location of its value.
    pub(super) fn attribute(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        text: &Text,
    ) -> Result<Option<(String, Location)>> {
        let Some(attribute) = node.attribute_node(name) else { return Ok(None) };
        let at = text.at(attribute.range_value().start);
        self.expand(attribute.value(), &at).map(|value| Some((value, at)))
    }

    fn need(&mut self, node: Node<'_, '_>, name: &str, text: &Text) -> Result<(String, Location)> {
        self.attribute(node, name, text)?.ok_or_else(|| {
            let at = text.at(node.range().start);
            Error::invalid(&at, format!("this <{}> has no `{name}`", node.tag_name().name()))
        })
    }

    /// Refuses attributes that the element does not have.
    pub(super) fn check_attributes(&self, node: Node<'_, '_>, known: &[&str], text: &Text) -> Result<()> {
        let Some(stranger) = node.attributes().find(|attribute| !known.contains(&attribute.name())) else {
            return Ok(());
        };
        let at = text.at(stranger.range().start);
        let message = format!("<{}> has no attribute `{}`", node.tag_name().name(), stranger.name());
        Err(Error::invalid(&at, message).hint(format!("it has: {}", known.join(", "))))
    }

    /// A value with its parameters (`$name`) replaced by theirs.
    fn expand(&mut self, value: &str, at: &Location) -> Result<String> {
        let mut parts = value.split('$');
        let mut expanded = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let end = part.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(part.len());
            let (name, rest) = part.split_at(end);
            let Some(meant) = self.parameters.get(name) else {
                let error = Error::invalid(at, format!("the parameter `${name}` has no value"));
                let known = self.parameters.keys().map(String::as_str);
                return Err(match nearest(name, known) {
                    Some(meant) => error.hint(format!("did you mean `${meant}`?")),
                    None => error.hint(format!(
                        "set the variable `{name}`, or write <default name=\"{name}\" value=\"…\"/> before"
                    )),
                });
            };
            self.known.insert(name.to_owned());
            expanded.push_str(meant);
            expanded.push_str(rest);
            self.expanded += meant.len();
            if expanded.len() > LONGEST_VALUE || self.expanded > MOST_EXPANDED {
                let message = format!(
                    "parameters make this longer than {LONGEST_VALUE} bytes, or all values by {MOST_EXPANDED}"
                );
                return Err(Error::new(ErrorKind::Limit, at, message));
            }
        }
        Ok(expanded)
    }
}

/// The second of two properties with the same name.
fn repeated(properties: &[Property]) -> Option<&Property> {
    let mut names = BTreeSet::new();
    properties.iter().find(|property| !property.name.is_empty() && !names.insert(&*property.name))
}

/// Whether there is a file.
fn exists(path: &Path, context: &LoadContext<'_>) -> bool {
    context.files.length(path).is_some()
}

/// The first file of that name in the folders; where there is none, that in the folder of the scene, which is the last.
pub(super) fn resolve(name: &str, folders: &[PathBuf], context: &LoadContext<'_>) -> PathBuf {
    let paths = folders.iter().map(|folder| folder.join(name));
    paths
        .clone()
        .find(|path| exists(path, context))
        .or_else(|| paths.clone().next_back())
        .unwrap_or_else(|| name.into())
}

/// Relocates the error of a file that cannot be opened to where it is named; errors inside a file stay there.
pub(super) fn blame(error: Error, at: &Location) -> Error {
    if error.at.line > 0 || !matches!(error.kind, ErrorKind::Io | ErrorKind::Unsupported) {
        return error;
    }
    let message = format!("{}: {}", error.at, error.message);
    Error { hint: error.hint, ..Error::new(error.kind, at, message) }
}

/// `toWorld` as `to_world`, `toUV` as `to_uv`.
fn snake_case(name: &str) -> String {
    let mut snake = String::with_capacity(name.len() + 4);
    let mut was_lower = false;
    for c in name.chars() {
        if c.is_ascii_uppercase() && was_lower {
            snake.push('_');
        }
        was_lower = c.is_ascii_lowercase() || c.is_ascii_digit();
        snake.push(c.to_ascii_lowercase());
    }
    snake
}

/// The place of the first tag with more than [`MOST_ATTRIBUTES`], by its equals signs outside of quotes.
fn crowded_tag(text: &str) -> Option<usize> {
    let mut start = 0;
    while let Some(found) = text[start..].find('<') {
        start += found;
        let rest = &text[start..];
        let not_tags = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((_, end)) = not_tags.iter().find(|(begin, _)| rest.starts_with(begin)) {
            start += rest.find(end)?;
            continue;
        }
        let (mut quote, mut attributes, mut length) = (None, 0, 1);
        for byte in rest[1..].bytes() {
            length += 1;
            match (quote, byte) {
                (Some(open), _) if open == byte => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => attributes += 1,
                (None, b'>') => break,
                _ => {}
            }
        }
        if attributes > MOST_ATTRIBUTES {
            return Some(start);
        }
        start += length;
    }
    None
}
