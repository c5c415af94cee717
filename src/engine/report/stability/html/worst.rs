//! Section of the HTML report with the worst case of each class and configuration, as JSON that can be saved and opened
//! again.

use std::collections::BTreeMap;

use crate::pipeline::settings::Choice as _;
use crate::report::html::escaped;
use crate::report::stability::metric::Measures;
use crate::report::stability::sweep::{ClassReport, StabilityReport, Worst};

/// A worst case, with the labels of the configurations for which it is the worst.
type WorstCase<'a> = (&'a Worst, Vec<String>);

/// Maximum length of a test case printed in the report, in bytes of JSON. Longer cases are available from the command
/// line.
const LONGEST_JSON: usize = 20_000;

/// Returns the HTML anchor of a case.
pub(super) fn anchor(class: &ClassReport, worst: &Worst) -> String {
    /// Offset basis and prime of the FNV-1a hash, which names cases by their contents.
    const FNV: (u32, u32) = (0x811c_9dc5, 0x0100_0193);
    let json = worst.case.to_json();
    let hash = json.bytes().fold(FNV.0, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(FNV.1));
    format!("{}-{hash:08x}", class.class.id)
}

/// Returns the HTML section with the worst cases of all classes.
pub(super) fn section(report: &StabilityReport) -> String {
    let classes: String = report.classes.iter().map(class_details).collect();
    if classes.is_empty() {
        return String::new();
    }
    format!(
        "<section id=\"worst\">\n<h2>Worst cases</h2>\n<p class=\"soft\">The worst case of each cell of the maps \
         above, reduced to the part that shows the fault. Saved as a file, it can be opened \
         again.</p>\n{classes}</section>\n"
    )
}

fn class_details(class: &ClassReport) -> String {
    let mut entries: BTreeMap<String, WorstCase<'_>> = BTreeMap::new();
    for cell in &class.cells {
        if let Some(worst) = &cell.worst {
            entries.entry(anchor(class, worst)).or_insert((worst, Vec::new())).1.push(cell.column.label());
        }
    }
    if entries.is_empty() {
        return String::new();
    }
    let cases: String = entries.iter().map(|(anchor, entry)| case_details(anchor, entry)).collect();
    let count = if entries.len() == 1 { "1 case".to_owned() } else { format!("{} cases", entries.len()) };
    format!(
        "<details open><summary><b>{}</b><small>{count}</small></summary>\n<p class=\"soft\">{}</p>\n{cases}</details>\n",
        escaped(class.class.name),
        escaped(class.class.about)
    )
}

fn case_details(anchor: &str, (worst, cells): &WorstCase<'_>) -> String {
    let json = worst.case.to_json();
    let shown = if json.len() > LONGEST_JSON {
        format!("<p class=\"soft\">{} characters: run `rasterscope stability --json` to get it.</p>", json.len())
    } else {
        format!("<pre>{}</pre>", escaped(&json))
    };
    let found = worst.measures.as_ref().map_or("no answer".to_owned(), summary);
    format!(
        "<details id=\"{anchor}\"><summary>{}<small>{} {found}</small></summary>\n<p class=\"soft\">Worst for {}.</p>\n\
         {shown}\n</details>\n",
        escaped(&worst.of),
        escaped(&worst.case.note),
        escaped(&cells.join(", "))
    )
}

/// Returns the faults of a case in one line.
fn summary(measures: &Measures) -> String {
    let faults = measures.iter().filter(|(metric, value)| *value > 0.0 && measures.severity(*metric) > Some(0));
    let faults = faults.filter(|(metric, _)| metric.is_fault());
    let words: Vec<String> =
        faults.map(|(metric, value)| format!("{} {}", metric.format(value), metric.name())).collect();
    escaped(&words.join(", "))
}
