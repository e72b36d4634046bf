//! The sampling schedule: when in a scan each sensor is read. Pure.
//!
//! One thread walks over the slots. Each bus is left quiet before each read, because polling
//! disturbs a thermopile's measurement; while one bus is quiet another one is read. The two sensors
//! of a pair are read next to each other. At the end of a scan one MLX90614 is asked for its die
//! temperature.

use crate::config::settings::{Ads1115Settings, DeviceSettings, SensorSettings};
use crate::direction::Direction;
use crate::head::Head;
use std::collections::HashMap;
use std::fmt;
use std::time::Duration;

/// A word with PEC at 100 kHz: 57 bit times.
const MLX_WORD: Duration = Duration::from_micros(570);
/// A word without PEC at 100 kHz.
const ADS_WORD: Duration = Duration::from_micros(480);
/// Words of an ADS1115 after its conversion: is it ready, is it still set up, the result, the next
/// start.
const ADS_WORDS: u32 = 4;
/// The share of a period that the slots may fill; the rest is for trying again, the estimator and
/// the scheduler's delays.
const USABLE: f64 = 0.9;
/// The share of a period by which rounding may exceed [`USABLE`]: a rate that is advised fills it to
/// the last digit.
const ROUNDING: f64 = 1e-9;

/// A chip: one address on one bus, and the sensors behind it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChipPlan {
    /// Its bus, as an index into [`Head::buses`].
    pub bus: usize,
    /// Its address.
    pub address: u8,
    /// The sensors, by their index in the head, in the order of the chip's slots.
    pub sensors: Vec<usize>,
}

/// One read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// When it begins, counted from the tick.
    pub offset: Duration,
    /// When it has ended if nothing goes wrong, counted from the tick.
    pub end: Duration,
    /// The chip, as an index into [`Schedule::chips`].
    pub chip: usize,
    /// The chip's slot.
    pub slot: usize,
    /// The sensor, by its index in the head.
    pub sensor: usize,
}

/// When in a scan each sensor is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Schedule {
    /// The time from one tick to the next.
    pub period: Duration,
    /// The quiet time before each read.
    pub quiet: Duration,
    /// The chips, in the order of their first sensor.
    pub chips: Vec<ChipPlan>,
    /// The reads, in time.
    pub slots: Vec<Slot>,
    /// When the die temperature is read, if there is an MLX90614.
    pub housekeeping: Option<Duration>,
    /// What the scan needs, quiet time before the next one included.
    pub needed: Duration,
    names: Vec<String>,
    buses: Vec<String>,
}

/// The sensors cannot all be read in one period.
#[derive(Clone, Debug, PartialEq)]
pub struct DoesNotFit {
    /// How many sensors.
    pub sensors: usize,
    /// The configured rate, Hz.
    pub rate_hz: f64,
    /// What a scan needs.
    pub needed: Duration,
    /// The quiet time before each read.
    pub quiet: Duration,
    /// The highest rate that fits, Hz, a whole number where it is above 1.
    pub highest_rate_hz: f64,
    /// The longest quiet time that fits at this rate; `None` when none does.
    pub longest_quiet: Option<Duration>,
    /// A conversion of an ADS1115 takes most of it.
    pub conversions_dominate: bool,
}

impl fmt::Display for DoesNotFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "a scan of {} sensors needs {:.1} ms, and rate-hz = {} leaves it {:.1} ms: set [daemon] rate-hz to {} or \
             less",
            self.sensors,
            milliseconds(self.needed),
            self.rate_hz,
            1e3 * USABLE / self.rate_hz,
            self.highest_rate_hz
        )?;
        if !self.quiet.is_zero()
            && let Some(longest) = self.longest_quiet
        {
            // Downwards, so that what is advised does fit.
            let ms = (milliseconds(longest) * 100.0).floor() / 100.0;
            write!(f, ", or quiet-ms from {} to {ms} or less", milliseconds(self.quiet))?;
        }
        if self.conversions_dominate {
            write!(f, ", or raise the ADS1115's data-rate-sps")?;
        }
        Ok(())
    }
}

