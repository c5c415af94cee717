//! Renderer: draws successive frames on all threads.

use std::sync::Arc;
use std::time::Instant;

use super::driver::FrameRequest;
use super::executor::{ClassicExecutor, TiledExecutor};
use super::pool::BufferPool;
use super::{Frame, KeepDepth, Recipe};
use crate::math::lanes::Lanes;
use crate::pipeline::settings::Execution;
use crate::pipeline::tiled;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::History;

/// Inputs that determine a frame, except for its history.
#[derive(Clone, Copy, Debug)]
pub struct RenderInputs<'a> {
    /// Scene at the time of the frame.
    pub scene: &'a Arc<Scene>,
    /// Camera of the frame.
    pub camera: &'a Camera,
    /// Recipe of the frame.
    pub recipe: &'a Recipe,
    /// Size of the frame, in pixels.
    pub viewport: Viewport,
}

/// Renderer that draws frames according to recipes and reuses buffers from frame to frame. With the tiled execution, it
/// uses all threads.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use rasterscope_engine::chain::{KeepDepth, Recipe, RenderInputs, Renderer};
/// # use rasterscope_engine::pipeline::viewport::Viewport;
/// # use rasterscope_engine::scene::builtin;
///
/// let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
/// let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
/// let inputs = RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport };
/// let mut renderer = Renderer::default();
/// let first = renderer.render(inputs, KeepDepth::Yes);
/// let picture = first.image().clone();
///
/// // The second frame is drawn into the buffers of the first one.
/// renderer.recycle(first);
/// let second = renderer.render(inputs, KeepDepth::Yes);
/// assert_eq!(*second.image(), picture);
/// ```
#[derive(Debug)]
pub struct Renderer {
    memory: tiled::TiledMemory,
    lanes: Lanes,
    pool: BufferPool,
    /// Preceding frame; `None` unless the upscaler of that frame reads history.
    past: Option<SavedHistory>,
}

/// History of the preceding frame, with the inputs of that frame. The next frame reads the history only if it has the
/// same inputs. Clones share the buffers.
#[derive(Clone, Debug)]
pub struct SavedHistory {
    recipe: Recipe,
    viewport: Viewport,
    history: Arc<History>,
}

impl SavedHistory {
    /// Returns the memory use in bytes, except for the meshes that the pose of the preceding frame shares with `scene`.
    pub fn bytes(&self, scene: &Scene) -> usize {
        let (own, others) = (self.history.scene.library.meshes(), scene.library.meshes());
        let moved = own.iter().enumerate().filter(|(i, mesh)| !others.get(*i).is_some_and(|it| Arc::ptr_eq(it, mesh)));
        self.history.buffer_bytes() + moved.map(|(_, mesh)| mesh.bytes()).sum::<usize>()
    }
}

impl Default for Renderer {
    fn default() -> Self {
        Self { memory: tiled::TiledMemory::default(), lanes: Lanes::best(), pool: BufferPool::default(), past: None }
    }
}

impl Renderer {
    /// Returns a renderer that uses the given SIMD instruction set.
    pub(crate) fn on(lanes: Lanes) -> Self {
        Self { lanes, ..Self::default() }
    }

    /// Draws one frame of the viewport's size, on the threads of the current rayon pool.
    pub fn render(&mut self, inputs: RenderInputs<'_>, keep_depth: KeepDepth) -> Frame {
        let RenderInputs { scene, camera, recipe, viewport } = inputs;
        let same = |past: &SavedHistory| {
            scene.is_pose_of(&past.history.scene) && past.recipe == *recipe && past.viewport == viewport
        };
        let past = self.past.take().filter(same).map(|past| past.history);
        let Self { memory, lanes, pool, .. } = self;
        let request = FrameRequest { scene, camera, recipe, viewport, keep_depth, past, lanes: *lanes };
        let mut frame = match execution(scene, recipe).0 {
            Execution::Tiled => request.draw(TiledExecutor::new(scene, memory, *lanes), pool),
            // It needs the depths of the whole picture for the depth test.
            Execution::Classic => {
                let request = FrameRequest { keep_depth: KeepDepth::Yes, ..request };
                request.draw(ClassicExecutor::new(&mut ()), pool)
            }
        };
        let finished = Instant::now();
        self.past = frame.take_history(scene, recipe, &mut self.pool).map(|history| SavedHistory {
            recipe: *recipe,
            viewport,
            history: Arc::new(history),
        });
        let remembering = finished.elapsed();
        frame.times.upscale += remembering;
        frame.times.total += remembering;
        frame
    }

    /// Discards the history, so that the next frame is drawn like a first one.
    pub fn forget_history(&mut self) {
        self.past = None;
    }

    /// Returns the history that the next frame reads; `None` if there is none.
    pub fn history(&self) -> Option<SavedHistory> {
        self.past.clone()
    }

    /// Replaces the history, so that the next frame is drawn like one after the frame at which `history` was saved.
    pub fn restore_history(&mut self, history: SavedHistory) {
        self.past = Some(history);
    }

    /// Draws a view repeatedly until the upscaler's history has converged, and returns the last frame. Draws only one
    /// frame if the upscaler reads no history.
    pub fn render_converged(&mut self, inputs: RenderInputs<'_>) -> Frame {
        let mut frame = self.render(inputs, KeepDepth::Yes);
        while frame.is_converging(inputs.recipe) {
            frame = self.render(inputs, KeepDepth::Yes);
        }
        frame
    }

    /// Takes back the buffers of a frame that is no longer needed, for reuse.
    pub fn recycle(&mut self, frame: Frame) {
        frame.give_buffers(&mut self.pool);
    }

    /// Returns the size in bytes of the buffers held from frame to frame.
    pub(crate) fn bytes(&self) -> usize {
        self.memory.bytes() + self.pool.bytes()
    }
}

/// Returns the execution that is used for a scene and a recipe. If it is not the execution that the recipe selects, the
/// second value is the reason.
pub fn execution(scene: &Scene, recipe: &Recipe) -> (Execution, Option<&'static str>) {
    match recipe.execution {
        Execution::Classic => (Execution::Classic, None),
        Execution::Tiled => match tiled::obstacle(scene, &recipe.pipeline) {
            None => (Execution::Tiled, None),
            why => (Execution::Classic, why),
        },
    }
}
