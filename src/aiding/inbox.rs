//! From the thread that hears the autopilot to the one that samples: a short lock, bounded room.

use super::{Link, Said};
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is kept while nobody takes it: more than a second of all that an autopilot says. The newest wins.
pub const ROOM: usize = 256;

/// What has been heard and not yet taken.
#[derive(Debug)]
pub struct Inbox(Mutex<Contents>);

#[derive(Debug)]
struct Contents {
    said: VecDeque<Said>,
    link: Link,
}

impl Default for Inbox {
    fn default() -> Self {
        Self(Mutex::new(Contents { said: VecDeque::with_capacity(ROOM), link: Link::default() }))
    }
}

impl Inbox {
    fn lock(&self) -> MutexGuard<'_, Contents> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts something in.
    pub fn push(&self, said: Said) {
        let mut contents = self.lock();
        if contents.said.len() >= ROOM {
            contents.said.pop_front();
        }
        contents.said.push_back(said);
    }

    /// How the autopilot is heard now.
    pub fn tell(&self, link: Link) {
        self.lock().link = link;
    }

    /// Moves everything to the end of `to`, and gives how the autopilot is heard. Allocates nothing where `to` has
    /// [`ROOM`].
    pub fn take(&self, to: &mut Vec<Said>) -> Link {
        let mut contents = self.lock();
        to.extend(contents.said.drain(..));
        contents.link
    }
}

#[cfg(test)]
mod tests {
    use super::super::What;
    use super::*;
    use crate::time::Time;

    #[test]
    fn the_newest_stay_in_their_order() {
        let inbox = Inbox::default();
        for i in 0..1000 {
            let time = Time::from_nanos(i);
            inbox.push(Said { time, arrived: time, what: What::Rates([0.0; 3]) });
        }
        inbox.tell(Link { system: Some(7), ..Link::default() });
        let mut taken = Vec::with_capacity(ROOM);
        assert_eq!(inbox.take(&mut taken).system, Some(7));
        let nanos: Vec<u64> = taken.iter().map(|s| s.time.as_nanos()).collect();
        assert_eq!(nanos, (744..1000).collect::<Vec<u64>>());
        assert_eq!(taken.capacity(), ROOM);
        taken.clear();
        inbox.take(&mut taken);
        assert!(taken.is_empty());
    }
}
