//! Reads accessors: typed columns inside buffers.
//!
//! **Invariants.** Component type, dimensions, count, byte range, stride and sparse indices are
//! checked before the first element is read, and nothing is allocated beyond the bytes that are
//! there. An accessor without a buffer view (all zeros, changed by sparse values) has no bytes to
//! hold it; its count is limited to the number of bytes in all buffers. Many accessors can name
//! the same bytes, so all that is read together is limited to [`BASE_LIMIT`] bytes plus
//! [`RATIO_LIMIT`] times the buffers; real files come to about twice.

use std::cell::Cell;
use std::path::Path;

use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Root, buffer::View, root::Index};

use super::buffers;
use crate::ImportError;

/// Types of numbers that stand for themselves.
pub(super) const FLOAT: &[ComponentType] = &[ComponentType::F32];
/// Types of numbers between 0 and 1.
pub(super) const UNIT: &[ComponentType] =
    &[ComponentType::F32, ComponentType::U8, ComponentType::U16];
/// Types of numbers between -1 and 1.
pub(super) const SIGNED_UNIT: &[ComponentType] = &[
    ComponentType::F32,
    ComponentType::I8,
    ComponentType::U8,
    ComponentType::I16,
    ComponentType::U16,
];
/// Types of positions in lists.
pub(super) const INDEX: &[ComponentType] =
    &[ComponentType::U8, ComponentType::U16, ComponentType::U32];

/// Found and expected.
pub(super) type Fault = (String, String);

/// An element of an accessor and its position.
type Placed<'a> = (usize, &'a [u8]);

/// Bytes that any document may ask for: 64 MiB.
const BASE_LIMIT: u64 = 64 << 20;
/// Bytes that a document may ask for, for each byte of its buffers.
const RATIO_LIMIT: u64 = 16;

/// All accessors of a document.
#[derive(Debug)]
pub(super) struct Accessors<'a> {
    pub(super) root: &'a Root,
    pub(super) buffers: &'a [Vec<u8>],
    pub(super) file: &'a Path,
    /// Bytes that may still be asked for.
    left: Cell<u64>,
}

/// What an accessor is read for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Purpose<'a> {
    /// The part of the file that names the accessor.
    pub(super) element: &'a str,
    /// Component types that may be there.
    pub(super) components: &'a [ComponentType],
    /// How many elements must be there, where that is known.
    pub(super) count: Option<usize>,
}

/// A checked run of elements in a buffer.
struct Run<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Run<'a> {
    fn elements(&self, count: usize) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..count).map(move |idx| &bytes[idx * stride..][..size])
    }
}

impl<'a> Accessors<'a> {
    /// The accessors of a document with its buffers.
    pub(super) fn new(root: &'a Root, buffers: &'a [Vec<u8>], file: &'a Path) -> Self {
        let held: usize = buffers.iter().map(Vec::len).sum();
        let left = Cell::new(BASE_LIMIT + RATIO_LIMIT * held as u64);
        Self { root, buffers, file, left }
    }

    /// Takes memory for `count` values of type `T` from what the document may ask for.
    pub(super) fn charge<T>(&self, count: usize) -> Result<(), Fault> {
        let size = (count as u64).saturating_mul(size_of::<T>() as u64);
        let left = self.left.get().checked_sub(size).ok_or_else(|| {
            let found = format!("{size} more bytes of elements");
            (found, "buffers that are not used over and over".to_owned())
        })?;
        self.left.set(left);
        Ok(())
    }

    /// Elements of `N` numbers; integers are normalised to -1..1 or 0..1.
    pub(super) fn floats<const N: usize>(
        &self,
        accessor: Index<Accessor>,
        purpose: Purpose<'_>,
    ) -> Result<Vec<[f32; N]>, ImportError> {
        self.read(accessor, purpose, to_float)
    }

    /// Elements of `N` positions in lists.
    pub(super) fn integers<const N: usize>(
        &self,
        accessor: Index<Accessor>,
        purpose: Purpose<'_>,
    ) -> Result<Vec<[u32; N]>, ImportError> {
        self.read(accessor, purpose, to_integer)
    }

    fn read<T: Copy + Default, const N: usize>(
        &self,
        idx: Index<Accessor>,
        purpose: Purpose<'_>,
        decode: fn(ComponentType, &[u8]) -> T,
    ) -> Result<Vec<[T; N]>, ImportError> {
        self.try_read(idx, purpose, decode).map_err(|(found, expected)| {
            let element = format!("{} accessor {}", purpose.element, idx.value());
            ImportError::invalid(self.file, element, found, expected)
        })
    }

