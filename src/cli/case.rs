//! `rasterscope case`: answers to numerical cases, as JSON.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use rasterscope::case::{Case, CaseResult, Options, Outcome, solve};
use rasterscope::disk;
use rasterscope::pipeline::settings::{Arithmetic, Rasterizer};

use super::failure::Failure;
use super::{output, parse};

/// What `case` takes.
#[derive(Args, Debug)]
pub(crate) struct CaseArgs {
    /// Files with one case each
    #[arg(required = true, value_name = "CASE.json")]
    cases: Vec<PathBuf>,

    /// The file for the result of a single case; standard output if omitted
    #[arg(short, long, value_name = "RESULT.json", conflicts_with = "out_dir")]
    output: Option<PathBuf>,

    /// The folder for results of many cases, one file for each, named after its id; made if missing
    #[arg(long, value_name = "DIR")]
    out_dir: Option<PathBuf>,

    /// How the samples inside a triangle are found
    #[arg(long, value_name = "R", default_value = "bounding-box", value_parser = parse::choice::<Rasterizer>())]
    rasterizer: Rasterizer,

    /// The numbers that coverage is decided in
    #[arg(long, value_name = "A", default_value = "fixed", value_parser = parse::choice::<Arithmetic>())]
    arithmetic: Arithmetic,
}

impl CaseArgs {
    fn options(&self) -> Options {
        Options { rasterizer: self.rasterizer, arithmetic: self.arithmetic }
    }
}

/// Answers one case or many.
pub(crate) fn run(args: &CaseArgs) -> Result<(), Failure> {
    match (&args.out_dir, &args.cases[..]) {
        (Some(folder), cases) => answer_all(cases, folder, args.options()),
        (None, [case]) => answer_one(case, args.output.as_deref(), args.options()),
        (None, cases) => Err(Failure::Usage(format!("{} cases need --out-dir for their results", cases.len()))),
    }
}

fn answer_one(case: &Path, into: Option<&Path>, options: Options) -> Result<(), Failure> {
    let result = solve(&Case::read(case)?, options);
    let Some(path) = into else { return output::print(&line(&result)?) };
    write_file(&result, path)?;
    let outcome = match &result.outcome {
        Outcome::Answered(_) => "answered",
        Outcome::Refused { error } => &format!("refused, as {error}"),
    };
    output::print(&format!("{}: {outcome}\n", output::display(path)))
}

/// Answers all that can be read. The failure of the last one that cannot is the failure of the whole; those before it
/// are told as they come.
fn answer_all(cases: &[PathBuf], folder: &Path, options: Options) -> Result<(), Failure> {
    // A result must not replace a case that is still to be read.
    cases.iter().for_each(|path| disk::note_input(path));
    fs::create_dir_all(folder).map_err(|source| Failure::ResultFile { path: folder.to_owned(), source })?;
    let mut ids = HashSet::new();
    let mut failure: Option<Failure> = None;
    let (mut answered, mut refused) = (0, 0);
    for path in cases {
        match read_unlike(path, &mut ids) {
            Ok(case) => {
                let result = solve(&case, options);
                *(if matches!(result.outcome, Outcome::Answered(_)) { &mut answered } else { &mut refused }) += 1;
                write_file(&result, &folder.join(format!("{}.json", case.id)))?;
            }
            Err(new) => {
                if let Some(earlier) = failure.replace(new) {
                    output::complain("error", earlier);
                }
            }
        }
    }
    output::print(&format!("{}: {answered} cases answered, {refused} refused\n", output::display(folder)))?;
    failure.map_or(Ok(()), Err)
}

/// Reads a case whose id none had before, as its result would replace the other one's.
fn read_unlike(path: &Path, ids: &mut HashSet<String>) -> Result<Case, Failure> {
    let case = Case::read(path)?;
    if ids.insert(case.id.clone()) {
        Ok(case)
    } else {
        Err(Failure::Usage(format!("{}: an earlier case has the id `{}`, too", path.display(), case.id)))
    }
}

fn write_file(result: &CaseResult, path: &Path) -> Result<(), Failure> {
    output::write(path, &line(result)?)
}

/// A result as one line of JSON.
fn line(result: &CaseResult) -> Result<String, Failure> {
    Ok(serde_json::to_string(result).map_err(|error| Failure::Output(error.into()))? + "\n")
}
