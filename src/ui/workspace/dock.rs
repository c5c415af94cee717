//! Dockable panels of a workspace, drawn by the docking library.
//!
//! The library divides the space of a container by shares. Here, shares are sizes in points: when the window is
//! resized, panels such as the picture take the difference, and the others keep their size.

use std::collections::BTreeMap;

use eframe::egui::{
    Color32, CursorIcon, Frame, Id, Response, Role, Sense, Stroke, StrokeKind, Style, Ui, UiBuilder, Vec2, Visuals,
    WidgetInfo, WidgetText,
};
use egui_tiles::{Behavior, Container, LinearDir, ResizeState, SimplificationOptions, Tile, TileId, Tiles, Tree};

use super::tree::panels_in;
use crate::pipeline::settings::Choice as _;
use crate::ui::manual::manual_button;
use crate::ui::panels::PanelContext;
use crate::ui::session::command::Command;
use crate::ui::session::layout::{Layout, StoredLayout, StoredLayouts};
use crate::ui::session::workspace::{Panel, Workspace, WorkspaceChange};
use crate::ui::theme::{Icon, space, tokens};
use crate::ui::widgets::icon_button;

/// Width of the gap between panels, in points.
const GAP: f32 = 3.0;

/// Minimum width and height of a panel, in points.
const MIN_SIZE: f32 = 60.0;

/// Minimum size of the growing parts of a container, such as the picture, in points; the others shrink first.
const GROWING_MIN: f32 = 280.0;

/// Largest share of a container that [`GROWING_MIN`] claims, so that a small window keeps room for the other parts.
const GROWING_SHARE: f32 = 0.55;

/// Height of the row with the titles of panels, in points.
const TITLE_HEIGHT: f32 = 26.0;

/// Share of a panel that was moved into a container and has no size yet.
const NEW_SHARE: f32 = 1.0;

/// Layout of one workspace.
struct Dock {
    tree: Tree<Panel>,
    /// Panel that covers the whole workspace; `None` if all panels are laid out.
    maximized: Option<Panel>,
    hides_panels: bool,
}

/// Layouts of all workspaces, and the panels that the last pass drew.
#[derive(Default)]
pub(crate) struct Docks {
    docks: BTreeMap<Workspace, Dock>,
    shown: Vec<Panel>,
    /// Panel that received the keyboard focus last.
    focused: Option<Panel>,
}

impl Docks {
    /// Creates the layouts of all workspaces. A stored layout that lacks a panel of this version is ignored.
    pub(crate) fn new(stored: &StoredLayouts) -> Self {
        let dock = |workspace: Workspace| {
            let default = workspace.default_layout();
            let kept = stored.get(&workspace).filter(|kept| kept.layout.is_rearrangement_of(&default));
            Dock {
                tree: kept.map_or(&default, |kept| &kept.layout).tree(workspace),
                maximized: None,
                hides_panels: kept.map_or(workspace.hides_panels(), |kept| kept.hides_panels),
            }
        };
        Self {
            docks: Workspace::ALL.iter().map(|workspace| (*workspace, dock(*workspace))).collect(),
            ..Self::default()
        }
    }

    /// Returns the layouts to store: those that differ from the default.
    pub(crate) fn stored(&self) -> StoredLayouts {
        let stored = self.docks.iter().filter_map(|(workspace, dock)| {
            let layout = Layout::of(&dock.tree)?;
            let is_default = layout == workspace.default_layout() && dock.hides_panels == workspace.hides_panels();
            (!is_default).then_some((*workspace, StoredLayout { layout, hides_panels: dock.hides_panels }))
        });
        stored.collect()
    }

    /// Whether the last pass drew the panel.
    pub(crate) fn shows(&self, panel: Panel) -> bool {
        self.shown.contains(&panel)
    }

    /// Returns the workspace that shows the panel: `current` if it has the panel, otherwise the first one that has it.
    pub(crate) fn workspace_of(&self, panel: Panel, current: Workspace) -> Workspace {
        let has = |dock: &Dock| dock.tree.tiles.find_pane(&panel).is_some();
        if self.docks.get(&current).is_some_and(has) { current } else { Workspace::of(panel) }
    }

    /// Makes a panel of the workspace visible.
    pub(crate) fn reveal(&mut self, workspace: Workspace, panel: Panel) {
        let Some(dock) = self.docks.get_mut(&workspace) else { return };
        dock.maximized = None;
        dock.hides_panels &= panel.spec().grows;
        dock.tree.make_active(|_, tile| matches!(tile, Tile::Pane(other) if *other == panel));
    }

