//! Trace from the mesh to clip space and through clipping, for the corners of one triangle.

use glam::{DMat4, DVec4, Vec4};

use super::formula::{Formula, given, sum, whole};
use super::inputs::{FormulaInputs, vector};
use super::line::{Notable, TraceRecorder, TraceStage};
use super::names::AXES;
use super::subject::TracedFragment;
use crate::pipeline::clip::{Cut, EdgeCut, Polygon, guard_band_widening};
use crate::pipeline::clip_space::{ClipPlane, ClipVertex, MIN_W};
use crate::pipeline::plan::{PipelinePart, PlanStep};
use crate::pipeline::shading::{Input, LightInputs as _, lambert};
use crate::pipeline::vertex::DrawMatrices;

/// A vertex in clip space, and its name in trace lines.
#[derive(Clone, Debug)]
pub(super) struct NamedVertex {
    pub(super) name: String,
    pub(super) vertex: ClipVertex,
}

/// Writes the trace lines from model space to clipping. Returns the corners of the fragment's triangle, or of its piece
/// after clipping, in clip space. Returns no corners if no piece matches the fragment, which cannot happen if the frame
/// belongs to the scene.
pub(super) fn write(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) -> Vec<NamedVertex> {
    scribe.enter(TraceStage::Model);
    model(subject, scribe);
    scribe.enter(TraceStage::Transform);
    let matrices = subject.matrices();
    matrix(subject, &matrices, scribe);
    asides(subject, scribe);
    let transformer = subject.transformer(&matrices);
    let corners: Vec<NamedVertex> = (0..3)
        .map(|corner| {
            let mut vertex = transformer.vertex(subject.corners[corner]);
            vertex.varyings.source_weights[corner] = 1.0;
            NamedVertex { name: format!("corner {corner}"), vertex }
        })
        .collect();
    for (named, place) in corners.iter().zip(subject.corners) {
        clip_position(subject, &matrices, place, named, scribe);
    }
    if subject.runs(PipelinePart::Normals) {
        for (named, place) in corners.iter().zip(subject.corners) {
            normal(subject, &matrices, place, named, scribe);
        }
    }
    scribe.enter(TraceStage::Clip);
    clip(subject, corners, scribe)
}

fn model(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    let mesh = subject.mesh;
    for (corner, vertex) in subject.corners.into_iter().enumerate() {
        let mut read = |what: &str, values: &[f32]| {
            for (axis, value) in values.iter().enumerate() {
                let name =
                    if what == "position" { AXES[axis].to_owned() } else { format!("{what} {}", part(what, axis)) };
                scribe.read(format!("corner {corner} · {name}"), format!("vertex {vertex} of the mesh"), *value);
            }
        };
        read("position", &mesh.positions[vertex].to_array());
        if subject.runs(PipelinePart::Normals) {
            read("normal", &mesh.normals[vertex].to_array());
        }
        if subject.runs(PipelinePart::TextureCoordinates) {
            read("texture", &mesh.uvs[vertex].to_array());
        }
        if subject.runs(PipelinePart::VertexColors) {
            read("colour", &mesh.colors[vertex].to_array());
        }
        if let Some([scale, offset]) =
            subject.plan.uv_transform().filter(|_| subject.runs(PipelinePart::TextureCoordinates))
        {
            let (uv, moved) = (mesh.uvs[vertex], mesh.uvs[vertex] * scale + offset);
            for axis in 0..2 {
                let name = ["u", "v"][axis];
                let formula = given(name, uv[axis]) * given("scale", scale[axis]) + given("offset", offset[axis]);
                scribe.compute(format!("corner {corner} · {name} of the material"), moved[axis], &formula);
            }
        }
    }
}

fn part(what: &str, axis: usize) -> &'static str {
    match what {
        "texture" => ["u", "v"][axis],
        "colour" => ["r", "g", "b"][axis],
        _ => AXES[axis],
    }
}

/// Writes the entries of the clip-from-model matrix, each rounded once from an f64 product.
fn matrix(subject: &TracedFragment<'_>, matrices: &DrawMatrices, scribe: &mut TraceRecorder) {
    let mapping = subject.settings.depth_format.mapping();
    let product =
        DrawMatrices::product(subject.instance, subject.camera.clip_from_world_f64(subject.raster.aspect(), mapping));
    for row in 0..4 {
        for column in 0..4 {
            let unrounded = given("(projection × view × model) in f64", product.col(column)[row]);
            let value = matrices.clip_from_model.col(column)[row];
            scribe.compute(entry(row, column), value, &unrounded);
        }
    }
}

/// Returns the name of a matrix entry, such as "m03".
fn entry(row: usize, column: usize) -> String {
    format!("m{row}{column}")
}

/// Writes the corners in world and view space. The pipeline never computes them, because it multiplies the matrices
/// first.
fn asides(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    let (model, view) = (subject.instance.world_from_model.as_dmat4(), subject.camera.view_from_world_f64());
    for (corner, vertex) in subject.corners.into_iter().enumerate() {
        let position = subject.mesh.positions[vertex].as_dvec3().extend(1.0);
        let world = transformed(&model, position, &format!("corner {corner} · world"), scribe);
        transformed(&view, world, &format!("corner {corner} · view"), scribe);
    }
}

