//! Changes of a scene that have the effect of a fault: meshes, materials and transforms.

use std::sync::Arc;

use glam::{Mat3, Mat4, Vec2, Vec3};
use rasterscope_engine::image::color::{decode, encode};
use rasterscope_engine::pipeline::settings::{BlendingOrder, ColorSpace, DepthFormat, DepthTest};
use rasterscope_engine::scene::{Instance, Material, Mesh, MeshData};

use crate::setup::{Setup, edit};

/// Opacity at which a surface is drawn like a translucent one, without depth, but hides what is behind it: the remaining
/// share is far below half a code.
const ALMOST_OPAQUE: f32 = 1.0 - 1e-6;

/// Largest number of triangles that are sorted, each of which may become an object of its own.
const MOST_SORTED: usize = 20_000;

/// Mirrors all objects about the origin: `signs` is −1 for each mirrored axis, otherwise 1.
pub(crate) fn mirror(setup: &mut Setup, signs: Vec3) {
    let mirror = Mat4::from_scale(signs);
    for instance in &mut edit(&mut setup.scene).instances {
        instance.world_from_model = mirror * instance.world_from_model;
    }
}

/// Removes all objects, so that only the background is drawn.
pub(crate) fn remove_objects(setup: &mut Setup) {
    edit(&mut setup.scene).instances.clear();
}

/// Sorts all triangles by descending `distance`, a function of their corners in world space, and draws them in this
/// order without a depth test. Scenes of more than [`MOST_SORTED`] triangles stay as they are.
pub(crate) fn sort_triangles(setup: &mut Setup, distance: impl Fn([Vec3; 3]) -> f32) {
    if setup.scene.triangle_count() > MOST_SORTED {
        return;
    }
    setup.recipe.pipeline.blending.order = BlendingOrder::Objects;
    // Without a material, as in pictures of ids, surfaces are opaque.
    setup.recipe.pipeline.depth_test = DepthTest::Off;
    change_materials(setup, |material| material.opacity = material.opacity.min(ALMOST_OPAQUE));
    let scene = edit(&mut setup.scene);
    let mut triangles = Vec::new();
    for (index, instance) in scene.instances.iter().enumerate() {
        let mesh = scene.library.mesh(instance.mesh);
        let world = |vertex: u32| instance.world_from_model.transform_point3(mesh.positions[vertex as usize]);
        triangles.extend(mesh.triangles.iter().map(|corners| (distance(corners.map(world)), index, *corners)));
    }
    triangles.sort_by(|(a, ..), (b, ..)| b.total_cmp(a));
    let objects = std::mem::take(&mut scene.instances);
    for run in triangles.chunk_by(|(_, a, _), (_, b, _)| a == b) {
        let object = &objects[run[0].1];
        let mesh = scene.library.mesh(object.mesh);
        let corners: Vec<_> = run.iter().map(|(.., corners)| *corners).collect();
        if let Ok(part) = Mesh::new(separate_corners(mesh, &corners)) {
            let mesh = scene.library.add_mesh(part);
            scene.instances.push(Instance { mesh, ..object.clone() });
        }
    }
}

/// Replaces the texture coordinates uv, with v down, by uv · `scale` + `offset`.
pub(crate) fn change_uv(setup: &mut Setup, scale: Vec2, offset: Vec2) {
    change_materials(setup, |material| {
        material.uv_scale *= scale;
        material.uv_offset = material.uv_offset * scale + offset;
    });
}

/// Moves every texture by a number of texels, to the left and up if it is positive.
pub(crate) fn move_texels(setup: &mut Setup, texels: Vec2) {
    let scene = Arc::clone(&setup.scene);
    change_materials(setup, |material| {
        if let Some(id) = material.texture {
            let (width, height) = scene.library.texture(id).image().size();
            material.uv_offset += texels / Vec2::new(width as f32, height as f32);
        }
    });
}

/// Removes the colour textures.
pub(crate) fn remove_textures(setup: &mut Setup) {
    change_materials(setup, |material| material.texture = None);
}

/// Changes translucent materials: `change` maps an opacity to another opacity and a factor for the colour.
pub(crate) fn change_opacity(setup: &mut Setup, change: impl Fn(f32) -> (f32, f32)) {
    let space = setup.recipe.pipeline.color_space;
    change_materials(setup, |material| {
        if material.opacity > 0.0 && material.opacity < 1.0 {
            let (opacity, factor) = change(material.opacity);
            material.opacity = opacity;
            material.diffuse = Vec3::from(material.diffuse.to_array().map(|code| match space {
                ColorSpace::Linear => encode(decode(code) * factor),
                ColorSpace::Bytes => code * factor,
            }));
        }
    });
}

/// Replaces every normal, in model space.
pub(crate) fn change_normals(setup: &mut Setup, change: impl Fn(Vec3) -> Vec3) {
    change_meshes(setup, |mesh| MeshData {
        normals: mesh.normals.iter().map(|normal| change(*normal)).collect(),
        ..(**mesh).clone()
    });
}

