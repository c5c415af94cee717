//! Background rendering of the mesh view. Once a picture is finished, the newest request is drawn; older ones are
//! dropped.

use std::sync::Arc;

use eframe::egui::Context;

use crate::image::{Image, Rgba8};
use crate::inspect::mesh_view::{Inner, MeshMark, OverlayInputs, Painting, drawn, paint, with_planes};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene, TriangleId};
use crate::ui::task::{BackgroundTask, TaskStatus};

/// Everything that determines a picture of the mesh view.
#[derive(Clone, Debug)]
pub(super) struct PictureRequest {
    pub(super) scene: Arc<Scene>,
    pub(super) inner: Inner,
    /// Camera of the mesh view. Its near and far planes are ignored and computed when the picture is drawn.
    pub(super) camera: Camera,
    /// Size of the picture, in pixels.
    pub(super) size: Viewport,
    pub(super) painting: Painting,
    pub(super) look: OverlayInputs,
}

impl PictureRequest {
    fn is_same(&self, other: &Self) -> bool {
        self.has_same_triangles(other) && self.look == other.look
    }

    /// Whether both requests draw the same triangles, so that at most the marks differ.
    fn has_same_triangles(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && (self.inner, self.camera, self.size) == (other.inner, other.camera, other.size)
            && self.painting == other.painting
    }
}

/// Picture of the mesh view with its marks.
#[derive(Clone, Debug)]
pub(super) struct PaintedMesh {
    request: PictureRequest,
    pub(super) image: Arc<Image<Rgba8>>,
    pub(super) owner: Arc<Image<TriangleId>>,
    pub(super) marks: Arc<Vec<MeshMark>>,
}

impl PaintedMesh {
    /// Returns the size of the picture, in pixels.
    pub(super) fn size(&self) -> Viewport {
        self.request.size
    }

    /// Draws a picture. Reuses the image of `last`, the previous picture, if only the marks differ.
    fn new(request: PictureRequest, last: Option<Self>) -> Self {
        let PictureRequest { scene, inner, camera, size, painting, look } = &request;
        let seen = with_planes(*camera, scene, inner);
        let marks = Arc::new(drawn(scene, inner, look, &seen, *size));
        if let Some(last) = last.filter(|last| last.request.has_same_triangles(&request)) {
            return Self { request, marks, ..last };
        }
        let picture = paint(scene, inner, seen, *size, painting);
        Self { image: Arc::new(picture.image), owner: Arc::new(picture.owner), marks, request }
    }
}

/// Last finished picture, and the task that draws the next one.
#[derive(Default)]
pub(super) struct Painter {
    last: Option<PaintedMesh>,
    task: Option<BackgroundTask<(), PaintedMesh>>,
}

impl Painter {
    /// Returns the last finished picture; `None` if there is none. If it does not match `wish`, starts drawing `wish`,
    /// unless another picture is still being drawn. If `waits` is `true`, drawing is synchronous.
    pub(super) fn picture(&mut self, context: &Context, wish: PictureRequest, waits: bool) -> Option<&PaintedMesh> {
        if let Some(task) = &self.task {
            match task.poll(&mut None) {
                TaskStatus::Running => {}
                TaskStatus::Ended(painted) => {
                    self.last = painted.map(|painted| *painted).or(self.last.take());
                    self.task = None;
                }
                TaskStatus::Lost => self.task = None,
            }
        }
        let is_there = self.last.as_ref().is_some_and(|last| last.request.is_same(&wish));
        if !is_there && self.task.is_none() {
            let last = self.last.clone();
            if waits {
                self.last = Some(PaintedMesh::new(wish, last));
            } else {
                self.task =
                    Some(BackgroundTask::start(context.clone(), move |_, _| Some(PaintedMesh::new(wish, last))));
            }
        }
        self.last.as_ref()
    }
}
