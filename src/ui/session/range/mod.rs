//! Range control: a histogram, on which the user sets the range of the colour map, and the statistics of a region.
//! Every buffer and stage has its own settings.

pub(crate) mod save;

use crate::inspect::display::{ColorMap, Display, ValueKind};
use crate::inspect::histogram::Histogram;
use crate::inspect::range::{RangeFit, Rule};
use crate::inspect::view::Range;
use crate::measure::region::PixelRegion;
use crate::ui::engine::look::kind;
use crate::ui::engine::{RenderedView, Shown, StatisticsRequest};
use crate::ui::session::Session;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;

/// Display settings of one buffer or stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Setting {
    /// Range, colour map and channels of the buffer or stage.
    pub(crate) display: Display,
    /// Range of the histogram's axis; `None` spans all values.
    pub(crate) axis: Option<Range>,
}

/// State of the range control.
#[derive(Clone, Debug, Default)]
pub(crate) struct RangeControl {
    /// Whether the card with the histogram is open on the canvas.
    pub(crate) open: bool,
    /// Whether the panel “Histogram” is shown. Statistics are computed only then.
    pub(crate) histogram_shown: bool,
    /// Whether histograms show the logarithm of their counts, if the user has chosen.
    log_counts: Option<bool>,
    /// Region of the picture whose statistics are shown separately.
    pub(crate) region: Option<PixelRegion>,
    /// Whether dragging on the canvas selects the region for separate statistics.
    pub(crate) draws_region: bool,
    /// Part of the picture that is visible on the canvas.
    pub(crate) visible: Option<PixelRegion>,
    settings: Vec<(Shown, Setting)>,
}

/// Change to the range control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RangeChange {
    /// Opens or closes the card with the histogram.
    Open(bool),
    /// Records whether the panel “Histogram” is shown.
    HistogramShown(bool),
    /// Sets whether histograms show the logarithm of their counts.
    LogCounts(bool),
    /// Sets the rule that determines the range.
    Rule(Rule),
    /// Fits the range once to the current picture.
    Fit(RangeFit),
    /// Fits the range once to the visible part of the picture.
    FitVisible,
    /// Toggles fitting the range to every new picture.
    ToggleSticky,
    /// Zooms the histogram's axis to the current range of the colour map.
    ZoomAxis,
    /// Resets the range and the histogram's axis.
    Reset,
    /// Sets the colour map; `None` means the default of the shown quantity.
    Map(Option<ColorMap>),
    /// Sets whether the colour map is reversed.
    Reverse(bool),
    /// Sets which channels are visible.
    Channels([bool; 3]),
    /// Shows only the channel with this index, or all channels if it is already the only one shown.
    Solo(usize),
    /// Sets or clears the region whose statistics are shown separately.
    Region(Option<PixelRegion>),
    /// Sets whether dragging on the canvas selects the region for separate statistics.
    DrawRegion(bool),
    /// Records which part of the picture is visible on the canvas.
    Visible(Option<PixelRegion>),
}

impl RangeControl {
    /// Returns the settings of a buffer or stage.
    pub(crate) fn setting(&self, shown: Shown) -> Setting {
        self.settings.iter().find(|(of, _)| *of == shown).map_or(Setting::default(), |(_, setting)| *setting)
    }

    /// Whether these histograms, one per channel, show the logarithm of their counts: as the user has chosen, or by
    /// default if linear bars would hide most values.
    pub(crate) fn uses_log_counts(&self, histograms: &[Histogram]) -> bool {
        self.log_counts.unwrap_or_else(|| histograms.iter().any(|histogram| has_mostly_low_bars(&histogram.bins)))
    }

    /// Returns the statistics to compute for `shown`; `None` if none are needed.
    pub(crate) fn measures(&self, shown: Shown) -> Option<StatisticsRequest> {
        let wanted = (self.open || self.histogram_shown) && kind(shown) != ValueKind::Names;
        // sRGB values range from 0 to 255 in every picture.
        let codes = Range { low: 0.0, high: 255.0 };
        let whole = (kind(shown) == ValueKind::Colors).then_some(codes);
        wanted.then(|| StatisticsRequest { axis: self.setting(shown).axis.or(whole), region: self.region })
    }

    /// Applies a change to the settings of `shown`. Ranges are fitted to `view`, the view on screen.
    pub(crate) fn apply(&mut self, change: RangeChange, shown: Shown, view: Option<&RenderedView>) {
        let mut setting = self.setting(shown);
        let display = &mut setting.display;
        match change {
            RangeChange::Open(open) => self.open = open,
            RangeChange::HistogramShown(open) => self.histogram_shown = open,
            RangeChange::LogCounts(log) => self.log_counts = Some(log),
            RangeChange::Visible(region) => self.visible = region,
            RangeChange::DrawRegion(draws) => self.draws_region = draws,
            RangeChange::Region(region) => {
                (self.region, self.draws_region) = (region, false);
                // Opens the card, because it shows the statistics of the region.
                self.open |= region.is_some();
            }
            RangeChange::Rule(Rule::Fixed(range)) => display.rule = ordered(range).map_or(display.rule, Rule::Fixed),
            RangeChange::Rule(rule) => display.rule = rule,
            RangeChange::Fit(fit) => display.rule = fitted(fit, display, view).unwrap_or(display.rule),
            RangeChange::FitVisible => {
                let fit = self.visible.map_or(RangeFit::All, RangeFit::Within);
                display.rule = fitted(fit, display, view).unwrap_or(display.rule);
            }
            RangeChange::ToggleSticky => {
                let is_sticky = matches!(display.rule, Rule::Sticky(_));
                display.rule = if is_sticky { Rule::Natural } else { Rule::Sticky(RangeFit::All) };
            }
            RangeChange::ZoomAxis => setting.axis = view.and_then(|view| view.range).or(setting.axis),
            RangeChange::Reset => (display.rule, setting.axis) = (Rule::Natural, None),
            RangeChange::Map(map) => display.map = map,
            RangeChange::Reverse(reversed) => display.reversed = reversed,
            RangeChange::Channels(channels) => display.channels = channels,
            RangeChange::Solo(channel) => {
                let alone = [0, 1, 2].map(|i| i == channel);
                display.channels = if display.channels == alone { [true; 3] } else { alone };
            }
        }
        self.store(shown, setting);
    }

