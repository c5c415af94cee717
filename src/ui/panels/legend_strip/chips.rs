//! Chips of the strip: everything that changes how the picture looks and that can be removed.

use crate::inspect::Buffer;
use crate::inspect::overlays::Overlay;
use crate::inspect::probe::Heat;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::Shown;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::fates::FatesChange;
use crate::ui::session::overlays::OverlayChange;
use crate::ui::session::probe::ProbeChange;

/// Removable part of the picture's appearance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chip {
    /// Quantity that is shown instead of the colour.
    Shown,
    /// Active overlay.
    Overlay(Overlay),
    /// Sample points and edge owners over enlarged pixels.
    Marks,
    /// Heat map of the stability probe.
    Probe,
    /// Selected triangles.
    Selection,
    /// Triangle limit, which the playback changes.
    TriangleLimit,
    /// Mirroring of the scene along z.
    Mirrored,
}

/// Returns the chips of everything that is active, in their order in the strip.
pub(super) fn active(session: &Session) -> Vec<Chip> {
    let layers = session.features.overlays.layers.iter().rev().map(|layer| Chip::Overlay(layer.overlay));
    let single = [Chip::Marks, Chip::Probe, Chip::Selection, Chip::TriangleLimit, Chip::Mirrored];
    [Chip::Shown].into_iter().chain(layers).chain(single).filter(|chip| chip.is_active(session)).collect()
}

impl Chip {
    fn is_active(self, session: &Session) -> bool {
        match self {
            Self::Shown => session.shown != Shown::Buffer(Buffer::Color),
            Self::Overlay(overlay) => session.features.overlays.layer(overlay).is_some(),
            Self::Marks => session.features.overlays.marks,
            Self::Probe => session.view.as_ref().is_some_and(|view| session.features.probing.picture(view).is_some()),
            Self::Selection => !session.selection.is_empty(),
            Self::TriangleLimit => session.features.scrub.triangle_limit.is_some(),
            Self::Mirrored => session.mirrored,
        }
    }

    /// Returns the text of the chip.
    pub(super) fn label(self, session: &Session) -> String {
        match self {
            Self::Shown => session.shown.name().to_owned(),
            Self::Overlay(overlay) => overlay.name().to_owned(),
            Self::Marks => "Sample points and edge owners".to_owned(),
            Self::Probe => {
                let heat = session.features.probing.heat.map(Heat::name).unwrap_or_default();
                format!("Probe: {}", heat.to_lowercase())
            }
            Self::Selection => {
                let count = session.selection.len() as u64;
                let noun = if count == 1 { "triangle" } else { "triangles" };
                format!("{} {noun}: {}", format::count(count), session.selection.label())
            }
            Self::TriangleLimit => {
                let [drawn, all] = [session.moment().triangles, session.triangle_count()];
                format!("First {} of {} triangles", format::count(drawn as u64), format::count(all as u64))
            }
            Self::Mirrored => "Mirrored along z".to_owned(),
        }
    }

    /// Describes the effect on the picture, in one sentence without a full stop.
    pub(super) fn help(self, session: &Session) -> String {
        match self {
            Self::Shown => session.shown.help().trim_end_matches('.').to_owned(),
            Self::Overlay(overlay) => overlay.help().trim_end_matches('.').to_owned(),
            Self::Marks => "Points at every sample, and ticks on each edge that point into the triangle that owns \
                            samples exactly on the edge"
                .to_owned(),
            Self::Probe => {
                let help = session.features.probing.heat.map(Heat::help).unwrap_or_default();
                help.trim_end_matches('.').to_owned()
            }
            Self::Selection => "Pixels that show a selected triangle are unchanged, pixels that hide one are tinted, \
                                all others are dimmed"
                .to_owned(),
            Self::TriangleLimit => "Drawing stops after these triangles. The last one is outlined".to_owned(),
            Self::Mirrored => "z is negated in the scene and in the camera".to_owned(),
        }
    }

    /// Returns the accessible name: the action, followed by what it removes.
    pub(super) fn name(self, session: &Session) -> String {
        format!("{}: {}", self.removal(), self.label(session))
    }

    /// Returns the action of the chip, as an instruction.
    pub(super) fn removal(self) -> &'static str {
        match self {
            Self::Shown => "Show the colour",
            Self::Overlay(_) => "Remove the overlay",
            Self::Marks => "Remove the marks",
            Self::Probe => "Hide the heat map",
            Self::Selection => "Clear the selection",
            Self::TriangleLimit => "Draw all triangles",
            Self::Mirrored => "Mirror the scene back",
        }
    }

    /// Returns the command that removes what the chip stands for.
    pub(super) fn remove(self) -> Command {
        match self {
            Self::Shown => Command::Show(Shown::Buffer(Buffer::Color)),
            Self::Overlay(overlay) => Command::Overlays(OverlayChange::Toggle(overlay)),
            Self::Marks => Command::Overlays(OverlayChange::Marks(false)),
            Self::Probe => Command::Probe(ProbeChange::Show(None)),
            Self::Selection => Command::Fates(FatesChange::Clear),
            Self::TriangleLimit => Command::LimitTriangles(None),
            Self::Mirrored => Command::MirrorZ,
        }
    }
}
