//! From configuration to a chip's plan: its channels, how it converts, its data-ready line.

use super::driver::Channel;
use super::registers::{Conversion, Gain, Rate};
use crate::config::settings::{Ads1115Settings, LineSettings};
use std::fmt;

/// Why sensors cannot share a chip as they are configured. Configuration refuses all of these
/// before; here they are an error all the same.
#[derive(Clone, Debug, PartialEq)]
pub enum SetupError {
    /// No sensor at all.
    Empty,
    /// A full scale that the chip does not have, V.
    Gain(f64),
    /// A rate that the chip does not have, conversions a second.
    Rate(u16),
    /// Continuous conversion with more than one sensor.
    ContinuousShared,
    /// Two data-ready lines for one pin.
    TwoLines,
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("an ADS1115 without a sensor"),
            Self::Gain(v) => {
                write!(f, "an ADS1115 has no gain of {v} V: set gain-v to 6.144, 4.096, 2.048, 1.024, 0.512 or 0.256")
            }
            Self::Rate(sps) => write!(
                f,
                "an ADS1115 has no rate of {sps} a second: set data-rate-sps to 8, 16, 32, 64, 128, 250, 475 or 860"
            ),
            Self::ContinuousShared => {
                f.write_str("continuous conversion needs an ADS1115 to itself: leave it out where sensors share one")
            }
            Self::TwoLines => {
                f.write_str("an ADS1115 has one ALERT/RDY pin: its sensors must name the same data-ready line")
            }
        }
    }
}

impl std::error::Error for SetupError {}

/// What a chip is to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// How it converts.
    pub(super) conversion: Conversion,
    /// What it measures, one for each sensor: at least one, exactly one in continuous mode.
    pub(super) channels: Vec<Channel>,
    /// The line that ALERT/RDY is wired to.
    pub(super) data_ready: Option<LineSettings>,
}

impl Plan {
    /// The plan for a chip whose sensors are configured as `sensors`, in the order of its slots.
    pub fn new(sensors: &[&Ads1115Settings]) -> Result<Self, SetupError> {
        let channels: Vec<Channel> = sensors.iter().map(|s| channel(s)).collect::<Result<_, _>>()?;
        let continuous = sensors.iter().any(|s| s.continuous);
        match channels.len() {
            0 => return Err(SetupError::Empty),
            1 => {}
            _ if continuous => return Err(SetupError::ContinuousShared),
            _ => {}
        }
        let mut lines = sensors.iter().filter_map(|s| s.data_ready.as_ref());
        let data_ready = lines.next().cloned();
        if lines.any(|l| Some(l) != data_ready.as_ref()) {
            return Err(SetupError::TwoLines);
        }
        let conversion = if continuous { Conversion::Continuous } else { Conversion::SingleShot };
        Ok(Self { conversion, channels, data_ready })
    }

    /// The slowest rate among the channels.
    pub fn slowest(&self) -> Rate {
        self.channels.iter().map(|c| c.rate).min_by_key(|r| r.sps()).unwrap_or_default()
    }
}

fn channel(settings: &Ads1115Settings) -> Result<Channel, SetupError> {
    Ok(Channel {
        input: settings.input,
        gain: Gain::from_full_scale_v(settings.gain_v).ok_or(SetupError::Gain(settings.gain_v))?,
        rate: Rate::from_sps(settings.data_rate_sps).ok_or(SetupError::Rate(settings.data_rate_sps))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::settings::AdcInput;

    fn settings() -> Ads1115Settings {
        Ads1115Settings {
            bus: "/dev/i2c-1".into(),
            address: 0x48,
            input: AdcInput::Ain2Ain3,
            gain_v: 4.096,
            data_rate_sps: 475,
            continuous: false,
            neutral_v: 0.0,
            kelvin_per_v: 40.0,
            data_ready: None,
        }
    }

    #[test]
    fn a_plan_has_a_channel_for_each_sensor() {
        let line = LineSettings { chip: "pinctrl-bcm2711".into(), line: 17, active_low: false };
        let first = Ads1115Settings { data_ready: Some(line.clone()), ..settings() };
        let second = Ads1115Settings { input: AdcInput::Ain0, data_rate_sps: 860, ..settings() };
        let plan = Plan::new(&[&first, &second]).unwrap();
        assert_eq!(plan.conversion, Conversion::SingleShot);
        assert_eq!(plan.channels[0], Channel { input: AdcInput::Ain2Ain3, gain: Gain::V4_096, rate: Rate::Sps475 });
        assert_eq!(plan.channels[1].rate, Rate::Sps860);
        assert_eq!(plan.slowest(), Rate::Sps475);
        assert_eq!(plan.data_ready, Some(line.clone()));

        let other = Ads1115Settings { data_ready: Some(LineSettings { line: 18, ..line }), ..settings() };
        assert_eq!(Plan::new(&[&first, &other]), Err(SetupError::TwoLines));
    }

    #[test]
    fn what_cannot_be_is_refused() {
        assert_eq!(Plan::new(&[]), Err(SetupError::Empty));
        assert_eq!(Plan::new(&[&Ads1115Settings { gain_v: 5.0, ..settings() }]), Err(SetupError::Gain(5.0)));
        assert_eq!(Plan::new(&[&Ads1115Settings { data_rate_sps: 100, ..settings() }]), Err(SetupError::Rate(100)));
        let continuous = Ads1115Settings { continuous: true, ..settings() };
        assert_eq!(Plan::new(&[&continuous]).unwrap().conversion, Conversion::Continuous);
        assert_eq!(Plan::new(&[&settings(), &continuous]), Err(SetupError::ContinuousShared));
    }
}
