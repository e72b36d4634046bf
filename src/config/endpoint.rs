//! `[[mavlink.endpoint]]`.

use super::findings::Findings;
use super::section::Section;
use super::settings::{EndpointAddress, EndpointSettings, Streams};
use super::source::Place;
use std::net::SocketAddr;

/// As many endpoints as are served.
const MOST: usize = 16;

/// How an address is written.
const FORMS: &str = "udpout:host:port, udpin:address:port, tcpout:host:port, tcpin:address:port or serial:/dev/…:baud";

/// Reads the endpoints under the section `mavlink`.
pub fn read<'a>(mavlink: &mut Section<'a>, findings: &Findings<'a>, rate_hz: f64) -> Vec<EndpointSettings> {
    let tables = mavlink.list("endpoint", "[[mavlink.endpoint]]");
    if let Some((place, _)) = tables.get(MOST) {
        findings.add(*place, format!("mavlink.endpoint: there are {}, and {MOST} are served at most", tables.len()));
    }
    let mut read: Vec<(Place, EndpointSettings)> = Vec::new();
    for (i, (place, table)) in tables.into_iter().take(MOST).enumerate() {
        let prefix = format!("mavlink.endpoint ({}): ", ordinal(i + 1));
        let mut s = Section::new(findings, table, place, "[[mavlink.endpoint]]", prefix);
        let address = address(&mut s);
        let (streams, tlog) = (streams(&mut s, rate_hz), s.path("tlog", "a file that is written to"));
        let place = s.place("address");
        if let Some(address) = address {
            if let Some((first, _)) = read.iter().find(|(_, e)| collide(&e.address, &address)) {
                s.wrong("address", &format!("is taken by the endpoint on {}", findings.line(*first, place)));
            }
            if let Some((first, _)) = read.iter().find(|(_, e)| tlog.is_some() && e.tlog == tlog) {
                let line = findings.line(*first, s.place("tlog"));
                s.wrong("tlog", &format!("is the file of the endpoint on {line} too: give each its own"));
            }
            read.push((place, EndpointSettings { address, streams, tlog }));
        }
        s.finish();
    }
    read.into_iter().map(|(_, e)| e).collect()
}

/// Whether one of them leaves no place for the other. Who listens at every address of this machine does so at each, and
/// a serial port has one rate at a time.
fn collide(a: &EndpointAddress, b: &EndpointAddress) -> bool {
    use EndpointAddress::{Serial, TcpIn, UdpIn};
    let every = |all: &SocketAddr, one: &SocketAddr| all.ip().is_unspecified() && (all.is_ipv6() || one.is_ipv4());
    match (a, b) {
        (UdpIn(a), UdpIn(b)) | (TcpIn(a), TcpIn(b)) => a == b || a.port() == b.port() && (every(a, b) || every(b, a)),
        (Serial { path: a, .. }, Serial { path: b, .. }) => a == b,
        _ => a == b,
    }
}

fn streams(s: &mut Section<'_>, rate_hz: f64) -> Streams {
    let d = Streams::default();
    let expected = format!("0 (none) or 0.1 to {rate_hz} Hz, the daemon's rate");
    let mut hz = |key| s.number(key, &expected, |hz| hz == 0.0 || (0.1..=rate_hz).contains(&hz));
    Streams {
        attitude_hz: hz("attitude-hz").or(d.attitude_hz),
        quaternion_hz: hz("quaternion-hz").unwrap_or(d.quaternion_hz),
        covariance_hz: hz("covariance-hz").unwrap_or(d.covariance_hz),
        values_hz: hz("values-hz").unwrap_or(d.values_hz),
        texts: s.boolean("texts").unwrap_or(d.texts),
    }
}

fn address(s: &mut Section<'_>) -> Option<EndpointAddress> {
    if !s.has("address") {
        s.missing("address", FORMS);
    }
    let text = s.string("address", FORMS)?;
    parse(text).map_err(|problem| s.wrong("address", &problem)).ok()
}

