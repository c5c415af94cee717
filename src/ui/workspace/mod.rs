//! Layouts of the workspaces, and the drawing of their panels.

mod defaults;

mod dock;

mod panel;

mod tree;

pub(crate) use dock::Docks;
