//! The terminal at one end, the daemon at the other.
//!
//! A thread asks the daemon and leaves its newest answer in one place; the terminal is drawn from
//! there. Neither waits for the other, and nothing queues up: a daemon that hangs is shown as
//! silent, a terminal that stalls skips pictures.

use super::palette::Palette;
use super::picture::{Seen, draw};
use super::print;
use crate::config::settings::BusAddress;
use crate::ctl::cli::WatchArgs;
use crate::ctl::error::{CtlError, chain};
use crate::ctl::kit::{Daemon, DaemonError, Kit};
use crate::ctl::view::Status;
use ratatui::DefaultTerminal;
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use ratatui::crossterm::terminal;
use ratatui::layout::Rect;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Between two questions to the daemon.
const ASK_EVERY: Duration = Duration::from_millis(100);
/// Before a silent daemon is asked again.
const RETRY_AFTER: Duration = Duration::from_millis(500);
/// An answer older than this is not shown as the state.
const SILENT_AFTER: Duration = Duration::from_millis(1_500);
/// The size of a picture when there is neither a terminal nor a size.
const DEFAULT_SIZE: (u16, u16) = (80, 24);

/// Does what the command line says.
pub fn command(
    args: WatchArgs,
    bus: &BusAddress,
    kit: &Kit,
    stop: &AtomicBool,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<(), CtlError> {
    match (args.json, args.once) {
        (true, once) => json(once, bus, kit, stop, out, err),
        (false, true) => once(args.size, bus, kit, out),
        (false, false) => live(bus, kit, stop),
    }
}

/// A line for each new measurement; while there is no daemon, a word on `err` and patience.
fn json(
    once: bool,
    bus: &BusAddress,
    kit: &Kit,
    stop: &AtomicBool,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<(), CtlError> {
    let mut link = Link::new(bus.clone(), *kit);
    let mut silent = false;
    let mut last = None;
    while !stop.load(Ordering::Relaxed) {
        match link.ask() {
            Ok(status) => {
                silent = false;
                let key = (status.sample_time_usec, status.mode.clone(), status.faults.len());
                if last.as_ref() != Some(&key) {
                    last = Some(key);
                    let line = serde_json::to_string(&status).map_err(|e| CtlError::Output(e.into()))?;
                    writeln!(out, "{line}").and_then(|()| out.flush()).map_err(CtlError::Output)?;
                }
                if once {
                    return Ok(());
                }
                thread::sleep(ASK_EVERY);
            }
            Err(e) if once => return Err(e.into()),
            Err(e) => {
                if !silent {
                    let _ = writeln!(err, "no daemon, trying again: {}", chain(&CtlError::from(e)));
                }
                silent = true;
                thread::sleep(RETRY_AFTER);
            }
        }
    }
    Ok(())
}

/// One picture.
fn once(size: Option<(u16, u16)>, bus: &BusAddress, kit: &Kit, out: &mut dyn Write) -> Result<(), CtlError> {
    let status = Link::new(bus.clone(), *kit).ask()?;
    let (width, height) = size.or_else(|| terminal::size().ok()).unwrap_or(DEFAULT_SIZE);
    let palette = Palette { colours: io::stdout().is_terminal() && colours_wanted() };
    let mut buf = Buffer::empty(Rect::new(0, 0, width, height));
    draw(&Seen::Status(Box::new(status)), palette, &mut buf);
    let picture = if palette.colours { print::ansi(&buf) } else { print::text(&buf) };
    out.write_all(picture.as_bytes()).and_then(|()| out.flush()).map_err(CtlError::Output)
}

/// Whether the environment wants colours (NO_COLOR, a dumb terminal).
fn colours_wanted() -> bool {
    let set = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty());
    set("NO_COLOR").is_none() && set("TERM").is_none_or(|t| t != "dumb")
}

/// The live picture until the user has seen enough.
fn live(bus: &BusAddress, kit: &Kit, stop: &AtomicBool) -> Result<(), CtlError> {
    if !io::stdout().is_terminal() || !io::stdin().is_terminal() {
        return Err(CtlError::NoTerminal);
    }
    let palette = Palette { colours: colours_wanted() };
    let latest = Arc::new(Latest::default());
    let (there, bus, kit) = (Arc::clone(&latest), bus.clone(), *kit);
    // Not joined: it may hang on a daemon that hangs, and ends with the process.
    let ask = move || there.keep_asking(Link::new(bus, kit));
    thread::Builder::new().name("ask".into()).spawn(ask).map_err(CtlError::Terminal)?;
    let mut terminal = ratatui::try_init().map_err(CtlError::Terminal)?;
    let result = show(&mut terminal, &latest, palette, stop);
    let restored = ratatui::try_restore();
    result.and(restored).map_err(CtlError::Terminal)
}

fn show(terminal: &mut DefaultTerminal, latest: &Latest, palette: Palette, stop: &AtomicBool) -> io::Result<()> {
    while !stop.load(Ordering::Relaxed) {
        if takes_output() {
            let seen = latest.seen(Instant::now());
            terminal.draw(|frame| draw(&seen, palette, frame.buffer_mut()))?;
        }
        if event::poll(ASK_EVERY / 2)? && is_quit(&event::read()?) {
            break;
        }
    }
    Ok(())
}

/// Whether the terminal takes output now: one that stalls is left alone, so that keys and signals
/// are still heard.
fn takes_output() -> bool {
    let stdout = io::stdout();
    let mut fds = [PollFd::new(&stdout, PollFlags::OUT)];
    !matches!(poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 })), Ok(0))
}

