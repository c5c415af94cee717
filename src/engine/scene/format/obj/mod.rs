//! Loader for Wavefront OBJ and MTL files (Alias|Wavefront, "Object Files", Advanced Visualizer manual, appendix B1).
//!
//! Input: the path of an untrusted file. Output: a renderable [`Scene`] with warnings about skipped content, or an
//! error with file and line. The stages:
//!
//! ```text
//! bytes ── decode ──► text ── attributes ──► lists ─┐
//!                       └──── faces ───────► parts ─┴─ normals ─ vertices ──► meshes
//!                               └ libraries ─ mtl ─► materials ─ textures ──────┴─► scene
//! ```
//!
//! A [`Load`] limits the memory, reports progress and checks for cancellation throughout. Texture coordinates are
//! flipped only here; afterwards v points down. Content that cannot be drawn as intended (an index out of range, a
//! malformed number) is an error. Content that can be skipped gives a warning.

mod attributes;
pub(super) mod decode;
mod faces;
mod libraries;
mod mtl;
mod normals;
mod opacity;
mod polygon;
pub mod statements;
mod textures;
mod vertices;

use std::collections::HashMap;
use std::path::Path;

use glam::{Mat4, Vec2, Vec3};

use self::attributes::quoted;
use self::faces::{FaceCorner, Faces, MeshPart};
use self::libraries::Libraries;
use self::mtl::{Description, PictureReference, TextureOptions};
pub use self::opacity::TrMeaning;
use self::textures::{Reading, Textures, Use, repeats_alpha};
use self::vertices::Stopped;
use super::SceneFormat;
use crate::disk;
use crate::scene::load::{BACKGROUND, Load, MAX_COORDINATE};
use crate::scene::warnings::Warnings;
use crate::scene::{
    Camera, Instance, Library, LoadControl, Loaded, Material, MaterialId, Mesh, MeshData, Scene, SceneError, UpAxis,
    Warning,
};

/// Fractions of the loading time that the five loading steps take, for progress reports. The values are those of a file
/// of 10 million triangles without normals.
const SHARES: [f32; 5] = [0.25, 0.35, 0.15, 0.15, 0.1];

/// Entry of the format in the list of formats.
pub(super) const FORMAT: SceneFormat = SceneFormat {
    name: "OBJ",
    extensions: &["obj"],
    companions: "MTL libraries, textures",
    example: b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    starts: |_| false,
    load: load_with,
    has_tr: true,
};

/// Loads a model within the default memory limit.
#[cfg(test)]
pub(crate) fn load(path: &Path) -> Result<Loaded, SceneError> {
    load_with(path, TrMeaning::Auto, LoadControl::quiet(crate::scene::MemoryLimit::default()))
}

/// Loads a model with its materials and textures. `tr` is the meaning of `Tr` in its materials; `control` holds the
/// memory limit, the progress callback and the cancellation flag.
///
/// Returns an error that names the file and, if known, the line. Causes are an unreadable file, a file that is not OBJ
/// text, a malformed number, an index out of range, no drawable face, or more memory than the limit.
pub(crate) fn load_with(path: &Path, tr: TrMeaning, control: LoadControl<'_>) -> Result<Loaded, SceneError> {
    let [share_of_lists, share_of_faces, share_of_normals, share_of_vertices, share_of_textures] = SHARES;
    let mut load = Load::new(path, control);
    let mut warnings = Warnings::default();
    load.begin(share_of_lists);
    load.advance(0.0)?;
    let text = read_text(path, &mut warnings, &mut load)?;
    let mut lists = attributes::read(path, &text, &mut warnings, &mut load)?;
    load.begin(share_of_faces);
    let mut faces = faces::read(path, &text, &mut lists, &mut warnings, &mut load)?;
    load.free(text.into_bytes());
    let is_drawable = |triangle: &[FaceCorner; 3]| {
        triangle.iter().all(|corner| lists.positions[corner.position as usize].is_finite())
    };
    if !faces.triangles.iter().any(is_drawable) {
        return Err(nothing_to_draw(path, &warnings));
    }
    let mut notes = Vec::new();
    let stopped = |stopped: Stopped| match stopped {
        Stopped::Memory(reason) => SceneError::Unusable { path: path.to_owned(), reason },
        Stopped::Cancelled(error) => error,
    };
    load.begin(share_of_normals);
    if normals::fill(&mut lists, &mut faces, &mut load).map_err(stopped)? {
        let degrees = normals::CREASE_DEGREES;
        let text = format!("no smoothing groups (`s`): where normals are missing, edges above {degrees}° are hard");
        notes.push(Warning::file(path, text));
    }
    load.begin(share_of_vertices);
    let meshes = vertices::meshes(&lists, &faces, &mut load).map_err(stopped)?;
    load.free(std::mem::take(&mut faces.triangles));
    lists.free(&mut load);

    load.begin(share_of_textures);
    let libraries = libraries::read(path, &faces.libraries, &mut warnings);
    let tr_is_opacity = libraries.tr_is_opacity(tr, &faces.parts, &mut warnings);
    libraries.warn_if_unused(path, &faces, &mut warnings);
    let materials = Materials {
        path,
        expects_descriptions: !faces.libraries.is_empty(),
        libraries: &libraries,
        tr_is_opacity,
        known: HashMap::new(),
        textures: Textures::new(load),
    };
    let scene = assemble(&faces, meshes, materials, &mut warnings)?;
    if scene.home.up == UpAxis::Z.unit() {
        let text = "the home view has z up: the model stands on z = 0 and is centred in y; override with `--up y`";
        notes.push(Warning::file(path, text));
    }
    Ok(Loaded { scene, warnings: warnings.finish(path), notes })
}

