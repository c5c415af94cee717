//! Builder of small glTF files for tests: JSON with accessors whose data is collected in one buffer.

use std::path::{Path, PathBuf};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// Positions of a unit square in the plane z = 0, counter-clockwise from the lower left corner.
pub(crate) const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];

/// Texture coordinates of [`SQUARE`], with the texture upright: v = 0 at the top.
pub(crate) const SQUARE_UVS: [f32; 8] = [0., 1., 1., 1., 1., 0., 0., 0.];

/// Indices of the two triangles of [`SQUARE`].
pub(crate) const SQUARE_INDICES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// glTF file under construction.
pub(crate) struct GltfBuilder {
    /// JSON of the file, without its buffer.
    pub(crate) json: Value,
    bytes: Vec<u8>,
}

impl GltfBuilder {
    /// Creates a file without meshes.
    pub(crate) fn empty() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [], "accessors": [], "bufferViews": [],
        });
        Self { json, bytes: Vec::new() }
    }

    /// Creates a file with a square that has texture coordinates and the material 0.
    pub(crate) fn square() -> Self {
        let mut this = Self::empty();
        let positions = this.floats(&SQUARE, 3);
        let uvs = this.floats(&SQUARE_UVS, 2);
        let indices = this.indices(&SQUARE_INDICES);
        let attributes = json!({"POSITION": positions, "TEXCOORD_0": uvs});
        this.mesh(json!({"attributes": attributes, "indices": indices, "material": 0}));
        this.json["materials"] = json!([{}]);
        this
    }

    /// Returns the file after `change` of its JSON.
    pub(crate) fn with(mut self, change: impl FnOnce(&mut Value)) -> Self {
        change(&mut self.json);
        self
    }

    /// Adds a buffer view with these bytes, and returns its index.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend(bytes);
        push(&mut self.json["bufferViews"], view)
    }

    /// Adds an accessor of vectors of `components` floats, and returns its index.
    pub(crate) fn floats(&mut self, values: &[f32], components: usize) -> usize {
        let view = self.view(&values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>());
        let type_ = ["SCALAR", "VEC2", "VEC3", "VEC4"][components - 1];
        let count = values.len() / components;
        let mut accessor = json!({"bufferView": view, "componentType": 5126, "count": count, "type": type_});
        if components == 3 {
            // Required for positions; the loader does not read the values.
            (accessor["min"], accessor["max"]) = (json!([0, 0, 0]), json!([1, 1, 1]));
        }
        push(&mut self.json["accessors"], accessor)
    }

    /// Adds an accessor of 32-bit indices, and returns its index.
    pub(crate) fn indices(&mut self, values: &[u32]) -> usize {
        let view = self.view(&values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>());
        let count = values.len();
        push(
            &mut self.json["accessors"],
            json!({"bufferView": view, "componentType": 5125, "count": count, "type": "SCALAR"}),
        )
    }

    /// Adds a mesh of one primitive, and returns its index.
    pub(crate) fn mesh(&mut self, primitive: Value) -> usize {
        let mut mesh = json!({});
        mesh["primitives"] = Value::Array(vec![primitive]);
        push(&mut self.json["meshes"], mesh)
    }

    /// Writes the file with embedded data, and returns its path.
    pub(crate) fn write(&self, folder: &Path) -> PathBuf {
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        self.write_with(folder, json!([{"uri": uri, "byteLength": self.bytes.len()}]))
    }

    /// Writes the file and its buffer as two files, and returns the path of the former.
    pub(crate) fn write_apart(&self, folder: &Path) -> PathBuf {
        std::fs::write(folder.join("its data.bin"), &self.bytes).unwrap();
        self.write_with(folder, json!([{"uri": "its%20data.bin", "byteLength": self.bytes.len()}]))
    }

    fn write_with(&self, folder: &Path, buffers: Value) -> PathBuf {
        let mut json = self.json.clone();
        if json["buffers"].is_null() {
            json["buffers"] = buffers;
        }
        let path = folder.join("a.gltf");
        std::fs::write(&path, serde_json::to_string_pretty(&json).unwrap()).unwrap();
        path
    }

    /// Writes the file in binary form, and returns its path.
    pub(crate) fn write_binary(&self, folder: &Path) -> PathBuf {
        let path = folder.join("a.glb");
        std::fs::write(&path, self.binary()).unwrap();
        path
    }

    /// Returns the bytes of the file in binary form.
    pub(crate) fn binary(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut data = self.bytes.clone();
        data.resize(data.len().next_multiple_of(4), 0);
        let number = |number: usize| (number as u32).to_le_bytes();
        let header = [*b"glTF", number(2), number(28 + text.len() + data.len())].concat();
        let json_chunk = [&number(text.len())[..], b"JSON", &text].concat();
        [header, json_chunk, [&number(data.len())[..], b"BIN\0", &data].concat()].concat()
    }
}

/// Appends an item to an array and returns its index.
fn push(array: &mut Value, item: Value) -> usize {
    let items = array.as_array_mut().unwrap();
    items.push(item);
    items.len() - 1
}
