//! Accessors: typed elements in buffer views, with sparse replacements. Every bound is checked before an element is read.

use std::collections::HashSet;

use gltf_json::accessor::{self, ComponentType, Type};
use gltf_json::{Index, Root, buffer};

use super::buffers::{self, Buffers};
use super::valid;

/// Number of elements that an accessor without data may have, however small the file is.
const MIN_ZEROS: u64 = 1 << 16;

/// Accessors of a file.
pub(super) struct Accessors<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    /// Accessors whose sparse indices are known to be in ascending order and in range.
    checked: HashSet<usize>,
}

/// Elements of an accessor. All of them can be read without errors.
pub(super) struct Elements<'a> {
    count: usize,
    components: usize,
    component: Component,
    /// Elements in a buffer view; `None` if all of them are zero.
    base: Option<Strided<'a>>,
    /// Replaced elements: their indices in ascending order, and their values.
    sparse: Option<(SparseIndices<'a>, Strided<'a>)>,
}

/// Type of the components of an element.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Component {
    kind: ComponentType,
    /// Whether integers denote fractions of their largest value.
    normalized: bool,
}

/// Elements at equal distances.
#[derive(Clone, Copy)]
struct Strided<'a> {
    bytes: &'a [u8],
    /// Distance between elements, in bytes.
    stride: usize,
    /// Size of an element, in bytes.
    size: usize,
}

#[derive(Clone, Copy)]
struct SparseIndices<'a> {
    places: Strided<'a>,
    kind: ComponentType,
    count: usize,
}

impl<'a> Strided<'a> {
    fn at(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..][..self.size]
    }
}

impl SparseIndices<'_> {
    fn at(&self, index: usize) -> u32 {
        integer(self.kind, self.places.at(index))
    }

    /// Returns the place of an element among the replaced ones, or `None` if it is not replaced.
    fn find(&self, element: usize) -> Option<usize> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            match (self.at(middle) as usize).cmp(&element) {
                std::cmp::Ordering::Equal => return Some(middle),
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
    }
}

impl<'a> Accessors<'a> {
    /// Creates the accessors of a file.
    pub(super) fn new(root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        Self { root, buffers, checked: HashSet::new() }
    }

    /// Returns the elements of an accessor, whose type must be one of `types`. The error names the accessor.
    pub(super) fn get(&mut self, index: Index<accessor::Accessor>, types: &[Type]) -> Result<Elements<'a>, String> {
        self.elements(index, types).map_err(|reason| format!("accessors[{}]: {reason}", index.value()))
    }

    fn elements(&mut self, index: Index<accessor::Accessor>, types: &[Type]) -> Result<Elements<'a>, String> {
        let accessor = self.root.get(index).ok_or("the index refers to nothing")?;
        let kind = valid(accessor.component_type).ok_or("its component type is invalid")?.0;
        let type_ = valid(accessor.type_).filter(|type_| types.contains(type_));
        let components = type_.ok_or_else(|| format!("its type must be {}", names(types)))?.multiplicity();
        let count = usize::try_from(accessor.count.0).ok().filter(|count| *count < u32::MAX as usize);
        let count = count.ok_or("it has too many elements: indices have 32 bits")?;
        let size = components * kind.size();
        let base = match accessor.buffer_view {
            Some(view) => Some(self.strided(view, accessor.byte_offset.unwrap_or_default().0, count, size)?),
            None => {
                let bytes: u64 = self.buffers.iter().map(|buffer| buffer.len() as u64).sum();
                if count as u64 > bytes.max(MIN_ZEROS) {
                    return Err(format!("it has {count} elements, but no data"));
                }
                None
            }
        };
        let sparse = match &accessor.sparse {
            Some(sparse) => {
                let kind = valid(sparse.indices.component_type).ok_or("the type of its sparse indices is invalid")?.0;
                let replaced = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
                let offset = sparse.indices.byte_offset.0;
                let places = self.strided(sparse.indices.buffer_view, offset, replaced, kind.size())?;
                let values = self.strided(sparse.values.buffer_view, sparse.values.byte_offset.0, replaced, size)?;
                let indices = SparseIndices { places, kind, count: replaced };
                if self.checked.insert(index.value()) {
                    check_ascending(&indices, count)?;
                }
                Some((indices, values))
            }
            None => None,
        };
        let component = Component { kind, normalized: accessor.normalized };
        Ok(Elements { count, components, component, base, sparse })
    }

    /// Returns `count` elements of `size` bytes in a buffer view, from byte `offset` on.
    fn strided(
        &self,
        view: Index<buffer::View>,
        offset: u64,
        count: usize,
        size: usize,
    ) -> Result<Strided<'a>, String> {
        let (bytes, view) = buffers::view(self.root, self.buffers, view)?;
        let stride = view.byte_stride.map_or(size, |stride| stride.0);
        if stride < size {
            return Err(format!("its stride of {stride} bytes is less than its elements of {size} bytes"));
        }
        let steps = (count as u64).saturating_sub(1).saturating_mul(stride as u64);
        let needed = if count == 0 { 0 } else { steps.saturating_add(size as u64) };
        if offset.saturating_add(needed) > bytes.len() as u64 {
            return Err(format!(
                "{count} elements from byte {offset} reach beyond the {} bytes of its buffer view",
                bytes.len()
            ));
        }
        Ok(Strided { bytes: &bytes[offset as usize..], stride, size })
    }
}