fn read_text(path: &Path, warnings: &mut Warnings, load: &mut Load<'_>) -> Result<String, SceneError> {
    let unusable = |reason| SceneError::Unusable { path: path.to_owned(), reason };
    // The bytes of the file, and up to twice as many bytes for its text: a Latin-1 character can take two bytes in
    // UTF-8.
    let transient = 3 * disk::length(path);
    load.charge(transient).map_err(unusable)?;
    let bytes = disk::read(path, load.memory().bytes())
        .map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
    let decoded = decode::decode(bytes).map_err(unusable)?;
    load.release(transient);
    load.charge(decoded.text.capacity() as u64).map_err(unusable)?;
    if decoded.padded {
        let line = decode::lines(&decoded.text).count() + usize::from(decoded.text.ends_with(['\n', '\r']));
        warnings.add(path, Some(line), "NUL bytes from here to the end; ignored");
    }
    Ok(decoded.text)
}

/// Returns the error for a file without drawable faces. The first warning with a line number, if any, gives the reason.
fn nothing_to_draw(path: &Path, warnings: &Warnings) -> SceneError {
    match warnings.first_with_line() {
        Some(Warning { line: Some(line), text, .. }) => {
            let reason = format!("{text}; the file contains no face that can be drawn");
            SceneError::Line { path: path.to_owned(), line: *line, reason }
        }
        _ => SceneError::Unusable { path: path.to_owned(), reason: "it contains no faces".to_owned() },
    }
}

/// Assembles the scene: one mesh and one instance per part, with shared materials.
fn assemble<'a>(
    faces: &'a Faces,
    mut meshes: Vec<MeshData>,
    mut materials: Materials<'a>,
    warnings: &mut Warnings,
) -> Result<Scene, SceneError> {
    let path = materials.path;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    scale_down(path, &mut meshes, warnings);
    let mut library = Library::default();
    let mut instances = Vec::with_capacity(faces.parts.len());
    let count = faces.parts.len() + materials.libraries.descriptions.len();
    for (done, (part, mut data)) in faces.parts.iter().zip(meshes).enumerate() {
        materials.textures.advance(done as f32 / count as f32)?;
        let part_name = if part.name.is_empty() { name.clone() } else { part.name.clone() };
        data.name.clone_from(&part_name);
        let material = materials.of(part, !data.colors.is_empty(), &mut library, warnings);
        let mesh =
            Mesh::repaired(data).map_err(|e| SceneError::Unusable { path: path.to_owned(), reason: e.to_string() })?;
        instances.push(Instance {
            name: part_name,
            mesh: library.add_mesh(mesh),
            material,
            world_from_model: Mat4::IDENTITY,
            tint: Vec3::ONE,
        });
    }
    // Materials that no face uses are loaded last. They can be inspected, but must not take memory from the used ones.
    for (done, name) in (faces.parts.len()..).zip(materials.libraries.descriptions.keys()) {
        materials.textures.advance(done as f32 / count as f32)?;
        materials.get(Name::Described(name), &mut library, warnings);
    }
    materials.textures.advance(1.0)?;
    let home = Camera::look_at(Vec3::Z, Vec3::ZERO);
    let mut scene = Scene {
        name,
        library,
        instances,
        background: BACKGROUND,
        home,
        views: Vec::new(),
        light: None,
        animation: None,
    };
    scene.home = scene.first_view(UpAxis::guess(scene.bounds()));
    Ok(scene)
}

/// Scales all coordinates down if the arithmetic of the pipeline would otherwise overflow. Models of plausible size are
/// unaffected.
fn scale_down(path: &Path, meshes: &mut [MeshData], warnings: &mut Warnings) {
    let finite = meshes.iter().flat_map(|mesh| &mesh.positions).flat_map(Vec3::to_array).filter(|x| x.is_finite());
    let largest = finite.fold(0.0_f32, |largest, x| largest.max(x.abs()));
    if largest <= MAX_COORDINATE {
        return;
    }
    warnings.add(path, None, format!("coordinates up to {largest:e} are scaled down to {MAX_COORDINATE:e}"));
    for position in meshes.iter_mut().flat_map(|mesh| &mut mesh.positions) {
        *position *= MAX_COORDINATE / largest;
    }
}

