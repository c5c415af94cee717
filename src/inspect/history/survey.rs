//! What the geometry stages of a frame dropped, kept so that every pixel can be asked about it.
//!
//! The stages are called once more, by the matrices, plans and arithmetic of the frame itself; only what ended there is kept.
//! For 100 000 dropped triangles that is some 5 MB.

use std::collections::BTreeSet;

use glam::{DVec2, Vec4};

use super::clipped::{Meeting, meeting};
use super::near_miss::distance_px;
use super::{Absent, Cause};
use crate::chain::{Frame, Recipe};
use crate::pipeline::clip::{Plane, clip, guard_band_widening};
use crate::pipeline::cull::{Facing, cull, facing};
use crate::pipeline::observe::{Fate, Observer};
use crate::pipeline::plan::Part;
use crate::pipeline::raster::{Scissor, Span, cover_within, doubled_area};
use crate::pipeline::settings::{Choice as _, Culling, Settings};
use crate::pipeline::vertex::{ClipVertex, DrawMatrices};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Projection, Scene, TriangleId};

/// Snapping moves each corner by at most 1/512 px along each axis: a sliver that covered a pixel's centre before lies no
/// farther from it after, px.
const SNAPPED_BY_PX: f64 = 1.0 / 256.0;

/// The triangles of one frame that ended before the rasterizer, as far as they may be missed at a pixel.
#[derive(Clone, Debug)]
pub struct Survey {
    dropped: Vec<Dropped>,
    crossing: Vec<Crossing>,
    not_finite: Vec<(TriangleId, u32)>,
    camera: Camera,
    raster: Viewport,
}

/// A triangle, or a piece of one, that reached the screen and was not rasterized.
#[derive(Clone, Copy, Debug)]
struct Dropped {
    id: TriangleId,
    instance: u32,
    corners_px: [[f32; 2]; 3],
    cause: Cause,
}

/// A triangle that is not wholly between the near and the far plane: its corners in clip space.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    id: TriangleId,
    instance: u32,
    corners: [Vec4; 3],
}

impl Survey {
    /// Of a frame that `recipe` made of `scene`.
    pub fn of(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        let mut survey = Self {
            dropped: Vec::new(),
            crossing: Vec::new(),
            not_finite: Vec::new(),
            camera: frame.drawn_by(recipe),
            raster: frame.raster,
        };
        let mut kept = 0;
        for (index, first) in scene.first_triangles().into_iter().enumerate() {
            kept += survey.take_draw(scene, recipe, frame, (index, first));
        }
        survey.settle_limit(kept, frame);
        survey
    }

    /// Takes in one draw. How many pieces were kept to be rasterized; they are noted, too, as if they came after the last.
    fn take_draw(&mut self, scene: &Scene, recipe: &Recipe, frame: &Frame, draw: (usize, TriangleId)) -> usize {
        let ((index, first), settings) = (draw, &recipe.pipeline);
        let (instance, plan) = (&scene.instances[index], &frame.plans[index]);
        let mesh = scene.library.mesh(instance.mesh);
        let matrices = DrawMatrices::new(instance, &self.camera, self.raster.aspect(), settings.depth_format.mapping());
        let vertices: Vec<ClipVertex> =
            mesh.positions.iter().map(|p| ClipVertex::at(matrices.clip_from_model * p.extend(1.0))).collect();
        let instance = index as u32;
        for (offset, corners) in mesh.triangles.iter().enumerate() {
            let corners = corners.map(|corner| vertices[corner as usize].position);
            if corners.iter().any(|p| p.z < 0.0 || p.z > p.w) {
                self.crossing.push(Crossing { id: TriangleId(first.0 + offset as u32), instance, corners });
            }
        }
        if !plan.runs(Part::Vertices) {
            return 0;
        }
        let positions_px: Vec<[f32; 2]> = vertices.iter().map(|vertex| self.position_px(vertex)).collect();
        let widening = guard_band_widening(self.raster.width, self.raster.height);
        let may_cross = plan.runs(Part::Clipping);
        let mut kept = 0;
        for (offset, corners) in mesh.triangles.iter().enumerate() {
            let owner = (TriangleId(first.0 + offset as u32), instance);
            let whole = corners.map(|corner| vertices[corner as usize]);
            if may_cross && !whole.iter().all(|corner| is_inside(corner.position)) {
                let pieces = self.clipped(owner, &whole, widening);
                kept += self.take_pieces(&pieces, owner, settings);
            } else {
                kept += self.take_pieces(&[corners.map(|corner| positions_px[corner as usize])], owner, settings);
            }
        }
        kept
    }

