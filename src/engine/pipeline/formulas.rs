//! Formulas of the pixel stages, written once: for the floats of the classic execution and of the inspector, for the lanes
//! of the tiled execution, and for the explanations of pixels.
//!
//! Every operation is rounded separately, and the order of operations is fixed, so all of them give the same bits. The
//! functions are `#[inline(always)]`, because lanes need the instruction set of their caller. Formulas of light and depth
//! are in [`super::shading`] and in [`crate::scene::DepthMapping`].

use std::ops::{Add, Mul, Sub};

/// Returns the products of the edge values of a sample and the relative 1/w of the corners. Divided by their sum, they are
/// the perspective-correct weights of the corners.
#[inline(always)]
pub(crate) fn weight_products<N: Mul<Output = N>>([e0, e1, e2]: [N; 3], [r0, r1, r2]: [N; 3]) -> [N; 3] {
    [e0 * r0, e1 * r1, e2 * r2]
}

/// Returns the sum of three numbers.
#[inline(always)]
pub(crate) fn sum_of_three<N: Add<Output = N>>([a, b, c]: [N; 3]) -> N {
    a + b + c
}

/// Returns the differences of an attribute from its value at the first corner to those at the second and the third.
#[inline(always)]
pub(crate) fn differences<T: Clone + Sub<Output = T>>([first, second, third]: [T; 3]) -> [T; 2] {
    [second - first.clone(), third - first]
}

/// Returns the change of an attribute for given changes of the weights of the second and the third corner.
#[inline(always)]
pub(crate) fn change<T, W>([second, third]: [T; 2], [of_second, of_third]: [W; 2]) -> T
where
    T: Add<Output = T> + Mul<W, Output = T>,
{
    second * of_second + third * of_third
}

/// Returns an attribute at a sample, from its values at the corners and the weights of the second and the third. An
/// attribute that is equal at all corners keeps its value exactly.
#[inline(always)]
pub(crate) fn interpolated<T, W>(corners: [T; 3], weights: [W; 2]) -> T
where
    T: Clone + Add<Output = T> + Sub<Output = T> + Mul<W, Output = T>,
{
    interpolated_by_differences(corners[0].clone(), differences(corners), weights)
}

/// Returns the same as [`interpolated`], from the value at the first corner and the [`differences`] from it.
#[inline(always)]
pub(crate) fn interpolated_by_differences<T, W>(first: T, [second, third]: [T; 2], weights: [W; 2]) -> T
where
    T: Add<Output = T> + Mul<W, Output = T>,
{
    let [of_second, of_third] = weights;
    first + second * of_second + third * of_third
}

/// Returns the bilinear weights of the upper left, the upper right, the lower left and the lower right texel, from the
/// shares of the right and the lower ones.
#[inline(always)]
pub(crate) fn bilinear_weights<N>(one: N, [right, down]: [N; 2]) -> [N; 4]
where
    N: Clone + Sub<Output = N> + Mul<Output = N>,
{
    let (left, up) = (one.clone() - right.clone(), one - down.clone());
    [left.clone() * up.clone(), right.clone() * up, left * down.clone(), right * down]
}

/// Returns the weighted sum of four texels.
#[inline(always)]
pub(crate) fn weighted_sum<T, W>([a, b, c, d]: [T; 4], [of_a, of_b, of_c, of_d]: [W; 4]) -> T
where
    T: Add<Output = T> + Mul<W, Output = T>,
{
    a * of_a + b * of_b + c * of_c + d * of_d
}

/// Returns a colour blended over the one below it, weighted by alpha.
#[inline(always)]
pub(crate) fn blended<T, W>(one: W, color: T, below: T, alpha: W) -> T
where
    T: Add<Output = T> + Mul<W, Output = T>,
    W: Clone + Sub<Output = W>,
{
    color * alpha.clone() + below * (one - alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Explanations use the same functions, so only values that were calculated by hand show an error.
    #[test]
    fn formulas_have_the_values_calculated_by_hand() {
        let products = weight_products([2.0, 3.0, 4.0], [1.0, 0.5, 0.25]);
        assert_eq!((products, sum_of_three(products)), ([2.0, 1.5, 1.0], 4.5));
        assert_eq!(interpolated([1.0, 3.0, 7.0], [0.5, 0.25]), 3.5);
        assert_eq!(change(differences([1.0, 3.0, 7.0]), [0.5, 0.25]), 2.5);
        let weights = bilinear_weights(1.0, [0.25, 0.5]);
        assert_eq!(weights, [0.375, 0.125, 0.375, 0.125]);
        assert_eq!(weighted_sum([8.0, 16.0, 24.0, 32.0], weights), 18.0);
        assert_eq!(blended(1.0, 0.75, 0.25, 0.25), 0.375);
    }
}
