//! Rendering of a whole scene.

use glam::{DMat3, DVec3};

use super::clip::{self, Corner};
use super::color::lambert;
use super::coverage::{covered, doubled_area};
use super::frame::{Finished, Fragment, Frame};
use super::scene::{Light, Material, Scene, Vertex};
use super::view::View;
use super::{Fault, Faults, Picture, Size, texture};

/// Triangle of a scene with the data of its object.
#[derive(Clone, Copy)]
struct Draw<'a> {
    vertices: &'a [Vertex; 3],
    material: &'a Material,
    model: DMat3,
    /// Number of the object.
    object: u32,
}

impl Draw<'_> {
    /// Returns the mean distance of the corners along the line of sight.
    fn distance(&self, view: &View) -> f64 {
        self.vertices.iter().map(|vertex| view.distance(vertex.position)).sum::<f64>() / 3.0
    }

    /// Returns the normal of a vertex in world space.
    fn normal(&self, vertex: &Vertex, faults: Faults) -> DVec3 {
        let normal = match () {
            () if faults.has(Fault::NormalsUntransformed) => vertex.object_normal,
            () if faults.has(Fault::NormalsByModel) => (self.model * vertex.object_normal).normalize(),
            () => vertex.normal,
        };
        if faults.has(Fault::NormalsNegated) { -normal } else { normal }
    }
}

/// Returns the triangles in the order in which they are drawn: opaque ones as in the scene, then blended ones from far
/// to near. The painter's algorithm sorts all of them.
fn draws<'a>(scene: &'a Scene, view: &View, faults: Faults) -> Vec<Draw<'a>> {
    let all = (0..).zip(&scene.objects).flat_map(|(number, object)| {
        let (material, model) = (&object.material, object.model);
        object.triangles.iter().map(move |vertices| Draw { vertices, material, model, object: number })
    });
    let (mut ordered, mut sorted): (Vec<_>, Vec<_>) =
        all.partition(|draw| draw.material.opacity >= 1.0 && !faults.has(Fault::Painter));
    sorted.sort_by(|a, b| b.distance(view).total_cmp(&a.distance(view)));
    ordered.append(&mut sorted);
    ordered
}

/// Whether a triangle with the given signed area on the screen is drawn.
fn is_drawn(doubled_area: f64, faults: Faults) -> bool {
    // Counter-clockwise triangles have negative areas, because y points down.
    match () {
        () if faults.has(Fault::CullNone) => true,
        () if faults.has(Fault::CullFront) => doubled_area > 0.0,
        () => doubled_area < 0.0,
    }
}

/// Returns the weights of attributes from the weights on the screen and 1/w of the three corners.
fn attribute_weights(screen: DVec3, inverse_w: DVec3, faults: Faults) -> DVec3 {
    if faults.has(Fault::Affine) {
        return screen;
    }
    let weighted = screen * inverse_w;
    weighted / weighted.element_sum()
}

/// Renderer of one frame.
struct Renderer {
    view: View,
    frame: Frame,
    size: Size,
    light: Light,
    faults: Faults,
}

impl Renderer {
    /// Clips a triangle and draws its parts.
    fn draw(&mut self, draw: &Draw<'_>) {
        let corners = draw.vertices.map(|vertex| Corner {
            position: self.view.to_clip(vertex.position),
            uv: vertex.uv,
            normal: draw.normal(&vertex, self.faults),
        });
        let parts = if self.faults.has(Fault::NoNearClip) { vec![corners] } else { clip::near(corners) };
        for part in parts {
            self.draw_part(part, draw);
        }
    }

