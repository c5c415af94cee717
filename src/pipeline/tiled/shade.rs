//! Shading a tile: once per visible sample, eight of a row at a time.
//!
//! The arithmetic is that of [`crate::pipeline::interpolate`] and [`crate::pipeline::shade`], operation by operation. Shadings
//! that show a single quantity are left to those functions themselves.

use glam::Vec3;

use super::Frame;
use super::bins::Key;
use super::geometry::{Surface, Vertex};
use super::lattice::{BLOCK, BLOCKS, TILE};
use super::setup::Edges;
use super::texture::{StoredTaps, TextureReader};
use super::tile::Tile;
use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::math::lanes::*;
use crate::pipeline::interpolate::{Attributes, interpolate};
use crate::pipeline::raster::Sample;
use crate::pipeline::settings::{ColorSpace, Filter, Shading};
use crate::pipeline::shade::Shader;
use crate::pipeline::viewport::ScreenTriangle;
use crate::scene::Texture;

/// How the samples of one draw are shaded.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawShader<'a> {
    pub(super) shader: Shader<'a>,
    attributes: Attributes,
    divides_by_w: bool,
    texture: Option<TextureReader<'a>>,
    on_lanes: bool,
    texels_per_sample: u64,
}

impl<'a> DrawShader<'a> {
    /// `texture` is the material's.
    pub(super) fn new(shader: Shader<'a>, texture: Option<&'a Texture>, divides_by_w: bool) -> Self {
        let settings = shader.settings;
        let on_lanes = matches!(settings.shading, Shading::Texture | Shading::Gouraud | Shading::Lambert);
        let texture = texture
            .filter(|_| shader.texture.is_some())
            .map(|texture| TextureReader::new(texture, shader.sampler(), settings.color_space));
        let mut attributes = shader.attributes();
        attributes.normal &= settings.shading == Shading::Lambert;
        let texels_per_sample = match (shader.texture, settings.filter) {
            (None, _) => 0,
            (Some(_), Filter::Point) => 1,
            (Some(_), Filter::Bilinear) => 4,
        };
        Self { shader, attributes, divides_by_w, texture, on_lanes, texels_per_sample }
    }
}

/// Attributes of a vertex, or what they change by from the first vertex to another, for eight samples.
#[derive(Clone, Copy)]
struct Values<S: Simd> {
    uv: [F32<S>; 2],
    light: F32<S>,
    normal: [F32<S>; 3],
    color: [F32<S>; 3],
}

/// A corner of the triangles of eight samples.
#[derive(Clone, Copy)]
struct Corner<S: Simd> {
    /// Position in grid steps.
    position: [F32<S>; 2],
    inv_w: F32<S>,
    values: Values<S>,
}

/// The attributes of the first corner, and what the second and the third differ by.
struct Interpolated<S: Simd> {
    base: Values<S>,
    deltas: [Values<S>; 2],
}

/// A triangle that many samples in a row belong to.
struct Uniform<S: Simd> {
    key: Key,
    draw: usize,
    edges: Edges,
    relative_inv_w: [F32<S>; 3],
    values: Interpolated<S>,
    /// For shadings that are not done on lanes.
    whole: Option<Box<ScreenTriangle>>,
}

/// How much shading a tile was.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shaded {
    pub(super) samples: u64,
    pub(super) texels: u64,
}

impl Shaded {
    #[inline(always)]
    fn add(&mut self, shader: &DrawShader<'_>, samples: usize) {
        self.samples += samples as u64;
        self.texels += samples as u64 * shader.texels_per_sample;
    }
}

/// Some rows of samples of a block, at most eight wide.
#[derive(Clone, Copy, Debug)]
struct Patch {
    tile: (usize, usize),
    /// First column, within the tile.
    column: usize,
    /// Columns that lie within the picture.
    count: usize,
    /// First row, within the tile.
    first: usize,
    /// One past the last row.
    end: usize,
}

