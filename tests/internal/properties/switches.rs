//! Effects of single settings, and properties that they must not change.

use glam::{Mat4, Vec3};
use rasterscope::chain::{Frame, Recipe};
use rasterscope::image::{Image, Rgba8};
use rasterscope::inspect::capture;
use rasterscope::pipeline::framebuffer::Framebuffer;
use rasterscope::pipeline::grid::SampleGrid;
use rasterscope::pipeline::interpolate::{AttributeSelection, Fragment, interpolate};
use rasterscope::pipeline::observe::{DepthOutcome, Observer};
use rasterscope::pipeline::plan::PipelinePart;
use rasterscope::pipeline::raster::{RasterSample, Scissor};
use rasterscope::pipeline::screen_triangle::ScreenTriangle;
use rasterscope::pipeline::screen_vertex::relative_inv_w;
use rasterscope::pipeline::settings::{Choice, DepthFormat, DepthTest, DisabledOptimisation, Interpolation, Shading};
use rasterscope::pipeline::shade::Shader;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::pipeline::{DrawCall, Extent, LastStage};
use rasterscope::scene::{Material, Scene, Transparency, TriangleId};

use crate::internal::common::{
    SceneBuilder, coplanar_scene, cube, for_seeds, ground_and_cube, in_cube, recipe, render, scenes, soup,
};

const SIZE: (u32, u32) = (64, 48);
const VIEW: Viewport = Viewport { width: SIZE.0, height: SIZE.1 };

fn picture(scene: &Scene, assignments: &[&str]) -> Image<Rgba8> {
    render(scene, &recipe(assignments), SIZE).image().clone()
}

/// Draws the geometry of a frame again, on another sample grid.
fn redraw(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    grid: SampleGrid,
    observer: &mut impl Observer,
) -> Framebuffer {
    let mut drawn = Framebuffer::new(grid, SIZE.0, SIZE.1, scene.background, &recipe.pipeline);
    let extent = Extent::all(frame.geometry(), VIEW);
    DrawCall::new(scene, frame.geometry(), &recipe.pipeline, &extent).draw(&mut drawn, observer);
    drawn
}

#[test]
fn back_and_front_faces_together_are_all_triangles_and_share_none() {
    for (name, scene) in scenes() {
        let ids = |culling: &str| -> Vec<_> {
            render(&scene, &recipe(&[culling]), SIZE).geometry().triangles.iter().map(|t| (t.id, t.vertices)).collect()
        };
        let (all, front, back) = (ids("culling=none"), ids("culling=back"), ids("culling=front"));
        assert!(!front.is_empty() && !back.is_empty(), "{name}");
        assert_eq!(front.len() + back.len(), all.len(), "{name}");
        assert!(all.iter().all(|t| front.contains(t) != back.contains(t)), "{name}");
    }
}

#[test]
fn back_faces_of_a_closed_body_are_never_seen() {
    for_seeds(20, |rng| {
        let scene = SceneBuilder::new(in_cube(rng).normalize() * 5.0).with(cube(), Mat4::IDENTITY, None).0;
        let least = |culling| picture(&scene, &[culling, "shading=normals"]);
        assert_eq!(least("culling=none"), least("culling=back"));
    });
}

#[test]
fn mirrored_winding_swaps_front_and_back() {
    let scene = ground_and_cube();
    let mut mirrored = scene.clone();
    for instance in &mut mirrored.instances {
        instance.world_from_model = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)) * instance.world_from_model;
    }
    mirrored.home.eye.x *= -1.0;
    let ids = |scene: &Scene, culling: &str| -> Vec<TriangleId> {
        render(scene, &recipe(&[culling]), SIZE).geometry().triangles.iter().map(|t| t.id).collect()
    };
    assert_eq!(ids(&scene, "culling=back"), ids(&mirrored, "culling=front"));
}

