//! Key map: the keys, mouse gestures and names of commands. Shortcuts, tooltips, key sheet and palette read these tables.

mod bindings;

mod keyless;

pub(crate) use bindings::BINDINGS;
pub(crate) use keyless::KEYLESS;

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

use super::session::command::Command;

/// Topic under which keys and mouse gestures are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topic {
    /// Mouse.
    Mouse,
    /// Picture on the canvas.
    Picture,
    /// Picked pixel.
    Pixel,
    /// Stages.
    Stages,
    /// Frame playback.
    Making,
    /// Value range and overlays.
    Showing,
    /// Calculation of the picked pixel.
    Arithmetic,
    /// Search and bookmarks.
    Places,
    /// Scene and view.
    Scene,
    /// Settings.
    Settings,
    /// Comparing.
    Comparing,
    /// Everything else.
    General,
}

impl Topic {
    /// All topics with their display names, in the order of the key sheet.
    pub(crate) const ALL: [(Self, &'static str); 12] = [
        (Self::Mouse, "Mouse"),
        (Self::Picture, "Picture on the canvas"),
        (Self::Pixel, "Picked pixel"),
        (Self::Stages, "Stages"),
        (Self::Making, "Frame playback"),
        (Self::Showing, "Value range and overlays"),
        (Self::Arithmetic, "Calculation of the picked pixel"),
        (Self::Places, "Search and bookmarks"),
        (Self::Scene, "Scene and view"),
        (Self::Settings, "Settings"),
        (Self::Comparing, "Comparing"),
        (Self::General, "Other"),
    ];
}

/// Key binding with its description.
pub(crate) struct KeyBinding {
    /// Topic under which the key sheet lists the binding.
    pub(crate) topic: Topic,
    /// Key that triggers the command.
    pub(crate) key: Key,
    /// Modifiers that must be held.
    pub(crate) modifiers: Modifiers,
    /// Constructor of the command.
    pub(crate) command: fn() -> Command,
    /// Description for tooltips and the key sheet.
    pub(crate) description: &'static str,
    /// Other words for the command, in lower case, by which the palette finds it.
    pub(crate) synonyms: &'static [&'static str],
}

impl KeyBinding {
    /// Returns the binding with other words for its command, in lower case, by which the palette finds it.
    const fn also(self, synonyms: &'static [&'static str]) -> Self {
        Self { synonyms, ..self }
    }

    /// Whether the key works while a widget other than a text field has the keyboard focus: function keys, and keys with
    /// Ctrl or Alt.
    pub(crate) fn works_beside_focus(&self) -> bool {
        let is_function_key = matches!(
            self.key,
            Key::F1
                | Key::F2
                | Key::F3
                | Key::F4
                | Key::F5
                | Key::F6
                | Key::F7
                | Key::F8
                | Key::F9
                | Key::F10
                | Key::F11
        );
        is_function_key || self.modifiers.command || self.modifiers.alt
    }

    /// Returns the binding as an egui shortcut.
    pub(crate) fn shortcut(&self) -> KeyboardShortcut {
        KeyboardShortcut::new(self.modifiers, self.key)
    }
}

/// Mouse gestures and their effects, for the key sheet.
pub(crate) const MOUSE: &[(&str, &str)] = &[
    ("Click", "Pick a pixel and explain it"),
    ("Right-drag", "Inspect pixels while dragging"),
    ("Drag", "Orbit the camera around its target"),
    ("Wheel", "Zoom at the pointer"),
    ("Middle-drag; P, then drag", "Pan the picture"),
    ("Shift + middle-drag", "Pan the camera"),
    ("Ctrl + wheel", "Dolly the camera"),
    ("Tab over the picture", "Hide or show the panels"),
    ("Hold Alt", "Show pixel values as raw bits in hexadecimal"),
    ("Shift + drag; Shift + R, then drag", "Show statistics of a rectangle of the picture"),
    ("Hold Shift while comparing", "Show the other picture"),
    ("What changed: hold Shift", "Show the picture before the change"),
    ("Comparing: R, then drag", "Measure the errors in a rectangle"),
    ("C, then drag, wheel, W A S D Q E", "Camera mode: orbit, dolly, fly"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_binding_is_hidden_by_an_earlier_one() {
        for (place, binding) in BINDINGS.iter().enumerate() {
            // The toolkit reports Ctrl as both `ctrl` and `command`.
            let pressed = Modifiers { ctrl: binding.modifiers.command, ..binding.modifiers };
            let hides =
                |earlier: &&KeyBinding| earlier.key == binding.key && pressed.matches_logically(earlier.modifiers);
            let hiding = BINDINGS[..place].iter().find(hides).map(|earlier| earlier.description);
            assert_eq!(hiding, None, "{}", binding.description);
        }
    }
}
