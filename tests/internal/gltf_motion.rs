//! Motion in glTF files: node channels, skins and morph targets, against poses written out in f64.

use std::path::Path;
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::{DMat4, DQuat, DVec3, DVec4, Vec3};
use rasterscope::scene::obj::TrMeaning;
use rasterscope::scene::{Loaded, Scene, SceneSource};
use serde_json::{Value, json};

use crate::internal::gltf_builder::{GltfBuilder, SQUARE, SQUARE_INDICES};
use crate::internal::samples;
use crate::internal::sound::sound;

fn load(path: &Path) -> Result<Loaded, String> {
    let loaded = SceneSource::File(path.to_owned(), TrMeaning::Auto).load().map_err(|error| error.to_string())?;
    sound(&loaded).unwrap_or_else(|fault| panic!("{}: {fault}", path.display()));
    Ok(loaded)
}

fn built(builder: &GltfBuilder) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    load(&builder.write(folder.path())).unwrap_or_else(|error| panic!("{error}"))
}

/// Adds an animation with one sampler and channel for each track of node, property, interpolation and output accessor.
fn animate(builder: &mut GltfBuilder, input: usize, tracks: &[(usize, &str, &str, usize)]) {
    let sampler = |(_, _, interpolation, output): &(usize, &str, &str, usize)| json!({"input": input, "interpolation": interpolation, "output": output});
    let channel = |(index, (node, property, ..)): (usize, &(usize, &str, &str, usize))| json!({"sampler": index, "target": {"node": node, "path": property}});
    let samplers: Vec<Value> = tracks.iter().map(sampler).collect();
    let channels: Vec<Value> = tracks.iter().enumerate().map(channel).collect();
    builder.json["animations"] = json!([{"samplers": samplers, "channels": channels}]);
}

/// File of a square whose parent node moves in steps and along a spline, and whose own node turns about z.
fn moving() -> GltfBuilder {
    let mut builder = GltfBuilder::square();
    builder.json["nodes"] = json!([{"children": [1]}, {"mesh": 0, "translation": [0, 0, 3]}]);
    let times = builder.floats(&[0.0, 1.0, 2.0], 1);
    let half = f32::sqrt(0.5);
    let turns = builder.floats(&[0., 0., 0., 1., 0., 0., half, half, 0., 0., 1., 0.], 4);
    let scales = builder.floats(&[1., 1., 1., 2., 3., 1., 1., 1., 1.], 3);
    // In-tangent, position and out-tangent of each key frame.
    let spline = [[0., 0., 0.], [0., 0., 0.], [2., 0., 0.], [2., 0., 0.], [1., 1., 0.], [0., 4., 0.]];
    let spline = [&spline[..], &[[0., 0., 0.], [5., 0., 0.], [0., 0., 0.]]].concat();
    let places = builder.floats(spline.as_flattened(), 3);
    let tracks =
        [(0, "translation", "CUBICSPLINE", places), (0, "scale", "STEP", scales), (1, "rotation", "LINEAR", turns)];
    animate(&mut builder, times, &tracks);
    builder
}

