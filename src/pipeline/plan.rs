//! Draw plans: the parts of the pipeline that a draw runs, and the reason for each part that it skips.
//!
//! A plan is made once per draw from mesh, material, view and settings. The stages read it instead of deciding per
//! triangle or per pixel. Skipping a part never changes the picture. A skipped attribute keeps one value at all
//! vertices: it is neither transformed nor interpolated, but clipping carries it along.

use glam::{Vec2, Vec3};
use serde::Serialize;

use super::settings::{Culling, DepthTest, Force, Interpolation, Settings, Shading};
use super::shade::Eye;
use crate::scene::{Camera, Instance, Library, Material, Projection, TextureId, Transparency, TriangleId};

/// Part of the pipeline that a draw may not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Transforming vertices, and all stages after it.
    Vertices,
    /// Processing every cluster of a large mesh. A cluster is skipped if all of it lies outside the view, or if all its
    /// triangles have the culled facing. Facing is decided by *snapped* corners. Triangles so small or so thin on the
    /// screen that snapping may flip them are therefore tested one by one, however clearly they are back-facing.
    EveryCluster,
    /// Cutting at the planes of the frustum.
    Clipping,
    /// Rejecting triangles by their facing.
    Culling,
    /// Comparing with, and storing to, the depth buffer.
    Depth,
    /// Dividing weights by w.
    PerspectiveDivision,
    /// Fetching and interpolating texture coordinates.
    TextureCoordinates,
    /// Transforming and interpolating normals.
    Normals,
    /// Fetching and interpolating vertex colours.
    VertexColors,
    /// Reading texels.
    Texels,
    /// Alpha test: discarding fragments by the alpha of the texture.
    CutOut,
    /// Computing light, at vertices (Gouraud) or per fragment.
    Light,
    /// Replacing the interpolated normal by that of a normal map.
    NormalMap,
    /// Adding the highlight of Blinn–Phong shading.
    Highlight,
    /// Adding emitted light.
    Emission,
    /// Blending with what is drawn already, from far to near and without storing depth.
    Blending,
}

impl Part {
    /// All parts, in the order of the stages.
    pub(crate) const ALL: [Self; 16] = [
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
        Self::CutOut,
        Self::Light,
        Self::NormalMap,
        Self::Highlight,
        Self::Emission,
        Self::Blending,
    ];

    /// Returns the setting that forces the part to run without need, if there is one.
    pub(crate) fn force(self) -> Option<Force> {
        match self {
            Self::Vertices => Some(Force::Vertices),
            Self::EveryCluster => Some(Force::Clusters),
            Self::Clipping => Some(Force::Clipping),
            Self::PerspectiveDivision => Some(Force::PerspectiveDivision),
            Self::TextureCoordinates => Some(Force::TextureCoordinates),
            Self::Normals => Some(Force::Normals),
            Self::VertexColors => Some(Force::VertexColors),
            Self::Culling
            | Self::Depth
            | Self::Texels
            | Self::CutOut
            | Self::Light
            | Self::NormalMap
            | Self::Highlight
            | Self::Emission
            | Self::Blending => None,
        }
    }

    /// Whether the part can run for an instance without changing the picture.
    fn can_run(self, library: &Library, instance: &Instance, settings: &Settings) -> bool {
        let mesh = library.mesh(instance.mesh);
        match self {
            Self::PerspectiveDivision => settings.interpolation == Interpolation::Perspective,
            Self::TextureCoordinates => !mesh.uvs.is_empty(),
            Self::VertexColors => !mesh.colors.is_empty(),
            // Each of these parts adds to the picture, so forcing it would change the picture.
            Self::NormalMap | Self::Highlight | Self::Emission => false,
            _ => true,
        }
    }

    /// Display name.
    pub(crate) fn name(self) -> &'static str {
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
            Self::CutOut => "Alpha test",
            Self::Light => "Light",
            Self::NormalMap => "Normal map",
            Self::Highlight => "Highlight",
            Self::Emission => "Emission",
            Self::Blending => "Blending",
        }
    }
}

/// Decision whether a part runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Step {
    /// The part is needed.
    Run,
    /// The part is skipped, for this reason.
    LeftOut(&'static str),
}

impl Step {
    /// Returns [`Step::Run`] if there is no reason to skip the part.
    pub(crate) fn unless(reason: Option<&'static str>) -> Self {
        reason.map_or(Self::Run, Self::LeftOut)
    }

    /// Whether the part runs.
    pub(crate) fn runs(self) -> bool {
        self == Self::Run
    }

    /// Returns the reason for skipping the part; `None` if it runs.
    pub(crate) fn reason(self) -> Option<&'static str> {
        match self {
            Self::Run => None,
            Self::LeftOut(reason) => Some(reason),
        }
    }
}

/// Location of a mesh's bounding box relative to the frustum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Containment {
    /// Wholly beyond one plane.
    Outside,
    /// Wholly inside all planes.
    Inside,
    /// Neither is certain.
    Crossing,
}