/// Rows of the packed picture that start with the first one of a tile.
struct Band<'a> {
    pixels: &'a mut [Rgba8],
    width: usize,
}

impl Band<'_> {
    #[inline(always)]
    fn row(&mut self, patch: &Patch, row: usize) -> &mut [Rgba8] {
        let at = row * self.width + patch.tile.0 * TILE + patch.column;
        &mut self.pixels[at..at + patch.count]
    }
}

/// Shades the samples of a tile into `pixels`, the rows of the packed picture that start with its first one.
pub(super) fn shade_tile<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    tile: &Tile,
    place: (usize, usize),
    pixels: &mut [Rgba8],
) -> Shaded {
    let width = frame.packed.0 as usize;
    let (columns, height) = ((width - place.0 * TILE).min(TILE), pixels.len() / width);
    let mut band = Band { pixels, width };
    let mut cached: Option<Uniform<S>> = None;
    let mut shaded = Shaded::default();
    for by in 0..height.div_ceil(BLOCK) {
        for bx in 0..columns.div_ceil(BLOCK) {
            let column = bx * BLOCK;
            let (first, end) = (by * BLOCK, ((by + 1) * BLOCK).min(height));
            let whole = Patch { tile: place, column, count: (columns - column).min(BLOCK), first, end };
            let mut one_triangle = |key: Key, patch: &Patch, band: &mut Band<'_>, shaded: &mut Shaded| {
                if key == Key::NONE {
                    for row in patch.first..patch.end {
                        band.row(patch, row).fill(frame.background);
                    }
                    return;
                }
                if cached.as_ref().is_none_or(|c| c.key != key) {
                    cached = Uniform::new(simd, frame, key, place);
                }
                if let Some(triangle) = &cached {
                    shaded.add(&frame.shaders[triangle.draw], patch.count * (patch.end - patch.first));
                    shade_uniform(simd, frame, triangle, patch, band);
                }
            };
            if let Some(key) = tile.owner(by * BLOCKS + bx) {
                one_triangle(key, &whole, &mut band, &mut shaded);
                continue;
            }
            let mut row = first;
            while row < end {
                let key = uniform_key(tile.keys(column, row));
                let same = |row: &usize| uniform_key(tile.keys(column, *row)) == key;
                let next = (row + 1..end).find(|row| !same(row)).unwrap_or(end);
                let patch = Patch { first: row, end: next, ..whole };
                match key {
                    Some(key) => one_triangle(key, &patch, &mut band, &mut shaded),
                    None => shade_mixed(simd, frame, tile, &patch, &mut band, &mut shaded),
                }
                row = next;
            }
        }
    }
    shaded
}

/// The key of all eight, if they are the same.
#[inline(always)]
fn uniform_key(keys: &[u32]) -> Option<Key> {
    keys.iter().all(|key| *key == keys[0]).then_some(Key(keys[0]))
}

impl<S: Simd> Uniform<S> {
    #[inline(always)]
    fn new(simd: S, frame: &Frame<'_>, key: Key, place: (usize, usize)) -> Option<Self> {
        let draw = frame.draw_of(key);
        let shader = &frame.shaders[draw];
        let corners = frame.corners(key, draw);
        let edges = Edges::new(&corners, frame.lattice.origin(place))?;
        let records = frame.records(key, draw);
        let nothing = Surface::default();
        let [a, b, c] = each!(corner in [0, 1, 2] => {
            let (vertex, surface) = records[corner];
            let surface = surface.unwrap_or(&nothing);
            let vertex = each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => F32::splat(simd, vertex.numbers[i]));
            let surface = each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => F32::splat(simd, surface.numbers[i]));
            Corner::new(&vertex, &surface)
        });
        let relative_inv_w = relative_inv_w(simd, [a.inv_w, b.inv_w, c.inv_w], shader.divides_by_w);
        let deltas = [b.values.less(a.values), c.values.less(a.values)];
        let values = Interpolated { base: a.values, deltas };
        let whole = (!shader.on_lanes).then(|| Box::new(frame.screen_triangle(key, draw)));
        Some(Self { key, draw, edges, relative_inv_w, values, whole })
    }
}

