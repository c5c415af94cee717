//! Inputs of shading kernels as named numbers, from which the kernels compute the formulas of a trace.

use std::borrow::Cow;

use glam::Vec3;

use super::formula::{Formula, constant, given};
use super::names::CHANNELS;
use super::subject::TracedFragment;
use crate::pipeline::screen_triangle::depth_at;
use crate::pipeline::settings::Checker;
use crate::pipeline::shading::{CheckerInputs, LightInputs, SurfaceInputs};

/// Inputs of a shading kernel at the traced fragment.
#[derive(Clone, Copy)]
pub(super) struct FormulaInputs<'a>(pub(super) &'a TracedFragment<'a>);

/// Returns the components of a vector as named numbers.
pub(super) fn vector<T: Into<Cow<'static, str>>>(names: [T; 3], vector: impl Into<[f32; 3]>) -> [Formula; 3] {
    let mut values = vector.into().into_iter();
    names.map(|name| given(name, values.next().unwrap_or_default()))
}

/// Returns the channels of a colour as numbers that are named after it.
fn channels(name: &str, color: Vec3) -> [Formula; 3] {
    vector(CHANNELS.map(|channel| format!("{name} {channel}")), color)
}

impl LightInputs for FormulaInputs<'_> {
    type Number = Formula;

    fn constant(&self, value: f32) -> Formula {
        constant(value)
    }

    fn normal(&self) -> [Formula; 3] {
        vector(["nx", "ny", "nz"], self.0.shader.unit_normal(&self.0.fragment))
    }

    fn vertex_light(&self) -> Formula {
        given("light from the corners", self.0.fragment.light)
    }

    fn light_direction(&self) -> [Formula; 3] {
        vector(["lx", "ly", "lz"], self.0.shader.light_direction)
    }

    fn ambient(&self) -> Formula {
        given("ambient", self.0.settings.light.ambient)
    }

    fn dark_factor(&self) -> Formula {
        given("factor of the dark side", self.0.shader.dark_factor())
    }
}

impl SurfaceInputs for FormulaInputs<'_> {
    fn eye_direction(&self) -> [Formula; 3] {
        vector(["ex", "ey", "ez"], self.0.shader.eye_direction(&self.0.fragment))
    }

    fn uv(&self) -> [Formula; 2] {
        let [u, v] = self.0.fragment.uv.to_array();
        [given("u", u), given("v", v)]
    }

    fn vertex_color(&self) -> [Formula; 3] {
        channels("vertex", self.0.fragment.color)
    }

    fn weights(&self) -> [Formula; 3] {
        vector(["λ0", "λ1", "λ2"], self.0.fragment.source_weights)
    }

    fn depth(&self) -> Formula {
        given("depth", depth_at(self.0.triangle, &self.0.fragment.sample))
    }

    fn checker(&self) -> CheckerInputs<Formula> {
        let Checker { squares, even, odd } = self.0.settings.checker;
        let squares = given("squares", squares);
        CheckerInputs { squares, even: channels("even", even), odd: channels("odd", odd) }
    }
}
