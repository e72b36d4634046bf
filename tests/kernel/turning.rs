//! A flight that never stops turning: six sensors whose words change all the time, and what may be wrong with them.

use crate::adapter::{Adapter, Chip};
use crate::mlx::{ADDRESSES, word};
use crate::sky::{GROUND_C, vertical};
use irhorizon::clock;
use irhorizon::sky::{Averaging, FieldOfView, Response, Shape};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// A dry grey sky; a sinusoid of the elevation is nothing that a field of view makes of any.
const SKY: Shape = Shape::Grey { depth: 0.3 };
const SKY_MAX_K: f64 = 45.0;
/// Roll and pitch swing so far, °, in so many seconds.
const ROLL: (f64, f64) = (25.0, 5.0);
const PITCH: (f64, f64) = (8.0, 3.1);
/// New words come this often.
const STEP: Duration = Duration::from_millis(20);
/// A sensor's noise, K, up and down.
const NOISE_K: f64 = 0.1;
/// The dies' temperature, °C.
pub const DIE_C: f64 = 24.0;
/// A film of water comes and goes in this time, s, and hides so much.
const FILM_S: f64 = 3.0;
const FILM: f64 = 0.95;

/// What is wrong with the words that the sensors show.
#[derive(Clone, Copy, Debug, Default)]
pub enum Wrong {
    #[default]
    Nothing,
    /// This sensor's register keeps its word.
    Frozen(usize),
    /// This sensor sets its error bit.
    Error(usize),
    /// Water on this sensor since that time, s.
    Wet(usize, f64),
    /// All around is alike.
    Fog,
}

/// Roll and pitch, °, at a time of the clock, s.
pub fn attitude(time_s: f64) -> (f64, f64) {
    let swing = |(most, period_s): (f64, f64)| most * (TAU * time_s / period_s).sin();
    (swing(ROLL), swing(PITCH))
}

/// Whoever writes the words; ends with it.
pub struct Turning {
    wrong: Arc<Mutex<Wrong>>,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Turning {
    /// On six chips of `bus`, which also get their factory's settings.
    pub fn start(bus: &Adapter) -> Self {
        let mut chips: Vec<Chip> = ADDRESSES.iter().map(|a| bus.chip(*a)).collect();
        for chip in &mut chips {
            for (register, value) in [(0x06, word(DIE_C)), (0x24, 0xffff), (0x25, 0x9fb4)] {
                chip.write(register, value);
            }
        }
        let (wrong, over) = <(Arc<Mutex<Wrong>>, Arc<AtomicBool>)>::default();
        let sky = Response::new(SKY, FieldOfView::Gaussian { fwhm_deg: 90.0 }, Averaging::Temperature);
        show(&mut chips, &sky, Wrong::Nothing, 0);
        let thread = {
            let (wrong, over) = (Arc::clone(&wrong), Arc::clone(&over));
            std::thread::spawn(move || {
                let begun = clock::now();
                for step in 1.. {
                    clock::sleep_until(begun + STEP * step);
                    if over.load(Ordering::Relaxed) {
                        return;
                    }
                    let wrong = *wrong.lock().unwrap();
                    show(&mut chips, &sky, wrong, step);
                }
            })
        };
        Self { wrong, over, thread: Some(thread) }
    }

    /// What is wrong from now on.
    pub fn set(&self, wrong: Wrong) {
        *self.wrong.lock().unwrap() = wrong;
    }
}

impl Drop for Turning {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

fn show(chips: &mut [Chip], sky: &Response, wrong: Wrong, step: u32) {
    let time_s = clock::now().as_secs_f64();
    let (roll_deg, pitch_deg) = attitude(time_s);
    let [nose, left, up] = vertical(roll_deg, pitch_deg);
    let sines = [nose, -nose, left, -left, up, -up];
    for (i, (chip, sine)) in chips.iter_mut().zip(sines).enumerate() {
        let seen_c = sky.sensor_c(sine, GROUND_C, SKY_MAX_K);
        // Something of each step and sensor, from -1 to 1.
        let chance = (f64::from(step) * 12.9898 + i as f64 * 78.233).sin() * 43_758.545_3;
        let own_c = NOISE_K * (2.0 * (chance - chance.floor()) - 1.0);
        let said = match wrong {
            Wrong::Frozen(which) if which == i => continue,
            Wrong::Error(which) if which == i => word(seen_c) | 0x8000,
            Wrong::Wet(which, since_s) if which == i => {
                let share = FILM * ((time_s - since_s) / FILM_S).clamp(0.0, 1.0);
                word(share * DIE_C + (1.0 - share) * seen_c + own_c)
            }
            Wrong::Fog => word(GROUND_C),
            _ => word(seen_c + own_c),
        };
        // A chip that is told not to answer does not answer here either.
        let _ = chip.try_write(0x07, said);
    }
}
