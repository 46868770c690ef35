//! A decoded picture.

/// A picture of linear colours, row 0 on top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// The file it came from.
    pub name: String,
    /// Columns: > 0.
    pub width: u32,
    /// Rows: > 0.
    pub height: u32,
    /// `width * height` linear Rec. 709 colours, row by row.
    pub texels: Vec<[f32; 3]>,
}
