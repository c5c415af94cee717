//! Recorded frame times of each upscaler: recent frames, the slowest frames, and the last measurement of all upscalers.
//! Recent and slowest frames are discarded when the scene, the settings or the size changes, so that times of different
//! pictures are never mixed.

pub(crate) mod budget;

pub(crate) mod history;

mod list;

pub(crate) mod request;

mod tradeoff;

pub(crate) mod window_times;

pub(crate) use list::MethodList;
pub(crate) use list::RowOrder;
pub(crate) use list::TimingsChange;
pub(crate) use tradeoff::TradeOff;

use std::collections::{BTreeMap, VecDeque};

use self::budget::BudgetWinner;
use self::history::FrameHistory;
use self::window_times::WindowTimes;
use crate::chain::Recipe;
use crate::measure::metric::Metric;
use crate::measure::motion::Turn;
use crate::measure::noise::Noise;
use crate::measure::other_programs::DISTURBING_SHARE;
use crate::measure::timing::summarize;
use crate::ui::engine::{Look, Request};
use crate::ui::session::Session;
use crate::ui::session::feature::Feature;
use crate::ui::session::save_item::SaveItem;
use crate::ui::session::window_task::WindowTask;
use crate::upscale::Upscaling;
use request::{MeasureRequest, MethodError};

/// Maximum number of recent frames stored for each upscaler.
const RECENT: usize = 240;

/// Maximum number of slowest frames stored, regardless of their age.
const SLOWEST: usize = 5;

/// Kind of plot of frame times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum TimingsView {
    /// Frame time of each frame, in drawing order.
    #[default]
    Lines,
    /// Cumulative distribution: the fraction of frames that took at most a given time.
    Distribution,
    /// Frames drawn for the window, across changes of settings.
    History,
}

/// All recorded frame times, in milliseconds.
#[derive(Debug)]
pub(crate) struct Timings {
    /// Plot that the panel shows.
    pub(crate) view: TimingsView,
    /// Whether recording of recent frames is paused.
    pub(crate) paused: bool,
    /// Whether measurements start by themselves while the panel is open and the machine is idle.
    pub(crate) automatic: bool,
    /// Order, filter and check marks of the rows, method under the pointer, and time budget.
    pub(crate) list: MethodList,
    /// Frames drawn for the window, across changes of settings.
    pub(crate) history: FrameHistory,
    recent: BTreeMap<Upscaling, VecDeque<f64>>,
    slowest: Vec<(Upscaling, f64)>,
    recent_request: Option<Request>,
    /// Camera motion over the frames of the next measurement.
    pub(crate) turn: Turn,
    /// Metric that the user chose to rank the upscalers.
    pub(crate) metric: Metric,
    measured: BTreeMap<Upscaling, Vec<f64>>,
    errors: BTreeMap<Upscaling, MethodError>,
    /// Time in milliseconds of the first frame whose error was measured, for each upscaler.
    first_ms: BTreeMap<Upscaling, f64>,
    noise: Option<Noise>,
    measurement_request: Option<MeasureRequest>,
    /// Largest share of the processors that other programs used during the measurement; `None` if unknown.
    others_share: Option<f64>,
    /// Time spent in the user interface itself, for each of the most recent frames of the window.
    pub(crate) window: WindowTimes,
}

impl Default for Timings {
    fn default() -> Self {
        Self {
            view: TimingsView::default(),
            paused: false,
            automatic: true,
            list: MethodList::default(),
            history: FrameHistory::default(),
            recent: BTreeMap::new(),
            slowest: Vec::new(),
            recent_request: None,
            turn: Turn::default(),
            metric: Metric::Flip,
            measured: BTreeMap::new(),
            errors: BTreeMap::new(),
            first_ms: BTreeMap::new(),
            noise: None,
            measurement_request: None,
            others_share: None,
            window: WindowTimes::default(),
        }
    }
}

