//! Loader for glTF 2.0 files (Khronos Group, "glTF 2.0 Specification", 2021), as JSON (`.gltf`) or binary (`.glb`).
//!
//! Input: the path of an untrusted file. Output: a renderable [`Scene`] with warnings about content that is not
//! rendered, or an error that names the file and the place in its JSON, as in `meshes[0].primitives[1]`. The stages:
//!
//! ```text
//! bytes ── document ──► JSON, binary chunk ── buffers ──► bytes of each buffer
//!            └─ nodes ──► placed meshes, cameras, lights      │
//!                             ├── animations ◄── accessors ◄──┤
//!                             └────── meshes ◄─────┘          │
//!                                       ├── deformations      │
//!                                       └── materials ◄── textures
//! ```
//!
//! The JSON is parsed and validated by the crate `gltf-json`. Everything else is checked here: no index, offset, count
//! or length of the file is trusted. A [`Load`] limits the memory, reports progress and checks for cancellation.

mod accessors;
mod animations;
mod buffers;
mod cameras;
mod deformations;
mod document;
mod materials;
mod meshes;
mod nodes;
mod textures;
mod topology;
mod uris;
mod vertices;

use std::path::Path;

use glam::{DMat4, Vec3};
use gltf_json::validation::Checked;

use self::accessors::Accessors;
use self::materials::Materials;
use self::meshes::Meshes;
use self::nodes::Placed;
use super::SceneFormat;
use crate::scene::animation::{Animation, Attachment};
use crate::scene::load::{BACKGROUND, Load, MAX_COORDINATE, bytes_of};
use crate::scene::obj::TrMeaning;
use crate::scene::warnings::Warnings;
use crate::scene::{Camera, Instance, Library, LoadControl, Loaded, Scene, SceneError, UpAxis};

/// Entry of the format in the list of formats.
pub(super) const FORMAT: SceneFormat = SceneFormat {
    name: "glTF",
    extensions: &["gltf", "glb"],
    companions: "buffers, textures",
    example:
        br#"{"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36,
                     "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#,
    starts: |bytes| bytes.starts_with(document::MAGIC) || bytes.starts_with(b"{"),
    load: load_with,
    has_tr: false,
};

/// Fractions of the loading time that the loading steps take, for progress reports: JSON and buffers, meshes, textures.
const SHARES: [f32; 3] = [0.25, 0.4, 0.35];

/// Memory for drawing one triangle, in bytes. It is added for each triangle of an instance that shares its mesh, because
/// the meshes of a small file may be placed millions of times.
const BYTES_PER_DRAWN_TRIANGLE: u64 = 128;

/// Reason why a load ends without a scene.
enum Failure {
    /// The file is unusable. The sentence names the place in the file.
    Unusable(String),
    /// The load was cancelled, or the error already names the file.
    Named(SceneError),
}

impl From<String> for Failure {
    fn from(reason: String) -> Self {
        Self::Unusable(reason)
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Named(error)
    }
}

/// Collected remarks about a file.
struct Remarks<'a> {
    path: &'a Path,
    warnings: Warnings,
    notes: Warnings,
}

impl Remarks<'_> {
    /// Adds a warning about content that is skipped or repaired. Equal warnings are counted.
    fn warn(&mut self, text: impl Into<String>) {
        self.warnings.add(self.path, None, text);
    }

    /// Adds a note about content that is not rendered by design. Equal notes are counted.
    fn note(&mut self, text: impl Into<String>) {
        self.notes.add(self.path, None, text);
    }
}

/// Loads a model with its materials, textures, cameras and light. `control` holds the memory limit, the progress callback
/// and the cancellation flag. glTF has no `Tr`, so the second parameter has no effect.
///
/// Returns an error that names the file and, if known, the place in its JSON. Causes are an unreadable file, malformed
/// content, a required extension that is not supported, no triangle to draw, or more memory than the limit.
pub fn load_with(path: &Path, _: TrMeaning, control: LoadControl<'_>) -> Result<Loaded, SceneError> {
    let mut remarks = Remarks { path, warnings: Warnings::default(), notes: Warnings::default() };
    match load(path, &mut remarks, control) {
        Ok(scene) => Ok(Loaded { scene, warnings: remarks.warnings.finish(path), notes: remarks.notes.finish(path) }),
        Err(Failure::Unusable(reason)) => Err(SceneError::Unusable { path: path.to_owned(), reason }),
        Err(Failure::Named(error)) => Err(error),
    }
}

