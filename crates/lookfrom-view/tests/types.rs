//! The page's types of inspections, `types/inspection.d.ts`, are those of `docs/guide/inspect.schema.json`.
//!
//! With `LOOKFROM_ACCEPT=1` the file is written anew. TypeScript checks the page with it: see `browser/run.sh`.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

const HEAD: &str = "\
// The types of inspections, made from docs/guide/inspect.schema.json by tests/types.rs; not to be edited.
//
// Numbers that are not finite are the strings \"NaN\", \"Infinity\" and \"-Infinity\": the types leave this out.
";

/// Names that stand for TypeScript's own type of numbers.
const NUMBERS: &[&str] = &["number", "count"];

/// The name of a definition: `light_place` is `LightPlace`.
fn name(definition: &str) -> String {
    definition.split('_').map(|word| word[..1].to_uppercase() + &word[1..]).collect()
}

/// The types of a list, as alternatives.
fn union(types: impl Iterator<Item = String>) -> String {
    types.collect::<Vec<_>>().join(" | ")
}

/// The type of a schema other than an object with properties.
fn type_of(schema: &Value) -> String {
    if let Some(path) = schema["$ref"].as_str() {
        let definition = path.trim_start_matches("#/$defs/");
        return if NUMBERS.contains(&definition) { "number".to_owned() } else { name(definition) };
    }
    if let Some(types) = schema["anyOf"].as_array() {
        return union(types.iter().map(type_of));
    }
    if let Some(values) = schema["enum"].as_array() {
        return union(values.iter().map(Value::to_string));
    }
    match &schema["type"] {
        Value::Array(words) => union(words.iter().map(|word| type_of_word(schema, word))),
        word => type_of_word(schema, word),
    }
}

fn type_of_word(schema: &Value, word: &Value) -> String {
    match word.as_str() {
        Some("integer" | "number") => "number".to_owned(),
        Some("array") => list_of(schema),
        Some(word @ ("string" | "boolean" | "null")) => word.to_owned(),
        _ => panic!("a type that is not known: {schema}"),
    }
}

/// An array, or a tuple where its length is fixed.
fn list_of(schema: &Value) -> String {
    if let Some(items) = schema["prefixItems"].as_array() {
        return format!("[{}]", items.iter().map(type_of).collect::<Vec<_>>().join(", "));
    }
    let item = type_of(&schema["items"]);
    match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
        (Some(least), Some(most)) if least == most => {
            format!("[{}]", vec![item; most as usize].join(", "))
        }
        _ if item.contains(' ') && !item.starts_with('[') => format!("({item})[]"),
        _ => format!("{item}[]"),
    }
}

fn comment(schema: &Value, indent: &str) -> String {
    let description = schema["description"].as_str();
    description.map_or_else(String::new, |text| format!("{indent}/** {text} */\n"))
}

/// The entries of an object by name, whatever order the parser keeps.
fn entries(object: &Value) -> Option<BTreeMap<&str, &Value>> {
    Some(object.as_object()?.iter().map(|(name, value)| (name.as_str(), value)).collect())
}

/// The types of all definitions.
fn types(schema: &Value) -> String {
    let mut text = HEAD.to_owned();
    let definitions = entries(&schema["$defs"]).expect("definitions");
    for (definition, schema) in definitions.into_iter().filter(|(name, _)| !NUMBERS.contains(name)) {
        text += "\n";
        text += &comment(schema, "");
        let name = name(definition);
        let Some(properties) = entries(&schema["properties"]) else {
            writeln!(text, "export type {name} = {};", type_of(schema)).expect("a string");
            continue;
        };
        writeln!(text, "export interface {name} {{").expect("a string");
        let required = schema["required"].as_array().map_or(&[][..], Vec::as_slice);
        for (key, property) in properties {
            let mark = if required.iter().any(|name| name == key) { "" } else { "?" };
            text += &comment(property, "    ");
            writeln!(text, "    {key}{mark}: {};", type_of(property)).expect("a string");
        }
        text += "}\n";
    }
    text
}

#[test]
fn types_of_inspections_are_those_of_the_schema() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &Path| std::fs::read_to_string(path).unwrap_or_default();
    let schema = read(&here.join("../../docs/guide/inspect.schema.json"));
    let made = types(&serde_json::from_str(&schema).expect("a schema"));
    let path = here.join("types/inspection.d.ts");
    if std::env::var_os("LOOKFROM_ACCEPT").is_some() {
        std::fs::write(&path, &made).expect("the file of types is written");
    }
    assert!(read(&path) == made, "{} is not of the schema: LOOKFROM_ACCEPT=1 writes it", path.display());
}
