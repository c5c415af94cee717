//! Buffers: the binary chunk of a GLB file, embedded data, and files beside the model.

use std::borrow::Cow;
use std::path::Path;

use gltf_json::{Index, Root, buffer};

use super::Failure;
use super::document::Document;
use super::uris::{self, Target};
use crate::disk;
use crate::scene::load::Load;

/// Bytes of each buffer, at least as long as the file declares.
pub(super) type Buffers<'a> = Vec<Cow<'a, [u8]>>;

/// Reads all buffers of a file.
pub(super) fn read<'a>(path: &Path, document: &'a Document, load: &mut Load<'_>) -> Result<Buffers<'a>, Failure> {
    let mut buffers = Vec::new();
    for (index, buffer) in document.root.buffers.iter().enumerate() {
        load.advance(1.0)?;
        let named = |reason: String| format!("buffers[{index}]: {reason}");
        let bytes = match (&buffer.uri, document.bin()) {
            (Some(uri), _) => Cow::Owned(external(uri, path, load).map_err(named)?),
            (None, Some(bin)) if index == 0 => Cow::Borrowed(bin),
            (None, _) => return Err(named("it has no `uri`, and there is no binary chunk for it".to_owned()).into()),
        };
        let declared = buffer.byte_length.0;
        if (bytes.len() as u64) < declared {
            return Err(named(format!("it has {} of {declared} bytes", bytes.len())).into());
        }
        load.push(&mut buffers, bytes)?;
    }
    Ok(buffers)
}

/// Reads the data that a URI describes, within the memory limit.
fn external(uri: &str, model: &Path, load: &mut Load<'_>) -> Result<Vec<u8>, String> {
    match uris::target(uri, model)? {
        Target::Embedded(data) => {
            load.charge(data.max_length())?;
            data.decode()
        }
        Target::File(path) => {
            load.charge(disk::length(&path))?;
            disk::read(&path, load.memory().bytes())
                .map_err(|error| format!("cannot read {}: {error}", crate::text::path(&path)))
        }
    }
}

/// Returns the bytes of a buffer view. The error names the view.
pub(super) fn view<'a>(
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    index: Index<buffer::View>,
) -> Result<(&'a [u8], &'a buffer::View), String> {
    let number = index.value();
    let missing = || format!("bufferViews[{number}]: the index refers to nothing");
    let view = root.get(index).ok_or_else(missing)?;
    let buffer = buffers.get(view.buffer.value()).ok_or_else(missing)?;
    let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
    let within = usize::try_from(offset).ok().zip(usize::try_from(offset.saturating_add(length)).ok());
    let bytes = within.and_then(|(start, end)| buffer.get(start..end)).ok_or_else(|| {
        format!(
            "bufferViews[{number}]: {length} bytes from byte {offset} reach beyond the {} bytes of its buffer",
            buffer.len()
        )
    })?;
    Ok((bytes, view))
}