/// Rows of samples that belong to one triangle.
#[inline(never)]
fn shade_uniform<S: Simd>(simd: S, frame: &Frame<'_>, triangle: &Uniform<S>, patch: &Patch, band: &mut Band<'_>) {
    simd.vectorize(
        #[inline(always)]
        || {
            let shader = &frame.shaders[triangle.draw];
            let lattice = &frame.lattice;
            let Edges { a, b, c, .. } = triangle.edges;
            let columns = F64::load_array(simd, lattice.lanes) + lattice.column(patch.column);
            let along = each!(i in [0, 1, 2] => columns * a[i]);
            let Interpolated { base, deltas } = &triangle.values;
            let mut taps = [StoredTaps::default(); BLOCK];
            let mut all_weights = [[[0.0; LANES]; 2]; BLOCK];
            for row in patch.first..patch.end {
                let y = row as f64 * lattice.row_step;
                let shift = lattice.shift(row);
                let e = each!(i in [0, 1, 2] => along[i] + (c[i] + b[i] * y + a[i] * shift));
                if let Some(whole) = &triangle.whole {
                    let edges = each!(i in [0, 1, 2] => e[i].to_array());
                    one_by_one(frame, shader, whole, patch, row, &edges, band.row(patch, row));
                    continue;
                }
                let weights = weights(simd, e, triangle.relative_inv_w);
                let place = row - patch.first;
                all_weights[place] = [weights[0].to_array(), weights[1].to_array()];
                if let Some(texture) = &shader.texture {
                    let [u, v] = Interpolant { base, deltas, weights }.uv();
                    texture.locate(simd, u, v).store(&mut taps[place]);
                }
            }
            if triangle.whole.is_some() {
                return;
            }
            for row in patch.first..patch.end {
                let place = row - patch.first;
                let [first, second] = &all_weights[place];
                let weights = [F32::load_array_ref(simd, first), F32::load_array_ref(simd, second)];
                let fragments = Interpolant { base, deltas, weights };
                store(shade(simd, shader, &fragments, &taps[place]), band.row(patch, row));
            }
        },
    );
}

/// Shades a row by the classic way's own functions.
fn one_by_one(
    frame: &Frame<'_>,
    shader: &DrawShader<'_>,
    triangle: &ScreenTriangle,
    patch: &Patch,
    row: usize,
    edges: &[[f64; LANES]; 3],
    out: &mut [Rgba8],
) {
    let row = (patch.tile.1 * TILE + row) as u32;
    for (lane, pixel) in out.iter_mut().enumerate() {
        let column = (patch.tile.0 * TILE + patch.column + lane) as u32;
        let (x, y) = frame.grid.pixel(column, row);
        let sample = Sample { column, row, x, y, edges: edges.map(|e| e[lane]) };
        let fragment = interpolate(triangle, sample, shader.shader.attributes());
        *pixel = shader.shader.shade(&fragment, triangle);
    }
}

