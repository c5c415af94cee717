//! Camera paths that depend only on the home view and the time. They repeat seamlessly and begin at the home view.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::scene::Camera;

/// Built-in motion of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Preset {
    /// One turn about the target at constant speed.
    Turntable,
    /// Hand-held camera: deterministic noise of a few pixels.
    Shake,
}

/// Amplitude of the turns of the hand-held camera, as a fraction of the height of the picture at the target.
const SHAKE_TURN: f64 = 0.004;

/// Amplitude of the shifts of the hand-held camera, as a fraction of the visible height at the target.
const SHAKE_SHIFT: f64 = 0.002;

impl Preset {
    pub(super) const ALL: [Self; 2] = [Self::Turntable, Self::Shake];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Turntable => "turntable",
            Self::Shake => "shake",
        }
    }

    /// Returns the time after which the motion repeats, in seconds.
    pub(super) fn duration_s(self) -> f64 {
        match self {
            Self::Turntable => 8.0,
            Self::Shake => 4.0,
        }
    }

    /// Returns the view at a finite time in seconds.
    pub(super) fn at(self, home: &Camera, time_s: f64) -> Camera {
        let share = (time_s / self.duration_s()).rem_euclid(1.0);
        let moved = match self {
            Self::Turntable => turned(home, share),
            Self::Shake => shaken(home, share),
        };
        // At the ends of the float range, the moved camera may be invalid.
        if moved.check().is_ok() { moved } else { *home }
    }
}

fn turned(home: &Camera, share: f64) -> Camera {
    let axis = home.up.as_dvec3().normalize_or(DVec3::Y);
    let offset = home.eye.as_dvec3() - home.target.as_dvec3();
    let turn = DQuat::from_axis_angle(axis, TAU * share);
    if share == 0.0 { *home } else { Camera { eye: (home.target.as_dvec3() + turn * offset).as_vec3(), ..*home } }
}

fn shaken(home: &Camera, share: f64) -> Camera {
    let (right, forward) = (home.right().as_dvec3(), home.forward().as_dvec3());
    let up = right.cross(forward);
    let height = f64::from(home.visible_height());
    let noise = |frequencies: [f64; 3]| {
        let wave = |frequency: f64| (TAU * frequency * share).sin() / frequency.sqrt();
        frequencies.map(wave).iter().sum::<f64>()
    };
    let shift = (right * noise([2.0, 5.0, 9.0]) + up * noise([1.0, 4.0, 11.0])) * (SHAKE_SHIFT * height);
    let turn = (right * noise([3.0, 7.0, 13.0]) + up * noise([2.0, 6.0, 15.0])) * (SHAKE_TURN * height);
    let moved = |point: glam::Vec3, offset: DVec3| (point.as_dvec3() + offset).as_vec3();
    Camera { eye: moved(home.eye, shift), target: moved(home.target, shift + turn), ..*home }
}
