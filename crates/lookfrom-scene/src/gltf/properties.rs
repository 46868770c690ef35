//! Properties that an animation changes by their JSON pointers: of materials, lights, cameras and nodes
//! (`KHR_animation_pointer`, ratified in 2025).
//!
//! Their values are written into the JSON, from which the document's structures are made once more: so all that is read can move.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde_json::{Map, Number, Value};

use super::animation::{Animated, channel_value};
use super::file::Document;
use super::json::{self, Camera, Light, Material, Mesh, Node, Root};
use crate::error::Result;
use crate::files::LoadContext;

/// Bytes of a value of the JSON, with its place in an array or object.
const VALUE: u64 = 160;

/// A list of the file whose items change.
struct List {
    /// The JSON pointer of its items, up to their index.
    items: &'static str,
    /// Whether a value is such an item.
    is_item: fn(&Value) -> bool,
}

const LISTS: [List; 5] = [
    List { items: "/nodes/", is_item: is::<Node> },
    List { items: "/materials/", is_item: is::<Material> },
    List { items: "/cameras/", is_item: is::<Camera> },
    List { items: "/meshes/", is_item: is::<Mesh> },
    List { items: "/extensions/KHR_lights_punctual/lights/", is_item: is::<Light> },
];

/// Whether a value is a structure, by its text: structures are made of text alone, so that serde's code for each is compiled once.
fn is<T: DeserializeOwned>(value: &Value) -> bool {
    serde_json::from_str::<T>(&value.to_string()).is_ok()
}

/// The value that a channel gives to a property.
struct Change<'a> {
    /// The index of the channel.
    channel: usize,
    /// The property: a JSON pointer in its item.
    property: &'a str,
    /// The components of its value at the requested time.
    numbers: Vec<f64>,
}

/// Gives the document the values that an animation has at the requested time, by its channels with pointers. What is not in
/// the file, or takes no such values, is left as it is, with a warning.
///
/// # Errors
/// As [`channel_value`], and `Limit` if there is not enough memory for the JSON's values.
pub(super) fn animate(document: &mut Document, index: usize, context: &mut LoadContext<'_>) -> Result<()> {
    let animation = &document.root.animations[index];
    if !animation.has_pointers() {
        return Ok(());
    }
    let still = |channel: usize, pointer: &str, context: &mut LoadContext<'_>| {
        let at = document.at(&format!("/animations/{index}/channels/{channel}"));
        context.warn(&at, format!("{pointer:?} cannot take the channel's values, and stays as it is"));
    };

    // The changes of each item.
    let mut items: BTreeMap<&str, (&List, Vec<Change<'_>>)> = BTreeMap::new();
    for (channel, animated_by) in animation.channels.iter().enumerate() {
        let Some(pointer) = &animated_by.target.extensions.pointer else { continue };
        let pointer = pointer.pointer.as_str();
        let animated = animated(document, index, channel, pointer)?;
        let Some(numbers) = channel_value(document, index, channel, animated, context)? else { continue };
        match item_and_property(pointer) {
            Some((list, item, property)) => {
                let (_, changes) = items.entry(item).or_insert_with(|| (list, Vec::new()));
                changes.push(Change { channel, property, numbers });
            }
            None => still(channel, pointer, context),
        }
    }

    // The JSON as values, with what is changed.
    let at = document.at(&format!("/animations/{index}"));
    let bytes = document.json();
    let values = bytes.iter().filter(|byte| b",[{".contains(byte)).count() as u64;
    // Of texts the file's and the changed one.
    let memory = 2 * bytes.len() as u64 + values * VALUE;
    let _memory =
        context.budget.reserve(memory, "the values of the JSON, which an animation changes", &at)?;
    let mut root: Value = match serde_json::from_str(&json::text(bytes)) {
        Ok(root) => root,
        Err(error) => {
            context.warn(&at, format!("properties stay as they are: {error}"));
            return Ok(());
        }
    };
    for (pointer, (list, changes)) in items {
        let item = root.pointer_mut(pointer);
        let mut moved = item.as_deref().cloned();
        for Change { channel, property, numbers } in &changes {
            if moved.as_mut().and_then(|moved| change(moved, property, numbers)).is_none() {
                still(*channel, &format!("{pointer}{property}"), context);
            }
        }
        let Some((item, moved)) = item.zip(moved) else { continue };
        if (list.is_item)(&moved) {
            *item = moved;
        } else {
            still(changes[0].channel, pointer, context);
        }
    }

    // Back to structures.
    match serde_json::from_str::<Root>(&root.to_string()) {
        Ok(root) => document.root = root,
        Err(error) => context.warn(&at, format!("properties stay as they are: {error}")),
    }
    Ok(())
}

/// The type of the value of a channel with this pointer, by its accessor's.
fn animated(document: &Document, animation: usize, channel: usize, pointer: &str) -> Result<Animated> {
    let whole = &document.root.animations[animation];
    let sampler = whole.channels[channel].sampler;
    // One that does not exist is an error where it is evaluated.
    let Some(sampler) = whole.samplers.get(sampler.index()) else { return Ok(Animated::Weights) };
    let asked = format!("/animations/{animation}/channels/{channel}/sampler");
    Ok(match document.shape(sampler.output, &asked)? {
        (1, _) => Animated::Weights,
        (4, _) if pointer.starts_with("/nodes/") && pointer.ends_with("/rotation") => Animated::Rotation,
        (width, _) => Animated::Numbers(width),
    })
}

/// A pointer's list, the pointer of the item in it, and that of the property in the item.
fn item_and_property(pointer: &str) -> Option<(&'static List, &str, &str)> {
    let list = LISTS.iter().find(|list| pointer.starts_with(list.items))?;
    let end = list.items.len() + pointer[list.items.len()..].find('/')?;
    let (item, property) = pointer.split_at(end);
    Some((list, item, property))
}

/// Changes a property of an item; `None` if there is none, or none with so many numbers.
fn change(item: &mut Value, property: &str, numbers: &[f64]) -> Option<()> {
    let mut tokens = property.split('/').skip(1);
    let value = tokens.try_fold(item, |value, token| {
        // What the file leaves to its default.
        if value.is_null() && token.parse::<usize>().is_err() {
            *value = Value::Object(Map::new());
        }
        match value {
            Value::Array(items) => items.get_mut(token.parse::<usize>().ok()?),
            Value::Object(members) => {
                Some(members.entry(token.replace("~1", "/").replace("~0", "~")).or_insert(Value::Null))
            }
            _ => None,
        }
    })?;
    let number = |&number: &f64| Number::from_f64(number).map(Value::Number);
    let name = property.rsplit('/').next()?;
    *value = match (&*value, numbers) {
        (Value::Bool(_), &[truth]) => Value::Bool(truth != 0.0),
        (Value::Null, &[truth]) if name == "visible" => Value::Bool(truth != 0.0),
        (Value::Null, [one]) if name != "weights" => number(one)?,
        (Value::Number(_), [one]) => number(one)?,
        (Value::Array(items), _) if items.len() == numbers.len() => {
            numbers.iter().map(number).collect::<Option<_>>()?
        }
        (Value::Null, _) => numbers.iter().map(number).collect::<Option<_>>()?,
        _ => return None,
    };
    Some(())
}
