//! Meaning of the MTL statement `Tr`: transparency according to the format, but opacity in files from MeshLab and some
//! other programs.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::mtl::{Description, Descriptions, Located};
use crate::scene::warnings::Warnings;

/// Meaning of the MTL statement `Tr`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrMeaning {
    /// Opacity if the file indicates it, otherwise transparency.
    #[default]
    Auto,
    /// Transparency: 0 is opaque.
    Transparency,
    /// Opacity: 1 is opaque.
    Opacity,
}

/// Minimum difference at which two opacities count as different.
const DIFFERENT: f32 = 1e-3;

/// Whether `Tr` means opacity in a model that uses the materials `used` of `all` materials. Warns if opacity was
/// inferred.
pub(super) fn tr_is_opacity(
    meaning: TrMeaning,
    used: &[&Description],
    all: &Descriptions,
    is_meshlab: bool,
    warnings: &mut Warnings,
) -> bool {
    let written: Vec<&Located<f32>> = all.values().filter_map(|material| material.tr.as_ref()).collect();
    let Some(first) = written.iter().min_by_key(|tr| tr.line) else { return false };
    match meaning {
        TrMeaning::Transparency => return false,
        TrMeaning::Opacity => return true,
        TrMeaning::Auto => {}
    }
    let reason = if is_meshlab {
        "the file was written by MeshLab"
    } else if agrees_with_dissolve(all) {
        "it equals `d` where both are given"
    } else if !used.is_empty() && used.iter().all(|material| material.opacity(false) == 0.0) && tr_decides(used) {
        "every material would be invisible otherwise"
    } else {
        return false;
    };
    let text = format!("`Tr` is treated as opacity because {reason}; override with `--tr transparency`");
    warnings.add(&first.library, Some(first.line), text);
    true
}

/// Whether `d` and `Tr` are equal in all materials that have both, which indicates that `Tr` means opacity. Ignores
/// materials with `d` = 0.5, for which both meanings agree. Returns `false` if no material remains.
fn agrees_with_dissolve(all: &Descriptions) -> bool {
    let mut pairs = all
        .values()
        .filter_map(|material| Some((material.dissolve.as_ref()?.value, material.tr.as_ref()?.value)))
        .filter(|(d, _)| (d - 0.5).abs() > DIFFERENT)
        .peekable();
    pairs.peek().is_some() && pairs.all(|(d, tr)| (d - tr).abs() < DIFFERENT)
}

/// Whether at least one of the materials specifies its opacity by `Tr` alone.
fn tr_decides(used: &[&Description]) -> bool {
    used.iter().any(|material| material.dissolve.is_none() && material.tr.is_some())
}

impl Description {
    /// Returns the opacity of the material: `d` if given, otherwise the opacity given by `Tr`, otherwise 1.
    pub(super) fn opacity(&self, tr_is_opacity: bool) -> f32 {
        match (&self.dissolve, &self.tr) {
            (Some(dissolve), _) => dissolve.value,
            (None, Some(tr)) if tr_is_opacity => tr.value,
            (None, Some(tr)) => 1.0 - tr.value,
            (None, None) => 1.0,
        }
    }

    /// Warns if surfaces of this material are invisible.
    pub(super) fn warn_if_invisible(&self, tr_is_opacity: bool, path: &Path, warnings: &mut Warnings) {
        if self.opacity(tr_is_opacity) == 0.0 {
            let at = self.dissolve.as_ref().or(self.tr.as_ref());
            let (library, line) = at.map_or((path, None), |at| (at.library.as_path(), Some(at.line)));
            warnings.add(library, line, "opacity 0: surfaces of this material are invisible");
        }
    }
}
