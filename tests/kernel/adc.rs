//! ADS1115s on an `i2c-stub`: a thread sees the starts that are written to the chips' memory,
//! converts, and pulses the data-ready line.

use crate::adapter::{Adapter, Chip, GpioSim};
use irhorizon::clock;
use irhorizon::time::Time;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

const CONVERSION: u8 = 0;
const CONFIG: u8 = 1;
const LO_THRESH: u8 = 2;
const HI_THRESH: u8 = 3;
/// Config bit 15: written, start; read, idle.
const OS: u16 = 0x8000;
/// Config bit 2 (COMP_LAT), which the driver writes 0 and does not read: set on all that the
/// emulation has seen, so that a start is known from the same word already there.
const SEEN: u16 = 0x0004;
/// The emulation looks this often; a conversion begins when it is seen.
const LOOK: Duration = Duration::from_millis(1);
/// The chips' oscillator is fast, within the datasheet's 10 %: so that they are done in time though
/// their starts are seen late.
const FAST: f64 = 0.92;

/// The voltages at a chip's four pins.
pub type Pins = Arc<Mutex<[f64; 4]>>;

struct Ads {
    chip: Chip,
    pins: Pins,
    /// The ALERT/RDY pin's line.
    line: Option<u32>,
    /// The config word being converted, and when that is done.
    busy: Option<(u16, Time)>,
}

impl Ads {
    // The chip sends the high byte first.

    fn get(&mut self, register: u8) -> u16 {
        self.chip.read(register).swap_bytes()
    }

    fn put(&mut self, register: u8, word: u16) {
        self.chip.write(register, word.swap_bytes());
    }

    fn pull(&self, gpio: Option<&GpioSim>, up: bool) {
        if let (Some(gpio), Some(line)) = (gpio, self.line) {
            gpio.pull(line, up);
        }
    }

    /// What the chip does by itself between two looks; whether a conversion ended.
    fn look(&mut self, now: Time, gpio: Option<&GpioSim>) -> bool {
        match self.busy {
            Some((_, done)) if now < done => false,
            Some((config, _)) => {
                self.busy = None;
                let code = code(config, *self.pins.lock().unwrap());
                self.put(CONVERSION, code.cast_unsigned());
                self.put(CONFIG, config | OS | SEEN);
                // Conversion-ready: the thresholds' top bits apart, the comparator's queue on.
                let told = config & 3 != 3 && self.get(HI_THRESH) & OS != 0 && self.get(LO_THRESH) & OS == 0;
                if told {
                    self.pull(gpio, false);
                }
                true
            }
            None => {
                let config = self.get(CONFIG);
                if config & SEEN == 0 {
                    if config & OS != 0 {
                        assert_ne!(config & 0x0100, 0, "continuous conversion is not emulated");
                        self.put(CONFIG, config & !OS);
                        self.pull(gpio, true);
                        self.busy = Some((config, now + conversion(config)));
                    } else {
                        self.put(CONFIG, config | OS | SEEN);
                    }
                }
                false
            }
        }
    }
}

/// DR 7:5.
fn conversion(config: u16) -> Duration {
    let sps = [8.0, 16.0, 32.0, 64.0, 128.0, 250.0, 475.0, 860.0][usize::from(config >> 5 & 7)];
    Duration::from_secs_f64(FAST / sps)
}

/// MUX 14:12 and PGA 11:9.
fn code(config: u16, pins: [f64; 4]) -> i16 {
    let volts = match config >> 12 & 7 {
        0 => pins[0] - pins[1],
        1 => pins[0] - pins[3],
        2 => pins[1] - pins[3],
        3 => pins[2] - pins[3],
        single => pins[usize::from(single) - 4],
    };
    let full_scale = [6.144, 4.096, 2.048, 1.024, 0.512, 0.256, 0.256, 0.256][usize::from(config >> 9 & 7)];
    // A float to integer cast saturates, as the chip does.
    (volts / full_scale * 32768.0).round() as i16
}

/// Chips do not wait for the processor: this thread runs before all others. Until a start is seen,
/// the word in memory looks like a conversion that is done.
fn ahead_of_all() {
    let thread = rustix::thread::gettid().as_raw_nonzero().to_string();
    let chrt = std::process::Command::new("chrt").args(["--fifo", "--pid", "50", &thread]).output().unwrap();
    assert!(chrt.status.success(), "chrt: {}", String::from_utf8_lossy(&chrt.stderr));
}

/// The chips of a bus at work.
pub struct Converters {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<u64>>,
}

impl Converters {
    /// ADS1115s after a reset at `addresses`, with the voltages at their pins; `ready` is the line
    /// that the first one's ALERT/RDY is wired to.
    pub fn start(bus: &Adapter, addresses: &[u16], ready: Option<(GpioSim, u32)>) -> (Self, Vec<Pins>) {
        let (gpio, line) = ready.unzip();
        let pins: Vec<Pins> = addresses.iter().map(|_| Pins::default()).collect();
        let make = |(i, address): (usize, &u16)| {
            let line = line.filter(|_| i == 0);
            let mut ads = Ads { chip: bus.chip(*address), pins: pins[i].clone(), line, busy: None };
            ads.put(CONFIG, 0x8583 | SEEN);
            ads.put(LO_THRESH, 0x8000);
            ads.put(HI_THRESH, 0x7fff);
            ads.pull(gpio.as_ref(), true);
            ads
        };
        let mut chips: Vec<Ads> = addresses.iter().enumerate().map(make).collect();
        let stop = Arc::new(AtomicBool::new(false));
        let flag = stop.clone();
        let thread = std::thread::spawn(move || {
            ahead_of_all();
            let mut conversions = 0;
            while !flag.load(Ordering::Relaxed) {
                let now = clock::now();
                conversions += chips.iter_mut().map(|c| u64::from(c.look(now, gpio.as_ref()))).sum::<u64>();
                clock::sleep_until(now + LOOK);
            }
            conversions
        });
        (Self { stop, thread: Some(thread) }, pins)
    }

    /// Switches them off; how many conversions there were.
    pub fn stop(mut self) -> u64 {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap()
    }
}

impl Drop for Converters {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