fn load(path: &Path, remarks: &mut Remarks<'_>, control: LoadControl<'_>) -> Result<Scene, Failure> {
    let [share_of_data, share_of_meshes, share_of_textures] = SHARES;
    let mut load = Load::new(path, control);
    load.begin(share_of_data);
    load.advance(0.0)?;
    let document = document::read(path, &mut load)?;
    let root = &document.root;
    document::remark_unrendered(root, remarks);
    let buffers = buffers::read(path, &document, &mut load)?;
    let mut placed = nodes::place(root, remarks)?;
    let mut accessors = Accessors::new(root, &buffers);
    animations::read(root, &mut accessors, &mut placed, &mut load, remarks)?;
    deformations::mark(root, &mut placed);

    load.begin(share_of_meshes);
    let mut library = Library::default();
    let mut meshes = Meshes::new(root, accessors, &placed.rig_nodes);
    let mut triangles = 0_u64;
    for (done, placed_mesh) in placed.meshes.iter().enumerate() {
        load.advance(done as f32 / placed.meshes.len() as f32)?;
        let is_first = meshes.prepare(placed_mesh, &mut library, &mut load, remarks)?;
        for part in meshes.parts(placed_mesh) {
            let drawn = library.mesh(part.mesh).triangles.len() as u64;
            load.charge(if is_first { 0 } else { drawn.saturating_mul(BYTES_PER_DRAWN_TRIANGLE) })?;
            triangles += drawn;
        }
        if triangles >= u64::from(u32::MAX) {
            return Err(format!("its instances have more than {} triangles in total", u32::MAX - 1).into());
        }
    }
    if triangles == 0 {
        return Err("it contains no triangles that can be drawn".to_owned().into());
    }

    load.begin(share_of_textures);
    let mut materials = Materials::new(path, root, &buffers);
    let moving = placed.rig.moving();
    let (mut instances, mut attachments) = (Vec::new(), Vec::new());
    for (done, placed_mesh) in placed.meshes.iter().enumerate() {
        load.advance(done as f32 / placed.meshes.len() as f32)?;
        for part in meshes.parts(placed_mesh) {
            let name = part.name(&placed_mesh.name);
            load.charge(bytes_of::<u8>(name.len()))?;
            let instance = Instance {
                name,
                mesh: part.mesh,
                material: materials.id(part.material, &mut library, &mut load, remarks),
                world_from_model: placed_mesh.world_from_model.as_mat4(),
                tint: Vec3::ONE,
            };
            if moving[placed_mesh.node] && placed_mesh.skin.is_none() {
                let (node, fallback) = (placed_mesh.node, instance.world_from_model);
                let attachment =
                    Attachment { instance: instances.len(), node, node_from_model: DMat4::IDENTITY, fallback };
                load.push(&mut attachments, attachment)?;
            }
            load.push(&mut instances, instance)?;
        }
    }
    load.advance(1.0)?;
    let deformations = meshes.into_deformations();
    let animation = Animation { rig: placed.rig.clone(), attachments, deformations, ..Animation::default() };
    let scene = Scene {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        library,
        instances,
        background: BACKGROUND,
        home: Camera::look_at(Vec3::Z, Vec3::ZERO),
        views: Vec::new(),
        light: placed.light,
        animation: None,
    };
    with_views(scene.animated(animation), &placed, remarks)
}

/// Returns the scene with the views of the file and a first view of all it contains.
fn with_views(mut scene: Scene, placed: &Placed, remarks: &mut Remarks<'_>) -> Result<Scene, Failure> {
    let bounds = scene.bounds();
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    if !bounds.is_empty() && largest > MAX_COORDINATE {
        return Err(format!("coordinates up to {largest:e} are too large: at most {MAX_COORDINATE:e}").into());
    }
    scene.home = scene.first_view(UpAxis::Y);
    scene.views = cameras::views(placed, bounds, remarks);
    Ok(scene)
}

/// Returns the item of a value that the validation of the file has accepted.
fn valid<T: Copy>(checked: Checked<T>) -> Option<T> {
    match checked {
        Checked::Valid(item) => Some(item),
        Checked::Invalid => None,
    }
}

/// Returns the name of an object of the file, or a name made of its kind and index if it has none.
fn name_or(name: Option<&String>, kind: &str, index: usize) -> String {
    name.filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("{kind} {index}"))
}
