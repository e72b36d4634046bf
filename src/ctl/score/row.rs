//! Which rows of a recording count, and what another program said at their time.

use super::statistics::{Errors, Said, Score, Truth};
use crate::ctl::error::CtlError;
use crate::ctl::recording_args::Beside;
use crate::frame::Frame;
use crate::recording::{EstimateRow, Estimates, Reference};
use crate::time::Time;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// How far two times may be apart that mean the same row, ns: less than half of any row's.
const SAME_NANOS: u64 = 1_000_000;

/// Which rows are compared.
#[derive(Clone, Copy, Debug)]
pub struct Filter {
    skip_s: f64,
    min_ground_speed_m_s: Option<f64>,
    first: Option<Time>,
    ground_speed_m_s: Option<f64>,
}

impl Filter {
    /// Without the first `skip_s` seconds and, if told, what is not above a ground speed.
    pub fn new(skip_s: f64, min_ground_speed_m_s: Option<f64>) -> Self {
        Self { skip_s, min_ground_speed_m_s, first: None, ground_speed_m_s: None }
    }

    /// What the row's estimates are to be compared with, if they are. To be called for every row.
    pub fn truth(&mut self, frame: &Frame, reference: Reference) -> Option<Truth> {
        let first = *self.first.get_or_insert(frame.time);
        self.ground_speed_m_s = frame.aiding.ground_speed_m_s.or(self.ground_speed_m_s);
        let fast = self.min_ground_speed_m_s.is_none_or(|least| self.ground_speed_m_s.is_some_and(|v| v > least));
        let truth = Truth { roll_deg: reference.roll_deg?, pitch_deg: reference.pitch_deg? };
        (fast && frame.time.since(first) >= self.skip_s).then_some(truth)
    }

    /// What is left out, in words.
    pub fn describe(&self) -> String {
        let speed = self.min_ground_speed_m_s.map(|v| format!(", rows not above {v} m/s (--min-ground-speed)"));
        format!("the first {} s (--skip), rows without a reference{}", self.skip_s, speed.unwrap_or_default())
    }
}

/// Another program's estimates beside the recording's rows.
#[derive(Debug)]
pub struct Other {
    name: String,
    path: PathBuf,
    rows: Estimates<BufReader<File>>,
    /// The first of its rows that is not before the recording's.
    next: Option<EstimateRow>,
    met: bool,
    errors: Errors,
}

impl Other {
    /// Opens its file.
    pub fn open(beside: &Beside) -> Result<Self, CtlError> {
        let mut rows = Estimates::open(&beside.path)?;
        let next = rows.next_row()?;
        let (name, path) = (beside.name.clone(), beside.path.clone());
        Ok(Self { name, path, rows, next, met: false, errors: Errors::default() })
    }

    /// Takes in the row at `time`; `truth` where it counts.
    pub fn step(&mut self, time: Time, truth: Option<Truth>) -> Result<(), CtlError> {
        let earliest = time.as_nanos().saturating_sub(SAME_NANOS);
        while self.next.is_some_and(|r| r.nanos < earliest) {
            self.next = self.rows.next_row()?;
        }
        let row = self.next.filter(|r| r.nanos <= time.as_nanos().saturating_add(SAME_NANOS));
        self.met |= row.is_some();
        if let Some(truth) = truth {
            let said = row.and_then(|r| {
                let [roll, pitch, roll_sigma_deg, pitch_sigma_deg] = r.values_deg;
                Some(Said { roll_deg: roll?, pitch_deg: pitch?, roll_sigma_deg, pitch_sigma_deg })
            });
            self.errors.add(truth, said);
        }
        Ok(())
    }

    /// Whether any of its rows had the time of one of the recording's.
    pub fn has_met(&self) -> bool {
        self.met
    }

    /// Its file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its name and score.
    pub fn score(self) -> (String, Score) {
        (self.name, self.errors.score())
    }
}
