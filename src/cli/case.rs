//! `rasterscope case`: evaluates numerical cases and writes their answers as JSON.

use std::collections::HashSet;
use std::fs;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::case::{Case, CaseOutcome, CaseResult, Control, Options, solve};
use crate::disk;
use crate::pipeline::settings::{Arithmetic, Rasterizer};
use clap::Args;

use super::failure::Failure;
use super::{interrupt, output, parse};

/// Evaluate numerical cases: small inputs to one algorithm each, for comparison with exact answers
#[derive(Args, Debug)]
#[command(after_help = super::example("case line.json -o result.json"))]
pub(crate) struct CaseArgs {
    /// Files with one case each
    #[arg(required = true, value_name = "CASE.json")]
    cases: Vec<PathBuf>,

    /// File for the result of a single case; standard output if omitted
    #[arg(short, long, value_name = "RESULT.json", conflicts_with = "out_dir")]
    output: Option<PathBuf>,

    /// Folder for the results of many cases, one file each, named after the case's id; created if missing
    #[arg(long, value_name = "DIR")]
    out_dir: Option<PathBuf>,

    /// Algorithm that finds the samples inside a triangle
    #[arg(long, value_name = "R", default_value = "bounding-box", value_parser = parse::choice::<Rasterizer>())]
    rasterizer: Rasterizer,

    /// Arithmetic that decides coverage
    #[arg(long, value_name = "A", default_value = "fixed", value_parser = parse::choice::<Arithmetic>())]
    arithmetic: Arithmetic,
}

impl CaseArgs {
    fn options(&self) -> Options {
        Options { rasterizer: self.rasterizer, arithmetic: self.arithmetic }
    }
}

/// Runs `case`: evaluates one or more cases.
pub(crate) fn run(args: &CaseArgs) -> Result<(), Failure> {
    match (&args.out_dir, &args.cases[..]) {
        (Some(folder), cases) => answer_all(cases, folder, args.options()),
        (None, [case]) => answer_one(case, args.output.as_deref(), args.options()),
        (None, cases) => {
            Err(Failure::Usage(format!("{} cases need --out-dir, the folder for their results", cases.len())))
        }
    }
}

fn answer_one(case: &Path, into: Option<&Path>, options: Options) -> Result<(), Failure> {
    let result = solved(&Case::read(case)?, options)?;
    let Some(path) = into else {
        return unless_interrupted(output::print_by(|out| write_line(&result, out)));
    };
    write_file(&result, path)?;
    let outcome = match &result.outcome {
        CaseOutcome::Answered(_) => "answered",
        CaseOutcome::Refused { error } => &format!("refused: {error}"),
    };
    output::print(&format!("{}: {outcome}\n", output::display(path)))
}

/// Evaluates all readable cases and writes their results to `folder`. Returns the failure of the last unreadable case;
/// earlier failures are printed.
fn answer_all(cases: &[PathBuf], folder: &Path, options: Options) -> Result<(), Failure> {
    // A result must not overwrite a case that is still to be read.
    cases.iter().for_each(|path| disk::note_input(path));
    fs::create_dir_all(folder).map_err(|source| Failure::ResultFile { path: folder.to_owned(), source })?;
    let mut ids = HashSet::new();
    let mut failure: Option<Failure> = None;
    let (mut answered, mut refused) = (0, 0);
    for path in cases {
        match read_unlike(path, &mut ids) {
            Ok(case) => {
                let written = solved(&case, options).and_then(|result| {
                    write_file(&result, &folder.join(format!("{}.json", case.id)))?;
                    Ok(matches!(result.outcome, CaseOutcome::Answered(_)))
                });
                match written {
                    Ok(true) => answered += 1,
                    Ok(false) => refused += 1,
                    Err(Failure::Interrupted(_)) if answered + refused > 0 => {
                        return Err(Failure::Interrupted("the results of the completed cases are written"));
                    }
                    Err(failure) => return Err(failure),
                }
            }
            Err(new) => {
                if let Some(earlier) = failure.replace(new) {
                    output::report("error", earlier);
                }
            }
        }
    }
    output::print(&format!("{}: {answered} cases answered, {refused} refused\n", output::display(folder)))?;
    failure.map_or(Ok(()), Err)
}

/// Reads a case and adds its id to `ids`. Returns an error if an earlier case has the same id, because both results
/// would be written to the same file.
fn read_unlike(path: &Path, ids: &mut HashSet<String>) -> Result<Case, Failure> {
    let case = Case::read(path)?;
    if ids.insert(case.id.clone()) {
        Ok(case)
    } else {
        Err(Failure::Usage(format!("{}: an earlier case has the same id, `{}`", path.display(), case.id)))
    }
}

/// Evaluates a case; the first SIGINT cancels the evaluation.
fn solved(case: &Case, options: Options) -> Result<CaseResult, Failure> {
    solve(case, options, &Control::new(&|_| {}, interrupt::flag())).ok_or_else(interrupt::nothing)
}

fn write_file(result: &CaseResult, path: &Path) -> Result<(), Failure> {
    unless_interrupted(output::write_by(path, |file| write_line(result, file)))
}

/// Returns `outcome`, or a failure if the process was interrupted.
fn unless_interrupted(outcome: Result<(), Failure>) -> Result<(), Failure> {
    if interrupt::flag().load(Ordering::Relaxed) { Err(interrupt::nothing()) } else { outcome }
}

/// Writes a result as one line of JSON. It is written piece by piece, because the complete text may take several times
/// as much memory as the result.
fn write_line(result: &CaseResult, out: &mut dyn Write) -> io::Result<()> {
    let mut out = BufWriter::new(Interruptible { out, stop: interrupt::flag() });
    serde_json::to_writer(&mut out, result)?;
    out.write_all(b"\n")?;
    out.flush()
}

/// Writer that fails once the process is interrupted.
struct Interruptible<'a> {
    out: &'a mut dyn Write,
    stop: &'a AtomicBool,
}

impl Write for Interruptible<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // The caller would retry an error of the kind `Interrupted`.
        if self.stop.load(Ordering::Relaxed) { Err(ErrorKind::Other.into()) } else { self.out.write(bytes) }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