/// Transforms a point by a matrix, and writes the components of the result as explanatory lines.
fn transformed(matrix: &DMat4, point: DVec4, what: &str, scribe: &mut TraceRecorder) -> DVec4 {
    let result = *matrix * point;
    for row in 0..3 {
        let formula =
            product_of(|column| matrix.col(column)[row].into(), point.truncate().to_array().map(Into::into), row);
        scribe.aside(format!("{what} {}", AXES[row]), result[row], &formula);
    }
    result
}

/// Returns the formula for the product of a matrix row and a point.
fn product_of(entries: impl Fn(usize) -> super::Number, point: [super::Number; 3], row: usize) -> Formula {
    let term = |column: usize| given(entry(row, column), entries(column)) * given(AXES[column], point[column]);
    sum((0..3).map(term)) + given(entry(row, 3), entries(3))
}

/// Writes a vertex in clip space. `place` is its index in the mesh.
fn clip_position(
    subject: &TracedFragment<'_>,
    matrices: &DrawMatrices,
    place: usize,
    NamedVertex { name, vertex }: &NamedVertex,
    scribe: &mut TraceRecorder,
) {
    let position = subject.mesh.positions[place].to_array();
    for (row, axis) in AXES.into_iter().enumerate() {
        let entries = |column: usize| matrices.clip_from_model.col(column)[row].into();
        let formula = product_of(entries, position.map(Into::into), row);
        scribe.compute(format!("{name} · clip {axis}"), vertex.position[row], &formula);
    }
}

/// Writes a vertex normal in world space: transformed, then normalised. `place` is the index of the vertex in the mesh.
fn normal(
    subject: &TracedFragment<'_>,
    matrices: &DrawMatrices,
    place: usize,
    NamedVertex { name, vertex }: &NamedVertex,
    scribe: &mut TraceRecorder,
) {
    let raw = subject.transformer(matrices).world_normal(place).to_array();
    let of_model = subject.mesh.normals[place].to_array();
    for (row, turned) in raw.into_iter().enumerate() {
        let term = |column: usize| {
            let entry = matrices.world_from_model_normal.col(column)[row];
            given(format!("n{row}{column}"), entry) * given(AXES[column], of_model[column])
        };
        scribe.compute(format!("{name} · world normal {}", AXES[row]), turned, &sum((0..3).map(term)));
    }
    for (row, unit) in vertex.varyings.normal.to_array().into_iter().enumerate() {
        scribe.compute(format!("{name} · unit normal {}", AXES[row]), unit, &unit_component(raw, row));
    }
    if subject.settings.shading.reads(Input::VertexLight) {
        let normal = vector(["nx", "ny", "nz"], vertex.varyings.normal);
        let inputs = FormulaInputs(subject);
        let light = lambert(&normal, &inputs.light_direction(), inputs.ambient());
        scribe.compute(format!("{name} · light"), vertex.varyings.light, &light);
    }
}

/// Returns the formula for one component of a normalised vector.
pub(super) fn unit_component(vector: [f32; 3], axis: usize) -> Formula {
    let component = |axis: usize| given(AXES[axis], vector[axis]);
    let square = sum((0..3).map(|axis| component(axis) * component(axis)));
    component(axis) / square.apply(super::formula::Function::SquareRoot)
}

/// Writes the clipping steps. Returns the corners of the piece that contains the fragment.
fn clip(subject: &TracedFragment<'_>, corners: Vec<NamedVertex>, scribe: &mut TraceRecorder) -> Vec<NamedVertex> {
    if let PlanStep::Skipped(reason) = subject.plan.step(PipelinePart::Clipping) {
        scribe.decide("clipping", reason, "skipped");
        return corners;
    }
    let widening = guard_band_widening(subject.raster.width, subject.raster.height);
    let Ok(triangle) = <[ClipVertex; 3]>::try_from(corners.iter().map(|named| named.vertex).collect::<Vec<_>>()) else {
        return corners;
    };
    let mut cuts: Vec<EdgeCut> = Vec::new();
    let mut polygon = Polygon::default();
    let outcome = polygon.clip_watched(&triangle, widening, &mut |cut| cuts.push(*cut));
    for plane in ClipPlane::ALL {
        if triangle.iter().any(|vertex| plane.distance(vertex.position, widening) < 0.0) {
            let name = plane_name(subject.plane_of_view(plane));
            distances(plane, name, widening, &corners, scribe);
        }
    }
    if outcome != Ok(Cut::Pieces) {
        scribe.decide("clipping", "no corner lies beyond the near plane, far plane or guard band", "not clipped");
        return corners;
    }
    let mut named = corners;
    for (index, cut) in cuts.iter().enumerate() {
        let name = format!("cut {index}");
        write_cut(subject, cut, &name, &named, scribe);
        named.push(NamedVertex { name, vertex: cut.vertex });
    }
    let name_of = |vertex: &ClipVertex| {
        named.iter().rev().find(|named| named.vertex == *vertex).map_or_else(String::new, |named| named.name.clone())
    };
    let around: Vec<_> = polygon.vertices().iter().map(name_of).collect();
    scribe.decide("clipped polygon", "its corners, in order", around.join(", "));
    let is_the_one = |piece: &[ClipVertex; 3]| {
        let projected =
            piece.each_ref().map(|v| subject.raster.project_vertex(v, &subject.frame.geometry().depth_scale));
        projected.iter().zip(&subject.triangle.vertices).all(|(a, b)| (a.x, a.y, a.inv_w) == (b.x, b.y, b.inv_w))
    };
    let pieces: Vec<_> = polygon.fan().collect();
    let Some(place) = pieces.iter().position(is_the_one) else { return Vec::new() };
    let words = format!("{} triangles around the first corner", pieces.len());
    scribe.decide("piece with the fragment", words, pieces[place].each_ref().map(name_of).join(", "));
    pieces[place].iter().map(|vertex| NamedVertex { name: name_of(vertex), vertex: *vertex }).collect()
}