/// Numbers of culled clusters of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Unseen {
    /// Number of clusters outside the view.
    pub(crate) outside: usize,
    /// Number of other clusters whose triangles all have the culled facing.
    pub(crate) turned_away: usize,
    /// Number of clusters, culled or not.
    pub(crate) all: usize,
}

impl Unseen {
    /// Returns the sums over several draws.
    pub(crate) fn of<'a>(plans: impl IntoIterator<Item = &'a DrawPlan>) -> Self {
        plans.into_iter().fold(Self::default(), |sum, DrawPlan { clusters, .. }| Self {
            outside: sum.outside + clusters.outside,
            turned_away: sum.turned_away + clusters.turned_away,
            all: sum.all + clusters.all,
        })
    }

    /// Returns the number of culled clusters.
    pub(crate) fn left_out(&self) -> usize {
        self.outside + self.turned_away
    }

    /// Returns a description in words.
    pub(crate) fn told(self) -> String {
        let Self { outside, turned_away, all } = self;
        format!("{} of {all}: {outside} wholly outside the view, {turned_away} culled by facing", self.left_out())
    }
}

/// Plan of one draw: a step for every [`Part`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DrawPlan {
    steps: [Step; Part::ALL.len()],
    transparency: Transparency,
    clusters: Unseen,
    /// Scale and offset of texture coordinates; `None` if they change nothing.
    #[serde(skip)]
    uv_transform: Option<[Vec2; 2]>,
    #[serde(skip)]
    eye: Eye,
    #[serde(skip)]
    first_triangle: TriangleId,
}

impl DrawPlan {
    /// Returns the plan of one instance.
    pub(crate) fn new(
        library: &Library,
        instance: &Instance,
        camera: &Camera,
        settings: &Settings,
        containment: Containment,
    ) -> Self {
        let forced = |part: Part| matches!(settings.force, Force::Everything) || part.force() == Some(settings.force);
        let outside = (containment == Containment::Outside && !forced(Part::Vertices))
            .then_some("the whole object is outside the view");
        let transparency = transparency(library, instance, settings.shading);
        let steps = Part::ALL.map(|part| {
            let drawn = (instance, containment, transparency);
            let reason = outside.or_else(|| left_out(part, library, drawn, camera, settings));
            let can_run = outside.is_none() && part.can_run(library, instance, settings);
            Step::unless(reason.filter(|_| !(forced(part) && can_run)))
        });
        let Material { uv_scale, uv_offset, .. } = *library.material(instance.material);
        let uv_transform = [uv_scale, uv_offset];
        Self {
            steps,
            transparency,
            clusters: Unseen::default(),
            uv_transform: (uv_transform != [Vec2::ONE, Vec2::ZERO]).then_some(uv_transform),
            eye: Eye::of(camera),
            first_triangle: TriangleId(0),
        }
    }

    /// Returns the plan with the identifier of its instance's first triangle set.
    pub(super) fn starting_at(self, first_triangle: TriangleId) -> Self {
        Self { first_triangle, ..self }
    }

    /// Returns the identifier of its instance's first triangle.
    pub(super) fn first_triangle(&self) -> TriangleId {
        self.first_triangle
    }

    /// Returns the viewpoint of the draw.
    pub(super) fn eye(&self) -> Eye {
        self.eye
    }

    /// Returns the scale and offset that the material applies to texture coordinates of vertices; `None` if they change
    /// nothing.
    pub(crate) fn uv_transform(&self) -> Option<[Vec2; 2]> {
        self.uv_transform
    }

    /// Returns the plan with the culled clusters recorded, if there are any.
    pub(super) fn without(mut self, clusters: Unseen) -> Self {
        if clusters.left_out() > 0 {
            self.steps[Part::EveryCluster as usize] =
                Step::LeftOut("clusters wholly outside the view or culled by facing");
            self.clusters = clusters;
        }
        self
    }

    /// Whether clusters may be culled at all.
    pub(super) fn may_leave_out_clusters(settings: &Settings, containment: Containment) -> bool {
        let some = match containment {
            // Skipped as a whole, or forced to run.
            Containment::Outside => false,
            Containment::Inside => settings.culling != Culling::None,
            Containment::Crossing => true,
        };
        some && !matches!(settings.force, Force::Everything | Force::Clusters)
    }

    /// Returns the numbers of culled clusters; all zero if none is culled.
    pub(crate) fn clusters(&self) -> Unseen {
        self.clusters
    }

    /// Whether both plans run the same parts, for the same reasons, whatever their numbers of culled clusters.
    pub(crate) fn agrees_with(&self, other: &Self) -> bool {
        (self.steps, self.transparency) == (other.steps, other.transparency)
    }

    /// Returns how the draw combines with what was drawn before. It is not optional: it determines the picture.
    pub fn transparency(&self) -> Transparency {
        self.transparency
    }

