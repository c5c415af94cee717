//! Tiled execution, the fast path of the pipeline: draws tile by tile, on all threads and with SIMD. Coverage and depth
//! are computed for eight samples at a time, shading for sixteen.
//!
//! ```text
//! transform ─► cull and bin ─┬─► tile: coverage and depth ─► shade ─┐
//!  vertices     triangles    ├─► tile …                             ├─► picture
//!                            └─► tile …                             ┘
//! ```
//!
//! Each tile first finds the visible triangle of every sample and only then shades each sample once, so hidden surfaces
//! cost no shading. Vertices are snapped to 1/256 px, so edge functions are exact integers. Depth and attributes are
//! computed by the same operations in the same order as on the classic (scalar) path. The picture is therefore
//! identical bit for bit, for any number of threads and any instruction set.
//!
//! Multisampling shades a pixel once for each triangle visible in it and draws one tile per sample: see
//! [`Multisampling`]. Jittered supersampling, with different sample positions in each pixel, draws and shades the
//! samples one after the other: see [`Jittering`].

mod anisotropic;
mod axis;
mod batch;
mod binning;
mod bins;
mod canvas;
mod centre;
mod classic;
mod clusters;
mod counters;
mod depths;
mod draw;
mod draws;
mod edge_number;
mod edge_rows;
mod entry;
mod few;
mod finish;
mod gather;
mod geometry;
mod jitter;
mod kernel;
mod lattice;
mod layout;
mod lookup;
mod mipmap;
mod mixed;
mod multisample;
mod multisample_transparency;
mod outcode;
mod packed;
mod pass;
mod patch;
mod pending;
mod pixel_samples;
mod queue;
mod record;
mod report;
mod runs;
mod sample_positions;
mod setup;
mod shade;
mod shade_jittered;
mod shader;
mod slot;
mod sorted;
mod target;
mod tested;
mod texels;
mod texture;
mod tile;
mod transparency;
mod weights;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use batch::TriangleGroup;
use binning::Binning;
use bins::{Chunk, MAX_TRIANGLES};
use counters::FrameCounters;
use depths::DepthRules;
use draws::{plan, shaders};
use geometry::{Arrays, InstanceDraw, TransformContext};
pub(crate) use jitter::JITTER_POSITIONS;
use jitter::JitterMemory;
pub(crate) use jitter::Jittering;
pub(crate) use jitter::SumOfSamples;
pub(crate) use jitter::Sums;
use lattice::TileLattice;
use layout::{TILE, TileGrid};
use mixed::MixedPixels;
pub(crate) use multisample::Multisampling;
pub(crate) use multisample::Picks;
use multisample_transparency::TransparencyMemory;
use pending::Pending;
pub(crate) use pixel_samples::PixelSamples;
use pixel_samples::PreparedSamples;
use queue::Queue;
use record::TileBin;
pub(crate) use report::TiledCounts;
pub(crate) use report::TiledReport;
pub(crate) use report::TiledTimes;
use runs::load;
use shader::{DrawShader, LightSource};
use target::{TileMemory, picture_rows};
use tile::Tile;

use super::DrawnView;
use super::depth::DepthScale;
use super::framebuffer::Framebuffer;
use super::grid::SampleGrid;
use super::plan::DrawPlan;
use super::settings::{Arithmetic, Interpolation, Settings};
use super::viewport::Viewport;
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;
use crate::scene::material::Transparency;
use crate::scene::{Camera, Scene};

/// Returns the reason why tiled execution cannot draw a frame; `None` if it can.
pub(crate) fn obstacle(scene: &Scene, settings: &Settings) -> Option<&'static str> {
    if settings.arithmetic != Arithmetic::Fixed {
        Some("tiled execution requires fixed-point arithmetic")
    } else if settings.rasterizer.is_published() {
        Some("rasterizers as published run in classic execution only")
    } else if settings.interpolation == Interpolation::Published {
        Some("interpolation as published runs in classic execution only")
    } else if scene.triangle_count() > MAX_TRIANGLES {
        Some("the scene has more triangles than tiled execution supports")
    } else {
        None
    }
}

