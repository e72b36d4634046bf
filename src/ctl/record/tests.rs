use super::*;
use crate::recording::Taps;

#[derive(Default)]
struct SmallDisk {
    bytes: Vec<u8>,
    room: usize,
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = bytes.len().min(self.room - self.bytes.len());
        self.bytes.extend_from_slice(&bytes[..n]);
        if n == 0 && !bytes.is_empty() { Err(ErrorKind::StorageFull.into()) } else { Ok(n) }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Sink for SmallDisk {
    fn cut(&mut self, len: u64) -> io::Result<()> {
        self.bytes.truncate(len as usize);
        Ok(())
    }
}

fn stream(rows: usize) -> OwnedFd {
    let taps = Taps::new("# irhorizon\ntime_s,nose_obj_c\n");
    let fd = taps.subscribe().unwrap();
    let mut line = String::new();
    for i in 0..rows {
        taps.offer(&mut line, |l| l.push_str(&format!("{i},1\n")));
    }
    fd
}

#[test]
fn rows_are_written_until_the_daemon_ends() {
    let mut disk = SmallDisk { room: 1000, ..SmallDisk::default() };
    let (rows, end) = record(&stream(3), &mut disk, None, &AtomicBool::new(false));
    assert!(matches!(end, Err(End::Closed)));
    assert_eq!(rows, 3);
    assert_eq!(disk.bytes, b"# irhorizon\ntime_s,nose_obj_c\n0,1\n1,1\n2,1\n");
}

#[test]
fn a_full_disk_keeps_whole_lines() {
    let mut disk = SmallDisk { room: 40, ..SmallDisk::default() };
    let (rows, end) = record(&stream(9), &mut disk, None, &AtomicBool::new(false));
    assert!(matches!(end, Err(End::Sink(_))), "{end:?}");
    assert_eq!(rows, 2);
    assert_eq!(disk.bytes, b"# irhorizon\ntime_s,nose_obj_c\n0,1\n1,1\n");
}

#[test]
fn a_limit_and_a_request_end_it_well() {
    let taps = Taps::new("time_s\n");
    let fd = taps.subscribe().unwrap();
    let mut disk = SmallDisk { room: 40, ..SmallDisk::default() };
    let (rows, end) = record(&fd, &mut disk, Some(Duration::from_millis(20)), &AtomicBool::new(false));
    assert!(end.is_ok());
    assert_eq!((rows, disk.bytes.as_slice()), (0, &b"time_s\n"[..]));
    let (_, end) = record(&fd, &mut disk, None, &AtomicBool::new(true));
    assert!(end.is_ok());
}