#[test]
fn nodes_follow_their_channels() {
    let scene = Arc::new(built(&moving()).scene);
    assert_eq!(scene.animation.as_ref().unwrap().duration_s(), 2.0);
    for (time_s, key, share) in [(0.0_f64, 0, 0.0_f64), (0.3, 0, 0.3), (1.0, 1, 0.0), (1.6, 1, 0.6), (3.6, 1, 0.6)] {
        let ends = [
            [DVec3::ZERO, DVec3::X * 2.0, DVec3::X * 2.0, DVec3::new(1.0, 1.0, 0.0)],
            [DVec3::new(1.0, 1.0, 0.0), DVec3::Y * 4.0, DVec3::ZERO, DVec3::X * 5.0],
        ];
        let [value, tangent, next_tangent, next] = ends[key];
        let (t, tt, ttt) = (share, share * share, share * share * share);
        let place = value * (2.0 * ttt - 3.0 * tt + 1.0)
            + tangent * (ttt - 2.0 * tt + t)
            + next * (3.0 * tt - 2.0 * ttt)
            + next_tangent * (ttt - tt);
        let scale = [DVec3::ONE, DVec3::new(2.0, 3.0, 1.0)][key];
        let (sin, cos) = ((key as f64 + share) * std::f64::consts::FRAC_PI_2).sin_cos();
        let posed = scene.at(time_s).instances[0].world_from_model.as_dmat4();
        for corner in [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.5)] {
            let turned = DVec3::new(cos * corner.x - sin * corner.y, sin * corner.x + cos * corner.y, corner.z + 3.0);
            let off = posed.transform_point3(corner).distance(place + scale * turned);
            assert!(off < 1e-5, "{time_s} s, {corner}: off by {off}");
        }
    }
}

/// File of a square with two joints: the lower corners follow the first, the upper ones both.
fn skinned(weights: &[f32; 16]) -> GltfBuilder {
    let mut builder = GltfBuilder::empty();
    let positions = builder.floats(&SQUARE, 3);
    let normals = builder.floats(&[0., 0., 1.].repeat(4), 3);
    let indices = builder.indices(&SQUARE_INDICES);
    let joints = builder.floats(&[0., 1., 0., 0.].repeat(4), 4);
    let weights = builder.floats(weights, 4);
    let attributes = json!({"POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights});
    builder.mesh(json!({"attributes": attributes, "indices": indices}));
    builder.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "scale": [9, 9, 9], "children": [1]},
        {"translation": [1, 0, 0], "children": [2]},
        {"rotation": [0, 0, 0, 1]},
    ]);
    builder.json["skins"] = json!([{"joints": [1, 2]}]);
    let times = builder.floats(&[0.0, 2.0], 1);
    let half = f32::sqrt(0.5);
    let turns = builder.floats(&[0., 0., 0., 1., half, 0., 0., half], 4);
    animate(&mut builder, times, &[(2, "rotation", "LINEAR", turns)]);
    builder
}

const WEIGHTS: [f32; 16] = [1., 0., 0., 0., 1., 0., 0., 0., 0.25, 0.75, 0., 0., 0.5, 1.5, 0., 0.];

#[test]
fn skins_blend_the_transforms_of_their_joints() {
    let loaded = built(&skinned(&WEIGHTS));
    assert!(loaded.warnings.is_empty() && loaded.notes.is_empty(), "{:?} {:?}", loaded.warnings, loaded.notes);
    let scene = Arc::new(loaded.scene);
    for time_s in [0.0_f64, 0.7, 1.9] {
        let angle = time_s * std::f64::consts::FRAC_PI_4;
        let posed = scene.at(time_s);
        let mesh = &posed.library.meshes()[0];
        for (vertex, position) in SQUARE.as_chunks::<3>().0.iter().enumerate() {
            // The scale of the parent applies to the joints, not to the node of the mesh.
            let [x, y, z] = position.map(f64::from);
            let share = if vertex < 2 { 0.0 } else { 0.75 };
            let (sin, cos) = angle.sin_cos();
            let still = DVec3::new(x + 1.0, y, z) * 9.0;
            let turned = DVec3::new(x + 1.0, cos * y - sin * z, sin * y + cos * z) * 9.0;
            let expected = still * (1.0 - share) + turned * share;
            let off = mesh.positions[vertex].as_dvec3().distance(expected);
            assert!(off < 1e-5, "{time_s} s, vertex {vertex}: off by {off}");
            // The blended matrix in y and z, whose inverse transpose turns the normal (0, 0, 1).
            let (a, b) = (1.0 - share + share * cos, share * sin);
            let normal = DVec3::new(0.0, -b, a).normalize();
            assert!(mesh.normals[vertex].as_dvec3().distance(normal) < 1e-6, "{time_s} s, normal {vertex}");
        }
    }
}

