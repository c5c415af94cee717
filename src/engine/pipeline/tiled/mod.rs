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
mod bins;
mod clusters;
mod depths;
mod edge_number;
mod entry;
mod few;
mod gather;
mod geometry;
mod jitter;
mod kernel;
mod lattice;
mod lookup;
mod mipmap;
mod mixed;
mod multisample;
mod multisample_transparency;
mod outcode;
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
mod sorted;
mod target;
mod tested;
mod texture;
mod tile;
mod transparency;

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use batch::{TriangleBatch, Triangles};
use bins::{Binning, Chunk, MAX_TRIANGLES};
use clusters::{ClusterCulling, VisibleClusters};
use depths::DepthRules;
use entry::{BATCHES, GROUP, uses_hiz};
use geometry::{Arrays, InstanceDraw};
pub(crate) use jitter::JITTER_POSITIONS;
use jitter::JitterMemory;
pub(crate) use jitter::Jittering;
pub(crate) use jitter::SumOfSamples;
pub(crate) use jitter::Sums;
use lattice::{TILE, TileLattice};
use mixed::MixedPixels;
pub(crate) use multisample::Multisampling;
pub(crate) use multisample::Picks;
use multisample_transparency::TransparencyMemory;
use pending::Pending;
pub(crate) use pixel_samples::PixelSamples;
use pixel_samples::PreparedSamples;
use queue::Queue;
use record::{Slot, TileBin};
pub(crate) use report::TiledCounts;
pub(crate) use report::TiledReport;
pub(crate) use report::TiledTimes;
use runs::{TileRun, load, split_into_runs};
use sample_positions::SamplePositions;
use setup::{Origin, Setup};
use shade::{ShadingTarget, ShadingWork, shade_tile};
use shader::{DrawShader, LightSource};
use target::{PictureRows, Target, TileMemory, TileRows, lock, picture_rows};
use tile::{Tile, TileCounts};

use super::clip::guard_band_widening;
use super::depth::DepthScale;
use super::framebuffer::Framebuffer;
use super::grid::SampleGrid;
use super::plan::{DrawPlan, PipelinePart};
use super::settings::{Arithmetic, Interpolation, Settings};
use super::shade::Shader;
use super::vertex::{DrawMatrices, containment};
use super::viewport::Viewport;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
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
    batches: [TriangleBatch; BATCHES],
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
            batches: Default::default(),
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
            + size_of::<[TriangleBatch; BATCHES]>()
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
}

/// Draws a scene into a framebuffer, overwriting all of its contents.
///
/// [`obstacle`] must return `None` for the scene and the settings.
pub(crate) fn draw(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    viewport: Viewport,
    (framebuffer, samples): (&mut Framebuffer, PixelSamples<'_>),
    memory: &mut TiledMemory,
    lanes: Lanes,
) -> TiledReport {
    let start = Instant::now();
    let scale = DepthScale::of(settings, camera);
    let (draws, plans) = plan(scene, camera, settings, viewport, lanes);
    let widening = guard_band_widening(viewport.width, viewport.height);
    let TiledMemory { arrays, chunks, workspaces } = memory;
    let workspaces: &Mutex<Vec<Workspace>> = workspaces;
    geometry::transform(&draws, settings, viewport, &scale, widening, lanes, arrays);
    let transformed = Instant::now();

    let packed = framebuffer.color.size();
    let lattice = TileLattice::new(framebuffer.grid).with_samples(&samples.offsets());
    let samples = PreparedSamples::new(samples, framebuffer.grid, framebuffer.depth.is_some());
    let tile_counts = ((packed.0 as usize).div_ceil(TILE), (packed.1 as usize).div_ceil(TILE));
    Binning { draws: &draws, arrays, settings, viewport, scale, lattice, packed, tiles: tile_counts }
        .run(lanes, chunks);
    let binned = Instant::now();

    let Framebuffer { grid, color, depth, .. } = framebuffer;
    let rules = DepthRules::new(settings, &scale, depth.is_some());
    let shaders = shaders(scene, settings, &draws);
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
        all_opaque: shaders.iter().all(|shader| shader.shader.transparency() == Transparency::Opaque),
        reads_normals: shaders.iter().any(|shader| shader.plan.light == LightSource::Normals),
        reads_colors: shaders.iter().any(|shader| shader.plan.colored),
        shader_of_draw: DrawShader::first_alike(&shaders),
        shaders,
        samples,
    };
    let work = FrameCounters::default();
    frame.draw_tiles(lanes, tile_counts, &picture_rows(color, depth.as_mut()), workspaces, &work);
    let tiles_time = binned.elapsed();
    let times = TiledTimes {
        transform: transformed - start,
        cull: binned - transformed,
        rasterize: work.share_of_rasterizing(tiles_time),
        shade: tiles_time - work.share_of_rasterizing(tiles_time),
    };
    let counts = frame.counts(scene.triangle_count() as u64, work);
    TiledReport { plans: Arc::new(plans), times, counts }
}