impl Timings {
    /// Adds the time of a frame that was drawn for `request`, unless recording is paused. A new scene, recipe or size
    /// discards the recent frames; a new camera or upscaler does not.
    pub(crate) fn record_recent(&mut self, request: &Request, milliseconds: f64) {
        if self.paused {
            return;
        }
        self.history.record(request, milliseconds);
        let goes_on = self.recent_request.as_ref().is_some_and(|old| {
            std::sync::Arc::ptr_eq(&old.scene, &request.scene)
                && Recipe { upscaler: request.recipe.upscaler, ..old.recipe } == request.recipe
                && old.viewport == request.viewport
        });
        if !goes_on {
            self.recent.clear();
            self.slowest.clear();
            self.recent_request = Some(request.clone());
        }
        let recent = self.recent.entry(request.recipe.upscaler).or_default();
        if recent.len() == RECENT {
            recent.pop_front();
        }
        recent.push_back(milliseconds);
        self.slowest.push((request.recipe.upscaler, milliseconds));
        self.slowest.sort_by(|a, b| b.1.total_cmp(&a.1));
        self.slowest.truncate(SLOWEST);
    }

    /// Returns the median time of the recent frames of an upscaler, in milliseconds. Excludes the first frame, which
    /// was drawn with cold caches and buffers; `None` if there is no other frame.
    pub(crate) fn warm_median_ms(&self, upscaling: Upscaling) -> Option<f64> {
        let times: Vec<f64> = self.recent.get(&upscaling)?.iter().skip(1).copied().collect();
        Some(summarize(&times)?.median)
    }

    /// Returns the slowest frames with their upscalers, slowest first. They may be older than the plotted frames.
    pub(crate) fn slowest(&self) -> &[(Upscaling, f64)] {
        &self.slowest
    }

    /// Returns every recorded frame time as comma-separated values, one line per frame, with scene, size and upscaler.
    pub(crate) fn csv(&self) -> String {
        let mut text = "scene,width,height,what,upscaler,frame,ms\n".to_owned();
        let recent = ("recent", self.recent_request.as_ref(), per_method(&self.recent));
        let measured =
            ("measured", self.measurement_request.as_ref().map(|measured| &measured.of), per_method(&self.measured));
        for (what, of, series) in [recent, measured] {
            let Some(request) = of else { continue };
            let scene = request.scene.name.replace('"', "\"\"");
            let (width, height) = (request.viewport.width, request.viewport.height);
            for (upscaling, times) in series {
                for (frame, ms) in times.iter().enumerate() {
                    text += &format!("\"{scene}\",{width},{height},{what},\"{}\",{frame},{ms}\n", upscaling.label());
                }
            }
        }
        text
    }

    /// Starts a measurement of all upscalers, discarding the previous one.
    pub(crate) fn begin_measurement(&mut self, request: MeasureRequest) {
        self.measured.clear();
        self.errors.clear();
        self.first_ms.clear();
        (self.noise, self.others_share) = (None, None);
        self.measurement_request = Some(request);
    }

    /// Adds a frame time to the measurement, in milliseconds.
    pub(crate) fn record_measured(&mut self, upscaling: Upscaling, milliseconds: f64) {
        if self.measurement_request.is_some() {
            self.measured.entry(upscaling).or_default().push(milliseconds);
        }
    }

    /// Records the error of an upscaler over the frames measured so far, and the time of the last one in milliseconds. The
    /// time of the first frame is provisional until the first round is complete.
    pub(crate) fn record_error(&mut self, upscaling: Upscaling, error: MethodError, milliseconds: f64) {
        if self.measurement_request.is_some() {
            self.errors.insert(upscaling, error);
            self.first_ms.entry(upscaling).or_insert(milliseconds);
        }
    }

    /// Records the noise floor of the frame times in the completed rounds.
    pub(crate) fn record_noise(&mut self, noise: Noise) {
        if self.measurement_request.is_some() {
            self.noise = Some(noise);
        }
    }

    /// Records the share of all processors that other programs use during the measurement, in [0, 1].
    pub(crate) fn record_others(&mut self, share: f64) {
        self.others_share = Some(self.others_share.map_or(share, |before| before.max(share)));
    }

    /// Returns the largest share of all processors that other programs used during the measurement, in [0, 1]; `None` if
    /// it was too small to disturb the measurement, or is unknown.
    pub(crate) fn disturbance(&self) -> Option<f64> {
        self.others_share.filter(|share| *share > DISTURBING_SHARE)
    }

