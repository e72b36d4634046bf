//! A chip by its label, name or path, and a line on it.
//!
//! The number in `/dev/gpiochipN` is no identity: it changed on the Raspberry Pi 5 and differs
//! with the order of probing. The label is what the driver calls the chip.

use super::GpioError;
use crate::config::settings::LineSettings;
use gpio_cdev::{Chip, Line};
use std::fmt;
use std::path::{Path, PathBuf};

/// What the consumer of our lines is called: `gpioinfo` shows it.
pub(super) const CONSUMER: &str = "irhorizon";

/// A chip as it may be asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Known {
    label: String,
    name: String,
    path: PathBuf,
}

/// The line that `settings` name, not yet requested.
pub fn find(settings: &LineSettings) -> Result<Line, GpioError> {
    let mut chip = open(&settings.chip)?;
    let (label, lines) = (chip.label().to_owned(), chip.num_lines());
    chip.get_line(settings.line).map_err(|_| GpioError::NoLine { chip: label, line: settings.line, lines })
}

/// The chip called `wanted`: by path when it begins with `/`, else by label, else by name.
fn open(wanted: &str) -> Result<Chip, GpioError> {
    if wanted.starts_with('/') {
        let path = Path::new(wanted);
        return Chip::new(path).map_err(|e| GpioError::opening(path, &e));
    }
    let (known, refused) = list();
    let path = match choose(wanted, &known) {
        // A chip that may not be opened may be the one.
        Err(GpioError::NoChip { .. }) if refused.is_some() => {
            return Err(GpioError::Denied(refused.unwrap_or_default()));
        }
        chosen => chosen?,
    };
    Chip::new(path).map_err(|e| GpioError::opening(path, &e))
}

/// All chips, in the order of their paths, and one that may not be opened, if there is one.
fn list() -> (Vec<Known>, Option<PathBuf>) {
    let mut paths: Vec<PathBuf> = std::fs::read_dir("/dev")
        .into_iter()
        .flatten()
        .flatten()
        .filter(|e| e.file_name().to_string_lossy().starts_with("gpiochip"))
        .map(|e| e.path())
        .collect();
    paths.sort();
    let (mut known, mut refused) = (Vec::<Known>::new(), None);
    for path in paths {
        match Chip::new(&path) {
            // Links under old numbers lead to a chip that is listed already.
            Ok(chip) if known.iter().any(|k| k.name == chip.name()) => {}
            Ok(chip) => known.push(Known { label: chip.label().to_owned(), name: chip.name().to_owned(), path }),
            Err(e) => {
                if let GpioError::Denied(path) = GpioError::opening(&path, &e) {
                    refused = Some(path);
                }
            }
        }
    }
    (known, refused)
}

fn choose<'a>(wanted: &str, known: &'a [Known]) -> Result<&'a Path, GpioError> {
    let labelled: Vec<&Known> = known.iter().filter(|k| k.label == wanted).collect();
    match labelled[..] {
        [one] => Ok(&one.path),
        [] => known.iter().find(|k| k.name == wanted).map(|k| k.path.as_path()).ok_or_else(|| GpioError::NoChip {
            wanted: wanted.to_owned(),
            present: known.iter().map(|k| format!("{:?} ({})", k.label, k.name)).collect(),
        }),
        _ => Err(GpioError::Ambiguous {
            wanted: wanted.to_owned(),
            paths: labelled.iter().map(|k| k.path.clone()).collect(),
        }),
    }
}

/// "line 17 of pinctrl-bcm2711".
pub(super) struct Shown<'a>(pub &'a Line);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {} of GPIO chip {:?}", self.0.offset(), self.0.chip().label())
    }
}

/// Why a request for `line` was refused.
pub(super) fn refused(line: &Line, tried: &'static str, cause: &gpio_cdev::Error) -> GpioError {
    match line.info() {
        Ok(info) if info.is_kernel() => GpioError::Busy {
            chip: line.chip().label().to_owned(),
            line: line.offset(),
            consumer: info.consumer().unwrap_or("the kernel").to_owned(),
        },
        _ => GpioError::failed(tried, Shown(line), cause),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(chips: &[(&str, &str)]) -> Vec<Known> {
        chips
            .iter()
            .map(|(label, name)| Known {
                label: (*label).into(),
                name: (*name).into(),
                path: Path::new("/dev").join(name),
            })
            .collect()
    }

    #[test]
    fn a_label_goes_before_a_name() {
        let chips = known(&[("gpio-brcmstb", "gpiochip0"), ("gpiochip0", "gpiochip1"), ("pinctrl-rp1", "gpiochip2")]);
        assert_eq!(choose("pinctrl-rp1", &chips), Ok(Path::new("/dev/gpiochip2")));
        assert_eq!(choose("gpiochip0", &chips), Ok(Path::new("/dev/gpiochip1")));
        assert_eq!(choose("gpiochip2", &chips), Ok(Path::new("/dev/gpiochip2")));
    }

    #[test]
    fn a_chip_that_is_not_there_lists_those_that_are() {
        let chips = known(&[("pinctrl-bcm2711", "gpiochip0"), ("raspberrypi-exp-gpio", "gpiochip1")]);
        let said = choose("pinctrl-rp1", &chips).unwrap_err().to_string();
        assert_eq!(
            said,
            r#"no GPIO chip "pinctrl-rp1": there are "pinctrl-bcm2711" (gpiochip0), "raspberrypi-exp-gpio" (gpiochip1)"#
        );
        assert!(choose("x", &[]).unwrap_err().to_string().contains("gpiodetect"));
    }

    #[test]
    fn two_chips_with_one_label_ask_for_a_path() {
        let chips = known(&[("mcp23017", "gpiochip1"), ("mcp23017", "gpiochip2")]);
        let said = choose("mcp23017", &chips).unwrap_err().to_string();
        assert_eq!(said, r#"several GPIO chips are "mcp23017": name one of /dev/gpiochip1, /dev/gpiochip2"#);
    }

    #[test]
    fn paths_that_lead_nowhere_or_to_something_else_are_errors() {
        let settings = |chip: &str| LineSettings { chip: chip.into(), line: 0, active_low: false };
        assert!(matches!(find(&settings("/dev/gpiochip-none")), Err(GpioError::NoChip { .. })));
        assert!(matches!(find(&settings("/dev/null")), Err(GpioError::Failed { .. })));
        assert!(find(&settings("no such label")).is_err());
    }

    #[test]
    fn lines_beyond_the_chip_are_named() {
        let beyond = |lines| GpioError::NoLine { chip: "c".into(), line: 54, lines }.to_string();
        assert_eq!(beyond(54), r#"GPIO chip "c" has no line 54: its lines are 0 to 53"#);
        assert_eq!(beyond(0), r#"GPIO chip "c" has no line 54: it has none"#);
    }
}