/// Width and height of a tile, in samples.
pub(crate) const TILE_SIDE: u32 = TILE as u32;

/// Returns the load of each tile: the number of triangles whose bounding boxes overlap it, before setup.
///
/// The image has one value per tile of [`TILE_SIDE`] × [`TILE_SIDE`] samples. `offsets` are the sample positions
/// relative to the pixel centre, in steps of 1/256 px; if it is empty, pixels are sampled at their centres.
/// [`obstacle`] must return `None` for the scene and the settings.
pub(crate) fn tile_loads(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    (grid, viewport): (SampleGrid, Viewport),
    offsets: &[[i32; 2]],
) -> Image<u32> {
    let (scale, lanes) = (DepthScale::of(settings, camera), Lanes::best());
    let (draws, _) = plan(scene, camera, settings, viewport, lanes);
    let widening = guard_band_widening(viewport.width, viewport.height);
    let TiledMemory { mut arrays, mut chunks, .. } = TiledMemory::default();
    geometry::transform(&draws, settings, viewport, &scale, widening, lanes, &mut arrays);
    let packed = grid.packed_size(viewport.width, viewport.height);
    let tiles = ((packed.0 as usize).div_ceil(TILE), (packed.1 as usize).div_ceil(TILE));
    let lattice = TileLattice::new(grid).with_samples(offsets);
    Binning { draws: &draws, arrays: &arrays, settings, viewport, scale, lattice, packed, tiles }
        .run(lanes, &mut chunks);
    Image::from_fn(tiles.0 as u32, tiles.1 as u32, |column, row| {
        let number = row as usize * tiles.0 + column as usize;
        load(&chunks, number) as u32
    })
}

/// Work counters and stage times of a frame, which all threads add to.
#[derive(Debug, Default)]
struct FrameCounters {
    rasterize_ns: AtomicU64,
    shade_ns: AtomicU64,
    visited: AtomicU64,
    uniform: AtomicU64,
    shaded: AtomicU64,
    texels: AtomicU64,
}

impl FrameCounters {
    /// Adds the rasterization and shading times of one tile, and its work counts.
    fn add(
        &self,
        (rasterize, shade): (Duration, Duration),
        tiles: impl IntoIterator<Item = TileCounts>,
        shaded: ShadingWork,
    ) {
        self.rasterize_ns.fetch_add(rasterize.as_nanos() as u64, Ordering::Relaxed);
        self.shade_ns.fetch_add(shade.as_nanos() as u64, Ordering::Relaxed);
        for TileCounts { visited, uniform: plain } in tiles {
            self.visited.fetch_add(visited, Ordering::Relaxed);
            self.uniform.fetch_add(plain, Ordering::Relaxed);
        }
        self.shaded.fetch_add(shaded.samples, Ordering::Relaxed);
        self.texels.fetch_add(shaded.texels, Ordering::Relaxed);
    }

