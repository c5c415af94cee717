//! Renderer side of the filmstrip: draws one picture per step and then measures its error.

use crate::ui::session::compare::compute::{CompareRequest, Compared, Comparer};

/// Draws and measures the pictures of the newest request.
#[derive(Debug, Default)]
pub(crate) struct FilmstripDrawer {
    comparer: Comparer,
    request: Option<CompareRequest>,
    /// Number of pictures drawn so far.
    drawn: usize,
}

impl FilmstripDrawer {
    /// Replaces the request; `None` cancels all work and drops all results.
    pub(crate) fn set(&mut self, request: Option<CompareRequest>) {
        if request.is_none() {
            self.comparer.clear();
        }
        (self.request, self.drawn) = (request, 0);
    }

    /// Whether any result is missing.
    pub(crate) fn has_work(&self) -> bool {
        self.request.as_ref().is_some_and(|request| self.drawn < request.recipes.len()) || self.comparer.has_work()
    }

    /// Whether computing the results has begun and is not complete.
    pub(crate) fn has_begun(&self) -> bool {
        self.drawn > 0 && self.has_work()
    }

    /// Draws the next picture, or runs one step of measuring the error of the last one. Returns `None` if there is no
    /// new result.
    pub(crate) fn step(&mut self) -> Option<&Compared> {
        let request = self.request.as_ref()?;
        if self.drawn > 0 && self.comparer.has_work() {
            return self.comparer.step();
        }
        let recipes = request.recipes.get(..=self.drawn)?.to_vec();
        let part = CompareRequest { recipes, ..request.clone() };
        self.drawn += 1;
        Some(self.comparer.start(part))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::measure::reference::Reference;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::SceneSource;
    use crate::ui::session::compare::files::ComparedFiles;
    use crate::ui::session::tile_set::methods;

    #[test]
    fn pictures_are_drawn_one_by_one_and_measured() {
        let scene = SceneSource::named("triangle".into()).load().unwrap().scene;
        let recipes: Vec<_> = methods(None).map(|upscaler| Recipe { upscaler, ..Recipe::default() }).collect();
        let mut drawer = FilmstripDrawer::default();
        drawer.set(Some(CompareRequest {
            camera: scene.home,
            scene: Arc::new(scene),
            sequence: None,
            viewport: Viewport { width: 32, height: 24 },
            recipes: recipes.clone(),
            files: ComparedFiles::default(),
            reference: Reference::Native,
            region: None,
            difference: None,
        }));
        let mut counts = Vec::new();
        let mut last = None;
        while drawer.has_work() {
            if let Some(compared) = drawer.step() {
                counts.push(compared.tiles.len());
                last = Some(compared.clone());
            }
        }
        counts.dedup();
        assert_eq!(counts, (1..=recipes.len()).collect::<Vec<_>>());
        let tiles = last.expect("there are results").tiles;
        assert!(tiles.iter().zip(&recipes).all(|(tile, recipe)| tile.recipe == *recipe && tile.measured.is_some()));
        drawer.set(None);
        assert!(!drawer.has_work());
    }
}
