//! The triangles of the scene as seen by the second camera, drawn by the pipeline.

use glam::Vec3;

use super::{Inner, MeshStyle, exploded, is_triangle, met_color};
use crate::image::{Image, Rgba8};
use crate::inspect::fates::GeometryOutcome;
use crate::inspect::normals::{DEFAULT_LENGTH, NormalKind, Projector, normal_lines, world_length};
use crate::inspect::overlays::{FACE_NORMAL, VERTEX_NORMAL};
use crate::inspect::selection::TriangleSelection;
use crate::math::unit_or;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::observe::Observer;
use crate::pipeline::raster::RasterSample;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{Culling, DepthFormat, DepthTest, Settings, Shading};
use crate::pipeline::shade::id_color;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::wireframe::{edge_pixels, line_pixels};
use crate::pipeline::{DrawCall, Extent, Geometry, LastStage, prepare};
use crate::scene::{Camera, Scene, TriangleId};

/// A rendered mesh view.
#[derive(Clone, Debug)]
pub struct MeshPicture {
    /// Rendered image of the mesh view.
    pub image: Image<Rgba8>,
    /// Triangle that each pixel shows, or [`TriangleId::NONE`].
    pub owner: Image<TriangleId>,
}

/// Brightness factor of a triangle seen edge-on.
const MIN_LIGHT: f32 = 0.38;

/// Brightness factor of unselected triangles.
const DIM: f32 = 0.35;

/// Colour of a triangle that directly faces the second camera in the flat style, in sRGB codes.
const FLAT: Rgba8 = [196, 198, 202, 255];

struct MeshOwnerRecorder(Image<TriangleId>);

impl Observer for MeshOwnerRecorder {
    fn depth_stored(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) {
        self.0.set(sample.column, sample.row, triangle.id);
    }
}

/// Returns the pipeline settings of the second camera: no culling, and reversed depth, which suits any range of
/// distances.
fn settings() -> Settings {
    Settings {
        culling: Culling::None,
        shading: Shading::TriangleId,
        depth_test: DepthTest::Less,
        depth_format: DepthFormat::ReversedF32,
        ..Settings::default()
    }
}

/// Display settings of a mesh view.
#[derive(Clone, Debug, PartialEq)]
pub struct Painting {
    /// Style that determines the colours of the triangles.
    pub style: MeshStyle,
    /// Factor by which triangles are moved apart, relative to their distance from the centre of their mesh.
    pub explode: f32,
    /// Selected triangles; all others are dimmed. If the selection is empty, no triangle is dimmed.
    pub selection: TriangleSelection,
    /// Background colour (sRGB codes).
    pub backdrop: [u8; 3],
    /// Kinds of normals to draw as lines.
    pub normals: MeshNormals,
}

/// Settings of the normals that are drawn over the triangles, without occlusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshNormals {
    /// Whether vertex normals are drawn.
    pub vertices: bool,
    /// Whether face normals are drawn.
    pub faces: bool,
    /// Length of the drawn normals, as a fraction of the diagonal of the scene's bounding box.
    pub length: f32,
}

impl Default for MeshNormals {
    fn default() -> Self {
        Self { vertices: false, faces: false, length: DEFAULT_LENGTH }
    }
}

impl MeshNormals {
    /// Returns the kinds of normals to draw, each with its colour and display name.
    pub fn kinds(&self) -> impl Iterator<Item = (NormalKind, Rgba8, &'static str)> {
        let faces = self.faces.then_some((NormalKind::Face, FACE_NORMAL, "face normal"));
        faces.into_iter().chain(self.vertices.then_some((NormalKind::Vertex, VERTEX_NORMAL, "vertex normal")))
    }
}

/// Renders the mesh view: the scene as seen by the second camera `outside`.
pub fn paint(scene: &Scene, inner: &Inner, outside: Camera, size: Viewport, painting: &Painting) -> MeshPicture {
    let Painting { style, explode: apart, selection, backdrop, normals } = painting;
    let (style, apart) = (*style, *apart);
    let moved = (apart != 0.0).then(|| exploded(scene, apart));
    let shown = moved.as_ref().unwrap_or(scene);
    let settings = settings();
    let geometry = prepare(shown, &outside, &settings, size, &mut ());
    let owner = owners(shown, &geometry, &settings, size);
    let colors = colors(scene, inner, style);
    let [r, g, b] = *backdrop;
    let mut image = Image::filled(size.width, size.height, [r, g, b, 255]);
    let is_dim = |id: TriangleId| !selection.is_empty() && !selection.contains(id);
    if style == MeshStyle::Wire {
        wires(&geometry, &colors, is_dim, &mut image);
    } else {
        let lights = lights(shown, outside.eye);
        for (pixel, id) in image.pixels_mut().iter_mut().zip(owner.pixels()).filter(|(_, id)| is_triangle(**id)) {
            let place = id.0 as usize;
            let light = lights.get(place).copied().unwrap_or(1.0) * if is_dim(*id) { DIM } else { 1.0 };
            *pixel = lit(colors.get(place).copied().unwrap_or(FLAT), light);
        }
    }
    let projector = Projector::new(&outside, size);
    for (kind, color, _) in normals.kinds() {
        let all = (0..shown.triangle_count() as u32).map(TriangleId);
        let found = normal_lines(shown, kind, world_length(scene, normals.length), all, &projector);
        for [from, to] in found.lines {
            line_pixels(from.into(), to.into(), image.size()).for_each(|(x, y)| image.set(x, y, color));
        }
    }
    MeshPicture { image, owner }
}