/// Materials of a model, each created at its first use.
struct Materials<'a> {
    path: &'a Path,
    /// Whether the file names a material library. If so, a material without a description gives a warning.
    expects_descriptions: bool,
    libraries: &'a Libraries,
    tr_is_opacity: bool,
    known: HashMap<Name<'a>, MaterialId>,
    textures: Textures<'a>,
}

/// Key of a material in [`Materials`].
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Name<'a> {
    Described(&'a str),
    DefaultUnderVertexColors,
    Default,
}

impl<'a> Materials<'a> {
    /// Returns the material of a part, creating it at its first use.
    fn of(
        &mut self,
        part: &'a MeshPart,
        has_colors: bool,
        library: &mut Library,
        warnings: &mut Warnings,
    ) -> MaterialId {
        let name = match &part.material {
            Some(name) if self.libraries.descriptions.contains_key(name) => Name::Described(name),
            _ if has_colors => Name::DefaultUnderVertexColors,
            _ => Name::Default,
        };
        if let (Name::Default | Name::DefaultUnderVertexColors, Some(missing)) = (name, &part.material)
            && self.expects_descriptions
        {
            let text = format!("material {} is not defined; the default is used", quoted(missing));
            warnings.add(self.path, Some(part.material_line), text);
        }
        self.get(name, library, warnings)
    }

    fn get(&mut self, name: Name<'a>, library: &mut Library, warnings: &mut Warnings) -> MaterialId {
        if let Some(id) = self.known.get(&name) {
            return *id;
        }
        let material = match name {
            Name::Described(name) => self.described(name, library, warnings),
            Name::DefaultUnderVertexColors => Material::plain("vertex colours", Vec3::ONE),
            Name::Default => Material::default(),
        };
        let id = library.add_material(material);
        self.known.insert(name, id);
        id
    }

    fn described(&mut self, name: &str, library: &mut Library, warnings: &mut Warnings) -> Material {
        let description = &self.libraries.descriptions[name];
        description.warn_if_invisible(self.tr_is_opacity, self.path, warnings);
        let mut reading = Reading { model: self.path, library, warnings };
        let mut read = |picture: &Option<PictureReference>, purpose: Use, reading: &mut Reading<'_>| {
            picture.as_ref().and_then(|picture| self.textures.get(picture, purpose, reading))
        };
        let picture = description.picture.as_ref();
        let texture = read(&description.picture, Use::Color, &mut reading);
        let channel = description.alpha_picture.as_ref().and_then(|opacity| opacity.options.channel);
        let is_repeated = texture
            .zip(description.alpha_picture.as_ref())
            .zip(picture)
            .is_some_and(|((color, opacity), picture)| repeats_alpha(color, opacity, picture, &reading));
        let opacities = if is_repeated { &None } else { &description.alpha_picture };
        let alpha_texture = read(opacities, Use::Opacity(channel), &mut reading);
        let emission_texture = read(&description.emission_picture, Use::Color, &mut reading);
        let normals = read(&description.normal_picture, Use::Normals, &mut reading);
        let bumps = read(&description.bump_picture, Use::Bumps, &mut reading);
        let normal_picture = if normals.is_some() { &description.normal_picture } else { &description.bump_picture };

        let unset = if texture.is_some() { Vec3::ONE } else { Material::default().diffuse };
        let plain = Material::plain(name, description.diffuse.unwrap_or(unset));
        let placement = description.placement(reading.warnings);
        let unset_emission = if emission_texture.is_some() { Vec3::ONE } else { Vec3::ZERO };
        Material {
            opacity: description.opacity(self.tr_is_opacity),
            texture,
            missing_texture: picture.filter(|_| texture.is_none()).map(|picture| picture.name.clone()),
            emission: description.emission.unwrap_or(unset_emission),
            emission_texture,
            specular: description.specular.unwrap_or(plain.specular),
            shininess: description.shininess.unwrap_or(plain.shininess),
            alpha_texture,
            normal_texture: normals.or(bumps),
            normal_scale: normal_picture.as_ref().map_or(1.0, |picture| picture.options.bump),
            uv_scale: placement.scale,
            // v points down here but up in the file: 1 − (s·(1 − v) + o) = s·v + (1 − s − o).
            uv_offset: Vec2::new(placement.offset.x, 1.0 - placement.scale.y - placement.offset.y),
            clamp: placement.clamp,
            ..plain
        }
    }
}

impl Description {
    /// Returns the scale, offset and clamping that the material's first texture specifies. They are used for all
    /// textures of the material. Warns about each texture that specifies other values.
    fn placement(&self, warnings: &mut Warnings) -> TextureOptions {
        let all =
            [&self.picture, &self.alpha_picture, &self.emission_picture, &self.normal_picture, &self.bump_picture];
        let mut pictures = all.into_iter().flatten();
        let Some(first) = pictures.next() else { return TextureOptions::default() };
        for other in pictures.filter(|other| !other.options.same_placement(&first.options)) {
            let text = "`-o`, `-s` and `-clamp` differ from those of the material's first texture, which are used";
            warnings.add(&other.library, Some(other.line), text);
        }
        first.options.clone()
    }
}
