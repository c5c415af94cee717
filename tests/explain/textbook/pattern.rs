//! Patterns of textures. None equals its own mirror image, so that a flipped or transposed texture shows.

use super::{Picture, Size};

/// sRGB codes of a colour.
type Codes = [u8; 3];

/// Returns a texture from the colours of its texels, by column and row from the top left.
fn texture(width: usize, height: usize, color: impl Fn(usize, usize) -> Codes) -> Picture {
    let pixels = (0..width * height).map(|index| color(index % width, index / width)).collect();
    Picture { size: Size { width, height }, pixels }
}

/// Returns a colour between `from` at 0 and `to` at 1, mixed in sRGB codes.
fn mix(from: Codes, to: Codes, part: f64) -> Codes {
    [0, 1, 2].map(|i| (f64::from(from[i]) + (f64::from(to[i]) - f64::from(from[i])) * part).round() as u8)
}

/// Returns a capital F of `ink` on `paper` in a frame of `ink`, of 32×32 texels.
pub(crate) fn letter(ink: Codes, paper: Codes) -> Picture {
    texture(32, 32, |x, y| {
        let frame = x < 2 || y < 2 || x >= 30 || y >= 30;
        let stem = (8..13).contains(&x) && (6..26).contains(&y);
        let bars = (6..10).contains(&y) && (8..25).contains(&x) || (14..18).contains(&y) && (8..20).contains(&x);
        if frame || stem || bars { ink } else { mix(paper, ink, 0.3 * y as f64 / 32.0) }
    })
}

/// Returns rows of bricks in running bond, darker to the right, of 64×32 texels.
pub(crate) fn bricks(brick: Codes, mortar: Codes) -> Picture {
    texture(64, 32, |x, y| {
        let row = y / 8;
        let shifted = x + 11 * row;
        if y % 8 == 0 || shifted % 32 < 2 {
            return mortar;
        }
        let shade = 0.25 * (row as f64 / 4.0) + 0.35 * (shifted % 32) as f64 / 32.0;
        mix(brick, [20, 20, 30], shade)
    })
}

/// Returns diagonal stripes of three widths, of 32×32 texels.
pub(crate) fn stripes(colors: [Codes; 3]) -> Picture {
    texture(32, 32, |x, y| match (x + 2 * y) % 32 {
        0..=5 => colors[0],
        6..=15 => colors[1],
        _ => colors[2],
    })
}

/// Returns one colour that darkens towards the bottom right, with a light square at the top left, of 16×16 texels.
pub(crate) fn shaded(color: Codes) -> Picture {
    texture(16, 16, |x, y| {
        if (2..6).contains(&x) && (2..5).contains(&y) {
            return mix(color, [255, 255, 255], 0.5);
        }
        mix(color, [0, 0, 0], 0.45 * (x + 2 * y) as f64 / 48.0)
    })
}

/// Returns arrows to the right above a row of dots, in `ink` on `paper`, of 64×32 texels.
pub(crate) fn arrows(ink: Codes, paper: Codes) -> Picture {
    texture(64, 32, |x, y| {
        let (along, across) = (x as i32, y as i32 - 11);
        let shaft = (6..40).contains(&along) && across.abs() < 3;
        let head = (38..54).contains(&along) && across.abs() < (54 - along) / 2 + 1;
        let dot = (24..29).contains(&y) && x % 16 < 6;
        let joint = x == 0 || y == 0;
        match () {
            () if joint => mix(ink, paper, 0.4),
            () if shaft || head => ink,
            () if dot => mix(ink, [240, 120, 30], 0.6),
            () => mix(paper, ink, 0.25 * x as f64 / 64.0),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_pattern_equals_its_mirror_image() {
        let [red, green, blue] = [[200, 40, 30], [40, 180, 60], [50, 60, 200]];
        for pattern in
            [letter(red, blue), bricks(red, green), stripes([red, green, blue]), shaded(red), arrows(red, green)]
        {
            let Size { width, height } = pattern.size;
            let mirrored = texture(width, height, |x, y| pattern.pixels[y * width + width - 1 - x]);
            let upside_down = texture(width, height, |x, y| pattern.pixels[(height - 1 - y) * width + x]);
            let least = width * height / 10;
            assert!(pattern.differing(&mirrored, 2) > least && pattern.differing(&upside_down, 2) > least);
        }
    }
}