/// Rows of samples that belong to different triangles.
#[inline(never)]
fn shade_mixed<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    tile: &Tile,
    patch: &Patch,
    band: &mut Band<'_>,
    shaded: &mut Shaded,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let lattice = &frame.lattice;
            let [x0, y0] = lattice.origin(patch.tile);
            for row in patch.first..patch.end {
                let keys = tile.keys(patch.column, row);
                let out = band.row(patch, row);
                let mut open: u32 = 0;
                for (lane, pixel) in out.iter_mut().enumerate() {
                    if keys[lane] == Key::NONE.0 {
                        *pixel = frame.background;
                    } else {
                        open |= 1 << lane;
                    }
                }
                let x = F64::load_array(simd, lattice.lanes) + (x0 + lattice.column(patch.column) + lattice.shift(row));
                let y = F64::splat(simd, y0 + row as f64 * lattice.row_step);
                while open != 0 {
                    let first = open.trailing_zeros() as usize;
                    let draw = frame.draw_of(Key(keys[first]));
                    let shader = &frame.shaders[draw];
                    let some = frame.records(Key(keys[first]), draw);
                    let mut records = [some; LANES];
                    let mut mine: u32 = 0;
                    for lane in (first..out.len()).filter(|lane| open >> lane & 1 != 0) {
                        if frame.is_of_draw(Key(keys[lane]), draw) {
                            records[lane] = frame.records(Key(keys[lane]), draw);
                            mine |= 1 << lane;
                        }
                    }
                    open &= !mine;
                    shaded.add(shader, mine.count_ones() as usize);
                    let reads_surface = shader.attributes.normal || shader.attributes.color;
                    let corners = each!(corner in [0, 1, 2] => Corner::gather(simd, &records, corner, reads_surface));
                    let e = edge_values(simd, &corners, x, y);
                    if !shader.on_lanes {
                        let edges = each!(i in [0, 1, 2] => e[i].to_array());
                        for lane in (0..out.len()).filter(|lane| mine >> lane & 1 != 0) {
                            let triangle = frame.screen_triangle(Key(keys[lane]), draw);
                            let edges = edges.map(|e| [e[lane]; LANES]);
                            let patch = Patch { column: patch.column + lane, ..*patch };
                            one_by_one(frame, shader, &triangle, &patch, row, &edges, &mut out[lane..=lane]);
                        }
                        continue;
                    }
                    let [a, b, c] = corners;
                    let relative_inv_w = relative_inv_w(simd, [a.inv_w, b.inv_w, c.inv_w], shader.divides_by_w);
                    let weights = weights(simd, e, relative_inv_w);
                    let deltas = [b.values.less(a.values), c.values.less(a.values)];
                    let fragments = Interpolant { base: &a.values, deltas: &deltas, weights };
                    let mut taps = StoredTaps::default();
                    if let Some(texture) = &shader.texture {
                        let [u, v] = fragments.uv();
                        texture.locate(simd, u, v).store(&mut taps);
                    }
                    let colors = shade(simd, shader, &fragments, &taps).to_array();
                    for (lane, pixel) in out.iter_mut().enumerate().filter(|(lane, _)| mine >> lane & 1 != 0) {
                        *pixel = colors[lane].to_le_bytes();
                    }
                }
            }
        },
    );
}

/// The corners of one triangle as lanes read them.
type Records<'a> = [(&'a Vertex, Option<&'a Surface>); 3];

impl<S: Simd> Corner<S> {
    #[inline(always)]
    fn new(vertex: &[F32<S>; LANES], surface: &[F32<S>; LANES]) -> Self {
        let values = Values {
            uv: [vertex[Vertex::UV[0]], vertex[Vertex::UV[1]]],
            light: vertex[Vertex::LIGHT],
            normal: each!(axis in [0, 1, 2] => surface[Surface::NORMAL[axis]]),
            color: each!(channel in [0, 1, 2] => surface[Surface::COLOR[channel]]),
        };
        Self { position: [vertex[Vertex::X], vertex[Vertex::Y]], inv_w: vertex[Vertex::INV_W], values }
    }

    /// The corners of this number of eight triangles.
    #[inline(always)]
    fn gather(simd: S, records: &[Records<'_>; LANES], corner: usize, reads_surface: bool) -> Self {
        let zero = F32::splat(simd, 0.0);
        let vertices = each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => {
            F32::load_array_ref(simd, &records[lane][corner].0.numbers)
        });
        let mut surfaces = [zero; LANES];
        if reads_surface {
            let nothing = Surface::default();
            surfaces = transpose(each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => {
                F32::load_array_ref(simd, &records[lane][corner].1.unwrap_or(&nothing).numbers)
            }));
        }
        Self::new(&transpose(vertices), &surfaces)
    }
}

