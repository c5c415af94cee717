//! Writes a scene as files that the program loads.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

use glam::DVec3;

use super::scene::{Light, Object, Scene};

/// Numbered lines of one OBJ keyword, each written once.
struct Pool {
    keyword: &'static str,
    numbers: HashMap<String, usize>,
}

impl Pool {
    /// Returns a pool without lines.
    fn new(keyword: &'static str) -> Self {
        Self { keyword, numbers: HashMap::new() }
    }

    /// Returns the number of the line with the given values, counted from 1; adds it to `text` at its first use.
    fn number(&mut self, text: &mut String, values: &[f64]) -> usize {
        let values: Vec<String> = values.iter().map(|&value| (value as f32).to_string()).collect();
        let line = format!("{} {}\n", self.keyword, values.join(" "));
        let next = self.numbers.len() + 1;
        *self.numbers.entry(line).or_insert_with_key(|line| {
            text.push_str(line);
            next
        })
    }
}

/// Returns the OBJ file of objects, in their order.
fn obj(objects: &[Object]) -> String {
    let mut text = "mtllib scene.mtl\n".to_owned();
    let (mut positions, mut uvs, mut normals) = (Pool::new("v"), Pool::new("vt"), Pool::new("vn"));
    for (index, object) in objects.iter().enumerate() {
        let mut faces = format!("o {0}-{1}\nusemtl {0}\n", object.material.name, index + 1);
        for triangle in &object.triangles {
            faces.push('f');
            for vertex in triangle {
                let position = positions.number(&mut text, &vertex.position.to_array());
                let uv = uvs.number(&mut text, &vertex.uv.to_array());
                let normal = normals.number(&mut text, &vertex.normal.to_array());
                let _ = write!(faces, " {position}/{uv}/{normal}");
            }
            faces.push('\n');
        }
        text.push_str(&faces);
    }
    text
}

/// Returns the camera file of a scene.
fn camera(scene: &Scene) -> String {
    let camera = scene.camera;
    let vector = |DVec3 { x, y, z }| format!("[{x}, {y}, {z}]");
    format!(
        "{{\"eye\": {}, \"target\": {}, \"fov_y_degrees\": {}, \"near\": {}, \"far\": {}}}\n",
        vector(camera.eye),
        vector(camera.target),
        camera.fov_y_degrees,
        camera.near,
        camera.far
    )
}

/// Returns the settings of the program that differ from its defaults, one `key=value` a line.
fn settings(scene: &Scene) -> String {
    let [r, g, b] = scene.background;
    let mut text = format!("background=#{r:02x}{g:02x}{b:02x}\n");
    let (light, default) = (scene.light, Light::default());
    if light.direction != default.direction {
        let DVec3 { x, y, z } = light.direction;
        let _ = writeln!(text, "light.direction={x},{y},{z}");
    }
    if light.ambient != default.ambient {
        let _ = writeln!(text, "light.ambient={}", light.ambient);
    }
    text
}

/// Writes `scene.obj`, `scene.mtl`, the textures, `camera.json` and `settings.txt` into an existing folder.
pub(crate) fn write(scene: &Scene, folder: &Path) -> io::Result<()> {
    let mut written: Vec<&str> = Vec::new();
    let mut library = String::new();
    for material in scene.objects.iter().map(|object| &object.material) {
        let name = material.name;
        if written.contains(&name) {
            continue;
        }
        written.push(name);
        let opacity = material.opacity;
        let _ = write!(library, "newmtl {name}\nKd 1 1 1\nd {opacity}\nmap_Kd {name}.png\n");
        material.texture.save(&folder.join(format!("{name}.png"))).map_err(io::Error::other)?;
    }
    fs::write(folder.join("scene.mtl"), library)?;
    fs::write(folder.join("scene.obj"), obj(&scene.objects))?;
    fs::write(folder.join("camera.json"), camera(scene))?;
    fs::write(folder.join("settings.txt"), settings(scene))
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::super::scene::Material;
    use super::super::{pattern, shapes};
    use super::*;

    #[test]
    fn faces_refer_to_shared_lines() {
        let material = Material { name: "red", texture: pattern::shaded([255, 0, 0]), opacity: 1.0 };
        let text = obj(&[Object::new(&shapes::card(), DAffine3::from_scale(DVec3::splat(2.0)), material)]);
        let expected = "mtllib scene.mtl\nv -1 -1 0\nvt 0 0\nvn 0 0 1\nv 1 -1 0\nvt 1 0\nv 1 1 0\nvt 1 1\nv -1 1 0\nvt 0 1\n\
                        o red-1\nusemtl red\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n";
        assert_eq!(text, expected);
    }
}
