//! Decimal numbers to and from text, fast and without allocation.

use std::fmt::Write as _;

/// Powers of ten that a number is scaled by before it is printed.
const SCALES: [f64; 10] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];

/// Appends `value` with `decimals` (at most 9) digits behind the point, rounded half away from
/// zero, never as `-0`. What is not finite is no number and appends nothing: an empty cell.
pub fn push_fixed(out: &mut String, value: f64, decimals: usize) {
    let decimals = decimals.min(9);
    let scaled = (value * SCALES[decimals]).round();
    if scaled.is_nan() || value.is_infinite() {
        return;
    }
    if scaled.abs() >= 9e15 {
        // Past the integers that a float holds exactly; never met in a sane recording.
        let _ = write!(out, "{value:.decimals$}");
        return;
    }
    if scaled < 0.0 {
        out.push('-');
    }
    push_digits(out, scaled.abs() as u64, decimals);
}

/// Appends `scaled / 10^decimals`, exactly.
pub fn push_digits(out: &mut String, mut scaled: u64, decimals: usize) {
    // 20 digits of a u64 and the point.
    let mut digits = [b'0'; 24];
    let mut at = digits.len();
    let mut written = 0;
    while written <= decimals || scaled > 0 {
        if written == decimals && decimals > 0 {
            at -= 1;
            digits[at] = b'.';
        }
        at -= 1;
        digits[at] = b'0' + (scaled % 10) as u8;
        scaled /= 10;
        written += 1;
    }
    out.push_str(std::str::from_utf8(&digits[at..]).unwrap_or_default());
}

/// A cell's number; `None` when it is not one. `nan` and `inf` are numbers here.
pub(super) fn parse(cell: &[u8]) -> Option<f64> {
    std::str::from_utf8(cell).ok()?.parse().ok()
}

/// Seconds as nanoseconds, exactly where they are plain decimals; `None` when they are not finite,
/// negative, or beyond 1e10 s.
pub(super) fn parse_nanos(cell: &[u8]) -> Option<u64> {
    let seconds = parse(cell)?;
    if !(0.0..1e10).contains(&seconds) {
        return None;
    }
    plain_nanos(cell).or(Some((seconds * 1e9).round() as u64))
}

/// `digits[.digits]` with at most 10 before and 9 behind the point.
fn plain_nanos(cell: &[u8]) -> Option<u64> {
    let (mut nanos, mut behind, mut point) = (0_u64, 0, false);
    if cell.len() > 20 {
        return None;
    }
    for &b in cell {
        match b {
            b'0'..=b'9' if behind < 9 => {
                nanos = nanos.checked_mul(10)?.checked_add(u64::from(b - b'0'))?;
                behind += i32::from(point);
            }
            b'.' if !point => point = true,
            _ => return None,
        }
    }
    (behind..9).try_fold(nanos, |n, _| n.checked_mul(10))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fixed(value: f64, decimals: usize) -> String {
        let mut s = String::new();
        push_fixed(&mut s, value, decimals);
        s
    }

    #[test]
    fn numbers_print_as_people_write_them() {
        for (value, decimals, text) in [
            (0.0, 3, "0.000"),
            (-0.0001, 3, "0.000"),
            (-12.345, 2, "-12.35"),
            (0.05, 2, "0.05"),
            (7.0, 0, "7"),
            (1234567.891, 6, "1234567.891000"),
            (1e17, 1, "100000000000000000.0"),
            (f64::NAN, 3, ""),
            (f64::NEG_INFINITY, 3, ""),
        ] {
            assert_eq!(fixed(value, decimals), text);
        }
    }

    #[test]
    fn seconds_are_exact_to_the_nanosecond() {
        assert_eq!(parse_nanos(b"123456789.123456789"), Some(123_456_789_123_456_789));
        assert_eq!(parse_nanos(b"0.1"), Some(100_000_000));
        assert_eq!(parse_nanos(b"1e2"), Some(100_000_000_000));
        assert_eq!(parse_nanos(b"0.1234567891234"), Some(123_456_789));
        for bad in ["", "-1", "nan", "inf", "1e300", "x", "1.2.3", "99999999999"] {
            assert_eq!(parse_nanos(bad.as_bytes()), None, "{bad}");
        }
    }

    proptest! {
        #[test]
        fn what_is_printed_reads_back_within_half_a_digit(value in -1e6..1e6_f64, decimals in 0_usize..7) {
            let back: f64 = fixed(value, decimals).parse().unwrap();
            prop_assert!((back - value).abs() <= 0.5000001 * 10_f64.powi(-(decimals as i32)));
        }
    }
}