    /// Returns the step of a part.
    pub(crate) fn step(&self, part: Part) -> Step {
        self.steps[part as usize]
    }

    /// Whether a part runs.
    pub fn runs(&self, part: Part) -> bool {
        self.step(part).runs()
    }
}

/// Returns the reason for skipping `part` in a draw that is not outside the view; `None` if the part is needed.
fn left_out(
    part: Part,
    library: &Library,
    (instance, containment, transparency): (&Instance, Containment, Transparency),
    camera: &Camera,
    settings: &Settings,
) -> Option<&'static str> {
    let mesh = library.mesh(instance.mesh);
    let shading = settings.shading;
    let reads_albedo = shading.reads_material();
    let lit = shading.is_lit();
    let material = library.material(instance.material);
    let textured = || textures_read(library, instance, shading).iter().any(Option::is_some);
    match part {
        // Clusters are culled later, in `DrawPlan::without`.
        Part::Vertices | Part::EveryCluster => None,
        Part::Clipping => (containment == Containment::Inside).then_some("the whole object is inside the view"),
        Part::Culling => (settings.culling == Culling::None).then_some("culling is off"),
        Part::Depth => (settings.depth_test == DepthTest::Off).then_some("the depth test is off"),
        Part::PerspectiveDivision if settings.interpolation != Interpolation::Perspective => {
            Some("interpolation is affine")
        }
        Part::PerspectiveDivision => {
            matches!(camera.projection, Projection::Orthographic { .. }).then_some("all w are equal: orthographic view")
        }
        Part::TextureCoordinates | Part::Texels if mesh.uvs.is_empty() => Some("the mesh has no texture coordinates"),
        Part::TextureCoordinates if matches!(shading, Shading::Uv | Shading::Checker) => None,
        Part::TextureCoordinates | Part::Texels if !reads_albedo && !textured() => {
            Some("this shading reads no texture")
        }
        Part::TextureCoordinates | Part::Texels => (!textured()).then_some("the material has no texture"),
        Part::Normals => (!lit && shading != Shading::Normals).then_some("this shading reads no normal"),
        Part::VertexColors if mesh.colors.is_empty() => Some("the mesh has no vertex colours"),
        Part::VertexColors => {
            (!reads_albedo && shading != Shading::VertexColor).then_some("this shading reads no vertex colour")
        }
        Part::CutOut | Part::Blending if !reads_albedo => Some("this shading ignores opacity and alpha"),
        Part::CutOut => match transparency {
            Transparency::Opaque => Some("no texture that is read has alpha"),
            Transparency::CutOut => None,
            Transparency::Blended => Some("the material is blended instead"),
        },
        Part::Light => (!lit).then_some("this shading is unlit"),
        Part::NormalMap if !shading.reads_pixel_normals() => Some("this shading reads no per-pixel normal"),
        Part::NormalMap if mesh.uvs.is_empty() => Some("the mesh has no texture coordinates"),
        Part::NormalMap => material.normal_texture.is_none().then_some("the material has no normal map"),
        Part::Highlight if shading != Shading::BlinnPhong => Some("this shading has no highlight"),
        Part::Highlight => (material.specular == Vec3::ZERO).then_some("the material's specular colour is black"),
        Part::Emission if !reads_albedo => Some("this shading ignores emission"),
        Part::Emission => (material.emission == Vec3::ZERO).then_some("the material emits no light"),
        Part::Blending => match transparency {
            Transparency::Opaque => Some("material and texture are opaque"),
            Transparency::CutOut => Some("every alpha is 0 or 1: alpha-tested instead"),
            Transparency::Blended => None,
        },
    }
}

/// Returns the transparency of an instance under a shading. Shadings that ignore the material are opaque.
pub(super) fn transparency(library: &Library, instance: &Instance, shading: Shading) -> Transparency {
    if !shading.reads_material() {
        return Transparency::Opaque;
    }
    let [color, dark, alpha, ..] = textures_read(library, instance, shading);
    let with_alpha = [color, dark, alpha].into_iter().flatten();
    library.material(instance.material).transparency(library, with_alpha)
}

/// Returns the textures that a shading reads on an instance: colour, dark colour, opacity, normal map, emission.
fn textures_read(library: &Library, instance: &Instance, shading: Shading) -> [Option<TextureId>; 5] {
    let material = library.material(instance.material);
    let has_coordinates = !library.mesh(instance.mesh).uvs.is_empty();
    let reads_material = has_coordinates && shading.reads_material();
    [
        material.texture.filter(|_| reads_material),
        material.dark_texture.filter(|_| has_coordinates && shading == Shading::Cel),
        material.alpha_texture.filter(|_| reads_material),
        material.normal_texture.filter(|_| has_coordinates && shading.reads_pixel_normals()),
        material.emission_texture.filter(|_| reads_material && material.emission != Vec3::ZERO),
    ]
}
