//! Draw plans: the parts of the pipeline that a draw runs, and the reason for each part that it skips.
//!
//! A plan is made once per draw from mesh, material, view and settings. The stages read it instead of deciding per
//! triangle or per pixel. Skipping a part never changes the picture. A skipped attribute keeps one value at all
//! vertices: it is neither transformed nor interpolated, but clipping carries it along.

use glam::{Vec2, Vec3};
use serde::Serialize;

use super::settings::{Culling, DepthTest, DisabledOptimisation, Interpolation, Settings, Shading};
use super::shading::Input;
use super::viewpoint::Viewpoint;
use crate::scene::{Camera, Instance, Library, Material, Mesh, Projection, TextureId, Transparency, TriangleId};

/// Part of the pipeline that a draw may not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PipelinePart {
    /// Transforming vertices, and running all later stages.
    Vertices,
    /// Processing every cluster of a large mesh. A cluster is skipped if it lies wholly outside the view, or if all its
    /// triangles have the culled facing. Facing is decided by *snapped* corners, and snapping may flip triangles that
    /// are very small or thin on the screen. Clusters with such triangles are not skipped for their facing; their
    /// triangles are tested one by one.
    EveryCluster,
    /// Cutting triangles at the planes of the frustum.
    Clipping,
    /// Rejecting triangles by their facing.
    Culling,
    /// Testing against the depth buffer and writing to it.
    Depth,
    /// Dividing interpolation weights by w.
    PerspectiveDivision,
    /// Fetching and interpolating texture coordinates.
    TextureCoordinates,
    /// Transforming and interpolating normals.
    Normals,
    /// Fetching and interpolating vertex colours.
    VertexColors,
    /// Reading the texels of textures.
    Texels,
    /// Alpha test: discarding fragments whose alpha is below a threshold.
    AlphaTest,
    /// Computing light, at vertices (Gouraud) or per fragment.
    Light,
    /// Perturbing the interpolated normal by a normal map.
    NormalMap,
    /// Adding the specular reflection of Blinn–Phong shading.
    Highlight,
    /// Adding emitted light.
    Emission,
    /// Blending with the pixels drawn so far, from far to near and without writing depth.
    Blending,
}

impl PipelinePart {
    /// All parts, in the order of the stages.
    pub const ALL: [Self; 16] = [
        Self::Vertices,
        Self::EveryCluster,
        Self::Clipping,
        Self::Culling,
        Self::Depth,
        Self::PerspectiveDivision,
        Self::TextureCoordinates,
        Self::Normals,
        Self::VertexColors,
        Self::Texels,
        Self::AlphaTest,
        Self::Light,
        Self::NormalMap,
        Self::Highlight,
        Self::Emission,
        Self::Blending,
    ];

    /// Returns the setting that forces the part to run, or `None` if there is none.
    pub(crate) fn disabled_optimisation(self) -> Option<DisabledOptimisation> {
        match self {
            Self::Vertices => Some(DisabledOptimisation::Vertices),
            Self::EveryCluster => Some(DisabledOptimisation::Clusters),
            Self::Clipping => Some(DisabledOptimisation::Clipping),
            Self::PerspectiveDivision => Some(DisabledOptimisation::PerspectiveDivision),
            Self::TextureCoordinates => Some(DisabledOptimisation::TextureCoordinates),
            Self::Normals => Some(DisabledOptimisation::Normals),
            Self::VertexColors => Some(DisabledOptimisation::VertexColors),
            Self::Culling
            | Self::Depth
            | Self::Texels
            | Self::AlphaTest
            | Self::Light
            | Self::NormalMap
            | Self::Highlight
            | Self::Emission
            | Self::Blending => None,
        }
    }

    /// Returns the display name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertices => "Vertices",
            Self::EveryCluster => "Every cluster",
            Self::Clipping => "Clipping",
            Self::Culling => "Culling",
            Self::Depth => "Depth buffer",
            Self::PerspectiveDivision => "Perspective division",
            Self::TextureCoordinates => "Texture coordinates",
            Self::Normals => "Normals",
            Self::VertexColors => "Vertex colours",
            Self::Texels => "Texture reads",
            Self::AlphaTest => "Alpha test",
            Self::Light => "Light",
            Self::NormalMap => "Normal map",
            Self::Highlight => "Highlight",
            Self::Emission => "Emission",
            Self::Blending => "Blending",
        }
    }
}

/// Whether a part of the pipeline runs, with the reason if it is skipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlanStep {
    /// The part runs: the draw needs it, or the settings force it to run.
    Run,
    /// The part is skipped for this reason.
    Skipped(&'static str),
}

