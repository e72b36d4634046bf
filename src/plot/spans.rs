//! What held from when to when.

/// A time during which something held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span<K> {
    /// What.
    pub key: K,
    /// From the row that showed it first, s.
    pub start_s: f64,
    /// To the first row that did not, or the last of all, s.
    pub end_s: f64,
}

/// All such times.
#[derive(Clone, Debug)]
pub struct Spans<K> {
    spans: Vec<Span<K>>,
    open: Vec<usize>,
}

impl<K> Default for Spans<K> {
    fn default() -> Self {
        Self { spans: Vec::new(), open: Vec::new() }
    }
}

impl<K: Copy + PartialEq> Spans<K> {
    /// Takes in what holds at a row.
    pub fn add(&mut self, time_s: f64, holding: impl Iterator<Item = K> + Clone) {
        for i in &self.open {
            self.spans[*i].end_s = time_s;
        }
        let spans = &mut self.spans;
        self.open.retain(|i| holding.clone().any(|k| k == spans[*i].key));
        for key in holding {
            if !self.open.iter().any(|i| spans[*i].key == key) {
                self.open.push(spans.len());
                spans.push(Span { key, start_s: time_s, end_s: time_s });
            }
        }
    }

    /// Everything that ever held, in the order of first mention.
    pub fn keys(&self) -> Vec<K> {
        let mut keys = Vec::new();
        for span in &self.spans {
            if !keys.contains(&span.key) {
                keys.push(span.key);
            }
        }
        keys
    }

    /// The times of `key`, those less than `least_s` apart as one.
    pub fn of(&self, key: K, least_s: f64) -> Vec<Span<K>> {
        let mut joined: Vec<Span<K>> = Vec::new();
        for span in self.spans.iter().filter(|s| s.key == key) {
            match joined.last_mut() {
                Some(last) if span.start_s - last.end_s < least_s => last.end_s = span.end_s,
                _ => joined.push(*span),
            }
        }
        joined
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_holds_lasts_until_the_first_row_without_it() {
        let mut spans = Spans::default();
        for (t, holding) in [(0.0, "a"), (1.0, "ab"), (2.0, "b"), (3.0, ""), (4.0, "b"), (5.0, "b")] {
            spans.add(t, holding.chars());
        }
        assert_eq!(spans.keys(), ['a', 'b']);
        let times = |key, least| spans.of(key, least).iter().map(|s| (s.start_s, s.end_s)).collect::<Vec<_>>();
        assert_eq!(times('a', 0.0), [(0.0, 2.0)]);
        assert_eq!(times('b', 0.0), [(1.0, 3.0), (4.0, 5.0)]);
        assert_eq!(times('b', 1.5), [(1.0, 5.0)]);
    }
}
