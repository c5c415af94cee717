//! Image error metrics and frame timing.

pub mod against;

pub mod bench;

pub mod checkpoints;

pub mod difference;

pub mod equality;

pub mod error;

pub mod flip;

pub mod jod;

pub mod machine;

pub mod metric;

pub mod other_programs;

pub mod motion;

mod ms_ssim;

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

pub mod skipped_work;

pub mod ssimulacra2;

pub mod stages;

pub mod temporal;

#[cfg(test)]
pub(crate) mod test_pictures;

pub mod timing;

pub mod tone;

pub mod window_cost;
