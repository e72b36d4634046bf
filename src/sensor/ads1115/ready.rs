//! The ALERT/RDY line, heard or silent: a line that goes silent costs time, never measurements.

use crate::gpio::{DataReady, GpioError};
use std::time::Duration;

/// Edges in a row after which a silent line is trusted again.
const TRUSTED_AFTER: u32 = 20;

/// Edges in a row that come too early after which the user is told.
const EARLY: u32 = 20;

/// A line that may be there, and whether it has lately been heard.
#[derive(Default)]
pub struct ReadyLine {
    line: Option<Box<dyn DataReady>>,
    trouble: Option<GpioError>,
    silent: bool,
    heard: u32,
    early: u32,
}

impl ReadyLine {
    /// Over `line`, trusted until it is found silent.
    pub fn new(line: Box<dyn DataReady>) -> Self {
        Self { line: Some(line), ..Self::default() }
    }

    /// Whether there is a line at all.
    pub const fn is_there(&self) -> bool {
        self.line.is_some()
    }

    /// Whether it has stopped telling conversions' ends.
    pub const fn is_silent(&self) -> bool {
        self.silent
    }

    /// Waits for an edge, at most `timeout`. A line that fails is silent.
    pub fn wait(&mut self, timeout: Duration) -> bool {
        match self.line.as_mut().map(|line| line.wait(timeout)) {
            Some(Err(trouble)) => {
                self.trouble = Some(trouble);
                false
            }
            waited => waited.is_some_and(|w| w == Ok(true)),
        }
    }

    /// Forgets the edges that have come.
    pub fn clear(&mut self) {
        if let Some(line) = &mut self.line {
            line.clear();
        }
    }

    /// An edge of `chip` came.
    pub fn heard(&mut self, chip: &str) {
        self.heard = self.heard.saturating_add(1);
        if self.silent && self.heard >= TRUSTED_AFTER {
            self.silent = false;
            log::info!("data-ready line of {chip}: heard again");
        }
    }

    /// An edge of `chip` came before the conversion can have ended: told once when that is the rule.
    pub fn early(&mut self, chip: &str) {
        self.early = self.early.saturating_add(1);
        if self.early == EARLY {
            log::warn!(
                "data-ready line of {chip}: its edges come when conversions begin, not when they end; conversions are \
                 waited for by time and polled. Is active-low right? ALERT/RDY itself falls when ready: active-low = false"
            );
        }
    }

    /// An edge came in its time.
    pub fn timely(&mut self) {
        self.early = 0;
    }

    /// An edge of `chip` did not come in its time; whether that is new.
    pub fn missed(&mut self, chip: &str) -> bool {
        self.heard = 0;
        let trouble = self.trouble.take();
        let new = !self.silent;
        if new {
            self.silent = true;
            let why = trouble.map_or_else(|| "no edge".to_owned(), |t| t.to_string());
            log::warn!(
                "data-ready line of {chip}: {why}; conversions are waited for by time and polled. Is ALERT/RDY wired \
                 there, with a pull-up?"
            );
        }
        new
    }
}
