//! Value noise: smoothly interpolated random numbers on a lattice, and sums of noise at increasing frequencies.
//!
//! The noise is periodic, so textures made from it can be tiled. The numbers come from an integer hash instead of a stateful
//! generator, so each texel can be computed independently and reproducibly. The interpolation uses Perlin's fade curve
//! ("Improving Noise", 2002).

use glam::Vec2;

/// Returns a pseudorandom number in [0, 1) for an integer position (the finalizer of MurmurHash3 over the mixed
/// coordinates).
pub(super) fn hash(x: u32, y: u32, seed: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    h = (h ^ h >> 16).wrapping_mul(0x85EB_CA6B);
    h = (h ^ h >> 13).wrapping_mul(0xC2B2_AE35);
    h ^= h >> 16;
    (h >> 8) as f32 / (1 << 24) as f32
}

/// Returns value noise in [0, 1] at `p`, with lattice points at integer positions. It repeats after `period` units on
/// each axis.
pub(super) fn value(p: Vec2, period: u32, seed: u32) -> f32 {
    let cell = p.floor();
    let t = p - cell;
    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let wrap = |i: f32| (i as i32).rem_euclid(period as i32) as u32;
    let corner = |dx: f32, dy: f32| hash(wrap(cell.x + dx), wrap(cell.y + dy), seed);
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    lerp(lerp(corner(0.0, 0.0), corner(1.0, 0.0), fade.x), lerp(corner(0.0, 1.0), corner(1.0, 1.0), fade.x), fade.y)
}

/// Returns the normalised sum of `octaves` noise layers, in [0, 1]. Each layer has twice the frequency and half the
/// amplitude of the previous one.
pub(super) fn fractal(p: Vec2, period: u32, octaves: u32, seed: u32) -> f32 {
    let sum: f32 = (0..octaves)
        .map(|octave| {
            let finer = 1 << octave;
            value(p * finer as f32, period * finer, seed + octave) / finer as f32
        })
        .sum();
    sum / (2.0 - 2.0 / (1 << octaves) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_stays_in_range_varies_and_repeats() {
        let (mut least, mut most) = (f32::MAX, f32::MIN);
        for i in 0..400 {
            let p = Vec2::new(i as f32 * 0.37, i as f32 * 0.11);
            let n = fractal(p, 4, 5, 7);
            assert!((n - fractal(p + Vec2::new(4.0, -8.0), 4, 5, 7)).abs() < 1e-3, "{p}");
            (least, most) = (least.min(n), most.max(n));
        }
        assert!(least >= 0.0 && most <= 1.0 && most - least > 0.3, "{least} to {most}");
    }
}