/// Buffers of tiled execution, reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct TiledMemory {
    arrays: Arrays,
    chunks: Vec<Chunk>,
    workspaces: Mutex<Vec<Workspace>>,
}

impl TiledMemory {
    /// Returns the memory use of the buffers in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let workspaces = self.workspaces.lock().map_or(0, |all| all.iter().map(Workspace::bytes).sum());
        self.arrays.bytes() + self.chunks.iter().map(Chunk::bytes).sum::<usize>() + workspaces
    }
}

/// Working memory in which one thread draws and shades a tile.
#[derive(Clone, Debug)]
struct Workspace {
    tile: Tile,
    /// Private colours and depths of one tile, used if the picture has few rows of tiles per thread.
    memory: Option<Box<TileMemory>>,
    /// Tiles of a multisampled frame: one per sample of a pixel, and one for the pixel centres if depths are kept.
    planes: Vec<Tile>,
    mixed: MixedPixels,
    transparency: TransparencyMemory,
    jitter: JitterMemory,
    bin: TileBin,
    group: TriangleGroup,
    pending: Pending,
    queue: Queue,
}

impl Workspace {
    fn new() -> Self {
        Self {
            tile: Tile::new(),
            memory: None,
            planes: Vec::new(),
            mixed: MixedPixels::default(),
            transparency: TransparencyMemory::default(),
            jitter: JitterMemory::default(),
            bin: TileBin::default(),
            group: TriangleGroup::default(),
            pending: Pending::default(),
            queue: Queue::default(),
        }
    }

    fn bytes(&self) -> usize {
        self.tile.bytes()
            + self.memory.as_ref().map_or(0, |_| size_of::<TileMemory>())
            + self.planes.iter().map(Tile::bytes).sum::<usize>()
            + self.mixed.bytes()
            + self.transparency.bytes()
            + self.jitter.bytes()
            + self.bin.bytes()
            + size_of::<TriangleGroup>()
            + self.pending.bytes()
            + self.queue.bytes()
    }
}

/// Per-frame data that all tiles read.
struct TiledFrame<'a> {
    settings: &'a Settings,
    grid: SampleGrid,
    lattice: TileLattice,
    scale: DepthScale,
    rules: DepthRules,
    background: Rgba8,
    draws: &'a [InstanceDraw<'a>],
    arrays: &'a Arrays,
    chunks: &'a [Chunk],
    tiles: TileGrid,
    /// Whether all draws are opaque: none is alpha-tested or blended.
    all_opaque: bool,
    /// Whether any draw computes light from per-pixel normals.
    reads_normals: bool,
    /// Whether any draw reads vertex colours.
    reads_colors: bool,
    /// Shading state of each draw, in the order of `draws`.
    shaders: Vec<DrawShader<'a>>,
    /// For each draw, the index of the first draw with equivalent shading. Samples of both can be shaded together.
    shader_of_draw: Vec<usize>,
    samples: PreparedSamples<'a>,
    /// Counters that each tile adds its work to.
    work: &'a FrameCounters,
}

