//! Shading eight samples of a row at a time: once per visible sample.
//!
//! The arithmetic is that of [`crate::pipeline::interpolate`] and [`crate::pipeline::shade`], operation by operation. Shadings
//! that show a single quantity are left to those functions themselves.

use glam::Vec3;

use super::Frame;
use super::geometry::lambert_lanes;
use super::lattice::{BLOCK, Lattice, TILE};
use super::record::{Record, Source, edge_values};
use super::setup::Edges;
use super::shader::{DrawShader, Light, Plan};
use super::texture::Taps;
use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::math::lanes::*;
use crate::pipeline::interpolate::interpolate;
use crate::pipeline::raster::Sample;
use crate::pipeline::settings::ColorSpace;
use crate::pipeline::viewport::ScreenTriangle;

/// Rows of samples that wait for their texels. Where texels lie is found out for all rows before the first texel is read,
/// so that what one read waits for, another one does not.
#[derive(Clone, Debug, Default)]
pub(super) struct Queue {
    rows: [QueuedRow; QUEUED],
    len: usize,
    /// Position of the shader of all rows.
    shader: usize,
}

/// Rows that wait together: those of a block.
const QUEUED: usize = BLOCK;

/// Eight samples of a row.
#[derive(Clone, Debug, Default)]
#[repr(align(32))]
struct QueuedRow {
    taps: Taps,
    light: [f32; LANES],
    /// The surface's colour without the texture, where it varies.
    color: [[f32; LANES]; 3],
    /// Position of the first sample in the tile's rows of the picture.
    start: usize,
    /// Samples that lie within the picture.
    count: usize,
    /// A bit for each sample that is written.
    mine: u32,
}

/// Some rows of samples of a block, at most eight wide.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) tile: (usize, usize),
    /// First column, within the tile.
    pub(super) column: usize,
    /// Columns that lie within the picture.
    pub(super) count: usize,
    /// First row, within the tile.
    pub(super) first: usize,
    /// One past the last row.
    pub(super) end: usize,
    /// A bit for each sample of a row that is shaded.
    pub(super) mine: u32,
}

/// Rows of the packed picture that start with the first one of a tile.
pub(super) struct Band<'a> {
    pub(super) pixels: &'a mut [Rgba8],
    pub(super) width: usize,
}

impl Band<'_> {
    #[inline(always)]
    fn start(&self, patch: &Patch, row: usize) -> usize {
        row * self.width + patch.tile.0 * TILE + patch.column
    }

    #[inline(always)]
    pub(super) fn row(&mut self, patch: &Patch, row: usize) -> &mut [Rgba8] {
        let start = self.start(patch, row);
        &mut self.pixels[start..start + patch.count]
    }
}

/// All samples of a row.
pub(super) const ALL: u32 = (1 << LANES) - 1;

/// Samples that belong to one triangle.
#[inline(never)]
pub(super) fn shade_uniform<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    record: &Record,
    patch: &Patch,
    queue: &mut Queue,
    band: &mut Band<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let shader = frame.shader(record.draw);
            let lattice = &frame.lattice;
            if shader.on_lanes && record.fits_i32 {
                let edges = IntegerRows::new(simd, lattice, record, patch);
                return shade_rows(
                    simd,
                    frame,
                    record,
                    patch,
                    (queue, band),
                    #[inline(always)]
                    |row| edges.at(row),
                );
            }
            let Edges { a, b, c, .. } = record.edges;
            let columns = F64::load_array(simd, lattice.lanes) + lattice.column(patch.column);
            let along = each!(i in [0, 1, 2] => columns * a[i]);
            let y = F64::load_array(simd, lattice.rows) + patch.first as f64 * lattice.row_step;
            let shift = F64::load_array(simd, lattice.shifts(patch.first));
            let down = each!(i in [0, 1, 2] => (y * b[i] + shift * a[i] + c[i]).to_array());
            if !shader.on_lanes {
                let whole = frame.screen_triangle(record.key, record.draw);
                for (i, row) in (patch.first..patch.end).enumerate() {
                    let e = each!(edge in [0, 1, 2] => (along[edge] + down[edge][i]).to_array());
                    one_by_one(frame, shader, &whole, patch, row, &e, band.row(patch, row));
                }
                return;
            }
            shade_rows(
                simd,
                frame,
                record,
                patch,
                (queue, band),
                #[inline(always)]
                |row| each!(edge in [0, 1, 2] => narrow(simd, along[edge] + down[edge][row])),
            );
        },
    );
}

/// Rows of samples that belong to one triangle, by its edge values in each of the rows.
#[inline(always)]
fn shade_rows<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    record: &Record,
    patch: &Patch,
    (queue, band): (&mut Queue, &mut Band<'_>),
    edges: impl Fn(usize) -> [F32<S>; 3],
) {
    let shader = frame.shader(record.draw);
    let rows = make_room(simd, frame, frame.shader_of_draw[record.draw], patch.end - patch.first, queue, band);
    let relative_inv_w = record.relative_inv_w(simd);
    let plan = shader.plan;
    let mut start = band.start(patch, patch.first);
    for (i, row) in rows.iter_mut().enumerate() {
        let weights = corner_weights(simd, edges(i), relative_inv_w);
        (row.start, row.count, row.mine) = (start, patch.count, patch.mine);
        start += band.width;
        match plan {
            Plan::COMMON => interpolate_row(simd, shader, Plan::COMMON, record, weights, row),
            plan => interpolate_row(simd, shader, plan, record, weights, row),
        }
    }
}

