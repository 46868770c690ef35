//! `[objects]`, groups of shapes, and `[[instance]]`, which places them.

use super::shape::{INSTANCE, kinds};
use super::table::Table;
use super::value::Value;
use super::{Reader, place};
use crate::error::Result;
use crate::scene::{Instance, Object, ObjectId};

impl Reader<'_, '_> {
    /// `[objects]`.
    pub(super) fn read_objects(&mut self, value: Value<'_>) -> Result<()> {
        for entry in value.table("[objects]")?.entries() {
            let table = entry.table(format!("[objects.{}]", entry.key()))?;
            table.allow(&[&kinds()])?;
            if let Some(before) = self.objects.get(entry.key()) {
                return Err(super::twice(entry, "object", &self.scene.objects[before.index()].at));
            }
            self.in_object = true;
            let shapes = self.shapes(&table);
            self.in_object = false;
            let shapes = shapes?;
            if shapes.is_empty() {
                return Err(table
                    .error("it has no shapes")
                    .hint(format!("add one, such as [[objects.{}.sphere]]", entry.key())));
            }
            self.objects.insert(entry.key().to_owned(), ObjectId(self.scene.objects.len() as u32));
            self.scene.objects.push(Object { name: entry.key().to_owned(), at: table.at(), shapes });
        }
        Ok(())
    }

    /// One `[[instance]]`.
    pub(super) fn read_instance(&mut self, table: &Table<'_>) -> Result<()> {
        table.allow(&[INSTANCE, place::KEYS])?;
        let value = table.need("object", "\"the name of an object\"")?;
        let name = value.text("the name of an object")?;
        let object = super::named(&self.objects, "object", value, name)?;
        let material = table.find("material").map(|value| self.material_named(value)).transpose()?;
        if material.is_some_and(|id| self.glows.contains_key(&id)) {
            let message = "the emission of an instance's material is ignored: its shapes keep theirs";
            self.sources.warn(&table.at(), message);
        }
        let world_from_object = place::place(table)?;
        self.scene.instances.push(Instance { at: table.at(), object, world_from_object, material });
        Ok(())
    }
}