#[test]
fn normals_of_a_stretched_skin_stay_perpendicular_to_it() {
    let mut builder = skinned(&WEIGHTS);
    let slanted = [0.6, 0., -0.8].repeat(4);
    let normals = builder.floats(&slanted, 3);
    let positions = builder.floats(&[0., 0., 0., 0.8, 0., 0.6, 0.8, 1., 0.6, 0., 1., 0.], 3);
    let attributes = &mut builder.json["meshes"][0]["primitives"][0]["attributes"];
    (attributes["POSITION"], attributes["NORMAL"]) = (json!(positions), json!(normals));
    for scale in [[3., 1., 1.], [1., 0.5, 4.], [1., 1., -1.]] {
        builder.json["nodes"][0]["scale"] = json!(scale);
        let scene = built(&builder).scene;
        let mesh = &scene.library.meshes()[0];
        for edge in [[0, 1], [1, 2]] {
            let along = (mesh.positions[edge[1]] - mesh.positions[edge[0]]).normalize();
            for end in edge {
                let cosine = along.dot(mesh.normals[end]);
                assert!(cosine.abs() < 1e-6, "{scale:?}, {edge:?}: {cosine}");
            }
        }
    }
}

/// File of a square with two morph targets, of which the second changes normals, too.
fn morphed() -> GltfBuilder {
    let mut builder = GltfBuilder::empty();
    let positions = builder.floats(&SQUARE, 3);
    let normals = builder.floats(&[0., 0., 1.].repeat(4), 3);
    let first = builder.floats(&[0., 0., 2.].repeat(4), 3);
    let second = builder.floats(&[1., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0.], 3);
    let tilts = builder.floats(&[1., 0., 0.].repeat(4), 3);
    let indices = builder.indices(&SQUARE_INDICES);
    let targets = json!([{"POSITION": first}, {"POSITION": second, "NORMAL": tilts}]);
    let attributes = json!({"POSITION": positions, "NORMAL": normals});
    builder.mesh(json!({"attributes": attributes, "indices": indices, "targets": targets}));
    builder
}

