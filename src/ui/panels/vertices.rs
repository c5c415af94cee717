//! The table of vertices: one row per vertex, one group of columns per stage.

use eframe::egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Response, RichText, Role, ScrollArea, Sense, Stroke, Ui, WidgetInfo,
    pos2, vec2,
};

use crate::inspect::vertices::{ObjectVertices, VertexStages, plane_name};
use crate::manual::Chapter;
use crate::ui::format;
use crate::ui::panels::PanelSpec;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::vertices::{VerticesChange, followed, object, picked};
use crate::ui::theme::{Icon, MARK_EDGE, ON_PIXEL, RADIUS, ROW_HEIGHT, font_size, tokens};
use crate::ui::widgets::{copy_button, empty_state};
use crate::ui::zoom::Placement;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::Stages,
    grows: false,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Group of table columns for one stage of the pipeline.
struct ColumnGroup {
    name: &'static str,
    help: &'static str,
    columns: &'static [&'static str],
    /// Width of each column of the group, in points.
    width: f32,
}

/// Width of a column of `f32` values with all significant digits, in points.
const FULL: f32 = 96.0;

const GROUPS: [ColumnGroup; 11] = [
    ColumnGroup { name: "Vertex", help: "Index of the vertex in the mesh", columns: &["number"], width: 58.0 },
    ColumnGroup {
        name: "Model",
        help: "Position in model space, as stored in the mesh",
        columns: &["x", "y", "z"],
        width: FULL,
    },
    ColumnGroup {
        name: "Clip",
        help: "Clip-space position after the model-view-projection matrix, bit for bit as the pipeline computes it",
        columns: &["x", "y", "z", "w"],
        width: FULL,
    },
    ColumnGroup {
        name: "Outcode",
        help: "Planes of the view frustum that the vertex lies beyond; “inside” if none. Side planes clip only where \
               coordinates become too large for the rasterizer",
        columns: &["beyond"],
        width: 92.0,
    },
    ColumnGroup {
        name: "NDC",
        help: "Normalized device coordinates: x and y from −1 to 1 across the picture, z is depth. Empty if w is not \
               positive, because triangles are clipped before the division by w",
        columns: &["x", "y", "z"],
        width: FULL,
    },
    ColumnGroup {
        name: "Screen",
        help: "Position in pixels before snapping, y down",
        columns: &["x px", "y px"],
        width: FULL,
    },
    ColumnGroup {
        name: "Snapped",
        help: "Screen-space position snapped to the grid of 1/256 px on which coverage is computed, in grid steps",
        columns: &["x /256", "y /256"],
        width: 74.0,
    },
    ColumnGroup {
        name: "World",
        help: "World-space position, shown for reference: the pipeline multiplies the matrices first",
        columns: &["x", "y", "z"],
        width: FULL,
    },
    ColumnGroup {
        name: "View",
        help: "View-space position, where the camera looks along −z. Shown for reference: the pipeline multiplies \
               the matrices first",
        columns: &["x", "y", "z"],
        width: FULL,
    },
    ColumnGroup {
        name: "Normal",
        help: "Normal in model space, as stored in the mesh",
        columns: &["x", "y", "z"],
        width: FULL,
    },
    ColumnGroup {
        name: "Attributes",
        help: "Texture coordinates (v down) and vertex colour (sRGB, 0 … 1), if the mesh has any",
        columns: &["u", "v", "red", "green", "blue"],
        width: FULL,
    },
];

/// Space between groups of columns, in points.
const GAP: f32 = 14.0;

/// Maximum number of rows to copy, because clipboards limit the size of their content.
const COPIED_ROWS: u32 = 65_536;

