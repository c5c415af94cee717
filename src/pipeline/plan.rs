//! What a draw needs, and what is left out of it, each with its reason.
//!
//! A plan is made once per draw from mesh, material, view and settings; the stages read it instead of finding out per
//! triangle or per pixel. Leaving a part out never changes the picture. An attribute that is left out keeps one value at
//! all vertices: it is neither transformed nor interpolated, but clipping carries it along.

use glam::{Vec2, Vec3};
use serde::Serialize;

use super::settings::{Culling, DepthTest, Force, Interpolation, Settings, Shading};
use super::shade::Eye;
use crate::scene::{Camera, Instance, Library, Material, Projection, TextureId, Transparency, TriangleId};

/// A part of the work that a draw may not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Transforming vertices, and everything after.
    Vertices,
    /// The same for every cluster of a large mesh. One is left out if all of it lies outside the view, or if all its triangles
    /// show the side that is culled. That is decided by their *snapped* corners: those that are so small or so thin on the
    /// screen that snapping may turn one over are looked at one by one, however much they face away.
    EveryCluster,
    /// Cutting at the planes of the frustum.
    Clipping,
    /// Telling front from back.
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
    /// Asking the texture's alpha whether a fragment is there at all.
    CutOut,
    /// Computing light, at vertices (Gouraud) or per fragment.
    Light,
    /// Replacing the interpolated normal by that of a normal map.
    NormalMap,
    /// Adding the highlight of Blinn–Phong shading.
    Highlight,
    /// Adding emitted light.
    Emission,
    /// Mixing with what is drawn already, from far to near and without storing depth.
    Blending,
}

impl Part {
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
        Self::CutOut,
        Self::Light,
        Self::NormalMap,
        Self::Highlight,
        Self::Emission,
        Self::Blending,
    ];

    /// What makes it run without need, if anything can.
    pub fn force(self) -> Option<Force> {
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

    /// Whether it can run for an instance without another picture coming of it.
    fn can_run(self, library: &Library, instance: &Instance, settings: &Settings) -> bool {
        let mesh = library.mesh(instance.mesh);
        match self {
            Self::PerspectiveDivision => settings.interpolation == Interpolation::Perspective,
            Self::TextureCoordinates => !mesh.uvs.is_empty(),
            Self::VertexColors => !mesh.colors.is_empty(),
            // Each of them adds to the picture: it runs where it is needed, and nowhere else.
            Self::NormalMap | Self::Highlight | Self::Emission => false,
            _ => true,
        }
    }

    /// What a person calls it.
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
            Self::CutOut => "Alpha cut-out",
            Self::Light => "Light",
            Self::NormalMap => "Normal map",
            Self::Highlight => "Highlight",
            Self::Emission => "Emission",
            Self::Blending => "Blending",
        }
    }
}

/// Whether a part runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Step {
    /// It is needed.
    Run,
    /// It is not, because …
    LeftOut(&'static str),
}

impl Step {
    /// Runs if there is no reason against it.
    pub fn unless(reason: Option<&'static str>) -> Self {
        reason.map_or(Self::Run, Self::LeftOut)
    }

    /// Whether the part runs.
    pub fn runs(self) -> bool {
        self == Self::Run
    }

    /// Why it does not, if it does not.
    pub fn reason(self) -> Option<&'static str> {
        match self {
            Self::Run => None,
            Self::LeftOut(reason) => Some(reason),
        }
    }
}

/// Where the box around a mesh lies with respect to the frustum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Containment {
    /// Wholly beyond one plane.
    Outside,
    /// Wholly inside all planes.
    Inside,
    /// Neither is certain.
    Crossing,
}

/// How many clusters of a mesh show nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Unseen {
    /// Those that lie outside the view.
    pub outside: usize,
    /// Others that show the side that is culled.
    pub turned_away: usize,
    /// All clusters.
    pub all: usize,
}

impl Unseen {
    /// Of several draws together.
    pub fn of<'a>(plans: impl IntoIterator<Item = &'a DrawPlan>) -> Self {
        plans.into_iter().fold(Self::default(), |sum, DrawPlan { clusters, .. }| Self {
            outside: sum.outside + clusters.outside,
            turned_away: sum.turned_away + clusters.turned_away,
            all: sum.all + clusters.all,
        })
    }

    /// Those that are left out.
    pub fn left_out(&self) -> usize {
        self.outside + self.turned_away
    }

    /// In words.
    pub fn told(self) -> String {
        let Self { outside, turned_away, all } = self;
        format!("{} of {all}: {outside} wholly outside the view, {turned_away} turned away", self.left_out())
    }
}