    /// Returns the noise floor of the measurement; `None` before the first round is complete.
    pub(crate) fn noise(&self) -> Option<Noise> {
        self.noise
    }

    /// Whether the measured times of an upscaler and of native rendering differ by no more than the noise.
    pub(crate) fn is_within_noise_of_native(&self, upscaling: Upscaling) -> bool {
        let median = |u| summarize(self.measured.get(&u)?).map(|summary| summary.median);
        let times = self.noise.zip(median(Upscaling::NATIVE)).zip(median(upscaling));
        !upscaling.is_native() && times.is_some_and(|((noise, native), own)| noise.covers(native, own))
    }

    /// Returns the time budget in milliseconds: the one that the user has set, or about half of the median time of
    /// native rendering.
    pub(crate) fn budget_ms(&self) -> f64 {
        let default_ms = || self.native_median_ms().map_or(budget::FALLBACK_MS, budget::default_ms);
        self.list.budget_ms.unwrap_or_else(default_ms)
    }

    /// Returns the method with the lowest error within the time budget, among those that are ranked.
    pub(crate) fn budget_winner(&self) -> BudgetWinner {
        let points = if self.noise.is_some() { self.tradeoff() } else { Vec::new() };
        BudgetWinner::of(&points, self.budget_ms())
    }

    /// Returns the median frame time of native rendering in milliseconds: the measured one if there is a measurement,
    /// otherwise that of the recent frames.
    fn native_median_ms(&self) -> Option<f64> {
        let native = Upscaling::NATIVE;
        let summary = if self.has_measurement() {
            summarize(self.measured.get(&native)?)
        } else {
            summarize(&self.recent.get(&native)?.iter().copied().collect::<Vec<_>>())
        };
        Some(summary?.median)
    }

    /// Returns the measured error of an upscaler; `None` before it is measured.
    pub(crate) fn error(&self, upscaling: Upscaling) -> Option<MethodError> {
        self.errors.get(&upscaling).copied()
    }

    /// Discards all recorded times.
    pub(crate) fn clear(&mut self) {
        let Self { view, paused, automatic, turn, metric, list, window, .. } = std::mem::take(self);
        *self = Self { view, paused, automatic, turn, metric, list, window, ..Self::default() };
    }

    /// Whether there is a running or complete measurement to show.
    pub(crate) fn has_measurement(&self) -> bool {
        !self.measured.is_empty()
    }

    /// Returns the request of the measurement; `None` without a measurement.
    pub(crate) fn measurement_request(&self) -> Option<&MeasureRequest> {
        self.measurement_request.as_ref()
    }

    /// Whether the measurement used the scene, camera and size of `request`, and the same recipe except for the
    /// upscaler.
    pub(crate) fn measurement_fits(&self, request: &Request) -> bool {
        let upscaler = Upscaling::NATIVE;
        let plain = |r: &Request| Request {
            recipe: Recipe { upscaler, ..r.recipe },
            shown: request.shown,
            pick: None,
            triangle_limit: None,
            look: Look::default(),
            fragment_limit: None,
            ..r.clone()
        };
        self.measurement_request.as_ref().is_some_and(|measured| plain(&measured.of).same_view(&plain(request)))
    }

    /// Returns the median frame time of an upscaler in milliseconds. Returns `None` unless it was measured with the view
    /// of `request`.
    pub(crate) fn median_ms(&self, request: &Request, upscaling: Upscaling) -> Option<f64> {
        let fits = self.measurement_fits(request);
        Some(summarize(self.measured.get(&upscaling).filter(|_| fits)?)?.median)
    }

    /// Returns the median frame time of an upscaler divided by that of native rendering. Returns `None` unless both
    /// were measured with the view of `request`.
    pub(crate) fn share_of_native(&self, request: &Request, upscaling: Upscaling) -> Option<f64> {
        Some(self.median_ms(request, upscaling)? / self.median_ms(request, Upscaling::NATIVE)?)
    }

