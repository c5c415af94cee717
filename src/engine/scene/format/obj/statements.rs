//! Table of the OBJ and MTL statements that the loader recognises, including those that do not change the picture.
//!
//! The loader takes its warning texts from this table. A test compares the table in the manual with `markdown`, so that
//! both agree.

/// Kind of a statement: OBJ statement, MTL statement, or texture option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Statement of a model file (OBJ).
    Obj,
    /// Statement of a material library (MTL).
    Mtl,
    /// Option of a texture statement in a material library.
    Option,
}

/// Treatment of a statement by the loader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Treatment {
    /// The statement changes the picture, or names objects, groups or materials.
    Rendered,
    /// The statement has no effect. It gives one warning per file and keyword, with the first line and a count.
    Warned,
}

/// Statement that the loader recognises.
#[derive(Clone, Copy, Debug)]
pub struct Statement {
    /// Keyword of the statement in its usual spelling; matching is case-insensitive.
    pub keyword: &'static str,
    /// Kind of file or statement to which the keyword belongs.
    pub format: Format,
    /// Whether the statement is rendered or gives a warning.
    pub(crate) treatment: Treatment,
    /// Meaning of the statement; for a rendered statement, also its effect.
    pub(crate) meaning: &'static str,
}

macro_rules! table {
    ($($format:ident $treatment:ident { $($keyword:literal: $meaning:literal,)+ })+) => {
        &[$($(Statement {
            keyword: $keyword,
            format: Format::$format,
            treatment: Treatment::$treatment,
            meaning: $meaning,
        },)+)+]
    };
}

/// All statements that the loader recognises. Any other keyword is reported as unknown.
pub const STATEMENTS: &[Statement] = table! {
    Obj Rendered {
        "v": "position; a weight is ignored, three or four further numbers are a vertex colour",
        "vt": "texture coordinate; w is ignored",
        "vn": "normal; takes precedence over smoothing groups",
        "f": "face",
        "fo": "face, in the older spelling",
        "o": "object",
        "g": "group; begins an object",
        "s": "smoothing group; `off` and 0 give hard edges",
        "usemtl": "material of the faces below",
        "mtllib": "material libraries inside the model's folder",
    }
    Obj Warned {
        "p": "points",
        "l": "lines",
        "vp": "parameter-space vertices",
        "cstype": "type of curve or surface",
        "deg": "degree of curve or surface",
        "bmat": "basis matrix",
        "step": "step of the basis matrix",
        "curv": "curve",
        "curv2": "curve on a surface",
        "surf": "free-form surface",
        "parm": "parameters of a curve or surface",
        "trim": "trimming curve",
        "hole": "hole in a surface",
        "scrv": "special curve",
        "sp": "special point",
        "end": "end of a curve or surface",
        "con": "connected surfaces",
        "mg": "merging group",
        "bevel": "bevel interpolation",
        "c_interp": "colour interpolation",
        "d_interp": "dissolve interpolation",
        "lod": "level of detail",
        "shadow_obj": "shadow object",
        "trace_obj": "ray-tracing object",
        "ctech": "curve approximation",
        "stech": "surface approximation",
        "maplib": "texture-map library",
        "usemap": "texture map of the faces below",
        "call": "inclusion of another file",
        "csh": "shell command; never executed",
        "bsp": "superseded B-spline patch",
        "bzp": "superseded Bézier patch",
        "cdc": "superseded Cardinal curve",
        "cdp": "superseded Cardinal patch",
        "res": "superseded patch resolution",
        "#MRGB": "vertex colours of ZBrush, in comments",
    }
    Mtl Rendered {
        "newmtl": "begins a material",
        "Kd": "diffuse colour",
        "Ks": "specular colour, with `shading=blinn-phong`",
        "Ns": "specular exponent, with `shading=blinn-phong`",
        "Ke": "emitted colour, added after lighting",
        "d": "opacity; takes precedence over `Tr`",
        "Tr": "transparency, or opacity where the file indicates it (see `--tr`)",
        "map_Kd": "colour texture",
        "map_Ke": "texture of the emitted colour",
        "map_d": "opacity texture: alpha if the picture has any, else luminance",
        "norm": "tangent-space normal map",
        "map_Bump": "normal map if the picture is one; a height map gives a warning",
        "bump": "the same as `map_Bump`",
    }
    Mtl Warned {
        "Ka": "ambient colour; ambient light is a setting",
        "Ni": "index of refraction",
        "illum": "illumination model; `shading` is a setting",
        "Tf": "transmission filter",
        "Km": "bump factor",
        "sharpness": "sharpness of reflections",
        "map_Ka": "ambient texture",
        "map_Ks": "specular texture",
        "map_Ns": "specular exponent texture",
        "map_Tr": "transparency texture",
        "map_aat": "texture antialiasing; `filter` is a setting",
        "disp": "displacement map",
        "map_disp": "displacement map",
        "decal": "decal texture",
        "refl": "reflection map",
        "map_refl": "reflection map",
        "Pr": "roughness (PBR)",
        "Pm": "metalness (PBR)",
        "Ps": "sheen (PBR)",
        "Pc": "clearcoat thickness (PBR)",
        "Pcr": "clearcoat roughness (PBR)",
        "aniso": "anisotropy (PBR)",
        "anisor": "anisotropy rotation (PBR)",
        "map_Pr": "roughness texture (PBR)",
        "map_Pm": "metalness texture (PBR)",
        "map_Ps": "sheen texture (PBR)",
        "map_Pc": "clearcoat texture (PBR)",
        "map_Pcr": "clearcoat roughness texture (PBR)",
        "map_aniso": "anisotropy texture (PBR)",
        "map_anisor": "anisotropy rotation texture (PBR)",
        "map_RMA": "roughness, metalness and occlusion texture (PBR)",
        "map_ORM": "occlusion, roughness and metalness texture (PBR)",
    }
    Option Rendered {
        "-o": "offset of the texture coordinates, one for each material",
        "-s": "scale of the texture coordinates, one for each material",
        "-clamp": "texture coordinates are clamped, one for each material",
        "-bm": "factor of a normal map",
        "-imfchan": "channel of `map_d`: r, g, b, m (alpha), l (luminance)",
    }
    Option Warned {
        "-blendu": "horizontal blending",
        "-blendv": "vertical blending",
        "-boost": "sharpening of mip levels",
        "-cc": "colour correction",
        "-colorspace": "colour space",
        "-halo": "dissolve by viewing angle",
        "-mm": "brightness and contrast",
        "-t": "turbulence",
        "-texres": "texture resolution",
        "-type": "projection",
    }
};

