//! Textured triangle, rasterized exactly and without gaps: integer edge functions give the span of pixels in each row.
//!
//! An edge function E(x, y) = (b − a) × (p − a) is affine, with integer values on the grid of 1/256 px. The first and
//! last pixel of a row thus follow from one integer division per edge. If two triangles share an edge, their edge
//! functions for it differ only in sign. The top-left rule assigns a pixel centre exactly on the edge to one of the
//! triangles (Pineda 1988; D3D11 specification, 3.4).

use eframe::egui::{TextureFilter, epaint::Vertex};

use glam::{Vec2, Vec4, vec2};

use super::{
    PixelRect,
    texture::{UiTexture, channels},
};
use crate::{
    image::{Image, Rgba8},
    math::fixed::{HALF_PIXEL, SUBPIXELS, snap},
};

/// Limit to which the magnitude of vertex coordinates is clamped, in pixels. It keeps edge functions well within 64
/// bits.
const FARTHEST_PX: f32 = 1_048_576.0;

/// Attributes interpolated over a triangle.
#[derive(Clone, Copy, PartialEq)]
struct PaintAttributes {
    /// Red, green, blue and alpha in [0, 255], premultiplied.
    color: Vec4,
    /// Texture coordinates, in texels.
    uv: Vec2,
}

/// Triangle of positive area, set up for painting.
pub(super) struct PaintTriangle<'a> {
    /// Edge functions. Edge `i` lies opposite vertex `i`, so its value is proportional to the barycentric weight of
    /// vertex `i`.
    edges: [EdgeFunction; 3],
    attributes: [PaintAttributes; 3],
    /// Horizontal gradient of the attributes: the change per pixel in x.
    attributes_dx: PaintAttributes,
    doubled_area: f64,
    /// Minimum and maximum y of the snapped vertices, in subpixels of 1/256 px.
    rows: (i64, i64),
    texture: &'a UiTexture,
    filter: TextureFilter,
}

impl<'a> PaintTriangle<'a> {
    /// Sets up a triangle. Returns `None` if its area is zero or a coordinate is not finite.
    pub(super) fn new(vertices: [Vertex; 3], pixels_per_point: f32, texture: &'a UiTexture) -> Option<Self> {
        let [a, mut b, mut c] = vertices;
        if ![a, b, c].iter().all(|vertex| vertex.pos.is_finite() && vertex.uv.is_finite()) {
            return None;
        }
        let position = |vertex: &Vertex| {
            [vertex.pos.x, vertex.pos.y]
                .map(|points| snap((points * pixels_per_point).clamp(-FARTHEST_PX, FARTHEST_PX)))
        };
        let area = doubled_area(position(&a), position(&b), position(&c));
        if area == 0 {
            return None;
        }
        if area < 0 {
            std::mem::swap(&mut b, &mut c);
        }
        let doubled_area = area.abs() as f64;
        let [pa, pb, pc] = [&a, &b, &c].map(position);
        let edges = [EdgeFunction::new(pb, pc), EdgeFunction::new(pc, pa), EdgeFunction::new(pa, pb)];
        let attributes = [a, b, c].map(|vertex| attributes_of(&vertex, texture.size()));
        let weights_dx = edges.map(|edge| (edge.dx as f64 / doubled_area) as f32);
        let [first, second, third] = attributes.map(|attributes| attributes.uv.as_dvec2());
        let texels = (second - first).perp_dot(third - first);
        let pixels = doubled_area / (SUBPIXELS * SUBPIXELS) as f64;
        Some(Self {
            edges,
            attributes_dx: weigh(&attributes, weights_dx),
            attributes,
            doubled_area,
            rows: (pa[1].min(pb[1]).min(pc[1]), pa[1].max(pb[1]).max(pc[1])),
            texture,
            filter: texture.filter(texels.abs() / pixels),
        })
    }

    /// Blends the triangle over `picture` within `clip`, which must lie inside the picture.
    pub(super) fn paint(&self, clip: PixelRect, picture: &mut Image<Rgba8>) {
        let solid = self.solid_source();
        let width = picture.width() as usize;
        let top = self.rows.0.div_euclid(SUBPIXELS).max(clip.top);
        let bottom = (self.rows.1.div_euclid(SUBPIXELS) + 1).min(clip.bottom);
        for y in top..bottom {
            let (left, right) = self.span(y, clip);
            if left >= right {
                continue;
            }
            let row = y as usize * width;
            let pixels = &mut picture.pixels_mut()[row + left as usize..row + right as usize];
            match solid {
                Some(source) => fill_row(pixels, source),
                None => self.shade_row(pixels, left, y),
            }
        }
    }

