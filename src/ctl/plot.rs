//! `plot`: a replayed flight, its errors, or the report's figures, as SVG.

use super::error::CtlError;
use super::kit::Kit;
use super::opening::{Fresh, Given, Opened, allowed, create, open, tell_tally, with_method};
use super::recording_args::{PlotArgs, PlotCommand};
use super::run::print;
use super::score::statistics::{Errors, Said, Score, Truth, wrapped};
use crate::attitude::Estimate;
use crate::frame::{Aiding, Frame};
use crate::head::Head;
use crate::plot::flight::{Flight, Row};
use crate::plot::report::figures;
use crate::plot::residuals::Residuals;
use crate::recording::Reference;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Does what the command line says; notices go to `err`.
pub fn command(what: &PlotCommand, kit: &Kit, out: &mut dyn Write, err: &mut dyn Write) -> Result<(), CtlError> {
    match what {
        PlotCommand::Flight(args) => {
            let mut flight = Flight::default();
            let pass = replay(args, kit, err, |shown| {
                let Shown { time_s, given, estimate, reference: r } = shown;
                let (attitude, nothing_new) = (given.attitude(), given == Given::Nothing);
                flight.add(Row { time_s, attitude, nothing_new, estimate, reference_deg: [r.roll_deg, r.pitch_deg] });
            })?;
            if flight.is_empty() {
                return Err(nothing(args, &pass));
            }
            finish(args, &flight.draw(&title(args), &pass.method, &pass.head), out)
        }
        PlotCommand::Residuals(args) => {
            let mut residuals = Residuals::default();
            let mut all = Errors::default();
            let pass = replay(args, kit, err, |shown| {
                if let Some((truth, said)) = shown.both() {
                    residuals.add(shown.time_s, Some(errors(truth, said)));
                    all.add(truth, Some(said));
                } else if shown.given == Given::Withheld {
                    residuals.add(shown.time_s, None);
                } else {
                    residuals.pass(shown.time_s);
                }
            })?;
            if let Some(column) = pass.lacks_reference {
                return Err(CtlError::NoReference { path: args.recording.file.clone(), column });
            }
            if residuals.is_empty() {
                let no_errors = |rows| CtlError::NoErrors { path: args.recording.file.clone(), rows };
                return Err(if pass.shown == 0 { nothing(args, &pass) } else { no_errors(pass.shown) });
            }
            finish(args, &residuals.draw(&title(args), &remark(&pass.method, &all.score())), out)
        }
        PlotCommand::Report { output_dir } => report(output_dir, out),
    }
}

/// A row that is drawn.
struct Shown<'a> {
    time_s: f64,
    given: Given,
    estimate: &'a Estimate,
    reference: Reference,
}

impl Shown<'_> {
    /// What holds and what was estimated, where there are both.
    fn both(&self) -> Option<(Truth, Said)> {
        let truth = Truth { roll_deg: self.reference.roll_deg?, pitch_deg: self.reference.pitch_deg? };
        Some((truth, Said::new(self.given.attitude()?, self.estimate.sigma)))
    }
}

/// What a replay leaves to say.
struct Pass {
    method: String,
    head: Head,
    lacks_reference: Option<&'static str>,
    /// The first and the last row's time, s.
    times_s: Option<(f64, f64)>,
    /// Rows that are drawn.
    shown: u64,
}

/// Runs the recording through the pipeline; `show` gets the rows that are drawn.
fn replay(args: &PlotArgs, kit: &Kit, err: &mut dyn Write, mut show: impl FnMut(Shown<'_>)) -> Result<Pass, CtlError> {
    let Opened { mut settings, mut reader } = open(&args.recording, kit, err)?;
    let head = reader.head().clone();
    if let Some(method) = args.method {
        settings = with_method(&settings, allowed(&head, method)?);
    }
    let mut pipeline = (kit.pipeline)(&settings, &head);
    let (mut frame, mut estimate, mut fresh) = (Frame::default(), Estimate::default(), Fresh::default());
    let (mut times_s, mut shown) = (None, 0);
    let wanted = args.from.unwrap_or(f64::NEG_INFINITY)..=args.to.unwrap_or(f64::INFINITY);
    while reader.next_frame(&mut frame)? {
        if args.recording.no_aiding {
            frame.aiding = Aiding::default();
        }
        pipeline(&frame, &mut estimate);
        let given = fresh.take(&estimate);
        let time_s = frame.time.as_secs_f64();
        times_s = Some((times_s.map_or(time_s, |(first, _)| first), time_s));
        if wanted.contains(&time_s) {
            shown += 1;
            show(Shown { time_s, given, estimate: &estimate, reference: reader.reference() });
        }
    }
    tell_tally(&reader, err);
    let method = format!("method {}", settings.estimator.method_for(&head).as_str());
    Ok(Pass { method, head, lacks_reference: reader.lacks_reference(), times_s, shown })
}

fn errors(truth: Truth, said: Said) -> [(f64, f64); 2] {
    let sigma = |s: Option<f64>| s.unwrap_or(f64::NAN);
    [
        (wrapped(said.roll_deg - truth.roll_deg), sigma(said.roll_sigma_deg)),
        (said.pitch_deg - truth.pitch_deg, sigma(said.pitch_sigma_deg)),
    ]
}

/// The method and the figures that count.
fn remark(method: &str, score: &Score) -> String {
    let degrees = |v: Option<f64>| v.map_or("–".to_owned(), |v| format!("{v:.2}°"));
    let percent = |v: Option<f64>| v.map_or("–".to_owned(), |v| format!("{v:.0} %"));
    format!(
        "{method}; rms: roll {}, pitch {}; within 2σ: roll {}, pitch {}",
        degrees(score.roll_rms_deg),
        degrees(score.pitch_rms_deg),
        percent(score.roll_in_2_sigma_percent),
        percent(score.pitch_in_2_sigma_percent)
    )
}

fn title(args: &PlotArgs) -> String {
    let file = &args.recording.file;
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

fn nothing(args: &PlotArgs, pass: &Pass) -> CtlError {
    CtlError::NothingToPlot { path: args.recording.file.clone(), times_s: pass.times_s }
}

fn finish(args: &PlotArgs, svg: &str, out: &mut dyn Write) -> Result<(), CtlError> {
    let Some(path) = &args.output else { return print(out, svg) };
    create(path, &args.recording.file)
        .and_then(|mut file| file.write_all(svg.as_bytes()).map_err(|source| failed(path, source)))
}

fn report(folder: &Path, out: &mut dyn Write) -> Result<(), CtlError> {
    fs::create_dir_all(folder).map_err(|source| failed(folder, source))?;
    for figure in figures() {
        let path = folder.join(format!("figure-{}.svg", figure.number));
        fs::write(&path, figure.svg).map_err(|source| failed(&path, source))?;
        print(out, &format!("{}\n", path.display()))?;
    }
    Ok(())
}

fn failed(path: &Path, source: std::io::Error) -> CtlError {
    CtlError::Write { path: path.to_owned(), rows: None, source }
}