/// Returns a scene of randomly rotated cubes behind each other, with space between them.
fn separated(rng: &mut fastrand::Rng) -> Scene {
    let mut builder = SceneBuilder::new(Vec3::new(0.4, 0.7, 9.0));
    for i in 0..6 {
        let turn = Mat4::from_axis_angle(in_cube(rng).normalize(), rng.f32() * 6.0);
        let place = Mat4::from_translation(Vec3::new(i as f32 - 2.5, 0.3 * i as f32 - 1.0, 2.5 - 2.0 * i as f32));
        builder = builder.with(cube(), place * turn * Mat4::from_scale(Vec3::splat(0.55)), None);
    }
    builder.0.home.near = 2.0;
    builder.0.home.far = 40.0;
    builder.0
}

#[test]
fn every_depth_format_gives_the_same_picture_of_well_separated_surfaces() {
    for_seeds(20, |rng| {
        let scene = separated(rng);
        for test in ["depth-test=less", "depth-test=less-equal", "depth-test=always", "depth-test=off"] {
            let by = |format: DepthFormat| {
                picture(&scene, &[test, &format!("depth-format={}", format.id()), "culling=back"])
            };
            let first = by(DepthFormat::F32);
            for format in DepthFormat::ALL {
                assert_eq!(by(*format), first, "{test} {format:?}");
            }
        }
    });
}

#[test]
fn the_order_of_triangles_does_not_matter_without_ties() {
    for_seeds(20, |rng| {
        let scene = SceneBuilder::new(in_cube(rng) + Vec3::Z * 3.0).with(soup(rng, 30), Mat4::IDENTITY, None).0;
        let recipe = recipe(&["culling=none", "shading=triangle-id"]);
        let mut frame = render(&scene, &recipe, SIZE);
        let ties = Ties::of(&scene, &recipe, &frame);
        rng.shuffle(&mut frame.geometry_mut().triangles);
        let shuffled = redraw(&scene, &recipe, &frame, SampleGrid::FULL, &mut ());
        assert_eq!(shuffled.depth, frame.drawn.depth);
        for (i, (a, b)) in frame.drawn.color.pixels().iter().zip(shuffled.color.pixels()).enumerate() {
            assert!(a == b || ties.0.pixels()[i], "sample {i}: {a:?} became {b:?}");
        }
        assert!(ties.0.pixels().iter().filter(|t| **t).count() < 10);
    });
}

/// Observer that marks the samples at which two fragments have exactly the same depth.
struct Ties(Image<bool>);

impl Ties {
    fn of(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        let mut ties = Self(Image::filled(SIZE.0, SIZE.1, false));
        redraw(scene, recipe, frame, SampleGrid::FULL, &mut ties);
        ties
    }
}

impl Observer for Ties {
    fn depth_tested(&mut self, _triangle: &ScreenTriangle, sample: &RasterSample, outcome: DepthOutcome) {
        if outcome.new == outcome.stored {
            self.0.set(sample.column, sample.row, true);
        }
    }
}

#[test]
fn less_and_less_equal_differ_at_ties_and_only_there() {
    let mut differing = 0;
    for (name, scene) in scenes() {
        let [less, less_equal] = ["less", "less-equal"]
            .map(|t| recipe(&["culling=none", "shading=triangle-id", &format!("depth-test={t}")]));
        let frame = render(&scene, &less, SIZE);
        let ties = Ties::of(&scene, &less, &frame);
        let other = render(&scene, &less_equal, SIZE);
        assert_eq!(frame.drawn.depth, other.drawn.depth, "{name}");
        for (i, (a, b)) in frame.image().pixels().iter().zip(other.image().pixels()).enumerate() {
            assert!(a == b || ties.0.pixels()[i], "{name}: sample {i} differs without a tie");
            differing += usize::from(a != b);
        }
    }
    assert!(differing > 100, "{differing}: the coplanar scene must tie");
}