/// Gives each triangle its own normal.
pub(crate) fn use_face_normals(setup: &mut Setup) {
    change_meshes(setup, |mesh| {
        let mut separate = separate_corners(mesh, &mesh.triangles);
        for (corners, normals) in separate.positions.chunks_exact(3).zip(separate.normals.chunks_exact_mut(3)) {
            normals.fill((corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Z));
        }
        separate
    });
}

/// Computes the normals from the positions.
pub(crate) fn recompute_normals(setup: &mut Setup) {
    change_meshes(setup, |mesh| MeshData { normals: Vec::new(), ..(**mesh).clone() });
}

/// Gives every object normals that `world_from_normal` takes to world space, instead of the inverse transpose of its
/// transform.
pub(crate) fn transform_normals_by(setup: &mut Setup, world_from_normal: impl Fn(Mat3) -> Mat3) {
    let scene = edit(&mut setup.scene);
    for instance in &mut scene.instances {
        let transform = Mat3::from_mat4(instance.world_from_model);
        // The pipeline multiplies by the inverse transpose, which this matrix undoes first.
        let change = transform.transpose() * world_from_normal(transform);
        let mesh = scene.library.mesh(instance.mesh);
        let normals = mesh.normals.iter().map(|normal| (change * *normal).normalize_or(Vec3::Z)).collect();
        if let Ok(changed) = Mesh::new(MeshData { normals, ..(**mesh).clone() }) {
            instance.mesh = scene.library.add_mesh(changed);
        }
    }
}

/// Removes the triangles that cross the near plane.
pub(crate) fn drop_near_crossing(setup: &mut Setup) {
    let camera = setup.camera;
    change_world(setup, |_, positions, data| {
        let is_before = |vertex: &u32| (positions[*vertex as usize] - camera.eye).dot(camera.forward()) >= camera.near;
        data.triangles.retain(|corners| {
            let before = corners.iter().filter(|vertex| is_before(vertex)).count();
            before == 0 || before == corners.len()
        });
    });
}

/// Projects corners behind the eye as a division by a negative w does: mirrored through the eye.
pub(crate) fn project_through_eye(setup: &mut Setup) {
    let camera = setup.camera;
    change_world(setup, |model_from_world, positions, data| {
        for (position, world) in data.positions.iter_mut().zip(positions) {
            if (*world - camera.eye).dot(camera.forward()) < 0.0 {
                *position = model_from_world.transform_point3(2.0 * camera.eye - *world);
            }
        }
    });
    ignore_near_plane(setup);
}

/// Moves the near plane to the eye. Reversed depths keep their precision there.
pub(crate) fn ignore_near_plane(setup: &mut Setup) {
    setup.camera.near *= 1e-3;
    setup.recipe.pipeline.depth_format = DepthFormat::ReversedF32;
}

/// Changes the mesh of each object with knowledge of its positions in world space. `change` gets the transform from
/// world space to model space, the positions in world space, and the arrays to change.
fn change_world(setup: &mut Setup, change: impl Fn(Mat4, &[Vec3], &mut MeshData)) {
    let scene = edit(&mut setup.scene);
    for instance in &mut scene.instances {
        let mut data = (**scene.library.mesh(instance.mesh)).clone();
        let world: Vec<_> = data.positions.iter().map(|p| instance.world_from_model.transform_point3(*p)).collect();
        change(instance.world_from_model.inverse(), &world, &mut data);
        if let Ok(changed) = Mesh::new(data) {
            instance.mesh = scene.library.add_mesh(changed);
        }
    }
}

/// Replaces every mesh. Meshes whose new arrays are invalid stay as they are.
fn change_meshes(setup: &mut Setup, change: impl Fn(&Mesh) -> MeshData) {
    let scene = edit(&mut setup.scene);
    scene.library = scene.library.with_meshes(|mesh| Mesh::new(change(mesh)).unwrap_or_else(|_| mesh.clone()));
}

fn change_materials(setup: &mut Setup, change: impl Fn(&mut Material)) {
    let scene = edit(&mut setup.scene);
    scene.library = scene.library.with_materials(|material| {
        let mut changed = material.clone();
        change(&mut changed);
        changed
    });
}

/// Returns the arrays of a mesh of some of the triangles, with three vertices of its own for each.
fn separate_corners(mesh: &Mesh, triangles: &[[u32; 3]]) -> MeshData {
    let corners = || triangles.iter().flatten().map(|vertex| *vertex as usize);
    MeshData {
        name: mesh.name.clone(),
        positions: corners().map(|vertex| mesh.positions[vertex]).collect(),
        normals: corners().map(|vertex| mesh.normals[vertex]).collect(),
        uvs: if mesh.uvs.is_empty() { Vec::new() } else { corners().map(|vertex| mesh.uvs[vertex]).collect() },
        colors: if mesh.colors.is_empty() { Vec::new() } else { corners().map(|vertex| mesh.colors[vertex]).collect() },
        triangles: (0..triangles.len() as u32).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner)).collect(),
    }
}
