//! A long series in bounded room: the lowest and highest of each short while, so that no spike is lost.

/// As many whiles as are kept, more than a sheet has columns.
const CELLS: usize = 2048;
/// The first while's length, s: shorter than any two rows are apart.
const SHORTEST_S: f64 = 1e-6;
/// A time without rows that a line does not bridge, s.
const BRIDGED_S: f64 = 5.0;

/// What happened in a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    index: u64,
    /// The first row's time, s.
    pub first_s: f64,
    /// The last row's time, s.
    pub last_s: f64,
    /// The lowest and the highest value; `None` where no row had one.
    pub values: Option<(f64, f64)>,
    /// Whether the lowest came after the highest.
    pub falling: bool,
}

impl Cell {
    /// The middle of its time, s.
    pub fn time_s(&self) -> f64 {
        0.5 * (self.first_s + self.last_s)
    }

    /// Its values in the order in which they came: one or two.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + use<> {
        let (low, high) = self.values.unwrap_or((f64::NAN, f64::NAN));
        let (a, b) = if self.falling { (high, low) } else { (low, high) };
        let time_s = self.time_s();
        std::iter::once((time_s, a)).chain((a != b).then_some((time_s, b)))
    }

    /// Takes in what came after.
    fn extend(&mut self, later: &Self) {
        self.last_s = later.last_s;
        match (&mut self.values, later.values) {
            (Some((low, high)), Some((l, h))) => {
                match (l < *low, h > *high) {
                    (true, true) => self.falling = later.falling,
                    (true, false) => self.falling = true,
                    (false, true) => self.falling = false,
                    (false, false) => {}
                }
                (*low, *high) = (low.min(l), high.max(h));
            }
            (None, Some(_)) => (self.values, self.falling) = (later.values, later.falling),
            _ => {}
        }
    }
}

/// The series.
#[derive(Clone, Debug)]
pub struct Envelope {
    width_s: f64,
    origin_s: f64,
    cells: Vec<Cell>,
}

impl Default for Envelope {
    fn default() -> Self {
        Self { width_s: SHORTEST_S, origin_s: 0.0, cells: Vec::new() }
    }
}

impl Envelope {
    /// Takes in the row at `time_s`, not before the last one: its value, or the lower and upper end
    /// of its band, or that it has none.
    pub fn add(&mut self, time_s: f64, values: Option<(f64, f64)>) {
        let values = values.filter(|(low, high)| low.is_finite() && high.is_finite());
        if self.cells.is_empty() {
            self.origin_s = time_s;
        }
        let cell = Cell { index: self.index(time_s), first_s: time_s, last_s: time_s, values, falling: false };
        self.push(cell);
        if self.cells.len() > CELLS {
            while self.cells.len() > 3 * CELLS / 4 && self.width_s < 1e12 {
                self.coarsen();
            }
        }
    }

    /// Takes in a value.
    pub fn add_value(&mut self, time_s: f64, value: Option<f64>) {
        self.add(time_s, value.map(|v| (v, v)));
    }

    /// The whiles that had values, in runs without a gap.
    pub fn runs(&self) -> impl Iterator<Item = &[Cell]> {
        let apart = BRIDGED_S.max(3.0 * self.width_s);
        self.cells
            .chunk_by(move |a, b| a.values.is_some() && b.values.is_some() && b.first_s - a.last_s <= apart)
            .filter(|run| run[0].values.is_some())
    }

    /// The lowest and the highest value of all.
    pub fn extremes(&self) -> Option<(f64, f64)> {
        self.cells.iter().filter_map(|c| c.values).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    fn index(&self, time_s: f64) -> u64 {
        // A cast saturates and sends what is no number to 0.
        ((time_s - self.origin_s) / self.width_s) as u64
    }

    fn push(&mut self, cell: Cell) {
        match self.cells.last_mut() {
            Some(last) if last.index >= cell.index => last.extend(&cell),
            _ => self.cells.push(cell),
        }
    }

    /// Makes two whiles one.
    fn coarsen(&mut self) {
        self.width_s *= 2.0;
        for cell in std::mem::take(&mut self.cells) {
            self.push(Cell { index: cell.index / 2, ..cell });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_series_is_kept_row_by_row() {
        let mut e = Envelope::default();
        for (t, v) in [(7.0, Some(1.0)), (7.1, Some(-2.0)), (7.2, None), (7.3, Some(f64::NAN)), (7.4, Some(3.0))] {
            e.add_value(t, v);
        }
        let runs: Vec<Vec<_>> = e.runs().map(|r| r.iter().flat_map(Cell::points).collect()).collect();
        assert_eq!(runs, [vec![(7.0, 1.0), (7.1, -2.0)], vec![(7.4, 3.0)]]);
        assert_eq!(e.extremes(), Some((-2.0, 3.0)));
        assert_eq!(Envelope::default().extremes(), None);
    }

    #[test]
    fn a_long_one_loses_no_spike_and_no_gap_and_stays_small() {
        let mut e = Envelope::default();
        for i in 0..500_000_u32 {
            let value = if i == 123_456 { 99.0 } else { f64::from(i % 7) };
            let withheld = (200_000..210_000).contains(&i) || i % 100 == 0;
            e.add_value(f64::from(i) * 0.02, (!withheld).then_some(value));
        }
        assert!(e.cells.len() <= CELLS && e.cells.len() > CELLS / 3);
        assert_eq!(e.extremes(), Some((0.0, 99.0)));
        let runs: Vec<&[Cell]> = e.runs().collect();
        assert_eq!(runs.len(), 2);
        let end_s = runs[0].last().unwrap().last_s;
        assert!((end_s - 4000.0).abs() < 10.0, "{end_s}");
        let spike = e.cells.iter().find(|c| c.values.unwrap().1 == 99.0).unwrap();
        assert!((spike.time_s() - 2469.12).abs() < 10.0);
    }

    #[test]
    fn values_come_out_in_the_order_they_went_in() {
        let cell =
            |low, high, falling| Cell { index: 0, first_s: 0.0, last_s: 0.0, values: Some((low, high)), falling };
        let mut c = cell(1.0, 1.0, false);
        c.extend(&cell(0.0, 0.0, false));
        assert_eq!(c.points().map(|p| p.1).collect::<Vec<_>>(), [1.0, 0.0]);
        c.extend(&cell(2.0, 2.0, false));
        assert_eq!(c.points().map(|p| p.1).collect::<Vec<_>>(), [0.0, 2.0]);
    }

    #[test]
    fn a_hole_in_the_recording_is_not_bridged_and_any_time_is_borne() {
        let mut e = Envelope::default();
        for t in [0.0, 1.0, 60.0] {
            e.add_value(t, Some(0.0));
        }
        assert_eq!(e.runs().count(), 2);
        for t in [f64::NAN, -1.0, f64::INFINITY, 1e300] {
            e.add_value(t, Some(1.0));
        }
        assert!(e.extremes().is_some());
    }
}
