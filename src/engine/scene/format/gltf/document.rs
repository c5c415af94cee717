//! First stage: splits the file into JSON and binary chunk, refuses what is not supported, and validates the JSON.

use std::ops::Range;
use std::path::Path;

use gltf_json::extensions::texture::TextureTransform;
use gltf_json::material::NormalTexture;
use gltf_json::mesh::Semantic;
use gltf_json::validation::{Checked, Error, Validate as _};
use gltf_json::{Path as JsonPath, Root};
use serde::Deserialize;

use super::{Failure, Remarks};
use crate::scene::SceneError;
use crate::scene::load::Load;
use crate::scene::obj::decode::foreign_format;
use crate::{disk, text};

/// First bytes of a binary glTF file.
pub(super) const MAGIC: &[u8] = b"glTF";

/// Extensions that are rendered, or that need no support. A file may require them.
const RENDERED: [&str; 3] = ["KHR_texture_transform", "KHR_lights_punctual", "KHR_mesh_quantization"];

/// Extensions that compress data, each with a description of the data and a remedy.
const COMPRESSIONS: [(&str, &str, &str); 4] = [
    ("KHR_draco_mesh_compression", "its meshes are compressed by", "export it without Draco compression"),
    ("EXT_meshopt_compression", "its buffers are compressed by", "export it without meshopt compression"),
    ("KHR_meshopt_compression", "its buffers are compressed by", "export it without meshopt compression"),
    ("KHR_texture_basisu", "its textures are KTX2 files of", "export it with PNG or JPEG textures"),
];

/// Largest number of components of an accessor, a 4 × 4 matrix.
const MAX_COMPONENTS: usize = 16;

/// Memory of an object of the JSON after parsing, in bytes; the largest ones are materials.
const BYTES_PER_OBJECT: u64 = 1 << 10;

/// Memory of an array element or field of the JSON after parsing, in bytes; fields of extensions are the largest.
const BYTES_PER_VALUE: u64 = 96;

/// JSON of a file, and the bytes of the file with the range of the binary chunk.
pub(super) struct Document {
    /// Validated JSON: all indices are in range.
    pub(super) root: Root,
    file: Vec<u8>,
    bin: Option<Range<usize>>,
}

impl Document {
    /// Returns the binary chunk of a GLB file, or `None` if there is none.
    pub(super) fn bin(&self) -> Option<&[u8]> {
        self.bin.clone().map(|range| &self.file[range])
    }
}

/// Fields that decide whether the file can be read, parsed before all others.
#[derive(Deserialize)]
struct Head {
    asset: AssetVersion,
    #[serde(default, rename = "extensionsRequired")]
    required: Vec<String>,
}

#[derive(Deserialize)]
struct AssetVersion {
    version: String,
}

/// Reads, parses and validates the file.
pub(super) fn read(path: &Path, load: &mut Load<'_>) -> Result<Document, Failure> {
    load.charge(disk::length(path))?;
    let file = disk::read(path, load.memory().bytes())
        .map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
    let (json, bin) = if file.starts_with(MAGIC) { chunks(&file)? } else { (0..file.len(), None) };
    let is_binary = json.start > 0;
    let json = &file[json];
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    if !json.trim_ascii_start().starts_with(b"{") {
        let other = foreign_format(json).unwrap_or_else(|| "this is neither a GLB file nor JSON".to_owned());
        return Err(other.into());
    }
    load.charge(parsed_bytes(json))?;
    let malformed = |error: serde_json::Error| {
        let whole = error.to_string();
        if is_binary {
            return Failure::Unusable(format!("its JSON chunk is malformed: {}", text::message(&whole)));
        }
        let reason = text::message(whole.split(" at line ").next().unwrap_or(&whole));
        SceneError::Line { path: path.to_owned(), line: error.line(), reason }.into()
    };
    let head: Head = serde_json::from_slice(json).map_err(malformed)?;
    refuse_unsupported(&head)?;
    load.advance(0.3)?;
    let root: Root = serde_json::from_slice(json).map_err(malformed)?;
    load.advance(0.6)?;
    validate(&root)?;
    Ok(Document { root, file, bin })
}

/// Returns an upper estimate of the memory of the parsed JSON, in bytes.
fn parsed_bytes(json: &[u8]) -> u64 {
    let count = |wanted: u8| json.iter().filter(|byte| **byte == wanted).count() as u64;
    json.len() as u64 + count(b'{') * BYTES_PER_OBJECT + count(b',') * BYTES_PER_VALUE
}

