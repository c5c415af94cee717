//! Report on the frame time saved by skipping unneeded pipeline parts: a table with one row per scene and one column
//! per part.

use serde::Serialize;

use crate::measure::skipped_work::{Saving, Savings};
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::viewport::Viewport;
use crate::scene::builtin::workload::sheet;
use crate::scene::{Camera, Scene, builtin};

/// Frame time saved in one view by skipping unneeded pipeline parts.
#[derive(Clone, Debug, Serialize)]
pub struct SceneSavings {
    /// Short name of the view, shown in the first column of the table.
    pub scene: &'static str,
    /// Frame time saved by each skipped pipeline part, and by all together.
    pub savings: Savings,
}

/// Number of triangles in the test mesh, enough to make the cost per triangle measurable.
const SHEET_TRIANGLES: usize = 100_000;

/// Distance from the eye to the target in the close-up view of the test mesh, as a fraction of the distance in its home
/// view.
const SHEET_NEAR: f32 = 0.25;

/// Returns the views to measure: every built-in scene in its home view, then three views of a large test mesh. These
/// three views show the whole mesh, show it close up, and look away from it.
pub fn views() -> Vec<(&'static str, Scene, Camera)> {
    let of = |id, scene: Scene| {
        let home = scene.home;
        (id, scene, home)
    };
    let mut views: Vec<_> = builtin::ALL.iter().map(|builtin| of(builtin.id, builtin.build())).collect();
    let sheet = sheet(SHEET_TRIANGLES);
    let Camera { eye, target, .. } = sheet.home;
    let away = Camera { target: eye + (eye - target), ..sheet.home };
    // The eye is so near that most of the mesh lies outside the image.
    let near = Camera { eye: target.lerp(eye, SHEET_NEAR), near: sheet.home.near * SHEET_NEAR, ..sheet.home };
    views.push(of("sheet in view", sheet.clone()));
    views.push(("sheet from near", sheet.clone(), near));
    views.push(("sheet behind", sheet, away));
    views
}

/// Pipeline parts whose skipping can be disabled, with their column headings.
const COLUMNS: [(PipelinePart, &str); 7] = [
    (PipelinePart::Vertices, "vertices"),
    (PipelinePart::EveryCluster, "clusters"),
    (PipelinePart::Clipping, "clipping"),
    (PipelinePart::PerspectiveDivision, "division"),
    (PipelinePart::TextureCoordinates, "tex. coords"),
    (PipelinePart::Normals, "normals"),
    (PipelinePart::VertexColors, "colours"),
];

/// Formats the table of savings, with a legend below.
pub fn table(rows: &[SceneSavings], Viewport { width, height }: Viewport, threads: usize) -> String {
    let rounds = rows.first().map_or(0, |row| row.savings.planned_ms.n);
    let unit = if threads == 1 { "thread" } else { "threads" };
    let mut text = format!(
        "Savings of skipped work: ms of a frame with one skip disabled minus ms with every skip enabled\n\
         {width} × {height} px, {threads} {unit}, medians of {rounds} interleaved rounds\n\n\
         {:16} {:>9} {:>8} {:>9} {:>7}",
        "scene", "frame ms", "± noise", "plan µs", "% frame"
    );
    text.extend(COLUMNS.map(|(_, heading)| format!(" {heading:>11}")));
    text += &format!(" {:>11}\n", "all parts");
    for SceneSavings { scene, savings } in rows {
        let Savings { planned_ms, planning_ms, .. } = savings;
        text += &format!(
            "{scene:16} {:9.3} {:8.3} {:9.2} {:7.3}",
            planned_ms.median,
            savings.noise.ms(planned_ms.median),
            planning_ms.median * 1e3,
            planning_ms.median / planned_ms.median * 100.0
        );
        text.extend(COLUMNS.map(|(part, _)| format!(" {:>11}", cell(savings, part))));
        text += &format!(" {:>11}\n", all(savings));
    }
    text + "\nneeded: every draw in view runs the part. –: the part is not needed, and no skip of it can be disabled. \
            frame ms: every skip\n\
            enabled. ± noise: 90th percentile of the differences between medians of this frame; savings within noise \
            are in parentheses.\n\
            plan µs: time for deciding what to skip, which is the only overhead of a frame that needs every part.\n"
}

fn cell(savings: &Savings, part: PipelinePart) -> String {
    let found = savings.savings.iter().find(|saving| saving.part == Some(part));
    match found {
        Some(saving) => signed(saving),
        None if savings.needed.contains(&part) => "needed".to_owned(),
        None => "–".to_owned(),
    }
}

/// Formats the time saved by all skipped parts together, or by the only skipped part; "nothing" if no part is skipped.
fn all(savings: &Savings) -> String {
    savings.savings.last().map_or_else(|| "nothing".to_owned(), signed)
}

fn signed(saving: &Saving) -> String {
    let ms = saving.saved_ms.median;
    let fault = if saving.same_picture { "" } else { "!PICTURE" };
    if saving.within_noise { format!("({ms:+.3}){fault}") } else { format!("{ms:+.3}{fault}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::noise::Noise;
    use crate::measure::timing::summarize;

    fn savings(parts: &[(Option<PipelinePart>, f64, bool)]) -> Savings {
        let ms = |ms: f64| summarize(&[ms]).unwrap();
        let noise = Noise { pairs: 7, p90: 0.2 };
        let saving = |&(part, saved, same_picture)| {
            let within_noise = noise.covers_change(saved, 2.0);
            Saving { part, draws: 1, saved_ms: ms(saved), within_noise, same_picture }
        };
        Savings {
            planned_ms: ms(2.0),
            noise,
            planning_ms: ms(0.003),
            needed: vec![PipelinePart::Vertices],
            savings: parts.iter().map(saving).collect(),
        }
    }

    #[test]
    fn a_cell_shows_the_saving_or_why_there_is_none() {
        let rows = [
            SceneSavings {
                scene: "one",
                savings: savings(&[
                    (Some(PipelinePart::Normals), 0.5, true),
                    (Some(PipelinePart::Clipping), -0.25, false),
                    (None, 0.75, true),
                ]),
            },
            SceneSavings { scene: "two", savings: savings(&[]) },
        ];
        let text = table(&rows, Viewport { width: 64, height: 48 }, 2);
        let words = |scene: &str| -> Vec<&str> {
            text.lines().find(|line| line.starts_with(scene)).unwrap().split_whitespace().skip(1).collect()
        };
        // The noise floor is 20 %, or 0.4 of 2 ms.
        assert_eq!(words("one")[..4], ["2.000", "0.400", "3.00", "0.150"]);
        assert_eq!(words("one")[4..], ["needed", "–", "(-0.250)!PICTURE", "–", "–", "+0.500", "–", "+0.750"]);
        assert_eq!(words("two")[4..], ["needed", "–", "–", "–", "–", "–", "–", "nothing"]);
    }

    #[test]
    fn every_part_that_can_be_forced_has_a_column() {
        let forced: Vec<_> =
            PipelinePart::ALL.into_iter().filter(|part| part.disabled_optimisation().is_some()).collect();
        assert_eq!(COLUMNS.map(|(part, _)| part)[..], forced);
    }
}