impl std::error::Error for DoesNotFit {}

fn milliseconds(d: Duration) -> f64 {
    d.as_secs_f64() * 1e3
}

/// The chips that the sensors are behind, in the order of their first sensor.
pub fn chips(sensors: &[SensorSettings], head: &Head) -> Vec<ChipPlan> {
    let mut chips: Vec<ChipPlan> = Vec::new();
    for (sensor, s) in sensors.iter().enumerate() {
        let bus = head.sensors.get(sensor).and_then(|s| s.bus).unwrap_or(0);
        let address = s.device.address();
        match chips.iter_mut().find(|c| (c.bus, c.address) == (bus, address)) {
            Some(chip) => chip.sensors.push(sensor),
            None => chips.push(ChipPlan { bus, address, sensors: vec![sensor] }),
        }
    }
    chips
}

/// The sensors in the order of reading: each next to the one that looks the opposite way.
fn order(sensors: &[SensorSettings]) -> Vec<usize> {
    let absolute = |i: usize| matches!(sensors[i].device, DeviceSettings::Mlx90614(_));
    let direction = |i: usize| -> Direction { sensors[i].direction };
    let mut order: Vec<usize> = Vec::new();
    for i in 0..sensors.len() {
        if order.contains(&i) {
            continue;
        }
        order.push(i);
        let opposed =
            |j: &usize| absolute(i) && absolute(*j) && !order.contains(j) && direction(i).opposes(direction(*j));
        let partner = (i + 1..sensors.len()).find(opposed);
        order.extend(partner);
    }
    order
}

/// The longest that a conversion takes: 10 % over its nominal time (ADS1115 datasheet 6.5).
fn conversion(ads: &Ads1115Settings) -> Duration {
    Duration::from_secs_f64(1.1 / f64::from(ads.data_rate_sps.max(1)))
}

impl Schedule {
    /// Plans the scan of `sensors`, which make `head`, `rate_hz` times a second with a bus `quiet`
    /// before each read; fails when it does not fit into the period.
    pub fn plan(sensors: &[SensorSettings], head: &Head, rate_hz: f64, quiet: Duration) -> Result<Self, DoesNotFit> {
        let plan = Self::lay_out(sensors, head, rate_hz, quiet);
        if plan.needed.as_secs_f64() * rate_hz <= USABLE + ROUNDING {
            return Ok(plan);
        }
        let highest = USABLE / plan.needed.as_secs_f64();
        let at_rest = Self::lay_out(sensors, head, rate_hz, Duration::ZERO).needed;
        let spare_s = USABLE / rate_hz - at_rest.as_secs_f64();
        // At most one quiet time before each transfer: what this gives always fits.
        let gaps = plan.slots.len() + 1 + usize::from(plan.housekeeping.is_some());
        let converting = sensors.iter().filter_map(|s| match &s.device {
            DeviceSettings::Ads1115(a) => Some(conversion(a)),
            DeviceSettings::Mlx90614(_) => None,
        });
        Err(DoesNotFit {
            sensors: plan.slots.len(),
            rate_hz,
            needed: plan.needed,
            quiet,
            highest_rate_hz: if highest >= 1.0 { highest.floor() } else { (highest * 100.0).floor() / 100.0 },
            longest_quiet: (spare_s >= 0.0).then(|| Duration::from_secs_f64(spare_s / gaps as f64)),
            conversions_dominate: converting.sum::<Duration>() * 2 > plan.needed,
        })
    }

