//! What is made from other files is as they say: man pages, completions. `UPDATE_GOLDEN=1` writes them anew.
//!
//! | made | from |
//! |---|---|
//! | `packaging/man/irhorizonctl.1`, `packaging/man/irhorizond.8` | the command lines |
//! | `packaging/man/irhorizon.toml.5` | `docs/configuration.md` |
//! | `packaging/completions/*` | the command lines |

mod golden_file;
mod manual;

use clap::{Command, CommandFactory};
use clap_complete::Shell;
use std::fs;
use std::path::Path;

fn golden(name: &str, text: &str) {
    assert_eq!(golden_file::difference(format!("packaging/{name}"), text), None);
}

fn ctl() -> Command {
    irhorizon::ctl::cli::Cli::command()
}

fn daemon() -> Command {
    irhorizon::daemon::cli::Cli::command()
}

#[test]
fn manual_pages_say_what_the_command_lines_say() {
    golden("man/irhorizonctl.1", &manual::of_command(ctl(), 1, manual::CTL));
    golden("man/irhorizond.8", &manual::of_command(daemon(), 8, manual::DAEMON));
}

#[test]
fn the_manual_page_of_the_configuration_says_what_the_documentation_says() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/configuration.md")).unwrap();
    golden("man/irhorizon.toml.5", &manual::of_configuration(&page));
}

#[test]
fn completions_complete_the_command_lines() {
    for (shell, folder) in [(Shell::Bash, "bash"), (Shell::Zsh, "zsh"), (Shell::Fish, "fish")] {
        for (mut command, name) in [(ctl(), "irhorizonctl"), (daemon(), "irhorizond")] {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut command, name, &mut text);
            let file = match shell {
                Shell::Zsh => format!("_{name}"),
                Shell::Fish => format!("{name}.fish"),
                _ => name.to_owned(),
            };
            let text = String::from_utf8(text).unwrap();
            golden(&format!("completions/{folder}/{file}"), &text);
        }
    }
}
