//! Drawing order of blended fragments: correct from far to near, wrong if a fragment is blended over a nearer one.

use crate::chain::{Frame, Recipe, redraw};
use crate::image::{Image, Rgba8};
use crate::pipeline::LastStage;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::Observer;
use crate::pipeline::plan::DrawPlan;
use crate::pipeline::raster::RasterSample;
use crate::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use crate::pipeline::settings::{BlendingOrder, Settings};
use crate::scene::{Scene, Transparency};

/// Returns a copy of the recipe that blends fragments in exact depth order.
pub(super) fn sorted(recipe: &Recipe) -> Recipe {
    let mut sorted = *recipe;
    sorted.pipeline.blending.order = BlendingOrder::Exact;
    sorted
}

/// Whether a stored depth is nearer to the viewer than another.
pub(super) fn is_nearer(depth: f32, other: f32, settings: &Settings) -> bool {
    if settings.reversed() { depth > other } else { depth < other }
}

/// Tracker of the depth of the nearest blended fragment at each sample. Fragments must be added in drawing order.
pub(super) struct BlendedDepths<'a> {
    settings: &'a Settings,
    plans: &'a [DrawPlan],
    /// Depth of the nearest fragment blended at each sample, NaN if there is none; `None` if no material is blended.
    nearest: Option<Image<f32>>,
}

impl<'a> BlendedDepths<'a> {
    /// Creates a tracker for the samples of `frame`, without any fragments.
    pub(super) fn new(settings: &'a Settings, frame: &'a Frame) -> Self {
        let (width, height) = frame.drawn.color.size();
        let plans = &frame.plans;
        let blends = plans.iter().any(|plan| plan.transparency() == Transparency::Blended);
        Self { settings, plans, nearest: blends.then(|| Image::filled(width, height, f32::NAN)) }
    }

    /// Adds a written fragment. If it is blended over earlier blended fragments, returns its own depth and the depth of
    /// the nearest of these earlier fragments.
    pub(super) fn add(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) -> Option<[f32; 2]> {
        let nearest = self.nearest.as_mut()?;
        let plan = self.plans.get(triangle.instance as usize)?;
        if plan.transparency() != Transparency::Blended {
            return None;
        }
        let (depth, before) = (depth_at(triangle, sample), nearest.at(sample.column, sample.row));
        if before.is_nan() || is_nearer(depth, before, self.settings) {
            nearest.set(sample.column, sample.row, depth);
        }
        (!before.is_nan()).then_some([depth, before])
    }

    /// Whether a pair of depths returned by [`BlendedDepths::add`] is in the wrong order.
    pub(super) fn is_wrong(&self, [depth, nearest]: [f32; 2]) -> bool {
        is_nearer(nearest, depth, self.settings)
    }
}

/// Effect of a wrong blending order on the colour of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Misordered {
    /// Blending in exact depth order would give a different colour, so the error is visible.
    Visible,
    /// Blending in exact depth order would give the same colour, so the error is invisible.
    Harmless,
}

/// Returns the effect of a wrong blending order at the centre of each drawn pixel; `None` where the order is correct.
pub(super) fn misordered(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Image<Option<Misordered>> {
    let (width, height) = frame.drawn.color.size();
    let mut watch = BlendOrderObserver {
        depths: BlendedDepths::new(&recipe.pipeline, frame),
        wrong: Image::filled(width, height, false),
    };
    if watch.depths.nearest.is_none() {
        return Image::filled(width, height, None);
    }
    let drawn = redraw(scene, recipe, frame, LastStage::Shade, &mut watch);
    let exact = redraw(scene, &sorted(recipe), frame, LastStage::Shade, &mut ());
    Image::from_fn(width, height, |x, y| {
        let differs = drawn.color.at(x, y) != exact.color.at(x, y);
        watch.wrong.at(x, y).then_some(if differs { Misordered::Visible } else { Misordered::Harmless })
    })
}

struct BlendOrderObserver<'a> {
    depths: BlendedDepths<'a>,
    wrong: Image<bool>,
}

