//! Frame times in drawing order, with a marker at each change of settings. In contrast to the statistics, the history
//! survives these changes.

use std::collections::VecDeque;

use crate::chain::Recipe;
use crate::inspect::fields;
use crate::pipeline::viewport::Viewport;
use crate::ui::engine::Request;
use crate::upscale::Upscaling;

/// Maximum number of stored frames.
const FRAMES: usize = 480;

/// Maximum number of changed settings that a marker names; the others are counted.
const NAMED: usize = 2;

/// One frame that was drawn for the window.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TimedFrame {
    /// Number of frames drawn before.
    number: u64,
    upscaling: Upscaling,
    ms: f64,
}

/// Change of settings between two frames.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SettingsMarker {
    /// Number of the first frame after the change.
    pub(crate) number: u64,
    /// Name of the change, such as “shading: lambert → gouraud”.
    pub(crate) words: String,
}

/// Consecutive frames of one upscaler.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrameRun {
    /// Upscaler that drew the frames.
    pub(crate) upscaling: Upscaling,
    /// Number and time in milliseconds of each frame.
    pub(crate) points: Vec<[f64; 2]>,
}

/// Settings of a frame that affect its time.
#[derive(Clone, Copy, Debug)]
struct FrameSettings {
    recipe: Recipe,
    viewport: Viewport,
}

/// The most recent frames and the changes between them.
#[derive(Debug, Default)]
pub(crate) struct FrameHistory {
    frames: VecDeque<TimedFrame>,
    markers: VecDeque<SettingsMarker>,
    /// Number of frames drawn so far.
    drawn: u64,
    /// Settings of the last frame.
    last: Option<FrameSettings>,
}

impl FrameHistory {
    /// Adds the time of a frame that was drawn for `request`, and a marker if its settings differ from those of the
    /// frame before.
    pub(super) fn record(&mut self, request: &Request, ms: f64) {
        let now = FrameSettings { recipe: request.recipe, viewport: request.viewport };
        if let Some(words) = self.last.and_then(|before| before.change_in_words(now)) {
            self.markers.push_back(SettingsMarker { number: self.drawn, words });
        }
        self.last = Some(now);
        if self.frames.len() == FRAMES {
            self.frames.pop_front();
        }
        self.frames.push_back(TimedFrame { number: self.drawn, upscaling: request.recipe.upscaler, ms });
        self.drawn += 1;
        let first = self.frames.front().map_or(0, |frame| frame.number);
        self.markers.retain(|marker| marker.number > first);
    }

    /// Whether no frames are stored.
    pub(crate) fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Returns the stored frames in drawing order, split where settings have changed.
    pub(crate) fn runs(&self) -> Vec<FrameRun> {
        let mut runs: Vec<FrameRun> = Vec::new();
        let is_marked = |number| self.markers.iter().any(|marker| marker.number == number);
        for TimedFrame { number, upscaling, ms } in &self.frames {
            let point = [*number as f64, *ms];
            match runs.last_mut().filter(|run| run.upscaling == *upscaling && !is_marked(*number)) {
                Some(run) => run.points.push(point),
                None => runs.push(FrameRun { upscaling: *upscaling, points: vec![point] }),
            }
        }
        runs
    }

    /// Returns the changes between the stored frames, oldest first.
    pub(crate) fn markers(&self) -> impl DoubleEndedIterator<Item = &SettingsMarker> {
        self.markers.iter()
    }
}

impl FrameSettings {
    /// Names the difference from the settings of a later frame; `None` if there is none.
    fn change_in_words(self, after: Self) -> Option<String> {
        let Viewport { width, height } = after.viewport;
        let size = (self.viewport != after.viewport).then(|| format!("size: {width} × {height} px"));
        let settings = fields::changes(&self.recipe, &after.recipe).into_iter().map(|change| change.words());
        let all: Vec<_> = size.into_iter().chain(settings).collect();
        let rest = all.len().saturating_sub(NAMED);
        let named = all[..all.len() - rest].join(", ");
        match rest {
            _ if all.is_empty() => None,
            0 => Some(named),
            more => Some(format!("{named} and {more} more")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::session::timings::tests::request;

    #[test]
    fn changes_split_the_history_and_are_named() {
        let (mut history, mut request) = (FrameHistory::default(), request());
        history.record(&request, 4.0);
        history.record(&request, 5.0);
        request.recipe.set("wireframe=true").unwrap();
        history.record(&request, 6.0);
        request.camera.orbit(0.1, 0.0);
        request.viewport.width = 9;
        history.record(&request, 7.0);
        let markers: Vec<_> = history.markers().map(|marker| (marker.number, &*marker.words)).collect();
        assert_eq!(markers, [(2, "wireframe: false → true"), (3, "size: 9 × 6 px")]);
        let runs: Vec<_> = history.runs().into_iter().map(|run| run.points).collect();
        assert_eq!(runs, [vec![[0.0, 4.0], [1.0, 5.0]], vec![[2.0, 6.0]], vec![[3.0, 7.0]]]);
    }

    #[test]
    fn a_new_upscaler_resets_its_options_and_names_only_the_first_ones() {
        let (mut history, mut request) = (FrameHistory::default(), request());
        history.record(&request, 4.0);
        request.recipe.upscaler = Upscaling::new("fsr1", 2).unwrap();
        request.recipe.wireframe = true;
        history.record(&request, 1.0);
        let words = &history.markers().next().expect("settings have changed").words;
        assert!(words.contains("upscaler") && words.contains(" more"), "{words}");
    }

    #[test]
    fn old_frames_are_dropped_with_their_markers() {
        let (mut history, mut request) = (FrameHistory::default(), request());
        history.record(&request, 4.0);
        request.recipe.wireframe = true;
        (0..FRAMES + 1).for_each(|_| history.record(&request, 3.0));
        assert_eq!(history.runs().iter().map(|run| run.points.len()).sum::<usize>(), FRAMES);
        assert_eq!(history.markers().count(), 0);
    }
}