/// Edge values of up to eight rows of a triangle that [`Record::fits_i32`]: sums that wrap around, and are right where the
/// triangle covers the sample.
struct IntegerRows<S: Simd> {
    /// Of the eight samples of a row, from its start.
    along: [i32x8<S>; 2],
    /// Of the starts of the rows.
    down: [[i32; LANES]; 2],
    doubled_area: i32,
}

impl<S: Simd> IntegerRows<S> {
    #[inline(always)]
    fn new(simd: S, lattice: &Lattice, record: &Record, patch: &Patch) -> Self {
        let columns = F64::load_array(simd, lattice.lanes) + lattice.column(patch.column);
        let columns: i32x8<S> = narrow(simd, columns).to_int();
        let y = F64::load_array(simd, lattice.rows) + patch.first as f64 * lattice.row_step;
        let y: i32x8<S> = narrow(simd, y).to_int();
        let shift: i32x8<S> = narrow(simd, F64::load_array(simd, lattice.shifts(patch.first))).to_int();
        let ([a0, b0, c0], [a1, b1, c1], doubled_area) = record.integer_edges();
        let down = each!((a, b, c) in [(a0, b0, c0), (a1, b1, c1)] => (y * b + shift * a + c).to_array());
        Self { along: [columns * a0, columns * a1], down, doubled_area }
    }

    #[inline(always)]
    fn at(&self, row: usize) -> [F32<S>; 3] {
        let [first, second] = each!(edge in [0, 1] => self.along[edge] + self.down[edge][row]);
        let third = i32x8::splat(first.simd, self.doubled_area) - first - second;
        each!(e in [first, second, third] => e.to_float::<F32<S>>())
    }
}

/// Places in the queue for some rows that a shader is for.
#[inline(always)]
fn make_room<'q, S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    shader: usize,
    rows: usize,
    queue: &'q mut Queue,
    band: &mut Band<'_>,
) -> &'q mut [QueuedRow] {
    if queue.shader != shader || queue.len + rows > QUEUED {
        flush(simd, frame, queue, band.pixels);
        queue.shader = shader;
    }
    let from = queue.len;
    queue.len += rows;
    &mut queue.rows[from..from + rows]
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
    for (lane, pixel) in out.iter_mut().enumerate().filter(|(lane, _)| patch.mine >> lane & 1 != 0) {
        let column = (patch.tile.0 * TILE + patch.column + lane) as u32;
        let (x, y) = frame.grid.pixel(column, row);
        let sample = Sample { column, row, x, y, edges: edges.map(|e| e[lane]) };
        let fragment = interpolate(triangle, sample, shader.shader.attributes());
        *pixel = shader.shader.shade(&fragment, triangle);
    }
}

/// Eight samples of eight triangles that one shader is for.
#[inline(never)]
pub(super) fn shade_gathered<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    shader: usize,
    records: &[&Record; LANES],
    patch: &Patch,
    queue: &mut Queue,
    band: &mut Band<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let [queued] = make_room(simd, frame, shader, 1, queue, band) else { return };
            let (lattice, row) = (&frame.lattice, patch.first);
            let x = F64::load_array(simd, lattice.lanes) + (lattice.column(patch.column) + lattice.shift(row));
            let x: i32x8<S> = narrow(simd, x).to_int();
            let y = i32x8::splat(simd, (row as f64 * lattice.row_step) as i32);
            let e = edge_values(simd, *records, x, y);
            let e = each!(i in [0, 1, 2] => e[i].to_float::<F32<S>>());
            let weights = corner_weights(simd, e, records.relative_inv_w(simd));
            let wanted = mask32x8::from_bitmask(simd, patch.mine.into());
            // The first corner stands for samples that are not wanted: what is computed there must not lead astray.
            let weights = each!(i in [0, 1] => wanted.select(weights[i], F32::splat(simd, 0.0)));
            (queued.start, queued.count, queued.mine) = (band.start(patch, row), patch.count, patch.mine);
            let shader = &frame.shaders[shader];
            match shader.plan {
                Plan::COMMON => interpolate_row(simd, shader, Plan::COMMON, *records, weights, queued),
                plan => interpolate_row(simd, shader, plan, *records, weights, queued),
            }
        },
    );
}

/// Weights of the second and third corner.
#[inline(always)]
fn corner_weights<S: Simd>(simd: S, e: [F32<S>; 3], relative_inv_w: [F32<S>; 3]) -> [F32<S>; 2] {
    let q = each!(i in [0, 1, 2] => e[i] * relative_inv_w[i]);
    let inverse_sum = F32::splat(simd, 1.0) / (q[0] + q[1] + q[2]);
    [q[1] * inverse_sum, q[2] * inverse_sum]
}

