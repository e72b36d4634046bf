//! What was said and is not written yet.
//!
//! A terminal that is held (Ctrl-S), a pipe that nobody empties and a journal that hangs keep their writer waiting for
//! as long as they like. Here that is a thread which does nothing else: the sampling loop goes on, and what the queue
//! cannot hold is counted instead of said.

use log::{Level, Log, Metadata, Record};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How many lines may wait: more than any state of things has to say, 50 kB.
const HOLDS: usize = 256;

/// How long the end of the program waits for its last lines.
const LAST_WORDS: Duration = Duration::from_millis(100);

/// What was said, as far as the log shows it.
#[derive(Debug)]
struct Line {
    level: Level,
    target: String,
    text: String,
    module: Option<&'static str>,
    file: Option<&'static str>,
    line: Option<u32>,
}

impl Line {
    fn new(record: &Record<'_>) -> Self {
        Self {
            level: record.level(),
            target: record.target().to_owned(),
            text: record.args().to_string(),
            module: record.module_path_static(),
            file: record.file_static(),
            line: record.line(),
        }
    }

    /// What is to be known of `lost` lines.
    fn of_lost(lost: u64) -> Self {
        Self {
            level: Level::Warn,
            target: module_path!().to_owned(),
            text: format!("{lost} lines are missing here: whoever reads the log did not for a while"),
            module: Some(module_path!()),
            file: Some(file!()),
            line: Some(line!()),
        }
    }

    fn write(&self, place: &dyn Log) {
        place.log(
            &Record::builder()
                .level(self.level)
                .target(&self.target)
                .module_path_static(self.module)
                .file_static(self.file)
                .line(self.line)
                .args(format_args!("{}", self.text))
                .build(),
        );
    }
}

#[derive(Debug, Default)]
struct Waiting {
    lines: VecDeque<Line>,
    /// How many came after `lines` and found no room.
    lost: u64,
    /// Whether a line is being written.
    writing: bool,
}

impl Waiting {
    fn all_written(&self) -> bool {
        self.lines.is_empty() && self.lost == 0 && !self.writing
    }

    /// What is to be written next.
    fn next(&mut self) -> Option<Line> {
        let lost = || (self.lost > 0).then(|| Line::of_lost(std::mem::take(&mut self.lost)));
        self.lines.pop_front().or_else(lost)
    }
}

/// A log that takes a line at once, and one that writes it in its own time.
pub struct Queue {
    place: Arc<dyn Log>,
    waiting: Mutex<Waiting>,
    said: Condvar,
    written: Condvar,
}

impl Queue {
    /// In front of `place`.
    pub fn new(place: Arc<dyn Log>) -> Self {
        Self { place, waiting: Mutex::default(), said: Condvar::new(), written: Condvar::new() }
    }

    /// Writes, for ever.
    pub fn run(&self) {
        let mut waiting = self.waiting();
        loop {
            if let Some(line) = waiting.next() {
                waiting.writing = true;
                drop(waiting);
                line.write(&*self.place);
                waiting = self.waiting();
                waiting.writing = false;
            } else {
                self.written.notify_all();
                waiting = self.said.wait(waiting).unwrap_or_else(PoisonError::into_inner);
            }
        }
    }

    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Log for Queue {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        self.place.enabled(metadata)
    }

    fn log(&self, record: &Record<'_>) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let line = Line::new(record);
        let mut waiting = self.waiting();
        // A gap is one gap: after it nothing is taken until it has been told.
        if waiting.lost == 0 && waiting.lines.len() < HOLDS {
            waiting.lines.push_back(line);
        } else {
            waiting.lost += 1;
        }
        drop(waiting);
        self.said.notify_one();
    }

    /// Waits until all is written, but not for one who does not read.
    fn flush(&self) {
        let waiting = self.waiting();
        drop(self.written.wait_timeout_while(waiting, LAST_WORDS, |w| !w.all_written()));
        self.place.flush();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
    use std::thread;
    use std::time::Instant;

    /// A place that takes a line only when somebody reads it.
    struct Held(SyncSender<String>);

    impl Log for Held {
        fn enabled(&self, metadata: &Metadata<'_>) -> bool {
            metadata.level() <= Level::Info
        }

        fn log(&self, record: &Record<'_>) {
            let _ = self.0.send(format!("{} {}", record.level(), record.args()));
        }

        fn flush(&self) {}
    }

    fn started() -> (Arc<Queue>, Receiver<String>) {
        let (put, read) = sync_channel(0);
        let queue = Arc::new(Queue::new(Arc::new(Held(put))));
        let own = Arc::clone(&queue);
        thread::spawn(move || own.run());
        (queue, read)
    }

    fn say(queue: &Queue, level: Level, n: usize) {
        queue.log(&Record::builder().level(level).args(format_args!("line {n}")).build());
    }

    /// Says so many lines from a thread that would be stopped with its log; whether it was.
    fn says(queue: &Arc<Queue>, n: usize) {
        let (done, ended): (Sender<()>, _) = channel();
        let own = Arc::clone(queue);
        thread::spawn(move || {
            (0..n).for_each(|n| say(&own, Level::Info, n));
            done.send(())
        });
        ended.recv_timeout(Duration::from_secs(20)).expect("the log kept its speaker waiting");
    }

    #[test]
    fn lines_come_in_order_as_they_were_said_and_unwanted_ones_not_at_all() {
        let (queue, read) = started();
        say(&queue, Level::Warn, 1);
        say(&queue, Level::Debug, 2);
        say(&queue, Level::Error, 3);
        assert_eq!(read.recv().unwrap(), "WARN line 1");
        assert_eq!(read.recv().unwrap(), "ERROR line 3");
        queue.flush();
        assert!(read.try_recv().is_err());
    }

    #[test]
    fn who_does_not_read_stops_nobody_and_is_told_what_is_missing() {
        let (queue, read) = started();
        says(&queue, 1000);
        let lines: Vec<_> = std::iter::from_fn(|| read.recv_timeout(Duration::from_secs(1)).ok()).collect();
        let (gap, lines) = lines.split_last().unwrap();
        assert!((HOLDS..=HOLDS + 1).contains(&lines.len()), "{}", lines.len());
        assert!(lines.iter().enumerate().all(|(n, line)| *line == format!("INFO line {n}")), "{lines:?}");
        let lost = 1000 - lines.len();
        assert_eq!(*gap, format!("WARN {lost} lines are missing here: whoever reads the log did not for a while"));
        say(&queue, Level::Info, 1000);
        assert_eq!(read.recv().unwrap(), "INFO line 1000");
    }

    #[test]
    fn the_end_waits_for_the_last_words_and_not_for_ever() {
        let (queue, read) = started();
        says(&queue, 3);
        let begun = Instant::now();
        queue.flush();
        assert!(begun.elapsed() >= LAST_WORDS);
        let reader = thread::spawn(move || read.iter().take(3).count());
        queue.flush();
        assert_eq!(reader.join().unwrap(), 3);
    }
}
