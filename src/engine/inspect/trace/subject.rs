//! Fragment to be traced, with all inputs from which it was drawn. Collecting them does not process the geometry again.

use crate::chain::{Frame, Recipe};
use crate::inspect::pixel::{FragmentRecord, PixelReport};
use crate::pipeline::clip_space::ClipPlane;
use crate::pipeline::interpolate::{Fragment, interpolate};
use crate::pipeline::plan::{DrawPlan, PipelinePart};
use crate::pipeline::raster::steps::EdgeSteps;
use crate::pipeline::raster::{AnyTriangle, RasterSample};
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::Settings;
use crate::pipeline::shade::Shader;
use crate::pipeline::vertex::{DrawMatrices, Transformer};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Instance, Mesh, Scene};

/// Fragment to trace, with all inputs from which it was drawn.
pub(super) struct TracedFragment<'a> {
    pub(super) settings: &'a Settings,
    pub(super) record: &'a FragmentRecord,
    pub(super) triangle: &'a ScreenTriangle,
    pub(super) instance: &'a Instance,
    pub(super) mesh: &'a Mesh,
    /// Vertices of the triangle, as indices into the mesh.
    pub(super) corners: [usize; 3],
    pub(super) plan: &'a DrawPlan,
    pub(super) shader: Shader<'a>,
    pub(super) frame: &'a Frame,
    /// Column and row of the fragment in the rasterized picture.
    pub(super) pixel: (u32, u32),
    /// Camera used for rasterization, shifted by a subpixel offset if samples do not lie at the pixel centres of the
    /// full picture.
    pub(super) camera: Camera,
    /// Size of the rasterized picture, before upscaling, in pixels.
    pub(super) raster: Viewport,
    pub(super) steps: [EdgeSteps; 3],
    pub(super) sample: RasterSample,
    pub(super) fragment: Fragment,
}

impl<'a> TracedFragment<'a> {
    /// Collects the inputs from which the fragment of `record` was drawn. Returns `None` if the record belongs to
    /// another frame.
    pub(super) fn of(
        scene: &'a Scene,
        recipe: &'a Recipe,
        frame: &'a Frame,
        record: &'a FragmentRecord,
        report: &PixelReport,
    ) -> Option<Self> {
        let settings = &recipe.pipeline;
        let triangle = frame.geometry().triangles.get(record.submission).filter(|t| t.id == record.triangle)?;
        let index = triangle.instance as usize;
        let (instance, plan) = scene.instances.get(index).zip(frame.plans.get(index))?;
        let mesh = scene.library.mesh(instance.mesh);
        let first = scene.first_triangles().get(index)?.0;
        let corners = mesh.triangles.get((triangle.id.0 - first) as usize)?.map(|vertex| vertex as usize);
        let pixel: (u32, u32) = report.drawn_at.into();
        let edges = AnyTriangle::new(settings.arithmetic, triangle.corners_px(), settings.fill_rule)?;
        let (column, row) = frame.drawn.grid.sample_at(report.drawn_at[0], report.drawn_at[1])?;
        let sample = RasterSample { column, row, ..edges.sample(pixel) };
        let shader = Shader::new(settings, &scene.library, instance, plan);
        Some(Self {
            settings,
            record,
            triangle,
            instance,
            mesh,
            corners,
            plan,
            shader,
            frame,
            pixel,
            camera: frame.drawn_from(recipe),
            raster: frame.raster,
            steps: edges.steps(pixel),
            sample,
            fragment: interpolate(triangle, sample, shader.attributes()),
        })
    }

    /// Returns the transformation matrices of the fragment's draw.
    pub(super) fn matrices(&self) -> DrawMatrices {
        let mapping = self.settings.depth_format.mapping();
        DrawMatrices::new(self.instance, self.camera.clip_from_world_f64(self.raster.aspect(), mapping))
    }

    /// Returns the plane of the view frustum that a clip-space plane represents. Near and far are swapped if z = 0 is
    /// the far plane.
    pub(super) fn plane_of_view(&self, plane: ClipPlane) -> ClipPlane {
        plane.of_view(self.camera.has_zero_at_far(self.settings.depth_format.mapping()))
    }

    /// Returns the vertex transformer for the fragment's mesh.
    pub(super) fn transformer<'b>(&'b self, matrices: &'b DrawMatrices) -> Transformer<'b> {
        Transformer::new(self.mesh, matrices, self.settings, self.plan)
    }

    /// Whether the fragment's draw plan runs a pipeline part.
    pub(super) fn runs(&self, part: PipelinePart) -> bool {
        self.plan.runs(part)
    }
}
