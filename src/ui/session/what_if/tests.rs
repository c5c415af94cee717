use std::sync::Arc;

use super::drawer::Drawer;
use super::*;
use crate::chain::KeepDepth;
use crate::inspect::Buffer;
use crate::measure::error::compare;
use crate::measure::shot::ShotRenderer;
use crate::scene::SceneSource;
use crate::ui::engine::{Engine, Shown};
use crate::ui::session::PictureSize;
use crate::ui::session::command::Command;
use crate::ui::session::scene_time::SceneTimeChange;

fn session(scene: &str) -> Session {
    let source = SceneSource::named(scene.into());
    let scene = source.load().unwrap().scene;
    let home = scene.home;
    let mut session = Session::new(Arc::new(scene), source, Recipe::default(), home);
    session.state.size = PictureSize::Fixed(64, 48);
    session.settle_silently();
    session.apply(Command::WhatIf(WhatIfChange::Toggle));
    session
}

fn set(session: &mut Session, assignment: &str) {
    let mut recipe = session.state.recipe;
    recipe.set(assignment).unwrap();
    session.apply(Command::SetRecipe(recipe));
    session.settle(0.0);
}

/// Draws the requested views and passes the results to the session.
fn find(session: &mut Session) {
    session.view = Some(Engine::default().answer(session.request()));
    let request = session.what_if_request().unwrap();
    session.features.what_if.found = Drawer::default().start(request).cloned();
}

#[test]
fn a_is_the_recipe_before_the_last_change_unless_pinned() {
    let mut session = session("triangle");
    assert!(session.what_if_request().is_none(), "nothing changed yet");
    let first = session.state.recipe;
    set(&mut session, "shading=normals");
    assert_eq!(session.features.what_if.before, Some(first));
    let second = session.state.recipe;
    set(&mut session, "culling=none");
    assert_eq!(session.features.what_if.before, Some(second));
    session.apply(Command::WhatIf(WhatIfChange::Pin(true)));
    set(&mut session, "wireframe=true");
    assert_eq!(session.features.what_if.before, Some(second));
    let third = session.state.recipe;
    session.apply(Command::WhatIf(WhatIfChange::Swap));
    session.settle(1.0);
    assert_eq!((session.features.what_if.before, session.state.recipe), (Some(third), second));
    session.apply(Command::WhatIf(WhatIfChange::Revert));
    session.settle(2.0);
    assert_eq!(session.state.recipe, third);
    session.apply(Command::Undo);
    assert_eq!(session.state.recipe, second, "a revert can be undone like any change");
}

#[test]
fn a_change_is_described_until_the_bar_is_opened() {
    let mut session = session("triangle");
    session.apply(Command::WhatIf(WhatIfChange::Toggle));
    assert_eq!(session.features.what_if.unseen_change(&session.state.recipe), None);
    set(&mut session, "culling=none");
    assert_eq!(session.features.what_if.unseen_change(&session.state.recipe).as_deref(), Some("culling: back → none"));
    session.apply(Command::WhatIf(WhatIfChange::Toggle));
    assert_eq!(session.features.what_if.unseen_change(&session.state.recipe), None);
}

#[test]
fn undo_counts_as_a_change() {
    let mut session = session("triangle");
    let first = session.state.recipe;
    set(&mut session, "shading=normals");
    let second = session.state.recipe;
    session.apply(Command::Undo);
    assert_eq!((session.state.recipe, session.features.what_if.before), (first, Some(second)));
}

#[test]
fn the_canvas_shows_a_b_or_the_changes_of_the_requested_view_only() {
    let mut session = session("shared-edges");
    set(&mut session, "fill_rule=inclusive");
    find(&mut session);
    let view = session.view.clone().unwrap();
    let found = session.features.what_if.found.clone().unwrap();
    assert!(found.changes.count > 0);
    let shown = |session: &Session, held| session.features.what_if.visible_view(&view, held).picture.clone();
    assert_eq!(*shown(&session, true), *found.before.picture);
    let mut plain = session.request();
    plain.recipe = Recipe::default();
    assert_eq!(*found.before.picture, *Engine::default().answer(plain).picture);
    for (show, picture) in [
        (Show::After, &view.picture),
        (Show::Marked, &view.picture),
        (Show::Before, &found.before.picture),
        (Show::Changed, &Arc::new(found.changes.with_unchanged_dimmed(&view.picture))),
    ] {
        session.apply(Command::WhatIf(WhatIfChange::Show(show)));
        assert_eq!(*shown(&session, false), **picture, "{show:?}");
    }
    let mut later = view.clone();
    later.request.recipe.wireframe = true;
    assert!(
        Arc::ptr_eq(&session.features.what_if.visible_view(&later, true).picture, &later.picture),
        "the results belong to another view"
    );
}

#[test]
fn stepping_visits_every_changed_pixel() {
    let mut session = session("shared-edges");
    set(&mut session, "fill_rule=inclusive");
    find(&mut session);
    let count = session.features.what_if.found.as_ref().unwrap().changes.count;
    let first = session.change_beside_pick(true);
    for _ in 0..count {
        session.pick = session.change_beside_pick(true);
        assert!(session.pick.is_some());
    }
    session.pick = session.change_beside_pick(true);
    assert_eq!(session.pick, first, "stepping wraps around");
}

