//! Values out of an autopilot's messages. What cannot be is not heard. Pure.

use super::choice::Source;
use crate::attitude::Attitude;
use crate::frame::Aiding;
use crate::mavlink::heard::Heard;
use ::mavlink::dialects::common::{GpsFixType, HighresImuUpdatedFlags};

/// Faster nothing that flies can turn, °/s; and no number for it is larger, whatever the unit.
const FASTEST_DEG_S: f64 = 2000.0;
/// Faster nothing flies that this is for, m/s.
const FASTEST_M_S: f64 = 500.0;
/// Slower than this a course means nothing, m/s.
const COURSE_FROM_M_S: f64 = 1.0;
/// A larger dilution of precision is no fix, hundredths; that of an unknown one is none.
const DILUTED: std::ops::Range<u16> = 500..u16::MAX;
/// Stamps in µs beyond this count from 1970 and not from a start, which was not 30 years ago.
const EPOCH_USEC: u64 = 1_000_000_000_000_000;

/// A stamp of the sender.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stamp {
    /// Milliseconds since its start.
    Millis(u32),
    /// Microseconds since its start.
    Micros(u64),
    /// Microseconds since 1970.
    Epoch(u64),
    /// There is none.
    None,
}

/// What a message says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Words {
    /// Body rates, °/s, about x (nose), y (right), z (down).
    Rates(Source, [f64; 3]),
    /// The autopilot's attitude and yaw, rad, with its body rates as it said them: see [`sense`](super::sense).
    Attitude(Attitude, f64, Option<[f64; 3]>),
    /// Where it flies to, by its filter: ground speed, course, climb, altitude.
    Position(Aiding),
    /// Ground speed and course by the GPS alone; `None` while that has no fix.
    Fix(Option<Aiding>),
    /// Airspeed and climb.
    Air(Aiding),
}

/// What `heard` says, and when; `None` for a message that says nothing of this, or nothing that can be.
pub fn decode(heard: &Heard, ardupilot: bool) -> Option<(Stamp, Words)> {
    Some(match heard {
        Heard::Attitude(m) => {
            let [roll, pitch, yaw] = [m.roll, m.pitch, m.yaw].map(f64::from);
            // Betaflight has none to give and says 0; no gyro does of all three. The unit is yet to be found.
            let said = Some([m.rollspeed, m.pitchspeed, m.yawspeed].map(f64::from));
            let said = said.filter(|said| said.iter().all(|v| v.abs() <= FASTEST_DEG_S) && *said != [0.0; 3]);
            if ![roll, pitch, yaw].iter().all(|a| a.abs() <= 10.0) {
                return None;
            }
            (Stamp::Millis(m.time_boot_ms), Words::Attitude(Attitude { roll, pitch }, yaw, said))
        }
        Heard::HighresImu(m) => {
            type F = HighresImuUpdatedFlags;
            let gyro = F::HIGHRES_IMU_UPDATED_XGYRO | F::HIGHRES_IMU_UPDATED_YGYRO | F::HIGHRES_IMU_UPDATED_ZGYRO;
            if !m.fields_updated.contains(gyro) {
                return None;
            }
            let rates = rates([m.xgyro, m.ygyro, m.zgyro].map(f64::from))?;
            (micros(m.time_usec), Words::Rates(Source::HighresImu, rates))
        }
        Heard::ScaledImu(m) => {
            let rates = rates([m.xgyro, m.ygyro, m.zgyro].map(milli))?;
            (Stamp::Millis(m.time_boot_ms), Words::Rates(Source::ScaledImu, rates))
        }
        // Of others it is the gyro's own counts.
        Heard::RawImu(m) if ardupilot => {
            let rates = rates([m.xgyro, m.ygyro, m.zgyro].map(milli))?;
            (micros(m.time_usec), Words::Rates(Source::RawImu, rates))
        }
        Heard::GlobalPosition(m) => {
            let [north, east, down] = [m.vx, m.vy, m.vz].map(|v| f64::from(v) / 100.0);
            let course_deg = east.atan2(north).to_degrees().rem_euclid(360.0);
            let climb_m_s = Some(-down);
            let altitude_m = Some(f64::from(m.relative_alt) / 1000.0);
            let aiding = Aiding { climb_m_s, ..course(north.hypot(east), course_deg) };
            // Betaflight has no velocity to give and says 0.
            let aiding = if [m.vx, m.vy, m.vz] == [0; 3] { Aiding::default() } else { aiding };
            (Stamp::Millis(m.time_boot_ms), Words::Position(Aiding { altitude_m, ..aiding }))
        }
        Heard::GpsRaw(m) => {
            let no_fix =
                [GpsFixType::GPS_FIX_TYPE_NO_GPS, GpsFixType::GPS_FIX_TYPE_NO_FIX, GpsFixType::GPS_FIX_TYPE_2D_FIX];
            let fix = !no_fix.contains(&m.fix_type) && !DILUTED.contains(&m.eph);
            let speed_m_s = (m.vel != u16::MAX).then(|| f64::from(m.vel) / 100.0);
            let cog_deg = (m.cog != u16::MAX).then(|| f64::from(m.cog) / 100.0).filter(|c| *c <= 360.0);
            let aiding = match (speed_m_s, cog_deg) {
                (Some(speed), Some(cog)) => course(speed, cog.rem_euclid(360.0)),
                (speed, _) => Aiding { ground_speed_m_s: speed.filter(|v| *v <= FASTEST_M_S), ..Aiding::default() },
            };
            (micros(m.time_usec), Words::Fix(fix.then_some(aiding)))
        }
        Heard::VfrHud(m) => {
            // An autopilot without a sensor, or whose estimate has none to give, says 0.
            let airspeed_m_s = Some(f64::from(m.airspeed)).filter(|v| *v > 0.0 && *v <= FASTEST_M_S);
            let climb_m_s = Some(f64::from(m.climb)).filter(|v| *v != 0.0 && v.abs() <= FASTEST_M_S);
            (Stamp::None, Words::Air(Aiding { airspeed_m_s, climb_m_s, ..Aiding::default() }))
        }
        _ => return None,
    })
}

