//! Names that trace lines of several stages use.

/// Names of the colour channels.
pub(super) const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Names of the components of a vector.
pub(super) const AXES: [&str; 4] = ["x", "y", "z", "w"];
