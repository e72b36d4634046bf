//! The name of a recording that was given none.

use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

/// `irhorizon-20261121-043000.csv`, UTC.
pub(super) fn dated_name(now: SystemTime) -> PathBuf {
    let seconds = now.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Years counted from March, so that the leap day comes last: 146 097 days are 400 years.
    let day = days + 719_468;
    let (era, of_era) = (day / 146_097, day % 146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * of_year + 2) / 153;
    let day = of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    let (h, m, s) = (second / 3_600, second / 60 % 60, second % 60);
    PathBuf::from(format!("irhorizon-{year:04}{month:02}{day:02}-{h:02}{m:02}{s:02}.csv"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn names_carry_the_date() {
        for (seconds, name) in [
            (0, "irhorizon-19700101-000000.csv"),
            (951_782_400 + 86_399, "irhorizon-20000229-235959.csv"),
            (1_795_235_400, "irhorizon-20261121-043000.csv"),
        ] {
            assert_eq!(dated_name(UNIX_EPOCH + Duration::from_secs(seconds)), PathBuf::from(name));
        }
    }
}
