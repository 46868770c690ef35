//! Objects as masks and labels tell them apart, by their names: instances, named pieces of shapes, and shapes.
//!
//! All of one name are one object. An instance without a name has that of what it is an instance of, with a number where there are
//! several; what is made for shapes which emit light and move is no instance of its own.

use std::collections::HashMap;

use super::World;
use crate::primitive::Primitives;

/// The objects of a world, by number.
pub struct Objects {
    names: Vec<String>,
    /// By shape: the first primitives of its pieces, beginning with 0, and their objects; nothing for those that are met only in named
    /// instances.
    shapes: Vec<Vec<(u32, u32)>>,
    /// By instance; `None` for those that are no instances of the scene.
    instances: Vec<Option<u32>>,
}

impl Objects {
    /// The names of the objects, each once.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The number of the object that a primitive belongs to, by the number of its shape, its own within that, and its instance's if it
    /// is in one.
    ///
    /// # Panics
    /// If the world has no such shape or instance.
    pub fn of(&self, shape: u32, primitive: u32, instance: Option<u32>) -> u32 {
        if let Some(object) = instance.and_then(|instance| self.instances[instance as usize]) {
            return object;
        }
        let pieces = &self.shapes[shape as usize];
        let after = pieces.partition_point(|(first, _)| *first <= primitive);
        pieces[after - 1].1
    }
}

impl World {
    /// The objects of the scene, for masks and labels.
    pub fn objects(&self) -> Objects {
        let mut names = Vec::new();
        let mut numbers: HashMap<String, u32> = HashMap::new();
        let mut number = |name: &str| match numbers.get(name) {
            Some(number) => *number,
            None => {
                let number = names.len() as u32;
                names.push(name.to_owned());
                numbers.insert(name.to_owned(), number);
                number
            }
        };
        let instances: Vec<_> = self.instance_names().collect();
        let is_met = self.are_met_alone(&instances);
        let shapes = self.names.shapes.iter().zip(is_met).map(|(label, is_met)| {
            if !is_met {
                return Vec::new();
            }
            let starts_unnamed = label.pieces.iter().next().is_none_or(|piece| piece.first > 0);
            let unnamed = starts_unnamed.then_some((0, &*label.name));
            let pieces =
                label.pieces.iter().map(|piece| (piece.first, piece.name.as_deref().unwrap_or(&label.name)));
            unnamed.into_iter().chain(pieces).map(|(first, name)| (first, number(name))).collect()
        });
        let shapes = shapes.collect();
        let instances = instances.into_iter().map(|name| name.map(|name| number(&name))).collect();
        Objects { names, shapes, instances }
    }

    /// By shape: whether it is met outside of named instances.
    fn are_met_alone(&self, instance_names: &[Option<String>]) -> Vec<bool> {
        let nameless = self.instances.iter().zip(instance_names).filter(|(_, name)| name.is_none());
        let in_nameless = nameless.flat_map(|(instance, _)| &self.objects[instance.object as usize]);
        let mut are_met = vec![false; self.names.shapes.len()];
        for shape in self.primitives.iter().chain(in_nameless).flat_map(Primitives::shapes) {
            are_met[shape as usize] = true;
        }
        are_met
    }

    /// The names of instances.
    fn instance_names(&self) -> impl Iterator<Item = Option<String>> {
        let names = &self.names;
        let mut counts = vec![0_u32; names.objects.len()];
        for instance in &*self.instances {
            counts.get_mut(instance.object as usize).into_iter().for_each(|count| *count += 1);
        }
        let mut numbers = vec![0_u32; names.objects.len()];
        self.instances.iter().enumerate().map(move |(index, instance)| {
            let object = instance.object as usize;
            let name = names.objects.get(object)?;
            numbers[object] += 1;
            let own = names.instances.get(index).and_then(Option::as_ref);
            Some(match (own, counts[object]) {
                (Some(own), _) => own.to_string(),
                (None, 1) if !name.is_empty() => name.clone(),
                (None, _) if name.is_empty() => format!("object {} {}", object + 1, numbers[object]),
                (None, _) => format!("{name} {}", numbers[object]),
            })
        })
    }
}
