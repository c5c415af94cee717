use glam::DVec2;

use super::*;
use crate::image::{Image, Rgba8};
use crate::pipeline::sample::Sampler;
use crate::pipeline::settings::{AddressMode, ColorSpace};
use crate::scene::Texture;

/// Returns the level of detail: the mean of the two levels, by their weights.
fn level_of_detail(bias: f32, texels_per_px: f32) -> f32 {
    let gradient = [Vec2::new(texels_per_px / 64.0, 0.0), Vec2::new(0.0, 0.25 * texels_per_px / 64.0)];
    let reads = MipFilter { bias, max_probes: 1 }.reads((64, 64), 6, gradient);
    let [(fine, share), (coarse, rest)] = reads.levels;
    assert_eq!(share + rest, 1.0);
    fine as f32 * share + coarse as f32 * rest
}

#[test]
fn level_of_detail_is_the_logarithm_of_the_footprint_plus_the_bias_within_the_existing_levels() {
    for bias in [-4.0, -1.5, -1.0, 0.0, 0.25, 4.0] {
        for texels_per_px in [1e-30, 0.01, 0.5, 1.0, 1.3, 2.0, 7.0, 64.0, 1e30] {
            let expected = (f64::from(texels_per_px).log2() + f64::from(bias)).clamp(0.0, 6.0);
            let found = f64::from(level_of_detail(bias, texels_per_px));
            assert!((found - expected).abs() < 1e-5, "{bias} {texels_per_px}: {found} {expected}");
        }
    }
}

#[test]
fn every_gradient_gives_existing_levels_with_finite_weights() {
    let lengths =
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 1e18, 1e10, f32::MIN_POSITIVE, 1e-40, -0.0, 1.0];
    for (a, b) in lengths.into_iter().flat_map(|a| lengths.map(|b| (a, b))) {
        for (bias, max_probes) in [(-4.0, 1), (0.0, 16), (4.0, 16)] {
            let gradient = [Vec2::new(a, b), Vec2::new(b, a)];
            let reads = MipFilter { bias, max_probes }.reads((64, 64), 6, gradient);
            let (levels, count) = (reads.levels, reads.probes);
            assert!(levels.iter().all(|(level, share)| *level <= 6 && (0.0..=1.0).contains(share)), "{levels:?}");
            assert!((1..=max_probes).contains(&count), "{a} {b}: {count}");
        }
    }
}

/// Returns random gradients of footprints of all shapes, in texels per pixel.
fn gradients() -> impl Iterator<Item = [Vec2; 2]> {
    let mut random = fastrand::Rng::with_seed(8);
    std::iter::repeat_with(move || {
        let mut turn = || Vec2::from_angle(random.f32() * std::f32::consts::TAU);
        let (inner, outer) = (turn(), turn());
        let [long, short] = [0.0, 0.0].map(|_: f32| 2.0_f32.powf(random.f32() * 8.0 - 2.0));
        let image = |unit: Vec2| outer.rotate(inner.rotate(unit) * Vec2::new(long, short));
        [image(Vec2::X), image(Vec2::Y)]
    })
    .take(2000)
}

#[test]
fn probes_lie_along_the_major_axis_of_the_ellipse_and_share_its_length() {
    let size = (64, 32);
    let texels = Vec2::new(64.0, 32.0);
    let mut anisotropic = 0;
    for gradient in gradients() {
        let [right, down] = gradient.map(glam::Vec2::as_dvec2);
        // The longest of many radii of the ellipse, in f64.
        let radius = |step: u32| {
            let angle = DVec2::from_angle(std::f64::consts::PI * f64::from(step) / 4096.0);
            right * angle.x + down * angle.y
        };
        let radii = || (0..4096).map(radius);
        let major = radii().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap();
        let minor = radii().map(DVec2::length).fold(f64::INFINITY, f64::min);
        let filter = MipFilter { bias: 0.0, max_probes: 16 };
        let reads = filter.reads(size, 6, gradient.map(|g| g / texels));
        let ratio = major.length() / minor;
        let wanted = ratio.ceil().min(major.length().ceil()).min(16.0);
        let found = f64::from(reads.probes);
        assert!(
            found == wanted || (found - wanted).abs() == 1.0 && (ratio - ratio.round()).abs() < 0.05,
            "{ratio} {found}"
        );
        if reads.probes == 1 {
            assert_eq!(reads, MipFilter { max_probes: 1, ..filter }.reads(size, 6, gradient.map(|g| g / texels)));
            continue;
        }
        anisotropic += 1;
        let axis = (reads.major_axis * texels).as_dvec2();
        let apart = (axis - major).length().min((axis + major).length());
        assert!(apart < 0.01 * major.length() || ratio < 1.05, "{axis} {major}");
        let [(fine, share), (coarse, rest)] = reads.levels;
        let level = f64::from(fine as f32 * share + coarse as f32 * rest);
        assert!((level - (major.length() / found).log2().clamp(0.0, 6.0)).abs() < 1e-3, "{level} {major} {found}");
        let offsets: f32 = (0..reads.probes).map(|probe| reads.offset(probe)).sum();
        assert!(offsets.abs() < 1e-5 && reads.offset(0) < 0.0, "centred");
    }
    assert!(anisotropic > 1000, "{anisotropic}");
}

