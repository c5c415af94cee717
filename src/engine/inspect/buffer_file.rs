//! All buffers of a frame as named channels of one OpenEXR file.
//!
//! Every sample is the value that the inspector shows at the pixel; only the colour is converted, from sRGB codes to
//! linear light. Pixels without a value are NaN in channels of floats, and [`NO_COUNT`] in channels of integers.

use std::io;

use glam::{DMat4, DVec3, Vec2, Vec3};

use super::buffers::{Buffer, BufferChannels, Buffers};
use super::intermediate::inv_w_at;
use super::view::{self, Value};
use crate::chain::{Frame, Recipe, redraw};
use crate::image::color::Tables;
use crate::image::picture::{Channel, DataWindow, Picture, RenderAttributes, Samples, encode_exr};
use crate::image::{Image, Rgba8};
use crate::pipeline::LastStage;
use crate::pipeline::interpolate::{AttributeSelection, Fragment, interpolate};
use crate::pipeline::observe::Observer;
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::shade::{PlacedMesh, Shader};
use crate::scene::Scene;

/// Value of a pixel without a value in a channel of integers.
pub const NO_COUNT: u32 = u32::MAX;

/// Frame whose buffers are written to a file, with its inputs.
#[derive(Clone, Copy, Debug)]
pub struct BufferSource<'a> {
    /// Scene of the frame.
    pub scene: &'a Scene,
    /// Recipe of the frame.
    pub recipe: &'a Recipe,
    /// Completed frame, or one that is drawn only up to a triangle.
    pub frame: &'a Frame,
}

impl BufferSource<'_> {
    /// Draws the frame again and returns all its buffers as an OpenEXR file. `comments` describes the content, normally
    /// by a command that writes the same file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be encoded.
    pub fn encode(&self, comments: &str) -> io::Result<Vec<u8>> {
        encode_exr(self.picture(), &render_attributes(self.recipe, self.frame, comments))
    }

    /// Returns all buffers as channels of a picture.
    fn picture(&self) -> Picture {
        let buffers = super::capture(self.scene, self.recipe, self.frame);
        let complete =
            |buffers: Buffers, buffer: &Buffer| buffers.completed_for(*buffer, self.scene, self.recipe, self.frame);
        let buffers = Buffer::ALL.iter().fold(buffers, complete);
        let mut surfaces = Surfaces::new(self);
        redraw(self.scene, self.recipe, self.frame, LastStage::Shade, &mut surfaces);
        let surfaces = surfaces.samples;
        let mut channels = Channels { frame: self.frame, buffers: &buffers, surfaces: &surfaces, list: Vec::new() };
        let is_in_motion = self.frame.before.is_some();
        for buffer in Buffer::ALL.iter().filter(|buffer| is_in_motion || !buffer.is_motion()) {
            channels.buffer(*buffer);
        }
        if is_in_motion {
            for (name, jitter) in ["jitter.X", "jitter.Y"].into_iter().zip(self.frame.jitter_px(self.recipe)) {
                channels.floats(name, |_, _| Some(jitter as f32));
            }
        }
        channels.object("id.object");
        channels.surface("distance", |surface| Some(surface.distance));
        for (axis, name) in ["U", "V"].into_iter().enumerate() {
            channels.surface(&format!("uv.{name}"), |surface| Some(surface.uv?[axis]));
        }
        for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
            channels.surface(&format!("normal.{name}"), |surface| Some(surface.normal?[axis]));
            channels.surface(&format!("position.{name}"), |surface| Some(surface.position?[axis]));
        }
        Picture::new("OpenEXR", self.frame.image().size(), channels.list)
    }
}

/// Returns the header of a file with pixels of a frame. `recipe` must be the recipe of the frame.
pub(crate) fn render_attributes(recipe: &Recipe, frame: &Frame, comments: &str) -> RenderAttributes {
    let camera = &frame.camera;
    let mirror = DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let mapping = recipe.pipeline.depth_format.mapping();
    let clip_from_world = camera.clip_from_world_f64(frame.viewport.aspect(), mapping);
    let picture_from_ndc =
        DMat4::from_translation(DVec3::new(0.5, 0.5, 0.0)) * DMat4::from_scale(DVec3::new(0.5, -0.5, 1.0));
    RenderAttributes {
        comments: comments.to_owned(),
        world_to_camera: (mirror * camera.view_from_world_f64()).as_mat4().to_cols_array(),
        world_to_picture: (picture_from_ndc * clip_from_world).as_mat4().to_cols_array(),
        clip_planes: [camera.near, camera.far],
    }
}

/// Channels of the file, and the buffers from which they are computed.
struct Channels<'a> {
    frame: &'a Frame,
    buffers: &'a Buffers,
    surfaces: &'a Image<Option<Surface>>,
    list: Vec<Channel>,
}

