//! `rasterscope bench --window` and `bench --answers`: the cost of drawing the window without the rendered picture, and
//! the time from a request of the window to the picture and the explanation of the picked pixel.

use crate::measure::motion::Turn;
use crate::measure::window_cost::{AnswerTime, WindowCost};
use crate::pipeline::viewport::Viewport;

use super::failure::Failure;
use super::scene_args::RequestedView;
use super::workbench;

/// Measures the cost of each part of a window, over `passes` passes. `size` is the size of the window in pixels.
pub(crate) fn measure(view: RequestedView, size: Viewport, passes: usize) -> Result<Vec<WindowCost>, Failure> {
    workbench::window_costs(view, size, passes)
}

/// Formats the costs as a table, most expensive first.
pub(crate) fn table(costs: &[WindowCost], Viewport { width, height }: Viewport) -> String {
    let passes = costs.first().map_or(0, |cost| cost.whole_ms.n);
    let mut text = format!(
        "User interface at {width} × {height} px: time per pass, {passes} passes each, without picture and GPU\n\n\
         {:28} {:>8} {:>8} {:>8} {:>12} {:>9} {:>10}\n",
        "milliseconds, median", "total", "p90", "layout", "tessellation", "vertices", "upload kB"
    );
    let mut costs: Vec<_> = costs.iter().collect();
    costs.sort_by(|a, b| b.whole_ms.median.total_cmp(&a.whole_ms.median));
    for WindowCost { what, layout_ms, tessellation_ms, whole_ms, vertices, texture_bytes } in costs {
        text += &format!(
            "{what:28} {:8.3} {:8.3} {:8.3} {:12.3} {vertices:9} {:10.1}\n",
            whole_ms.median,
            whole_ms.p90,
            layout_ms.median,
            tessellation_ms.median,
            *texture_bytes as f64 / 1e3,
        );
    }
    text
}

/// Times `count` answers about the pixel in the middle of the picture while the camera orbits by `turn` per answer.
pub(crate) fn answers(
    view: RequestedView,
    size: Viewport,
    turn: Turn,
    count: usize,
) -> Result<Option<AnswerTime>, Failure> {
    workbench::answer_time(view, size, turn, count)
}

/// Formats the time of the answers as text.
pub(crate) fn answers_text(time: &AnswerTime) -> String {
    let AnswerTime { size: [width, height], pick: [x, y], explained, answer_ms: ms } = time;
    let per_second = 1e3 / ms.median.max(1e-6);
    format!(
        "Picture of {width} × {height} px and explanation of pixel {x}, {y}: time per answer while the camera orbits\n\n\
         milliseconds         median {:.3}   p10 {:.3}   p90 {:.3}\n\
         per second           {per_second:.0}\n\
         answers              {}, {explained} with an explanation\n",
        ms.median, ms.p10, ms.p90, ms.n
    )
}
