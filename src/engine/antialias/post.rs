//! Post filter: applies the filter of a recipe to the finished picture.

use super::fxaa;
use super::mask;
use super::settings::{PostFilter, PostFilterKind};
use super::smaa;
use crate::flat2d::convolve::Mask;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::ColorSpace;

/// Returns the filtered picture, or `None` if there is no filter to apply. FXAA and SMAA reuse
/// the buffer `memory`.
pub(crate) fn apply(filter: &PostFilter, picture: &Image<Rgba8>, memory: Option<Image<Rgba8>>) -> Option<Image<Rgba8>> {
    let linear = filter.light == ColorSpace::Linear;
    match filter.filter {
        PostFilterKind::Fxaa => Some(fxaa::apply(picture, linear, memory)),
        PostFilterKind::Smaa => Some(smaa::apply(picture, linear, memory)),
        _ => mask_of(filter).map(|mask| mask::apply(&mask, picture, linear)),
    }
}

/// Returns the convolution mask of a filter, or `None` if the filter is not a convolution.
pub(crate) fn mask_of(filter: &PostFilter) -> Option<Mask> {
    match filter.filter {
        PostFilterKind::None | PostFilterKind::Fxaa | PostFilterKind::Smaa => None,
        PostFilterKind::Blur => Some(Mask::blur(filter.strength.round() as usize)),
        PostFilterKind::Gaussian => Some(Mask::gaussian(filter.strength)),
        PostFilterKind::Sharpen => Some(Mask::sharpen(filter.strength)),
        PostFilterKind::Motion => Some(Mask::motion(filter.strength, filter.angle_degrees.to_radians())),
        PostFilterKind::Custom => Mask::square(&filter.mask).ok(),
    }
}

/// Returns the maximum distance, in pixels, at which a filter reads neighbours of a pixel, or `None` if there is no
/// filter to apply.
pub(crate) fn reach(filter: &PostFilter) -> Option<u32> {
    match filter.filter {
        PostFilterKind::Fxaa => Some(fxaa::SEARCH_PX),
        PostFilterKind::Smaa => Some(smaa::REACH_PX),
        _ => mask_of(filter).map(|mask| mask.reach()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antialias::settings::centred_in_5x5;

    #[test]
    fn a_custom_mask_of_three_rows_is_centred() {
        let weights = [0.0, 0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0];
        let filter =
            PostFilter { filter: PostFilterKind::Custom, mask: centred_in_5x5(weights), ..PostFilter::default() };
        let picture = Image::from_fn(3, 6, |x, y| [(x * 20 + y * 7) as u8, 0, 0, 255]);
        let expected = mask::apply(&Mask::square(&weights).unwrap(), &picture, true);
        assert_eq!(apply(&filter, &picture, None), Some(expected));
        assert_eq!(apply(&PostFilter::default(), &picture, None), None);
    }
}