#[test]
fn round_footprints_are_read_like_trilinear_ones() {
    for turn in 0..360_u16 {
        let (right, size) = (Vec2::from_angle(f32::from(turn).to_radians()) * 3.7, Vec2::new(64.0, 32.0));
        for gradient in [[right, right.perp()], [right, -right.perp()]].map(|g| g.map(|g| g / size)) {
            let [isotropic, anisotropic] =
                [1, 16].map(|max_probes| MipFilter { bias: 0.0, max_probes }.reads((64, 32), 6, gradient));
            assert_eq!(isotropic, anisotropic, "{turn}°");
        }
    }
}

/// Returns the mean squared error of a filter on a slanted checkerboard, against the mean of the texture over the
/// parallelogram of each pixel. Every pixel has the footprint of `gradient`, in texels per pixel.
fn squared_error(texture: &Texture, gradient: [Vec2; 2], max_probes: u32) -> f64 {
    const STEPS: u32 = 48;
    let size = texture.image().size();
    let texels = Vec2::new(size.0 as f32, size.1 as f32);
    let sampler = Sampler::new(TexelFilter::Anisotropic, AddressMode::Repeat, ColorSpace::Bytes);
    let point = Sampler::new(TexelFilter::Point, AddressMode::Repeat, ColorSpace::Bytes);
    let copies = texture.mip_levels(false);
    let reads = MipFilter { bias: 0.0, max_probes }.reads(size, copies.len(), gradient.map(|g| g / texels));
    let level = |level: usize| level.checked_sub(1).map_or(texture.image(), |copy| &copies[copy]);
    let mut random = fastrand::Rng::with_seed(5);
    let mut sum = 0.0;
    for _ in 0..100 {
        let uv = Vec2::new(random.f32(), random.f32());
        let at = |step: u32| (step as f32 + 0.5) / STEPS as f32 - 0.5;
        let offsets = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| gradient[0] * at(i) + gradient[1] * at(j)));
        let exact: f32 = offsets.map(|offset| point.sample(texture.image(), uv + offset / texels).x).sum();
        let reading = |read: TextureRead| sampler.sample(level(read.level), read.uv).x * read.share;
        let found = reads.all(uv).map(reading).sum::<f32>() / reads.probes as f32;
        sum += f64::from(found - exact / (STEPS * STEPS) as f32).powi(2);
    }
    sum / 100.0
}

#[test]
fn more_probes_come_nearer_to_the_mean_over_the_footprint_of_a_slanted_plane() {
    let board = |x: u32, y: u32| -> Rgba8 { [if (x / 16 + y / 16).is_multiple_of(2) { 230 } else { 30 }; 4] };
    let texture = Texture::new(Image::from_fn(128, 128, board)).expect("it has texels");
    for angle in [0.0, 30.0_f32, 45.0] {
        let turn = Vec2::from_angle(angle.to_radians());
        // 1.5 texels across, and 24 into the distance.
        let gradient = [turn * 1.5, turn.perp() * 24.0];
        let errors = [1, 2, 4, 8, 16].map(|probes| squared_error(&texture, gradient, probes).sqrt());
        assert!(errors.is_sorted_by(|more, less| more > less), "{angle}: {errors:?}");
        assert!(errors[4] < 0.25 * errors[0], "{angle}: {errors:?}");
    }
    // The gradients of a plane that recedes along a diagonal of the screen are equally long, so the approximation of the
    // specification would take a single probe. The footprint is a rhombus, on which the filter weights the ends too much.
    let (axis, across) = (Vec2::new(24.0, 0.0), Vec2::new(0.0, 1.5));
    let diagonal = [axis + across, axis - across].map(|g| g * std::f32::consts::FRAC_1_SQRT_2);
    let [trilinear, anisotropic] = [1, 16].map(|probes| squared_error(&texture, diagonal, probes).sqrt());
    assert!(anisotropic < 0.6 * trilinear, "diagonal: {anisotropic} {trilinear}");
}
