//! Recordings as they come from the field: round trips, and everything that can be wrong with them.

use irhorizon::frame::{Aiding, Frame, Missing, Sample, Value};
use irhorizon::head::Head;
use irhorizon::recording::{MAX_LINE, Reader, Recording, RowFault, Writer};
use irhorizon::time::Time;
use proptest::prelude::*;

const HEADER: &str = "time_s,nose_obj_c,tail_obj_c";

fn open(bytes: &[u8]) -> Result<Reader<&[u8]>, String> {
    Recording::new(bytes, "flight.csv".into()).and_then(|r| r.frames(None)).map_err(|e| e.to_string())
}

/// A frame's time and objects, `None` for a missing reading.
type Row = (f64, Vec<Option<f64>>);

fn read(text: impl AsRef<[u8]>) -> (Vec<Row>, Reader<&'static [u8]>) {
    let bytes: &'static [u8] = text.as_ref().to_vec().leak();
    let mut reader = open(bytes).unwrap();
    let mut frame = Frame::default();
    let mut frames = Vec::new();
    while reader.next_frame(&mut frame).unwrap() {
        let objects = frame.readings.iter().map(|r| match r.ok()?.value {
            Value::Absolute { object_c, .. } => Some(object_c),
            Value::Volts(v) => Some(v),
        });
        frames.push((frame.time.as_nanos() as f64 / 1e9, objects.collect()));
    }
    (frames, reader)
}

fn rows(body: &str) -> (Vec<f64>, Reader<&'static [u8]>) {
    let (frames, reader) = read(format!("{HEADER}\n{body}"));
    (frames.into_iter().map(|(t, _)| t).collect(), reader)
}