/// Returns the statement with this keyword, ignoring case; `None` for an unknown keyword.
pub(crate) fn find(format: Format, keyword: &str) -> Option<&'static Statement> {
    STATEMENTS.iter().find(|s| s.format == format && s.keyword.eq_ignore_ascii_case(keyword))
}

impl Statement {
    /// Returns the text of the warning about a statement that is not rendered.
    pub(super) fn not_rendered(&self) -> String {
        format!("`{}` ({}) is not rendered", self.keyword, self.meaning)
    }
}

/// Returns the table of statements for the manual, with one row for each format.
#[cfg(test)]
pub(crate) fn markdown() -> String {
    let mut text = "| | rendered | read, not rendered: one warning each |\n| --- | --- | --- |\n".to_owned();
    for (format, title) in [(Format::Obj, "OBJ"), (Format::Mtl, "MTL"), (Format::Option, "texture options")] {
        let list = |treatment: Treatment| {
            let own = STATEMENTS.iter().filter(|s| s.format == format && s.treatment == treatment);
            own.map(|s| format!("`{}`", s.keyword)).collect::<Vec<_>>().join(" ")
        };
        text.push_str(&format!("| {title} | {} | {} |\n", list(Treatment::Rendered), list(Treatment::Warned)));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manual_has_this_table() {
        assert!(
            include_str!("../../../../../assets/manual/12-scenes-and-file-formats.md").contains(&markdown()),
            "the manual should have:\n{}",
            markdown()
        );
    }

    #[test]
    fn keywords_are_unique_ignoring_case() {
        for (i, a) in STATEMENTS.iter().enumerate() {
            let same = |b: &Statement| b.format == a.format && b.keyword.eq_ignore_ascii_case(a.keyword);
            assert!(!STATEMENTS[i + 1..].iter().any(same), "{}", a.keyword);
        }
    }
}
