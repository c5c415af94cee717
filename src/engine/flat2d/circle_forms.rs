//! Circles in explicit and parametric form, in floats, for comparison with the midpoint circle.
//!
//! The *explicit* form y = ±√(r² − x²) gives one pixel above and one below for each column, and leaves gaps where the
//! circle is steep. The *parametric* form (r cos φ, r sin φ) has no gaps if its steps are small enough, but then visits
//! pixels more than once. The third form is *implicit*: the sign of F(x, y) = x² + y² − r² shows whether a point lies
//! inside or outside. [`super::circle`] uses it.

use std::f64::consts::TAU;

/// Returns the pixels of a circle in explicit form: for each column, from the left, one pixel above and one below the
/// centre.
pub(crate) fn explicit_circle(center: (i32, i32), radius: u32) -> impl Iterator<Item = (i64, i64)> {
    let radius = i64::from(radius);
    (-radius..=radius).flat_map(move |x| {
        let height = ((radius * radius - x * x) as f64).sqrt().round() as i64;
        [height, -height].map(|y| (i64::from(center.0) + x, i64::from(center.1) + y))
    })
}

/// Returns the pixels of a circle in parametric form: one for each of `angles` evenly spaced angles, starting at the
/// right and going clockwise on a screen.
pub(crate) fn parametric_circle(center: (i32, i32), radius: u32, angles: u32) -> impl Iterator<Item = (i64, i64)> {
    (0..angles).map(move |i| {
        let (sin, cos) = (f64::from(i) / f64::from(angles) * TAU).sin_cos();
        let at = |center: i32, share: f64| (f64::from(center) + f64::from(radius) * share).round() as i64;
        (at(center.0, cos), at(center.1, sin))
    })
}

/// Returns a number of angles for which the parametric form has no gaps, because consecutive points are at most one
/// pixel apart.
pub(crate) fn angles_without_gaps(radius: u32) -> u32 {
    (TAU * f64::from(radius)).ceil().max(1.0) as u32
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::flat2d::circle::midpoint_circle;

    fn gaps(pixels: &HashSet<(i64, i64)>) -> usize {
        let has_two_neighbours = |(x, y): &(i64, i64)| {
            let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))).filter(|d| *d != (0, 0));
            around.filter(|(dx, dy)| pixels.contains(&(x + dx, y + dy))).count() >= 2
        };
        pixels.iter().filter(|pixel| !has_two_neighbours(pixel)).count()
    }

    #[test]
    fn the_explicit_form_leaves_gaps_and_the_parametric_one_does_not() {
        for radius in [8, 20, 77] {
            let explicit: HashSet<_> = explicit_circle((3, -4), radius).collect();
            let parametric: HashSet<_> = parametric_circle((3, -4), radius, angles_without_gaps(radius)).collect();
            let midpoint: HashSet<_> = midpoint_circle((3, -4), radius).collect();
            assert!(gaps(&explicit) > 0 && explicit.len() < midpoint.len(), "radius {radius}");
            assert_eq!((gaps(&parametric), gaps(&midpoint)), (0, 0), "radius {radius}");
            assert!(angles_without_gaps(radius) as usize > parametric.len(), "some pixels come twice");
            // Where the circle is flat, the explicit form gives exactly the pixels of the midpoint form.
            let flat = |(x, y): &&(i64, i64)| (x - 3).abs() < (y + 4).abs();
            assert!(explicit.iter().filter(flat).all(|pixel| midpoint.contains(pixel)), "radius {radius}");
        }
    }
}
