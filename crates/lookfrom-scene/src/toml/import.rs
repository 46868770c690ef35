//! `import`: other scenes and models, merged into this one.

use std::path::{Component, Path, PathBuf};

use super::Reader;
use super::value::Value;
use crate::error::{Error, ErrorKind, Result};
use crate::load;
use crate::scene::MaterialId;

impl Reader<'_, '_> {
    /// Imports one file or a list of them. Unless all can be read, not all names are known.
    pub(super) fn imports(&mut self, value: Value<'_>) {
        let mut import = |value: Value<'_>| {
            if let Err(error) = self.import(value) {
                value.note(error);
                self.knows_all_names = false;
            }
        };
        match value.list("") {
            Ok(items) => items.for_each(import),
            Err(_) => import(value),
        }
    }

    fn import(&mut self, value: Value<'_>) -> Result<()> {
        let path = self.resolve(value, "the name of a file, or a list of names")?;
        let chain = |files: &[PathBuf]| {
            files.iter().chain([&path]).map(|file| file.display().to_string()).collect::<Vec<_>>().join(" → ")
        };
        if let Some(start) = self.open.iter().position(|file| tidy(file) == tidy(&path)) {
            return Err(value
                .error(format!("this file imports itself: {}", chain(&self.open[start..])))
                .hint("take one of these imports out"));
        }
        if self.open.len() as u64 > u64::from(self.context.limits.import_depth) {
            let message = format!(
                "imports nest deeper than the limit of {}: {}",
                self.context.limits.import_depth,
                chain(&self.open)
            );
            return Err(Error { kind: ErrorKind::Limit, ..value.error(message) }
                .hint("import the files from fewer levels"));
        }
        // A file that several others import is merged once.
        if self.done.contains(&tidy(&path)) {
            return Ok(());
        }
        if load::is_toml(&path) {
            return self.import_scene(&path).map_err(|error| value.blame(error));
        }
        let first = self.scene.materials.len();
        let choice = self.context.import.clone();
        let model = self.model(value, &choice)?;
        for (index, material) in self.scene.materials.iter().enumerate().skip(first) {
            self.materials.entry(material.name.clone()).or_insert(MaterialId(index as u32));
        }
        let material = self.default_material();
        self.scene.shapes.extend(load::shapes(model.parts, &value.at(), material));
        self.scene.lights.extend(model.lights);
        self.scene.camera = self.scene.camera.take().or(model.camera);
        self.done.insert(tidy(&path));
        Ok(())
    }

    /// Imports a scene; its camera and settings apply unless there are some already.
    fn import_scene(&mut self, path: &Path) -> Result<()> {
        let camera = self.scene.camera.take();
        let image = self.has_image.then(|| self.scene.image.clone());
        let render = self.has_render.then(|| (self.scene.render.clone(), self.names_integrator));
        let bytes = self.context.read(path)?;
        self.scene_text(path, &bytes)?;
        self.scene.camera = camera.or(self.scene.camera.take());
        self.scene.image = image.unwrap_or_else(|| self.scene.image.clone());
        if let Some(before) = render {
            (self.scene.render, self.names_integrator) = before;
        }
        Ok(())
    }
}

/// A path without `.` and without `x/..`, so that the same file has the same path (apart from links).
pub(super) fn tidy(path: &Path) -> PathBuf {
    let mut tidied = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(tidied.components().next_back(), Some(Component::Normal(_))) => {
                tidied.pop();
            }
            other => tidied.push(other),
        }
    }
    tidied
}
