//! `[objects]`, groups of shapes, and `[[instance]]`, which places them.

use std::sync::Arc;

use super::shape::{INSTANCE, kinds};
use super::table::Table;
use super::value::Value;
use super::{Reader, light, transform};
use crate::scene::{Instance, Object, ObjectId};
use crate::shape::Shape;

impl Reader<'_, '_> {
    /// Reads `[objects]`.
    pub(super) fn read_objects(&mut self, value: Value<'_>) {
        self.knows_all_names &= value.is_table();
        for entry in value.named("[objects]") {
            if let Some(before) = self.objects.get(entry.key()) {
                entry.note(super::twice(entry, "object", &self.scene.objects[before.index()].at));
                continue;
            }
            let errors = entry.document.count();
            let table = entry.table(format!("[objects.{}]", entry.key()));
            let shapes = match entry.noting(table.map(Some), None) {
                Some(table) => self.object_shapes(&table),
                None => Vec::new(),
            };
            if shapes.is_empty() && entry.document.count() == errors {
                let error = entry.error(format!("[objects.{}]: it has no shapes", entry.key()));
                entry.note(error.hint(format!("add one, such as [[objects.{}.sphere]]", entry.key())));
            }
            self.objects.insert(entry.key().to_owned(), ObjectId(self.scene.objects.len() as u32));
            self.scene.objects.push(Object { name: entry.key().to_owned(), at: entry.at(), shapes });
        }
    }

    fn object_shapes(&mut self, table: &Table<'_>) -> Vec<Shape> {
        table.allow(&[&kinds()]);
        self.in_object = true;
        let shapes = self.shapes(table);
        self.in_object = false;
        shapes
    }

    /// Reads one `[[instance]]`.
    pub(super) fn read_instance(&mut self, table: &Table<'_>) {
        table.allow(&[INSTANCE, transform::KEYS]);
        let object = table.need("object", "\"the name of an object\"", None, |value| {
            let name = value.text("the name of an object")?;
            self.named(&self.objects, "object", value, name).map(Some)
        });
        let material = table.maybe("material", |value| self.material_named(value));
        if material.is_some_and(|id| self.glows.contains_key(&id)) {
            let message = "the emission of an instance's material is ignored: its shapes keep theirs";
            self.context.warn(&table.at(), message);
        }
        let name = light::name(table);
        let world_from_object = transform::world_from_object(table);
        if let Some(object) = object {
            self.scene.instances.push(Instance {
                name: name.map(Arc::new),
                at: table.at(),
                object,
                world_from_object,
                material,
                motion: table.maybe("motion", transform::motion),
            });
        }
    }
}