fn owners(scene: &Scene, geometry: &Geometry, settings: &Settings, size: Viewport) -> Image<TriangleId> {
    let mut frame = Framebuffer::new(SampleGrid::FULL, size.width, size.height, scene.background, settings);
    let mut owners = MeshOwnerRecorder(Image::filled(size.width, size.height, TriangleId::NONE));
    let extent = &Extent::all(geometry, size);
    DrawCall { scene, geometry, settings, extent, until: LastStage::Depth }.draw(&mut frame, &mut owners);
    owners.0
}

/// Returns the most central pixel that shows a triangle, as column and row; `None` if no pixel does.
pub fn shown_at(owner: &Image<TriangleId>, triangle: TriangleId) -> Option<(u32, u32)> {
    let width = owner.width();
    let places = || {
        let owned = owner.pixels().iter().zip(0..).filter(|(id, _)| **id == triangle);
        owned.map(|(_, index): (_, u32)| (index % width, index / width))
    };
    let (x, y, count) =
        places().fold((0, 0, 0), |(x, y, n), place| (x + u64::from(place.0), y + u64::from(place.1), n + 1));
    let middle = (x.checked_div(count)?, y.checked_div(count)?);
    places().min_by_key(|(x, y)| u64::from(*x).abs_diff(middle.0).pow(2) + u64::from(*y).abs_diff(middle.1).pow(2))
}

/// Returns the unlit colour of each triangle, in scene order; empty if all have the same colour.
fn colors(scene: &Scene, inner: &Inner, style: MeshStyle) -> Vec<Rgba8> {
    match style {
        MeshStyle::Flat => Vec::new(),
        MeshStyle::Fate => inner.rejections(scene, inner.settings.culling).outcomes().map(met_color).collect(),
        // Culls back faces, whatever the render camera's culling mode, so that the outcome of each triangle shows its
        // facing.
        MeshStyle::Facing | MeshStyle::Wire => {
            let whole = |met| if met == GeometryOutcome::Cut { GeometryOutcome::Drawn } else { met };
            inner.rejections(scene, Culling::Back).outcomes().map(|met| met_color(whole(met))).collect()
        }
        MeshStyle::Object => {
            let counts = scene.instances.iter().map(|i| scene.library.mesh(i.mesh).triangles.len());
            counts.zip(0..).flat_map(|(count, object)| vec![id_color(TriangleId(object)); count]).collect()
        }
    }
}

/// Returns the brightness factor of each triangle when lit from the eye, in scene order.
fn lights(scene: &Scene, eye: Vec3) -> Vec<f32> {
    let light = |instance: &crate::scene::Instance| {
        let mesh = scene.library.mesh(instance.mesh);
        let world: Vec<Vec3> = mesh.positions.iter().map(|p| instance.world_from_model.transform_point3(*p)).collect();
        mesh.triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| world[corner as usize].as_dvec3());
                let normal = unit_or((b - a).cross(c - a), Vec3::Y);
                let towards = unit_or(eye.as_dvec3() - a, Vec3::Z);
                MIN_LIGHT + (1.0 - MIN_LIGHT) * normal.dot(towards).abs()
            })
            .collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(light).collect()
}

fn lit([r, g, b, a]: Rgba8, light: f32) -> Rgba8 {
    let channel = |code: u8| (f32::from(code) * light) as u8;
    [channel(r), channel(g), channel(b), a]
}

/// Draws the edges of all triangles, with the edges of front-facing triangles on top.
fn wires(geometry: &Geometry, colors: &[Rgba8], is_dim: impl Fn(TriangleId) -> bool, image: &mut Image<Rgba8>) {
    let front = met_color(GeometryOutcome::Drawn);
    let color = |triangle: &ScreenTriangle| colors.get(triangle.id.0 as usize).copied().unwrap_or(FLAT);
    for fronts in [false, true] {
        for triangle in geometry.triangles.iter().filter(|triangle| (color(triangle) == front) == fronts) {
            let color = lit(color(triangle), if is_dim(triangle.id) { DIM } else { 1.0 });
            for (x, y) in edge_pixels(triangle, image.size()) {
                image.set(x, y, color);
            }
        }
    }
}
