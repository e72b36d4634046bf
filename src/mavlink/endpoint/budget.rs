//! How much is taken in at a time: neither a flood nor bytes that are costly to check hold up what goes out.

use crate::clock;
use crate::time::Time;
use std::time::Duration;

/// The longest turn: small beside the 20 ms between two frames.
const TURN: Duration = Duration::from_millis(1);

/// What is left of one turn.
#[derive(Debug)]
pub struct Budget {
    calls: u32,
    whole: u32,
    end: Time,
}

impl Budget {
    /// At most `calls`.
    pub fn new(calls: u32) -> Self {
        Self { calls, whole: calls, end: clock::now() + TURN }
    }

    /// Whether one more call is within bounds. The first always is.
    pub fn more(&mut self) -> bool {
        let more = self.calls > 0 && (self.calls == self.whole || clock::now() < self.end);
        self.calls = self.calls.saturating_sub(1);
        more
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_ends_by_number_or_by_time() {
        let mut budget = Budget::new(3);
        let taken = (0..10).filter(|_| budget.more()).count();
        assert!((1..=3).contains(&taken));
        let mut late = Budget::new(100);
        assert!(late.more());
        std::thread::sleep(Duration::from_millis(2));
        assert!(!late.more());
    }
}
