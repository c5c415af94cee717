//! Inputs of the kernels of shadings at a fragment, in floats.

use super::Shader;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use crate::pipeline::settings::Checker;
use crate::pipeline::shading::{CheckerInputs, LightInputs, SurfaceInputs};

/// Inputs at a fragment, in floats: of the light, or with its triangle also of a quantity.
#[derive(Clone, Copy, Debug)]
pub(super) struct FragmentInputs<'a, T> {
    pub(super) shader: &'a Shader<'a>,
    pub(super) fragment: &'a Fragment,
    /// The triangle, or `()`.
    pub(super) triangle: T,
}

impl<T> LightInputs for FragmentInputs<'_, T> {
    type Number = f32;

    #[inline(always)]
    fn constant(&self, value: f32) -> f32 {
        value
    }

    #[inline(always)]
    fn normal(&self) -> [f32; 3] {
        self.shader.unit_normal(self.fragment).to_array()
    }

    #[inline(always)]
    fn vertex_light(&self) -> f32 {
        self.fragment.light
    }

    #[inline(always)]
    fn light_direction(&self) -> [f32; 3] {
        self.shader.light_direction.to_array()
    }

    #[inline(always)]
    fn ambient(&self) -> f32 {
        self.shader.settings.light.ambient
    }

    #[inline(always)]
    fn dark_factor(&self) -> f32 {
        self.shader.dark_factor()
    }
}

impl SurfaceInputs for FragmentInputs<'_, &ScreenTriangle> {
    fn eye_direction(&self) -> [f32; 3] {
        self.shader.eye_direction(self.fragment).to_array()
    }

    #[inline(always)]
    fn uv(&self) -> [f32; 2] {
        self.fragment.uv.to_array()
    }

    #[inline(always)]
    fn vertex_color(&self) -> [f32; 3] {
        self.fragment.color.to_array()
    }

    #[inline(always)]
    fn weights(&self) -> [f32; 3] {
        self.fragment.source_weights.to_array()
    }

    #[inline(always)]
    fn depth(&self) -> f32 {
        depth_at(self.triangle, &self.fragment.sample)
    }

    fn checker(&self) -> CheckerInputs<f32> {
        let Checker { squares, even, odd } = self.shader.settings.checker;
        CheckerInputs { squares, even: even.to_array(), odd: odd.to_array() }
    }
}