impl PlanStep {
    /// Returns [`PlanStep::Skipped`] with the given reason, or [`PlanStep::Run`] if `reason` is `None`.
    pub(crate) fn unless(reason: Option<&'static str>) -> Self {
        reason.map_or(Self::Run, Self::Skipped)
    }

    /// Returns whether the part runs.
    pub fn runs(self) -> bool {
        self == Self::Run
    }

    /// Returns the reason for skipping the part, or `None` if it runs.
    pub fn reason(self) -> Option<&'static str> {
        match self {
            Self::Run => None,
            Self::Skipped(reason) => Some(reason),
        }
    }
}

/// Location of a mesh's bounding box relative to the frustum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Containment {
    /// The box lies wholly beyond one plane.
    Outside,
    /// The box lies wholly inside all planes.
    Inside,
    /// The box may cross a plane: neither of the other cases is certain.
    Crossing,
}

/// Numbers of culled clusters in one or several draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CullStats {
    /// Number of clusters outside the view.
    pub(crate) outside: usize,
    /// Number of clusters that are not outside the view but whose triangles all have the culled facing.
    pub(crate) turned_away: usize,
    /// Total number of clusters, culled or not.
    pub(crate) all: usize,
}

impl CullStats {
    /// Returns the sums of the cluster counts over several draws.
    pub fn of<'a>(plans: impl IntoIterator<Item = &'a DrawPlan>) -> Self {
        plans.into_iter().fold(Self::default(), |sum, DrawPlan { clusters, .. }| Self {
            outside: sum.outside + clusters.outside,
            turned_away: sum.turned_away + clusters.turned_away,
            all: sum.all + clusters.all,
        })
    }

    /// Returns the number of culled clusters.
    pub fn culled(&self) -> usize {
        self.outside + self.turned_away
    }

    /// Describes the cluster counts in words, for display.
    pub fn describe(self) -> String {
        let Self { outside, turned_away, all } = self;
        format!("{} of {all}: {outside} wholly outside the view, {turned_away} culled by facing", self.culled())
    }
}

/// Plan of one draw: for every [`PipelinePart`], whether it runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DrawPlan {
    steps: [PlanStep; PipelinePart::ALL.len()],
    transparency: Transparency,
    clusters: CullStats,
    /// Culling of the draw's triangles by their facing.
    #[serde(skip)]
    culling: Culling,
    /// Scale and offset of texture coordinates, or `None` if they are the identity.
    #[serde(skip)]
    uv_transform: Option<[Vec2; 2]>,
    #[serde(skip)]
    eye: Viewpoint,
    #[serde(skip)]
    first_triangle: TriangleId,
}

impl DrawPlan {
    /// Returns the plan for drawing one instance.
    pub(crate) fn new(
        library: &Library,
        instance: &Instance,
        camera: &Camera,
        settings: &Settings,
        containment: Containment,
    ) -> Self {
        let facts = DrawFacts::new(library, instance, camera, settings, containment);
        let steps = PipelinePart::ALL.map(|part| facts.step(part));
        let Material { uv_scale, uv_offset, .. } = *facts.material;
        let uv_transform = [uv_scale, uv_offset];
        Self {
            steps,
            transparency: facts.transparency,
            clusters: CullStats::default(),
            culling: culling(library, instance, settings),
            uv_transform: (uv_transform != [Vec2::ONE, Vec2::ZERO]).then_some(uv_transform),
            eye: Viewpoint::of(camera),
            first_triangle: TriangleId(0),
        }
    }

    /// Returns the plan with `first_triangle` as the identifier of the instance's first triangle.
    pub(super) fn starting_at(self, first_triangle: TriangleId) -> Self {
        Self { first_triangle, ..self }
    }

    /// Returns the identifier of the first triangle of the instance.
    pub(super) fn first_triangle(&self) -> TriangleId {
        self.first_triangle
    }

    /// Returns the viewpoint of the camera: its position or, in orthographic views, the direction towards it.
    pub(super) fn eye(&self) -> Viewpoint {
        self.eye
    }

    /// Returns the scale and offset that the material applies to the texture coordinates of vertices, or `None` if they
    /// are the identity.
    pub(crate) fn uv_transform(&self) -> Option<[Vec2; 2]> {
        self.uv_transform
    }

    /// Records the cluster counts in the plan, provided that a cluster was culled, and returns the plan.
    pub(super) fn with_cull_stats(mut self, clusters: CullStats) -> Self {
        if clusters.culled() > 0 {
            self.steps[PipelinePart::EveryCluster as usize] =
                PlanStep::Skipped("clusters wholly outside the view or culled by facing");
            self.clusters = clusters;
        }
        self
    }

