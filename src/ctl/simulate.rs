//! `simulate`: a recording of a flight that never was, with its true attitude beside it.

use super::cli::SimulateArgs;
use super::error::CtlError;
use crate::frame::Frame;
use crate::head::{Head, SensorKind};
use crate::recording::{Reference, Writer};
use crate::simulation::fault::kind;
use crate::simulation::scenario::LIST;
use crate::simulation::{Scenario, SimulatedSource};
use crate::source::FrameSource;
use crate::time::Time;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write};

/// As much as waits in memory, bytes.
const BUFFER: usize = 64 * 1024;

/// Writes `frames` frames of `source`, `rate_hz` a second from second 0 on, under a header.
pub fn simulate(
    source: &mut SimulatedSource,
    head: &Head,
    rate_hz: f64,
    frames: u64,
    out: &mut dyn Write,
) -> io::Result<()> {
    let writer = Writer::new(head, &configuration(head));
    let mut frame = Frame::new(head.sensors.len());
    let mut line = writer.reference_header();
    for i in 0..frames {
        out.write_all(line.as_bytes())?;
        let tick = Time::from_secs_f64(i as f64 / rate_hz);
        source.scan(tick, &mut frame);
        let truth = source.truth_at(tick);
        let [roll_deg, pitch_deg, yaw_deg] =
            [truth.roll, truth.pitch, source.yaw_at(tick)].map(|angle| Some(angle.to_degrees()));
        line.clear();
        writer.reference_row(&frame, &Reference { roll_deg, pitch_deg, yaw_deg }, &mut line);
    }
    out.write_all(line.as_bytes())?;
    out.flush()
}

/// What a replay must be told of a head that its columns do not tell: where the pairs look.
fn configuration(head: &Head) -> String {
    let mut text = String::new();
    for (i, sensor) in head.sensors.iter().enumerate() {
        if let SensorKind::Pair { neutral_v, kelvin_per_v } = sensor.kind {
            let _ = write!(
                text,
                "[[sensor]]\nname = \"{}\"\nkind = \"ads1115\"\nbus = \"/dev/i2c-1\"\naddress = 0x48\n\
                 input = \"ain{i}\"\ndirection = \"{}\"\nneutral-v = {neutral_v:?}\nkelvin-per-v = {kelvin_per_v:?}\n",
                sensor.name, sensor.direction
            );
        }
    }
    text
}

/// Does what the command line says; a summary goes to `err`.
pub fn command(args: &SimulateArgs, out: &mut dyn Write, err: &mut dyn Write) -> Result<(), CtlError> {
    let Some(mut scenario) = args.scenario.as_deref().filter(|_| !args.list).and_then(Scenario::named) else {
        let mut list: String = LIST.iter().map(|(name, about)| format!("{name:<16} {about}\n")).collect();
        list += "\nFaults, --fault KIND=STRENGTH:WHO@FROM..TO, with the strength when not said; SENSOR can be all, SIDE is\n\
                 left, right, or ° clockwise from north:\n";
        list += &kind::list();
        return out.write_all(list.as_bytes()).and_then(|()| out.flush()).map_err(CtlError::Output);
    };
    scenario = scenario.lasting(args.seconds);
    if args.scripted {
        scenario = scenario.scripted(args.seed);
    }
    if args.no_aiding {
        scenario = scenario.with_instruments(None);
    }
    if args.differential {
        scenario = scenario.differential();
    }
    let (head, frames) = (scenario.head(), (args.seconds * args.rate).round().max(1.0) as u64);
    let names: Vec<&str> = head.sensors.iter().map(|s| s.name.as_str()).collect();
    args.faults.iter().try_for_each(|fault| fault.check(&names).and_then(|()| fault.check_time(args.seconds)))?;
    let write = |sink: &mut dyn Write| {
        let mut out = BufWriter::with_capacity(BUFFER, sink);
        let mut source = scenario.source(args.seed).with_faults(args.faults.clone());
        simulate(&mut source, &head, args.rate, frames, &mut out)
    };
    match &args.output {
        None => write(out).map_err(CtlError::Output)?,
        Some(path) => File::create(path).and_then(|mut file| write(&mut file)).map_err(|source| CtlError::Write {
            path: path.clone(),
            rows: None,
            source,
        })?,
    }
    let _ = writeln!(err, "{} with seed {}: {frames} frames over {:.1} s", scenario.name(), args.seed, args.seconds);
    Ok(())
}
