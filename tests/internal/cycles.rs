//! Checks that the modules of a folder do not import each other in a cycle.
//!
//! The rule: the modules of one folder, each of which stands for all modules below it, can be put in an order in which
//! each imports only from those before it. An import counts for the module that defines the item, so that a re-export
//! neither hides a cycle nor makes one. A module may use what its ancestors define themselves, because a folder is one
//! thing with its parts; and a module uses those below it. Code that is compiled only for tests is not checked.

use std::collections::BTreeSet;

use super::module_graph::{ModuleGraph, TestCode, cycles};

/// Cycle that remains, with the reason.
struct Remaining {
    /// Folder, as a path from its crate on.
    folder: &'static str,
    /// Modules of the cycle, in alphabetical order, separated by spaces.
    modules: &'static str,
    /// Reason why the cycle is still there.
    reason: &'static str,
}

/// Cycles that remain. The list may only become shorter.
const REMAINING: &[Remaining] = &[Remaining {
    folder: "rasterscope::ui",
    modules: "appearance camera_path canvas canvas_state checks command compare engine explaining fates fault_bar \
                  features files filmstrip first_pick key_map key_sheet lab legend_strip long_tasks look manual \
                  mesh_view navigate onboarding open_case over_time overlays palette panels picked_point \
                  picture_panel picture_size place probe range save_as scene_time scrub sequences session stages \
                  temporal timings trace vertices watch what_if window_task worker workspace",
    reason: "The session owns the state of all features, and each feature changes the session and draws itself.",
}];

/// Maximum number of imports that are listed for a new cycle.
const MAX_LISTED: usize = 40;

#[test]
fn modules_of_a_folder_import_each_other_in_one_direction() {
    let graph = ModuleGraph::read(TestCode::LeftOut);
    assert!(graph.len() > 700, "only {} modules seen", graph.len());
    let mut known: BTreeSet<(&str, &str)> = REMAINING.iter().map(|cycle| (cycle.folder, cycle.modules)).collect();
    let mut new = String::new();
    for (folder, imports) in graph.sibling_imports() {
        let folder = folder.join("::");
        for cycle in cycles(imports.keys()) {
            let modules = cycle.iter().copied().collect::<Vec<_>>().join(" ");
            let entry = known.iter().copied().find(|entry| *entry == (folder.as_str(), modules.as_str()));
            if entry.is_some_and(|entry| known.remove(&entry)) {
                continue;
            }
            new += &format!("{folder}: {modules}\n");
            let within = imports.iter().filter(|((from, to), _)| cycle.contains(&**from) && cycle.contains(&**to));
            for ((from, to), module) in within.take(MAX_LISTED) {
                new += &format!("    {from} imports {to}, in {}\n", module.join("::"));
            }
        }
    }
    assert!(new.is_empty(), "cycles of imports:\n{new}");
    assert!(known.is_empty(), "cycles that no longer exist are still listed: {known:?}");
}

#[test]
fn every_remaining_cycle_has_a_reason() {
    assert!(REMAINING.iter().all(|cycle| cycle.reason.ends_with('.')));
}