    /// Returns whether the settings and the location of the mesh allow clusters to be culled.
    pub(super) fn may_cull_clusters(&self, settings: &Settings, containment: Containment) -> bool {
        let some = match containment {
            // The whole draw is skipped. If the settings force it to run, no cluster is culled either.
            Containment::Outside => false,
            Containment::Inside => self.culling != Culling::None,
            Containment::Crossing => true,
        };
        some && !matches!(settings.force, DisabledOptimisation::Everything | DisabledOptimisation::Clusters)
    }

    /// Returns the culling of the draw's triangles by their facing.
    pub(crate) fn culling(&self) -> Culling {
        self.culling
    }

    /// Returns the cluster counts. All of them, even the total, are zero if no cluster was culled.
    pub fn clusters(&self) -> CullStats {
        self.clusters
    }

    /// Returns whether both plans run the same parts, skip the others for the same reasons, and have the same
    /// transparency. Cluster counts are not compared.
    pub(crate) fn agrees_with(&self, other: &Self) -> bool {
        (self.steps, self.transparency) == (other.steps, other.transparency)
    }

    /// Returns whether the draw is opaque, alpha-tested or blended. Forcing parts to run never changes this, because
    /// transparency determines the picture.
    pub(crate) fn transparency(&self) -> Transparency {
        self.transparency
    }

    /// Returns whether a part runs, with the reason if it is skipped.
    pub fn step(&self, part: PipelinePart) -> PlanStep {
        self.steps[part as usize]
    }

    /// Returns whether a part runs.
    pub fn runs(&self, part: PipelinePart) -> bool {
        self.step(part).runs()
    }
}

/// Inputs for deciding which parts of the pipeline a draw runs. They are gathered once per draw, because the decision
/// for every part reads them.
struct DrawFacts<'a> {
    mesh: &'a Mesh,
    material: &'a Material,
    camera: &'a Camera,
    settings: &'a Settings,
    containment: Containment,
    transparency: Transparency,
    /// Whether the shading reads a texture of the material.
    textured: bool,
}

impl<'a> DrawFacts<'a> {
    fn new(
        library: &'a Library,
        instance: &Instance,
        camera: &'a Camera,
        settings: &'a Settings,
        containment: Containment,
    ) -> Self {
        let textures = textures_read(library, instance, settings.shading);
        Self {
            mesh: library.mesh(instance.mesh),
            material: library.material(instance.material),
            camera,
            settings,
            containment,
            transparency: transparency(library, instance, settings.shading),
            textured: textures.iter().any(Option::is_some),
        }
    }

    /// Returns whether `part` runs: because the draw needs it, or because the settings force it to run.
    fn step(&self, part: PipelinePart) -> PlanStep {
        if self.containment == Containment::Outside && !self.forced(PipelinePart::Vertices) {
            return PlanStep::Skipped("the whole object is outside the view");
        }
        PlanStep::unless(self.skip_reason(part).filter(|_| !(self.forced(part) && self.can_run(part))))
    }

    /// Returns whether the settings force `part` to run.
    fn forced(&self, part: PipelinePart) -> bool {
        match self.settings.force {
            DisabledOptimisation::Nothing => false,
            DisabledOptimisation::Everything => true,
            one => part.disabled_optimisation() == Some(one),
        }
    }

    /// Returns whether `part` can run in a draw that does not need it, without changing the picture.
    fn can_run(&self, part: PipelinePart) -> bool {
        match part {
            PipelinePart::PerspectiveDivision => self.settings.interpolation == Interpolation::Perspective,
            PipelinePart::TextureCoordinates => !self.mesh.uvs.is_empty(),
            PipelinePart::VertexColors => !self.mesh.colors.is_empty(),
            // Each of these parts adds to the picture, so forcing it would change the picture.
            PipelinePart::NormalMap | PipelinePart::Highlight | PipelinePart::Emission => false,
            _ => true,
        }
    }