/// Returns the ranges of the JSON chunk and of the binary chunk of a GLB file.
fn chunks(file: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), String> {
    const HEADER_BYTES: usize = 12;
    let number = |at: usize| {
        let bytes = file.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
        bytes.map(|bytes| u32::from_le_bytes(bytes) as usize).ok_or("the GLB file ends in a header")
    };
    let version = number(4)?;
    if version != 2 {
        return Err(format!("this is a GLB file of version {version}; only version 2 is read"));
    }
    let length = number(8)?;
    if length > file.len() {
        return Err(format!("the GLB file is cut off: it has {} of {length} bytes", file.len()));
    }
    let (mut json, mut bin) = (None, None);
    let mut at = HEADER_BYTES;
    while at < length {
        let (size, kind) = (number(at)?, file.get(at + 4..at + 8).unwrap_or_default());
        let start = at + 8;
        let range = start..start.saturating_add(size);
        if range.end > length {
            return Err(format!("the GLB chunk at byte {at} of {size} bytes reaches beyond the end"));
        }
        match kind {
            b"JSON" if json.is_none() => json = Some(range.clone()),
            b"BIN\0" if bin.is_none() => bin = Some(range.clone()),
            // Readers must ignore other chunks.
            _ => {}
        }
        at = range.end.next_multiple_of(4);
    }
    json.map(|json| (json, bin)).ok_or_else(|| "the GLB file has no JSON chunk".to_owned())
}

/// Refuses versions other than 2, and required extensions that are not rendered.
fn refuse_unsupported(head: &Head) -> Result<(), String> {
    let version = text::message(&head.asset.version);
    if version != "2" && !version.starts_with("2.") {
        return Err(format!("asset.version is {version:?}: only glTF 2.0 is read"));
    }
    let Some(extension) = head.required.iter().find(|required| !RENDERED.contains(&required.as_str())) else {
        return Ok(());
    };
    Err(compression(std::slice::from_ref(extension))
        .unwrap_or_else(|| format!("it requires the extension {}, which is not supported", text::message(extension))))
}

/// Returns the sentence about the first extension of a list that compresses data, if there is one.
fn compression(extensions: &[String]) -> Option<String> {
    let known = |extension: &String| COMPRESSIONS.iter().find(|(name, ..)| name == extension);
    let (name, what, remedy) = extensions.iter().find_map(known)?;
    Some(format!("{what} the extension {name}, which is not supported: {remedy}"))
}

/// Validates the JSON: required fields, valid values, and all indices in range. The error names the first fault.
fn validate(root: &Root) -> Result<(), String> {
    // The validation clones these arrays for every primitive, so they must be short.
    for (index, accessor) in root.accessors.iter().enumerate() {
        let is_long = |bound: &Option<serde_json::Value>| {
            bound.as_ref().and_then(|bound| bound.as_array()).is_some_and(|array| array.len() > MAX_COMPONENTS)
        };
        if is_long(&accessor.min) || is_long(&accessor.max) {
            return Err(format!("accessors[{index}]: min or max has more than {MAX_COMPONENTS} components"));
        }
    }
    // The validation reads this accessor before it checks that it exists.
    for (index, mesh) in root.meshes.iter().enumerate() {
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if let Some(accessor) = position.filter(|accessor| root.get(**accessor).is_none()) {
                let count = root.accessors.len();
                return Err(format!(
                    "meshes[{index}].primitives[{number}].attributes.POSITION: accessor {} of {count}",
                    accessor.value()
                ));
            }
        }
    }
    for (index, material) in root.materials.iter().enumerate() {
        if let Some(Err(error)) = material.normal_texture.as_ref().and_then(transform_of_normals) {
            let place = format!("materials[{index}].normalTexture.extensions.KHR_texture_transform");
            return Err(format!("{place}: {}", text::message(&error.to_string())));
        }
    }
    let mut first: Option<String> = None;
    root.validate(root, JsonPath::new, &mut |path, error| {
        // Required extensions have been checked.
        if first.is_none() && error != Error::Unsupported {
            first = Some(format!("{}: {}", text::message(&path().0), words(error)));
        }
    });
    match first {
        // Without the extension, the data is missing.
        Some(fault) => Err(compression(&root.extensions_used).unwrap_or(fault)),
        None => Ok(()),
    }
}

fn words(error: Error) -> &'static str {
    match error {
        Error::IndexOutOfBounds => "the index refers to nothing",
        Error::Invalid => "the value is invalid",
        Error::Missing => "the value is missing",
        Error::Oversize => "the size is too large",
        Error::Unsupported => "the extension is not supported",
    }
}

/// Warns about parts of the file that are not rendered.
pub(super) fn remark_unrendered(root: &Root, remarks: &mut Remarks<'_>) {
    let is_rendered = |extension: &String| RENDERED.contains(&extension.as_str());
    for extension in root.extensions_used.iter().filter(|extension| !is_rendered(extension)) {
        remarks.warn(format!("the extension {} is not rendered", text::message(extension)));
    }
    if root.scenes.len() > 1 {
        remarks.note(format!("only the default scene of {} is shown", root.scenes.len()));
    }
}

/// Returns the transform of a normal map, or the reason why it is malformed. Returns `None` if it has none.
pub(super) fn transform_of_normals(info: &NormalTexture) -> Option<serde_json::Result<TextureTransform>> {
    // The JSON crate has a type for this extension, but no field for it in normal maps.
    let transform = info.extensions.as_ref()?.others.get("KHR_texture_transform")?;
    Some(TextureTransform::deserialize(transform))
}