/// Writes the distances of all corners from a plane that the triangle crosses.
fn distances(plane: ClipPlane, plane_name: &str, widening: f32, corners: &[NamedVertex], scribe: &mut TraceRecorder) {
    for NamedVertex { name, vertex } in corners {
        let formula = distance_formula(plane, vertex.position, widening);
        let distance = plane.distance(vertex.position, widening);
        let line = scribe.compute(format!("{name} · distance from the {plane_name}"), distance, &formula);
        line.flag(Notable::Tie, distance == 0.0);
    }
}

fn distance_formula(plane: ClipPlane, position: Vec4, widening: f32) -> Formula {
    let component = |axis: usize| given(AXES[axis], position[axis]);
    let side = || component(3) * given("guard band", widening);
    match plane {
        ClipPlane::Near => component(2),
        ClipPlane::Eye => component(3) - given("least w", MIN_W),
        ClipPlane::Far => component(3) - component(2),
        ClipPlane::Left => side() + component(0),
        ClipPlane::Right => side() - component(0),
        ClipPlane::Bottom => side() + component(1),
        ClipPlane::Top => side() - component(1),
    }
}

fn plane_name(plane: ClipPlane) -> &'static str {
    match plane {
        ClipPlane::Near => "near plane",
        ClipPlane::Eye => "eye plane",
        ClipPlane::Far => "far plane",
        ClipPlane::Left => "left guard band",
        ClipPlane::Right => "right guard band",
        ClipPlane::Bottom => "lower guard band",
        ClipPlane::Top => "upper guard band",
    }
}

/// Writes the trace lines for a vertex created by clipping: its position along the clipped edge, and in clip space.
fn write_cut(
    subject: &TracedFragment<'_>,
    cut: &EdgeCut,
    name: &str,
    known: &[NamedVertex],
    scribe: &mut TraceRecorder,
) {
    let plane = plane_name(subject.plane_of_view(cut.plane));
    let widening = guard_band_widening(subject.raster.width, subject.raster.height);
    let name_of = |vertex: &ClipVertex| {
        let known = known.iter().rev().find(|known| known.vertex == *vertex);
        known.map_or_else(|| "a corner".to_owned(), |known| known.name.clone())
    };
    let (inside, outside) = (name_of(&cut.inside), name_of(&cut.outside));
    let words = format!("the edge from {inside} to {outside} leaves through the {plane}");
    scribe.decide(name, words, "a new vertex");
    let [da, db] = [("d inside", cut.distances[0]), ("d outside", cut.distances[1])].map(|(name, d)| given(name, d));
    scribe.compute(format!("{name} · t"), cut.t, &(da.clone() / (da.clone() - db.clone())));
    let other = db.clone() / (db - da);
    for (axis, part) in AXES.into_iter().enumerate() {
        let (a, b) = (cut.inside.position[axis], cut.outside.position[axis]);
        let formula = pinned(cut, axis, widening).unwrap_or_else(|| {
            given(format!("{part} inside"), a) * other.clone() + given(format!("{part} outside"), b) * given("t", cut.t)
        });
        scribe.compute(format!("{name} · clip {part}"), cut.vertex.position[axis], &formula);
    }
}

/// If clipping sets a component of a new vertex exactly to its value on the clip plane, returns the formula for that
/// value. Returns `None` if clipping interpolates the component.
fn pinned(cut: &EdgeCut, axis: usize, widening: f32) -> Option<Formula> {
    let w = || given("w", cut.vertex.position.w);
    let side = || w() * given("guard band", widening);
    match (cut.plane, AXES[axis]) {
        (ClipPlane::Near, "z") => Some(whole("0", 0)),
        (ClipPlane::Eye, "w") => Some(given("least w", MIN_W)),
        (ClipPlane::Far, "z") => Some(w()),
        (ClipPlane::Left, "x") | (ClipPlane::Bottom, "y") => Some(-side()),
        (ClipPlane::Right, "x") | (ClipPlane::Top, "y") => Some(side()),
        _ => None,
    }
}
