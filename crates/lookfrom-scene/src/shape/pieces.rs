//! Pieces of a shape: runs of its triangles with names of their own, as the objects of an OBJ file are that have one material.

use std::sync::Arc;

/// A run of triangles with one name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Its first triangle; the next piece's is the end.
    pub first: u32,
    /// Its name; without one it is called as the shape is.
    pub name: Option<Arc<str>>,
}

/// The pieces of a shape by their first triangles; none where all of it has one name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pieces(Arc<[Piece]>);

impl Pieces {
    /// Of pieces in any order.
    pub fn new(mut pieces: Vec<Piece>) -> Self {
        pieces.sort_by_key(|piece| piece.first);
        Self(pieces.into())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The pieces by their first triangles.
    pub fn iter(&self) -> impl Iterator<Item = &Piece> {
        self.0.iter()
    }

    /// The name of a triangle, if it has one besides the shape's.
    pub fn name_of(&self, triangle: u32) -> Option<&str> {
        let after = self.0.partition_point(|piece| piece.first <= triangle);
        self.0[..after].last()?.name.as_deref()
    }

    /// The pieces of what is left when triangles are left out: those with these numbers, in order. What lost all of its own is none.
    pub(crate) fn without(&self, gone: &[u32], left: usize) -> Self {
        let moved = self.0.iter().map(|Piece { first, name }| {
            let before = gone.partition_point(|triangle| triangle < first) as u32;
            Piece { first: first - before, name: name.clone() }
        });
        let mut pieces: Vec<Piece> = moved.filter(|piece| (piece.first as usize) < left).collect();
        pieces.dedup_by(|later, earlier| {
            let is_empty = earlier.first == later.first;
            if is_empty {
                std::mem::swap(earlier, later);
            }
            is_empty
        });
        Self(pieces.into())
    }

    /// Bytes of its array.
    pub fn bytes(&self) -> u64 {
        size_of_val(&*self.0) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_have_the_names_of_their_pieces() {
        let piece = |first, name: Option<&str>| Piece { first, name: name.map(Arc::from) };
        let pieces = Pieces::new(vec![piece(7, None), piece(2, Some("chair")), piece(9, Some("lamp"))]);
        let names = [0, 1, 2, 6, 7, 8, 9, u32::MAX].map(|triangle| pieces.name_of(triangle));
        let (chair, lamp) = (Some("chair"), Some("lamp"));
        assert_eq!(names, [None, None, chair, chair, None, None, lamp, lamp]);
        assert_eq!(Pieces::default().name_of(3), None);
        // Of ten triangles, the first of all, all that have no name, and the last.
        let left = pieces.without(&[0, 7, 8, 9], 6);
        assert_eq!(left, Pieces::new(vec![piece(1, Some("chair"))]));
        assert_eq!(
            pieces.without(&[7, 8], 8),
            Pieces::new(vec![piece(2, Some("chair")), piece(7, Some("lamp"))])
        );
    }
}
