//! Shared helpers of the integration tests: seeded randomness, small scenes, and the geometry stages on bare clip-space
//! vertices.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Mat4, Quat, Vec2, Vec3};
use rasterscope::chain::{Frame, Recipe, run};
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::from_clip_space;
use rasterscope::pipeline::observe::Observer;
use rasterscope::pipeline::raster::{AnyTriangle, RasterSample, cover};
use rasterscope::pipeline::settings::{Arithmetic, Choice, DepthBias, FillRule, Rasterizer};
use rasterscope::pipeline::vertex::ClipVertex;
use rasterscope::pipeline::viewport::{ScreenTriangle, Viewport};
use rasterscope::scene::{Camera, Instance, Library, Material, Mesh, MeshData, Scene, Texture};

/// Returns the four fill rules under which shared edges are drawn exactly once.
pub(crate) fn sound_fill_rules() -> impl Iterator<Item = FillRule> {
    FillRule::ALL.iter().copied().filter(|r| !matches!(r, FillRule::Inclusive | FillRule::Exclusive))
}

/// Depth biases of both signs: constant, slope-scaled, both at once, and large enough to clamp depths.
pub(crate) const DEPTH_BIASES: [DepthBias; 5] = [
    DepthBias { constant: 3.0, slope: 0.0 },
    DepthBias { constant: 0.0, slope: -1.5 },
    DepthBias { constant: -700.0, slope: 2.0 },
    DepthBias { constant: -5e6, slope: 0.0 },
    DepthBias { constant: 1e6, slope: 40.0 },
];

/// Runs `test` with the seeds 0 to `count` − 1, and prints the seed if it panics.
pub(crate) fn for_seeds(count: u64, mut test: impl FnMut(&mut fastrand::Rng)) {
    for seed in 0..count {
        let _named = NameSeedOnPanic(seed);
        test(&mut fastrand::Rng::with_seed(seed));
    }
}

struct NameSeedOnPanic(u64);

impl Drop for NameSeedOnPanic {
    #[expect(clippy::print_stderr, reason = "a failing random test must name its seed")]
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("failed with seed {}", self.0);
        }
    }
}

/// Returns a random number in [−1, 1).
pub(crate) fn signed(rng: &mut fastrand::Rng) -> f32 {
    rng.f32() * 2.0 - 1.0
}

/// Returns a random vector in the cube [−1, 1)³.
pub(crate) fn in_cube(rng: &mut fastrand::Rng) -> Vec3 {
    Vec3::new(signed(rng), signed(rng), signed(rng))
}

/// Returns a clip-space vertex without attributes that projects to the position (x, y), in pixels of `viewport`.
pub(crate) fn clip_vertex(viewport: Viewport, (x, y): (f32, f32), depth: f32, w: f32) -> ClipVertex {
    let ndc = Vec3::new(x / viewport.width as f32 * 2.0 - 1.0, 1.0 - y / viewport.height as f32 * 2.0, depth);
    ClipVertex::at((ndc * w).extend(w))
}

/// Clips and projects clip-space triangles in fixed-point arithmetic.
pub(crate) fn screen_triangles(
    vertices: &[ClipVertex],
    triangles: &[[u32; 3]],
    viewport: Viewport,
    observer: &mut impl Observer,
) -> Vec<ScreenTriangle> {
    from_clip_space(vertices, triangles, Arithmetic::Fixed, viewport, observer)
}

/// Returns the samples of a picture that a triangle covers, in fixed-point arithmetic.
pub(crate) fn covered(
    triangle: &ScreenTriangle,
    rasterizer: Rasterizer,
    rule: FillRule,
    viewport: Viewport,
) -> Vec<RasterSample> {
    let corners_px = triangle.corners_px();
    let spans = cover(rasterizer, Arithmetic::Fixed, corners_px, rule, viewport);
    let pixels = spans.into_iter().flat_map(|span| (span.left..span.right).map(move |x| (x, span.row)));
    let triangle = AnyTriangle::new(Arithmetic::Fixed, corners_px, rule);
    triangle.map_or_else(Vec::new, |triangle| pixels.map(|pixel| triangle.sample(pixel)).collect())
}

/// Returns a mesh with texture coordinates derived from x and y, and a colour per vertex derived from its index.
pub(crate) fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let uvs = positions.iter().map(|p| Vec2::new(p.x, -p.y) * 0.5 + 0.5).collect();
    let colors = (0..positions.len()).map(|i| Vec3::new(1.0, 0.5 + 0.5 * (i % 2) as f32, 0.6)).collect();
    Mesh::new(MeshData { name: "mesh".into(), positions, uvs, colors, triangles, ..MeshData::default() })
        .expect("test meshes are valid")
}

/// Returns the triangles of a grid of `columns` × `rows` cells whose vertices are numbered row by row.
pub(crate) fn grid_triangles(columns: u32, rows: u32) -> Vec<[u32; 3]> {
    let at = |x: u32, y: u32| y * (columns + 1) + x;
    let cells = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    cells
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            // Diagonals alternate, so that both directions occur.
            if (x + y) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        })
        .collect()
}

