//! `score`: methods of estimation, and other programs, side by side against a recording's reference.
//!
//! - [`statistics`]: errors, and what is said of many.
//! - `row`: which rows count, and what others said at their time.
//! - `table`: scores for people.

mod row;
pub mod statistics;
mod table;

use super::error::{CtlError, printable};
use super::kit::{Kit, Pipeline};
use super::opening::{Fresh, Opened, allowed, open, tell_tally, with_method};
use super::recording_args::{Beside, MethodChoice, ScoreArgs, ScoreFormat};
use super::run::{json, print};
use crate::attitude::Estimate;
use crate::config::Settings;
use crate::config::settings::Method;
use crate::frame::{Aiding, Frame};
use crate::head::Head;
use row::{Filter, Other};
use serde::Serialize;
use statistics::{Errors, Said, Score, Truth};
use std::io::Write;

/// What `score --format json` prints.
#[derive(Debug, Serialize)]
struct Answer {
    file: String,
    /// Rows that are compared: given or withheld.
    rows: u64,
    skip_s: f64,
    min_ground_speed_m_s: Option<f64>,
    methods: Vec<Named>,
}

/// A method's score.
#[derive(Debug, Serialize)]
struct Named {
    name: String,
    #[serde(flatten)]
    score: Score,
}

impl Named {
    /// With four decimals of each figure.
    fn new((name, mut score): (String, Score)) -> Self {
        for figure in score.figures().into_iter().flatten() {
            *figure = (*figure * 1e4).round() / 1e4 + 0.0;
        }
        Self { name, score }
    }
}

/// A method on its way through the recording.
struct Runner {
    name: &'static str,
    pipeline: Pipeline,
    estimate: Estimate,
    fresh: Fresh,
    errors: Errors,
}

impl Runner {
    fn new(method: Method, settings: &Settings, head: &Head, kit: &Kit) -> Self {
        let pipeline = (kit.pipeline)(&with_method(settings, method), head);
        let (estimate, fresh, errors) = Default::default();
        Self { name: method.as_str(), pipeline, estimate, fresh, errors }
    }

    fn step(&mut self, frame: &Frame, truth: Option<Truth>) {
        (self.pipeline)(frame, &mut self.estimate);
        let given = self.fresh.take(&self.estimate).attitude();
        if let Some(truth) = truth {
            let said = given.map(|a| Said::new(a, self.estimate.sigma));
            self.errors.add(truth, said);
        }
    }
}

/// Does what the command line says; notices go to `err`.
pub fn command(args: &ScoreArgs, kit: &Kit, out: &mut dyn Write, err: &mut dyn Write) -> Result<(), CtlError> {
    let Opened { settings, mut reader } = open(&args.recording, kit, err)?;
    let path = &args.recording.file;
    if let Some(column) = reader.lacks_reference() {
        return Err(CtlError::NoReference { path: path.clone(), column });
    }
    let head = reader.head().clone();
    let methods = methods(&args.methods, &settings, &head)?;
    let mut names: Vec<&str> = methods.iter().map(|m| m.as_str()).collect();
    for Beside { name, .. } in &args.beside {
        if names.contains(&name.as_str()) {
            return Err(CtlError::SameName(name.clone()));
        }
        names.push(name);
    }
    let mut runners: Vec<Runner> = methods.into_iter().map(|m| Runner::new(m, &settings, &head, kit)).collect();
    let mut others = args.beside.iter().map(Other::open).collect::<Result<Vec<_>, _>>()?;
    let mut filter = Filter::new(args.skip, args.min_ground_speed);
    let mut frame = Frame::default();
    let (mut rows, mut compared) = (0_u64, 0_u64);
    while reader.next_frame(&mut frame)? {
        rows += 1;
        let truth = filter.truth(&frame, reader.reference());
        compared += u64::from(truth.is_some());
        if args.recording.no_aiding {
            frame.aiding = Aiding::default();
        }
        for runner in &mut runners {
            runner.step(&frame, truth);
        }
        for other in &mut others {
            other.step(frame.time, truth)?;
        }
    }
    tell_tally(&reader, err);
    let left_out = filter.describe();
    if compared == 0 {
        return Err(CtlError::NothingToScore { path: path.clone(), rows, left_out });
    }
    if let Some(other) = others.iter().find(|o| !o.has_met()) {
        return Err(CtlError::OtherFlight { path: other.path().to_owned(), recording: path.clone() });
    }
    let mut scores: Vec<(String, Score)> = runners.into_iter().map(|r| (r.name.to_owned(), r.errors.score())).collect();
    scores.extend(others.into_iter().map(Other::score));
    let file = path.display().to_string();
    let text = match args.format {
        ScoreFormat::Plain => {
            let file = printable(&file);
            format!("{file}: {compared} of {rows} rows compared; left out: {left_out}\n\n{}", table::table(&scores))
        }
        ScoreFormat::Json => {
            let (skip_s, min_ground_speed_m_s) = (args.skip, args.min_ground_speed);
            let methods = scores.into_iter().map(Named::new).collect();
            json(&Answer { file, rows: compared, skip_s, min_ground_speed_m_s, methods })?
        }
    };
    print(out, &text)
}

/// The methods asked for, each once, in the order of first mention.
fn methods(choices: &[MethodChoice], settings: &Settings, head: &Head) -> Result<Vec<Method>, CtlError> {
    let mut methods = Vec::new();
    for choice in choices {
        match choice {
            MethodChoice::All => methods.extend(Method::NAMED.iter().map(|(_, m)| *m).filter(|m| m.suits(head))),
            MethodChoice::One(m) => methods.push(allowed(head, *m)?),
        }
    }
    if methods.is_empty() {
        methods.push(settings.estimator.method_for(head));
    }
    let mut once = Vec::new();
    for m in methods {
        if !once.contains(&m) {
            once.push(m);
        }
    }
    Ok(once)
}