#[test]
fn a_header_that_cannot_be_used_says_what_was_expected_and_what_to_do() {
    for (bytes, part) in [
        (&b""[..], "cut off before it began"),
        (b"\n\n# only a comment\n", "no header line"),
        (b"\x1f\x8b\x08\0\0\0\xff\xfe\n", "flight.csv:1: not text"),
        (b"time_s;nose_obj_c\n", "among \"time_s;nose_obj_c\"; separate the columns by commas"),
        (b"nose_obj_c\t\"time_s\"\n", "separate the columns by commas"),
        (b"nose_obj_c;tail_obj_c\n", "name the column of seconds time_s"),
        (b"nose_obj_c,tail_obj_c\n", "no time_s column among \"nose_obj_c,tail_obj_c\""),
        (b"# a\ntime_s,nose_obj_c,nose_obj_c\n", "flight.csv:2: column nose_obj_c is there twice"),
        (b"time_s,long_v,lat_v\n", "long_v, lat_v need a configuration"),
        (b"time_s,belly_obj_c\n", "--config"),
    ] {
        let error = open(bytes).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
    let long = vec![b'x'; 3 * MAX_LINE];
    assert!(open(&long).unwrap_err().contains("not text"));
}

#[test]
fn a_header_alone_is_a_recording_without_frames() {
    let (frames, reader) = rows("");
    assert!(frames.is_empty() && reader.tally().is_clean());
}

/// As the daemon gives it: what was not read anew for ten seconds says nothing of now.
#[test]
fn a_die_temperature_lasts_ten_seconds() {
    let cells = |t: u32| if t.is_multiple_of(20) { "15.5" } else { "" };
    let body: String = (0..40).map(|t| format!("{t}.00,{},7\n", cells(t))).collect();
    let text = format!("time_s,nose_amb_c,nose_obj_c\n{body}");
    let (mut reader, mut frame) = (open(text.as_bytes()).unwrap(), Frame::default());
    for t in 0..40 {
        assert!(reader.next_frame(&mut frame).unwrap());
        let Ok(Sample { value, .. }) = frame.readings[0] else { panic!("{t} s: no reading") };
        assert_eq!(value.ambient_c(), (t % 20 <= 10).then_some(15.5), "{t} s");
    }
}

#[test]
fn every_bad_row_costs_itself_alone() {
    let body = "0.00,1,2\n\
                nonsense,1,2\n\
                ,1,2\n\
                0.02,1\n\
                0.04,1,2,3\n\
                0.06,1,2,\n\
                0.06,1,2\n\
                0.05,1,2\n\
                \n\
                # a remark\n\
                99999.0,1,2\n\
                \u{0}\u{1}\u{7}\n\
                0.08,1,2\n\
                0.10,1";
    let (times, reader) = rows(body);
    assert_eq!(times, [0.0, 0.06, 0.08]);
    let t = reader.tally();
    assert_eq!((t.rows, t.unusable()), (12, 9));
    for (fault, n) in [
        (RowFault::NoTime, 2),
        (RowFault::Ragged, 3),
        (RowFault::Backwards, 2),
        (RowFault::Ahead, 1),
        (RowFault::Truncated, 1),
    ] {
        assert_eq!(t.count(fault), n, "{fault:?}");
    }
    assert!(t.to_string().contains("1 truncated (line 15)"), "{t}");
}

#[test]
fn a_leap_that_goes_on_is_believed() {
    let (times, reader) = rows("1,1,2\n90000,1,2\n90000.02,1,2\n90000.04,1,2\n");
    assert_eq!(times, [1.0, 90000.0, 90000.02, 90000.04]);
    assert_eq!(reader.tally().count(RowFault::Ahead), 0);
}

#[test]
fn one_row_far_ahead_costs_itself_alone_wherever_it_stands() {
    let rows_of = |wrong: usize, at: f64| -> String {
        let time = |i: usize| if i == wrong { at } else { 10.0 + 0.02 * i as f64 };
        (0..50).map(|i| format!("{:.2},1,2\n", time(i))).collect()
    };
    for at in [11.5, 70.0, 3000.0, 1e6] {
        for wrong in [0, 1, 25, 48] {
            let (times, reader) = rows(&rows_of(wrong, at));
            assert_eq!(times.len(), 49, "row {wrong} at {at} s: {}", reader.tally());
            assert!(times.iter().all(|t| *t < 11.0));
            assert_eq!((reader.tally().unusable(), reader.tally().count(RowFault::Ahead)), (1, 1));
        }
    }
    // The last is alone where nothing comes after it for an hour.
    assert_eq!(rows(&rows_of(49, 1e6)).0.len(), 49);
    assert_eq!(rows(&rows_of(49, 70.0)).0.len(), 50);
}

#[test]
fn a_clock_that_was_set_back_costs_a_second_and_times_go_on_rising() {
    let body: String = (0..100)
        .map(|i| if i < 50 { 5e4 } else { 10.0 } + 0.1 * f64::from(i))
        .fold(String::new(), |text, t| text + &format!("{t:.1},1,2\n"));
    let (times, reader) = rows(&body);
    assert_eq!(times.len(), 90, "{}", reader.tally());
    assert!(times.windows(2).all(|t| t[1] > t[0]));
    assert!((times[50] - times[49] - 10.0).abs() < 1e-6 && (times[51] - times[50] - 0.1).abs() < 1e-6);
    assert_eq!(reader.tally().count(RowFault::Backwards), 10);
    assert!(reader.tally().to_string().contains("the clock was set back (line 62): "), "{}", reader.tally());
}

#[test]
fn rows_that_come_late_are_left_out_and_set_no_clock_back() {
    // Half a second, three seconds late; two clocks mixed.
    let late = |from: usize, to: usize| {
        let mut order: Vec<usize> = (0..500).collect();
        order[from..to].rotate_left(10);
        order.iter().map(|i| format!("{:.2},1,2\n", 10.0 + 0.02 * *i as f64)).collect::<String>()
    };
    let mixed: String = (0..200).map(|i| format!("{:.2},1,2\n{:.2},1,2\n", 90.0 + 0.02 * f64::from(i), 10.0)).collect();
    for (body, kept) in [(late(100, 135), 490), (late(100, 260), 490), (mixed, 200)] {
        let (times, reader) = rows(&body);
        assert!(times.len() >= kept - 1 && times.windows(2).all(|t| t[1] > t[0]), "{}", reader.tally());
        assert!(!reader.tally().to_string().contains("clock"), "{}", reader.tally());
    }
}

#[test]
fn an_overlong_row_is_passed_over() {
    let (times, reader) = rows(&format!("0,1,2\n1,{},2\n2,1,2\n", "9".repeat(5 * MAX_LINE)));
    assert_eq!(times, [0.0, 2.0]);
    assert_eq!(reader.tally().count(RowFault::TooLong), 1);
}

#[test]
fn cells_without_a_usable_number_are_missing_readings_and_counted() {
    let text = format!("{HEADER}\n0,,2\n1,nan,2\n2,inf,2\n3,abc,2\n4,-300,2\n5,1e999,2\n");
    let mut reader = open(text.as_bytes()).unwrap();
    let mut frame = Frame::default();
    for expected in [
        Missing::Empty,
        Missing::Impossible,
        Missing::Impossible,
        Missing::Empty,
        Missing::Impossible,
        Missing::Impossible,
    ] {
        assert!(reader.next_frame(&mut frame).unwrap());
        assert_eq!(frame.readings[0], Err(expected), "at {:?}", frame.time);
        assert!(frame.readings[1].is_ok());
    }
    assert_eq!(reader.tally().cells, 5);
}

#[test]
fn what_other_programs_do_to_a_csv_changes_nothing() {
    for text in [
        "\u{feff}time_s,nose_obj_c,tail_obj_c\r\n0.5,-1.25,3\r\n",
        "\"time_s\", \"nose_obj_c\" ,tail_obj_c\n\"0.5\",\"-1.25\", 3\n",
        "tail_obj_c,time_s,nose_obj_c\n3,0.5,-1.25",
        "# made by hand\n\ntime_s,note,nose_obj_c,tail_obj_c\n5e-1,\"a, b\",-1.25,3\n",
    ] {
        let (frames, reader) = read(text);
        assert_eq!(frames.len(), 1, "{text}: {}", reader.tally());
        let nose = reader.head().sensors.iter().position(|s| s.name == "nose").unwrap();
        assert_eq!((frames[0].0, frames[0].1[nose], frames[0].1[1 - nose]), (0.5, Some(-1.25), Some(3.0)));
    }
}

#[test]
fn unknown_columns_are_ignored_with_one_notice_and_the_reference_stays_outside_the_frame() {
    let text =
        "time_s,foo,nose_obj_c,battery_v,ref_roll_deg,tail_obj_c,course_deg\n0,a,1,12.6,17.5,2,90\n1,b,1,12.6,,2,\n";
    let mut reader = open(text.as_bytes()).unwrap();
    assert_eq!(reader.notices(), ["2 columns not known and ignored: foo, battery_v"]);
    let mut frame = Frame::default();
    reader.next_frame(&mut frame).unwrap();
    assert_eq!(reader.reference().roll_deg, Some(17.5));
    assert_eq!(frame.aiding, Aiding { course_deg: Some(90.0), ..Aiding::default() });
    reader.next_frame(&mut frame).unwrap();
    assert_eq!(reader.reference().roll_deg, None);
    assert_eq!(frame.aiding, Aiding::default());
}

#[test]
fn the_configuration_comes_back_out_of_the_comments() {
    let config = "[daemon]\nrate-hz = 50.0\n\n[[sensor]]\nname = \"nose\"\n";
    let text = Writer::new(&Head::six(), config).header().to_owned();
    assert_eq!(Recording::new(text.as_bytes(), "f".into()).unwrap().config(), Some(config));
    let plain = Recording::new(&b"# a flight over the fens\ntime_s,nose_obj_c\n"[..], "f".into()).unwrap();
    assert_eq!(plain.config(), None);
}

#[test]
fn our_own_last_line_without_its_end_may_be_cut_and_is_dropped() {
    let whole = "# irhorizon 1.0\ntime_s,nose_obj_c\n0,1.25\n1,1.25\n";
    assert_eq!(read(whole).0.len(), 2);
    assert_eq!(read(&whole[..whole.len() - 1]).0.len(), 1);
}

#[test]
fn a_configured_head_that_is_not_in_the_recording_is_an_error() {
    let open = |header: &'static str| {
        let recording = Recording::new(header.as_bytes(), "f".into()).unwrap();
        recording.frames(Some(Head::six()))
    };
    let error = open("time_s,long_v\n").unwrap_err().to_string();
    assert!(error.contains("belong to this recording"), "{error}");
    let reader = open("time_s,nose_obj_c\n").unwrap();
    assert!(reader.notices()[0].starts_with("no column tail_obj_c, left_obj_c"));
    assert_eq!(reader.head().sensors.len(), 6);
}