/// Draws the controls of the panel “Vertices”.
fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let whole = session.features.vertices.whole_object;
    for (value, name, help) in [
        (false, "Triangle", "List the three corners of the visible triangle at the picked pixel"),
        (true, "Whole object", "List all vertices of the object that the picked triangle belongs to"),
    ] {
        if ui.selectable_label(whole == value, name).on_hover_text(help).clicked() {
            commands.push(Command::Vertices(VerticesChange::WholeObject(value)));
        }
    }
    let Some((triangle, instance, corners)) = picked(session) else { return };
    let Some(object) = object(session, instance) else { return };
    ui.separator();
    copy_button(ui, "the table", || as_text(&object, &rows(&object, corners, whole)));
    let name = &session.scene.instances.get(instance).map_or("", |instance| &instance.name);
    let text = format!("triangle {} of “{name}”, {} vertices", triangle.0, format::count(object.count() as u64));
    ui.label(RichText::new(text).color(tokens(ui).text_weak));
}

/// Draws the table of vertices.
fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some((_, instance, corners)) = picked(session) else {
        let how = "Pick a pixel that shows a triangle to list its corners, from model space to the pixel grid.";
        empty_state(ui, Icon::Table, "No triangle picked", how);
        return;
    };
    let Some(object) = object(session, instance) else { return };
    let whole = session.features.vertices.whole_object;
    ScrollArea::horizontal().id_salt("vertex columns").auto_shrink(false).show(ui, |ui| {
        let width = GROUPS.iter().map(|group| group.width * group.columns.len() as f32 + GAP).sum();
        ui.set_min_width(width);
        ui.spacing_mut().item_spacing.y = 0.0;
        header(ui, width);
        let count = if whole { object.count() } else { corners.len() };
        let area = ScrollArea::vertical().id_salt("vertex rows").auto_shrink(false);
        area.show_rows(ui, ROW_HEIGHT - 4.0, count, |ui, range| {
            for place in range {
                let index = if whole { place as u32 } else { corners[place] };
                let Some(stages) = object.stages(index) else { continue };
                let marks = Marks {
                    is_selected: session.features.vertices.selected == Some((instance, index)),
                    corner: corners.iter().position(|corner| *corner == index),
                };
                if row(ui, width, &stages, marks).clicked() {
                    let selected = (!marks.is_selected).then_some((instance, index));
                    commands.push(Command::Vertices(VerticesChange::Select(selected)));
                }
            }
        });
    });
}

/// Highlights of a row of the table.
#[derive(Clone, Copy)]
struct Marks {
    is_selected: bool,
    /// Index of the picked triangle's corner at this vertex, 0 to 2; `None` if it is not a corner.
    corner: Option<usize>,
}

fn header(ui: &mut Ui, width: f32) {
    let (rect, _) = ui.allocate_exact_size(vec2(width, 32.0), Sense::hover());
    let small = FontId::proportional(font_size::SMALL);
    let (strong, weak) = (tokens(ui).text_strong, tokens(ui).text_weak);
    let mut left = rect.left();
    for group in &GROUPS {
        let group_width = group.width * group.columns.len() as f32;
        let place = Rect::from_min_size(pos2(left, rect.top()), vec2(group_width, rect.height()));
        ui.painter().text(place.right_top(), Align2::RIGHT_TOP, group.name, small.clone(), strong);
        for (column, name) in group.columns.iter().enumerate() {
            let right = pos2(left + group.width * (column + 1) as f32, rect.bottom() - 2.0);
            ui.painter().text(right, Align2::RIGHT_BOTTOM, name, small.clone(), weak);
        }
        ui.interact(place, ui.scope_id().with(group.name), Sense::hover()).on_hover_text(group.help);
        left += group_width + GAP;
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), (1.0, tokens(ui).border));
}

