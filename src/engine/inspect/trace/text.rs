//! Plain-text form of a trace, for the command line and the clipboard.

use std::fmt;

use super::Trace;
use super::line::TraceLine;
use crate::pipeline::settings::Choice as _;

/// Writes the trace stage by stage: each line, then its formula with numbers, then its exact value.
impl fmt::Display for Trace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        match (self.fragment, self.triangle) {
            (Some(fragment), Some(triangle)) => {
                let of = format!("fragment {} of {}", fragment + 1, self.fragments);
                writeln!(f, "calculation of pixel {x}, {y}: {of}, triangle {} of “{}”", triangle.0, self.instance)?;
            }
            _ => writeln!(f, "calculation of pixel {x}, {y}: no triangle covers it")?,
        }
        if self.drawn_at != self.pixel {
            let [x, y] = self.drawn_at;
            writeln!(f, "the fragment lies at the drawn pixel {x}, {y}")?;
        }
        for (stage, lines) in self.stages() {
            writeln!(f, "\n{}: {}", stage.name(), stage.help())?;
            for line in lines {
                write_line(line, f)?;
            }
        }
        Ok(())
    }
}

fn write_line(line: &TraceLine, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let mark = if line.aside { "(not computed by the pipeline) " } else { "" };
    write!(f, "  {mark}{} = {}", line.what, line.value_text())?;
    if !line.kind.is_empty() {
        write!(f, " [{} {}]", line.kind, line.bits)?;
    }
    for flag in &line.flags {
        write!(f, "  ! {}", flag.words())?;
    }
    if line.numbers.is_empty() && line.exact.is_none() {
        return writeln!(f, "  ({})", line.formula);
    }
    writeln!(f)?;
    match line.numbers.as_str() {
        "" => writeln!(f, "      {}", line.formula)?,
        numbers => writeln!(f, "      {} = {numbers}", line.formula)?,
    }
    let Some(exact) = &line.exact else { return Ok(()) };
    let fraction = exact.fraction.as_ref().map_or_else(String::new, |fraction| format!(" = {fraction}"));
    match line.rounding_ulp {
        Some(0.0) => writeln!(f, "      exactly {}{fraction}: no rounding error", exact.decimal),
        Some(_) => writeln!(f, "      exactly {}{fraction}: off by {}", exact.decimal, line.rounding()),
        None => writeln!(f, "      exactly {}{fraction}: the exact result is finite", exact.decimal),
    }
}
