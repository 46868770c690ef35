//! Accessors: component types, normalisation, strides and sparse values (specification, §3.6.2).
//!
//! Everything is checked against the buffers and the limits before memory is allocated.

use super::draco::{self, Role};
use super::file::Document;
use super::json::{self, Whole};
use crate::error::{Error, Result};

/// Component types, by the names of OpenGL's constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ComponentType {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl ComponentType {
    fn of(number: Whole) -> Option<Self> {
        Some(match number.0 {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// A component as it is stored in a buffer.
trait Component: Copy {
    /// The value of the first bytes of `bytes`, which has enough.
    fn read(bytes: &[u8]) -> Self;
    /// The value without normalisation.
    fn number(self) -> f32;
    /// The normalised value: 0 … 1 or −1 … 1.
    fn fraction(self) -> f32;
    /// The value as an index.
    fn whole(self) -> u32;
}

macro_rules! components {
    ($($type:ty: $size:literal, $fraction:expr;)*) => {$(
        impl Component for $type {
            fn read(bytes: &[u8]) -> Self {
                let mut own = [0; $size];
                own.copy_from_slice(&bytes[..$size]);
                Self::from_le_bytes(own)
            }
            fn number(self) -> f32 {
                self as f32
            }
            fn fraction(self) -> f32 {
                let fraction: fn(f32) -> f32 = $fraction;
                fraction(self as f32)
            }
            fn whole(self) -> u32 {
                self as u32
            }
        }
    )*};
}

components! {
    i8: 1, |number| (number / 127.0).max(-1.0);
    u8: 1, |number| number / 255.0;
    i16: 2, |number| (number / 32767.0).max(-1.0);
    u16: 2, |number| number / 65535.0;
    u32: 4, |number| number;
    f32: 4, |number| number;
}

/// The target type of a component.
trait Value: Copy + Default {
    fn of<C: Component>(component: C, normalized: bool) -> Self;
}

impl Value for f32 {
    fn of<C: Component>(component: C, normalized: bool) -> Self {
        if normalized { component.fraction() } else { component.number() }
    }
}

impl Value for u32 {
    fn of<C: Component>(component: C, _: bool) -> Self {
        component.whole()
    }
}

/// The number of components of an element of this type, and of one of its columns.
fn shape_of(kind: &str) -> Option<(usize, usize)> {
    Some(match kind {
        "SCALAR" => (1, 1),
        "VEC2" => (2, 2),
        "VEC3" => (3, 3),
        "VEC4" => (4, 4),
        "MAT2" => (4, 2),
        "MAT3" => (9, 3),
        "MAT4" => (16, 4),
        _ => return None,
    })
}

/// The layout of an element's components in its bytes.
#[derive(Clone, Copy)]
struct ElementLayout {
    component: ComponentType,
    normalized: bool,
    /// Components per column.
    rows: usize,
    /// Stride from column to column in bytes: columns of matrices start at multiples of four.
    column: usize,
    /// Size of an element in bytes.
    size: usize,
}

impl ElementLayout {
    fn new(component: ComponentType, normalized: bool, numbers: usize, rows: usize) -> Self {
        let column = match numbers / rows {
            1 => rows * component.size(),
            _ => (rows * component.size()).next_multiple_of(4),
        };
        Self { component, normalized, rows, column, size: column * (numbers / rows) }
    }

    /// The `count` elements that `bytes` hold.
    fn read<V: Value, const N: usize>(&self, bytes: &[u8], stride: usize, count: usize) -> Vec<[V; N]> {
        match self.component {
            ComponentType::I8 => self.gather::<i8, V, N>(bytes, stride, count),
            ComponentType::U8 => self.gather::<u8, V, N>(bytes, stride, count),
            ComponentType::I16 => self.gather::<i16, V, N>(bytes, stride, count),
            ComponentType::U16 => self.gather::<u16, V, N>(bytes, stride, count),
            ComponentType::U32 => self.gather::<u32, V, N>(bytes, stride, count),
            ComponentType::F32 => self.gather::<f32, V, N>(bytes, stride, count),
        }
    }

    fn gather<C: Component, V: Value, const N: usize>(
        &self,
        bytes: &[u8],
        stride: usize,
        count: usize,
    ) -> Vec<[V; N]> {
        let places: [usize; N] =
            std::array::from_fn(|i| i / self.rows * self.column + i % self.rows * self.component.size());
        let element = |element: &[u8]| places.map(|place| V::of(C::read(&element[place..]), self.normalized));
        bytes.chunks(stride).take(count).map(element).collect()
    }
}

impl Document {
    /// The number of components per element of an accessor, and the number of its elements.
    ///
    /// # Errors
    /// If there is no such accessor, or its type is unknown.
    pub(crate) fn shape(&self, index: Whole, asked: &str) -> Result<(usize, usize)> {
        let accessor = self.one_of(&self.root.accessors, index, "accessor", asked)?;
        let (numbers, _) = shape_of(&accessor.kind)
            .ok_or_else(|| self.wrong(index, asked, &format!("has the unknown type {:?}", accessor.kind)))?;
        Ok((numbers, accessor.count.index()))
    }

    /// The vectors of an accessor, matrices as columns one after another, with integers normalised where the accessor says
    /// so. They may be infinite or NaN. `asked` is the JSON pointer of the property that refers to the accessor.
    ///
    /// # Errors
    /// If the accessor has another number of components, if it, its view or its buffer does not exist or is too short, or
    /// if there are too many elements.
    pub(crate) fn vectors<const N: usize>(&self, index: Whole, asked: &str) -> Result<Vec<[f32; N]>> {
        self.elements(index, asked)
    }

    /// As [`Document::vectors`], for unsigned integers: indices of vertices and joints.
    ///
    /// # Errors
    /// As [`Document::vectors`], and if the components are floating-point or signed.
    pub(crate) fn whole_vectors<const N: usize>(&self, index: Whole, asked: &str) -> Result<Vec<[u32; N]>> {
        let accessor = self.one_of(&self.root.accessors, index, "accessor", asked)?;
        match ComponentType::of(accessor.component_type) {
            Some(component) if component.is_unsigned() => self.elements(index, asked),
            _ => {
                let found = accessor.component_type.0;
                Err(self.wrong(
                    index,
                    asked,
                    &format!("has the component type {found}; expected 5121, 5123 or 5125"),
                ))
            }
        }
    }

    /// The values of an accessor of scalars.
    ///
    /// # Errors
    /// As [`Document::vectors`].
    pub(crate) fn scalars(&self, index: Whole, asked: &str) -> Result<Vec<f32>> {
        Ok(self.vectors::<1>(index, asked)?.into_flattened())
    }

    fn wrong(&self, index: Whole, asked: &str, what: &str) -> Error {
        self.invalid(asked, format!("accessor {} {what}", index.0))
            .hint("Khronos' glTF validator shows everything that is wrong with the file")
    }

    fn elements<V: Value, const N: usize>(&self, index: Whole, asked: &str) -> Result<Vec<[V; N]>> {
        let accessor = self.one_of(&self.root.accessors, index, "accessor", asked)?;
        let wrong = |what: String| self.wrong(index, asked, &what);

        // Layout.
        let component = ComponentType::of(accessor.component_type)
            .ok_or_else(|| wrong(format!("has the unknown component type {}", accessor.component_type.0)))?;
        let (numbers, rows) = shape_of(&accessor.kind)
            .ok_or_else(|| wrong(format!("has the unknown type {:?}", accessor.kind)))?;
        if numbers != N {
            return Err(wrong(format!(
                "is {}: {} per element; expected {N}",
                accessor.kind,
                crate::plural::counted(numbers, "number")
            )));
        }
        let layout = ElementLayout::new(component, accessor.normalized.unwrap_or(false), numbers, rows);
        let count = accessor.count.index();
        self.count(count as u64, asked)?;
        let memory = (count as u64).saturating_mul(size_of::<[V; N]>() as u64);
        let what = format!("an accessor of {}", crate::plural::counted(count, "element"));
        let _memory = self.budget.reserve(memory, &what, &self.at(asked))?;

        // A part of a compressed mesh; if it cannot be decompressed, the uncompressed fallback, where there is one.
        if let Some((view, role)) = self.compressed.role(index) {
            match self.unpacked(view, asked) {
                Ok(mesh) => return self.part_of(mesh, role, layout.normalized, asked),
                Err(error) if accessor.buffer_view.is_none() => return Err(error),
                Err(_) => {}
            }
        }

        // Values: zeros without a buffer view.
        let mut elements = match accessor.buffer_view {
            Some(view) => self.gather(layout, view, accessor.byte_offset, count, asked)?,
            None => {
                self.count_zeros(count as u64, asked)?;
                vec![[V::default(); N]; count]
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let replaced = self.sparse_indices(sparse, count, asked)?;
            let values = &sparse.values;
            let values: Vec<[V; N]> =
                self.gather(layout, values.buffer_view, values.byte_offset, replaced.len(), asked)?;
            for (place, value) in replaced.into_iter().zip(values) {
                elements[place as usize] = value;
            }
        }
        Ok(elements)
    }

    /// The values of one attribute of a compressed mesh, for all of its vertices, whatever the accessor's count.
    fn part_of<V: Value, const N: usize>(
        &self,
        mesh: &draco::Decoded,
        role: Role,
        normalized: bool,
        asked: &str,
    ) -> Result<Vec<[V; N]>> {
        let (found, numbers, one) = match role {
            Role::Indices => {
                let index = |&index: &u32| [V::of(index, false); N];
                return Ok(mesh.indices.iter().map(index).collect());
            }
            Role::Attribute(id) => match mesh.attributes.get(&id) {
                Some(attribute) => (attribute.width, &attribute.numbers, attribute.one),
                None => return Err(self.invalid(asked, format!("the compressed mesh has no attribute {id}"))),
            },
        };
        if found != N {
            let message = format!(
                "the compressed mesh has {} per element; expected {N}",
                crate::plural::counted(found, "number")
            );
            return Err(self.invalid(asked, message));
        }
        let one = if normalized { one } else { None };
        let value = |number: f32| V::of(one.map_or(number, |one| (number / one).max(-1.0)), false);
        Ok(numbers.as_chunks::<N>().0.iter().map(|element| element.map(value)).collect())
    }

    /// `count` elements of a buffer view, from `offset` on.
    fn gather<V: Value, const N: usize>(
        &self,
        layout: ElementLayout,
        view: Whole,
        offset: Option<Whole>,
        count: usize,
        asked: &str,
    ) -> Result<Vec<[V; N]>> {
        let found = self.view(view, asked)?;
        let size = layout.size;
        let stride = found.stride.unwrap_or(size);
        if stride < size {
            let message = format!(
                "buffer view {} has an element every {}, but elements have {}",
                view.0,
                crate::plural::counted(stride, "byte"),
                crate::plural::counted(size, "byte")
            );
            return Err(self.invalid(asked, message));
        }
        let start = offset.unwrap_or_default().index();
        let length = match count {
            0 => Some(0),
            _ => stride.checked_mul(count - 1).and_then(|length| length.checked_add(size)),
        };
        let end = length.and_then(|length| start.checked_add(length));
        let bytes = end.and_then(|end| found.bytes.get(start..end)).ok_or_else(|| {
            let message = format!(
                "{} of {}, one every {stride}, from byte {start} on {} beyond the end of buffer view {}, which has {}",
                crate::plural::counted(count, "element"),
                crate::plural::counted(size, "byte"),
                crate::plural::be(count as u64),
                view.0,
                crate::plural::counted(found.bytes.len(), "byte")
            );
            self.invalid(asked, message).hint("the file is cut off or was written wrongly: export it again")
        })?;
        Ok(layout.read(bytes, stride, count))
    }

    /// The indices of the elements that a sparse accessor replaces: all below `count`.
    fn sparse_indices(&self, sparse: &json::Sparse, count: usize, asked: &str) -> Result<Vec<u32>> {
        let component = match ComponentType::of(sparse.indices.component_type) {
            Some(component) if component.is_unsigned() => component,
            _ => {
                let found = sparse.indices.component_type.0;
                let message = format!("the indices of sparse values have the component type {found}");
                return Err(self.invalid(asked, message).hint("5121, 5123 and 5125 are possible"));
            }
        };
        let replaced = sparse.count.index();
        if replaced > count {
            return Err(self.invalid(
                asked,
                format!(
                    "{} for only {}",
                    crate::plural::counted(replaced, "sparse value"),
                    crate::plural::counted(count, "element")
                ),
            ));
        }
        let layout = ElementLayout::new(component, false, 1, 1);
        let indices: Vec<[u32; 1]> =
            self.gather(layout, sparse.indices.buffer_view, sparse.indices.byte_offset, replaced, asked)?;
        let indices = indices.into_flattened();
        match indices.iter().find(|&&index| index as usize >= count) {
            Some(index) => {
                Err(self
                    .invalid(asked, format!("a sparse value replaces element {index}; there are {count}")))
            }
            None => Ok(indices),
        }
    }
}