    /// Lays the slots out, whether they fit into the period or not.
    fn lay_out(sensors: &[SensorSettings], head: &Head, rate_hz: f64, quiet: Duration) -> Self {
        let chips = chips(sensors, head);
        let place: HashMap<usize, (usize, usize)> = chips
            .iter()
            .enumerate()
            .flat_map(|(c, chip)| chip.sensors.iter().enumerate().map(move |(slot, s)| (*s, (c, slot))))
            .collect();
        // The first conversion of each ADC is started at the tick.
        let mut begun = Duration::ZERO;
        let mut ready: Vec<Duration> = Vec::with_capacity(chips.len());
        for chip in &chips {
            ready.push(match &sensors[chip.sensors[0]].device {
                DeviceSettings::Ads1115(a) => {
                    begun += ADS_WORD;
                    begun + conversion(a)
                }
                DeviceSettings::Mlx90614(_) => Duration::ZERO,
            });
        }
        let mut free = begun;
        let mut bus_free: Vec<Option<Duration>> = vec![None; head.buses.len().max(1)];
        let mut slots = Vec::new();
        for sensor in order(sensors) {
            let (chip, slot) = place[&sensor];
            let bus = chips[chip].bus;
            let offset = free.max(bus_free[bus].map_or(Duration::ZERO, |f| f + quiet));
            let end = match &sensors[sensor].device {
                DeviceSettings::Mlx90614(_) => offset + MLX_WORD,
                DeviceSettings::Ads1115(_) => offset.max(ready[chip]) + ADS_WORD * ADS_WORDS,
            };
            // Once read, an ADC starts on its next channel.
            if let Some(DeviceSettings::Ads1115(next)) = chips[chip].sensors.get(slot + 1).map(|s| &sensors[*s].device)
            {
                ready[chip] = end + conversion(next);
            }
            slots.push(Slot { offset, end, chip, slot, sensor });
            free = end;
            bus_free[bus] = Some(end);
        }
        let has_mlx = sensors.iter().any(|s| matches!(s.device, DeviceSettings::Mlx90614(_)));
        let housekeeping = has_mlx.then_some(free + quiet);
        let end = housekeeping.map_or(free, |h| h + MLX_WORD);
        Self {
            period: Duration::from_secs_f64(1.0 / rate_hz),
            quiet,
            chips,
            slots,
            housekeeping,
            needed: end + quiet,
            names: sensors.iter().map(|s| s.name.clone()).collect(),
            buses: head.buses.clone(),
        }
    }

    /// A schedule of given chips for a source that is put together by hand: their sensors one after
    /// the other, as fast as they answer.
    pub fn plain(period: Duration, chips: Vec<ChipPlan>, buses: Vec<String>) -> Self {
        let mut slots = Vec::new();
        for (c, chip) in chips.iter().enumerate() {
            for (slot, sensor) in chip.sensors.iter().enumerate() {
                slots.push(Slot { offset: Duration::ZERO, end: Duration::ZERO, chip: c, slot, sensor: *sensor });
            }
        }
        let sensors = slots.iter().map(|s| s.sensor + 1).max().unwrap_or(0);
        let names = (0..sensors).map(|i| format!("sensor {i}")).collect();
        let quiet = Duration::ZERO;
        Self { period, quiet, chips, slots, housekeeping: Some(quiet), needed: quiet, names, buses }
    }

    /// How many sensors the schedule reads.
    pub fn sensors(&self) -> usize {
        self.names.len()
    }

    /// The buses.
    pub fn buses(&self) -> &[String] {
        &self.buses
    }

    /// The names of the sensors behind chip `index`, joined by commas.
    pub fn chip_name(&self, index: usize) -> String {
        let names: Vec<&str> = self.chips[index].sensors.iter().map(|s| self.names[*s].as_str()).collect();
        names.join(", ")
    }
}

impl fmt::Display for Schedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "a scan of {} sensors every {:.2} ms, {:.2} ms of it used, quiet for {:.2} ms before each read",
            self.slots.len(),
            milliseconds(self.period),
            milliseconds(self.needed),
            milliseconds(self.quiet)
        )?;
        for slot in &self.slots {
            let chip = &self.chips[slot.chip];
            writeln!(
                f,
                "  {:7.2} to {:6.2} ms  {:<12} {:#04x} on {}",
                milliseconds(slot.offset),
                milliseconds(slot.end),
                self.names[slot.sensor],
                chip.address,
                self.buses.get(chip.bus).map_or("?", String::as_str)
            )?;
        }
        if let Some(at) = self.housekeeping {
            write!(
                f,
                "  {:7.2} to {:6.2} ms  a die temperature, in turn",
                milliseconds(at),
                milliseconds(at + MLX_WORD)
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
