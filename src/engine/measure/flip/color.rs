//! Colour spaces of FLIP: opponent colours, which are blurred, and L\*a\*b\*, in which colours are compared.

use std::array::from_fn;

use crate::image::Rgba8;
use crate::image::color::Tables;

/// Three components of a colour, or one row of a colour matrix.
type Color = [f64; 3];

/// Matrix from linear sRGB to CIE XYZ, with white at D65. The inverse is [`RGB_FROM_XYZ`].
const XYZ_FROM_RGB: [Color; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// Matrix from CIE XYZ to linear sRGB, with white at D65.
const RGB_FROM_XYZ: [Color; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

fn transform(matrix: &[Color; 3], color: Color) -> Color {
    matrix.map(|row| row[0] * color[0] + row[1] * color[1] + row[2] * color[2])
}

/// Returns the CIE XYZ of white.
fn white() -> Color {
    transform(&XYZ_FROM_RGB, [1.0; 3])
}

/// Lookup table from 8-bit sRGB-encoded values to opponent colours; the opponent colour of a pixel is the sum of the
/// entries for its three channels.
pub(super) struct Opponents {
    /// Lightness (Y), red–green (Cx) and blue–yellow (Cz) per channel and 8-bit value, all computed from linear light.
    /// The red entries include the constant term.
    of_code: [[[f32; 3]; 256]; 3],
}

impl Opponents {
    pub(super) fn new() -> Self {
        let light = &Tables::get().linear_of_code.values;
        let white = white();
        let of_code = from_fn(|channel| {
            from_fn(|code| {
                let xyz = XYZ_FROM_RGB.map(|row| row[channel] * f64::from(light[code]));
                let [x, y, z] = [0, 1, 2].map(|i| xyz[i] / white[i]);
                let constant = if channel == 0 { 16.0 } else { 0.0 };
                [116.0 * y - constant, 500.0 * (x - y), 200.0 * (y - z)].map(|value| value as f32)
            })
        });
        Self { of_code }
    }

    /// Returns the opponent colours of a row as three planes.
    pub(super) fn planes(&self, row: &[Rgba8]) -> [Vec<f32>; 3] {
        let [red, green, blue] = &self.of_code;
        let mut planes = [const { Vec::new() }; 3];
        planes.iter_mut().for_each(|plane| plane.reserve(row.len()));
        for [r, g, b, _] in row {
            let parts = [red[*r as usize], green[*g as usize], blue[*b as usize]];
            for (i, plane) in planes.iter_mut().enumerate() {
                plane.push(parts[0][i] + parts[1][i] + parts[2][i]);
            }
        }
        planes
    }
}

/// Conversion from opponent colours to L\*a\*b\*, through linear sRGB clamped to [0, 1]. a\* and b\* are scaled by
/// lightness, because dark colours look less colourful (Hunt effect).
pub(super) struct LabFromOpponent {
    rgb_from_relative_xyz: [[f32; 3]; 3],
    relative_xyz_from_rgb: [[f32; 3]; 3],
}

impl LabFromOpponent {
    pub(super) fn new() -> Self {
        let white = white();
        Self {
            rgb_from_relative_xyz: RGB_FROM_XYZ.map(|row| from_fn(|i| (row[i] * white[i]) as f32)),
            relative_xyz_from_rgb: from_fn(|i| XYZ_FROM_RGB[i].map(|value| (value / white[i]) as f32)),
        }
    }

    pub(super) fn lab_of_opponent(&self, [lightness, cx, cz]: [f32; 3]) -> [f32; 3] {
        let y = (lightness + 16.0) / 116.0;
        let rgb = product(&self.rgb_from_relative_xyz, [cx / 500.0 + y, y, y - cz / 200.0]);
        self.lab_of_rgb(rgb.map(|channel| channel.clamp(0.0, 1.0)))
    }

    pub(super) fn lab_of_rgb(&self, rgb: [f32; 3]) -> [f32; 3] {
        const DELTA: f32 = 6.0 / 29.0;
        let [x, y, z] = product(&self.relative_xyz_from_rgb, rgb)
            .map(|t| if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 });
        let lightness = 116.0 * y - 16.0;
        [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
    }
}

fn product(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Returns the HyAB distance of two L\*a\*b\* colours: absolute difference in lightness plus Euclidean distance in
/// chroma.
pub(super) fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let (da, db) = (a[1] - b[1], a[2] - b[2]);
    (a[0] - b[0]).abs() + (da * da + db * db).sqrt()
}
