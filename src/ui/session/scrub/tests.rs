use super::*;
use crate::antialias::settings::AntialiasMethod;
use crate::chain::Recipe;
use crate::inspect::inspect;
use crate::scene::SceneSource;
use crate::ui::engine::{Engine, RenderedView};
use crate::ui::session::PictureSize;
use crate::ui::session::command::Command;
use crate::upscale::Upscaling;

/// Session with an engine that renders its requests synchronously.
struct Desk {
    session: Session,
    engine: Engine,
}

impl Desk {
    fn new(scene: &str, recipe: Recipe) -> Self {
        let source = SceneSource::named(scene.into());
        let scene = source.load().unwrap().scene;
        let home = scene.home;
        let mut session = Session::new(Arc::new(scene), source, recipe, home);
        session.state.size = PictureSize::Fixed(48, 32);
        let mut desk = Self { session, engine: Engine::default() };
        desk.show();
        desk
    }

    fn show(&mut self) {
        let request = self.session.request();
        self.session.view = Some(self.engine.answer(request));
    }

    fn give(&mut self, change: ScrubChange) -> Moment {
        assert_eq!(self.session.apply(Command::Scrub(change)), None);
        self.show();
        self.session.moment()
    }

    fn view(&self) -> &RenderedView {
        self.session.view.as_ref().unwrap()
    }
}

#[test]
fn a_step_back_and_one_forward_restore_the_picture() {
    let mut desk = Desk::new("cubes", Recipe::default());
    let whole = desk.view().frame.image().clone();
    let all = desk.session.triangle_count();
    for unit in [Unit::Draw, Unit::Triangle, Unit::Fragment] {
        let before = desk.give(ScrubChange::Step(unit, false));
        assert!(before.key() < Moment::after(all).key(), "{unit:?}");
        assert_eq!(desk.view().request.moment(), Some(before));
        assert_eq!(desk.give(ScrubChange::Step(unit, true)), Moment::after(all), "{unit:?}");
        assert_eq!((desk.session.features.scrub.triangle_limit, desk.session.request().moment()), (None, None));
        assert_eq!(*desk.view().frame.image(), whole, "{unit:?}");
    }
    let by_object = desk.give(ScrubChange::Step(Unit::Draw, false));
    let last = desk.view().frame.geometry().triangles.last().unwrap().instance;
    assert_eq!(desk.session.timeline().unwrap().last.as_ref().map(|triangle| triangle.instance), Some(last));
    assert!(desk.session.timeline().unwrap().draws.iter().any(|(start, _)| *start == by_object.triangles));
}

#[test]
fn a_new_triangle_limit_clears_the_fragment_limit() {
    let mut desk = Desk::new("interpenetrating", Recipe::default());
    let partial = desk.give(ScrubChange::Go(Moment { triangles: 1, fragments: Some(3) }));
    assert_eq!(partial.fragments, Some(3));
    assert_eq!(
        desk.view().frame.geometry().partial.as_ref().map(|samples| crate::pipeline::partial::count(samples)),
        Some(3)
    );
    desk.session.apply(Command::LimitTriangles(Some(2)));
    desk.show();
    assert_eq!(desk.session.moment(), Moment::after(2));
    assert_eq!(desk.view().frame.geometry().partial, None);
    // Setting the triangle limit directly drops the fragment limit, too.
    desk.give(ScrubChange::Go(Moment { triangles: 1, fragments: Some(3) }));
    desk.session.features.scrub.triangle_limit = Some(2);
    assert_eq!(desk.session.moment(), Moment::after(2));
}

#[test]
fn each_step_at_the_picked_pixel_adds_one_fragment() {
    let mut desk = Desk::new("stained-glass", Recipe::default());
    desk.session.pick = Some((24, 16));
    desk.show();
    let all = desk.view().report.as_ref().unwrap().fragments.len();
    assert!(all > 1);
    desk.give(ScrubChange::Touching(Some(true)));
    for unit in [Unit::Triangle, Unit::Fragment] {
        desk.give(ScrubChange::Go(Moment::after(0)));
        assert_eq!(desk.view().timeline.as_ref().unwrap().touches.len(), all, "the ticks show the whole frame");
        for fragments in 1..=all {
            desk.give(ScrubChange::Step(unit, true));
            assert_eq!(desk.view().report.as_ref().unwrap().fragments.len(), fragments, "{unit:?}");
        }
        for fragments in (0..all).rev() {
            desk.give(ScrubChange::Step(unit, false));
            assert_eq!(desk.view().report.as_ref().unwrap().fragments.len(), fragments, "{unit:?}");
        }
    }
}

#[test]
fn playback_stops_at_the_end_and_restarts_from_there() {
    let mut desk = Desk::new("interpenetrating", Recipe::default());
    let all = desk.session.triangle_count();
    desk.give(ScrubChange::Speed(2.0));
    desk.give(ScrubChange::Play(true));
    assert_eq!(desk.session.moment(), Moment::after(0), "playing at the end restarts from the beginning");
    let mut seen = vec![0];
    for _ in 0..100 {
        desk.give(ScrubChange::Tick(0.25));
        seen.push(desk.session.moment().triangles);
    }
    seen.dedup();
    assert_eq!(seen, (0..=all).collect::<Vec<_>>(), "each triangle was shown");
    assert_eq!(desk.session.features.scrub.playing, 0);
    desk.give(ScrubChange::Play(false));
    desk.give(ScrubChange::Tick(0.5));
    assert_eq!(desk.session.moment(), Moment::after(all - 1));
    desk.give(ScrubChange::Play(false));
    assert_eq!(desk.session.features.scrub.playing, 0, "playing a second time pauses");
}

#[test]
fn playback_waits_for_the_picture() {
    let mut desk = Desk::new("interpenetrating", Recipe::default());
    desk.give(ScrubChange::Play(true));
    desk.session.scrub(ScrubChange::Tick(1.0 / 60.0));
    let asked = desk.session.moment();
    desk.session.scrub(ScrubChange::Tick(9.0));
    assert_eq!(desk.session.moment(), asked, "it is not on screen yet");
}

#[test]
fn anti_aliased_and_upscaled_frames_can_be_scrubbed() {
    let mut smooth = Recipe::default();
    smooth.antialias.method = AntialiasMethod::RotatedGrid;
    let of = |method, scale| Recipe { upscaler: Upscaling::new(method, scale).unwrap(), ..Recipe::default() };
    for recipe in
        [smooth, of("bilinear", 2), of("checkerboard", 1), of("checkerboard-temporal", 1), of("accumulation", 2)]
    {
        let mut desk = Desk::new("cubes", recipe);
        let all = desk.session.triangle_count();
        for triangles in [all / 2, all - 1, 0] {
            desk.give(ScrubChange::Go(Moment::after(triangles)));
            let view = desk.view();
            assert_eq!(view.frame.geometry().triangles.len(), triangles);
            for pixel in [(24, 16), (10, 20), (33, 9)] {
                let report = inspect(&view.request.scene, &recipe, &view.frame, pixel.0, pixel.1).unwrap();
                assert_eq!(report.color, view.frame.image().at(pixel.0, pixel.1), "{triangles} {recipe:?}");
            }
        }
    }
}
