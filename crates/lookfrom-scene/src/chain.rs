//! Graphs of textures and of mixed materials: one that uses itself, directly or indirectly, is an error, and so are a chain that is
//! too deep and mixed materials that are too many where every use counts. Of textures every use is counted once, since each is
//! evaluated once per point.

use std::collections::BTreeMap;

use crate::error::{Error, ErrorKind, Location, Result};
use crate::material::{Color, Material, MaterialKind};
use crate::scene::MaterialId;
use crate::texture::Texture;

/// The maximum depth of a chain.
const DEEPEST: usize = 16;

/// Items that may be made of others of their kind.
pub(crate) trait Made {
    /// The noun for an item in messages.
    const WHAT: &'static str;
    /// The remedy for an item that uses itself.
    const REMEDY: &'static str;
    /// The largest number of items that one may stand for, each as often as it is used.
    const LARGEST: usize;
    /// The item's name.
    fn name(&self) -> &str;
    /// The location in the file.
    fn at(&self) -> &Location;
    /// The indices of the items that it is made of, as often as each is used.
    fn parts(&self) -> Vec<usize>;
}

impl Made for Texture {
    const WHAT: &'static str = "texture";
    const REMEDY: &'static str = "give one of them a plain colour";
    const LARGEST: usize = usize::MAX;
    fn name(&self) -> &str {
        &self.name
    }
    fn at(&self) -> &Location {
        &self.at
    }
    fn parts(&self) -> Vec<usize> {
        let index = |color: Color| if let Color::Texture(id) = color { Some(id.index()) } else { None };
        self.kind.parts().into_iter().filter_map(index).collect()
    }
}

impl Made for Material {
    const WHAT: &'static str = "material";
    const REMEDY: &'static str = "let one of them mix other materials";
    const LARGEST: usize = 4096;
    fn name(&self) -> &str {
        &self.name
    }
    fn at(&self) -> &Location {
        &self.at
    }
    fn parts(&self) -> Vec<usize> {
        match self.kind {
            MaterialKind::Mix { materials, .. } => materials.map(MaterialId::index).to_vec(),
            _ => Vec::new(),
        }
    }
}

/// Checks these items, and all that they are made of.
pub(crate) fn check<T: Made>(things: &[T], indices: impl IntoIterator<Item = usize>) -> Vec<Error> {
    let mut search = Search { things, chain: Vec::new(), extents: BTreeMap::new() };
    let mut errors = Vec::new();
    for index in indices {
        if let Err(error) = search.extent(index) {
            errors.push(error);
            // Reported once: from here on the items of this chain count as having no parts.
            let chain = search.chain.drain(..).map(|index| (index, Extent::ONE));
            search.extents.extend(chain);
        }
    }
    errors
}

/// The extent of the graph that begins with an item.
#[derive(Clone, Copy)]
struct Extent {
    /// The depth of the longest chain.
    height: usize,
    /// The number of items, each as often as it is used.
    size: usize,
}

impl Extent {
    /// The extent of an item without parts.
    const ONE: Self = Self { height: 1, size: 1 };
}

struct Search<'a, T> {
    things: &'a [T],
    /// From the item that the search began with to the current one.
    chain: Vec<usize>,
    extents: BTreeMap<usize, Extent>,
}

impl<T: Made> Search<'_, T> {
    fn extent(&mut self, index: usize) -> Result<Extent> {
        if let Some(&extent) = self.extents.get(&index) {
            return Ok(extent);
        }
        let thing = &self.things[index];
        if let Some(start) = self.chain.iter().position(|&other| other == index) {
            let names = self.chain[start..].iter().chain([&index]).map(|&i| self.things[i].name());
            let chain = names.collect::<Vec<_>>().join(" → ");
            let message = format!("{} {:?} uses itself: {chain}", T::WHAT, thing.name());
            return Err(Error::invalid(thing.at(), message).hint(T::REMEDY));
        }
        self.chain.push(index);
        let mut extent = Extent::ONE;
        for part in thing.parts() {
            if self.chain.len() <= DEEPEST {
                let Extent { height, size } = self.extent(part)?;
                extent.height = extent.height.max(1 + height);
                extent.size = extent.size.saturating_add(size);
            }
        }
        let (what, name) = (T::WHAT, thing.name());
        let fault = if extent.height > DEEPEST || self.chain.len() > DEEPEST {
            format!("{what} {name:?} is in a chain of more than {DEEPEST} {what}s")
        } else if extent.size > T::LARGEST {
            format!(
                "{what} {name:?} is made of {} {what}s, more than {}, as often as each is used",
                extent.size,
                T::LARGEST
            )
        } else {
            self.chain.pop();
            self.extents.insert(index, extent);
            return Ok(extent);
        };
        Err(Error::new(ErrorKind::Limit, thing.at(), fault).hint(format!("use fewer {what}s in {what}s")))
    }
}
