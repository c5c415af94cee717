//! The default scene: solids and pawns on a chess floor that extends to the horizon.
//!
//! The floor is a grid of 4 × 4 large quads with a repeated texture. On it, errors in texture wrapping, filtering and
//! especially perspective-correct interpolation are obvious. The solids have textures, plain colours and vertex
//! colours, and occlude each other. The front edge of the floor lies below the picture and beyond the near plane, so no
//! triangle is clipped against the near plane.

use glam::{Mat4, Quat, Vec2, Vec3, Vec3Swizzles as _};

use super::Builtin;
use super::draft::SceneDraft;
use super::revolve::Profile;
use super::{shapes, textures};
use crate::scene::{Camera, MeshData};
use textures::srgb;

pub(super) const CHESS: Builtin = Builtin {
    id: "chess",
    title: "Chess floor",
    summary: "Solids on a chess floor that runs to the horizon: shows perspective, texture filtering, depth and \
              shading in one picture.",
    draft,
};

const BACKGROUND: [u8; 3] = [62, 68, 78];

/// Size of the floor along x and z, in world units. Its far edge fills the width of a 16:9 picture.
const FLOOR_SIZE: Vec2 = Vec2::new(104.0, 62.0);

/// World-space z of the floor's front edge, which lies below the bottom of the picture but beyond the near plane.
const FLOOR_FRONT_Z: f32 = 6.9;

/// Edge length of one tile, in world units.
const TILE: f32 = 1.5;

/// Number of tiles per texture repeat, along u and v.
const TILES_PER_TEXTURE: f32 = 4.0;

/// Rotation of the rows of tiles relative to the picture, in radians.
const TILE_TURN: f32 = -0.2;

pub(super) fn draft() -> SceneDraft {
    let home = Camera { near: 0.5, far: 200.0, ..Camera::look_at(Vec3::new(0.0, 3.3, 9.6), Vec3::new(0.0, 0.95, 0.0)) };
    let mut draft = SceneDraft::new(BACKGROUND, home);
    add_floor(&mut draft);
    add_solids(&mut draft);
    add_pawns(&mut draft);
    draft
}

fn add_floor(draft: &mut SceneDraft) {
    let center = Vec3::new(0.0, 0.0, FLOOR_FRONT_Z - FLOOR_SIZE.y * 0.5);
    let scale = Vec3::new(FLOOR_SIZE.x, 1.0, FLOOR_SIZE.y);
    let world_from_model = Mat4::from_scale_rotation_translation(scale, Quat::IDENTITY, center);
    let tiled = shapes::mapped(shapes::grid(4), |position, _| floor_uv(world_from_model.transform_point3(position)));
    let mesh = draft.mesh(tiled);
    let stone = draft.textured("chess tiles", textures::chess(512, srgb(0xE6_DC_CB), srgb(0x46_54_60)));
    draft.place("floor", mesh, stone, world_from_model);
}

/// Returns the texture coordinates of the floor at a world position. The world origin is at the centre of a texture
/// repeat.
fn floor_uv(world: Vec3) -> Vec2 {
    Vec2::from_angle(-TILE_TURN).rotate(world.xz()) / (TILE * TILES_PER_TEXTURE) + 0.5
}

/// Returns the world position of the centre of a floor tile, with column and row counted from the origin.
fn on_tile(column: i32, row: i32) -> Vec3 {
    let middle = (Vec2::new(column as f32, row as f32) + 0.5) * TILE;
    let turned = Vec2::from_angle(TILE_TURN).rotate(middle);
    Vec3::new(turned.x, 0.0, turned.y)
}

fn add_solids(draft: &mut SceneDraft) {
    let knot = draft.mesh(shapes::painted(shapes::trefoil(0.24, 160, 12), |uv| ribbon_color(uv.x)));
    let white = draft.plain("vertex colours", Vec3::ONE);
    let upright = Quat::from_rotation_y(0.25) * Quat::from_rotation_x(1.35);
    draft.place("knot", knot, white, placed(Vec3::new(0.15, 1.62, -1.2), upright, 1.0));

    let sphere = draft.mesh(shapes::sphere(40));
    let marble = draft.textured("green marble", textures::marble(256, srgb(0x2F_7F_74), srgb(0xD8_EA_DF)));
    draft.place("sphere", sphere, marble, placed(Vec3::new(2.7, 0.95, 0.7), Quat::from_rotation_y(0.6), 0.95));

    let cube = draft.mesh(shapes::cube());
    let wood = draft.textured("crate", textures::crate_side(256, srgb(0xD9_A0_62)));
    draft.place("crate", cube, wood, placed(Vec3::new(-3.4, 0.9, -2.0), Quat::from_rotation_y(0.5), 0.9));

    let torus = draft.mesh(shapes::torus(0.36, 44, 18));
    let copper = draft.plain("copper", srgb(0xD6_8A_5C));
    draft.place("ring", torus, copper, placed(Vec3::new(0.75, 0.25, 2.7), Quat::IDENTITY, 0.7));

    let cone = draft.mesh(shapes::cone(2.6, 48));
    let gold = draft.plain("gold", srgb(0xE9_BE_4F));
    draft.place("cone", cone, gold, placed(Vec3::new(4.5, 0.0, -2.6), Quat::IDENTITY, 1.1));
}

