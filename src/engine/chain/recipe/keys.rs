//! Keys of settings: one declaration for each setting of a recipe. Command line, palette, switches of the window, change
//! lists, the manual's table and tests follow from it.

use super::Recipe;
use super::values::{SettingValue, ValueForm, Values, Word};
use crate::antialias::settings::PostFilterKind;
use crate::pipeline::settings::{Choice, MIP_BIAS};
use crate::upscale::{self, HistoryFilter, HistoryOptions, MAX_SHARPENING, Offers, Rectification, Scale, Upscaling};

/// Pipeline stage whose switches include a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingStage {
    /// Back-face or front-face culling.
    Cull,
    /// Coverage of samples; also the execution mode.
    Rasterize,
    /// Test and format of depths.
    Depth,
    /// Interpolation of vertex attributes across a triangle.
    Interpolate,
    /// Colours of fragments: shading, textures, light, blending and background.
    Shade,
    /// Everything after shading: resolve, upscaling and post filter.
    Upscale,
    /// No stage: the window has no switch for the setting.
    Hidden,
}

/// Conversion of a setting's value from and to text.
struct Access {
    /// Returns the accepted values.
    values: fn() -> Values,
    /// Returns the value as text.
    read: fn(&Recipe) -> String,
    /// Replaces the value. Returns an error message if the text is not a value of the setting.
    write: fn(&mut Recipe, &str) -> Result<(), String>,
    /// Returns an error message if the value is one that its type allows, but the setting does not.
    check: fn(&Recipe) -> Result<(), String>,
}

/// Declaration of a setting, apart from its variant.
struct Declaration {
    id: &'static str,
    stage: SettingStage,
    is_placed: bool,
    name: &'static str,
    help: &'static str,
    access: Access,
    synonyms: &'static [&'static str],
}

/// Declares [`SettingKey`]: for each setting its key, its stage, the name and the help text of its switch, and the access
/// to its value; optionally other words by which the palette finds it. `placed` after the stage means that the window
/// draws the switch at a place of its own; all others are drawn at the top of the stage.
macro_rules! setting_keys {
    ($($variant:ident = $id:literal, $stage:ident $($placed:ident)?, $name:literal, $help:literal, $access:expr
        $(, also [$($synonym:literal),+])?;)+) => {
        /// Setting of a [`Recipe`], addressed by its key.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum SettingKey {
            $(#[doc = $help] $variant,)+
        }

        impl Choice for SettingKey {
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            fn id(self) -> &'static str {
                self.declaration().id
            }

            fn name(self) -> &'static str {
                self.declaration().name
            }

            fn help(self) -> &'static str {
                self.declaration().help
            }

            fn synonyms(self) -> &'static [&'static str] {
                self.declaration().synonyms
            }
        }

        impl SettingKey {
            /// Returns the declaration of the setting.
            fn declaration(self) -> &'static Declaration {
                match self {
                    $(Self::$variant => {
                        const DECLARATION: Declaration = Declaration {
                            id: $id,
                            stage: SettingStage::$stage,
                            is_placed: !concat!($(stringify!($placed))?).is_empty(),
                            name: $name,
                            help: $help,
                            access: $access,
                            synonyms: &[$($($synonym),+)?],
                        };
                        &DECLARATION
                    })+
                }
            }
        }
    };
}

/// Access to a field of a recipe, for example `field!(pipeline.culling)`. A number may be restricted to a range, as in
/// `field!(pipeline.mip_bias in MIP_BIAS)`.
macro_rules! field {
    ($($field:ident).+) => {
        Access {
            values: || values_of(|recipe| &recipe.$($field).+),
            check: |recipe| check_finite(&recipe.$($field).+),
            ..field!(@convert $($field).+)
        }
    };
    ($($field:ident).+ in $range:expr) => {
        Access {
            values: || Values::of_form(ValueForm::Number(Some($range))),
            check: |recipe| {
                let (range, number) = ($range, recipe.$($field).+);
                let is_inside = range.contains(&number);
                is_inside.then_some(()).ok_or_else(|| {
                    format!("must lie in {}…{}, not {number}", range.start(), range.end())
                })
            },
            ..field!(@convert $($field).+)
        }
    };
    (@convert $($field:ident).+) => {
        Access {
            values: Values::default,
            read: |recipe| recipe.$($field).+.text(),
            write: |recipe, text| {
                recipe.$($field).+ = SettingValue::parse(text)?;
                Ok(())
            },
            check: |_| Ok(()),
        }
    };
}