    /// Maximizes a panel of the workspace, or restores the layout if it is already maximized.
    pub(crate) fn maximize(&mut self, workspace: Workspace, panel: Panel) {
        if let Some(dock) = self.docks.get_mut(&workspace) {
            dock.maximized = (dock.maximized != Some(panel)).then_some(panel);
        }
    }

    /// Hides or shows the panels around the picture, or restores the layout if a panel is maximized.
    pub(crate) fn toggle_panels(&mut self, workspace: Workspace) {
        if let Some(dock) = self.docks.get_mut(&workspace)
            && dock.maximized.take().is_none()
        {
            dock.hides_panels ^= true;
        }
    }

    /// Moves the keyboard focus to the next panel of the last pass, in layout order.
    pub(crate) fn focus_next(&mut self, ui: &Ui) {
        let last = self.focused.and_then(|focused| self.shown.iter().position(|panel| *panel == focused));
        let next = last.map_or(0, |last| (last + 1) % self.shown.len().max(1));
        self.focused = self.shown.get(next).copied();
        if let Some(panel) = self.focused {
            ui.memory_mut(|memory| memory.request_focus(focus_id(panel)));
        }
    }

    /// Restores the default layout of a workspace.
    pub(crate) fn reset(&mut self, workspace: Workspace) {
        let fresh = Self::new(&StoredLayouts::default()).docks.remove(&workspace);
        self.docks.extend(fresh.map(|dock| (workspace, dock)));
    }

    /// Draws the panels of a workspace.
    pub(crate) fn ui(&mut self, ui: &mut Ui, workspace: Workspace, context: PanelContext<'_>) {
        self.shown.clear();
        let Some(dock) = self.docks.get_mut(&workspace) else { return };
        let (maximized, hides_panels) = (dock.maximized, dock.hides_panels);
        let is_visible = |panel: Panel| match maximized {
            Some(only) => panel == only,
            None => !hides_panels || panel.spec().grows,
        };
        let panes: Vec<_> = dock.tree.tiles.iter().filter_map(|(id, tile)| pane(*id, tile)).collect();
        for (id, panel) in &panes {
            dock.tree.set_visible(*id, is_visible(*panel));
        }
        if let Some(root) = dock.tree.root {
            fit(&mut dock.tree.tiles, root, ui.available_size());
        }
        let untitled = panes.iter().filter(|(_, panel)| !panel.spec().titled).map(|(id, _)| *id).collect();
        dock.tree.ui(&mut Drawing { context, shown: &mut self.shown, maximized, untitled }, ui);
    }
}

/// Returns the id of the invisible widget at the start of a panel. From there, the Tab key leads to the widgets of the
/// panel.
fn focus_id(panel: Panel) -> Id {
    Id::unique(("panel", panel.id()))
}

fn pane(id: TileId, tile: &Tile<Panel>) -> Option<(TileId, Panel)> {
    match tile {
        Tile::Pane(panel) => Some((id, *panel)),
        Tile::Container(_) => None,
    }
}

/// Sets the shares in a tile of `size` points to the sizes of its parts, in points. Growing parts take the difference
/// to the previous size.
fn fit(tiles: &mut Tiles<Panel>, id: TileId, size: Vec2) {
    let Some(Tile::Container(container)) = tiles.get(id) else { return };
    let visible = |child: &&TileId| tiles.is_visible_in_layout(**child);
    let children: Vec<TileId> = container.children().filter(visible).copied().collect();
    match container {
        Container::Tabs(_) | Container::Grid(_) => {
            for child in children {
                fit(tiles, child, size - Vec2::new(0.0, TITLE_HEIGHT));
            }
        }
        Container::Linear(linear) => {
            let (dir, is_complete) = (linear.dir, linear.children.len() == children.len());
            let length = match dir {
                LinearDir::Horizontal => size.x,
                LinearDir::Vertical => size.y,
            };
            let room = (length - GAP * children.len().saturating_sub(1) as f32).max(1.0);
            let grows = |child: &TileId| panels_in(tiles, *child).iter().any(|panel| panel.spec().grows);
            let parts: Vec<_> = children.iter().map(|child| (linear.shares[*child], grows(child))).collect();
            let points = sizes(&parts, room);
            // Sizes are kept while parts are hidden.
            if is_complete && let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(id) {
                for (child, points) in children.iter().zip(&points) {
                    linear.shares.set_share(*child, *points);
                }
            }
            for (child, points) in children.into_iter().zip(points) {
                let part = match dir {
                    LinearDir::Horizontal => Vec2::new(points, size.y),
                    LinearDir::Vertical => Vec2::new(size.x, points),
                };
                fit(tiles, child, part);
            }
        }
    }
}