impl Channels<'_> {
    fn add(&mut self, name: &str, samples: Samples) {
        let (width, height) = self.frame.image().size();
        self.list.push(Channel::new(name.to_owned(), samples, DataWindow { left: 0, top: 0, width, height }));
    }

    fn floats(&mut self, name: &str, value: impl Fn(u32, u32) -> Option<f32>) {
        let (width, height) = self.frame.image().size();
        let values = Image::from_fn(width, height, |x, y| value(x, y).unwrap_or(f32::NAN));
        self.add(name, Samples::F32(values.into_pixels()));
    }

    fn integers(&mut self, name: &str, value: impl Fn(u32, u32) -> Option<u32>) {
        let (width, height) = self.frame.image().size();
        let values = Image::from_fn(width, height, |x, y| value(x, y).unwrap_or(NO_COUNT));
        self.add(name, Samples::U32(values.into_pixels()));
    }

    /// Adds the channels of a buffer.
    fn buffer(&mut self, buffer: Buffer) {
        let linear = &Tables::get().linear_of_code.values;
        match buffer.channels() {
            BufferChannels::Color([red, green, blue, alpha]) => {
                for (name, channel) in [red, green, blue].into_iter().zip(0..) {
                    self.color(name, buffer, |codes| linear[usize::from(codes[channel])]);
                }
                self.color(alpha, buffer, |[.., alpha]| f32::from(alpha) / 255.0);
            }
            BufferChannels::Number(name) => self.number(name, buffer),
            BufferChannels::Count(name) | BufferChannels::Triangle(name) => self.count(name, buffer),
            BufferChannels::Weights(names) => {
                for (corner, name) in names.into_iter().enumerate() {
                    self.weight(name, buffer, corner);
                }
            }
        }
    }

    /// Adds a channel of the values of a buffer that the inspector shows.
    fn value(&mut self, name: &str, buffer: Buffer, of: impl Fn(Value) -> Option<f32>) {
        let (frame, buffers) = (self.frame, self.buffers);
        self.floats(name, |x, y| of(view::value(buffer, frame, Some(buffers), x, y)));
    }

    fn number(&mut self, name: &str, buffer: Buffer) {
        self.value(name, buffer, |value| match value {
            Value::Number(number) => Some(number),
            _ => None,
        });
    }

    fn color(&mut self, name: &str, buffer: Buffer, of: impl Fn(Rgba8) -> f32) {
        self.value(name, buffer, |value| match value {
            Value::Color(codes) => Some(of(codes)),
            _ => None,
        });
    }

    fn weight(&mut self, name: &str, buffer: Buffer, corner: usize) {
        self.value(name, buffer, |value| match value {
            Value::Weights(weights) => Some(weights[corner]),
            _ => None,
        });
    }

    fn count(&mut self, name: &str, buffer: Buffer) {
        let (frame, buffers) = (self.frame, self.buffers);
        self.integers(name, |x, y| match view::value(buffer, frame, Some(buffers), x, y) {
            Value::Count(count) => Some(count),
            Value::Triangle(id) => Some(id.0),
            _ => None,
        });
    }

    fn object(&mut self, name: &str) {
        let (frame, surfaces) = (self.frame, self.surfaces);
        self.integers(name, |x, y| Some(surface_at(frame, surfaces, x, y)?.object));
    }

    fn surface(&mut self, name: &str, of: impl Fn(&Surface) -> Option<f32>) {
        let (frame, surfaces) = (self.frame, self.surfaces);
        self.floats(name, |x, y| of(&surface_at(frame, surfaces, x, y)?));
    }
}

/// Returns the surface at a pixel of the full picture; `None` if the pixel was not drawn or shows no triangle.
fn surface_at(frame: &Frame, surfaces: &Image<Option<Surface>>, x: u32, y: u32) -> Option<Surface> {
    let (column, row) = frame.sample_at(x, y)?;
    surfaces.at(column, row)
}

/// Surface of the fragment shaded last at a sample.
#[derive(Clone, Copy, Debug)]
struct Surface {
    /// Index of the instance in the scene.
    object: u32,
    /// Distance along the view axis, in world units; 1 without perspective.
    distance: f32,
    /// Texture coordinates before addressing, with v pointing down; `None` if the draw does not compute them.
    uv: Option<Vec2>,
    /// Unit normal after normal mapping, in world space; `None` if the draw does not compute it.
    normal: Option<Vec3>,
    /// Position in world space, interpolated with the weights of attributes.
    position: Option<Vec3>,
}

/// Observer that records the surface at every sample.
struct Surfaces<'a> {
    source: &'a BufferSource<'a>,
    /// Shader and mesh of each instance.
    objects: Vec<(Shader<'a>, PlacedMesh<'a>)>,
    samples: Image<Option<Surface>>,
}

impl<'a> Surfaces<'a> {
    fn new(source: &'a BufferSource<'a>) -> Self {
        let BufferSource { scene, recipe, frame } = source;
        let (width, height) = frame.drawn.color.size();
        let objects = scene.instances.iter().zip(frame.plans.iter()).map(|(instance, plan)| {
            let shader = Shader::new(&recipe.pipeline, &scene.library, instance, plan);
            (shader, PlacedMesh::new(&scene.library, instance, plan))
        });
        Self { source, objects: objects.collect(), samples: Image::filled(width, height, None) }
    }
}

impl Observer for Surfaces<'_> {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let object = triangle.instance as usize;
        let (shader, mesh) = &self.objects[object];
        let runs = |part| self.source.frame.plans[object].runs(part);
        let interpolation = self.source.recipe.pipeline.interpolation;
        let complete = interpolate(triangle, fragment.sample, AttributeSelection::all(interpolation));
        let surface = Surface {
            object: triangle.instance,
            distance: 1.0 / inv_w_at(triangle, &fragment.sample),
            uv: runs(PipelinePart::TextureCoordinates).then_some(fragment.uv),
            normal: runs(PipelinePart::Normals).then(|| shader.unit_normal(fragment)),
            position: mesh.position(&complete),
        };
        self.samples.set(fragment.sample.column, fragment.sample.row, Some(surface));
    }
}
