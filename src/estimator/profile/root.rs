//! One bracketed root of a rising function, in a bounded number of steps.

/// Steps after which the search stops in any case.
const MOST_STEPS: u32 = 40;

/// A place with the function's value and slope there.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Where.
    pub x: f64,
    /// The value there.
    pub value: f64,
    /// The slope there; it only speeds the search up and need not be exact.
    pub slope: f64,
}

/// Where the function passes zero between `low`, where it is below, and `high`, where it is not: by
/// Newton's steps from `high`, kept within the bracket, to `tolerance` in the value. Where it passes
/// more than once, at one of these places.
///
/// Always stops, and always within the bracket; its middle is given when the steps have run out.
pub fn root(at: impl Fn(f64) -> Point, low: f64, high: Point, tolerance: f64) -> f64 {
    let (mut low, mut top, mut here) = (low, high.x, high);
    for step in 1..MOST_STEPS {
        if here.value.abs() <= tolerance {
            return here.x;
        }
        let newton = here.x - here.value / here.slope;
        // A halving where the step leaves the bracket, and now and then, so that no shape makes it crawl.
        let inside = newton > low && newton < top && step % 6 != 0;
        here = at(if inside { newton } else { 0.5 * (low + top) });
        if here.value < 0.0 {
            low = here.x;
        } else {
            top = here.x;
        }
    }
    0.5 * (low + top)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// The root between 0 and 1, and how often `f` was asked for it.
    fn between_0_and_1(f: impl Fn(f64) -> f64) -> (f64, u32) {
        let asked = Cell::new(0);
        let at = |x: f64| {
            asked.set(asked.get() + 1);
            Point { x, value: f(x), slope: (f(x + 1e-6) - f(x - 1e-6)) / 2e-6 }
        };
        let root = root(at, 0.0, at(1.0), 1e-9);
        (root, asked.get())
    }

    #[test]
    fn roots_of_smooth_bent_and_broken_functions() {
        for root in [1e-6_f64, 0.1, 0.5, 0.9, 0.999_999, 1.0] {
            assert!((between_0_and_1(|x| x - root).0 - root).abs() < 1e-8);
            assert!((between_0_and_1(|x| x.powi(3) - root.powi(3)).0 - root).abs() < 1e-3);
            assert!((between_0_and_1(|x| (x - root).cbrt()).0 - root).abs() < 1e-4);
            assert!((between_0_and_1(|x| if x < root { -1.0 } else { 5.0 }).0 - root).abs() < 1e-6);
        }
    }

    #[test]
    fn few_steps_where_the_function_is_nearly_straight() {
        let (x, asked) = between_0_and_1(|x| x + 0.2 * x * x - 0.7);
        assert!((x + 0.2 * x * x - 0.7).abs() < 1e-9);
        assert!(asked <= 5, "{asked}");
    }

    #[test]
    fn it_stops_within_the_bracket_whatever_the_function() {
        for f in [|_: f64| f64::NAN, |_| f64::INFINITY, |_| -1.0, |_| 0.0, |x| 1.0 / (x - 0.5)] {
            let (x, asked) = between_0_and_1(f);
            assert!((0.0..=1.0).contains(&x) && asked <= 40, "{x} {asked}");
        }
    }
}
