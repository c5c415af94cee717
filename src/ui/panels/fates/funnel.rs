//! Funnel of fates: a bar for each fate with its count and percentage. The total is at the top, visible triangles or
//! fragments are at the bottom.

use eframe::egui::{Align2, Color32, FontId, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::inspect::fates::{Bin, FragmentFate, TriangleFate};
use crate::pipeline::settings::Choice;
use crate::ui::format;
use crate::ui::session::command::Command;
use crate::ui::session::fates::FatesChange;
use crate::ui::theme::{RADIUS, Tokens, font_size, space, tokens};
use crate::ui::widgets::elided;

/// Height of a row, which holds a bar and its text, in points.
const ROW: f32 = 19.0;

/// Width of the column of counts, in points.
const COUNT: f32 = 52.0;

/// Width of the column of percentages, in points.
const SHARE: f32 = 58.0;

/// Minimum width of the names if there is a column of percentages, in points.
const MIN_NAME: f32 = 80.0;

/// Fate of a triangle or of a fragment. The funnel shows one bar for each fate.
pub(crate) trait BinnedFate: Choice {
    /// Heading of the funnel: plural name of the counted objects.
    const NAME: &str;

    /// Help text of the total count.
    const TOTAL_HELP: &str;

    /// Returns the bin that a click on the bar selects: triangles with this fate or, if it is the fate of a fragment,
    /// triangles with at least one such fragment.
    fn bin(self) -> Bin;

    /// Returns the colour of this fate's bar.
    fn color(self, tokens: &Tokens) -> Color32;
}

impl BinnedFate for TriangleFate {
    const NAME: &str = "Triangles";
    const TOTAL_HELP: &str = "Every triangle of the scene has exactly one of these fates";

    fn bin(self) -> Bin {
        Bin::Triangles(self)
    }

    fn color(self, tokens: &Tokens) -> Color32 {
        match self {
            Self::Visible | Self::BlendedOver => tokens.passed,
            Self::Overwritten => tokens.warning,
            Self::NotFinite | Self::Unaccounted => tokens.error,
            Self::LostDepth | Self::AlphaRejected | Self::NoCentre => tokens.rejected,
            Self::Outside | Self::ClippedAway | Self::ZeroArea | Self::BackFacing | Self::FrontFacing => {
                tokens.text_weak
            }
        }
    }
}

impl BinnedFate for FragmentFate {
    const NAME: &str = "Fragments";
    const TOTAL_HELP: &str = "Every sample that a triangle covers has exactly one of these fates";

    fn bin(self) -> Bin {
        Bin::Fragments(self)
    }

    fn color(self, tokens: &Tokens) -> Color32 {
        match self {
            Self::Visible | Self::BlendedOver => tokens.passed,
            Self::Overwritten => tokens.warning,
            Self::LostDepth | Self::AlphaRejected => tokens.rejected,
        }
    }
}

/// Draws the total count, and below it the bars of all fates that occur.
pub(crate) fn ui<E: BinnedFate>(
    ui: &mut Ui,
    chosen: Option<Bin>,
    count: impl Fn(E) -> u64,
    commands: &mut Vec<Command>,
) {
    let what = E::NAME;
    let sum: u64 = E::ALL.iter().map(|ending| count(*ending)).sum();
    let weak = tokens(ui).text_weak;
    let (head, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let small = FontId::proportional(font_size::SMALL);
    ui.painter().text(head.left_center(), Align2::LEFT_CENTER, what, small, weak);
    let total = format::count(sum);
    ui.painter().text(head.right_center(), Align2::RIGHT_CENTER, &total, FontId::monospace(font_size::SMALL), weak);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{what} {total}")));
    response.on_hover_text(E::TOTAL_HELP);
    for ending in E::ALL.iter().copied().filter(|ending| count(*ending) > 0) {
        if bar(ui, ending, count(ending), sum, chosen == Some(ending.bin())) {
            commands.push(Command::Fates(FatesChange::Bin(ending.bin())));
        }
    }
}

/// Draws the bar of a fate that `count` of `sum` triangles or fragments have, with its text over it. Returns whether it
/// was clicked.
fn bar<E: BinnedFate>(ui: &mut Ui, ending: E, count: u64, sum: u64, chosen: bool) -> bool {
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let share = count as f64 / sum.max(1) as f64;
    let name = ending.name();
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, format!("{name}: {count}")));
    let fill = match (chosen, response.hovered()) {
        (true, _) => tokens(ui).accent_fill,
        (false, true) => tokens(ui).raised,
        (false, false) => Color32::TRANSPARENT,
    };
    let painter = ui.painter_at(row);
    painter.rect_filled(row, RADIUS, fill);
    // A minimum width keeps every non-empty bin visible.
    const MIN_POINTS: f32 = 2.0;
    const OPACITY: f32 = 0.42;
    let width = (row.width() * share as f32).max(MIN_POINTS);
    let bar = Rect::from_min_size(row.min, vec2(width, row.height())).shrink2(vec2(0.0, 1.0));
    painter.rect_filled(bar, 2.0, ending.color(tokens(ui)).gamma_multiply(OPACITY));
    let text = tokens(ui).text_strong;
    let body = FontId::proportional(font_size::BODY);
    // A narrow panel has room for the names, but not for the percentages, which the bars show, too.
    let share_width = if row.width() >= MIN_NAME + COUNT + SHARE { SHARE } else { space::XS };
    let words = elided(ui, name, body, text, row.width() - share_width - COUNT);
    painter.galley(pos2(row.left() + space::XS, row.center().y - words.size().y / 2.0), words, text);
    let mono = FontId::monospace(font_size::SMALL);
    let at = |from_right: f32| row.right_center() - vec2(from_right, 0.0);
    if share_width == SHARE {
        painter.text(at(space::XS), Align2::RIGHT_CENTER, format::percent(share), mono.clone(), tokens(ui).text);
    }
    painter.text(at(share_width), Align2::RIGHT_CENTER, format::count(count), mono, text);
    let click = if chosen {
        "Click to clear the selection."
    } else {
        "Click to select the triangles with this fate in the picture."
    };
    response.on_hover_text(format!("{} {click}", ending.help())).clicked()
}
