//! The log: the journal when systemd started us, stderr otherwise. Nobody who has something to say waits for either.
//!
//! - [`queue`]: what was said and is not written yet.

pub mod queue;

use log::{LevelFilter, Log};
use queue::Queue;
use std::sync::Arc;
use std::thread;

/// Starts logging at `level` for `program`; a terminal or pipe gets plain lines without time stamps of their own
/// when it is the journal that reads them. Whoever ends the program writes the last lines: `log::logger().flush()`.
pub fn start(program: &str, level: LevelFilter) {
    let (place, level) = place(program, level);
    let queue = Arc::new(Queue::new(Arc::clone(&place)));
    let own = Arc::clone(&queue);
    let spawned = thread::Builder::new().name("log".into()).spawn(move || own.run());
    // Without a thread every line is written by whoever says it: better late than unsaid.
    let logger: Box<dyn Log> = if spawned.is_ok() { Box::new(queue) } else { Box::new(place) };
    if log::set_boxed_logger(logger).is_ok() {
        log::set_max_level(level);
    }
}

/// Where the lines go, and down to which level they are wanted.
fn place(program: &str, level: LevelFilter) -> (Arc<dyn Log>, LevelFilter) {
    if systemd_journal_logger::connected_to_journal()
        && let Ok(journal) = systemd_journal_logger::JournalLog::new()
    {
        return (Arc::new(journal.with_syslog_identifier(program.to_owned())), level);
    }
    // Only our own words: the libraries' chatter is for debugging them.
    let stderr = env_logger::Builder::new()
        .filter_level(LevelFilter::Warn)
        .filter_module("irhorizon", level)
        .format_target(false)
        .build();
    let level = stderr.filter();
    (Arc::new(stderr), level)
}