/// Computes the sizes of the parts of a container, in points; their sum is `room`. Each part has its previous size,
/// and whether it grows.
fn sizes(parts: &[(f32, bool)], room: f32) -> Vec<f32> {
    let even = room / parts.len().max(1) as f32;
    let mut sizes: Vec<f32> = parts.iter().map(|(size, _)| if *size <= NEW_SHARE { even } else { *size }).collect();
    let any_grows = parts.iter().any(|(_, grows)| *grows);
    let growing = |index: usize| !any_grows || parts[index].1;
    let fixed: f32 = sizes.iter().enumerate().filter(|(index, _)| !growing(*index)).map(|(_, size)| size).sum();
    let left_for_fixed = room - GROWING_MIN.min(GROWING_SHARE * room);
    if fixed > left_for_fixed {
        let smaller = sizes.iter_mut().enumerate().filter(|(index, _)| !growing(*index));
        smaller.for_each(|(_, size)| *size *= left_for_fixed / fixed);
    }
    let missing = room - sizes.iter().sum::<f32>();
    let total: f32 = sizes.iter().enumerate().filter(|(index, _)| growing(*index)).map(|(_, size)| size).sum();
    for (index, size) in sizes.iter_mut().enumerate() {
        if growing(index) {
            *size = (*size + missing * *size / total.max(1.0)).max(MIN_SIZE.min(even));
        }
    }
    // If growing parts cannot become small enough, all parts shrink.
    let excess = sizes.iter().sum::<f32>() / room;
    if excess > 1.0 {
        sizes.iter_mut().for_each(|size| *size /= excess);
    }
    sizes
}

/// Draws panels on behalf of the docking library.
struct Drawing<'a> {
    context: PanelContext<'a>,
    shown: &'a mut Vec<Panel>,
    maximized: Option<Panel>,
    /// Tiles of the panels that need no title.
    untitled: Vec<TileId>,
}