/// Access to an option of the upscaler by functions that read it from, and write it to, an [`Upscaling`], and one that
/// returns the values that a method offers.
macro_rules! option {
    ($read:expr, $write:expr, $offered:expr) => {
        Access {
            values: || offered_by_any($offered),
            read: |recipe| {
                let read: fn(Upscaling) -> _ = $read;
                read(recipe.upscaler).text()
            },
            write: |recipe, text| {
                choose(recipe, text, UpscalerOption { read: $read, write: $write, offered: $offered })
            },
            check: |_| Ok(()),
        }
    };
}

/// Access to a field of the [`HistoryOptions`] of the upscaler.
macro_rules! history_option {
    ($field:ident: $type:ty) => {
        option!(
            |upscaling: Upscaling| upscaling.history().$field,
            |upscaling: Upscaling, $field: $type| {
                upscaling.with_history(HistoryOptions { $field, ..upscaling.history() })
            },
            |offers| all_or(offers.history, &HistoryOptions::DEFAULT.$field)
        )
    };
}

setting_keys! {
    Address = "address", Shade placed, "Texture wrap", "Texels for texture coordinates outside 0…1",
        field!(pipeline.address), also ["wrap", "texture wrap", "tiling"];
    Alpha = "alpha", Shade placed, "Alpha", "Treatment of alpha when the filter mixes texels",
        field!(pipeline.alpha), also ["premultiplied alpha"];
    AntialiasLight = "antialias.light", Upscale placed, "Averaged values",
        "Values that are averaged into a pixel: linear light or sRGB codes", field!(antialias.light);
    AntialiasMethod = "antialias.method", Upscale placed, "Anti-aliasing",
        "Reduction of jagged edges and moiré: method and sample pattern",
        field!(antialias.method), also ["aa", "antialiasing", "supersampling", "ssaa"];
    AntialiasSamples = "antialias.samples", Upscale placed, "Samples", "Samples per rendered pixel", field!(antialias.samples);
    AntialiasSeed = "antialias.seed", Upscale placed, "Seed", "Different seeds give different sample positions",
        field!(antialias.seed);
    Arithmetic = "arithmetic", Rasterize placed, "Arithmetic", "Number format in which coverage is computed",
        field!(pipeline.arithmetic);
    Background = "background", Shade placed, "Background", "Colour of the pixels that no triangle covers",
        field!(pipeline.background), also ["clear color", "sky"];
    BlendingOrder = "blending.order", Shade placed, "Blending order",
        "Order in which the fragments of blended materials are blended", field!(pipeline.blending.order);
    CheckerEven = "checker.even", Shade placed, "Even square", "Colour of every other square of the checkerboard",
        field!(pipeline.checker.even);
    CheckerOdd = "checker.odd", Shade placed, "Odd square", "Colour of every other square of the checkerboard",
        field!(pipeline.checker.odd);
    CheckerSquares = "checker.squares", Shade placed, "Squares",
        "Number of checkerboard squares per unit of texture coordinate", field!(pipeline.checker.squares);
    ColorSpace = "color_space", Shade placed, "Colour space",
        "Colour space in which light is computed and textures are filtered", field!(pipeline.color_space);
    Culling = "culling", Cull, "Culling", "Facing of the triangles that are culled",
        field!(pipeline.culling), also ["backface", "back face"];
    DepthBiasConstant = "depth_bias.constant", Depth placed, "Constant bias",
        "Added to all depths of a triangle before the test, in the smallest steps of the format: for floats, units in \
         the last place of the triangle's greatest depth. A positive bias moves surfaces away, or towards the viewer \
         with a reversed format",
        field!(pipeline.depth_bias.constant), also ["polygon offset"];
    DepthBiasSlope = "depth_bias.slope", Depth placed, "Slope-scaled bias",
        "Added to all depths of a triangle before the test, times its slope: the change of its depth per pixel along x \
         or y, whichever is greater",
        field!(pipeline.depth_bias.slope), also ["polygon offset"];
    DepthFormat = "depth_format", Depth placed, "Format",
        "Number format of the depth buffer, and mapping of distance to depth", field!(pipeline.depth_format);
    DepthTest = "depth_test", Depth placed, "Test",
        "Depth test: condition under which a fragment replaces the stored one",
        field!(pipeline.depth_test), also ["depth compare", "zfunc"];
    Execution = "execution", Rasterize placed, "Execution",
        "Tile by tile on all threads, or triangle by triangle on one; the picture is the same, bit for bit",
        field!(execution);
    FillRule = "fill_rule", Rasterize placed, "Fill rule",
        "Rule that decides whether a pixel centre exactly on an edge is covered",
        field!(pipeline.fill_rule), also ["top left rule"];
    Filter = "filter", Shade placed, "Filter", "Filter that samples a texture between texel centres",
        field!(pipeline.filter), also ["mipmap", "mip", "sampler"];
    Force = "force", Hidden, "Disabled optimisation",
        "Parts of the pipeline that run even in draws that do not need them", field!(pipeline.force);
    Interpolation = "interpolation", Interpolate, "Attributes",
        "Interpolation of texture coordinates, normals and colours", field!(pipeline.interpolation);
    LightAmbient = "light.ambient", Shade placed, "Ambient",
        "Fraction of the light that reaches every surface, whatever its direction",
        field!(pipeline.light.ambient in 0.0..=1.0), also ["brightness"];
    LightDirection = "light.direction", Shade placed, "Light direction", "World-space direction towards the light",
        Access {
            values: || values_of(|recipe| &recipe.pipeline.light.direction).restricted("not all of them 0"),
            check: |recipe| match recipe.pipeline.light.direction {
                glam::Vec3::ZERO => Err("must not be zero".to_owned()),
                direction => check_finite(&direction),
            },
            ..field!(pipeline.light.direction)
        }, also ["sun"];
    MaxAnisotropy = "max_anisotropy", Shade placed, "Max. anisotropy",
        "Maximum number of samples per pixel along the major axis of its footprint",
        field!(pipeline.max_anisotropy), also ["anisotropic filtering"];
    MipBias = "mip_bias", Shade placed, "Mip bias",
        "Added to the level of detail, in mip levels: negative values are sharper but show moiré. Temporal upscalers \
         that draw fewer pixels want log₂(drawn width / full width) − 1",
        field!(pipeline.mip_bias in MIP_BIAS), also ["lod bias", "texture sharpness"];
    PostAngle = "post.angle_degrees", Upscale placed, "Direction", "Direction of the motion, clockwise from the right",
        field!(post.angle_degrees);
    PostFilter = "post.filter", Upscale placed, "Post filter", "Filter applied to the finished picture",
        Access {
            write: |recipe, text| {
                recipe.post = recipe.post.with_filter(SettingValue::parse(text)?);
                Ok(())
            },
            ..field!(post.filter)
        };
    PostLight = "post.light", Upscale placed, "Filter space",
        "Values that the post filter mixes: linear light or sRGB codes", field!(post.light);
    PostMask = "post.mask", Upscale placed, "Mask", "Weights of the custom convolution mask", field!(post.mask);
    PostStrength = "post.strength", Upscale placed, "Strength",
        "Radius, deviation, amount or distance of the post filter",
        Access {
            values: || f32::values().restricted(strength_ranges()),
            check: |recipe| recipe.post.check_strength(),
            ..field!(post.strength)
        };
    Rasterizer = "rasterizer", Rasterize placed, "Algorithm", "Algorithm that finds the samples inside a triangle",
        field!(pipeline.rasterizer), also ["scanline"];
    Shading = "shading", Shade placed, "Shading", "Source of the fragments' colour", field!(pipeline.shading);
    UpscalerAnchor = "upscaler.anchor", Upscale placed, "Anchor",
        "Position of a drawn sample in the block of pixels that it represents",
        option!(
            Upscaling::anchor,
            Upscaling::with_anchor,
            |offers| Values::of_words(offers.anchors.iter().copied().map(Word::of))
        );
    UpscalerDeringing = "upscaler.deringing", Upscale placed, "De-ringing",
        "Clamps each pixel to the range of the drawn pixels around it",
        option!(Upscaling::deringing, Upscaling::with_deringing, |offers| all_or(offers.deringing, &false));
    UpscalerHistoryFilter = "upscaler.history.filter", Upscale placed, "History filter",
        "Filter that reads the history between its pixels",
        history_option!(filter: HistoryFilter);
    UpscalerLuminanceWeighting = "upscaler.history.luminance_weighting", Upscale placed, "Luminance weighting",
        "Blends colours with weights 1 / (1 + luminance)",
        history_option!(luminance_weighting: bool);
    UpscalerRectification = "upscaler.history.rectification", Upscale placed, "Rectification",
        "Change of the history so that it agrees with the samples around the pixel",
        history_option!(rectification: Rectification);
    UpscalerLight = "upscaler.light", Upscale placed, "Filtered values",
        "Values that are filtered: sRGB codes or linear light",
        option!(
            Upscaling::light,
            Upscaling::with_light,
            |offers| Values::of_words(offers.lights.iter().copied().map(Word::of))
        );
    UpscalerMethod = "upscaler.method", Upscale placed, "Method",
        "Upscaling method, which reconstructs the pixels that are not drawn",
        Access {
            values: methods,
            read: |recipe| recipe.upscaler.method().to_owned(),
            write: choose_method,
            check: |_| Ok(()),
        };
    UpscalerScale = "upscaler.scale", Upscale placed, "Scale", "Scale factor per axis: ×4 draws one of sixteen pixels",
        option!(
            Upscaling::scale,
            |upscaling: Upscaling, scale: Scale| upscaling.with_scale(scale),
            |offers| Values::of_words(offers.scales.iter().map(|scale| Word::plain(scale.to_string())))
        );
    UpscalerSharpening = "upscaler.sharpening", Upscale placed, "Sharpening",
        "Strength, in percent of the strongest sharpening that creates no new extremes",
        option!(
            Upscaling::sharpening,
            Upscaling::with_sharpening,
            |offers| if offers.sharpening {
                Values::of_form(ValueForm::Percent(MAX_SHARPENING))
            } else {
                Values::of_words([Word::plain("0")])
            }
        );
    Wireframe = "wireframe", Rasterize placed, "Wireframe", "Draws the snapped edges of all drawn triangles over the picture",
        field!(wireframe), also ["wireframe", "wire", "lines"];
}

