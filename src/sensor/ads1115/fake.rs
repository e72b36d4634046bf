//! A chip in virtual time: conversions that take a while, a multiplexer, the OS bit, a data-ready
//! line, and whatever can go wrong with them. Written from the datasheet, not from the driver.

use super::timing::Clock;
use crate::bus::{BusError, WordBus};
use crate::gpio::{DataReady, GpioError};
use crate::time::Time;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

/// How one conversion goes.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// How long it takes, in nominal conversion times.
    pub factor: f64,
    /// How long after its end the data-ready edge comes, ns; `None`: it does not.
    pub edge_after: Option<u64>,
    /// A stray edge this long after its start, ns.
    pub stray_after: Option<u64>,
}

impl Course {
    pub const IDEAL: Self = Self { factor: 1.0, edge_after: Some(0), stray_after: None };
    pub const SILENT: Self = Self { edge_after: None, ..Self::IDEAL };
}

/// How a transfer fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The chip did not hear it.
    Unheard,
    /// The chip heard it, the host thinks it failed.
    Heard,
}

#[derive(Debug)]
struct Running {
    mux: u16,
    began: u64,
    ends: u64,
    edge_after: Option<u64>,
}

/// The chip with its surroundings.
#[derive(Debug)]
pub struct World {
    pub now: u64,
    /// Time spent waiting, as against transferring.
    pub waited: u64,
    pub transfer_ns: u64,
    pub transfers: u64,
    /// Registers 0 to 3, as the datasheet writes them: high byte first.
    pub registers: [u16; 4],
    /// The chip keeps registers as plain memory and never converts by itself.
    pub memory: bool,
    /// The next conversions; `usual` afterwards.
    pub courses: VecDeque<Course>,
    pub usual: Course,
    pub failures: VecDeque<Option<Failure>>,
    /// The code of the next conversion, whatever the input.
    pub forced_code: Option<u16>,
    /// When the conversion began whose result is in the register.
    pub began: u64,
    number: u16,
    running: Option<Running>,
    pub edges: Vec<u64>,
}

impl World {
    #[expect(clippy::new_ret_no_self, reason = "a world is only ever shared")]
    pub fn new() -> Handle {
        Handle(Arc::new(Mutex::new(Self {
            now: 1_000_000_000,
            waited: 0,
            transfer_ns: 120_000,
            transfers: 0,
            registers: [0, 0x8583, 0x8000, 0x7fff],
            memory: false,
            courses: VecDeque::new(),
            usual: Course::IDEAL,
            failures: VecDeque::new(),
            forced_code: None,
            began: 0,
            number: 0,
            running: None,
            edges: Vec::new(),
        })))
    }

    fn nominal_ns(&self) -> f64 {
        1e9 / [8.0, 16.0, 32.0, 64.0, 128.0, 250.0, 475.0, 860.0][usize::from(self.registers[1] >> 5 & 7)]
    }

    fn continuous(&self) -> bool {
        self.registers[1] & 0x0100 == 0
    }

    fn convert(&mut self, at: u64) {
        let course = self.courses.pop_front().unwrap_or(self.usual);
        let ends = at + (self.nominal_ns() * course.factor) as u64;
        let ready = self.registers[3] & 0x8000 != 0 && self.registers[2] & 0x8000 == 0 && self.registers[1] & 3 != 3;
        if let Some(after) = course.stray_after {
            self.edges.push(at + after);
        }
        let edge_after = course.edge_after.filter(|_| ready);
        self.running = Some(Running { mux: self.registers[1] >> 12 & 7, began: at, ends, edge_after });
    }

    pub fn advance(&mut self, to: u64) {
        while let Some(run) = self.running.take_if(|r| r.ends <= to) {
            self.number += 1;
            // A code tells which conversion it is of, and of which input: 4000 to an input.
            self.registers[0] = self.forced_code.unwrap_or(run.mux * 4000 + self.number % 4000);
            self.began = run.began;
            self.edges.extend(run.edge_after.map(|after| run.ends + after));
            if self.continuous() {
                self.convert(run.ends);
            }
        }
        self.edges.sort_unstable();
        self.now = self.now.max(to);
    }

    /// The supply drops: everything is as after a reset.
    pub fn brown_out(&mut self) {
        self.registers = [0, 0x8583, 0x8000, 0x7fff];
        self.running = None;
    }

    fn transfer(&mut self, act: impl FnOnce(&mut Self)) -> Result<(), BusError> {
        self.transfers += 1;
        let failure = self.failures.pop_front().flatten();
        let end = self.now + self.transfer_ns;
        // The chip takes its part in the middle of the transfer.
        self.advance(end - self.transfer_ns / 2);
        if failure != Some(Failure::Unheard) {
            act(self);
        }
        self.advance(end);
        if failure.is_some() { Err(BusError::NoAnswer) } else { Ok(()) }
    }

    fn write(&mut self, register: u8, word: u16) {
        self.registers[usize::from(register)] = word;
        let idle = self.running.is_none();
        if register == 1 && !self.memory && idle && (word & 0x8000 != 0 || word & 0x0100 == 0) {
            self.convert(self.now);
        }
    }

    fn read(&self, register: u8) -> u16 {
        let word = self.registers[usize::from(register)];
        match register {
            1 if !self.memory => word & 0x7fff | u16::from(self.running.is_none()) << 15,
            _ => word,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Handle(Arc<Mutex<World>>);

impl Handle {
    pub fn world(&self) -> MutexGuard<'_, World> {
        self.0.lock().unwrap()
    }
}

impl WordBus for Handle {
    fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
        let mut word = 0;
        self.world().transfer(|w| word = w.read(command))?;
        Ok(u16::from_be_bytes(word.to_le_bytes()))
    }

    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
        self.world().transfer(|w| w.write(command, u16::from_be_bytes(word.to_le_bytes())))
    }
}

impl Clock for Handle {
    fn now(&mut self) -> Time {
        Time::from_nanos(self.world().now)
    }

    fn sleep_until(&mut self, deadline: Time) {
        let mut world = self.world();
        let left = deadline.as_nanos().saturating_sub(world.now);
        world.waited += left;
        let to = world.now + left;
        world.advance(to);
    }
}

impl DataReady for Handle {
    fn wait(&mut self, timeout: Duration) -> Result<bool, GpioError> {
        let mut world = self.world();
        let until = world.now + timeout.as_nanos() as u64;
        // The chip's next edge may not be known before its conversion has ended: step towards it.
        loop {
            if let Some(&edge) = world.edges.first()
                && edge <= until
                && world.running.as_ref().is_none_or(|r| edge <= r.ends)
            {
                world.edges.remove(0);
                let to = edge.max(world.now);
                world.waited += to - world.now;
                world.advance(to);
                return Ok(true);
            }
            let step = world.running.as_ref().map_or(until, |r| r.ends.min(until));
            if step >= until {
                world.waited += until - world.now;
                world.advance(until);
                let came = world.edges.first().is_some_and(|e| *e <= until);
                if came {
                    world.edges.remove(0);
                }
                return Ok(came);
            }
            world.waited += step.saturating_sub(world.now);
            world.advance(step);
        }
    }

    fn clear(&mut self) {
        let mut world = self.world();
        let now = world.now;
        world.edges.retain(|e| *e > now);
    }
}