impl Observer for BlendOrderObserver<'_> {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let Some(pair) = self.depths.add(triangle, &fragment.sample) else { return };
        if self.depths.is_wrong(pair) {
            self.wrong.set(fragment.sample.column, fragment.sample.row, true);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, OnceLock};

    use glam::{Mat4, Vec3};

    use super::*;
    use crate::chain::run;
    use crate::inspect::inspect;
    use crate::inspect::overlays::{Overlay, OverlayContext};
    use crate::inspect::scrub::{TouchPrecision, TouchedDrawing};
    use crate::inspect::view::Value;
    use crate::pipeline::settings::{Choice as _, Shading};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::{Camera, Instance, Library, Material, Mesh, MeshData};

    const SIZE: Viewport = Viewport { width: 60, height: 40 };

    /// Builds a scene with a large blue glass floor and a small red pane in front of one of its corners.
    fn glass() -> Scene {
        let mut library = Library::default();
        let quad = |corners: [[f32; 3]; 4]| {
            let positions = corners.map(Vec3::from).to_vec();
            let triangles = vec![[0, 1, 2], [0, 2, 3]];
            Mesh::new(MeshData { name: "quad".into(), positions, triangles, ..MeshData::default() }).unwrap()
        };
        let floor = quad([[-10.0, 0.0, 10.0], [10.0, 0.0, 10.0], [10.0, 0.0, -10.0], [-10.0, 0.0, -10.0]]);
        let pane = quad([[3.0, 0.3, -3.0], [5.0, 0.3, -3.0], [5.0, 3.0, -3.0], [3.0, 3.0, -3.0]]);
        let mut place = |name: &str, mesh, color| {
            let material = Material { opacity: 0.5, ..Material::plain(name, color) };
            let (mesh, material) = (library.add_mesh(mesh), library.add_material(material));
            Instance { name: name.into(), mesh, material, world_from_model: Mat4::IDENTITY, tint: Vec3::ONE }
        };
        let instances = vec![place("floor", floor, Vec3::Z), place("pane", pane, Vec3::X)];
        let home = Camera::look_at(Vec3::new(0.0, 5.0, 10.0), Vec3::Y);
        Scene {
            name: "glass".into(),
            library,
            instances,
            background: [40; 3],
            home,
            views: Vec::new(),
            light: None,
            animation: None,
        }
    }

    fn recipe(order: BlendingOrder) -> Recipe {
        let mut recipe = Recipe::default();
        (recipe.pipeline.shading, recipe.pipeline.blending.order) = (Shading::Texture, order);
        recipe
    }

    #[test]
    fn wrong_pixels_are_marked_and_their_verdicts_name_the_right_colour() {
        let scene = glass();
        let frame = |order| run(&scene, &scene.home, &recipe(order), SIZE, &mut ());
        let exact = frame(BlendingOrder::Exact);
        let mut wrong = 0;
        for order in BlendingOrder::ALL {
            let (recipe, frame) = (recipe(*order), frame(*order));
            let sheet = Overlay::BlendOrder.sheet(&OverlayContext {
                scene: &scene,
                recipe: &recipe,
                frame: &frame,
                is_whole: true,
                stats_cache: &OnceLock::new(),
                seams: None,
                shown: &|_, _| Value::Nothing,
                range: None,
            });
            for (x, y) in (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y))) {
                let right = exact.image().at(x, y);
                let differs = frame.image().at(x, y) != right;
                assert_eq!(sheet.values.at(x, y) == 0.0, differs, "{order:?} {x}, {y}");
                let verdict = inspect(&scene, &recipe, &frame, x, y).unwrap().verdict;
                let reported =
                    format!("the colour is ({}, {}, {}). Set blending.order to exact.", right[0], right[1], right[2]);
                assert_eq!(verdict.contains(&reported), differs, "{verdict}");
                assert_eq!(verdict.contains("wrong order"), differs, "{verdict}");
                wrong += usize::from(differs);
            }
        }
        assert!(wrong > 0);
    }

    #[test]
    fn reports_list_fragments_in_blending_order_and_touches_in_drawing_order() {
        let scene = glass();
        for order in BlendingOrder::ALL {
            let recipe = recipe(*order);
            let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
            for (x, y) in (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y))) {
                let report = inspect(&scene, &recipe, &frame, x, y).unwrap();
                let depths: Vec<_> = report.fragments.iter().map(|fragment| fragment.depth.value).collect();
                assert!(*order != BlendingOrder::Exact || depths.is_sorted_by(|a, b| a >= b), "{depths:?}");
                let mut colors = report.fragments.iter().filter_map(|fragment| fragment.shading.as_ref());
                assert_eq!(
                    colors.next_back().map(|shading| shading.color),
                    report.visible().map(|_| frame.image().at(x, y))
                );
                let drawing = TouchedDrawing::of_frame(&scene, &recipe, &frame);
                let touches = drawing.touches((x, y), TouchPrecision::Fragments);
                assert_eq!(touches.len(), depths.len());
                assert!(touches.is_sorted_by_key(|touch| touch.moment.key()));
            }
        }
    }

    #[test]
    fn a_scene_without_blended_materials_has_no_wrong_pixel() {
        let scene = Arc::new(crate::scene::builtin::by_id("cubes").unwrap().build());
        let recipe = Recipe::default();
        let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
        assert!(misordered(&scene, &recipe, &frame).pixels().iter().all(Option::is_none));
    }
}