/// Rows to columns.
#[inline(always)]
fn transpose<S: Simd>(mut rows: [F32<S>; LANES]) -> [F32<S>; LANES] {
    // Shuffling the two halves into each other like cards, three times.
    for _ in 0..3 {
        let (a, b) = rows[0].interleave(rows[4]);
        let (c, d) = rows[1].interleave(rows[5]);
        let (e, f) = rows[2].interleave(rows[6]);
        let (g, h) = rows[3].interleave(rows[7]);
        rows = [a, b, c, d, e, f, g, h];
    }
    rows
}

/// Edge values of each lane's triangle at that lane's sample, in grid steps. Exact, so the order of terms is free.
#[inline(always)]
fn edge_values<S: Simd>(simd: S, corners: &[Corner<S>; 3], x: F64<S>, y: F64<S>) -> [F64<S>; 3] {
    let dx = each!(corner in [0, 1, 2] => widen(simd, corners[corner].position[0]) - x);
    let dy = each!(corner in [0, 1, 2] => widen(simd, corners[corner].position[1]) - y);
    let e = each!((from, to) in [(1, 2), (2, 0), (0, 1)] => dx[from] * dy[to] - dx[to] * dy[from]);
    let turned = (e[0] + e[1] + e[2]).simd_lt(0.0);
    each!(i in [0, 1, 2] => turned.select(-e[i], e[i]))
}

/// [`crate::pipeline::viewport::relative_inv_w`] for eight triangles; all 1 where perspective division is left out.
#[inline(always)]
fn relative_inv_w<S: Simd>(simd: S, inv_w: [F32<S>; 3], divides_by_w: bool) -> [F32<S>; 3] {
    if !divides_by_w {
        return [F32::splat(simd, 1.0); 3];
    }
    let largest = inv_w[0].max(inv_w[1]).max(inv_w[2]);
    each!(i in [0, 1, 2] => (inv_w[i] / largest).max(f32::MIN_POSITIVE))
}

impl<S: Simd> Values<S> {
    #[inline(always)]
    fn less(&self, base: Self) -> Self {
        Self {
            uv: [self.uv[0] - base.uv[0], self.uv[1] - base.uv[1]],
            light: self.light - base.light,
            normal: each!(axis in [0, 1, 2] => self.normal[axis] - base.normal[axis]),
            color: each!(axis in [0, 1, 2] => self.color[axis] - base.color[axis]),
        }
    }
}

/// The attributes of a triangle, each interpolated where it is read.
struct Interpolant<'a, S: Simd> {
    base: &'a Values<S>,
    deltas: &'a [Values<S>; 2],
    weights: [F32<S>; 2],
}

impl<S: Simd> Interpolant<'_, S> {
    #[inline(always)]
    fn mix(&self, base: F32<S>, first: F32<S>, second: F32<S>) -> F32<S> {
        base + first * self.weights[0] + second * self.weights[1]
    }

    #[inline(always)]
    fn uv(&self) -> [F32<S>; 2] {
        let [a, b] = self.deltas;
        each!(axis in [0, 1] => self.mix(self.base.uv[axis], a.uv[axis], b.uv[axis]))
    }

    #[inline(always)]
    fn light(&self) -> F32<S> {
        let [a, b] = self.deltas;
        self.mix(self.base.light, a.light, b.light)
    }

    #[inline(always)]
    fn normal(&self) -> [F32<S>; 3] {
        let [a, b] = self.deltas;
        each!(axis in [0, 1, 2] => self.mix(self.base.normal[axis], a.normal[axis], b.normal[axis]))
    }

    #[inline(always)]
    fn color(&self) -> [F32<S>; 3] {
        let [a, b] = self.deltas;
        each!(channel in [0, 1, 2] => self.mix(self.base.color[channel], a.color[channel], b.color[channel]))
    }
}

