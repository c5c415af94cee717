use super::*;
use crate::chain::run;
use crate::pipeline::viewport::Viewport;
use crate::scene::builtin;

const VIEW: Viewport = Viewport { width: 96, height: 64 };

/// A view of a scene whose pixels are explained.
struct Subject {
    scene: Arc<Scene>,
    camera: Camera,
    recipe: Recipe,
}

impl Subject {
    fn new(scene: &str, set: &[&str]) -> Self {
        let scene = Arc::new(builtin::by_id(scene).unwrap().build());
        let mut recipe = Recipe::default();
        recipe.set_all(set).unwrap();
        Self { camera: scene.home, scene, recipe }
    }

    fn frame(&self) -> Frame {
        run(&self.scene, &self.camera, &self.recipe, VIEW, &mut ())
    }

    fn report(&self, frame: &Frame, pixel: (u32, u32)) -> PixelReport {
        let survey = Survey::of(&self.scene, &self.recipe, frame);
        explain(&self.scene, &self.recipe, frame, &survey, pixel).unwrap()
    }

    /// Returns the first pixel whose report fulfils `wanted`, with its remedies.
    fn find(&self, wanted: impl Fn(&PixelReport) -> bool) -> (PixelReport, Vec<Remedy>) {
        let frame = self.frame();
        let survey = Survey::of(&self.scene, &self.recipe, &frame);
        let pixels = (0..VIEW.height).flat_map(|y| (0..VIEW.width).map(move |x| (x, y)));
        let mut reports = pixels.filter_map(|pixel| explain(&self.scene, &self.recipe, &frame, &survey, pixel));
        let report = reports.find(wanted).expect("such a pixel exists");
        let remedies = remedies(&self.scene, &self.recipe, &frame, &report);
        (report, remedies)
    }

    /// Applies a remedy and returns the new verdict of the pixel.
    fn after(mut self, remedy: Remedy, report: &PixelReport) -> String {
        remedy.apply(&mut self.recipe, &mut self.camera);
        self.report(&self.frame(), (report.x, report.y)).verdict
    }
}

#[test]
fn reversed_depth_resolves_the_z_fight_of_separate_surfaces_only() {
    let subject = Subject::new("z-fighting", &["depth_format=unorm16"]);
    let contested = |report: &PixelReport| report.verdict.contains("Depth tie") || report.verdict.contains("Z-fight");
    let frame = subject.frame();
    let survey = Survey::of(&subject.scene, &subject.recipe, &frame);
    let (mut cured, mut uncured) = (0, 0);
    for pixel in (0..VIEW.height).step_by(4).flat_map(|y| (0..VIEW.width).step_by(4).map(move |x| (x, y))) {
        let report = explain(&subject.scene, &subject.recipe, &frame, &survey, pixel).unwrap();
        if !contested(&report) {
            continue;
        }
        let is_offered = remedies(&subject.scene, &subject.recipe, &frame, &report) == [Remedy::ReversedDepth];
        let subject = Subject::new("z-fighting", &["depth_format=unorm16"]);
        let verdict = subject.after(Remedy::ReversedDepth, &report);
        let is_cured = !verdict.contains("Depth tie") && !verdict.contains("Z-fight");
        assert_eq!(is_offered, is_cured, "{pixel:?}: {verdict}");
        cured += u32::from(is_cured);
        uncured += u32::from(!is_cured);
    }
    assert!(cured > 0, "{cured} cured, {uncured} not");
}

#[test]
fn culling_is_offered_to_be_turned_off_where_the_culled_triangle_would_be_visible() {
    let set = ["culling=front"];
    let subject = Subject::new("triangle", &set);
    let culled = |report: &PixelReport| report.absent.iter().any(|absent| absent.cause == Cause::FrontFacing);
    let (report, remedies) = subject.find(culled);
    assert_eq!(remedies, [Remedy::NoCulling]);
    assert!(report.verdict.starts_with("Background"));
    assert!(subject.after(Remedy::NoCulling, &report).contains("Won by "));

    // The back of a closed cube is hidden whether or not it is culled.
    let hidden = |report: &PixelReport| {
        report.visible().is_some() && report.absent.iter().any(|absent| absent.cause == Cause::BackFacing)
    };
    assert_eq!(Subject::new("cubes", &[]).find(hidden).1, []);
}

#[test]
fn the_near_plane_is_moved_no_further_than_necessary() {
    let mut subject = Subject::new("triangle", &[]);
    subject.camera.near = subject.camera.distance() * 1.5;
    let near = subject.camera.near;
    let (report, remedies) = subject.find(|report| report.absent.iter().any(|a| a.cause == Cause::NearPlane));
    assert_eq!(remedies, [Remedy::NearPlane(near / 10.0)]);
    assert!(!report.verdict.contains("Won by "), "{}", report.verdict);
    assert!(subject.after(remedies[0], &report).contains("Won by "));
}

#[test]
fn the_far_plane_is_moved_behind_the_triangle() {
    let mut subject = Subject::new("triangle", &[]);
    subject.camera.far = subject.camera.distance() * 0.5;
    let far = subject.camera.far;
    let (report, remedies) = subject.find(|report| report.absent.iter().any(|a| a.cause == Cause::FarPlane));
    assert_eq!(remedies, [Remedy::FarPlane(far * 10.0)]);
    assert!(subject.after(remedies[0], &report).contains("Won by "));
}

#[test]
fn faults_along_shared_edges_have_the_remedy_of_their_cause() {
    for (set, remedy) in [
        ("fill_rule=inclusive", Remedy::TopLeftRule),
        ("fill_rule=exclusive", Remedy::TopLeftRule),
        ("rasterizer=scanline-published", Remedy::CorrectRasterizer),
    ] {
        let subject = Subject::new("shared-edges", &[set]);
        let (report, remedies) = subject.find(|report| report.fault.is_some());
        assert_eq!(remedies, [remedy], "{set}");
        let verdict = subject.after(remedy, &report);
        assert!(!verdict.contains("To fix it"), "{verdict}");
    }
}

#[test]
fn a_wrong_blending_order_is_resolved_by_the_exact_one() {
    let subject = Subject::new("stained-glass", &["blending.order=objects"]);
    let (report, remedies) = subject.find(|report| report.verdict.contains("Blended in the wrong order"));
    assert_eq!(remedies, [Remedy::ExactBlending]);
    assert!(!subject.after(remedies[0], &report).contains("wrong order"));
}

#[test]
fn a_pixel_without_complaint_has_no_remedy() {
    let subject = Subject::new("interpenetrating", &[]);
    let (report, remedies) = subject.find(|report| report.verdict.contains("Won by "));
    assert_eq!(remedies, [], "{}", report.verdict);
}

#[test]
fn every_change_of_a_setting_is_what_the_recipe_understands() {
    for remedy in [
        Remedy::ReversedDepth,
        Remedy::NoCulling,
        Remedy::CorrectRasterizer,
        Remedy::FixedPoint,
        Remedy::TopLeftRule,
        Remedy::ExactBlending,
    ] {
        let mut by_name = Recipe::default();
        by_name.set_all(&["culling=front", "fill_rule=inclusive", "arithmetic=f32"]).unwrap();
        let mut applied = by_name;
        by_name.set(&remedy.change()).unwrap();
        remedy.apply(&mut applied, &mut Camera::look_at(glam::Vec3::Z, glam::Vec3::ZERO));
        assert_eq!(applied, by_name, "{}", remedy.label());
    }
}