/// An endpoint's address; the error says what is wrong with it.
pub fn parse(text: &str) -> Result<EndpointAddress, String> {
    let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
    match kind {
        "udpout" | "udpin" | "tcpout" | "tcpin" => {}
        "serial" => return serial(rest),
        _ => return Err(format!("is not an endpoint: {FORMS}")),
    }
    match socket_address(rest)? {
        to if to.port() == 0 => Err("has port 0: a port lies in 1 to 65535".into()),
        to if kind == "udpin" => Ok(EndpointAddress::UdpIn(to)),
        to if kind == "tcpin" => Ok(EndpointAddress::TcpIn(to)),
        to if to.ip().is_unspecified() => {
            let listening = kind.replace("out", "in");
            Err(format!("sends to nobody: name the receiver's address, or listen with \"{listening}:{rest}\""))
        }
        to if kind == "udpout" => Ok(EndpointAddress::UdpOut(to)),
        to => Ok(EndpointAddress::TcpOut(to)),
    }
}

/// `/dev/…:baud`; the rate is the adapter's business, its range is what adapters have.
fn serial(rest: &str) -> Result<EndpointAddress, String> {
    let example = "for example serial:/dev/serial0:921600";
    let (path, baud) = rest.rsplit_once(':').unwrap_or((rest, ""));
    match baud.parse::<u32>() {
        _ if !path.starts_with('/') => Err(format!("names no device by its absolute path: {example}")),
        Ok(baud @ 1200..=4_000_000) => Ok(EndpointAddress::Serial { path: path.into(), baud }),
        _ => Err(format!("has no good baud rate at its end, 1200 to 4000000: {example}")),
    }
}

/// `host:port`, the host as a number or `localhost`, IPv6 in brackets.
fn socket_address(text: &str) -> Result<SocketAddr, String> {
    let example = "for example 127.0.0.1:14550 or [::1]:14550";
    let Some((host, port)) = text.rsplit_once(':').filter(|(host, _)| !host.is_empty()) else {
        return Err(format!("lacks its host or its port: {example}"));
    };
    if !port.bytes().all(|b| b.is_ascii_digit()) || port.parse::<u16>().is_err() {
        return Err("has no good port at its end: a port lies in 1 to 65535".into());
    }
    let host = if host == "localhost" { "127.0.0.1" } else { host };
    if host.contains(':') && !host.starts_with('[') {
        return Err("has an IPv6 address without its brackets: for example [::1]:14550".into());
    }
    format!("{host}:{port}")
        .parse()
        .map_err(|_| format!("names a host that is neither an address in numbers nor localhost: {example}"))
}

/// `1st`, `2nd`, `3rd`, `4th` …
pub fn ordinal(n: usize) -> String {
    let ending = match (n % 10, n % 100) {
        (1, teen) if teen != 11 => "st",
        (2, teen) if teen != 12 => "nd",
        (3, teen) if teen != 13 => "rd",
        _ => "th",
    };
    format!("{n}{ending}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hosts_are_numbers_or_localhost() {
        for (text, good) in [
            ("127.0.0.1:14550", true),
            ("localhost:1", true),
            ("[::1]:14550", true),
            ("0.0.0.0:14550", true),
            ("::1:14550", false),
            ("ground:14550", false),
            ("127.0.0.1", false),
            ("127.0.0.1:", false),
            ("127.0.0.1:65536", false),
            ("127.0.0.1:+5", false),
            (":14550", false),
            ("", false),
        ] {
            assert_eq!(socket_address(text).is_ok(), good, "{text}");
        }
    }

    #[test]
    fn ordinals() {
        let of = [1, 2, 3, 4, 11, 12, 13, 21, 22, 101, 111].map(ordinal);
        assert_eq!(of.join(" "), "1st 2nd 3rd 4th 11th 12th 13th 21st 22nd 101st 111th");
    }
}