    fn share_of_rasterizing(&self, time: Duration) -> Duration {
        let rasterize = self.rasterize_ns.load(Ordering::Relaxed) as f64;
        let shade = self.shade_ns.load(Ordering::Relaxed) as f64;
        time.mul_f64(if rasterize > 0.0 { rasterize / (rasterize + shade) } else { 0.0 })
    }
}

/// Returns the draw plan of every instance of a scene, in instance order.
pub fn plans(scene: &Scene, camera: &Camera, settings: &Settings, viewport: Viewport) -> Vec<DrawPlan> {
    plan(scene, camera, settings, viewport, Lanes::best()).1
}

/// Creates the draw plan of every instance of a scene. Returns the draws of the instances that may be visible, and all
/// plans.
fn plan<'a>(
    scene: &'a Scene,
    camera: &Camera,
    settings: &Settings,
    viewport: Viewport,
    lanes: Lanes,
) -> (Vec<InstanceDraw<'a>>, Vec<DrawPlan>) {
    let count = scene.instances.len();
    let (mut draws, mut plans) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let mut first_vertex = 0;
    let clip_from_world = camera.clip_from_world_f64(viewport.aspect(), settings.depth_format.mapping());
    for ((index, instance), first) in scene.instances.iter().enumerate().zip(scene.first_triangles()) {
        let mesh = scene.library.mesh(instance.mesh);
        let matrices = DrawMatrices::new(instance, clip_from_world);
        let inside = containment(mesh.visible_bounds(), matrices.clip_from_model);
        let mut plan = DrawPlan::new(&scene.library, instance, camera, settings, inside).starting_at(first);
        let mut kept = VisibleClusters::all(mesh);
        if !mesh.clusters().is_empty() && plan.may_cull_clusters(settings, inside) {
            let unseen;
            (kept, unseen) = VisibleClusters::cull_clusters(
                mesh,
                &ClusterCulling::new(matrices.clip_from_model, inside, plan.culling(), viewport),
                lanes,
            );
            plan = plan.with_cull_stats(unseen);
        }
        plans.push(plan);
        if plan.runs(PipelinePart::Vertices) && !mesh.triangles.is_empty() {
            draws.push(InstanceDraw::new(index as u32, mesh, plan, matrices, first, (first_vertex, kept)));
            first_vertex += mesh.positions.len();
        }
    }
    (draws, plans)
}

fn shaders<'a>(scene: &'a Scene, settings: &'a Settings, draws: &[InstanceDraw<'_>]) -> Vec<DrawShader<'a>> {
    let shader = |draw: &InstanceDraw<'_>| {
        let instance = &scene.instances[draw.instance as usize];
        let shader = Shader::new(settings, &scene.library, instance, &draw.plan);
        let texture = scene.library.material(instance.material).texture.map(|id| scene.library.texture(id));
        DrawShader::new(shader, texture, draw.plan.runs(PipelinePart::PerspectiveDivision))
    };
    draws.iter().map(shader).collect()
}