    /// Draws a triangle whose corners can be projected.
    fn draw_part(&mut self, corners: [Corner; 3], draw: &Draw<'_>) {
        let (material, object) = (draw.material, draw.object);
        let screen = corners.map(|corner| self.view.to_screen(corner.position));
        if !is_drawn(doubled_area(screen), self.faults) {
            return;
        }
        let inverse_w = DVec3::from_array(corners.map(|corner| 1.0 / corner.position.w));
        let depths = DVec3::from_array(corners.map(|corner| corner.position.z / corner.position.w));
        for pixel in covered(screen, self.size, self.faults) {
            let weights = attribute_weights(pixel.weights, inverse_w, self.faults).to_array();
            let uv = (0..3).map(|i| corners[i].uv * weights[i]).sum();
            let normal = (0..3).map(|i| corners[i].normal * weights[i]).sum();
            let color = texture::sample(&material.texture, uv, self.faults) * lambert(self.light, normal, self.faults);
            let fragment = Fragment { depth: pixel.weights.dot(depths), color, opacity: material.opacity, object };
            self.frame.draw(pixel.x, pixel.y, fragment);
        }
    }
}

/// Returns the picture of a scene, drawn with the given faults.
pub(crate) fn render(scene: &Scene, size: Size, faults: Faults) -> Picture {
    render_with_buffers(scene, size, faults).picture
}

/// Returns the picture of a scene, drawn with the given faults, and its buffers.
pub(crate) fn render_with_buffers(scene: &Scene, size: Size, faults: Faults) -> Finished {
    let view = View::new(scene.camera, size, faults);
    let draws = draws(scene, &view, faults);
    let frame = Frame::new(size, scene.background, faults);
    let mut renderer = Renderer { view, frame, size, light: scene.light, faults };
    for draw in &draws {
        renderer.draw(draw);
    }
    renderer.frame.finish()
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::super::scene::Object;
    use super::super::view::Camera;
    use super::super::{pattern, shapes};
    use super::*;

    #[test]
    fn attributes_are_perspective_correct() {
        // Halfway on the screen between distances 1 and 3, a quarter of the way is covered: 1/w is 2/3 there, w is 1.5.
        let (screen, inverse_w) = (DVec3::new(0.5, 0.5, 0.0), DVec3::new(1.0, 1.0 / 3.0, 1.0));
        let correct = attribute_weights(screen, inverse_w, Faults::default());
        assert!((correct - DVec3::new(0.75, 0.25, 0.0)).length() < 1e-15, "{correct}");
        assert_eq!(attribute_weights(screen, inverse_w, Faults::new(&[Fault::Affine])), screen);
    }

    /// Returns the colour of the middle of a card that faces the viewer, lit from above the viewer with cosine 0.6.
    fn middle(faults: &[Fault]) -> [u8; 3] {
        let card = shapes::card().repeated(0.0, 0.0);
        let material = Material { name: "plain", texture: pattern::stripes([[188, 0, 255]; 3]), opacity: 0.5 };
        let scene = Scene {
            name: "card",
            objects: vec![Object::new(&card, DAffine3::IDENTITY, material)],
            camera: Camera { eye: DVec3::Z, target: DVec3::ZERO, fov_y_degrees: 30.0, near: 0.1, far: 2.0 },
            light: Light { direction: DVec3::new(0.0, 4.0, 3.0), ambient: 0.2 },
            background: [0, 255, 255],
            invisible: &[],
            pairs: &[],
        };
        render(&scene, Size { width: 3, height: 3 }, Faults::new(faults)).pixels[4]
    }

    #[test]
    fn one_pixel_has_the_colour_computed_by_hand() {
        // Light 0.68. Red: 0.68 · 0.5029 / 2 = 0.1710, code 115.0. Green: 1/2, code 187.5. Blue: (0.68 + 1) / 2 = 0.84,
        // code 236.1.
        assert_eq!(middle(&[]), [115, 188, 236]);
        assert_eq!(middle(&[Fault::RedBlue]), [236, 188, 115]);
        // On codes: 188 · 0.68 / 2 = 63.9, 127.5 and 255 · 0.84 = 214.2.
        assert_eq!(middle(&[Fault::LightOnCodes]), [64, 128, 214]);
    }

    #[test]
    fn culled_sides_show_the_background() {
        assert_eq!(middle(&[Fault::CullFront]), [0, 255, 255]);
        assert_eq!(middle(&[Fault::LeftHanded]), [0, 255, 255]);
        assert_eq!(middle(&[Fault::LeftHanded, Fault::CullNone]), middle(&[]));
    }
}