fn row(ui: &mut Ui, width: f32, stages: &VertexStages, marks: Marks) -> Response {
    let (rect, _) = ui.allocate_exact_size(vec2(width, ROW_HEIGHT - 4.0), Sense::hover());
    let name = format!("Vertex {}", stages.index);
    // Only the visible part is clickable: screen readers click the middle of a widget, which must be visible.
    let seen = rect.intersect(ui.clip_rect());
    let response = ui.interact(seen, ui.scope_id().with(&name), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, marks.is_selected, &name));
    if marks.is_selected {
        ui.painter().rect_filled(rect, RADIUS, tokens(ui).accent_fill);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, RADIUS, tokens(ui).raised);
    }
    let mono = FontId::monospace(font_size::SMALL);
    let mut cells = cells(stages).into_iter();
    let mut left = rect.left();
    for (place, group) in GROUPS.iter().enumerate() {
        for _ in group.columns {
            let Some(cell) = cells.next() else { break };
            left += group.width;
            let at = pos2(left, rect.center().y);
            ui.painter().text(at, Align2::RIGHT_CENTER, &cell.text, mono.clone(), cell.color(ui));
        }
        if let Some(corner) = marks.corner.filter(|_| place == 0) {
            // Same colour as the corner's weight in the inspector.
            let color = crate::ui::theme::WEIGHTS[corner];
            ui.painter().circle_filled(pos2(rect.left() + 5.0, rect.center().y), 3.5, color);
        }
        left += GAP;
    }
    let follow = if marks.is_selected { "Stop following this vertex" } else { "Follow this vertex in the picture" };
    let corner = marks.corner.map_or(String::new(), |corner| format!(" Corner {corner} of the picked triangle."));
    response.on_hover_text(format!("{follow}.{corner}"))
}

/// Cell of the vertex table.
struct TableCell {
    text: String,
    kind: CellKind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum CellKind {
    Plain,
    /// The number is NaN or infinite.
    NotFinite,
    /// The vertex has no value for this column.
    Absent,
    /// The cell lists the frustum planes that the vertex lies outside of.
    Beyond,
}

impl TableCell {
    fn number(value: f64, text: String) -> Self {
        Self { text, kind: if value.is_finite() { CellKind::Plain } else { CellKind::NotFinite } }
    }

    fn absent() -> Self {
        Self { text: "–".to_owned(), kind: CellKind::Absent }
    }