/// Draws a scene into a framebuffer, overwriting all of its contents.
///
/// [`obstacle`] must return `None` for the scene and the settings.
pub(crate) fn draw(
    view: &DrawnView<'_>,
    framebuffer: &mut Framebuffer,
    samples: PixelSamples<'_>,
    memory: &mut TiledMemory,
    lanes: Lanes,
) -> TiledReport {
    let start = Instant::now();
    let DrawnView { scene, camera, settings, viewport } = *view;
    let scale = DepthScale::of(settings, camera);
    let (draws, plans) = plan(view, lanes);
    let TiledMemory { arrays, chunks, workspaces } = memory;
    let workspaces: &Mutex<Vec<Workspace>> = workspaces;
    TransformContext::new(settings, viewport, scale).transform(&draws, lanes, arrays);
    let transformed = Instant::now();

    let packed = framebuffer.color.size();
    let lattice = TileLattice::new(framebuffer.grid).with_samples(&samples.offsets());
    let samples = PreparedSamples::new(samples, framebuffer.grid, framebuffer.depth.is_some());
    let tiles = TileGrid::covering(packed);
    Binning { draws: &draws, arrays, settings, viewport, scale, lattice, packed, tiles }.run(lanes, chunks);
    let binned = Instant::now();

    let Framebuffer { grid, color, depth, .. } = framebuffer;
    let rules = DepthRules::new(settings, &scale, depth.is_some());
    let shaders = shaders(scene, settings, &draws);
    let work = FrameCounters::default();
    let frame = TiledFrame {
        settings,
        grid: *grid,
        lattice,
        scale,
        rules,
        background: settings.clear_color(scene.background),
        draws: &draws,
        arrays,
        chunks,
        tiles,
        all_opaque: shaders.iter().all(|shader| shader.shader.transparency() == Transparency::Opaque),
        reads_normals: shaders.iter().any(|shader| shader.plan.light == LightSource::Normals),
        reads_colors: shaders.iter().any(|shader| shader.plan.colored),
        shader_of_draw: DrawShader::first_alike(&shaders),
        shaders,
        samples,
        work: &work,
    };
    frame.draw_tiles(lanes, &picture_rows(color, depth.as_mut()), workspaces);
    let tiles_time = binned.elapsed();
    let times = TiledTimes {
        transform: transformed - start,
        cull: binned - transformed,
        rasterize: work.share_of_rasterizing(tiles_time),
        shade: tiles_time - work.share_of_rasterizing(tiles_time),
    };
    let counts = frame.counts(scene.triangle_count() as u64);
    TiledReport { plans: Arc::new(plans), times, counts }
}

/// Width and height of a tile, in samples.
pub(crate) const TILE_SIDE: u32 = TILE as u32;

/// Returns the load of each tile: the number of triangles whose bounding boxes overlap it, before setup.
///
/// The image has one value per tile of [`TILE_SIDE`] × [`TILE_SIDE`] samples. `offsets` are the sample positions
/// relative to the pixel centre, in steps of 1/256 px; if it is empty, pixels are sampled at their centres.
/// [`obstacle`] must return `None` for the scene and the settings.
pub(crate) fn tile_loads(view: &DrawnView<'_>, grid: SampleGrid, offsets: &[[i32; 2]]) -> Image<u32> {
    let DrawnView { camera, settings, viewport, .. } = *view;
    let (scale, lanes) = (DepthScale::of(settings, camera), Lanes::best());
    let (draws, _) = plan(view, lanes);
    let TiledMemory { mut arrays, mut chunks, .. } = TiledMemory::default();
    TransformContext::new(settings, viewport, scale).transform(&draws, lanes, &mut arrays);
    let packed = grid.packed_size(viewport.width, viewport.height);
    let tiles = TileGrid::covering(packed);
    let lattice = TileLattice::new(grid).with_samples(offsets);
    Binning { draws: &draws, arrays: &arrays, settings, viewport, scale, lattice, packed, tiles }
        .run(lanes, &mut chunks);
    Image::from_fn(tiles.columns as u32, tiles.rows as u32, |column, row| {
        load(&chunks, tiles.place(column as usize, row as usize)) as u32
    })
}

/// Returns the draw plan of every instance of a scene, in instance order.
pub fn plans(scene: &Scene, camera: &Camera, settings: &Settings, viewport: Viewport) -> Vec<DrawPlan> {
    plan(&DrawnView { scene, camera, settings, viewport }, Lanes::best()).1
}

impl TiledFrame<'_> {
    /// Returns the work counts of the frame. `triangles_in` is the number of triangles in the scene.
    fn counts(&self, triangles_in: u64) -> TiledCounts {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        TiledCounts {
            triangles_in,
            considered: self.draws.iter().map(|draw| draw.mesh.triangles.len() as u64).sum(),
            rasterized: self.chunks.iter().map(|chunk| chunk.rasterized as u64).sum(),
            kept: self.chunks.iter().map(|chunk| chunk.kept() as u64).sum(),
            binned: self.chunks.iter().map(|chunk| chunk.binned() as u64).sum(),
            visited: count(&self.work.visited),
            uniform: count(&self.work.uniform),
            shaded: count(&self.work.shaded),
            texels: count(&self.work.texels),
            vertices: self.draws.iter().map(|draw| draw.kept.vertices.count() as u64).sum(),
        }
    }
}
