//! Picture files as input of the lab page on seed fills, reduced to a grid.

use super::Paint;
use crate::image::{Image, Rgba8};

/// Threshold for the brightest channel of a grid pixel, in [0, 255]: pixels below it become walls.
const WALL_BELOW: f32 = 96.0;

/// Difference between the brightest and the darkest channel of a grid pixel, in [0, 255], above which the pixel counts
/// as coloured.
const COLOR_FROM: f32 = 64.0;

/// Reduces a picture to a grid of `width` × `height` pixels and keeps its aspect ratio. Coloured pixels become
/// [`Paint::Spot`], dark ones [`Paint::Wall`], all others [`Paint::Paper`], as do pixels outside the picture.
pub(super) fn painted(picture: &Image<Rgba8>, (width, height): (u32, u32)) -> Image<Paint> {
    let [wide, high] = [picture.width(), picture.height()].map(f64::from);
    let cell_px = (wide / f64::from(width)).max(high / f64::from(height));
    let left = (f64::from(width) - wide / cell_px) / 2.0;
    let top = (f64::from(height) - high / cell_px) / 2.0;
    Image::from_fn(width, height, |x, y| {
        let range = |at: u32, before: f64, end: f64| {
            let from = ((f64::from(at) - before) * cell_px).max(0.0);
            let to = ((f64::from(at) + 1.0 - before) * cell_px).min(end);
            let (from, to) = (from.round() as u32, to.round() as u32);
            // A cell narrower than a picture pixel may contain no pixel centre. Such a cell takes the pixel that
            // contains its centre.
            let middle = (f64::from(at) + 0.5 - before) * cell_px;
            if from == to && (0.0..end).contains(&middle) { middle as u32..middle as u32 + 1 } else { from..to }
        };
        let (columns, rows) = (range(x, left, wide), range(y, top, high));
        let pixels = rows.flat_map(|row| columns.clone().map(move |column| picture.at(column, row)));
        mean(pixels).map_or(Paint::Paper, paint)
    })
}

fn mean(pixels: impl Iterator<Item = Rgba8>) -> Option<[f32; 3]> {
    let (sum, count) = pixels.fold(([0.0_f32; 3], 0_u32), |(sum, count), [r, g, b, _]| {
        ([sum[0] + f32::from(r), sum[1] + f32::from(g), sum[2] + f32::from(b)], count + 1)
    });
    (count > 0).then(|| sum.map(|channel| channel / count as f32))
}

fn paint(color: [f32; 3]) -> Paint {
    let (low, high) = color.iter().fold((f32::INFINITY, 0.0_f32), |(low, high), c| (low.min(*c), high.max(*c)));
    match () {
        () if high - low > COLOR_FROM => Paint::Spot,
        () if high < WALL_BELOW => Paint::Wall,
        () => Paint::Paper,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dark_cells_are_walls_coloured_ones_spots_and_the_aspect_ratio_is_kept() {
        let picture = Image::from_fn(40, 40, |x, y| match (x < 20, y < 20) {
            (true, true) => [10, 10, 10, 255],
            (true, false) => [200, 30, 30, 255],
            (false, _) => [240, 240, 240, 255],
        });
        let grid = painted(&picture, (8, 4));
        // The picture is square, so it is centred in the wide grid.
        let row = |y| (0..8).map(|x| grid.at(x, y)).collect::<Vec<_>>();
        let (paper, wall, spot) = (Paint::Paper, Paint::Wall, Paint::Spot);
        assert_eq!(row(0), [paper, paper, wall, wall, paper, paper, paper, paper]);
        assert_eq!(row(3), [paper, paper, spot, spot, paper, paper, paper, paper]);
    }

    #[test]
    fn a_picture_smaller_than_the_grid_has_no_gaps() {
        for side in [1, 3, 5, 7, 19] {
            let grid = painted(&Image::filled(side, side, [0, 0, 0, 255]), (40, 20));
            let expected =
                Image::from_fn(40, 20, |x, _| if (10..30).contains(&x) { Paint::Wall } else { Paint::Paper });
            assert_eq!(grid, expected, "{side}");
        }
    }

    #[test]
    fn any_size_of_picture_gives_the_grid() {
        for size in [(1, 1), (1, 500), (700, 2), (29, 19), (31, 21)] {
            let grid = painted(&Image::filled(size.0, size.1, [0, 0, 0, 255]), (30, 20));
            assert!(grid.size() == (30, 20) && grid.pixels().contains(&Paint::Wall), "{size:?}");
        }
    }
}
