//! Time from a request to the picture and the explanation of a picked pixel, while the camera orbits.

use std::time::Instant;

use super::engine::{Engine, Look, Request, Shown};
use super::start::WindowStart;
use crate::inspect::Buffer;
use crate::measure::motion::Turn;
use crate::measure::timing::summarize;
use crate::measure::window_cost::AnswerTime;
use crate::pipeline::viewport::Viewport;

/// Number of unmeasured answers at the start.
const WARM_UP_ANSWERS: usize = 5;

/// Orbits the camera by `turn` per answer, with the pixel in the middle of the picture picked, and times `count`
/// answers of the renderer. `size` is the size of the picture. As in the window, the last view is held until the next
/// one arrives.
pub(crate) fn answer_time(start: &WindowStart, size: Viewport, turn: Turn, count: usize) -> Option<AnswerTime> {
    let pick = (size.width / 2, size.height / 2);
    let shot = turn.shot(&start.scene, &start.camera);
    let mut engine = Engine::default();
    let mut held = None;
    let mut times_ms = Vec::with_capacity(count);
    let mut explained = 0;
    for step in 0..WARM_UP_ANSWERS + count {
        let request = Request {
            scene: start.scene.clone(),
            camera: shot.camera_of(turn.frame_of_round(step as i64)),
            sequence: None,
            is_replayed: false,
            recipe: start.recipe,
            viewport: size,
            shown: Shown::Buffer(Buffer::Color),
            triangle_limit: None,
            fragment_limit: None,
            pick: Some(pick),
            look: Look::default(),
        };
        let begun = Instant::now();
        let view = engine.answer(request);
        let elapsed = begun.elapsed();
        if step >= WARM_UP_ANSWERS {
            times_ms.push(elapsed.as_secs_f64() * 1e3);
            explained += usize::from(view.report.is_some());
        }
        held = Some(view);
    }
    drop(held);
    Some(AnswerTime { size: [size.width, size.height], pick: pick.into(), explained, answer_ms: summarize(&times_ms)? })
}
