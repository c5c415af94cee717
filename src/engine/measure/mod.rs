//! Image error metrics and frame timing.

pub mod against;

pub mod bench;

pub mod difference;

pub mod equality;

pub mod error;

pub mod flip;

pub mod skipped_work;

pub mod machine;

pub mod other_programs;

pub mod motion;

pub mod noise;

pub mod pair;

pub mod part;

pub mod picture_error;

pub mod reference;

pub mod region;

pub mod response;

pub mod rounds;

pub mod scaling;

pub mod shard;

pub mod shot;

pub mod stages;

pub mod temporal;

pub mod timing;

pub mod tone;

pub mod window_cost;