/// Returns the colour at position `u`, from 0 to 1, of a cyclic gradient through coral, amber, green, azure and violet,
/// as sRGB values.
fn ribbon_color(u: f32) -> Vec3 {
    let colors = [0xF2_5F_4C, 0xF7_B5_45, 0x5C_BF_6C, 0x35_A7_DF, 0x7C_58_D8].map(srgb);
    let place = u * colors.len() as f32;
    let index = place as usize;
    colors[index % colors.len()].lerp(colors[(index + 1) % colors.len()], place.fract())
}

fn add_pawns(draft: &mut SceneDraft) {
    let mesh = draft.mesh(pawn());
    let ivory = draft.plain("ivory", srgb(0xF3_E7_CF));
    let ebony = draft.plain("ebony", srgb(0x5C_4A_4C));
    let tiles = [
        ("ivory pawn 1", ivory, -2, 0),
        ("ivory pawn 2", ivory, -5, -3),
        ("ivory pawn 3", ivory, -4, -7),
        ("ebony pawn 1", ebony, 2, -4),
        ("ebony pawn 2", ebony, 6, -3),
        ("ebony pawn 3", ebony, 5, -8),
    ];
    for (name, material, column, row) in tiles {
        draft.place(name, mesh, material, placed(on_tile(column, row), Quat::IDENTITY, 1.0));
    }
}

/// Returns a chess pawn standing on y = 0, 1.9 world units high.
fn pawn() -> MeshData {
    Profile::from(0.0, 1.9)
        .arc_to(0.19, 1.22, 146.0, 9)
        .line_to(0.34, 1.18)
        .arc_to(0.34, 1.08, 180.0, 4)
        .line_to(0.2, 1.05)
        .arc_to(0.46, 0.36, -40.0, 6)
        .line_to(0.56, 0.3)
        .arc_to(0.62, 0.18, 120.0, 4)
        .line_to(0.62, 0.0)
        .line_to(0.0, 0.0)
        .revolve("pawn", 24)
}

/// Returns the model matrix for a position, a rotation and a uniform scale.
fn placed(place: Vec3, turn: Quat, scale: f32) -> Mat4 {
    Mat4::from_scale_rotation_translation(Vec3::splat(scale), turn, place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::DepthMapping;
    use crate::scene::builtin::shapes::tests::{assert_closed, assert_faces_agree};

    #[test]
    fn a_pawn_is_a_closed_solid() {
        assert_closed(&pawn());
        assert_faces_agree(&pawn());
    }

    #[test]
    fn pawns_stand_in_the_middle_of_tiles() {
        for (column, row) in [(0, 0), (-5, -3), (6, -11)] {
            let tile = floor_uv(on_tile(column, row)) * TILES_PER_TEXTURE;
            let expected = Vec2::new(column as f32, row as f32) + 0.5 + TILES_PER_TEXTURE * 0.5;
            assert!(tile.distance(expected) < 1e-4, "{tile}");
        }
    }

    #[test]
    fn the_floor_fills_the_bottom_of_wide_pictures() {
        let home = CHESS.build().home;
        for aspect in [1.6, 16.0 / 9.0] {
            let world_from_clip = home.clip_from_world(aspect, DepthMapping::STANDARD).inverse();
            for x in [-1.0, 1.0] {
                let toward = world_from_clip.project_point3(Vec3::new(x, -1.0, 0.5)) - home.eye;
                let hit = home.eye - toward * (home.eye.y / toward.y);
                assert!(hit.z < FLOOR_FRONT_Z && hit.x.abs() < FLOOR_SIZE.x * 0.5, "{aspect}: {hit}");
            }
        }
    }

    #[test]
    fn nothing_crosses_the_near_plane() {
        let scene = CHESS.build();
        let view_from_world = scene.home.view_from_world();
        for instance in &scene.instances {
            for position in &scene.library.mesh(instance.mesh).positions {
                let p = view_from_world.transform_point3(instance.world_from_model.transform_point3(*position));
                assert!(-p.z > scene.home.near, "{}: {p}", instance.name);
            }
        }
    }
}
