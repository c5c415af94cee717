//! Search for open seams of the scene on screen, where adjacent surfaces share no vertices. It is synchronous for small
//! scenes and runs in a background thread for large ones.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Weak};
use std::time::Duration;

use crate::scene::Scene;
use crate::scene::seams::Seams;

/// Maximum number of triangles in a scene that is searched synchronously, which takes a few milliseconds.
const SMALL: usize = 20_000;

/// Seams of the last requested scene, or the running search for them. Requesting another scene, or dropping this value,
/// cancels the search.
#[derive(Debug, Default)]
pub(super) struct SeamSearch {
    scene: Weak<Scene>,
    state: State,
}

#[derive(Debug, Default)]
enum State {
    #[default]
    Idle,
    Running(Receiver<Seams>, Arc<AtomicBool>),
    Found(Arc<Seams>),
}

impl SeamSearch {
    /// Returns the seams of a scene, and starts the search for them if necessary. Returns `None` if the search is still
    /// running after `patience`.
    pub(super) fn seams(&mut self, scene: &Arc<Scene>, patience: Duration) -> Option<Arc<Seams>> {
        if !std::ptr::eq(self.scene.as_ptr(), Arc::as_ptr(scene)) {
            *self = Self { scene: Arc::downgrade(scene), state: begun(scene) };
        }
        if let State::Running(found, _) = &self.state {
            match found.recv_timeout(patience) {
                Ok(seams) => self.state = State::Found(Arc::new(seams)),
                Err(RecvTimeoutError::Timeout) => {}
                // The thread panicked: the scene is shown without seams.
                Err(RecvTimeoutError::Disconnected) => self.state = State::Found(Arc::default()),
            }
        }
        match &self.state {
            State::Found(seams) => Some(seams.clone()),
            State::Idle | State::Running(..) => None,
        }
    }
}

impl Drop for State {
    fn drop(&mut self) {
        if let Self::Running(_, stop) = self {
            stop.store(true, Ordering::Relaxed);
        }
    }
}

fn begun(scene: &Arc<Scene>) -> State {
    if scene.triangle_count() <= SMALL {
        return State::Found(Arc::new(Seams::of(scene)));
    }
    let (sender, found) = channel();
    let stop = Arc::new(AtomicBool::new(false));
    let (scene, cancelled) = (scene.clone(), stop.clone());
    std::thread::spawn(move || {
        if let Some(seams) = Seams::find(&scene, &cancelled) {
            // The receiver is gone if another scene is shown by now.
            drop(sender.send(seams));
        }
    });
    State::Running(found, stop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn a_large_scene_is_searched_in_the_background_and_another_scene_cancels_the_search() {
        let small = builtin::by_id("cubes").unwrap().build();
        let repeats = SMALL / small.triangle_count() + 1;
        let instances = small.instances.iter().cycle().take(small.instances.len() * repeats).cloned().collect();
        let (large, small) = (Arc::new(Scene { instances, ..small.clone() }), Arc::new(small));
        assert!(large.triangle_count() > SMALL && small.triangle_count() <= SMALL);
        let mut search = SeamSearch::default();
        assert_eq!(search.seams(&large, Duration::ZERO), None);
        let State::Running(_, stop) = &search.state else { panic!("it runs") };
        let stop = stop.clone();
        assert_eq!(search.seams(&small, Duration::ZERO).as_deref(), Some(&Seams::of(&small)));
        assert!(stop.load(Ordering::Relaxed));
        assert_eq!(search.seams(&large, Duration::from_secs(100)).as_deref(), Some(&Seams::of(&large)));
    }
}
