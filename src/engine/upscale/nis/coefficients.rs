//! Filter coefficients of NVIDIA Image Scaling.
//!
//! The tables are those of the SDK (NVIDIA Image Scaling SDK 1.0.3, `NIS_Config.h`), which are printed with four decimals.
//! All entries lie on a grid of 1/2048. The position between two samples is divided into 64 phases. Phase 64 − k has the
//! coefficients of phase k in reverse order, so the tables hold the phases up to 32.

/// Number of phases between two samples.
pub(super) const PHASES: u32 = 64;

/// Number of taps of both filters.
pub(super) const TAPS: usize = 6;

/// Unit of the tables.
const UNIT: f32 = 1.0 / 2048.0;

/// Returns the coefficients of the interpolating filter at a phase below [`PHASES`].
pub(super) fn scale(phase: u32) -> [f32; TAPS] {
    at(&SCALE, phase)
}

/// Returns the coefficients of the unsharp mask at a phase below [`PHASES`].
pub(super) fn unsharp(phase: u32) -> [f32; TAPS] {
    at(&UNSHARP, phase)
}

fn at(table: &[[i16; TAPS]; PHASES as usize / 2 + 1], phase: u32) -> [f32; TAPS] {
    let [a, b, c, d, e, f] = table[phase.min(PHASES - phase) as usize];
    let row = if phase <= PHASES / 2 { [a, b, c, d, e, f] } else { [f, e, d, c, b, a] };
    row.map(|coefficient| f32::from(coefficient) * UNIT)
}

/// Interpolating filter; each row sums to 1.
const SCALE: [[i16; TAPS]; PHASES as usize / 2 + 1] = [
    [0, 0, 2048, 0, 0, 0],
    [6, -26, 2048, 27, -7, 0],
    [13, -51, 2045, 55, -14, 0],
    [18, -74, 2039, 85, -21, 1],
    [24, -97, 2034, 115, -29, 1],
    [29, -118, 2027, 146, -37, 1],
    [34, -138, 2016, 179, -45, 2],
    [38, -156, 2004, 213, -54, 3],
    [42, -174, 1992, 247, -63, 4],
    [46, -190, 1976, 283, -72, 5],
    [49, -206, 1961, 319, -81, 6],
    [52, -220, 1943, 356, -90, 7],
    [54, -233, 1923, 395, -100, 9],
    [57, -244, 1901, 434, -110, 10],
    [59, -255, 1878, 473, -119, 12],
    [60, -265, 1855, 514, -129, 13],
    [62, -273, 1828, 555, -139, 15],
    [63, -280, 1800, 597, -149, 17],
    [63, -287, 1773, 639, -159, 19],
    [64, -292, 1742, 682, -169, 21],
    [64, -296, 1711, 725, -179, 23],
    [64, -299, 1678, 769, -189, 25],
    [64, -301, 1643, 812, -198, 28],
    [63, -303, 1609, 857, -208, 30],
    [62, -303, 1573, 901, -217, 32],
    [61, -303, 1537, 945, -226, 34],
    [60, -301, 1498, 989, -235, 37],
    [59, -299, 1458, 1034, -243, 39],
    [57, -296, 1419, 1078, -251, 41],
    [56, -293, 1377, 1122, -258, 44],
    [54, -289, 1337, 1166, -266, 46],
    [52, -284, 1295, 1209, -272, 48],
    [50, -278, 1252, 1252, -278, 50],
];

/// Unsharp mask; each row sums to 0, up to one unit.
const UNSHARP: [[i16; TAPS]; PHASES as usize / 2 + 1] = [
    [0, -1229, 2458, -1229, 0, 0],
    [6, -1246, 2455, -1209, -6, 0],
    [10, -1259, 2449, -1186, -14, 1],
    [15, -1269, 2435, -1159, -21, 0],
    [19, -1277, 2417, -1129, -31, 0],
    [23, -1283, 2396, -1096, -40, 1],
    [25, -1284, 2372, -1061, -53, 1],
    [29, -1287, 2346, -1025, -65, 1],
    [32, -1283, 2309, -981, -79, 1],
    [34, -1277, 2271, -936, -93, 2],
    [36, -1267, 2228, -890, -109, 2],
    [37, -1257, 2183, -840, -126, 3],
    [39, -1243, 2131, -787, -143, 3],
    [40, -1230, 2081, -732, -163, 4],
    [41, -1214, 2026, -673, -184, 5],
    [41, -1192, 1962, -612, -205, 6],
    [41, -1173, 1903, -551, -226, 7],
    [41, -1151, 1838, -485, -251, 8],
    [42, -1126, 1770, -419, -275, 9],
    [41, -1100, 1700, -350, -300, 10],
    [40, -1073, 1627, -280, -325, 11],
    [40, -1046, 1556, -209, -353, 12],
    [39, -1017, 1481, -133, -382, 13],
    [38, -987, 1402, -59, -409, 14],
    [38, -956, 1323, 19, -439, 15],
    [36, -923, 1240, 98, -469, 17],
    [35, -895, 1166, 176, -501, 18],
    [33, -860, 1082, 257, -532, 20],
    [33, -829, 1000, 339, -564, 21],
    [31, -796, 921, 418, -596, 22],
    [29, -760, 834, 501, -628, 24],
    [28, -728, 752, 584, -661, 25],
    [27, -695, 668, 668, -695, 27],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_agree_with_printed_rows() {
        // Rows 7 and 57 of `coef_scale`, rows 16 and 63 of `coef_usm`.
        let printed = [
            (scale(7), [0.0186, -0.0762, 0.9785, 0.1040, -0.0264, 0.0015]),
            (scale(57), [0.0015, -0.0264, 0.1040, 0.9785, -0.0762, 0.0186]),
            (unsharp(16), [0.0200, -0.5728, 0.9292, -0.2690, -0.1104, 0.0034]),
            (unsharp(63), [0.0, -0.0029, -0.5903, 1.1987, -0.6084, 0.0029]),
        ];
        for (own, printed) in printed.into_iter().flat_map(|(own, printed)| own.into_iter().zip(printed)) {
            assert!((own - printed).abs() < 6e-5, "{own}, not {printed}");
        }
        for phase in 0..PHASES {
            assert_eq!(scale(phase).iter().sum::<f32>(), 1.0, "{phase}");
            assert!(unsharp(phase).iter().sum::<f32>().abs() <= UNIT, "{phase}");
        }
    }
}
