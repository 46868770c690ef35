//! `[[text]]`: words in a font, as a solid or a sheet.

use super::Reader;
use super::mesh::too_many;
use super::table::Table;
use super::value::Value;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::shape::Geometry;
use crate::tessellation::BYTES_OF_TRIANGLE;
use crate::text::{Align, TextLayout, solid};

/// The depth of a solid in its size.
const DEPTH: f64 = 0.2;

const ALIGNMENTS: &[(&str, Align)] =
    &[("left", Align::Left), ("center", Align::Center), ("right", Align::Right)];

impl Reader<'_, '_> {
    /// A mesh whose first baseline is on the x axis, and whose front faces +z.
    pub(super) fn text(&mut self, table: &Table<'_>) -> Result<Geometry> {
        let text = table.need("text", "\"Hello\"", None, |value| Ok(Some((value, value.text("a text")?))));
        let font = table.need("font", "\"DejaVuSans.ttf\"", None, |value| {
            Ok(Some(self.resolve(value, "the name of a font file (.ttf, .otf)")?))
        });
        let size = table.or("size", 1.0, Value::positive);
        let layout = TextLayout {
            size,
            depth: table.or("depth", DEPTH * size, Value::not_negative),
            align: table.or("align", Align::Left, |value| value.choice(ALIGNMENTS)),
            line_spacing: table.or("line_spacing", 1.0, Value::positive),
        };
        table.sound(&["text", "font", "size", "depth"])?;
        let (Some((value, text)), Some(font)) = (text, font) else { return Err(Error::untold()) };
        // A glyph is seldom more than some hundred triangles.
        let (count, most) = (100 * text.chars().count() as u64, self.context.limits.elements);
        if count > most {
            return Err(too_many(table, count, most));
        }
        let _memory = self.context.budget.reserve(count * BYTES_OF_TRIANGLE, "the text", &value.at())?;
        let bytes = self.context.read(&font)?;
        let Some(solid) = solid(&bytes, text, layout) else {
            let error =
                Error::new(ErrorKind::Syntax, &Location::file(&font), "not a TrueType or OpenType font");
            return Err(error.hint("`font` names a file, .ttf or .otf"));
        };
        if !solid.missing.is_empty() {
            let list: Vec<String> = solid.missing.iter().map(|character| format!("`{character}`")).collect();
            let message = format!("the font has no {}: left out", list.join(", "));
            self.context.warn(&value.at(), message);
        }
        if solid.mesh.triangles.is_empty() {
            return Err(value
                .error("no character of the text has a shape")
                .hint("give it letters that the font has"));
        }
        self.mesh(table, solid.mesh)
    }
}