impl TiledFrame<'_> {
    /// Draws all tiles into the picture, on all threads. `rows` holds the picture, split into rows of tiles.
    fn draw_tiles(
        &self,
        lanes: Lanes,
        tile_counts: (usize, usize),
        rows: &[Mutex<PictureRows<'_>>],
        workspaces: &Mutex<Vec<Workspace>>,
        work: &FrameCounters,
    ) {
        let threads = rayon::current_num_threads();
        let runs = split_into_runs(self.chunks, tile_counts, threads);
        let next_run = AtomicUsize::new(0);
        let draw_runs = || {
            let taken = workspaces.lock().ok().and_then(|mut all| all.pop());
            let mut workspace = taken.unwrap_or_else(Workspace::new);
            while let Some(run) = runs.get(next_run.fetch_add(1, Ordering::Relaxed)) {
                self.draw_run(lanes, run, tile_counts.0, &rows[run.row], &mut workspace, work);
            }
            if let Ok(mut all) = workspaces.lock() {
                all.push(workspace);
            }
        };
        rayon::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|_| draw_runs());
            }
        });
    }

    /// Draws a run of tiles into a row of the picture that is `columns` tiles wide.
    fn draw_run(
        &self,
        lanes: Lanes,
        run: &TileRun,
        columns: usize,
        rows: &Mutex<PictureRows<'_>>,
        workspace: &mut Workspace,
        work: &FrameCounters,
    ) {
        let tiles = run.columns.clone().map(|column| ((column, run.row), run.row * columns + column));
        if run.load == 0 {
            let nothing = (self.background, self.rules.clear);
            on_lanes!(lanes, simd => lock(rows).clear(simd, &run.columns, nothing));
        } else if run.columns.len() == columns {
            let mut rows = lock(rows);
            on_lanes!(lanes, simd => rows.fill(simd, self.background));
            for (place, number) in tiles {
                self.draw_target(lanes, workspace, rows.target(place, number), work);
            }
        } else {
            let mut memory = workspace.memory.take().unwrap_or_else(TileMemory::new);
            for tile in tiles {
                let draw = |target: Target<'_>| self.draw_target(lanes, workspace, target, work);
                memory.draw(lanes, tile, rows, self.background, draw);
            }
            workspace.memory = Some(memory);
        }
    }

    /// Draws and shades one tile in the sampling mode of the frame.
    fn draw_target(&self, lanes: Lanes, workspace: &mut Workspace, target: Target<'_>, work: &FrameCounters) {
        match &self.samples {
            PreparedSamples::Centre => on_lanes!(lanes, simd => self.draw_tile(simd, workspace, target, work)),
            PreparedSamples::Multisampled(planes) => {
                on_lanes!(lanes, simd => self.draw_samples(simd, planes, workspace, target, work));
            }
            PreparedSamples::Jittered(samples) => {
                on_lanes!(lanes, simd => self.draw_jittered(simd, samples, workspace, target, work));
            }
        }
    }

    /// Returns the work counts of the frame. `triangles_in` is the number of triangles in the scene.
    fn counts(&self, triangles_in: u64, work: FrameCounters) -> TiledCounts {
        TiledCounts {
            triangles_in,
            considered: self.draws.iter().map(|draw| draw.mesh.triangles.len() as u64).sum(),
            rasterized: self.chunks.iter().map(|chunk| chunk.rasterized as u64).sum(),
            kept: self.chunks.iter().map(|chunk| chunk.kept() as u64).sum(),
            binned: self.chunks.iter().map(|chunk| chunk.binned() as u64).sum(),
            visited: work.visited.into_inner(),
            uniform: work.uniform.into_inner(),
            shaded: work.shaded.into_inner(),
            texels: work.texels.into_inner(),
            vertices: self.draws.iter().map(|draw| draw.kept.vertices.count() as u64).sum(),
        }
    }

    #[inline(always)]
    fn draw_tile<S: Simd>(&self, simd: S, workspace: &mut Workspace, mut target: Target<'_>, work: &FrameCounters) {
        let start = Instant::now();
        let Workspace {
            tile,
            bin: entrants,
            batches,
            pending,
            queue,
            transparency: TransparencyMemory { blended, .. },
            ..
        } = workspace;
        self.gather_bin(target.number, entrants);
        if entrants.len() == 0 {
            return target.clear_depths(self.rules.clear);
        }
        let place = target.place;
        let origin = self.origin(&self.lattice, place);
        blended.clear();
        for group in (0..entrants.len()).step_by(GROUP) {
            let (alive, large) = self.set_up_group(simd, entrants, batches, group, origin);
            if group == 0 {
                tile.clear(&self.rules, uses_hiz(entrants.len(), batches, &alive));
            }
            let owner = self.owner(entrants, &self.lattice, place);
            for (number, batch) in batches.iter().enumerate() {
                let mut alive = alive[number];
                while alive != 0 {
                    let lane = alive.trailing_zeros() as usize;
                    alive &= alive - 1;
                    let slot = Slot::new(group + number * LANES + lane, large[number] >> lane & 1 != 0);
                    let triangle = (batch, lane, slot);
                    self.draw_triangle(simd, (tile, &self.lattice), triangle, (entrants, place), &owner, blended);
                }
            }
        }
        if target.depths.is_some() {
            self.write_depths(simd, tile, entrants, &mut target);
        }
        let rasterized = Instant::now();
        let mut picture = target.picture;
        let canvas = ShadingTarget {
            tile,
            locations: &self.lattice,
            bin: entrants,
            pending,
            queue,
            place,
            picture: picture.reborrow(),
        };
        let mut shaded = shade_tile(simd, self, canvas);
        if !blended.is_empty() {
            shaded += self.blend(simd, (tile, &self.lattice), (entrants, blended), place, queue, &mut picture);
        }
        work.add((rasterized - start, rasterized.elapsed()), [tile.counts], shaded);
    }

    /// Draws one triangle of a batch into a tile, or appends it to `blended` if its material is blended.
    #[inline(always)]
    fn draw_triangle<S: Simd>(
        &self,
        simd: S,
        (tile, locations): (&mut Tile, impl SamplePositions),
        (triangles, lane, slot): (&impl Triangles, usize, Slot),
        (entrants, place): (&TileBin, (usize, usize)),
        owner: &impl Fn(Slot) -> Option<Setup>,
        blended: &mut Vec<Slot>,
    ) {
        let transparency = if self.all_opaque { Transparency::Opaque } else { self.transparency(entrants.get(slot)) };
        match transparency {
            Transparency::Opaque => self.draw_opaque(simd, (tile, locations), (triangles, lane, slot), owner),
            Transparency::AlphaTested => {
                let triangle = triangles.triangle(lane, slot);
                self.draw_alpha_tested(simd, (tile, locations), &triangle, (entrants, place), owner);
            }
            Transparency::Blended => blended.push(slot),
        }
    }

    /// Draws one opaque triangle of a batch into a tile, with integer edge values if these fit into 32 bits.
    #[inline(always)]
    fn draw_opaque<S: Simd>(
        &self,
        simd: S,
        (tile, locations): (&mut Tile, impl SamplePositions),
        (triangles, lane, slot): (&impl Triangles, usize, Slot),
        owner: &impl Fn(Slot) -> Option<Setup>,
    ) {
        if triangles.fits(lane) {
            tile.draw(simd, &triangles.triangle::<i32>(lane, slot), locations, &self.rules, owner);
        } else {
            tile.draw(simd, &triangles.triangle::<f64>(lane, slot), locations, &self.rules, owner);
        }
    }

    /// Returns the position of a tile's first sample in steps of 1/256 px, and that sample's column and row in the
    /// packed picture. `place` is the column and row of the tile.
    #[inline(always)]
    fn origin(&self, lattice: &TileLattice, place: (usize, usize)) -> Origin {
        (lattice.origin(place), [(place.0 * TILE) as f32, (place.1 * TILE) as f32])
    }

    /// Returns a function that sets up a triangle of the tile's bin again, given its slot.
    #[inline(always)]
    fn owner(
        &self,
        entrants: &TileBin,
        lattice: &TileLattice,
        place: (usize, usize),
    ) -> impl Fn(Slot) -> Option<Setup> {
        let origin = self.origin(lattice, place);
        move |slot| {
            let entrant = entrants.get(slot);
            let corners = self.corners(entrant.key, entrant.draw as usize);
            Setup::new(slot, &corners, self.settings.fill_rule, &self.scale, lattice, origin)
        }
    }

    /// Copies the depths of a tile, sampled at pixel centres, to its target.
    #[inline(always)]
    fn write_depths<S: Simd>(&self, simd: S, tile: &mut Tile, entrants: &TileBin, target: &mut Target<'_>) {
        let owner = self.owner(entrants, &self.lattice, target.place);
        for (block, _) in tile.uniform_blocks() {
            tile.expand_block(simd, block, &self.lattice, &self.rules, &owner);
        }
        for (row, out) in target.depths.iter_mut().flat_map(TileRows::rows).enumerate() {
            out.copy_from_slice(&tile.depths(row)[..out.len()]);
        }
    }
}