    /// Where a vertex lies on the screen before snapping, by the steps of [`Viewport::project`].
    fn position_px(&self, vertex: &ClipVertex) -> [f32; 2] {
        let inv_w = 1.0 / vertex.position.w;
        self.raster.pixels_from_ndc(vertex.position.truncate() * inv_w).into()
    }

    /// Corners on the screen of what clipping leaves of a triangle.
    fn clipped(&mut self, owner: (TriangleId, u32), whole: &[ClipVertex; 3], widening: f32) -> Vec<[[f32; 2]; 3]> {
        let mut not_finite = NotFinite { found: &mut self.not_finite, instance: owner.1 };
        let pieces = clip(whole, &[[0, 1, 2]], owner.0, true, widening, &mut not_finite);
        pieces.iter().map(|piece| piece.vertices.each_ref().map(|corner| self.position_px(corner))).collect()
    }

    /// Takes in the pieces of one triangle; how many were kept.
    fn take_pieces(&mut self, pieces: &[[[f32; 2]; 3]], owner: (TriangleId, u32), settings: &Settings) -> usize {
        let causes = pieces.iter().map(|corners_px| {
            let (area, _) = doubled_area(settings.arithmetic, *corners_px);
            match cull(area, settings.culling) {
                None => Cause::NotDrawnYet,
                Some(Fate::BackFacing) => Cause::BackFacing,
                Some(Fate::FrontFacing) => Cause::FrontFacing,
                Some(_) => Cause::ZeroArea,
            }
        });
        // A piece without area says nothing where others of its triangle have some.
        let has_area = causes.clone().any(|cause| cause != Cause::ZeroArea);
        let told = pieces.iter().zip(causes.clone()).filter(|(_, cause)| !has_area || *cause != Cause::ZeroArea);
        let (id, instance) = owner;
        self.dropped.extend(told.map(|(corners_px, cause)| Dropped { id, instance, corners_px: *corners_px, cause }));
        causes.filter(|cause| *cause == Cause::NotDrawnYet).count()
    }

    /// Forgets the triangles that the frame did draw: all that were kept, unless its list was cut short.
    fn settle_limit(&mut self, kept: usize, frame: &Frame) {
        let drawn: BTreeSet<TriangleId> = if frame.geometry.triangles.len() < kept {
            frame.geometry.triangles.iter().map(|triangle| triangle.id).collect()
        } else {
            BTreeSet::new()
        };
        let is_whole = frame.geometry.triangles.len() >= kept;
        self.dropped.retain(|piece| piece.cause != Cause::NotDrawnYet || !is_whole && !drawn.contains(&piece.id));
        self.dropped.shrink_to_fit();
    }

    /// The triangles that ended before the rasterizer and would have been at a drawn pixel, and those that are nowhere.
    pub(super) fn dropped_at(&self, scene: &Scene, recipe: &Recipe, frame: &Frame, pixel: (u32, u32)) -> Vec<Absent> {
        let absent = |triangle, instance: u32, cause, reason| Absent {
            triangle,
            instance: scene.instances[instance as usize].name.clone(),
            submission: None,
            cause,
            reason,
            corners_px: None,
            distance_px: None,
            edges: None,
        };
        let settings = &recipe.pipeline;
        let dropped = self.dropped.iter().filter(|piece| piece.would_cover(settings, frame, pixel));
        let crossing = self.crossing.iter().filter_map(|t| Some((t, self.cut_away(t, settings, pixel)?)));
        dropped
            .map(|piece| Absent {
                corners_px: Some(piece.corners_px),
                ..absent(piece.id, piece.instance, piece.cause, piece.reason(settings))
            })
            .chain(crossing.map(|(t, (cause, reason))| absent(t.id, t.instance, cause, reason)))
            .chain(self.not_finite.iter().map(|(id, instance)| {
                let reason = "has a corner that is not a finite number in clip space, so it is never drawn".to_owned();
                absent(*id, *instance, Cause::NotFinite, reason)
            }))
            .collect()
    }