/// Weights of the second and third corner.
#[inline(always)]
fn weights<S: Simd>(simd: S, e: [F64<S>; 3], relative_inv_w: [F32<S>; 3]) -> [F32<S>; 2] {
    let q = each!(i in [0, 1, 2] => narrow(simd, e[i]) * relative_inv_w[i]);
    let inverse_sum = F32::splat(simd, 1.0) / (q[0] + q[1] + q[2]);
    [q[1] * inverse_sum, q[2] * inverse_sum]
}

/// Colours of eight fragments, packed.
#[inline(always)]
fn shade<S: Simd>(simd: S, shader: &DrawShader<'_>, fragments: &Interpolant<'_, S>, taps: &StoredTaps) -> u32x8<S> {
    let settings = shader.shader.settings;
    let diffuse = shader.shader.diffuse.to_array();
    let mut color = each!(channel in [0, 1, 2] => F32::splat(simd, diffuse[channel]));
    if shader.attributes.color {
        let vertex_color = fragments.color();
        color = each!(channel in [0, 1, 2] => color[channel] * vertex_color[channel]);
    }
    if let Some(texture) = &shader.texture {
        let texel = texture.read(simd, taps);
        color = each!(channel in [0, 1, 2] => color[channel] * texel[channel]);
    }
    match settings.shading {
        Shading::Gouraud => {
            let light = fragments.light();
            color = each!(channel in [0, 1, 2] => color[channel] * light);
        }
        Shading::Lambert => {
            let light = lambert(simd, fragments.normal(), shader.shader.light_direction, settings.light.ambient);
            color = each!(channel in [0, 1, 2] => color[channel] * light);
        }
        _ => {}
    }
    let codes = match settings.color_space {
        ColorSpace::Bytes => {
            each!(c in [0, 1, 2] => (color[c] * 255.0 + 0.5).max(0.0).min(255.0).to_int::<i32x8<S>>().bitcast::<u32x8<S>>())
        }
        ColorSpace::Linear => {
            let tables = Tables::get();
            each!(c in [0, 1, 2] => encode(simd, tables, color[c]))
        }
    };
    codes[0] | codes[1] << 8 | codes[2] << 16 | 0xFF00_0000
}

/// [`Tables::encode`] for eight values.
#[inline(always)]
fn encode<S: Simd>(simd: S, tables: &Tables, linear: F32<S>) -> u32x8<S> {
    let linear = linear.to_array();
    let mut codes = [0; LANES];
    for lane in 0..LANES {
        codes[lane] = u32::from(tables.encode(linear[lane]));
    }
    u32x8::load_array(simd, codes)
}

/// Light on normals that are not of unit length.
#[inline(always)]
fn lambert<S: Simd>(simd: S, normal: [F32<S>; 3], direction: Vec3, ambient: f32) -> F32<S> {
    let [x, y, z] = normal;
    let reciprocal = F32::splat(simd, 1.0) / (x * x + y * y + z * z).sqrt();
    let has_length = reciprocal.is_finite() & reciprocal.simd_gt(0.0);
    let unit = each!((component, up) in [(x, 0.0), (y, 1.0), (z, 0.0)] => has_length.select(component * reciprocal, F32::splat(simd, up)));
    let cosine = unit[0] * direction.x + unit[1] * direction.y + unit[2] * direction.z;
    cosine.max(0.0) * (1.0 - ambient) + ambient
}

#[inline(always)]
fn store<S: Simd>(colors: u32x8<S>, out: &mut [Rgba8]) {
    let out = out.as_flattened_mut();
    if out.len() == 4 * LANES {
        colors.bitcast::<u8x32<S>>().store_slice(out);
    } else {
        let colors = colors.bitcast::<u8x32<S>>().to_array();
        let len = out.len();
        out.copy_from_slice(&colors[..len]);
    }
}
