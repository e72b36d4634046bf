//! Frames into a recording: the header once, then a line a frame into one string.

use super::format::{AIDING, AMBIENT, OBJECT, REFERENCE, TIME, VOLTS, aiding};
use super::number::{push_digits, push_fixed};
use super::reader::Reference;
use crate::frame::{Frame, Value};
use crate::head::{Head, SensorKind};

/// Digits of a temperature: the MLX90614's 0.02 K steps are exact with two.
const TEMPERATURE_DECIMALS: usize = 2;
/// Digits of a voltage: an ADS1115 step is 7.8 µV at its finest.
const VOLTS_DECIMALS: usize = 6;
/// Digits of aiding values, and of the reference.
const AIDING_DECIMALS: usize = 4;

/// Writes the frames of one head.
#[derive(Clone, Debug)]
pub struct Writer {
    absolute: Vec<bool>,
    header: String,
}

impl Writer {
    /// For frames of `head`, under a configuration that later goes into the recording.
    pub fn new(head: &Head, config: &str) -> Self {
        let mut header = format!("# irhorizon {}\n", env!("CARGO_PKG_VERSION"));
        for line in config.lines() {
            header.push_str(if line.is_empty() { "#" } else { "# " });
            header.push_str(line);
            header.push('\n');
        }
        header.push_str(TIME);
        for sensor in &head.sensors {
            let ends: &[&str] = match sensor.kind {
                SensorKind::Absolute { .. } => &[OBJECT, AMBIENT],
                SensorKind::Pair { .. } => &[VOLTS],
            };
            for end in ends {
                header.extend([",", &sensor.name, end]);
            }
        }
        for name in AIDING {
            header.extend([",", name]);
        }
        header.push('\n');
        let absolute = head.sensors.iter().map(|s| s.is_absolute()).collect();
        Self { absolute, header }
    }

    /// The header of a recording whose rows are [`reference_row`](Self::reference_row)s.
    pub fn reference_header(&self) -> String {
        format!("{},{}\n", self.header.trim_end(), REFERENCE.join(","))
    }

    /// The lines before the first row, line ends included: version, configuration, columns.
    pub fn header(&self) -> &str {
        &self.header
    }

    /// Appends the frame's row, line end included. Time is the end of the scan on the frame's own
    /// clock, to the microsecond.
    pub fn row(&self, frame: &Frame, line: &mut String) {
        self.cells(frame, line);
        line.push('\n');
    }

    /// Appends the frame's row with what a reference says beside it.
    pub fn reference_row(&self, frame: &Frame, reference: &Reference, line: &mut String) {
        self.cells(frame, line);
        push_cells([reference.roll_deg, reference.pitch_deg, reference.yaw_deg], line);
        line.push('\n');
    }

    fn cells(&self, frame: &Frame, line: &mut String) {
        push_digits(line, frame.time.as_nanos().saturating_add(500) / 1_000, 6);
        for (i, absolute) in self.absolute.iter().enumerate() {
            let value = frame.readings.get(i).and_then(|r| r.ok()).map(|s| s.value);
            line.push(',');
            match value {
                Some(Value::Absolute { object_c, ambient_c }) if *absolute => {
                    push_fixed(line, object_c, TEMPERATURE_DECIMALS);
                    line.push(',');
                    push_fixed(line, ambient_c.unwrap_or(f64::NAN), TEMPERATURE_DECIMALS);
                }
                Some(Value::Volts(v)) if !*absolute => push_fixed(line, v, VOLTS_DECIMALS),
                _ if *absolute => line.push(','),
                _ => {}
            }
        }
        push_cells(aiding(&frame.aiding), line);
    }
}

/// Appends a comma and a number, or nothing, for each value.
fn push_cells<const N: usize>(values: [Option<f64>; N], line: &mut String) {
    for value in values {
        line.push(',');
        push_fixed(line, value.unwrap_or(f64::NAN), AIDING_DECIMALS);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Missing, Sample};
    use crate::time::Time;

    #[test]
    fn a_frame_is_a_row_under_its_header() {
        let writer = Writer::new(&Head::six(), "[daemon]\n\nrate-hz = 50\n");
        let lines: Vec<_> = writer.header().lines().collect();
        assert!(lines[0].starts_with("# irhorizon "));
        assert_eq!(lines[1..4], ["# [daemon]", "#", "# rate-hz = 50"]);
        assert!(lines[4].starts_with("time_s,nose_obj_c,nose_amb_c,tail_obj_c,"));
        let mut frame = Frame::new(6);
        frame.time = Time::from_nanos(12_345_678_499);
        let value = Value::Absolute { object_c: -12.345, ambient_c: Some(20.0) };
        frame.readings[1] = Ok(Sample { value, time: frame.time });
        frame.readings[2] = Err(Missing::BadPec);
        frame.aiding.airspeed_m_s = Some(14.5);
        let mut line = String::new();
        writer.row(&frame, &mut line);
        assert_eq!(line, "12.345678,,,-12.35,20.00,,,,,,,,,,,,14.5000,,,,\n");
        assert_eq!(line.matches(',').count(), lines[4].matches(',').count());
    }
}