#[test]
fn the_samples_of_every_grid_equal_the_full_picture() {
    for (name, scene) in scenes() {
        for shading in Shading::ALL {
            let mut recipe = recipe(&["culling=none"]);
            recipe.pipeline.shading = *shading;
            let native = render(&scene, &recipe, SIZE);
            for grid in [
                SampleGrid::Block { step: 2 },
                SampleGrid::Block { step: 4 },
                SampleGrid::Block { step: 7 },
                SampleGrid::Checkerboard,
                SampleGrid::OddCheckerboard,
            ] {
                let drawn = redraw(&scene, &recipe, &native, grid, &mut ());
                let (mut samples, depths) = (0, native.drawn.depth.as_ref().zip(drawn.depth.as_ref()));
                for y in 0..SIZE.1 {
                    for x in 0..SIZE.0 {
                        let Some((column, row)) = grid.sample_at(x, y) else { continue };
                        assert_eq!(drawn.color.at(column, row), native.image().at(x, y), "{name} {grid:?} {x},{y}");
                        assert!(depths.is_some_and(|(full, packed)| full.at(x, y) == packed.at(column, row)));
                        samples += 1;
                    }
                }
                assert_eq!(samples, grid.drawn_pixels(SIZE.0, SIZE.1));
            }
        }
    }
}

#[test]
fn a_background_colours_only_pixels_that_no_triangle_covers() {
    const COLOR: [u8; 4] = [0xd0, 0x40, 0x10, 255];
    let (mut empty, mut covered) = (0, 0);
    for (name, scene) in scenes() {
        for upscaler in [["native", "1"], ["checkerboard", "1"], ["nearest", "2"]] {
            let [method, scale] = upscaler;
            let more = [format!("upscaler.method={method}"), format!("upscaler.scale={scale}")];
            let mut plain = recipe(&["shading=triangle-id"]);
            plain.set_all(&more).expect("an upscaler at a scale that it offers");
            let frame = render(&scene, &plain, SIZE);
            let owners = capture(&scene, &plain, &frame).triangle;
            let mut colored = plain;
            colored.set("background=#d04010").expect("a colour");
            let colored = render(&scene, &colored, SIZE);
            let [r, g, b] = scene.background;
            for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
                let Some((column, row)) = frame.sample_at(x, y) else { continue };
                let (before, after) = (frame.image().at(x, y), colored.image().at(x, y));
                if owners.at(column, row) == TriangleId::NONE {
                    assert_eq!((before, after), ([r, g, b, 255], COLOR), "{name} {method} {x}, {y}");
                    empty += 1;
                } else {
                    assert_eq!(before, after, "{name} {method} {x}, {y}");
                    covered += 1;
                }
            }
        }
    }
    assert!(empty > 1000 && covered > 1000, "{empty} pixels of background, {covered} covered");
}

#[test]
fn a_scissor_draws_its_part_of_the_picture_and_nothing_else() {
    let scene = ground_and_cube();
    let recipe = Recipe::default();
    let full = render(&scene, &recipe, SIZE);
    for_seeds(30, |rng| {
        let (left, top) = (rng.u32(0..SIZE.0), rng.u32(0..SIZE.1));
        let scissor = Scissor { left, top, right: rng.u32(left..=SIZE.0), bottom: rng.u32(top..=SIZE.1) };
        let mut part = Framebuffer::new(SampleGrid::FULL, SIZE.0, SIZE.1, scene.background, &recipe.pipeline);
        let extent = Extent { scissor, ..Extent::all(full.geometry(), VIEW) };
        DrawCall::new(&scene, full.geometry(), &recipe.pipeline, &extent).draw(&mut part, &mut ());
        let [r, g, b] = scene.background;
        let expected = Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            let inside = (scissor.left..scissor.right).contains(&x) && (scissor.top..scissor.bottom).contains(&y);
            if inside { full.image().at(x, y) } else { [r, g, b, 255] }
        });
        assert_eq!(part.color, expected, "{scissor:?}");
    });
}

#[test]
fn without_a_depth_buffer_the_picture_is_that_of_a_test_that_always_passes() {
    for (name, scene) in scenes() {
        assert_eq!(picture(&scene, &["depth-test=off"]), picture(&scene, &["depth-test=always"]), "{name}");
    }
}

