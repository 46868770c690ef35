//! Detection of cycles: a texture or a mix that uses itself, directly or indirectly, is an error, and so is a chain that is
//! too deep.

use std::collections::BTreeMap;

use crate::error::{Error, ErrorKind, Location, Result};

/// The maximum depth of a chain.
const DEEPEST: usize = 16;

/// Items that may be made of others of their kind.
pub(super) trait Made {
    /// The noun for an item in messages.
    const WHAT: &'static str;
    /// The remedy for an item that uses itself.
    const REMEDY: &'static str;
    /// The item's name.
    fn name(&self) -> &str;
    /// The location in the file.
    fn at(&self) -> &Location;
    /// The indices of the items that it is made of.
    fn parts(&self) -> Vec<usize>;
}

/// Checks these items, and all that they are made of.
pub(super) fn check<T: Made>(things: &[T], indices: impl IntoIterator<Item = usize>) -> Vec<Error> {
    let mut search = Search { things, chain: Vec::new(), heights: BTreeMap::new() };
    let mut errors = Vec::new();
    for index in indices {
        if let Err(error) = search.height(index) {
            errors.push(error);
            // Reported once: from here on the items of this chain count as having no parts.
            let chain = search.chain.drain(..).map(|index| (index, 1));
            search.heights.extend(chain);
        }
    }
    errors
}

struct Search<'a, T> {
    things: &'a [T],
    /// From the item that the search began with to the current one.
    chain: Vec<usize>,
    heights: BTreeMap<usize, usize>,
}

impl<T: Made> Search<'_, T> {
    /// The depth of the chains that begin with this item.
    fn height(&mut self, index: usize) -> Result<usize> {
        if let Some(&height) = self.heights.get(&index) {
            return Ok(height);
        }
        let thing = &self.things[index];
        if let Some(start) = self.chain.iter().position(|&other| other == index) {
            let names = self.chain[start..].iter().chain([&index]).map(|&i| self.things[i].name());
            let chain = names.collect::<Vec<_>>().join(" → ");
            let message = format!("{} {:?} uses itself: {chain}", T::WHAT, thing.name());
            return Err(Error::invalid(thing.at(), message).hint(T::REMEDY));
        }
        self.chain.push(index);
        let mut height = 1;
        for part in thing.parts() {
            if self.chain.len() <= DEEPEST {
                height = height.max(1 + self.height(part)?);
            }
        }
        if height > DEEPEST || self.chain.len() > DEEPEST {
            let (what, name) = (T::WHAT, thing.name());
            let message = format!("{what} {name:?} is in a chain of more than {DEEPEST} {what}s");
            return Err(Error::new(ErrorKind::Limit, thing.at(), message)
                .hint(format!("use fewer {what}s in {what}s")));
        }
        self.chain.pop();
        self.heights.insert(index, height);
        Ok(height)
    }
}
