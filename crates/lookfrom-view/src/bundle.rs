//! The page as one file: its modules as a classic script, since a page that is opened from a folder may import none, its styles, and data.
//!
//! Only the forms that the page's own modules use are understood: imports of names on a line, exports of declarations.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use lookfrom_scene::Result;
use lookfrom_scene::digest::digest;

use crate::assets::asset;
use crate::view::refused;

const STYLES: [&str; 4] = ["style.css", "panels.css", "figures.css", "media.css"];

/// The page that begins with a module, and holds JSON in the element of this id. It may load nothing and connect to nobody.
///
/// # Errors
/// An error where a file of the page is missing.
pub(crate) fn page(entry: &str, id: &str, data: &str) -> Result<String> {
    let script = script(entry)?;
    let style = STYLES.map(text).into_iter().collect::<Result<String>>()?;
    let policy = format!(
        "default-src 'none'; script-src {}; style-src {}; img-src blob: data:; base-uri 'none'; form-action 'none'",
        source(&script),
        source(&style)
    );
    let head = format!(
        "<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n    <link rel=\"icon\" href=\"data:image/svg+xml;base64,{}\">\n    <style>{style}</style>",
        STANDARD.encode(text("icon.svg")?)
    );
    // Within JSON, an angle bracket is part of a string; as an escape it ends no element.
    let data = data.replace('<', "\\u003c");
    let mut html = String::new();
    for line in text("index.html")?.lines() {
        let trimmed = line.trim();
        if trimmed.starts_with("<link") || trimmed.starts_with("<script") {
            continue;
        }
        if trimmed == "</body>" {
            let _ = write!(
                html,
                "<script type=\"application/json\" id=\"{id}\">{data}</script>\n<script>{script}</script>\n"
            );
        }
        html.push_str(line);
        html.push('\n');
        if trimmed.starts_with("<meta charset") {
            let _ = writeln!(html, "    {head}");
        }
    }
    Ok(html)
}

/// One script of a module and all that it imports, each before those that import it.
fn script(entry: &str) -> Result<String> {
    let mut script = String::from("\"use strict\";\nconst modules = {};\n");
    let mut done = Vec::new();
    add(entry, &mut done, &mut script)?;
    match script.contains("</script") {
        true => Err(refused("internal error: a module of the page ends its element")),
        false => Ok(script),
    }
}

fn add(name: &str, done: &mut Vec<String>, script: &mut String) -> Result<()> {
    if done.iter().any(|known| known == name) {
        return Ok(());
    }
    done.push(name.to_owned());
    let module = text(name)?;
    let (mut body, mut exported) = (String::new(), Vec::new());
    for line in module.lines() {
        if let Some((names, from)) =
            line.strip_prefix("import {").and_then(|rest| rest.split_once("} from \"./"))
        {
            let from = from.trim_end_matches("\";");
            add(from, done, script)?;
            let _ = writeln!(body, "const {{{}}} = modules[\"{from}\"];", names.replace(" as ", ": "));
        } else if let Some(declaration) = line.strip_prefix("export ") {
            let mut words = declaration.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '$'));
            let name = words.find(|word| !matches!(*word, "async" | "function" | "const" | "class"));
            exported.extend(name.filter(|name| !name.is_empty()).map(str::to_owned));
            let _ = writeln!(body, "{declaration}");
        } else {
            let _ = writeln!(body, "{line}");
        }
    }
    let _ = writeln!(
        script,
        "modules[\"{name}\"] = (() => {{\n{body}return {{ {} }};\n}})();",
        exported.join(", ")
    );
    Ok(())
}

fn text(name: &str) -> Result<String> {
    let missing = || refused(format!("internal error: the page has no file {name}"));
    let (_, bytes) = asset(name).ok_or_else(missing)?;
    String::from_utf8(bytes.into_owned()).map_err(|_| missing())
}

/// The source expression of a script or a style in a content security policy: the digest of its text (CSP level 3, section 2.3.1).
fn source(text: &str) -> String {
    let digits = digest(text.as_bytes());
    let bytes: Vec<u8> = (0..digits.len() / 2)
        .filter_map(|i| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok())
        .collect();
    format!("'sha256-{}'", STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_loads_nothing_and_its_data_end_no_element() {
        let page = page("handout.js", "handout", r#"{"a":"</script><b>"}"#).expect("a page");
        assert!(page.contains(r#"{"a":"\u003c/script>\u003cb>"}"#), "data");
        assert!(!page.contains("src=\"/") && !page.contains("href=\"/"), "a file of the server");
        assert!(!page.contains("\nimport ") && !page.contains("\nexport "), "a module");
        assert!(page.contains("modules[\"socket.js\"]") && page.contains("default-src 'none'"));
    }
}
