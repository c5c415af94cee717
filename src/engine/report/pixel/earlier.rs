//! Section of the page about a pixel: contribution of earlier frames.

use super::swatch;
use crate::inspect::temporal::{FrameShare, PastFrames, PixelFrame, PixelHistory};
use crate::report::html::{escaped, table};

/// Maximum number of listed frames: the inspected one and those before it.
const MAX_FRAMES: usize = 200;

/// Returns the section as HTML.
pub(super) fn section(history: &PixelHistory) -> String {
    let shares = history.past_frames.as_ref().map_or_else(String::new, shares);
    let masks: String =
        history.masks.iter().map(|score| format!("<li>{}</li>\n", escaped(&score.sentence()))).collect();
    let masks = match masks.as_str() {
        "" => String::new(),
        list => format!("<h3>History of all pixels, compared with the exact disocclusion</h3>\n<ul>\n{list}</ul>\n"),
    };
    format!("<section>\n<h2>Earlier frames</h2>\n{shares}{}{masks}</section>\n", colors(&history.pixel_frames))
}

/// Returns the share of every frame.
fn shares(past: &PastFrames) -> String {
    let row = |frame: &FrameShare| {
        let [x, y] = frame.position_px;
        let [share, place] = [format!("{:.1} %", frame.share * 100.0), format!("{x:.2}, {y:.2}")];
        vec![frame.frame.to_string(), share, place, frame.pixels.to_string(), frame.outcome(past.space)]
    };
    let heads = ["Frame", "Share before clamping", "Position, px", "Pixels", "Outcome"];
    let rows = past.frames.iter().take(MAX_FRAMES).map(row);
    format!("{}<p class=\"soft\">{}</p>\n", table(&heads, rows, true), escaped(&past.remark()))
}

/// Returns the colours of the pixel in every frame, the newest first.
fn colors(frames: &[PixelFrame]) -> String {
    let color = |[r, g, b]: [u8; 3]| swatch([r, g, b, u8::MAX]);
    let row = |frame: &PixelFrame| {
        let history = frame.history.map_or_else(|| "none".to_owned(), color);
        let cells = [frame.frame.to_string(), color(frame.samples), percent(frame.share), history, color(frame.result)];
        format!("<tr><td>{}</td></tr>\n", cells.join("</td><td>"))
    };
    let heads = ["Frame", "Samples", "Share of the samples", "History", "Result"].join("</th><th>");
    let rows: String = frames.iter().rev().take(MAX_FRAMES).map(row).collect();
    format!(
        "<h3>Colours of the pixel</h3>\n<div class=\"scroll\"><table class=\"rows prose\">\n<thead><tr><th>{heads}</th></tr>\
         </thead>\n<tbody>\n{rows}</tbody></table></div>\n"
    )
}

fn percent(share: f32) -> String {
    format!("{:.1} %", share * 100.0)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::inspect::temporal::{ClipView, HistoryClip, TemporalSearch};
    use crate::measure::shot::{CameraMotion, Shot};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    #[test]
    fn the_section_lists_every_frame_with_its_share_and_colours() {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let shot = Shot::from_start(Arc::clone(&scene), scene.home, CameraMotion::Still, 30.0);
        let recipe = Recipe { upscaler: Upscaling::new("taa", 2).unwrap(), ..Recipe::default() };
        let viewport = Viewport { width: 40, height: 24 };
        let clip = HistoryClip { view: ClipView::Moving(shot), recipe, viewport, last: 2 };
        let mut search = TemporalSearch::new(clip, (20, 12)).unwrap();
        while search.step() {}
        let history = search.finish();
        let html = section(&history);
        for (frame, place) in history.pixel_frames.iter().zip(0..) {
            let [r, g, b] = frame.result;
            assert_eq!(frame.frame, place);
            assert!(html.contains(&format!("<tr><td>{place}</td>")));
            assert!(html.contains(&format!("background:#{r:02x}{g:02x}{b:02x}")));
        }
        for frame in history.past_frames.iter().flat_map(|past| &past.frames) {
            assert!(html.contains(&format!("<td>{:.1} %</td>", frame.share * 100.0)), "{frame:?}");
        }
        assert!(html.contains("Rejected history") && html.contains("gives the bits of the pixel"));
    }
}
