//! `pieces` of a `[[mesh]]`: names of runs of its triangles.

use std::sync::Arc;

use super::Reader;
use super::table::Table;
use super::value::Value;
use crate::error::Result;
use crate::shape::{Geometry, Part, Piece, Pieces};

/// The keys of a piece.
const KEYS: &[&str] = &["name", "first"];

impl Reader<'_, '_> {
    /// Gives the parts of a `[[mesh]]` the pieces that its table has.
    pub(super) fn put_pieces(&mut self, table: &Table<'_>, parts: &mut [Part]) {
        let Some(value) = table.find("pieces") else { return };
        if self.subdivision(table) > 0 {
            let message = "`pieces` left out: a subdivided mesh has other triangles";
            self.context.warn(&value.at(), message);
            return;
        }
        if let Some(pieces) = table.maybe("pieces", |value| self.pieces(value, parts)) {
            parts.iter_mut().for_each(|part| part.pieces = pieces.clone());
        }
    }

    fn pieces(&self, value: Value<'_>, parts: &[Part]) -> Result<Pieces> {
        let [Part { geometry: Geometry::Mesh(id), .. }] = parts else {
            return Err(value
                .error(format!("`pieces` are those of one mesh, but the file has {}", parts.len()))
                .hint("give them to a file with one mesh, or take them out"));
        };
        let count = self.scene.meshes[id.index()].triangles.len() as u64;
        let piece = |item: Value<'_>| {
            let table = item.table("a piece")?;
            table.allow(&[KEYS]);
            let first = table.need("first", "0", 0, |value| value.integer(0, count.saturating_sub(1)));
            let name = table.maybe("name", |name| Ok(Arc::from(name.text("a name")?)));
            Ok(Piece { first: first as u32, name })
        };
        let expected = "a list of pieces, such as [{ name = \"chair\", first = 0 }]";
        Ok(Pieces::new(value.list(expected)?.map(piece).collect::<Result<_>>()?))
    }
}
