//! `trim`: the head's trim, with what was learnt in flight, as lines of configuration.

use super::cli::TrimArgs;
use super::error::CtlError;
use super::run::print;
use super::view::Trim;
use crate::save::{FileSystem, make_drop_ins, replace};
use std::fmt::Write as _;
use std::io::Write;

/// The largest trim that a configuration may hold, °.
const LARGEST_DEG: f64 = 45.0;

/// The lines that make `trim` permanent.
pub fn lines(trim: Trim) -> String {
    let mut text = String::from("[head]\n");
    for (key, value) in [("roll-trim-deg", trim.roll_deg), ("pitch-trim-deg", trim.pitch_deg)] {
        // A number whatever was said, and never "-0.00".
        let value = if value.is_nan() { 0.0 } else { value.clamp(-LARGEST_DEG, LARGEST_DEG) };
        let hundredths = (value * 100.0).round() + 0.0;
        let _ = writeln!(text, "{key} = {:.2}", hundredths / 100.0);
    }
    text
}

/// Prints the lines, or saves them.
pub fn command(args: &TrimArgs, trim: Trim, out: &mut dyn Write, err: &mut dyn Write) -> Result<(), CtlError> {
    let text = lines(trim);
    let Some(path) = &args.save else { return print(out, &text) };
    if path.exists() && !args.force {
        return Err(CtlError::Exists { path: path.clone() });
    }
    let failed = |source| CtlError::Write { path: path.clone(), rows: None, source };
    make_drop_ins(path).and_then(|_| replace(&mut FileSystem, path, text.as_bytes())).map_err(failed)?;
    let _ = writeln!(
        err,
        "saved to {}; it holds after systemctl reload irhorizond, if that is a drop-in of its configuration and no MAVLink \
         parameter has set another",
        path.display()
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_the_trim_the_lines_are_good_configuration() {
        for value in [0.0, -0.001, 6.049, -51.0, f64::NAN, f64::INFINITY] {
            let text = lines(Trim { roll_deg: value, pitch_deg: -value, ..Trim::default() });
            assert!(!text.contains("-0.00"), "{text}");
            let text = format!("{text}[simulation]\nenabled = true\n");
            let head = crate::config::parse(&[("trim.toml".into(), text)]).unwrap().settings.head;
            let expected = if value.is_finite() { value.clamp(-45.0, 45.0) } else { head.roll_trim_deg };
            assert!((head.roll_trim_deg - expected).abs() <= 0.005 + 1e-12);
        }
    }
}