    /// Sets the display settings of a buffer or stage.
    pub(crate) fn show_by(&mut self, display: Display, shown: Shown) {
        let setting = Setting { display, ..self.setting(shown) };
        self.store(shown, setting);
    }

    fn store(&mut self, shown: Shown, setting: Setting) {
        self.settings.retain(|(of, _)| *of != shown);
        if setting != Setting::default() {
            self.settings.push((shown, setting));
        }
    }
}

/// Whether at least half of the non-empty bins have less than a hundredth of the highest count, as in pictures of high
/// dynamic range.
fn has_mostly_low_bars(bins: &[u64]) -> bool {
    /// Height of a low bar, as a divisor of the height of the highest one.
    const LOW: u64 = 100;
    let most = bins.iter().copied().max().unwrap_or(0);
    let filled = || bins.iter().filter(|count| **count > 0);
    let low = filled().filter(|count| **count < most.div_ceil(LOW)).count();
    low > 0 && 2 * low >= filled().count()
}

/// Returns the range with its bounds in ascending order; `None` unless both are finite.
fn ordered(Range { low, high }: Range) -> Option<Range> {
    (low.is_finite() && high.is_finite()).then(|| Range { low: low.min(high), high: low.max(high) })
}

/// Returns the rule for a fixed range that is fitted to the view on screen. Returns `None` without a view or without
/// finite values.
fn fitted(fit: RangeFit, display: &Display, view: Option<&RenderedView>) -> Option<Rule> {
    let view = view?;
    let range = fit.range(view.picture.size(), display.channels, |x, y| view.value(x, y))?;
    Some(Rule::Fixed(range))
}

impl Feature for RangeControl {
    type Change = RangeChange;

    fn apply(session: &mut Session, change: RangeChange) -> Option<WindowTask> {
        session.features.range.apply(change, session.shown, session.view.as_ref());
        None
    }

    fn leave_scene(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::Buffer;

    const DEPTH: Shown = Shown::Buffer(Buffer::Depth);

    #[test]
    fn every_buffer_keeps_its_own_settings() {
        let mut control = RangeControl::default();
        let range = Range { low: 0.25, high: 0.5 };
        control.apply(RangeChange::Rule(Rule::Fixed(range)), DEPTH, None);
        control.apply(RangeChange::Solo(1), Shown::Buffer(Buffer::Color), None);
        assert_eq!(control.setting(DEPTH).display.rule, Rule::Fixed(range));
        assert_eq!(control.setting(DEPTH).display.channels, [true; 3]);
        assert_eq!(control.setting(Shown::Buffer(Buffer::Color)).display.channels, [false, true, false]);
        control.apply(RangeChange::Reset, DEPTH, None);
        control.apply(RangeChange::Solo(1), Shown::Buffer(Buffer::Color), None);
        assert!(control.settings.is_empty(), "defaults are not stored");
    }

    #[test]
    fn statistics_are_requested_only_while_they_are_visible() {
        let mut control = RangeControl::default();
        assert_eq!(control.measures(DEPTH), None);
        control.apply(RangeChange::Open(true), DEPTH, None);
        assert!(control.measures(DEPTH).is_some());
        assert_eq!(control.measures(Shown::Buffer(Buffer::TriangleId)), None, "identifiers have no range");
        control.apply(RangeChange::Open(false), DEPTH, None);
        control.apply(RangeChange::HistogramShown(true), DEPTH, None);
        assert!(control.measures(DEPTH).is_some());
    }

    #[test]
    fn counts_are_logarithmic_where_linear_bars_would_hide_most_values() {
        assert!(has_mostly_low_bars(&[50_000, 3, 0, 1, 2, 0, 1]), "a bright sun in a dark picture");
        for bins in [&[900, 700, 20, 400][..], &[50_000, 0, 0], &[1, 1, 0], &[]] {
            assert!(!has_mostly_low_bars(bins), "{bins:?}");
        }
        let mut control = RangeControl::default();
        control.apply(RangeChange::LogCounts(true), DEPTH, None);
        assert!(control.uses_log_counts(&[]), "the choice of the user counts");
    }

    #[test]
    fn a_range_is_finite_and_ascending() {
        let mut control = RangeControl::default();
        control.apply(RangeChange::Rule(Rule::Fixed(Range { low: 2.0, high: 1.0 })), DEPTH, None);
        let ordered = Rule::Fixed(Range { low: 1.0, high: 2.0 });
        assert_eq!(control.setting(DEPTH).display.rule, ordered);
        control.apply(RangeChange::Rule(Rule::Fixed(Range { low: f32::NAN, high: 1.0 })), DEPTH, None);
        assert_eq!(control.setting(DEPTH).display.rule, ordered);
    }

    #[test]
    fn drawing_ends_with_the_region() {
        let mut control = RangeControl { draws_region: true, ..RangeControl::default() };
        let region = PixelRegion { left: 1, top: 2, right: 3, bottom: 4 };
        control.apply(RangeChange::Region(Some(region)), DEPTH, None);
        assert_eq!((control.region, control.draws_region, control.open), (Some(region), false, true));
    }
}