impl SettingKey {
    /// Returns the setting with this key, which may be written with `-` in place of `_`; `None` if there is none.
    pub fn by_id(id: &str) -> Option<Self> {
        let id = id.trim().replace('-', "_");
        Self::ALL.iter().copied().find(|key| key.id() == id)
    }

    /// Returns the pipeline stage whose switches include the setting.
    pub fn stage(self) -> SettingStage {
        self.declaration().stage
    }

    /// Whether the window draws the switch of the setting at a place of its own among those of the stage.
    pub fn is_placed(self) -> bool {
        self.declaration().is_placed
    }

    /// Returns the values that the setting accepts. For options of the upscaler, these are the values that any method
    /// accepts.
    pub fn values(self) -> Values {
        (self.declaration().access.values)()
    }

    /// Returns the value of the setting in the syntax of [`Recipe::set`].
    pub fn read(self, recipe: &Recipe) -> String {
        (self.declaration().access.read)(recipe)
    }

    /// Returns the words that the setting accepts in `recipe`.
    pub fn choices(self, recipe: &Recipe) -> Vec<Word> {
        let is_accepted = |word: &Word| {
            let mut changed = *recipe;
            self.write(&mut changed, &word.id).is_ok()
        };
        self.values().words.into_iter().filter(is_accepted).collect()
    }