    fn try_read<T: Copy + Default, const N: usize>(
        &self,
        idx: Index<Accessor>,
        purpose: Purpose<'_>,
        decode: fn(ComponentType, &[u8]) -> T,
    ) -> Result<Vec<[T; N]>, Fault> {
        let accessor = self.root.accessors.get(idx.value()).ok_or_else(|| {
            let expected = format!("one of {} accessors", self.root.accessors.len());
            ("an index out of range".to_owned(), expected)
        })?;
        let component = check_type::<N>(accessor, purpose)?;
        let count = check_count(accessor, purpose)?;
        let size = component.size() * N;
        let decode_all = |bytes: &[u8]| {
            let mut values = [T::default(); N];
            for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(component.size())) {
                *value = decode(component, bytes);
            }
            values
        };

        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                let run = self.run(view, offset, count, size)?;
                self.charge::<[T; N]>(count)?;
                run.elements(count).map(decode_all).collect()
            }
            None => {
                self.check_zeros(count)?;
                self.charge::<[T; N]>(count)?;
                vec![[T::default(); N]; count]
            }
        };
        for (idx, bytes) in self.sparse(accessor, count, size)? {
            elements[idx] = decode_all(bytes);
        }
        Ok(elements)
    }

    /// The checked place of `count` elements of `size` bytes.
    fn run(
        &self,
        view: Index<View>,
        offset: u64,
        count: usize,
        size: usize,
    ) -> Result<Run<'a>, Fault> {
        let bytes = buffers::view(self.root, self.buffers, view)
            .map_err(|found| (found, "a buffer view inside its buffer".to_owned()))?;
        let stride = self.root.buffer_views[view.value()].byte_stride.map_or(0, |stride| stride.0);
        let stride = if stride == 0 { size } else { stride };
        if stride < size {
            return Err((format!("a stride of {stride} bytes"), format!("at least {size}")));
        }
        let place = || {
            let offset = usize::try_from(offset).ok()?;
            let last = stride.checked_mul(count.saturating_sub(1))?;
            let end = last.checked_add(if count == 0 { 0 } else { size })?.checked_add(offset)?;
            bytes.get(offset..end)
        };
        let bytes = place().ok_or_else(|| {
            let found = format!("{count} elements of {size} bytes, {stride} apart, from {offset}");
            (found, format!("room for them in the {} bytes of the buffer view", bytes.len()))
        })?;
        Ok(Run { bytes, stride, size })
    }

    /// Limits accessors that no bytes stand behind.
    fn check_zeros(&self, count: usize) -> Result<(), Fault> {
        let limit: usize = self.buffers.iter().map(Vec::len).sum();
        if count <= limit {
            return Ok(());
        }
        let found = format!("{count} elements without a buffer view");
        Err((found, format!("at most {limit}, the bytes in all buffers")))
    }

    /// The elements that sparse storage replaces, with their positions.
    fn sparse(
        &self,
        accessor: &Accessor,
        count: usize,
        size: usize,
    ) -> Result<Vec<Placed<'a>>, Fault> {
        let Some(sparse) = &accessor.sparse else { return Ok(Vec::new()) };
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(("unknown sparse indices".to_owned(), "unsigned integers".to_owned()));
        };
        let sparse_count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        let (indices, values) = (&sparse.indices, &sparse.values);
        let component = component.0;
        let index_run =
            self.run(indices.buffer_view, indices.byte_offset.0, sparse_count, component.size())?;
        let value_run = self.run(values.buffer_view, values.byte_offset.0, sparse_count, size)?;
        let positions = index_run.elements(sparse_count);
        self.charge::<Placed<'_>>(sparse_count)?;
        let mut replaced = Vec::with_capacity(sparse_count);
        for (position, value) in positions.zip(value_run.elements(sparse_count)) {
            let position = to_integer(component, position) as usize;
            if position >= count {
                let found = format!("a sparse index of {position}");
                return Err((found, format!("less than the count of {count}")));
            }
            replaced.push((position, value));
        }
        Ok(replaced)
    }
}

fn check_type<const N: usize>(
    accessor: &Accessor,
    purpose: Purpose<'_>,
) -> Result<ComponentType, Fault> {
    let expected = match N {
        1 => Type::Scalar,
        2 => Type::Vec2,
        3 => Type::Vec3,
        4 => Type::Vec4,
        16 => Type::Mat4,
        _ => unreachable!("no purpose asks for elements of {N} numbers"),
    };
    let (Checked::Valid(found), Checked::Valid(component)) =
        (accessor.type_, accessor.component_type)
    else {
        return Err(("an unknown type".to_owned(), format!("{expected:?}")));
    };
    if found != expected || !purpose.components.contains(&component.0) {
        let found = format!("{found:?} of {:?}", component.0);
        return Err((found, format!("{expected:?} of {:?}", purpose.components)));
    }
    Ok(component.0)
}

fn check_count(accessor: &Accessor, purpose: Purpose<'_>) -> Result<usize, Fault> {
    let found = usize::try_from(accessor.count.0).unwrap_or(usize::MAX);
    match purpose.count {
        Some(expected) if expected != found => {
            Err((format!("a count of {found}"), format!("a count of {expected}")))
        }
        _ => Ok(found),
    }
}

/// A number from its bytes; integers are normalised (glTF 2.0, section 3.11).
fn to_float(component: ComponentType, bytes: &[u8]) -> f32 {
    match (component, bytes) {
        (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
        (ComponentType::U8, &[a]) => f32::from(a) / 255.0,
        (ComponentType::I8, &[a]) => (f32::from(a as i8) / 127.0).max(-1.0),
        (ComponentType::U16, &[a, b]) => f32::from(u16::from_le_bytes([a, b])) / 65_535.0,
        (ComponentType::I16, &[a, b]) => {
            (f32::from(i16::from_le_bytes([a, b])) / 32_767.0).max(-1.0)
        }
        _ => unreachable!("the component type was checked, and its bytes are as many as it has"),
    }
}

fn to_integer(component: ComponentType, bytes: &[u8]) -> u32 {
    match (component, bytes) {
        (ComponentType::U8, &[a]) => u32::from(a),
        (ComponentType::U16, &[a, b]) => u32::from(u16::from_le_bytes([a, b])),
        (ComponentType::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
        _ => unreachable!("the component type was checked, and its bytes are as many as it has"),
    }
}
