//! One bracketed root of a rising function, in a bounded number of steps.

/// Steps after which the search stops in any case.
const MOST_STEPS: usize = 40;

/// Where `f` passes zero between `low`, where it is below, and `high`, where it is not: by false
/// position with Illinois' halving, to `tolerance` in `f`. Where it passes more than once, at one of
/// these places.
///
/// `at_low` and `at_high` are the values there. Always stops, and always within the bracket; the
/// end that was nearest when the steps ran out is given then.
pub fn root(f: impl Fn(f64) -> f64, low: (f64, f64), high: (f64, f64), tolerance: f64) -> f64 {
    let ((mut a, mut fa), (mut b, mut fb)) = (low, high);
    let mut side = 0;
    for step in 0..MOST_STEPS {
        if fb.abs() <= tolerance {
            return b;
        }
        // False position; a plain halving now and then, so that no shape makes it crawl.
        let x = if step % 8 == 7 { 0.5 * (a + b) } else { (a * fb - b * fa) / (fb - fa) };
        let fx = f(x);
        if fx.abs() <= tolerance {
            return x;
        }
        if fx < 0.0 {
            (a, fa) = (x, fx);
            if side == -1 {
                fb *= 0.5;
            }
            side = -1;
        } else {
            (b, fb) = (x, fx);
            if side == 1 {
                fa *= 0.5;
            }
            side = 1;
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between_0_and_1(f: impl Fn(f64) -> f64) -> f64 {
        root(&f, (0.0, f(0.0)), (1.0, f(1.0)), 1e-9)
    }

    #[test]
    fn roots_of_smooth_bent_and_broken_functions() {
        for root in [1e-6_f64, 0.1, 0.5, 0.9, 0.999_999, 1.0] {
            assert!((between_0_and_1(|x| x - root) - root).abs() < 1e-8);
            assert!((between_0_and_1(|x| x.powi(3) - root.powi(3)) - root).abs() < 1e-3);
            assert!((between_0_and_1(|x| (x - root).cbrt()) - root).abs() < 1e-8);
            assert!((between_0_and_1(|x| if x < root { -1.0 } else { 5.0 }) - root).abs() < 0.05);
        }
    }

    #[test]
    fn few_steps_where_the_function_is_nearly_straight() {
        let steps = std::cell::Cell::new(0);
        let x = between_0_and_1(|x| {
            steps.set(steps.get() + 1);
            x + 0.2 * x * x - 0.7
        });
        assert!((x + 0.2 * x * x - 0.7).abs() < 1e-9);
        assert!(steps.get() < 12, "{}", steps.get());
    }

    #[test]
    fn it_stops_whatever_the_function() {
        for f in [|_: f64| f64::NAN, |_| f64::INFINITY, |_| -1.0, |_| 0.0] {
            let _ = root(f, (0.0, -1.0), (1.0, 1.0), 1e-9);
        }
    }
}
