//! Modes and faults as bars over time, their names beside them.

use super::axis::Axis;
use super::chart::grid;
use super::spans::{Span, Spans};
use super::style::{FAULT, FRAME, SOFT, STRIP};
use super::svg::{Anchor, Area, Svg, cut};
use crate::attitude::Mode;
use crate::fault::{FaultKind, FaultName};

/// The height of a strip for the modes, or for one fault.
pub const LINE: f64 = 20.0;
/// The narrowest bar.
const NARROWEST: f64 = 1.0;

/// The modes with their colours, darker as less can be trusted.
const MODES: [(Mode, &str); 4] =
    [(Mode::Starting, "#ffffff"), (Mode::Nominal, "#d9e6d3"), (Mode::Degraded, "#e6a93c"), (Mode::Faulted, "#7d2e20")];

/// The mode at each time, and beside it what each colour means.
pub fn modes(svg: &mut Svg, area: Area, x: &Axis, spans: &Spans<Mode>) {
    title(svg, area, "mode");
    svg.clipped(area, |svg| {
        for (mode, colour) in MODES {
            for bar in bars(area, x, spans, mode) {
                svg.fill(bar, colour);
            }
        }
    });
    svg.outline(area, FRAME);
    let seen: Vec<_> = MODES.into_iter().filter(|(m, _)| spans.keys().contains(m)).collect();
    // Two beside each other, and two below.
    let top = area.y + if seen.len() > 2 { -3.0 } else { 4.0 };
    for (i, (mode, colour)) in seen.into_iter().enumerate() {
        let (right, down) = ((i % 2) as f64 * 88.0, (i / 2) as f64 * 16.0);
        let sample = Area { x: area.right() + 16.0 + right, y: top + down, width: 12.0, height: 12.0 };
        svg.fill(sample, colour);
        svg.outline(sample, FRAME);
        svg.text((sample.right() + 6.0, sample.y + 10.5), Anchor::Start, 12.0, "", mode.as_str());
    }
}

/// A line for each fault that there was.
pub fn faults(svg: &mut Svg, area: Area, x: &Axis, x_name: &str, spans: &Spans<FaultKind>, names: &dyn FaultName) {
    svg.fill(area, STRIP);
    grid(svg, area, x, Some(x_name));
    title(svg, area, "faults");
    let keys = spans.keys();
    for (i, key) in keys.iter().enumerate() {
        let line = Area { y: area.y + LINE * i as f64 + 4.0, height: LINE - 8.0, ..area };
        svg.clipped(area, |svg| {
            for bar in bars(line, x, spans, *key) {
                svg.fill(bar, FAULT);
            }
        });
        let name = key.display(names).to_string();
        svg.text((area.right() + 16.0, line.y + 10.5), Anchor::Start, 12.0, "", &cut(&name, 30));
    }
    if keys.is_empty() {
        let place = (area.right() + 16.0, area.y + 14.5);
        svg.text(place, Anchor::Start, 12.0, &format!(" fill=\"{SOFT}\""), "none");
    }
    svg.outline(area, FRAME);
}

fn title(svg: &mut Svg, area: Area, text: &str) {
    svg.text((area.x - 7.0, area.y + 14.5), Anchor::End, 13.0, "", text);
}

/// The bars of `key` along the axis.
fn bars<K: Copy + PartialEq>(area: Area, x: &Axis, spans: &Spans<K>, key: K) -> Vec<Area> {
    let second = area.width / (x.high() - x.low());
    let bar = |s: Span<K>| {
        let left = area.x + area.width * x.share(s.start_s);
        Area { x: left, width: ((s.end_s - s.start_s) * second).max(NARROWEST), ..area }
    };
    spans.of(key, NARROWEST / second).into_iter().map(bar).collect()
}
