//! Manual pages out of command lines and documentation.

mod markdown;

use clap::Command;
use clap_mangen::Man;
use std::fmt::Write as _;

/// The sections that a command line does not tell.
pub struct Rest {
    files: &'static [(&'static str, &'static str)],
    see_also: &'static str,
}

/// Of irhorizonctl(1).
pub const CTL: Rest = Rest {
    files: &[("/etc/irhorizon/irhorizon.toml", "the daemon's configuration, see irhorizon.toml(5)")],
    see_also: "irhorizond(8), irhorizon.toml(5)",
};

/// Of irhorizond(8).
pub const DAEMON: Rest = Rest {
    files: &[
        ("/etc/irhorizon/irhorizon.toml", "the configuration, see irhorizon.toml(5)"),
        ("/etc/irhorizon/irhorizon.toml.d/*.toml", "its drop-ins"),
    ],
    see_also: "irhorizonctl(1), irhorizon.toml(5), busctl(1)",
};

/// The page of a program: clap's own, with every command's options under it.
pub fn of_command(mut command: Command, section: u8, rest: Rest) -> String {
    command.build();
    let name = command.get_name().to_owned();
    let man = Man::new(command.clone()).section(section.to_string()).manual("irhorizon").source("irhorizon");
    let mut page = written(|out| {
        man.render_title(out)?;
        man.render_name_section(out)?;
        man.render_synopsis_section(out)?;
        man.render_description_section(out)?;
        man.render_options_section(out)
    });
    let mut commands = String::new();
    let globals: Vec<String> = command.get_arguments().map(|a| a.get_id().to_string()).collect();
    describe(&command, "", &globals, &mut commands);
    if !commands.is_empty() {
        page += &format!(".SH COMMANDS\n{commands}");
    }
    if let Some(text) = command.get_after_help() {
        page += &format!(".SH \"EXIT STATUS\"\n{}\n", text.to_string().replace('\n', "\n.br\n"));
    } else {
        page += ".SH \"EXIT STATUS\"\n0: ended by a signal, in good order; 1: failed; 64: wrong usage; 78: the configuration cannot be used.\n";
    }
    if name == "irhorizond" {
        page += ".SH SIGNALS\nSIGHUP has it read its configuration again; SIGTERM and SIGINT end it.\n";
    }
    page += ".SH FILES\n";
    for (file, what) in rest.files {
        let _ = writeln!(page, ".TP\n\\fI{}\\fR\n{what}", escaped(file));
    }
    page += &format!(".SH \"SEE ALSO\"\n{}\n", rest.see_also);
    page
}

/// The page of the configuration.
pub fn of_configuration(markdown: &str) -> String {
    let mut page = String::from(
        "'\\\" t\n.TH irhorizon.toml 5 \"\" irhorizon irhorizon\n.SH NAME\nirhorizon.toml \\- configuration of irhorizond\n\
         .SH DESCRIPTION\n",
    );
    page += &markdown::roff(markdown);
    page += ".SH \"SEE ALSO\"\nirhorizond(8), irhorizonctl(1)\n";
    page
}

/// A paragraph for each command under `parent`, commands of commands included.
fn describe(parent: &Command, words: &str, globals: &[String], page: &mut String) {
    for command in parent.get_subcommands().filter(|c| c.get_name() != "help") {
        let words = format!("{words}{} ", command.get_name());
        if command.has_subcommands() {
            describe(command, &words, globals, page);
            continue;
        }
        // What every command has is told once, at the head of the page.
        let own = command.clone().mut_args(|a| {
            let known = globals.contains(&a.get_id().to_string()) || a.get_id() == "help";
            a.hide(known)
        });
        let man = Man::new(own.clone());
        let _ = writeln!(page, ".SS {}", escaped(words.trim_end()));
        let usage = own.clone().render_usage().to_string();
        let _ = writeln!(page, ".nf\n{}\n.fi\n.PP", escaped(usage.trim_start_matches("Usage: ").trim()));
        if let Some(about) = command.get_about() {
            let _ = writeln!(page, "{}.", escaped(&about.to_string()));
        }
        let options = written(|out| man.render_options_section(out));
        let options: Vec<&str> = options
            .lines()
            .filter(|l| !l.starts_with(".SH") && !l.starts_with(".ie") && !l.starts_with(".el"))
            .collect();
        if !options.is_empty() {
            let _ = writeln!(page, "{}", options.join("\n"));
        }
        if let Some(text) = command.get_after_help().filter(|t| Some(*t) != parent.get_after_help()) {
            let _ = writeln!(page, ".PP\n{}", escaped(&text.to_string()).replace('\n', "\n.br\n"));
        }
    }
}

fn written(render: impl FnOnce(&mut dyn std::io::Write) -> std::io::Result<()>) -> String {
    let mut out = Vec::new();
    render(&mut out).unwrap();
    String::from_utf8(out).unwrap()
}

/// Text that roff takes for text.
fn escaped(text: &str) -> String {
    let text = text.replace('\\', "\\e").replace('-', "\\-");
    match text.chars().next() {
        Some('.' | '\'') => format!("\\&{text}"),
        _ => text,
    }
}
