//! Dots, eight to a cell (Unicode braille patterns), around a centre. Dots are square where a
//! cell is twice as high as wide.

/// A canvas of `width` × `height` cells; both odd, so that a cell lies in the middle.
#[derive(Debug)]
pub(super) struct Canvas {
    width: i32,
    height: i32,
    cells: Vec<u8>,
}

impl Canvas {
    pub fn new(width: u16, height: u16) -> Self {
        let (width, height) = (i32::from(width), i32::from(height));
        Self { width, height, cells: vec![0; (width * height) as usize] }
    }

    /// Sets the dot at `x` to the right of the centre and `y` above it, in dots.
    pub fn dot(&mut self, x: f64, y: f64) {
        let i = (x + f64::from(self.width)).floor() as i32;
        let j = (f64::from(2 * self.height) - y).floor() as i32;
        if !(0..2 * self.width).contains(&i) || !(0..4 * self.height).contains(&j) {
            return;
        }
        // The bits of U+2800: the left column 0 1 2 6, the right one 3 4 5 7, downwards.
        const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
        self.cells[(j / 4 * self.width + i / 2) as usize] |= BITS[(j % 4) as usize][(i % 2) as usize];
    }

    /// Sets the dots from one point to another; of every `period` dots the first `on`.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), (on, period): (usize, usize)) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let steps = dx.abs().max(dy.abs()).ceil().clamp(1.0, 4_000.0) as usize;
        for step in (0..=steps).filter(|s| s % period < on) {
            let t = step as f64 / steps as f64;
            self.dot(from.0 + t * dx, from.1 + t * dy);
        }
    }

    /// The character of a cell; `None` when no dot is set in it.
    pub fn character(&self, column: u16, row: u16) -> Option<char> {
        let bits = self.cells[(i32::from(row) * self.width + i32::from(column)) as usize];
        if bits == 0 { None } else { char::from_u32(0x2800 + u32::from(bits)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_land_around_the_centre_and_never_outside() {
        let mut c = Canvas::new(3, 1);
        c.dot(0.5, 0.5);
        assert_eq!(c.character(1, 0), Some('⠐'));
        c.dot(-0.5, -1.5);
        assert_eq!(c.character(1, 0), Some('⡐'));
        for far in [1e30, -1e30, f64::NAN, f64::INFINITY] {
            c.dot(far, 3.0);
            c.dot(0.0, far);
        }
        assert_eq!((c.character(0, 0), c.character(2, 0)), (None, None));
    }
}