    /// Returns the reason for skipping `part` in a draw that is not outside the view, or `None` if the draw needs the
    /// part.
    fn skip_reason(&self, part: PipelinePart) -> Option<&'static str> {
        let settings = self.settings;
        let shading = settings.shading;
        let reads_albedo = shading.reads_material();
        let lit = shading.is_lit();
        let reads = |input| shading.reads(input);
        match part {
            // Clusters are culled later, which `DrawPlan::with_cull_stats` records.
            PipelinePart::Vertices | PipelinePart::EveryCluster => None,
            PipelinePart::Clipping => {
                (self.containment == Containment::Inside).then_some("the whole object is inside the view")
            }
            PipelinePart::Culling if settings.culling == Culling::None => Some("culling is off"),
            PipelinePart::Culling => self.material.double_sided.then_some("the material is double-sided"),
            PipelinePart::Depth => (settings.depth_test == DepthTest::Off).then_some("the depth test is off"),
            PipelinePart::PerspectiveDivision if settings.interpolation != Interpolation::Perspective => {
                Some("interpolation is affine")
            }
            PipelinePart::PerspectiveDivision => matches!(self.camera.projection, Projection::Orthographic { .. })
                .then_some("all w are equal: orthographic view"),
            PipelinePart::TextureCoordinates | PipelinePart::Texels if self.mesh.uvs.is_empty() => {
                Some("the mesh has no texture coordinates")
            }
            PipelinePart::TextureCoordinates if reads(Input::Uv) => None,
            PipelinePart::TextureCoordinates | PipelinePart::Texels if !reads_albedo && !self.textured => {
                Some("this shading reads no texture")
            }
            PipelinePart::TextureCoordinates | PipelinePart::Texels => {
                (!self.textured).then_some("the material has no texture")
            }
            PipelinePart::Normals => (!lit && !reads(Input::Normal)).then_some("this shading reads no normal"),
            PipelinePart::VertexColors if self.mesh.colors.is_empty() => Some("the mesh has no vertex colours"),
            PipelinePart::VertexColors => {
                (!reads_albedo && !reads(Input::VertexColor)).then_some("this shading reads no vertex colour")
            }
            PipelinePart::AlphaTest | PipelinePart::Blending if !reads_albedo => {
                Some("this shading ignores opacity and alpha")
            }
            PipelinePart::AlphaTest => match self.transparency {
                Transparency::Opaque => Some("no texture that is read has alpha"),
                Transparency::AlphaTested => None,
                Transparency::Blended => Some("the material is blended instead"),
            },
            PipelinePart::Light => (!lit).then_some("this shading is unlit"),
            PipelinePart::NormalMap if !reads(Input::Normal) => Some("this shading reads no per-pixel normal"),
            PipelinePart::NormalMap if self.mesh.uvs.is_empty() => Some("the mesh has no texture coordinates"),
            PipelinePart::NormalMap => {
                self.material.normal_texture.is_none().then_some("the material has no normal map")
            }
            PipelinePart::Highlight if !reads(Input::Specular) => Some("this shading has no highlight"),
            PipelinePart::Highlight => {
                (self.material.specular == Vec3::ZERO).then_some("the material's specular colour is black")
            }
            PipelinePart::Emission if !reads_albedo => Some("this shading ignores emission"),
            PipelinePart::Emission => (self.material.emission == Vec3::ZERO).then_some("the material emits no light"),
            PipelinePart::Blending => match self.transparency {
                Transparency::Opaque => Some("material and texture are opaque"),
                Transparency::AlphaTested => Some("every alpha is 0 or 1: alpha-tested instead"),
                Transparency::Blended => None,
            },
        }
    }
}

/// Returns the culling of an instance's triangles: that of the settings, or none if its material is double-sided.
pub(crate) fn culling(library: &Library, instance: &Instance, settings: &Settings) -> Culling {
    if library.material(instance.material).double_sided { Culling::None } else { settings.culling }
}

/// Returns the transparency of an instance in a shading mode. Modes that ignore the material are opaque.
pub(crate) fn transparency(library: &Library, instance: &Instance, shading: Shading) -> Transparency {
    if !shading.reads_material() {
        return Transparency::Opaque;
    }
    let [color, dark, alpha, ..] = textures_read(library, instance, shading);
    let with_alpha = [color, dark, alpha].into_iter().flatten();
    library.material(instance.material).transparency(library, with_alpha)
}

/// Returns the textures of an instance that a shading mode reads: colour, dark colour, opacity, normal map, emission.
fn textures_read(library: &Library, instance: &Instance, shading: Shading) -> [Option<TextureId>; 5] {
    let material = library.material(instance.material);
    let has_coordinates = !library.mesh(instance.mesh).uvs.is_empty();
    let reads_material = has_coordinates && shading.reads_material();
    [
        material.texture.filter(|_| reads_material),
        material.dark_texture.filter(|_| has_coordinates && shading.reads(Input::DarkTexture)),
        material.alpha_texture.filter(|_| reads_material),
        material.normal_texture.filter(|_| has_coordinates && shading.reads(Input::Normal)),
        material.emission_texture.filter(|_| reads_material && material.emission != Vec3::ZERO),
    ]
}