/// The plan of one draw: a step for every [`Part`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DrawPlan {
    steps: [Step; Part::ALL.len()],
    transparency: Transparency,
    clusters: Unseen,
    /// Scale and offset of texture coordinates, unless they leave them as they are.
    #[serde(skip)]
    uv_transform: Option<[Vec2; 2]>,
    #[serde(skip)]
    eye: Eye,
    #[serde(skip)]
    first_triangle: TriangleId,
}

impl DrawPlan {
    /// Decides for one instance.
    pub fn new(
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

    /// Returns the plan for an instance whose first triangle has this identifier.
    pub(super) fn starting_at(self, first_triangle: TriangleId) -> Self {
        Self { first_triangle, ..self }
    }

    /// Identifier of the first triangle of its instance.
    pub(super) fn first_triangle(&self) -> TriangleId {
        self.first_triangle
    }

    /// The place that it is seen from.
    pub(super) fn eye(&self) -> Eye {
        self.eye
    }

    /// Scale and offset that the material applies to the texture coordinates of vertices, if any.
    pub fn uv_transform(&self) -> Option<[Vec2; 2]> {
        self.uv_transform
    }

    /// The same with some clusters left out, if there are any that show nothing.
    pub(super) fn without(mut self, clusters: Unseen) -> Self {
        if clusters.left_out() > 0 {
            self.steps[Part::EveryCluster as usize] =
                Step::LeftOut("clusters outside the view or turned away as a whole");
            self.clusters = clusters;
        }
        self
    }

    /// Whether clusters may be left out at all.
    pub(super) fn may_leave_out_clusters(settings: &Settings, containment: Containment) -> bool {
        let some = match containment {
            // Left out as a whole, or forced.
            Containment::Outside => false,
            Containment::Inside => settings.culling != Culling::None,
            Containment::Crossing => true,
        };
        some && !matches!(settings.force, Force::Everything | Force::Clusters)
    }

    /// How many clusters are left out, of how many; nothing if none is.
    pub fn clusters(&self) -> Unseen {
        self.clusters
    }

    /// Whether the same parts run as in another draw, and for the same reasons, however many clusters of either show nothing.
    pub fn agrees_with(&self, other: &Self) -> bool {
        (self.steps, self.transparency) == (other.steps, other.transparency)
    }

    /// How the draw meets what was drawn before it. Not a matter of what can be left out: it decides the picture.
    pub fn transparency(&self) -> Transparency {
        self.transparency
    }

    /// The step of a part.
    pub fn step(&self, part: Part) -> Step {
        self.steps[part as usize]
    }

    /// Whether a part runs.
    pub fn runs(&self, part: Part) -> bool {
        self.step(part).runs()
    }
}

/// The reason for which a draw that is not outside does without `part`.
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
        // Which clusters show something is known later: `DrawPlan::without`.
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
            Transparency::Blended => Some("it is blended instead"),
        },
        Part::Light => (!lit).then_some("this shading is unlit"),
        Part::NormalMap if !shading.reads_pixel_normals() => Some("this shading reads no normal in pixels"),
        Part::NormalMap if mesh.uvs.is_empty() => Some("the mesh has no texture coordinates"),
        Part::NormalMap => material.normal_texture.is_none().then_some("the material has no normal map"),
        Part::Highlight if shading != Shading::BlinnPhong => Some("this shading has no highlight"),
        Part::Highlight => (material.specular == Vec3::ZERO).then_some("the specular colour of the material is black"),
        Part::Emission if !reads_albedo => Some("this shading ignores emission"),
        Part::Emission => (material.emission == Vec3::ZERO).then_some("the material emits no light"),
        Part::Blending => match transparency {
            Transparency::Opaque => Some("material and texture are opaque"),
            Transparency::CutOut => Some("alpha is all or nothing: cut out instead"),
            Transparency::Blended => None,
        },
    }
}

/// How the instance meets what lies behind under a shading: those that ignore the material are opaque.
pub(super) fn transparency(library: &Library, instance: &Instance, shading: Shading) -> Transparency {
    if !shading.reads_material() {
        return Transparency::Opaque;
    }
    let [color, dark, alpha, ..] = textures_read(library, instance, shading);
    let with_alpha = [color, dark, alpha].into_iter().flatten();
    library.material(instance.material).transparency(library, with_alpha)
}

/// The textures that a shading reads somewhere on an instance: colour, its dark one, opacity, normal map, emission.
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