#[test]
fn morph_targets_move_vertices_by_their_weights() {
    let mut builder = morphed();
    let times = builder.floats(&[0.0, 1.0, 4.0], 1);
    let weights = builder.floats(&[0., 0., 1., 0., 0., 1.], 1);
    animate(&mut builder, times, &[(0, "weights", "LINEAR", weights)]);
    let scene = Arc::new(built(&builder).scene);
    for (time_s, first, second) in [(0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (1.75, 0.75, 0.25), (3.25, 0.25, 0.75)] {
        let posed = scene.at(time_s);
        let mesh = &posed.library.meshes()[0];
        assert!(mesh.positions[0].distance(Vec3::new(second, 0.0, 2.0 * first)) < 1e-6, "{:?}", mesh.positions);
        assert!(mesh.positions[2].distance(Vec3::new(1.0, 1.0, 2.0 * first)) < 1e-6, "{:?}", mesh.positions);
        assert!(mesh.normals[1].distance(Vec3::new(second, 0.0, 1.0).normalize()) < 1e-6, "{:?}", mesh.normals);
    }
}

#[test]
fn weights_without_an_animation_deform_a_still_mesh() {
    let shape = |builder: &GltfBuilder| {
        let scene = Arc::new(built(builder).scene);
        assert!(scene.animation.is_none() && Arc::ptr_eq(&scene.at(1.0), &scene));
        scene.library.meshes()[0].positions[0]
    };
    assert_eq!(shape(&morphed()), Vec3::ZERO);
    assert_eq!(shape(&morphed().with(|json| json["meshes"][0]["weights"] = json!([0.5, 1]))), Vec3::new(1.0, 0.0, 1.0));
    let of_node = morphed().with(|json| {
        json["meshes"][0]["weights"] = json!([0.5, 1]);
        json["nodes"][0]["weights"] = json!([2, 0]);
    });
    assert_eq!(shape(&of_node), Vec3::Z * 4.0);
}

#[test]
fn nodes_of_one_mesh_have_poses_of_their_own() {
    let mut builder = morphed();
    builder.json["nodes"] = json!([{"mesh": 0, "weights": [1, 0]}, {"mesh": 0}, {"mesh": 0, "weights": [0, 1]}]);
    builder.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    let scene = built(&builder).scene;
    let first = |instance: usize| scene.library.mesh(scene.instances[instance].mesh).positions[0];
    assert_eq!([0, 1, 2].map(first), [Vec3::Z * 2.0, Vec3::ZERO, Vec3::X]);
}

#[test]
fn the_first_of_several_animations_is_shown() {
    let builder = moving().with(|json| {
        let mut other = json["animations"][0].clone();
        other["name"] = json!("Jump");
        json["animations"].as_array_mut().unwrap().push(other);
        json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
        json["nodes"][1]["camera"] = json!(0);
    });
    let notes: Vec<String> = built(&builder).notes.into_iter().map(|note| note.text).take(2).collect();
    let expected = [
        "the animation animation 0 is shown; the file also has Jump",
        "cameras and lights keep the place that the file gives them: their motion is not rendered",
    ];
    assert_eq!(notes, expected);
}

#[test]
fn malformed_motion_is_an_error_that_names_its_place() {
    type Change = fn(&mut Value);
    let cases: [(GltfBuilder, Change, &str); 9] = [
        (
            moving(),
            |json| json["animations"][0]["samplers"][0]["input"] = json!(1),
            "accessors[1]: its type must be SCALAR",
        ),
        (moving(), |json| json["animations"][0]["samplers"][2]["output"] = json!(3), "its type must be VEC4"),
        (
            moving(),
            |json| json["animations"][0]["samplers"][0]["interpolation"] = json!("STEP"),
            "it has 9 values instead of 3",
        ),
        (
            moving(),
            |json| json["nodes"][1] = json!({"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}),
            "has a matrix",
        ),
        (moving(), |json| json["accessors"][3]["count"] = json!(0), "it has no key frames"),
        (skinned(&WEIGHTS), |json| json["skins"][0]["joints"] = json!([1]), "a vertex refers to joint 1 of 1"),
        (skinned(&WEIGHTS), |json| json["skins"][0]["inverseBindMatrices"] = json!(0), "its type must be MAT4"),
        (skinned(&WEIGHTS), |json| json["accessors"][3]["count"] = json!(3), "it has 3 elements for 4 vertices"),
        (
            morphed().with(|json| json["meshes"][0]["weights"] = json!([1])),
            |json| json["accessors"][2]["count"] = json!(2),
            "it has 2 elements for 4 vertices",
        ),
    ];
    for (builder, change, expected) in cases {
        let folder = tempfile::tempdir().unwrap();
        let error = load(&builder.with(change).write(folder.path())).unwrap_err();
        assert!(error.contains(expected), "{error} instead of {expected}");
    }
}

#[test]
fn broken_weights_and_joints_are_repaired_with_a_warning() {
    let mut weights = WEIGHTS;
    (weights[1], weights[4]) = (-3.0, 0.0);
    let loaded = built(&skinned(&weights));
    let texts: Vec<&str> = loaded.warnings.iter().map(|warning| warning.text.as_str()).collect();
    let negative = "weight of a joint that is negative or not finite; treated as 0";
    assert_eq!(texts, [negative, "vertex without weights of joints; it follows the first joint"]);
    let outside = skinned(&WEIGHTS).with(|json| json["nodes"][1]["children"] = json!([]));
    let loaded = built(&outside);
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    assert!(loaded.warnings[0].text.contains("a joint is not part of the scene"));
    assert_eq!(loaded.scene.library.meshes()[0].positions[2], Vec3::new(1.0, 1.0, 0.0));
}

/// Parsed file with its buffers, read without the loader.
struct RawFile {
    json: Value,
    buffers: Vec<Vec<u8>>,
}

impl RawFile {
    fn read(path: &Path) -> Self {
        let file = std::fs::read(path).unwrap();
        if file.starts_with(b"glTF") {
            let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
            let json = serde_json::from_slice(&file[20..20 + length]).unwrap();
            return Self { json, buffers: vec![file[28 + length..].to_vec()] };
        }
        let json: Value = serde_json::from_slice(&file).unwrap();
        let uris = json["buffers"].as_array().unwrap().iter().map(|buffer| buffer["uri"].as_str().unwrap());
        let buffers = uris.map(|uri| STANDARD.decode(uri.split_once(',').unwrap().1).unwrap()).collect();
        Self { json, buffers }
    }

    /// Returns the elements of an accessor.
    fn elements(&self, accessor: &Value) -> Vec<Vec<f64>> {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        let components = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            other => panic!("{other}"),
        };
        let size = if accessor["componentType"] == json!(5126) { 4 } else { 2 };
        let stride = view["byteStride"].as_u64().map_or(components * size, |stride| stride as usize);
        let start = number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
        let bytes = &self.buffers[number(&view["buffer"])];
        let component = |at: usize| match size {
            4 => f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())),
            _ => f64::from(u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap())),
        };
        let element = |index: usize| (0..components).map(|i| component(start + index * stride + i * size)).collect();
        (0..number(&accessor["count"])).map(element).collect()
    }

    /// Returns a property of a node at a time: interpolated linearly between key frames, or the one of the file.
    fn property(&self, node: usize, name: &str, time_s: f64) -> Option<Vec<f64>> {
        let animation = &self.json["animations"][0];
        let channels = animation["channels"].as_array().unwrap();
        let is_own = |channel: &&Value| channel["target"] == json!({"node": node, "path": name});
        let Some(channel) = channels.iter().find(is_own) else {
            return Some(self.json["nodes"][node][name].as_array()?.iter().map(|n| n.as_f64().unwrap()).collect());
        };
        let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        assert!(sampler["interpolation"].is_null() || sampler["interpolation"] == json!("LINEAR"));
        let (times, values) = (self.elements(&sampler["input"]), self.elements(&sampler["output"]));
        let Some(next) = times.iter().position(|time| time[0] > time_s) else { return values.last().cloned() };
        let Some(key) = next.checked_sub(1) else { return values.first().cloned() };
        let share = (time_s - times[key][0]) / (times[next][0] - times[key][0]);
        let (mut from, mut to) = (values[key].clone(), values[next].clone());
        let mut weights = [1.0 - share, share];
        if name == "rotation" {
            // The specification demands unit quaternions, but some files round them to three digits.
            for quaternion in [&mut from, &mut to] {
                let length = quaternion.iter().map(|part| part * part).sum::<f64>().sqrt();
                quaternion.iter_mut().for_each(|part| *part /= length);
            }
            let cosine: f64 = from.iter().zip(&to).map(|(a, b)| a * b).sum();
            let angle = cosine.abs().min(1.0).acos();
            if angle > 1e-6 {
                weights = [(angle * (1.0 - share)).sin() / angle.sin(), (angle * share).sin() / angle.sin()];
            }
            weights[1] *= cosine.signum();
        }
        Some(from.iter().zip(&to).map(|(a, b)| a * weights[0] + b * weights[1]).collect())
    }

    fn local(&self, node: usize, time_s: f64) -> DMat4 {
        let vector = |name, unset| self.property(node, name, time_s).map_or(unset, |v| DVec3::new(v[0], v[1], v[2]));
        let turn = self.property(node, "rotation", time_s).unwrap_or_else(|| vec![0.0, 0.0, 0.0, 1.0]);
        let turn = DQuat::from_vec4(DVec4::new(turn[0], turn[1], turn[2], turn[3]).normalize());
        DMat4::from_scale_rotation_translation(vector("scale", DVec3::ONE), turn, vector("translation", DVec3::ZERO))
    }

    fn world(&self, node: usize, time_s: f64) -> DMat4 {
        let nodes = self.json["nodes"].as_array().unwrap();
        let has = |parent: &Value| parent["children"].as_array().is_some_and(|all| all.contains(&json!(node)));
        let parent = nodes.iter().position(has).map_or(DMat4::IDENTITY, |parent| self.world(parent, time_s));
        parent * self.local(node, time_s)
    }

    /// Returns the skinned positions of the first mesh.
    fn skinned(&self, time_s: f64) -> Vec<DVec3> {
        let skin = &self.json["skins"][0];
        let inverse_binds = self.elements(&skin["inverseBindMatrices"]);
        let joints = skin["joints"].as_array().unwrap().iter().zip(&inverse_binds).map(|(joint, inverse_bind)| {
            let inverse_bind = DMat4::from_cols_array(inverse_bind.as_slice().try_into().unwrap());
            self.world(joint.as_u64().unwrap() as usize, time_s) * inverse_bind
        });
        let joints: Vec<DMat4> = joints.collect();
        let attributes = &self.json["meshes"][0]["primitives"][0]["attributes"];
        let [positions, indices, weights] =
            ["POSITION", "JOINTS_0", "WEIGHTS_0"].map(|name| self.elements(&attributes[name]));
        let vertices = positions.iter().zip(indices.iter().zip(&weights));
        let skinned = vertices.map(|(position, (indices, weights))| {
            let position = DVec4::new(position[0], position[1], position[2], 1.0);
            let total: f64 = weights.iter().sum();
            let parts = indices.iter().zip(weights).map(|(joint, weight)| joints[*joint as usize] * position * *weight);
            parts.sum::<DVec4>().truncate() / total
        });
        skinned.collect()
    }
}

