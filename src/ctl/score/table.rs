//! Scores as people read them: a row for each method.

use super::statistics::Score;
use crate::ctl::error::printable;
use std::fmt::Write as _;

/// Titles over groups of columns, then over each; their widths; decimals.
const GROUPS: [(&str, usize); 7] = [
    ("", 8),
    ("with-", 7),
    ("rms °", 14),
    ("bias °", 14),
    ("larger error °", 21),
    ("underest. °", 14),
    ("within 2σ %", 21),
];
const TITLES: [&str; 14] = [
    "rows", "held %", "roll", "pitch", "roll", "pitch", "50 %", "95 %", "99 %", "99 %", "worst", "roll", "pitch",
    "both",
];
const WIDTHS: [usize; 14] = [8, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7];
const DECIMALS: [usize; 14] = [0, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 1, 1, 1];

/// A line for each score under two lines of titles.
pub fn table(scores: &[(String, Score)]) -> String {
    let scores: Vec<_> = scores.iter().map(|(name, score)| (printable(name), score)).collect();
    let width = scores.iter().map(|(name, _)| name.chars().count()).chain(["method".len()]).max().unwrap_or(0);
    let mut text = " ".repeat(width);
    for (title, columns) in GROUPS {
        let _ = write!(text, "{title:>columns$}");
    }
    let _ = write!(text, "\n{:<width$}", "method");
    for (title, columns) in TITLES.iter().zip(WIDTHS) {
        let _ = write!(text, "{title:>columns$}");
    }
    text.push('\n');
    for (name, score) in &scores {
        let _ = write!(text, "{name:<width$}");
        let mut score = **score;
        let rows = Some(score.rows as f64);
        let values = std::iter::once(rows).chain(score.figures().map(|f| *f));
        for ((value, columns), decimals) in values.zip(WIDTHS).zip(DECIMALS) {
            let _ = match value {
                Some(v) => write!(text, "{:>columns$.decimals$}", unsigned_zero(v, decimals)),
                None => write!(text, "{:>columns$}", "–"),
            };
        }
        text.push('\n');
    }
    text
}

/// The value, but no zero with a sign after rounding.
pub fn unsigned_zero(value: f64, decimals: usize) -> f64 {
    if value.abs() < 0.5 * 0.1_f64.powi(decimals as i32) { 0.0 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_under_their_titles() {
        let score = Score { rows: 7, roll_bias_deg: Some(-0.001), error_p99_deg: Some(123.456), ..Score::default() };
        let text = table(&[("a name that is long".into(), score), ("b".into(), Score::default())]);
        let widths: Vec<usize> = text.lines().map(|l| l.chars().count()).collect();
        assert!(widths.iter().all(|w| *w == widths[0]), "{text}");
        let cells: Vec<&str> = text.lines().nth(2).unwrap().split_whitespace().skip(5).collect();
        assert_eq!(cells, ["7", "–", "–", "–", "0.00", "–", "–", "–", "123.46", "–", "–", "–", "–", "–"]);
    }

    #[test]
    fn groups_cover_whole_columns() {
        let mut ends = WIDTHS.iter().scan(0, |at, w| {
            *at += w;
            Some(*at)
        });
        let mut at = 0;
        for (title, width) in GROUPS {
            at += width;
            assert!(ends.any(|e| e == at), "{title}");
        }
        assert_eq!(at, WIDTHS.iter().sum::<usize>());
    }
}