#[test]
fn skipping_the_perspective_division_of_an_orthographic_view_changes_no_bit() {
    let mut scenes = scenes();
    for (name, scene) in &mut scenes {
        scene.home = scene.home.with_orthographic(true);
        let recipe = recipe(&["culling=none"]);
        let mut frame = render(scene, &recipe, SIZE);
        assert!(frame.plans.iter().all(|p| !p.runs(PipelinePart::PerspectiveDivision)), "{name}");
        for triangle in &mut frame.geometry_mut().triangles {
            triangle.relative_inv_w = relative_inv_w(&triangle.vertices);
        }
        assert_eq!(redraw(scene, &recipe, &frame, SampleGrid::FULL, &mut ()).color, *frame.image(), "{name}");
    }
}

#[test]
fn skipping_the_interpolation_of_attributes_changes_no_bit() {
    struct Compare<'a>(Vec<Shader<'a>>);
    impl Observer for Compare<'_> {
        fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, color: Rgba8) {
            let all = interpolate(triangle, fragment.sample, AttributeSelection::all(Interpolation::Perspective));
            let shader = &self.0[triangle.instance as usize];
            if shader.transparency() != Transparency::Blended {
                assert_eq!(shader.shade(&all, triangle), color);
            }
            let weights = (fragment.source_weights, all.source_weights);
            assert_eq!(Fragment { source_weights: weights.0, ..all }, *fragment, "equal except for the weights");
        }
    }
    let mut skipped = [0; 5];
    for (_, scene) in &scenes() {
        for shading in Shading::ALL {
            let mut recipe = Recipe::default();
            recipe.pipeline.shading = *shading;
            let frame = render(scene, &recipe, SIZE);
            let shaders = scene.instances.iter().zip(frame.plans.iter());
            let shaders: Vec<_> =
                shaders.map(|(i, plan)| Shader::new(&recipe.pipeline, &scene.library, i, plan)).collect();
            for shader in &shaders {
                let AttributeSelection { normal, uv, color, light, source_weights, .. } = shader.attributes();
                for (count, read) in skipped.iter_mut().zip([normal, uv, color, light, source_weights]) {
                    *count += usize::from(!read);
                }
            }
            redraw(scene, &recipe, &frame, SampleGrid::FULL, &mut Compare(shaders));
        }
    }
    assert!(skipped.iter().all(|n| *n > 10), "each attribute is skipped by some draws: {skipped:?}");
}

#[test]
fn skipping_the_clipping_of_an_object_inside_the_view_changes_no_bit() {
    let mut compared = 0;
    for_seeds(60, |rng| {
        let mut scene = SceneBuilder::new(in_cube(rng).normalize() * (1.8 + 3.0 * rng.f32()))
            .with(soup(rng, 20), Mat4::IDENTITY, None)
            .0;
        let double_sided = rng.bool();
        scene.library = scene.library.with_materials(|material| Material { double_sided, ..material.clone() });
        let recipe = Recipe::default();
        let frame = render(&scene, &recipe, SIZE);
        if frame.plans[0].runs(PipelinePart::Clipping) {
            return;
        }
        compared += 1;
        let mut clipping = recipe;
        clipping.pipeline.force = DisabledOptimisation::Clipping;
        let clipped = render(&scene, &clipping, SIZE);
        assert!(clipped.plans[0].runs(PipelinePart::Clipping));
        assert_eq!(frame.geometry().triangles[..], clipped.geometry().triangles[..]);
        assert_eq!(frame.geometry().triangles_clipped, clipped.geometry().triangles_clipped);
    });
    assert!(compared > 10, "only {compared} objects were inside");
}

