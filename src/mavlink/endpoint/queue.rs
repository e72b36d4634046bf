//! Frames that wait for a stream to take them. The newest win: when there is no room the oldest are dropped, but
//! never one of which a part has gone out already. Pure.

use crate::mavlink::deframe::MAX_FRAME;
use std::collections::VecDeque;

/// As many bytes as wait: what 57600 baud carry in 0.7 s. More would only be older.
const MOST_BYTES: usize = 4096;

/// As many frames as wait.
const MOST_FRAMES: usize = 256;

/// The frames that wait, and the one that is going out.
#[derive(Clone, Debug)]
pub struct Queue {
    going: [u8; MAX_FRAME],
    /// Of `going`: the bytes gone, and all of them.
    gone: usize,
    whole: usize,
    bytes: VecDeque<u8>,
    lengths: VecDeque<u16>,
}

impl Default for Queue {
    fn default() -> Self {
        Self {
            going: [0; MAX_FRAME],
            gone: 0,
            whole: 0,
            bytes: VecDeque::with_capacity(MOST_BYTES),
            lengths: VecDeque::with_capacity(MOST_FRAMES),
        }
    }
}

impl Queue {
    /// Nothing waits.
    pub fn is_empty(&self) -> bool {
        self.gone == self.whole && self.lengths.is_empty()
    }

    /// Puts a frame at the end; how many others, or itself when it is too long for any, were dropped for it.
    pub fn push(&mut self, frame: &[u8]) -> u64 {
        let Some(length) = u16::try_from(frame.len()).ok().filter(|l| (1..=MAX_FRAME).contains(&usize::from(*l)))
        else {
            return 1;
        };
        let mut dropped = 0;
        while self.bytes.len() + frame.len() > MOST_BYTES || self.lengths.len() >= MOST_FRAMES {
            let Some(oldest) = self.lengths.pop_front() else { break };
            self.bytes.drain(..usize::from(oldest));
            dropped += 1;
        }
        self.bytes.extend(frame);
        self.lengths.push_back(length);
        dropped
    }

    /// What goes out next: a frame, or the rest of it.
    pub fn front(&mut self) -> Option<&[u8]> {
        if self.gone == self.whole {
            self.whole = usize::from(self.lengths.pop_front()?);
            self.gone = 0;
            for (to, from) in self.going.iter_mut().zip(self.bytes.drain(..self.whole)) {
                *to = from;
            }
        }
        Some(&self.going[self.gone..self.whole])
    }

    /// So many bytes of [`front`](Self::front) have gone; whether that was the end of the frame.
    pub fn gone(&mut self, bytes: usize) -> bool {
        self.gone = self.whole.min(self.gone + bytes);
        self.gone == self.whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_newest_win_but_none_is_cut() {
        let mut queue = Queue::default();
        let frame = |i: u8| [i; 100];
        assert_eq!(queue.push(&frame(0)), 0);
        assert_eq!(queue.front(), Some(&frame(0)[..]));
        assert!(!queue.gone(30));
        let dropped: u64 = (1..=60).map(|i| queue.push(&frame(i))).sum();
        assert_eq!(dropped, 20, "4096 bytes hold 40 of 100");
        assert_eq!(queue.front(), Some(&frame(0)[30..]), "begun, so it is finished");
        assert!(queue.gone(70));
        for i in 21..=60 {
            assert_eq!(queue.front(), Some(&frame(i)[..]));
            assert!(queue.gone(100));
        }
        assert!(queue.is_empty() && queue.front().is_none());
    }

    #[test]
    fn what_is_no_frame_is_dropped() {
        let mut queue = Queue::default();
        assert_eq!((queue.push(&[]), queue.push(&[0; MAX_FRAME + 1]), queue.push(&[0; 70_000])), (1, 1, 1));
        assert!(queue.is_empty());
    }

    proptest! {
        #[test]
        fn whatever_the_stream_takes_it_takes_whole_frames_in_order(
            steps in prop::collection::vec((prop::option::of(1_usize..=MAX_FRAME), 0_usize..400), 1..400),
        ) {
            let (mut queue, mut wire, mut number, mut dropped) = (Queue::default(), Vec::new(), 0_u32, 0);
            let room = (queue.bytes.capacity(), queue.lengths.capacity());
            let mut lengths = Vec::new();
            for (pushed, mut taken) in steps {
                if let Some(length) = pushed {
                    // A frame is its number again and again.
                    let frame: Vec<u8> = std::iter::repeat_n(number as u8, length).collect();
                    lengths.push(length);
                    dropped += queue.push(&frame);
                    number += 1;
                }
                while taken > 0 && let Some(front) = queue.front() {
                    let n = front.len().min(taken);
                    wire.extend_from_slice(&front[..n]);
                    queue.gone(n);
                    taken -= n;
                }
            }
            while let Some(front) = queue.front() {
                let n = front.len();
                wire.extend_from_slice(front);
                queue.gone(n);
            }
            prop_assert_eq!(room, (queue.bytes.capacity(), queue.lengths.capacity()));
            let (mut rest, mut seen, mut last) = (&wire[..], 0, None);
            while let Some(&first) = rest.first() {
                // Numbers are met in order, so the next frame with this number modulo 256 is it.
                let from = last.map_or(0, |l: usize| l + 1);
                let at = (from..lengths.len()).find(|i| *i as u8 == first).unwrap();
                prop_assert!(rest.len() >= lengths[at] && rest[..lengths[at]].iter().all(|b| *b == first));
                rest = &rest[lengths[at]..];
                seen += 1;
                last = Some(at);
            }
            prop_assert_eq!(seen + dropped, u64::from(number));
        }
    }
}
