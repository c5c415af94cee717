//! Outcodes of vertices and clipping decisions for triangles: the tests of [`clip`], performed for eight vertices at a
//! time.
//!
//! [`clip`]: crate::pipeline::clip

use std::ops::{BitAnd, BitOr};

use crate::math::lanes::*;
use crate::pipeline::clip_space::{ClipPlane, MIN_W};

/// Outcode of a vertex: one bit for each frustum plane that the vertex is beyond, and two flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Outcode(u16);

impl Outcode {
    const NOT_FINITE: u16 = 1 << 14;
    const CROSSES: u16 = 1 << 15;
    /// Outcode with all bits set: the neutral element of `&`.
    pub(super) const ALL: Self = Self(u16::MAX);
    const PLANES: u16 = (1 << ClipPlane::ALL.len()) - 1;

    /// Returns the outcodes of eight vertices in clip space, and whether any of them is nonzero. The guard band is
    /// bounded by the side planes, moved outward by the factor `widening`. A triangle that crosses a side plane is
    /// clipped only if it also leaves the guard band.
    #[inline(always)]
    pub(super) fn of_lanes<S: Simd>(simd: S, [x, y, z, w]: [F32<S>; 4], widening: f32) -> ([Self; LANES], bool) {
        let between_sides = w.simd_ge(x.abs()) & w.simd_ge(y.abs());
        let in_depth = z.simd_ge(0.0) & w.simd_ge(z) & w.simd_ge(MIN_W) & w.simd_le(f32::MAX);
        if (between_sides & in_depth).all_true() {
            return ([Self::default(); LANES], false);
        }
        // Each distance is the difference of two floats, so comparing the two floats gives its sign.
        let depth = each!(beyond in [z.simd_lt(0.0), w.simd_lt(MIN_W), w.simd_lt(z)] => beyond.to_bitmask());
        let offsets = [-x, x, -y, y];
        let sides = each!(i in [0, 1, 2, 3] => w.simd_lt(offsets[i]).to_bitmask());
        // Products of floats are exact in doubles.
        let band = widen(simd, w) * f64::from(widening);
        let cut = each!(i in [0, 1, 2, 3] => sides[i] & band.simd_lt(widen(simd, offsets[i])).to_bitmask());
        let is_finite = (x.is_finite() & y.is_finite() & z.is_finite() & w.is_finite()).to_bitmask();
        let crosses = depth[0] | depth[1] | depth[2] | cut[0] | cut[1] | cut[2] | cut[3];
        // In the order of `ClipPlane::ALL`.
        let planes = [depth[0], depth[1], depth[2], sides[0], sides[1], sides[2], sides[3]];
        let mut codes = [Self(Self::NOT_FINITE | Self::CROSSES); LANES];
        for (lane, code) in codes.iter_mut().enumerate().filter(|(lane, _)| is_finite >> lane & 1 != 0) {
            code.0 = if crosses >> lane & 1 != 0 { Self::CROSSES } else { 0 };
            for (bit, beyond) in planes.iter().enumerate() {
                code.0 |= ((beyond >> lane & 1) << bit) as u16;
            }
        }
        (codes, true)
    }

    /// Decides from the outcodes of a triangle's vertices whether it is dropped, clipped or drawn whole.
    #[inline(always)]
    pub(super) fn verdict(corners: [Self; 3]) -> ClipVerdict {
        let [a, b, c] = corners;
        let any = a | b | c;
        if any.0 & Self::NOT_FINITE != 0 || (a & b & c).is_beyond() {
            ClipVerdict::Rejected
        } else if any.0 & Self::CROSSES != 0 {
            ClipVerdict::Cut
        } else {
            ClipVerdict::Whole
        }
    }

    /// Returns `true` if the bit of any frustum plane is set.
    #[inline(always)]
    pub(super) fn is_beyond(self) -> bool {
        self.0 & Self::PLANES != 0
    }

    /// Returns `true` if the vertex lies within the frustum.
    #[inline(always)]
    pub(super) fn is_inside(self) -> bool {
        self.0 == 0
    }
}

impl BitAnd for Outcode {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Outcode {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Result of the clipping tests of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ClipVerdict {
    /// The triangle is dropped: it is outside the frustum, or a vertex is not finite.
    Rejected,
    /// The triangle must be clipped.
    Cut,
    /// The triangle is drawn without clipping.
    Whole,
}

#[cfg(test)]
mod tests {
    use glam::Vec4;

    use super::*;

    /// Computes the outcode from plane distances, as the clipping stage does.
    fn expected(position: Vec4, widening: f32) -> Outcode {
        if !position.is_finite() {
            return Outcode(Outcode::NOT_FINITE | Outcode::CROSSES);
        }
        let mut bits = 0;
        for (bit, plane) in ClipPlane::ALL.iter().enumerate() {
            if plane.distance(position, 1.0) < 0.0 {
                bits |= 1 << bit;
                if plane.distance(position, widening) < 0.0 {
                    bits |= Outcode::CROSSES;
                }
            }
        }
        Outcode(bits)
    }

    #[test]
    fn outcodes_agree_with_plane_distances() {
        const WIDENING: f32 = 34.133_335;
        const SPECIAL: [f32; 12] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.999_999_94,
            WIDENING,
            -1.5,
            f32::MIN_POSITIVE,
            1e-45,
            f32::MAX,
            f32::INFINITY,
            f32::NAN,
        ];
        let mut random = fastrand::Rng::with_seed(11);
        let mut number = || match random.u32(..4) {
            0 => SPECIAL[random.usize(..SPECIAL.len())],
            1 => random.f32() * 80.0 - 40.0,
            _ => random.f32(),
        };
        let mut seen = 0;
        for _ in 0..20_000 {
            let group: [Vec4; LANES] = std::array::from_fn(|_| Vec4::from_array(std::array::from_fn(|_| number())));
            let expected = group.map(|position| expected(position, WIDENING));
            let columns: [[f32; LANES]; 4] = std::array::from_fn(|axis| group.map(|position| position[axis]));
            for lanes in Lanes::all() {
                let found = on_lanes!(lanes, simd => {
                    let columns = each!(axis in [0, 1, 2, 3] => F32::load_array(simd, columns[axis]));
                    Outcode::of_lanes(simd, columns, WIDENING)
                });
                assert_eq!(found, (expected, expected.iter().any(|code| !code.is_inside())), "{group:?}");
            }
            seen |= expected.iter().fold(0, |all, code| all | code.0);
        }
        assert_eq!(seen, Outcode::PLANES | Outcode::CROSSES | Outcode::NOT_FINITE);
    }

    #[test]
    fn vertices_inside_have_no_outcode_bits() {
        let inside = Vec4::new(-1.0, 0.25, 0.0, 1.0).to_array();
        for lanes in Lanes::all() {
            let (codes, any) = on_lanes!(lanes, simd => {
                let columns = each!(axis in [0, 1, 2, 3] => F32::splat(simd, inside[axis]));
                Outcode::of_lanes(simd, columns, 2.0)
            });
            assert!(!any && codes.iter().all(|code| code.is_inside()));
        }
    }
}
