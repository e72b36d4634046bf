//! `replay`: a recording through the daemon's own pipeline, as fast as it goes.

use super::cli::ReplayArgs;
use super::error::CtlError;
use super::kit::Kit;
use super::opening::{Fresh, Opened, not_over, open, tell_tally};
use crate::attitude::{Attitude, Estimate, Mode};
use crate::frame::{Aiding, Frame};
use crate::head::Head;
use crate::recording::{ReadError, Reader, push_digits, push_fixed};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufRead, BufWriter, Write};
use std::path::Path;

/// The columns of what `replay` writes.
pub const HEADER: &str = "time_s,roll_deg,pitch_deg,roll_sigma_deg,pitch_sigma_deg,contrast_c,mode,faults\n";
/// Digits of angles and contrast.
const DECIMALS: usize = 3;

/// What came out of a replay.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Frames that went through.
    pub frames: u64,
    /// From the first to the last, s.
    pub seconds: f64,
    /// Frames in each mode, in the order starting, nominal, degraded, faulted.
    pub modes: [u64; 4],
}

/// Why a replay stopped.
#[derive(Debug)]
pub enum Stop {
    /// The recording cannot be read on.
    Read(ReadError),
    /// The output cannot be written.
    Write(io::Error),
}

/// Writes a line for each frame of `reader` after `update` has seen it, and a header before the first; without its
/// aiding if so told.
pub fn replay<R: BufRead>(
    reader: &mut Reader<R>,
    no_aiding: bool,
    update: &mut dyn FnMut(&Frame, &mut Estimate),
    out: &mut dyn Write,
) -> Result<Summary, Stop> {
    let mut summary = Summary::default();
    let head = reader.head().clone();
    let mut frame = Frame::default();
    let mut estimate = Estimate::default();
    let mut line = String::with_capacity(256);
    let mut first = None;
    let mut fresh = Fresh::default();
    while reader.next_frame(&mut frame).map_err(Stop::Read)? {
        if no_aiding {
            frame.aiding = Aiding::default();
        }
        update(&frame, &mut estimate);
        line.clear();
        if summary.frames == 0 {
            line.push_str(HEADER);
        }
        row(&frame, &estimate, fresh.take(&estimate).attitude(), &head, &mut line);
        out.write_all(line.as_bytes()).map_err(Stop::Write)?;
        summary.frames += 1;
        summary.modes[estimate.mode as usize] += 1;
        summary.seconds = frame.time.since(*first.get_or_insert(frame.time));
    }
    out.flush().map_err(Stop::Write)?;
    Ok(summary)
}

/// Appends the line of one estimate; time is the frame's. Without angles where none are given.
fn row(frame: &Frame, estimate: &Estimate, given: Option<Attitude>, head: &Head, line: &mut String) {
    push_digits(line, frame.time.as_nanos().saturating_add(500) / 1_000, 6);
    let beside = |value: f64| if given.is_some() { value.to_degrees() } else { f64::NAN };
    let attitude = given.unwrap_or_default();
    for value in [
        beside(attitude.roll),
        beside(attitude.pitch),
        beside(estimate.sigma.roll),
        beside(estimate.sigma.pitch),
        estimate.contrast_k.unwrap_or(f64::NAN),
    ] {
        line.push(',');
        push_fixed(line, value, DECIMALS);
    }
    line.push(',');
    line.push_str(estimate.mode.as_str());
    line.push(',');
    for (i, fault) in estimate.faults.iter().enumerate() {
        let _ = write!(line, "{}{}", if i > 0 { "|" } else { "" }, fault.kind.display(head));
    }
    line.push('\n');
}

/// A file that is made when something is written to it: what is there stays where nothing is.
struct Late<'a> {
    path: &'a Path,
    file: Option<File>,
}

impl Write for Late<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(File::create(self.path)?),
        };
        file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_mut().map_or(Ok(()), Write::flush)
    }
}

/// Does what the command line says; notices and the summary go to `err`.
pub fn command(args: &ReplayArgs, kit: &Kit, out: &mut dyn Write, err: &mut dyn Write) -> Result<(), CtlError> {
    let Opened { settings, mut reader } = open(&args.recording, kit, err)?;
    let mut pipeline = (kit.pipeline)(&settings, reader.head());
    let result = match &args.output {
        None => {
            let mut out = BufWriter::with_capacity(64 * 1024, out);
            replay(&mut reader, args.recording.no_aiding, &mut pipeline, &mut out)
        }
        Some(path) => {
            not_over(path, &args.recording.file)?;
            let mut out = BufWriter::with_capacity(64 * 1024, Late { path, file: None });
            replay(&mut reader, args.recording.no_aiding, &mut pipeline, &mut out)
        }
    };
    tell_tally(&reader, err);
    match result {
        Ok(Summary { frames: 0, .. }) => Err(CtlError::NothingToReplay { path: args.recording.file.clone() }),
        Ok(summary) => {
            let _ = writeln!(err, "{}", describe(&summary));
            Ok(())
        }
        Err(Stop::Read(e)) => Err(e.into()),
        Err(Stop::Write(source)) => Err(match &args.output {
            Some(path) => CtlError::Write { path: path.clone(), rows: None, source },
            None => CtlError::Output(source),
        }),
    }
}

fn describe(summary: &Summary) -> String {
    let plural = if summary.frames == 1 { "" } else { "s" };
    let mut text = format!("{} frame{plural} over {:.1} s", summary.frames, summary.seconds);
    for mode in [Mode::Starting, Mode::Nominal, Mode::Degraded, Mode::Faulted] {
        let n = summary.modes[mode as usize];
        if n > 0 {
            let _ = write!(text, ", {mode} {:.1} %", 100.0 * n as f64 / summary.frames as f64);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::{ActiveFault, Evidence, FaultKind};
    use crate::time::Time;

    #[test]
    fn angles_are_empty_while_withheld_and_faults_are_joined() {
        let head = Head::six();
        let frame = Frame { time: Time::from_nanos(1_020_000_000), ..Frame::new(6) };
        let mut estimate = Estimate {
            attitude: Some(Attitude::from_degrees(-30.0, 5.25)),
            sigma: Attitude::from_degrees(1.0, 2.0),
            contrast_k: Some(30.0),
            mode: Mode::Nominal,
            ..Estimate::default()
        };
        let mut line = String::new();
        row(&frame, &estimate, estimate.attitude, &head, &mut line);
        assert_eq!(line, "1.020000,-30.000,5.250,1.000,2.000,30.000,nominal,\n");
        line.clear();
        row(&frame, &estimate, None, &head, &mut line);
        assert_eq!(line, "1.020000,,,,,30.000,nominal,\n");
        estimate.attitude = None;
        estimate.mode = Mode::Faulted;
        for kind in [FaultKind::LowContrast, FaultKind::SensorLost(0)] {
            let evidence = Evidence::Limit { value: 1.0, limit: 3.0, unit: "K" };
            estimate.faults.push(ActiveFault { kind, since: Time::default(), evidence });
        }
        line.clear();
        row(&frame, &estimate, estimate.attitude, &head, &mut line);
        assert_eq!(line, "1.020000,,,,,30.000,faulted,low-contrast|sensor-lost:nose\n");
    }
}