#[test]
fn skipping_an_object_outside_the_view_changes_no_bit() {
    let mut outside = 0;
    for_seeds(100, |rng| {
        let mut scene = SceneBuilder::new(in_cube(rng) * 3.0)
            .with(soup(rng, 20), Mat4::from_translation(in_cube(rng) * 6.0), None)
            .0;
        let frame = render(&scene, &Recipe::default(), SIZE);
        if frame.plans[0].runs(PipelinePart::Vertices) {
            return;
        }
        outside += 1;
        // A tiny triangle in front of the eye makes the bounding box cross the view, so that every triangle is
        // examined.
        let id = scene.instances[0].mesh;
        let mut data = (**scene.library.mesh(id)).clone();
        let stray =
            Mat4::inverse(&scene.instances[0].world_from_model).transform_point3(scene.home.eye + scene.home.forward());
        for corner in 0..3 {
            data.positions.push(stray + Vec3::AXES[corner] * 1e-20);
        }
        let count = data.positions.len();
        (data.normals, data.uvs, data.colors) = (Vec::new(), Vec::new(), Vec::new());
        data.triangles.push([0, 1, 2].map(|c| (count - 3 + c) as u32));
        scene.instances[0].mesh = scene.library.add_mesh(rasterscope::scene::Mesh::new(data).unwrap());
        let forced = render(&scene, &Recipe::default(), SIZE);
        assert!(forced.geometry().plans[0].runs(PipelinePart::Vertices));
        assert_eq!(forced.image(), frame.image());
    });
    assert!(outside > 10, "only {outside} objects were outside");
}

#[test]
fn affine_interpolation_differs_only_where_w_does() {
    let tilted = ground_and_cube();
    assert_ne!(picture(&tilted, &["interpolation=affine"]), picture(&tilted, &[]));
    let flat = coplanar_scene();
    assert_eq!(picture(&flat, &["interpolation=affine"]), picture(&flat, &[]));
}

#[test]
fn stopping_early_counts_the_same_samples() {
    #[derive(Default, PartialEq, Debug)]
    struct Covered(Vec<(TriangleId, RasterSample)>);
    impl Observer for Covered {
        fn covered(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) {
            self.0.push((triangle.id, *sample));
        }
        fn shaded(&mut self, _triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
            assert_eq!(self.0.last().map(|(_, s)| *s), Some(fragment.sample));
        }
    }
    let scene = ground_and_cube();
    let recipe = Recipe::default();
    let frame = render(&scene, &recipe, SIZE);
    let [coverage, depth, interpolate, all] =
        [LastStage::Coverage, LastStage::Depth, LastStage::Interpolate, LastStage::Shade].map(|until| {
            let mut buffer = Framebuffer::new(SampleGrid::FULL, SIZE.0, SIZE.1, scene.background, &recipe.pipeline);
            let mut covered = Covered::default();
            let extent = &Extent::all(frame.geometry(), VIEW);
            let whole = DrawCall::new(&scene, frame.geometry(), &recipe.pipeline, extent);
            DrawCall { until, ..whole }.draw(&mut buffer, &mut covered);
            (covered, buffer.depth)
        });
    assert_eq!(coverage.0, all.0);
    assert_eq!(depth, all);
    assert_eq!(interpolate, all);
}

#[test]
fn a_greater_depth_test_shows_the_farthest_surface() {
    let scene = ground_and_cube();
    for format in DepthFormat::ALL {
        let mut recipe = recipe(&["culling=none", "shading=triangle-id"]);
        (recipe.pipeline.depth_test, recipe.pipeline.depth_format) = (DepthTest::Greater, *format);
        let frame = render(&scene, &recipe, SIZE);
        let mut farthest = Farthest(Image::filled(SIZE.0, SIZE.1, None), recipe.pipeline.reversed());
        redraw(&scene, &recipe, &frame, SampleGrid::FULL, &mut farthest);
        let depths = frame.drawn.depth.unwrap();
        for (got, expected) in depths.pixels().iter().zip(farthest.0.pixels()) {
            assert!(expected.is_none_or(|e| e == *got), "{got} for {expected:?}");
        }
    }
}

/// Observer that records the depth of the farthest fragment of each sample; the flag is `true` if depth is reversed.
struct Farthest(Image<Option<f32>>, bool);

impl Observer for Farthest {
    fn depth_tested(&mut self, _triangle: &ScreenTriangle, sample: &RasterSample, outcome: DepthOutcome) {
        let before = self.0.at(sample.column, sample.row).unwrap_or(outcome.new);
        let farthest = if self.1 { before.min(outcome.new) } else { before.max(outcome.new) };
        self.0.set(sample.column, sample.row, Some(farthest));
    }
}