    /// Whether the setting is an option of the upscaler, whose values depend on the method.
    pub fn is_upscaler_option(self) -> bool {
        self.is_of_upscaler() && self != Self::UpscalerMethod
    }

    /// Whether the setting is the upscaler's method or one of its options.
    pub fn is_of_upscaler(self) -> bool {
        self.id().starts_with("upscaler.")
    }

    /// Changes the value. Returns an error message if it is not one that the setting accepts; then `recipe` may have
    /// changed.
    pub(super) fn write(self, recipe: &mut Recipe, text: &str) -> Result<(), String> {
        (self.declaration().access.write)(recipe, text)?;
        self.check(recipe)
    }

    /// Returns an error message if the value is out of range.
    pub(super) fn check(self, recipe: &Recipe) -> Result<(), String> {
        (self.declaration().access.check)(recipe)
    }
}

/// Returns all values of the type of a field.
fn values_of<T: SettingValue>(_field: fn(&Recipe) -> &T) -> Values {
    T::values()
}

fn check_finite(value: &impl SettingValue) -> Result<(), String> {
    if value.is_finite() { Ok(()) } else { Err("must be finite".to_owned()) }
}

/// Returns the ranges of the strength of all post filters that have one.
fn strength_ranges() -> String {
    let range = |filter: &PostFilterKind| Some(format!("0…{} for {}", filter.max_strength()?, filter.id()));
    PostFilterKind::ALL.iter().filter_map(range).collect::<Vec<_>>().join(", ")
}