impl Behavior<Panel> for Drawing<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, panel: &mut Panel) -> egui_tiles::UiResponse {
        self.shown.push(*panel);
        let spec = panel.spec();
        let rect = ui.available_rect_before_wrap();
        ui.painter().rect_filled(rect, 0.0, tokens(ui).panel);
        let start = ui.interact(rect, focus_id(*panel), Sense::focusable_noninteractive());
        start.widget_info(|| WidgetInfo::labeled(Role::Group, true, panel.name()));
        if start.has_focus() {
            let stroke = Stroke::new(2.0, tokens(ui).accent);
            ui.painter().rect_stroke(rect, 0.0, stroke, StrokeKind::Inside);
        }
        // The content is clipped to its panel, and neither grows nor shrinks it.
        let mut within = ui.new_child(UiBuilder::new().id_salt(panel.id()).max_rect(rect));
        within.shrink_clip_rect(rect);
        let Some(controls) = spec.controls else {
            (spec.content)(&mut within, &mut self.context);
            return egui_tiles::UiResponse::None;
        };
        Frame::new().inner_margin(space::S).show(&mut within, |ui| {
            ui.horizontal_wrapped(|ui| controls(ui, &mut self.context));
            ui.add_space(space::XS);
            (spec.content)(ui, &mut self.context);
        });
        egui_tiles::UiResponse::None
    }

    fn tab_title_for_pane(&mut self, panel: &Panel) -> WidgetText {
        panel.name().into()
    }

    fn on_tab_button(&mut self, tiles: &mut Tiles<Panel>, tile: TileId, button: Response) -> Response {
        let Some(panel) = tiles.get_pane(&tile).copied() else { return button };
        if button.double_clicked() {
            self.context.commands.push(Command::Workspace(WorkspaceChange::Maximize(panel)));
        }
        button.on_hover_text(format!("{}. Double-click to maximize, drag to move", panel.help()))
    }

    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<Panel>,
        ui: &mut Ui,
        _tile: TileId,
        tabs: &egui_tiles::Tabs,
        _scroll_offset: &mut f32,
    ) {
        let Some(panel) = tabs.active.and_then(|active| tiles.get_pane(&active)).copied() else { return };
        ui.add_space(space::XS);
        let (icon, name) = if self.maximized == Some(panel) {
            (Icon::Minimize2, format!("Restore the layout around “{}”", panel.name()))
        } else {
            (Icon::Maximize2, format!("Maximize “{}”", panel.name()))
        };
        if icon_button(ui, icon, &name).clicked() {
            self.context.commands.push(Command::Workspace(WorkspaceChange::Maximize(panel)));
        }
        manual_button(ui, panel.spec().chapter, self.context.commands);
    }

    fn tab_hover_cursor_icon(&self) -> CursorIcon {
        CursorIcon::Default
    }

    fn tab_bar_height(&self, _style: &Style) -> f32 {
        TITLE_HEIGHT
    }

    fn gap_width(&self, _style: &Style) -> f32 {
        GAP
    }

    fn min_size(&self) -> f32 {
        MIN_SIZE
    }

    fn simplification_options(&self) -> SimplificationOptions {
        // Every panel keeps its title, which is the handle for moving it.
        SimplificationOptions {
            prune_single_child_tabs: false,
            all_panes_must_have_tabs: true,
            ..SimplificationOptions::default()
        }
    }

    fn is_tab_bar_visible(&self, _tile: TileId, tabs: &egui_tiles::Tabs) -> bool {
        // Panels without a title are alone in their area when they are neither moved nor maximized.
        tabs.children.len() != 1 || !self.untitled.contains(&tabs.children[0])
    }

    fn resize_stroke(&self, style: &Style, state: ResizeState) -> Stroke {
        match state {
            ResizeState::Idle => Stroke::NONE,
            ResizeState::Hovering => style.visuals.widgets.hovered.fg_stroke,
            ResizeState::Dragging => style.visuals.widgets.active.fg_stroke,
        }
    }

    fn tab_bar_color(&self, visuals: &Visuals) -> Color32 {
        visuals.extreme_bg_color
    }

    fn tab_outline_stroke(
        &self,
        _visuals: &Visuals,
        _tiles: &Tiles<Panel>,
        _tile: TileId,
        _state: &egui_tiles::TabState,
    ) -> Stroke {
        Stroke::NONE
    }

    fn tab_bar_hline_stroke(&self, _visuals: &Visuals) -> Stroke {
        Stroke::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growing_parts_take_the_difference() {
        assert_eq!(sizes(&[(232.0, false), (400.0, true), (288.0, false)], 1274.0), [232.0, 754.0, 288.0]);
        assert_eq!(sizes(&[(300.0, true), (100.0, true)], 200.0), [150.0, 60.0].map(|x: f32| x / 1.05));
        assert_eq!(sizes(&[(100.0, false), (300.0, false)], 800.0), [200.0, 600.0]);
        assert_eq!(sizes(&[(300.0, true), (NEW_SHARE, false)], 600.0), [300.0, 300.0]);
        assert_eq!(sizes(&[(400.0, true), (250.0, false)], 480.0), [264.0, 216.0], "the picture keeps its share");
        let narrow = sizes(&[(232.0, false), (400.0, true), (288.0, false)], 300.0);
        assert!((narrow.iter().sum::<f32>() - 300.0).abs() < 1e-3 && narrow.iter().all(|size| *size > 0.0));
    }

    #[test]
    fn stored_layouts_are_restored_and_invalid_ones_ignored() {
        let mut docks = Docks::new(&StoredLayouts::default());
        assert!(docks.stored().is_empty());
        docks.reveal(Workspace::Measure, Panel::Scaling);
        docks.toggle_panels(Workspace::Inspect);
        let mut stored = docks.stored();
        assert_eq!(stored.keys().copied().collect::<Vec<_>>(), [Workspace::Inspect, Workspace::Measure]);
        assert_eq!(Docks::new(&stored).stored(), stored);
        docks.reset(Workspace::Measure);
        docks.toggle_panels(Workspace::Inspect);
        assert!(docks.stored().is_empty());
        for kept in stored.values_mut() {
            kept.layout = Layout::Panel(Panel::Log);
        }
        assert!(Docks::new(&stored).stored().is_empty());
    }
}