    /// The plane that cuts a triangle away at a pixel, if one does and the triangle would be seen without.
    fn cut_away(&self, triangle: &Crossing, settings: &Settings, (x, y): (u32, u32)) -> Option<(Cause, String)> {
        let share = |pixel: u32, size: u32| (f64::from(pixel) + 0.5) / f64::from(size);
        let ndc = DVec2::new(share(x, self.raster.width) * 2.0 - 1.0, 1.0 - share(y, self.raster.height) * 2.0);
        let met = meeting(triangle.corners, ndc)?;
        let side = if met.shows_front { Facing::Front } else { Facing::Back };
        let is_culled =
            matches!((side, settings.culling), (Facing::Front, Culling::Front) | (Facing::Back, Culling::Back));
        let is_before_zero = met.z < 0.0;
        if is_culled || (0.0..=met.w).contains(&met.z) {
            return None;
        }
        // Reversed depth has its zero at the far plane.
        let is_near = is_before_zero != settings.reversed();
        let (cause, name, plane, beyond) = if is_near {
            (Cause::NearPlane, "near", self.camera.near, "before")
        } else {
            (Cause::FarPlane, "far", self.camera.far, "beyond")
        };
        let distance = self.distance(met, settings);
        let reason = format!(
            "would cover it {distance:.4} from the eye, which is {beyond} the {name} plane at {plane}: cut away there"
        );
        Some((cause, reason))
    }

    /// How far from the eye, along the line of sight, a triangle is met; world units.
    fn distance(&self, met: Meeting, settings: &Settings) -> f64 {
        let Camera { near, far, .. } = self.camera;
        let (near, far) = (f64::from(near), f64::from(far));
        match self.camera.projection {
            Projection::Perspective { .. } => met.w,
            Projection::Orthographic { .. } if settings.reversed() => far - met.z * (far - near),
            Projection::Orthographic { .. } => near + met.z * (far - near),
        }
    }
}

impl Dropped {
    /// Whether the recipe's rasterizer would have given the pixel to it; one without area, whether it runs through it.
    fn would_cover(&self, settings: &Settings, frame: &Frame, (x, y): (u32, u32)) -> bool {
        let scissor = Scissor::pixel(x, y);
        if !scissor.may_meet(self.corners_px) {
            return false;
        }
        if self.cause == Cause::ZeroArea {
            let corners = self.corners_px.map(|[x, y]| DVec2::new(x.into(), y.into()));
            return distance_px(corners, DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)) <= SNAPPED_BY_PX;
        }
        let mut spans: Vec<Span> = Vec::new();
        let how = (settings.rasterizer, settings.arithmetic, settings.fill_rule);
        cover_within(how, self.corners_px, (frame.drawn.grid, scissor), &mut spans);
        !spans.is_empty()
    }

    fn reason(&self, settings: &Settings) -> String {
        let (area, scale) = doubled_area(settings.arithmetic, self.corners_px);
        let area = area * scale;
        match facing(area) {
            _ if self.cause == Cause::NotDrawnYet => {
                "covers it, but comes after the last triangle that the triangle slider lets draw".to_owned()
            }
            Facing::Front => format!(
                "covers it and faces the viewer, but culling is {} (doubled area {area} < 0)",
                settings.culling.id()
            ),
            Facing::Back => format!(
                "covers it, but turns its back, and culling is {} (doubled area {area} > 0)",
                settings.culling.id()
            ),
            Facing::Edge => "passes here, but its snapped corners lie on one line: there is no area to draw".to_owned(),
        }
    }
}

/// Whether a corner lies in the view: a triangle of three such corners is neither cut nor dropped.
fn is_inside(position: Vec4) -> bool {
    position.is_finite() && Plane::ALL.iter().all(|plane| plane.distance(position, 1.0) >= 0.0)
}

/// Notes triangles that have a corner that is not finite.
struct NotFinite<'a> {
    found: &'a mut Vec<(TriangleId, u32)>,
    instance: u32,
}

impl Observer for NotFinite<'_> {
    fn rejected(&mut self, id: TriangleId, fate: Fate) {
        if fate == Fate::NotFinite {
            self.found.push((id, self.instance));
        }
    }
}

#[cfg(test)]
mod tests;