/// From weights to everything that is interpolated.
#[inline(always)]
fn interpolate_row<S: Simd>(
    simd: S,
    shader: &DrawShader<'_>,
    plan: Plan,
    source: impl Source,
    weights: [F32<S>; 2],
    row: &mut QueuedRow,
) {
    if let (Some(texture), Some(layout)) = (&shader.texture, plan.texture) {
        let [u, v] = source.uv(simd);
        texture.locate(simd, layout, [u.at(weights), v.at(weights)], &mut row.taps);
    }
    match plan.light {
        Light::None => {}
        Light::Vertices => source.light(simd).at(weights).store_array(&mut row.light),
        Light::Normals => {
            let normal = source.normal(simd);
            let normal = each!(axis in [0, 1, 2] => normal[axis].at(weights));
            let ambient = shader.shader.settings.light.ambient;
            lambert(simd, normal, shader.shader.light_direction, ambient).store_array(&mut row.light);
        }
    }
    if plan.colored {
        let (diffuse, color) = (shader.shader.diffuse.to_array(), source.color(simd));
        for channel in 0..3 {
            let color = F32::splat(simd, diffuse[channel]) * color[channel].at(weights);
            color.store_array(&mut row.color[channel]);
        }
    }
}

/// Reads the texels of all rows of the queue, finishes their colours, and writes those.
#[inline(never)]
pub(super) fn flush<S: Simd>(simd: S, frame: &Frame<'_>, queue: &mut Queue, pixels: &mut [Rgba8]) {
    simd.vectorize(
        #[inline(always)]
        || {
            let rows = std::mem::take(&mut queue.len);
            if rows == 0 {
                return;
            }
            let shader = &frame.shaders[queue.shader];
            let rows = &queue.rows[..rows];
            // Loops, as the closure of `for_each` may fail to be compiled for the chosen instructions.
            match shader.plan {
                Plan::COMMON => {
                    for row in rows {
                        finish_row(simd, shader, Plan::COMMON, row, pixels);
                    }
                }
                plan => {
                    for row in rows {
                        finish_row(simd, shader, plan, row, pixels);
                    }
                }
            }
        },
    );
}

/// Multiplies colour, texture and light, and writes the codes.
#[inline(always)]
fn finish_row<S: Simd>(simd: S, shader: &DrawShader<'_>, plan: Plan, row: &QueuedRow, pixels: &mut [Rgba8]) {
    let mut color = if plan.colored {
        each!(channel in [0, 1, 2] => F32::load_array_ref(simd, &row.color[channel]))
    } else {
        let diffuse = shader.shader.diffuse.to_array();
        each!(channel in [0, 1, 2] => F32::splat(simd, diffuse[channel]))
    };
    if let (Some(texture), Some(layout)) = (&shader.texture, plan.texture) {
        let texel = texture.read(simd, layout, plan.space, &row.taps);
        color = each!(channel in [0, 1, 2] => color[channel] * texel[channel]);
    }
    if plan.light != Light::None {
        let light = F32::load_array_ref(simd, &row.light);
        color = each!(channel in [0, 1, 2] => color[channel] * light);
    }
    let codes = code(simd, color, plan.space);
    let out = &mut pixels[row.start..row.start + row.count];
    if row.mine == ALL && row.count == LANES {
        codes.bitcast::<u8x32<S>>().store_slice(out.as_flattened_mut());
    } else {
        let codes = codes.to_array();
        for (lane, pixel) in out.iter_mut().enumerate().filter(|(lane, _)| row.mine >> lane & 1 != 0) {
            *pixel = codes[lane].to_le_bytes();
        }
    }
}

/// Colours of eight samples, packed.
#[inline(always)]
fn code<S: Simd>(simd: S, color: [F32<S>; 3], space: ColorSpace) -> u32x8<S> {
    let codes = match space {
        ColorSpace::Bytes => {
            each!(c in [0, 1, 2] => (color[c] * 255.0 + 0.5).max(0.0).min(255.0).to_int::<i32x8<S>>().bitcast::<u32x8<S>>())
        }
        ColorSpace::Linear => {
            let tables = Tables::get();
            each!(c in [0, 1, 2] => tables.encode_lanes(simd, color[c]))
        }
    };
    codes[0] | codes[1] << 8 | codes[2] << 16 | 0xFF00_0000
}

/// Light on normals that are not of unit length; no direct light on those of none.
#[inline(always)]
fn lambert<S: Simd>(simd: S, normal: [F32<S>; 3], direction: Vec3, ambient: f32) -> F32<S> {
    let [x, y, z] = normal;
    let reciprocal = F32::splat(simd, 1.0) / (x * x + y * y + z * z).sqrt();
    let has_length = reciprocal.is_finite() & reciprocal.simd_gt(0.0);
    let unit = each!(component in [x, y, z] => has_length.select(component * reciprocal, F32::splat(simd, 0.0)));
    lambert_lanes(unit, direction, ambient)
}