/// Returns all values of a type if a method offers a choice, otherwise only `default`.
fn all_or<T: SettingValue>(is_offered: bool, default: &T) -> Values {
    if is_offered { T::values() } else { Values::of_words([Word::plain(default.text())]) }
}

/// Returns the values of which any upscaling method offers a choice.
fn offered_by_any(offered: fn(Offers) -> Values) -> Values {
    let mut all = Values::default().restricted("where the method offers a choice");
    for values in upscale::all().iter().map(|method| offered(method.offers())) {
        if values.words.len() > 1 || values.form.is_some() {
            let new = values.words.into_iter().filter(|word| !all.words.contains(word));
            all.words.extend(new.collect::<Vec<_>>());
            all.form = values.form.or(all.form);
        }
    }
    all
}

/// Option of the upscaler: how to read and to replace it, and the values that a method offers.
#[derive(Clone, Copy)]
struct UpscalerOption<T> {
    read: fn(Upscaling) -> T,
    write: fn(Upscaling, T) -> Upscaling,
    offered: fn(Offers) -> Values,
}

/// Replaces an option of the upscaler. Returns an error message if the method does not offer the value.
fn choose<T: SettingValue + PartialEq + Copy>(
    recipe: &mut Recipe,
    text: &str,
    option: UpscalerOption<T>,
) -> Result<(), String> {
    let wanted = T::parse(text)?;
    recipe.upscaler = (option.write)(recipe.upscaler, wanted);
    if (option.read)(recipe.upscaler) == wanted {
        return Ok(());
    }
    let offered = (option.offered)(recipe.upscaler.upscaler().offers());
    Err(format!("`{}` offers {offered}", recipe.upscaler.method()))
}

/// Returns the ids of all upscaling methods.
fn methods() -> Values {
    Values::of_words(upscale::all().into_iter().map(|method| Word {
        id: method.id().to_owned(),
        name: method.name().to_owned(),
        help: method.help(),
        synonyms: &[],
    }))
}

/// Selects an upscaling method with its default options. Returns an error message if there is none with this id.
fn choose_method(recipe: &mut Recipe, text: &str) -> Result<(), String> {
    let chosen = recipe.upscaler.with_method(&text.replace('_', "-"));
    recipe.upscaler = chosen.ok_or_else(|| methods().refuse(text))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    /// Returns the dotted paths of all values in a tree.
    fn leaves(tree: &Value, prefix: &str) -> Vec<String> {
        let Value::Object(fields) = tree else { return vec![prefix.to_owned()] };
        let name = |name: &str| if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") };
        fields.iter().flat_map(|(field, value)| leaves(value, &name(field))).collect()
    }

    #[test]
    fn every_field_of_a_recipe_is_declared_once() {
        let fields = leaves(&serde_json::to_value(Recipe::default()).unwrap(), "");
        let declared: Vec<_> = SettingKey::ALL.iter().map(|key| key.id().to_owned()).collect();
        assert_eq!(declared, fields);
    }

    #[test]
    fn values_of_all_kinds_are_described() {
        for (key, values) in [
            (SettingKey::Culling, "none, back, front"),
            (SettingKey::Wireframe, "true, false"),
            (SettingKey::MipBias, "number, -4…4"),
            (SettingKey::AntialiasSeed, "whole number"),
            (SettingKey::PostMask, "9 or 25 comma-separated numbers, row by row"),
            (SettingKey::LightDirection, "3 comma-separated numbers, not all of them 0"),
            (SettingKey::Background, "scene, #rrggbb"),
            (SettingKey::UpscalerSharpening, "0…100 %, where the method offers a choice"),
            (SettingKey::UpscalerAnchor, "corner, centre, where the method offers a choice"),
        ] {
            assert_eq!(key.values().to_string(), values, "{key:?}");
        }
    }
}