/// Speed and course, where they can be.
fn course(speed_m_s: f64, course_deg: f64) -> Aiding {
    if speed_m_s > FASTEST_M_S {
        return Aiding::default();
    }
    let course_deg = (speed_m_s >= COURSE_FROM_M_S).then_some(course_deg);
    Aiding { ground_speed_m_s: Some(speed_m_s), course_deg, ..Aiding::default() }
}

fn micros(usec: u64) -> Stamp {
    if usec < EPOCH_USEC { Stamp::Micros(usec) } else { Stamp::Epoch(usec) }
}

fn milli(value: i16) -> f64 {
    f64::from(value) / 1000.0
}

/// From rad/s to °/s; `None` for what cannot be.
pub fn rates(rad_s: [f64; 3]) -> Option<[f64; 3]> {
    let deg_s = rad_s.map(f64::to_degrees);
    deg_s.iter().all(|v| v.abs() <= FASTEST_DEG_S).then_some(deg_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::mavlink::dialects::common::{
        ATTITUDE_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA, HIGHRES_IMU_DATA, RAW_IMU_DATA, SCALED_IMU_DATA,
        VFR_HUD_DATA,
    };

    fn near(a: Option<f64>, b: f64) -> bool {
        a.is_some_and(|a| (a - b).abs() < 1e-4)
    }

    #[test]
    fn rates_of_every_other_message_are_degrees_a_second() {
        let attitude = ATTITUDE_DATA {
            time_boot_ms: 5,
            roll: 0.1,
            yaw: 3.0,
            rollspeed: 1.0,
            pitchspeed: -0.5,
            ..ATTITUDE_DATA::DEFAULT
        };
        let Some((Stamp::Millis(5), Words::Attitude(_, yaw, Some([p, q, r])))) =
            decode(&Heard::Attitude(attitude), false)
        else {
            panic!()
        };
        assert_eq!(([p, q, r], yaw), ([1.0, -0.5, 0.0], 3.0), "as it was said");
        let scaled = SCALED_IMU_DATA { time_boot_ms: 6, zgyro: -2000, ..SCALED_IMU_DATA::DEFAULT };
        let Some((Stamp::Millis(6), Words::Rates(Source::ScaledImu, [_, _, r]))) =
            decode(&Heard::ScaledImu(scaled), false)
        else {
            panic!()
        };
        assert!((r + 114.59156).abs() < 1e-4);
        let raw = RAW_IMU_DATA { time_usec: 7, xgyro: 1000, ..RAW_IMU_DATA::DEFAULT };
        assert_eq!(decode(&Heard::RawImu(raw.clone()), false), None, "counts of a gyro that nobody knows");
        let Some((Stamp::Micros(7), Words::Rates(Source::RawImu, [p, ..]))) = decode(&Heard::RawImu(raw), true) else {
            panic!()
        };
        assert!((p - 57.29578).abs() < 1e-4);
        let mut highres =
            HIGHRES_IMU_DATA { time_usec: 1_700_000_000_000_000, ygyro: 0.2, ..HIGHRES_IMU_DATA::DEFAULT };
        assert_eq!(highres.fields_updated.bits() & 56, 0);
        assert_eq!(decode(&Heard::HighresImu(highres.clone()), false), None, "not updated");
        highres.fields_updated = HighresImuUpdatedFlags::from_bits_truncate(63);
        let Some((stamp, Words::Rates(Source::HighresImu, [_, q, _]))) = decode(&Heard::HighresImu(highres), false)
        else {
            panic!()
        };
        assert!(stamp == Stamp::Epoch(1_700_000_000_000_000) && (q - 11.459156).abs() < 1e-4);
    }

    #[test]
    fn what_cannot_be_is_no_measurement() {
        for bad in [f32::NAN, f32::INFINITY, 2001.0, -2001.0] {
            let m = ATTITUDE_DATA { rollspeed: bad, ..ATTITUDE_DATA::DEFAULT };
            let Some((_, Words::Attitude(_, _, None))) = decode(&Heard::Attitude(m), false) else { panic!("{bad}") };
            let m = ATTITUDE_DATA { roll: bad, ..ATTITUDE_DATA::DEFAULT };
            assert_eq!(decode(&Heard::Attitude(m), false), None);
        }
        for bad in [f32::NAN, f32::INFINITY, -3.0, 501.0, 0.0] {
            let m = VFR_HUD_DATA { airspeed: bad, climb: if bad == -3.0 { 0.5 } else { bad }, ..VFR_HUD_DATA::DEFAULT };
            let Some((Stamp::None, Words::Air(air))) = decode(&Heard::VfrHud(m), false) else { panic!() };
            assert_eq!(air.airspeed_m_s, None);
            assert_eq!(air.climb_m_s.is_some(), bad == -3.0);
        }
    }

    #[test]
    fn an_attitude_that_never_turns_has_no_rates() {
        for (rollspeed, there) in [(0.0, false), (-0.0, false), (1e-6, true)] {
            let m = ATTITUDE_DATA { rollspeed, roll: 0.2, ..ATTITUDE_DATA::DEFAULT };
            let Some((_, Words::Attitude(seen, _, rates))) = decode(&Heard::Attitude(m), false) else { panic!() };
            assert!(rates.is_some() == there && seen.roll > 0.0, "{rollspeed}");
        }
    }

    #[test]
    fn velocities_are_speed_course_and_climb() {
        let m = GLOBAL_POSITION_INT_DATA {
            time_boot_ms: 9,
            relative_alt: 123_400,
            vx: -1000,
            vy: -1000,
            vz: 250,
            ..GLOBAL_POSITION_INT_DATA::DEFAULT
        };
        let Some((Stamp::Millis(9), Words::Position(a))) = decode(&Heard::GlobalPosition(m), false) else { panic!() };
        assert!(near(a.ground_speed_m_s, 200_f64.sqrt()) && near(a.course_deg, 225.0));
        assert!(near(a.climb_m_s, -2.5) && near(a.altitude_m, 123.4));
        let m = GLOBAL_POSITION_INT_DATA { relative_alt: 5000, ..GLOBAL_POSITION_INT_DATA::DEFAULT };
        let Some((_, Words::Position(a))) = decode(&Heard::GlobalPosition(m), false) else { panic!() };
        assert_eq!(a, Aiding { altitude_m: Some(5.0), ..Aiding::default() }, "no velocity");
        let m = GLOBAL_POSITION_INT_DATA { vx: 50, ..GLOBAL_POSITION_INT_DATA::DEFAULT };
        let Some((_, Words::Position(a))) = decode(&Heard::GlobalPosition(m), false) else { panic!() };
        assert_eq!((a.ground_speed_m_s, a.course_deg), (Some(0.5), None), "it stands");
    }

    #[test]
    fn a_fix_is_one_in_three_dimensions_that_knows_where() {
        let good = GPS_RAW_INT_DATA {
            time_usec: 8,
            eph: 120,
            vel: 1800,
            cog: 36_000,
            fix_type: GpsFixType::GPS_FIX_TYPE_3D_FIX,
            ..GPS_RAW_INT_DATA::DEFAULT
        };
        let fix = |m: &GPS_RAW_INT_DATA| match decode(&Heard::GpsRaw(m.clone()), false) {
            Some((Stamp::Micros(8), Words::Fix(fix))) => fix,
            other => panic!("{other:?}"),
        };
        let a = fix(&good).unwrap();
        assert!(near(a.ground_speed_m_s, 18.0) && near(a.course_deg, 0.0));
        assert_eq!(fix(&GPS_RAW_INT_DATA { fix_type: GpsFixType::GPS_FIX_TYPE_2D_FIX, ..good.clone() }), None);
        assert_eq!(fix(&GPS_RAW_INT_DATA { eph: 600, ..good.clone() }), None);
        assert!(fix(&GPS_RAW_INT_DATA { eph: u16::MAX, ..good.clone() }).is_some());
        let a = fix(&GPS_RAW_INT_DATA { vel: u16::MAX, ..good.clone() }).unwrap();
        assert_eq!((a.ground_speed_m_s, a.course_deg), (None, None));
        let a = fix(&GPS_RAW_INT_DATA { cog: u16::MAX, ..good }).unwrap();
        assert_eq!((a.ground_speed_m_s, a.course_deg), (Some(18.0), None));
    }
}
