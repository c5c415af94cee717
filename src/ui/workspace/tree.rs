//! Conversion of layouts to and from the trees of the docking library.

use eframe::egui::Id;
use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};

use crate::pipeline::settings::Choice as _;
use crate::ui::session::layout::{Layout, Part};
use crate::ui::session::workspace::{Panel, Workspace};

impl Layout {
    /// Returns the layout as a tree of the docking library. The sizes of parts become shares.
    pub(super) fn tree(&self, workspace: Workspace) -> Tree<Panel> {
        let mut tiles = Tiles::default();
        let root = self.insert(&mut tiles);
        Tree::new(Id::unique(("workspace", workspace.id())), root, tiles)
    }

    fn insert(&self, tiles: &mut Tiles<Panel>) -> TileId {
        match self {
            Self::Panel(panel) => tiles.insert_pane(*panel),
            Self::Tabs { panels, active } => {
                let children: Vec<_> = panels.iter().map(|panel| tiles.insert_pane(*panel)).collect();
                let mut tabs = Tabs::new(children.clone());
                if let Some(child) = children.get(*active) {
                    tabs.set_active(*child);
                }
                tiles.insert_container(tabs)
            }
            Self::Row(parts) => Self::insert_parts(LinearDir::Horizontal, parts, tiles),
            Self::Column(parts) => Self::insert_parts(LinearDir::Vertical, parts, tiles),
        }
    }

    fn insert_parts(dir: LinearDir, parts: &[Part], tiles: &mut Tiles<Panel>) -> TileId {
        let children: Vec<_> = parts.iter().map(|part| part.layout.insert(tiles)).collect();
        let mut linear = Linear::new(dir, children.clone());
        for (child, part) in children.into_iter().zip(parts) {
            linear.shares.set_share(child, part.points);
        }
        tiles.insert_container(linear)
    }

    /// Returns a tree of the docking library as a layout; `None` for an empty tree.
    pub(super) fn of(tree: &Tree<Panel>) -> Option<Self> {
        Self::of_tile(&tree.tiles, tree.root?)
    }

    fn of_tile(tiles: &Tiles<Panel>, id: TileId) -> Option<Self> {
        match tiles.get(id)? {
            Tile::Pane(panel) => Some(Self::Panel(*panel)),
            Tile::Container(Container::Tabs(tabs)) => {
                let panels: Vec<_> = tabs.children.iter().flat_map(|child| panels_in(tiles, *child)).collect();
                let shown = tabs.active.and_then(|active| panels_in(tiles, active).first().copied());
                let active = panels.iter().position(|panel| Some(*panel) == shown).unwrap_or(0);
                // The docking library puts every panel into tabs.
                Some(match panels[..] {
                    [only] if !only.spec().titled => Self::Panel(only),
                    _ => Self::Tabs { panels, active },
                })
            }
            Tile::Container(Container::Linear(linear)) => {
                let part = |child: &TileId| {
                    let layout = Self::of_tile(tiles, *child)?;
                    Some(Part { layout, points: linear.shares[*child].round() })
                };
                let parts = linear.children.iter().filter_map(part).collect();
                Some(match linear.dir {
                    LinearDir::Horizontal => Self::Row(parts),
                    LinearDir::Vertical => Self::Column(parts),
                })
            }
            // No layout contains a grid, and dragging panels creates none.
            Tile::Container(Container::Grid(grid)) => {
                let panels = grid.children().flat_map(|child| panels_in(tiles, *child)).collect();
                Some(Self::Tabs { panels, active: 0 })
            }
        }
    }
}

/// Returns all panels in a tile.
pub(super) fn panels_in(tiles: &Tiles<Panel>, id: TileId) -> Vec<Panel> {
    match tiles.get(id) {
        Some(Tile::Pane(panel)) => vec![*panel],
        Some(Tile::Container(container)) => container.children().flat_map(|child| panels_in(tiles, *child)).collect(),
        None => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_survives_the_docking_library_and_its_text() {
        for workspace in Workspace::ALL.iter().copied() {
            let layout = workspace.default_layout();
            assert_eq!(Layout::of(&layout.tree(workspace)).as_ref(), Some(&layout));
            let text = serde_json::to_string(&layout).unwrap();
            assert_eq!(serde_json::from_str::<Layout>(&text).unwrap(), layout);
            assert!(layout.is_rearrangement_of(&layout));
        }
    }

    #[test]
    fn other_panels_and_sizes_are_not_a_rearrangement() {
        let layout = Workspace::Compare.default_layout();
        let Layout::Row(parts) = &layout else { panic!("{layout:?}") };
        let mut wrong = parts.clone();
        wrong[0].points = f32::NAN;
        assert!(!Layout::Row(wrong).is_rearrangement_of(&layout));
        assert!(!Layout::Row(parts[..1].to_vec()).is_rearrangement_of(&layout));
        let twice = [parts.clone(), parts[..1].to_vec()].concat();
        assert!(!Layout::Row(twice).is_rearrangement_of(&layout));
        let swapped = parts.iter().rev().cloned().collect();
        assert!(Layout::Row(swapped).is_rearrangement_of(&layout));
    }
}
