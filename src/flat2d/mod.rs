//! The two-dimensional chapter: shapes as iterators of pixels or spans, with no picture and no depth behind them.

pub mod line;
