//! Pictures from outside, drawn on a thread of their own: the newest wish is begun when the last one is done.

use std::sync::Arc;

use eframe::egui::Context;

use crate::image::{Image, Rgba8};
use crate::inspect::mesh_view::{Inner, Look, Mark, Painting, drawn, paint, with_planes};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene, TriangleId};
use crate::ui::task::{Listening, Task};

/// What a picture from outside is drawn from.
#[derive(Clone, Debug)]
pub(super) struct Wish {
    pub(super) scene: Arc<Scene>,
    pub(super) inner: Inner,
    /// The second camera, whose planes are still to be found.
    pub(super) camera: Camera,
    /// Size of the picture.
    pub(super) size: Viewport,
    pub(super) painting: Painting,
    pub(super) look: Look,
}

impl Wish {
    fn is_same(&self, other: &Self) -> bool {
        self.has_same_triangles(other) && self.look == other.look
    }

    /// Whether only marks differ.
    fn has_same_triangles(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && (self.inner, self.camera, self.size) == (other.inner, other.camera, other.size)
            && self.painting == other.painting
    }
}

/// A picture from outside with its marks.
#[derive(Clone, Debug)]
pub(super) struct Painted {
    wish: Wish,
    pub(super) image: Arc<Image<Rgba8>>,
    pub(super) owner: Arc<Image<TriangleId>>,
    pub(super) marks: Arc<Vec<Mark>>,
}

impl Painted {
    /// What the picture was asked with.
    pub(super) fn size(&self) -> Viewport {
        self.wish.size
    }

    /// Draws; of the last picture what has not changed is kept.
    fn new(wish: Wish, last: Option<Self>) -> Self {
        let Wish { scene, inner, camera, size, painting, look } = &wish;
        let seen = with_planes(*camera, scene, inner);
        let marks = Arc::new(drawn(scene, inner, look, &seen, *size));
        if let Some(last) = last.filter(|last| last.wish.has_same_triangles(&wish)) {
            return Self { wish, marks, ..last };
        }
        let picture = paint(scene, inner, seen, *size, painting);
        Self { image: Arc::new(picture.image), owner: Arc::new(picture.owner), marks, wish }
    }
}

/// The last picture, and the next one under way.
#[derive(Default)]
pub(super) struct Painter {
    last: Option<Painted>,
    task: Option<Task<(), Painted>>,
}

impl Painter {
    /// The newest picture there is; asks for the wished one if it is another. With `waits` it is there at once.
    pub(super) fn picture(&mut self, context: &Context, wish: Wish, waits: bool) -> Option<&Painted> {
        if let Some(task) = &self.task {
            match task.listen(&mut None) {
                Listening::GoesOn => {}
                Listening::Ended(painted) => {
                    self.last = painted.map(|painted| *painted).or(self.last.take());
                    self.task = None;
                }
                Listening::BrokeOff => self.task = None,
            }
        }
        let is_there = self.last.as_ref().is_some_and(|last| last.wish.is_same(&wish));
        if !is_there && self.task.is_none() {
            let last = self.last.clone();
            if waits {
                self.last = Some(Painted::new(wish, last));
            } else {
                self.task = Some(Task::start(context.clone(), move |_, _| Some(Painted::new(wish, last))));
            }
        }
        self.last.as_ref()
    }
}