/// Returns the square [−1, 1]² at z = 0, divided into 4 × 4 cells.
pub(crate) fn plane() -> Mesh {
    let positions = (0..25).map(|i| Vec3::new((i % 5) as f32, (i / 5) as f32, 0.0) * 0.5 - Vec3::new(1.0, 1.0, 0.0));
    mesh(positions.collect(), grid_triangles(4, 4))
}

/// Returns the cube [−1, 1]³, whose faces are counter-clockwise when seen from outside.
pub(crate) fn cube() -> Mesh {
    let around_y = [0.0, 0.25, 0.5, 0.75].map(|turn| Quat::from_rotation_y(turn * TAU));
    let around_x = [0.25, 0.75].map(|turn| Quat::from_rotation_x(turn * TAU));
    let corners = [Vec3::new(-1.0, -1.0, 1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::ONE, Vec3::new(-1.0, 1.0, 1.0)];
    let positions = around_y.into_iter().chain(around_x).flat_map(|q| corners.map(|c| (q * c).round())).collect();
    let triangles = (0..6).flat_map(|f| [[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|i| f * 4 + i))).collect();
    let uvs = [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO].repeat(6);
    Mesh::new(MeshData { name: "cube".into(), positions, uvs, triangles, ..MeshData::default() })
        .expect("test meshes are valid")
}

/// Returns a mesh of `count` random triangles in [−1, 1]³ that intersect each other.
pub(crate) fn soup(rng: &mut fastrand::Rng, count: u32) -> Mesh {
    mesh((0..count * 3).map(|_| in_cube(rng)).collect(), (0..count).map(|i| [0, 1, 2].map(|c| i * 3 + c)).collect())
}

/// Returns an opaque noise texture of 5 × 7 texels.
pub(crate) fn noise_texture(rng: &mut fastrand::Rng) -> Image<Rgba8> {
    Image::from_fn(5, 7, |_, _| [rng.u8(..), rng.u8(..), rng.u8(..), 255])
}

/// Returns the image with the alpha of each pixel replaced by a random element of `codes`.
pub(crate) fn with_alpha(rng: &mut fastrand::Rng, image: &Image<Rgba8>, codes: &[u8]) -> Image<Rgba8> {
    image.map(|[r, g, b, _]| [r, g, b, codes[rng.usize(..codes.len())]])
}

/// Builder of a scene, one object at a time.
pub(crate) struct SceneBuilder(pub(crate) Scene);

impl SceneBuilder {
    /// Creates an empty scene whose camera looks from `eye` to the origin.
    pub(crate) fn new(eye: Vec3) -> Self {
        let home = Camera::look_at(eye, Vec3::ZERO);
        Self(Scene {
            name: "test".into(),
            library: Library::default(),
            instances: Vec::new(),
            background: [30, 60, 90],
            home,
        })
    }

    /// Adds an opaque object, with a plain material or with a texture and a dark texture.
    pub(crate) fn with(self, mesh: Mesh, world_from_model: Mat4, textures: Option<[Image<Rgba8>; 2]>) -> Self {
        self.with_opacity(mesh, world_from_model, textures, 1.0)
    }

    /// Adds an object whose material has an opacity in [0, 1].
    pub(crate) fn with_opacity(
        mut self,
        mesh: Mesh,
        world_from_model: Mat4,
        textures: Option<[Image<Rgba8>; 2]>,
        opacity: f32,
    ) -> Self {
        let library = &mut self.0.library;
        let mut material = Material { opacity, ..Material::plain("material", Vec3::new(0.9, 0.8, 0.7)) };
        if let Some(images) = textures {
            let mut ids = images.map(|i| library.add_texture(Texture::new(i).expect("not empty"))).into_iter();
            (material.texture, material.dark_texture) = (ids.next(), ids.next());
        }
        let (mesh, material) = (library.add_mesh(mesh), library.add_material(material));
        let name = format!("object {}", self.0.instances.len());
        self.0.instances.push(Instance { name, mesh, material, world_from_model, tint: Vec3::ONE });
        self
    }
}

/// Returns a scene of textured ground that extends behind the eye, and a cube on it with a corner towards the light.
pub(crate) fn ground_and_cube() -> Scene {
    let mut rng = fastrand::Rng::with_seed(1);
    let mut textures = || [noise_texture(&mut rng), noise_texture(&mut rng)];
    let flat = Mat4::from_rotation_x(-FRAC_PI_2);
    SceneBuilder::new(Vec3::new(1.5, 1.2, 3.0))
        .with(plane(), Mat4::from_scale(Vec3::splat(6.0)) * flat, Some(textures()))
        .with(cube(), Mat4::from_translation(Vec3::Y * 0.6) * Mat4::from_rotation_y(0.5), Some(textures()))
        .0
}

/// Returns a scene of intersecting triangles, some around and behind the eye, most of them without textures.
pub(crate) fn soup_scene() -> Scene {
    let mut rng = fastrand::Rng::with_seed(2);
    SceneBuilder::new(Vec3::new(0.2, 0.3, 1.1))
        .with(soup(&mut rng, 25), Mat4::from_scale(Vec3::splat(1.5)), None)
        .with(soup(&mut rng, 8), Mat4::from_translation(Vec3::NEG_Z), Some([(); 2].map(|()| noise_texture(&mut rng))))
        .0
}

/// Returns an orthographic scene of two planes at exactly the same depth, and a cube that intersects them.
pub(crate) fn coplanar_scene() -> Scene {
    let mut rng = fastrand::Rng::with_seed(3);
    let mut scene = SceneBuilder::new(Vec3::new(0.0, 0.0, 4.0))
        .with(plane(), Mat4::IDENTITY, None)
        .with(
            plane(),
            Mat4::from_translation(Vec3::new(0.4, 0.3, 0.0)),
            Some([(); 2].map(|()| noise_texture(&mut rng))),
        )
        .with(cube(), Mat4::from_scale(Vec3::splat(0.5)) * Mat4::from_rotation_x(0.7), None)
        .0;
    scene.home = scene.home.with_orthographic(true);
    scene
}

/// Returns a scene of opaque, alpha-tested and blended surfaces that intersect and cover each other. Their transparency
/// comes from textures and from opacity.
pub(crate) fn transparency_scene() -> Scene {
    let mut rng = fastrand::Rng::with_seed(4);
    let soup = soup(&mut rng, 8);
    let mut textures = |codes: &[u8]| {
        Some([(); 2].map(|()| {
            let image = noise_texture(&mut rng);
            with_alpha(&mut rng, &image, codes)
        }))
    };
    let at = |z: f32, turn: f32| Mat4::from_translation(Vec3::Z * z) * Mat4::from_rotation_y(turn);
    SceneBuilder::new(Vec3::new(0.3, 0.4, 3.4))
        .with_opacity(cube(), at(0.5, 0.5) * Mat4::from_scale(Vec3::splat(0.5)), None, 0.4)
        .with(plane(), at(0.9, -0.2), textures(&[0, 255]))
        .with(plane(), at(-0.8, 0.1), textures(&[255]))
        .with(plane(), at(0.1, 0.3), textures(&[0, 90, 200, 255]))
        .with_opacity(plane(), at(-0.2, -0.4), textures(&[0, 255]), 0.7)
        .with_opacity(soup, Mat4::from_scale(Vec3::splat(2.0)), None, 0.25)
        .0
}

/// Returns a sphere of radius 1 around the origin, with 2 · `cells`² triangles in rows parallel to the equator.
pub(crate) fn sphere(cells: u32) -> Mesh {
    let side = cells + 1;
    let at = |i: u32| {
        let (longitude, latitude) = ((i % side) as f32 / cells as f32 * TAU, (i / side) as f32 / cells as f32 * PI);
        Vec3::new(latitude.sin() * longitude.cos(), -latitude.cos(), -latitude.sin() * longitude.sin())
    };
    mesh((0..side * side).map(at).collect(), grid_triangles(cells, cells))
}

/// Returns a parallelogram of 512 triangles that `edges` span from `corner`. Rows of triangles run along the first
/// edge.
pub(crate) fn sheet(corner: Vec3, edges: [Vec3; 2]) -> Mesh {
    const CELLS: u32 = 16;
    let side = CELLS + 1;
    let share = |i: u32| i as f32 / CELLS as f32;
    let at = |i: u32| corner + edges[0] * share(i % side) + edges[1] * share(i / side);
    mesh((0..side * side).map(at).collect(), grid_triangles(CELLS, CELLS))
}

/// Returns the scenes of this module, each with its name.
pub(crate) fn scenes() -> [(&'static str, Scene); 4] {
    [
        ("ground and cube", ground_and_cube()),
        ("soup", soup_scene()),
        ("coplanar", coplanar_scene()),
        ("transparency", transparency_scene()),
    ]
}

/// Renders a scene from its home view.
pub(crate) fn render(scene: &Scene, recipe: &Recipe, (width, height): (u32, u32)) -> Frame {
    run(scene, &scene.home, recipe, Viewport { width, height }, &mut ())
}

/// Returns the recipes without repetitions. Variations of several settings contain the default once per setting.
pub(crate) fn distinct(recipes: impl IntoIterator<Item = Recipe>) -> Vec<Recipe> {
    let mut distinct = Vec::new();
    for recipe in recipes {
        if !distinct.contains(&recipe) {
            distinct.push(recipe);
        }
    }
    distinct
}

/// Returns the default recipe changed by `assignments` such as `culling=none`.
pub(crate) fn recipe(assignments: &[&str]) -> Recipe {
    let mut recipe = Recipe::default();
    for assignment in assignments {
        recipe.set(assignment).expect("test recipes are valid");
    }
    recipe
}