fn is_quit(event: &Event) -> bool {
    let Event::Key(key) = event else { return false };
    if key.kind == KeyEventKind::Release {
        return false;
    }
    match key.code {
        KeyCode::Char('q') | KeyCode::Esc => true,
        KeyCode::Char('c') => key.modifiers.contains(KeyModifiers::CONTROL),
        _ => false,
    }
}

/// The way to the daemon, made again when it breaks.
struct Link {
    bus: BusAddress,
    kit: Kit,
    daemon: Option<Box<dyn Daemon>>,
}

impl Link {
    fn new(bus: BusAddress, kit: Kit) -> Self {
        Self { bus, kit, daemon: None }
    }

    fn ask(&mut self) -> Result<Status, DaemonError> {
        let daemon = match &mut self.daemon {
            Some(daemon) => daemon,
            none => none.insert((self.kit.connect)(&self.bus)?),
        };
        let answer = daemon.status();
        if answer.is_err() {
            self.daemon = None;
        }
        answer
    }
}

/// The newest answer, and since when there is none.
#[derive(Default)]
struct Latest(Mutex<State>);

#[derive(Default)]
struct State {
    answer: Option<(Status, Instant)>,
    silence: Option<(String, Instant)>,
}

impl Latest {
    fn keep_asking(&self, mut link: Link) {
        loop {
            let answer = link.ask().map_err(|e| chain(&CtlError::from(e)));
            let pause = if answer.is_ok() { ASK_EVERY } else { RETRY_AFTER };
            self.take(answer, Instant::now());
            thread::sleep(pause);
        }
    }

    fn take(&self, answer: Result<Status, String>, now: Instant) {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *state = match answer {
            Ok(status) => State { answer: Some((status, now)), silence: None },
            Err(reason) => {
                let since = state.silence.as_ref().map_or(now, |(_, since)| *since);
                State { answer: None, silence: Some((reason, since)) }
            }
        };
    }

    /// What to show at `now`: the answer with its ages gone on, or that there is none.
    fn seen(&self, now: Instant) -> Seen {
        let state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match (&state.answer, &state.silence) {
            (Some((status, at)), _) => {
                let age = now.saturating_duration_since(*at);
                if age >= SILENT_AFTER {
                    return Seen::Silent { reason: "it does not answer".to_owned(), for_s: age.as_secs_f64() };
                }
                let mut status = status.clone();
                status.sample_age_s += age.as_secs_f64();
                for fault in &mut status.faults {
                    fault.for_s += age.as_secs_f64();
                }
                Seen::Status(Box::new(status))
            }
            (None, Some((reason, since))) => {
                let for_s = now.saturating_duration_since(*since).as_secs_f64();
                Seen::Silent { reason: reason.clone(), for_s }
            }
            (None, None) => Seen::Nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_old_answer_is_silence_and_a_new_one_ends_it() {
        let latest = Latest::default();
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        assert_eq!(latest.seen(start), Seen::Nothing);
        latest.take(Ok(Status { sample_age_s: 0.01, ..Status::default() }), start);
        let Seen::Status(status) = latest.seen(after(500)) else { panic!("an answer is shown") };
        assert!((status.sample_age_s - 0.51).abs() < 1e-9);
        assert!(matches!(latest.seen(after(2_000)), Seen::Silent { .. }));
        latest.take(Err("gone".into()), after(2_000));
        latest.take(Err("gone".into()), after(3_000));
        assert_eq!(latest.seen(after(4_000)), Seen::Silent { reason: "gone".into(), for_s: 2.0 });
        latest.take(Ok(Status::default()), after(4_100));
        assert!(matches!(latest.seen(after(4_200)), Seen::Status(_)));
    }

    #[test]
    fn q_escape_and_control_c_quit() {
        let key = |code, modifiers| Event::Key(event::KeyEvent::new(code, modifiers));
        assert!(is_quit(&key(KeyCode::Char('q'), KeyModifiers::NONE)));
        assert!(is_quit(&key(KeyCode::Esc, KeyModifiers::NONE)));
        assert!(is_quit(&key(KeyCode::Char('c'), KeyModifiers::CONTROL)));
        assert!(!is_quit(&key(KeyCode::Char('c'), KeyModifiers::NONE)));
        assert!(!is_quit(&Event::Resize(80, 24)));
    }
}
