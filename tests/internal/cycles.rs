//! Checks that the modules of a folder do not import each other in a cycle.
//!
//! The rule: the modules of one folder, each of which stands for all modules below it, can be put in an order in which
//! each imports only from those before it. An import counts for the module that defines the item, so that a re-export
//! neither hides a cycle nor makes one. A module may use what its ancestors define themselves, because a folder is one
//! thing with its parts; and a module uses those below it. Code that is compiled only for tests is not checked.

use super::module_graph::{ModuleGraph, TestCode, cycles};

/// Maximum number of imports that are listed for a cycle.
const MAX_LISTED: usize = 40;

#[test]
fn modules_of_a_folder_import_each_other_in_one_direction() {
    let graph = ModuleGraph::read(TestCode::LeftOut);
    assert!(graph.len() > 700, "only {} modules seen", graph.len());
    let mut found = String::new();
    for (folder, imports) in graph.sibling_imports() {
        for cycle in cycles(imports.keys()) {
            let modules = cycle.iter().copied().collect::<Vec<_>>().join(" ");
            found += &format!("{}: {modules}\n", folder.join("::"));
            let within = imports.iter().filter(|((from, to), _)| cycle.contains(&**from) && cycle.contains(&**to));
            for ((from, to), module) in within.take(MAX_LISTED) {
                found += &format!("    {from} imports {to}, in {}\n", module.join("::"));
            }
        }
    }
    assert!(found.is_empty(), "cycles of imports:\n{found}");
}