impl RawFile {
    /// Returns values of the vertices in the order of the loaded mesh. Without normals, each triangle has vertices of its
    /// own.
    fn in_mesh_order(&self, values: Vec<DVec3>) -> Vec<DVec3> {
        let primitive = &self.json["meshes"][0]["primitives"][0];
        if !primitive["attributes"]["NORMAL"].is_null() || primitive["indices"].is_null() {
            return values;
        }
        self.elements(&primitive["indices"]).iter().map(|index| values[index[0] as usize]).collect()
    }
}

/// Checks the poses of an external file against skinning of each vertex that reads the file by itself.
fn check_poses(name: &str, times_s: &[f64], tolerance: f64) {
    let Some(path) = samples::external().map(|folder| folder.join("gltf").join(name)).filter(|path| path.is_file())
    else {
        return;
    };
    let (raw, scene): (RawFile, Arc<Scene>) = (RawFile::read(&path), Arc::new(load(&path).unwrap().scene));
    for time_s in times_s {
        let posed = scene.at(*time_s);
        let expected = raw.in_mesh_order(raw.skinned(*time_s));
        let positions = &posed.library.meshes()[0].positions;
        assert_eq!(positions.len(), expected.len());
        let off = positions.iter().zip(&expected).map(|(a, b)| a.as_dvec3().distance(*b)).fold(0.0, f64::max);
        assert!(off < tolerance, "{name} at {time_s} s: off by {off}");
    }
}

#[test]
fn external_skins_have_the_pose_of_an_independent_computation() {
    // Coordinates are up to 2 and up to 150 units.
    check_poses("SimpleSkin.gltf", &[0.0, 0.9, 2.25, 5.4], 1e-6);
    check_poses("Fox.glb", &[0.0, 1.234, 2.9], 1e-4);
}