fn check_ascending(indices: &SparseIndices<'_>, count: usize) -> Result<(), String> {
    let mut least = 0_u64;
    for place in 0..indices.count {
        let index = indices.at(place);
        if u64::from(index) < least || index as usize >= count {
            return Err(format!("its sparse index {index} is out of order or not below {count}"));
        }
        least = u64::from(index) + 1;
    }
    Ok(())
}

fn names(types: &[Type]) -> String {
    let name = |type_: &Type| match type_ {
        Type::Scalar => "SCALAR",
        Type::Vec2 => "VEC2",
        Type::Vec3 => "VEC3",
        Type::Vec4 => "VEC4",
        Type::Mat2 => "MAT2",
        Type::Mat3 => "MAT3",
        Type::Mat4 => "MAT4",
    };
    types.iter().map(name).collect::<Vec<_>>().join(" or ")
}

impl Elements<'_> {
    /// Returns the number of elements.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Returns the number of components of each element.
    pub(super) fn components(&self) -> usize {
        self.components
    }

    /// Returns whether the components are unsigned integers, as those of indices must be.
    pub(super) fn are_unsigned(&self) -> bool {
        matches!(self.component.kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
    }

    /// Returns an element as an unsigned integer. Call it only if [`Elements::are_unsigned`].
    pub(super) fn integer(&self, index: usize) -> u32 {
        self.bytes(index).map_or(0, |bytes| integer(self.component.kind, bytes))
    }

    /// Returns the first `N` components of an element as floats. Components that it does not have are 0.
    pub(super) fn vector<const N: usize>(&self, index: usize) -> [f32; N] {
        let Some(bytes) = self.bytes(index) else { return [0.0; N] };
        let mut components = bytes.chunks_exact(self.component.kind.size());
        [(); N].map(|()| components.next().map_or(0.0, |bytes| self.component.float(bytes)))
    }

    fn bytes(&self, index: usize) -> Option<&[u8]> {
        if let Some((indices, values)) = &self.sparse
            && let Some(place) = indices.find(index)
        {
            return Some(values.at(place));
        }
        self.base.map(|base| base.at(index))
    }
}

impl Component {
    fn float(self, bytes: &[u8]) -> f32 {
        let signed = |number: f32, most: f32| if self.normalized { (number / most).max(-1.0) } else { number };
        match (self.kind, bytes) {
            (ComponentType::I8, [byte, ..]) => signed(f32::from(*byte as i8), 127.0),
            (ComponentType::U8, [byte, ..]) => signed(f32::from(*byte), 255.0),
            (ComponentType::I16, [a, b, ..]) => signed(f32::from(i16::from_le_bytes([*a, *b])), 32_767.0),
            (ComponentType::U16, [a, b, ..]) => signed(f32::from(u16::from_le_bytes([*a, *b])), 65_535.0),
            (ComponentType::U32, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
            (ComponentType::F32, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
            _ => 0.0,
        }
    }
}

/// Returns the unsigned integer in `bytes`; 0 for other types.
fn integer(kind: ComponentType, bytes: &[u8]) -> u32 {
    match (kind, bytes) {
        (ComponentType::U8, [byte, ..]) => u32::from(*byte),
        (ComponentType::U16, [a, b, ..]) => u32::from(u16::from_le_bytes([*a, *b])),
        (ComponentType::U32, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]),
        _ => 0,
    }
}