fn cell(range: std::ops::Range<f64>) -> impl Strategy<Value = Option<f64>> {
    proptest::option::weighted(0.8, range)
}

proptest! {
    #[test]
    fn what_is_written_is_read(
        rows in proptest::collection::vec(
            (1_u64..60_000_000, proptest::array::uniform6(cell(-70.0..380.0)), cell(-180.0..180.0)), 1..20),
        ambient in cell(-40.0..125.0),
    ) {
        let head = Head::six();
        let writer = Writer::new(&head, "");
        let mut text = writer.header().to_owned();
        let mut frames = Vec::new();
        let mut micros = 0;
        for (step, objects, gyro) in rows {
            micros += step;
            let time = Time::from_nanos(micros * 1_000);
            let mut frame = Frame::new(6);
            frame.time = time;
            for (r, o) in frame.readings.iter_mut().zip(objects) {
                *r = match o {
                    Some(object_c) => {
                        Ok(Sample { value: Value::Absolute { object_c, ambient_c: ambient }, time })
                    }
                    None => Err(Missing::NoAnswer),
                };
            }
            frame.aiding.gyro_deg_s[1] = gyro;
            writer.row(&frame, &mut text);
            frames.push(frame);
        }
        let mut reader = Recording::new(text.as_bytes(), "f".into()).unwrap().frames(None).unwrap();
        let mut got = Frame::default();
        for frame in &frames {
            prop_assert!(reader.next_frame(&mut got).unwrap());
            prop_assert_eq!(got.time, frame.time);
            for (a, b) in got.readings.iter().zip(&frame.readings) {
                match (a, b) {
                    (Ok(a), Ok(b)) => {
                        let (Value::Absolute { object_c: x, ambient_c: p },
                             Value::Absolute { object_c: y, ambient_c: q }) = (a.value, b.value) else {
                            panic!("six absolute sensors");
                        };
                        prop_assert!((x - y).abs() < 0.00501 && p.is_some() == q.is_some());
                    }
                    (Err(Missing::Empty), Err(_)) => {}
                    other => prop_assert!(false, "{other:?}"),
                }
            }
            prop_assert_eq!(got.aiding.gyro_deg_s[1].is_some(), frame.aiding.gyro_deg_s[1].is_some());
        }
        prop_assert!(!reader.next_frame(&mut got).unwrap());
        prop_assert!(reader.tally().is_clean());
    }

    #[test]
    fn bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..600), header in any::<bool>()) {
        let mut text = if header { b"time_s,nose_obj_c,up_amb_c,up_obj_c\n".to_vec() } else { Vec::new() };
        text.extend(bytes);
        if let Ok(mut reader) = open(&text) {
            let mut frame = Frame::default();
            let mut last = None;
            while reader.next_frame(&mut frame).unwrap() {
                prop_assert!(last < Some(frame.time));
                last = Some(frame.time);
            }
            let _ = reader.tally().to_string();
        }
    }
}