    /// Returns the frame times of each upscaler in milliseconds, oldest first: from the measurement if there is one,
    /// otherwise from the recent frames.
    pub(crate) fn series(&self) -> Vec<(Upscaling, Vec<f64>)> {
        if self.has_measurement() { per_method(&self.measured) } else { per_method(&self.recent) }
    }
}

impl Feature for Timings {
    type Change = TimingsChange;

    fn apply(session: &mut Session, change: TimingsChange) -> Option<WindowTask> {
        let timings = &mut session.features.timings;
        match change {
            TimingsChange::View(view) => timings.view = view,
            TimingsChange::Automatic(automatic) => timings.automatic = automatic,
            TimingsChange::Order(order) => timings.list.order = order,
            TimingsChange::ToggleScale(scale) => timings.list.toggle_scale(scale),
            TimingsChange::ToggleChecked(upscaling) => timings.list.toggle_checked(upscaling),
            TimingsChange::Hover(tab, upscaling) => timings.list.set_hovered(tab, upscaling),
            TimingsChange::Budget(ms) => timings.list.budget_ms = Some(budget::rounded(ms)),
            TimingsChange::Turn(turn) => timings.turn = turn,
            TimingsChange::Metric(metric) => timings.metric = metric,
            TimingsChange::TogglePaused => timings.paused ^= true,
            TimingsChange::Export => return Some(WindowTask::Save(SaveItem::FrameTimes)),
            TimingsChange::Clear => {
                timings.clear();
                return Some(WindowTask::DeclineMeasurement);
            }
        }
        None
    }

    fn leave_scene(&mut self) {
        self.clear();
    }
}

