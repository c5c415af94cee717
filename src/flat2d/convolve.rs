//! Convolution of a picture with a mask of 3 × 3 weights: blur, sharpen, and the trace of a movement.

use crate::image::Image;

/// Weights, row by row from the upper left neighbour to the lower right one.
pub type Mask = [[f64; 3]; 3];

/// The mean with the middle counting most: binomial in both directions. Sums to 1.
pub const BLUR: Mask = [[0.0625, 0.125, 0.0625], [0.125, 0.25, 0.125], [0.0625, 0.125, 0.0625]];

/// Takes the four neighbours off: what differs from its surroundings differs more. Sums to 1.
pub const SHARPEN: Mask = [[0.0, -1.0, 0.0], [-1.0, 5.0, -1.0], [0.0, -1.0, 0.0]];

/// The mean along a diagonal, as a movement during the exposure leaves it. Sums to 1.
pub const MOTION: Mask = [[1.0 / 3.0, 0.0, 0.0], [0.0, 1.0 / 3.0, 0.0], [0.0, 0.0, 1.0 / 3.0]];

/// The value of one pixel and what it is the sum of: (weight, value) by rows. Beyond the edge the picture goes on as it ends.
pub fn convolve_at(image: &Image<f64>, mask: &Mask, (x, y): (u32, u32)) -> (f64, [(f64, f64); 9]) {
    let parts = std::array::from_fn(|i| {
        let (column, row) = ((i % 3) as i64, (i / 3) as i64);
        (mask[i / 3][i % 3], image.at_clamped(i64::from(x) + column - 1, i64::from(y) + row - 1))
    });
    (parts.iter().map(|(weight, value)| weight * value).sum(), parts)
}

/// Every pixel; values may leave the range of those of `image` where weights are negative.
pub fn convolve(image: &Image<f64>, mask: &Mask) -> Image<f64> {
    Image::from_fn(image.width(), image.height(), |x, y| convolve_at(image, mask, (x, y)).0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_impulse_gives_the_mask_and_a_plain_picture_stays() {
        let impulse = Image::from_fn(5, 5, |x, y| f64::from((x, y) == (2, 2)));
        for mask in [BLUR, SHARPEN, MOTION] {
            let found = convolve(&impulse, &mask);
            for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
                // Convolution turns the mask around; these are symmetric.
                assert_eq!(found.at(column + 1, row + 1), mask[2 - row as usize][2 - column as usize]);
            }
            let plain = convolve(&Image::filled(4, 3, 0.5), &mask);
            assert!(plain.pixels().iter().all(|value| (value - 0.5).abs() < 1e-15), "weights sum to 1");
        }
    }
}