#[test]
fn a_pick_does_not_redraw_and_buffers_are_compared_by_value() {
    let mut session = session("interpenetrating");
    set(&mut session, "depth_format=unorm16");
    let mut drawer = Drawer::default();
    let first = drawer.start(session.what_if_request().unwrap()).unwrap().clone();
    session.pick = Some((30, 20));
    let second = drawer.start(session.what_if_request().unwrap()).unwrap().clone();
    assert!(Arc::ptr_eq(&first.before.frame, &second.before.frame) && Arc::ptr_eq(&first.changes, &second.changes));
    assert!(first.before.report.is_none() && second.before.report.is_some());
    session.shown = Shown::Buffer(Buffer::Depth);
    let depth = drawer.start(session.what_if_request().unwrap()).unwrap();
    assert!(depth.changes.count > first.changes.count);
    assert_eq!(depth.before.range, depth.marked.range, "equal values have equal colours");
}

#[test]
fn error_is_reported_first_and_time_after_all_rounds() {
    let mut session = session("shared-edges");
    set(&mut session, "fill_rule=inclusive");
    let mut drawer = Drawer::default();
    drawer.start(session.what_if_request().unwrap());
    let error = drawer.step().unwrap().error.unwrap();
    let found = drawer.start(session.what_if_request().unwrap()).unwrap();
    assert_eq!((error.differing_pixels, found.error), (found.changes.count, Some(error)));
    let mut pieces = 0;
    while drawer.has_work() {
        let reported = drawer.step().is_some_and(|found| found.times.is_some());
        pieces += 1;
        assert_eq!(reported, !drawer.has_work());
    }
    assert!(pieces > super::drawer::ROUNDS);
}

#[test]
fn changed_pixels_are_marked_only_in_their_view_and_not_while_a_is_held() {
    let mut session = session("shared-edges");
    set(&mut session, "fill_rule=inclusive");
    find(&mut session);
    let view = session.view.clone().unwrap();
    assert_eq!(session.features.what_if.show, Show::Marked);
    let marked = session.features.what_if.marked_changes(&view, false).map(|changes| changes.count);
    assert_eq!(marked, session.features.what_if.found.as_ref().map(|found| found.changes.count));
    assert!(session.features.what_if.marked_changes(&view, true).is_none());
    for show in [Show::Changed, Show::Before, Show::After] {
        session.apply(Command::WhatIf(WhatIfChange::Show(show)));
        assert!(session.features.what_if.marked_changes(&view, false).is_none(), "{show:?}");
    }
}

#[test]
fn in_a_scene_in_motion_both_pictures_have_the_history_of_all_frames() {
    let mut session = session("chess-motion");
    set(&mut session, "upscaler.method=taa");
    set(&mut session, "upscaler.method=fsr2");
    let mut drawer = Drawer::default();
    for number in [20, 21, 12] {
        session.apply(Command::SceneTime(SceneTimeChange::Go(number)));
        let request = session.what_if_request().unwrap();
        let mut found = drawer.start(request.clone()).cloned().unwrap();
        assert_eq!(found.replay.is_some(), number == 20, "frame 21 continues, frame 12 is near a checkpoint");
        while found.error.is_none() {
            found = drawer.step().cloned().unwrap_or(found);
        }
        assert!(found.replay.is_none());
        let picture = |request: &Request| {
            let frame = ShotRenderer::new(request.shot_inputs().unwrap()).draw(number as u32, KeepDepth::No);
            frame.image().clone()
        };
        let (before, after) = (picture(&request.before), picture(&request.after));
        assert!(*found.before.frame.image() == before && *found.marked.frame.image() == after, "frame {number}");
        assert_eq!(found.error, compare(&before, &after));
        assert_eq!(found.changes.count, Changes::of_pictures(&before, &after).unwrap().count);
    }
}

#[test]
fn results_are_current_only_if_the_view_and_b_have_their_whole_history() {
    let mut session = session("chess-motion");
    set(&mut session, "upscaler.method=taa");
    set(&mut session, "upscaler.method=fsr2");
    session.apply(Command::SceneTime(SceneTimeChange::Go(20)));
    let request = session.what_if_request().unwrap();
    let mut drawer = Drawer::default();
    let preview = drawer.start(request.clone()).cloned().unwrap();
    assert!(preview.marked.needs_replay);
    let mut found = preview.clone();
    while drawer.has_work() {
        found = drawer.step().cloned().unwrap_or(found);
    }
    let incomplete = Engine::default().answer(session.request());
    let complete = RenderedView { needs_replay: false, ..incomplete.clone() };
    for (view, found, is_current) in
        [(&incomplete, &found, false), (&complete, &preview, false), (&complete, &found, true)]
    {
        session.features.what_if.found = Some(found.clone());
        assert_eq!(session.features.what_if.marked_changes(view, false).is_some(), is_current);
    }
}

#[test]
fn a_cancelled_replay_measures_nothing_until_other_frames_are_requested() {
    let mut session = session("chess-motion");
    set(&mut session, "upscaler.method=taa");
    set(&mut session, "upscaler.method=fsr2");
    let mut drawer = Drawer::default();
    session.apply(Command::SceneTime(SceneTimeChange::Go(20)));
    drawer.start(session.what_if_request().unwrap());
    drawer.step();
    drawer.cancel_replay();
    assert!(!drawer.has_work() && drawer.step().is_none());
    session.pick = Some((3, 4));
    let picked = drawer.start(session.what_if_request().unwrap()).unwrap();
    assert!(picked.error.is_none() && picked.marked.needs_replay);
    assert!(!drawer.has_work() && drawer.step().is_none());
    session.apply(Command::WhatIf(WhatIfChange::Pin(true)));
    set(&mut session, "upscaler.method=accumulation");
    let mut found = drawer.start(session.what_if_request().unwrap()).cloned().unwrap();
    while drawer.has_work() {
        found = drawer.step().cloned().unwrap_or(found);
    }
    assert!(found.error.is_some() && found.times.is_some());
    assert!(!found.before.needs_replay && !found.marked.needs_replay);
}
