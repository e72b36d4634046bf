//! The log: the journal when systemd started us, stderr otherwise.

use log::LevelFilter;

/// Starts logging at `level` for `program`; a terminal or pipe gets plain lines without time stamps of their own
/// when it is the journal that reads them.
pub fn start(program: &str, level: LevelFilter) {
    if systemd_journal_logger::connected_to_journal()
        && let Ok(journal) = systemd_journal_logger::JournalLog::new()
        && journal.with_syslog_identifier(program.to_owned()).install().is_ok()
    {
        log::set_max_level(level);
        return;
    }
    // Only our own words: the libraries' chatter is for debugging them.
    let _ = env_logger::Builder::new()
        .filter_level(LevelFilter::Warn)
        .filter_module("irhorizon", level)
        .format_target(false)
        .try_init();
}