/// Copies the frame times of every upscaler into a list, oldest first.
fn per_method<T>(times: &BTreeMap<Upscaling, T>) -> Vec<(Upscaling, Vec<f64>)>
where
    for<'a> &'a T: IntoIterator<Item = &'a f64>,
{
    times.iter().map(|(upscaling, times)| (*upscaling, times.into_iter().copied().collect())).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::inspect::Buffer;
    use crate::measure::against::figures;
    use crate::measure::motion::MotionError;
    use crate::measure::reference::Reference;
    use crate::pipeline::viewport::Viewport;
    use crate::report::upscaling::tradeoff::Standing;
    use crate::scene::SceneSource;
    use crate::ui::engine::Shown;

    /// Returns a request for a small picture of the scene “triangle”.
    pub(super) fn request() -> Request {
        let scene = SceneSource::named("triangle".into()).load().unwrap().scene;
        Request {
            camera: scene.home,
            scene: Arc::new(scene),
            sequence: None,
            is_replayed: false,
            recipe: Recipe::default(),
            viewport: Viewport { width: 8, height: 6 },
            shown: Shown::Buffer(Buffer::Color),
            triangle_limit: None,
            fragment_limit: None,
            pick: None,
            look: Look::default(),
        }
    }

    fn measurement(of: Request) -> MeasureRequest {
        let (reference, metric) = (Reference::Native, Metric::Flip);
        MeasureRequest { number: 1, of, reference, turn: Turn::default(), metric }
    }

    #[test]
    fn upscalers_are_ranked_by_error_in_motion_and_by_times_above_noise() {
        let mut timings = Timings::default();
        timings.begin_measurement(measurement(request()));
        let black = crate::image::Image::filled(8, 8, [0, 0, 0, 255]);
        let error = |still: u8, moving: u8| {
            let of = |code| figures(&crate::image::Image::filled(8, 8, [code, code, code, 255]), &black).unwrap().0;
            MethodError { still: of(still), motion: MotionError::of(&[of(moving)]).unwrap() }
        };
        let [temporal, nearest] =
            [("checkerboard-temporal", 1), ("nearest", 2)].map(|(id, scale)| Upscaling::new(id, scale).unwrap());
        for (upscaling, ms, error) in
            [(Upscaling::NATIVE, 4.0, error(0, 0)), (temporal, 3.0, error(0, 200)), (nearest, 3.01, error(40, 40))]
        {
            timings.record_measured(upscaling, ms);
            timings.record_error(upscaling, error, 2.0 * ms);
        }
        let provisional = timings.tradeoff();
        assert!(provisional.iter().all(|point| point.standing.is_none() && point.ms.n == 1), "no noise floor yet");
        assert_eq!(provisional.len(), 3);
        assert_eq!(timings.budget_winner(), BudgetWinner::NoErrors);
        timings.record_noise(Noise { pairs: 25, p90: 0.02 });
        let standing = |timings: &Timings, upscaling| {
            timings.tradeoff().into_iter().find(|point| point.upscaling == upscaling)?.standing
        };
        assert_eq!(standing(&timings, temporal), Some(Standing::WithinNoise(nearest)));
        assert_eq!(standing(&timings, nearest), Some(Standing::Front));
        assert_eq!(standing(&timings, Upscaling::NATIVE), Some(Standing::Front));
        assert!(!timings.is_within_noise_of_native(nearest));
        timings.record_noise(Noise { pairs: 25, p90: 0.001 });
        assert_eq!(standing(&timings, temporal), Some(Standing::Front));
        // SSIM against black is smaller for the brighter picture, too; a metric that was not measured is not used.
        timings.metric = Metric::Ssim;
        assert!(timings.tradeoff().iter().all(|point| point.metric == Metric::Ssim && point.mean() <= 1.0));
        timings.metric = Metric::Ssimulacra2;
        assert_eq!(timings.metric_in_use(), Metric::Flip);
        timings.record_noise(Noise { pairs: 25, p90: 0.5 });
        assert!(timings.is_within_noise_of_native(nearest) && !timings.is_within_noise_of_native(Upscaling::NATIVE));
        timings.begin_measurement(measurement(request()));
        assert_eq!(timings.noise(), None);
    }

    #[test]
    fn the_first_frame_does_not_count_as_warm() {
        let mut timings = Timings::default();
        let request = request();
        let native = request.recipe.upscaler;
        timings.record_recent(&request, 90.0);
        assert_eq!(timings.warm_median_ms(native), None);
        for ms in [3.0, 5.0, 4.0] {
            timings.record_recent(&request, ms);
        }
        assert_eq!(timings.warm_median_ms(native), Some(4.0));
    }

    #[test]
    fn each_upscaler_has_a_line_until_something_else_changes() {
        let (mut timings, native) = (Timings::default(), request());
        let nearest = Upscaling::new("nearest", 4).unwrap();
        let mut other = native.clone();
        other.recipe.upscaler = nearest;
        timings.record_recent(&native, 4.0);
        timings.record_recent(&other, 1.0);
        timings.record_recent(&native, 5.0);
        assert_eq!(timings.series(), [(Upscaling::NATIVE, vec![4.0, 5.0]), (nearest, vec![1.0])]);
        other.recipe.wireframe = true;
        timings.record_recent(&other, 2.0);
        assert_eq!(timings.series(), [(nearest, vec![2.0])]);
    }

    #[test]
    fn slowest_frames_outlive_their_line_and_a_pause_records_nothing() {
        let (mut timings, request) = (Timings::default(), request());
        timings.record_recent(&request, 90.0);
        for _ in 0..2 * RECENT {
            timings.record_recent(&request, 3.0);
        }
        assert_eq!(timings.series()[0].1, vec![3.0; RECENT]);
        assert_eq!((timings.slowest().len(), timings.slowest()[0].1), (SLOWEST, 90.0));
        timings.paused = true;
        timings.record_recent(&request, 7.0);
        assert!(!timings.series()[0].1.contains(&7.0));
    }

    #[test]
    fn csv_has_a_line_for_each_frame() {
        let (mut timings, request) = (Timings::default(), request());
        assert_eq!(timings.csv().lines().count(), 1);
        timings.record_recent(&request, 4.25);
        let recent = format!("\"{}\",8,6,recent,\"Native\",0,4.25", request.scene.name);
        assert_eq!(timings.csv().lines().nth(1), Some(&*recent));
        timings.begin_measurement(measurement(request));
        timings.record_measured(Upscaling::NATIVE, 1.5);
        assert_eq!(timings.csv().lines().nth(1), Some(&*recent), "a measurement keeps the recent frames");
        assert!(timings.csv().ends_with("measured,\"Native\",0,1.5\n"));
    }
}