    fn color(&self, ui: &Ui) -> Color32 {
        match self.kind {
            CellKind::Plain => tokens(ui).text,
            CellKind::NotFinite => tokens(ui).error,
            CellKind::Absent => tokens(ui).text_weak,
            CellKind::Beyond => tokens(ui).warning,
        }
    }
}

/// Returns all cells of a vertex's row, in the order of [`GROUPS`].
fn cells(v: &VertexStages) -> Vec<TableCell> {
    let f32s = |values: &[f32]| -> Vec<TableCell> {
        values.iter().map(|value| TableCell::number((*value).into(), format::f32_full(*value))).collect()
    };
    // The pipeline does not compute these values, so the digits of an `f32` suffice.
    let f64s = |values: [f64; 3]| values.map(|value| TableCell::number(value, format::f32_full(value as f32)));
    let absent = |count: usize| (0..count).map(|_| TableCell::absent()).collect::<Vec<_>>();
    let mut cells = vec![TableCell { text: v.index.to_string(), kind: CellKind::Plain }];
    cells.extend(f32s(&v.model.to_array()));
    cells.extend(f32s(&v.clip.to_array()));
    let planes: Vec<_> = v.outcode.planes().map(plane_name).collect();
    cells.push(match planes.is_empty() {
        true => TableCell { text: "inside".to_owned(), kind: CellKind::Plain },
        false => TableCell { text: planes.join(" "), kind: CellKind::Beyond },
    });
    match &v.screen {
        Some(screen) => {
            cells.extend(f32s(&screen.ndc.to_array()));
            cells.extend(f32s(&screen.px));
            cells.extend(
                screen.snapped.map(|steps| TableCell { text: format::fixed(steps.into(), 0), kind: CellKind::Plain }),
            );
        }
        None => cells.extend(absent(7)),
    }
    cells.extend(f64s(v.world.to_array()));
    cells.extend(f64s(v.view.to_array()));
    cells.extend(f32s(&v.normal.to_array()));
    cells.extend(v.uv.map_or_else(|| absent(2), |uv| f32s(&uv.to_array())));
    cells.extend(v.color.map_or_else(|| absent(3), |color| f32s(&color.to_array())));
    cells
}

/// Returns the indices of the vertices to copy: all vertices of the object, or only the three corners.
fn rows(object: &ObjectVertices<'_>, corners: [u32; 3], whole: bool) -> Vec<u32> {
    if whole { (0..(object.count() as u32).min(COPIED_ROWS)).collect() } else { corners.to_vec() }
}

/// Formats the table as text, with tabs between columns.
fn as_text(object: &ObjectVertices<'_>, rows: &[u32]) -> String {
    let names = GROUPS.iter().flat_map(|group| group.columns.iter().map(move |name| format!("{} {name}", group.name)));
    let mut text = names.collect::<Vec<_>>().join("\t") + "\n";
    for stages in rows.iter().filter_map(|index| object.stages(*index)) {
        let cells: Vec<_> = cells(&stages).into_iter().map(|cell| cell.text.replace('−', "-")).collect();
        text += &(cells.join("\t") + "\n");
    }
    text
}

/// Marks the followed vertex on the picture.
pub(crate) fn mark(ui: &Ui, painter: &Painter, placement: Placement, session: &Session) {
    let Some(vertex) = followed(session) else { return };
    let Some(screen) = vertex.screen else { return };
    let [x, y] = screen.px;
    let at = placement.corner + vec2(x, y) * placement.points_per_px;
    if placement.canvas.expand(RING_POINTS).contains(at) {
        ring(ui, painter, at, vertex.index);
    }
}

/// Radius of the ring around a vertex, in points.
const RING_POINTS: f32 = 5.0;

/// Draws a ring around a vertex and its index beside it, visible on any background.
pub(crate) fn ring(ui: &Ui, painter: &Painter, at: Pos2, index: u32) {
    let accent = tokens(ui).accent;
    painter.circle_stroke(at, RING_POINTS, Stroke::new(4.0, MARK_EDGE));
    painter.circle_stroke(at, RING_POINTS, Stroke::new(2.0, accent));
    let galley = painter.layout_no_wrap(format!("v{index}"), FontId::monospace(font_size::SMALL), ON_PIXEL[0]);
    let place = Align2::LEFT_BOTTOM.anchor_size(pos2(at.x + RING_POINTS + 3.0, at.y - RING_POINTS), galley.size());
    painter.rect_filled(place.expand(2.0), 2.0, MARK_EDGE);
    painter.galley(place.min, galley, ON_PIXEL[0]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::Settings;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    #[test]
    fn every_row_fills_every_column_and_reads_back() {
        for id in ["chess", "near-plane", "triangle"] {
            let scene = builtin::by_id(id).unwrap().build();
            let size = Viewport { width: 64, height: 48 };
            let object = ObjectVertices::new(&scene, &scene.home, &Settings::default(), size, 0).unwrap();
            let columns: usize = GROUPS.iter().map(|group| group.columns.len()).sum();
            let text = as_text(&object, &rows(&object, [0, 1, 2], true));
            assert_eq!(text.lines().count(), object.count() + 1);
            for (line, index) in text.lines().skip(1).zip(0..) {
                let cells: Vec<_> = line.split('\t').collect();
                assert_eq!(cells.len(), columns, "{line}");
                let stages = object.stages(index).unwrap();
                let numbers: Vec<f32> = cells[1..8].iter().map(|cell| cell.parse().unwrap()).collect();
                let reported = [&stages.model.to_array()[..], &stages.clip.to_array()[..]].concat();
                assert_eq!(numbers, reported, "{line}");
            }
        }
    }
}
