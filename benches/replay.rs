//! `irhorizonctl replay` of an hour at 50 Hz: `cargo bench --bench replay`.

use irhorizon::config::settings::SimulationSettings;
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use irhorizon::recording::Writer;
use irhorizon::simulation::SimulatedSource;
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use std::fmt::Write as _;
use std::process::Command;
use std::time::Instant;

fn main() {
    let head = Head::six();
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let mut source = SimulatedSource::new(&SimulationSettings::default(), &head, field);
    let writer = Writer::new(&head, "");
    let mut text = String::new();
    let _ = write!(text, "{}", writer.header());
    let mut frame = Frame::new(6);
    for i in 0..3600 * 50 {
        source.scan(Time::from_secs_f64(f64::from(i) * 0.02), &mut frame);
        writer.row(&frame, &mut text);
    }
    let dir = std::env::temp_dir();
    let (input, output) = (dir.join("irhorizon-hour.csv"), dir.join("irhorizon-hour-out.csv"));
    std::fs::write(&input, &text).expect("a temporary file");
    let mut times: Vec<f64> = (0..7)
        .map(|_| {
            let start = Instant::now();
            let status = Command::new(env!("CARGO_BIN_EXE_irhorizonctl"))
                .arg("replay")
                .args([input.as_os_str(), "--output".as_ref(), output.as_os_str()])
                .status()
                .expect("irhorizonctl runs");
            assert!(status.success());
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let lines = std::fs::read_to_string(&output).map(|t| t.lines().count()).unwrap_or(0);
    println!(
        "replay of an hour at 50 Hz ({:.1} MB in, {lines} lines out): median {:.2} s, best {:.2} s, worst {:.2} s",
        text.len() as f64 / 1e6,
        times[3],
        times[0],
        times[6]
    );
    let _ = std::fs::remove_file(input);
    let _ = std::fs::remove_file(output);
}