    /// Returns the common colour of all pixels if the attributes of all vertices are equal, and `None` otherwise.
    fn solid_source(&self) -> Option<Vec4> {
        let [first, ref others @ ..] = self.attributes;
        others.iter().all(|other| *other == first).then(|| {
            let texel = match self.filter {
                TextureFilter::Nearest => self.texture.nearest(first.uv),
                TextureFilter::Linear => self.texture.bilinear(first.uv),
            };
            modulate(first.color, texel)
        })
    }

    /// Returns the columns within `clip` whose pixel centres in row `y` are inside all three edges, as a half-open
    /// range.
    fn span(&self, y: i64, clip: PixelRect) -> (i64, i64) {
        let (mut left, mut right) = (clip.left, clip.right);
        for edge in &self.edges {
            let excess = edge.at(0, y) - edge.threshold;
            if edge.dx > 0 {
                left = left.max(-excess.div_euclid(edge.dx));
            } else if edge.dx < 0 {
                right = right.min(excess.div_euclid(-edge.dx) + 1);
            } else if excess < 0 {
                return (0, 0);
            }
        }
        (left, right)
    }

    fn shade_row(&self, pixels: &mut [Rgba8], left: i64, y: i64) {
        let weights = self.edges.map(|edge| (edge.at(left, y) as f64 / self.doubled_area) as f32);
        let first = weigh(&self.attributes, weights);
        match self.filter {
            TextureFilter::Nearest => {
                shade_pixels(pixels, &first, &self.attributes_dx, |uv| self.texture.nearest(uv));
            }
            TextureFilter::Linear => {
                shade_pixels(pixels, &first, &self.attributes_dx, |uv| self.texture.bilinear(uv));
            }
        }
    }
}

/// Edge function of the edge from a to b, positive inside the triangle.
#[derive(Clone, Copy)]
struct EdgeFunction {
    /// Value at the centre of pixel (0, 0).
    origin: i64,
    /// Gradient of the edge function: `dx` and `dy` are its changes per pixel in x and in y.
    dx: i64,
    dy: i64,
    /// Minimum value at a covered pixel centre: 0 for a top or left edge, 1 for other edges.
    threshold: i64,
}

impl EdgeFunction {
    fn new(a: [i64; 2], b: [i64; 2]) -> Self {
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        let top_or_left = y < 0 || (y == 0 && x > 0);
        Self {
            origin: doubled_area(a, b, [HALF_PIXEL; 2]),
            dx: -y * SUBPIXELS,
            dy: x * SUBPIXELS,
            threshold: i64::from(!top_or_left),
        }
    }

    fn at(&self, x: i64, y: i64) -> i64 {
        self.origin + self.dx * x + self.dy * y
    }
}

/// Returns twice the signed area of a triangle, positive if it is clockwise on the y-down screen.
fn doubled_area(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn attributes_of(vertex: &Vertex, [width, height]: [f32; 2]) -> PaintAttributes {
    PaintAttributes { color: channels(vertex.color.to_array()), uv: vec2(vertex.uv.x * width, vertex.uv.y * height) }
}

fn weigh([a, b, c]: &[PaintAttributes; 3], weights: [f32; 3]) -> PaintAttributes {
    PaintAttributes {
        color: a.color * weights[0] + b.color * weights[1] + c.color * weights[2],
        uv: a.uv * weights[0] + b.uv * weights[1] + c.uv * weights[2],
    }
}

/// Multiplies vertex colour and texel, with all channels in [0, 255].
#[inline(always)]
fn modulate(color: Vec4, texel: Vec4) -> Vec4 {
    color * texel * (1.0 / 255.0)
}

/// Blends `source` over `pixel` and rounds to nearest. `keep` is 1 − alpha of `source`. The conversion to bytes
/// saturates, because additive colours (alpha 0) can exceed 255.
#[inline(always)]
fn blend(pixel: &mut Rgba8, source: Vec4, keep: f32) {
    *pixel = bytes(source + channels(*pixel) * keep);
}

#[inline(always)]
fn bytes(channels: Vec4) -> Rgba8 {
    (channels + 0.5).as_u8vec4().to_array()
}

fn fill_row(pixels: &mut [Rgba8], source: Vec4) {
    let keep = 1.0 - source.w / 255.0;
    if keep <= 0.0 {
        pixels.fill(bytes(source));
    } else {
        for pixel in pixels {
            blend(pixel, source, keep);
        }
    }
}

#[inline(always)]
fn shade_pixels(pixels: &mut [Rgba8], first: &PaintAttributes, dx: &PaintAttributes, sample: impl Fn(Vec2) -> Vec4) {
    for (step, pixel) in pixels.iter_mut().enumerate() {
        let step = step as f32;
        let source = modulate(first.color + dx.color * step, sample(first.uv + dx.uv * step));
        blend(pixel, source, 1.0 - source.w * (1.0 / 255.0));
    }
}
