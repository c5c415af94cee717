//! Test scenes that the fuzz targets draw as well: a builder of scenes, its objects and textures, and seeded randomness.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::{Mat4, Quat, Vec2, Vec3};
use rasterscope::chain::{Frame, Recipe, run};
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Camera, Instance, Library, Material, Mesh, MeshData, Scene, Texture};

/// Returns a random number in [−1, 1).
pub(crate) fn signed(rng: &mut fastrand::Rng) -> f32 {
    rng.f32() * 2.0 - 1.0
}

/// Returns a random vector in the cube [−1, 1)³.
pub(crate) fn in_cube(rng: &mut fastrand::Rng) -> Vec3 {
    Vec3::new(signed(rng), signed(rng), signed(rng))
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
            views: Vec::new(),
            light: None,
            animation: None,
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

/// Renders a scene from its home view.
pub(crate) fn render(scene: &Scene, recipe: &Recipe, (width, height): (u32, u32)) -> Frame {
    run(scene, &scene.home, recipe, Viewport { width, height }, &mut ())
}
