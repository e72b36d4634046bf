//! Scripts beyond what a level flight does: rolls, inverted flight, loops.

use super::flight::{Flight, Waypoint};

/// Seconds since the last, roll, pitch, °. Upright is 0, 0 but also 180, 180, the other way round.
type Step = (f64, f64, f64);

/// Rolls both ways, inverted flight, and turns between them, in turbulence.
pub fn rolls() -> Flight {
    let cycle: [Step; 14] = [
        (5.0, 0.0, 3.0),
        (6.0, 360.0, 3.0),
        (4.0, 360.0, 3.0),
        (3.0, 540.0, 3.0),
        (8.0, 540.0, 3.0),
        (1.0, 560.0, 3.0),
        (4.0, 560.0, 3.0),
        (3.0, 720.0, 3.0),
        (4.0, 720.0, 3.0),
        (2.0, 680.0, 3.0),
        (8.0, 680.0, 3.0),
        (2.0, 720.0, 3.0),
        (3.0, 720.0, 3.0),
        (8.0, 0.0, 3.0),
    ];
    again(&cycle, 1500, [0.0, 0.0])
}

/// Loops, a barrel roll, an aileron roll, an Immelmann turn and a split S, inverted flight, and turns
/// between them, in turbulence: 120 s, again and again.
pub fn aerobatics() -> Flight {
    let cycle: [Step; 29] = [
        (6.0, 0.0, 3.0),
        // A loop.
        (6.0, 0.0, 363.0),
        (5.0, 0.0, 363.0),
        // A barrel roll: the nose rises, and falls through the roll.
        (1.0, 0.0, 383.0),
        (3.0, 360.0, 343.0),
        (1.5, 360.0, 363.0),
        (4.0, 360.0, 363.0),
        // An aileron roll to the left.
        (2.5, 0.0, 363.0),
        (4.0, 0.0, 363.0),
        (2.0, 45.0, 364.0),
        (6.0, 45.0, 364.0),
        (2.0, 0.0, 363.0),
        // An Immelmann turn: half a loop, half a roll.
        (3.0, 0.0, 537.0),
        (2.0, 180.0, 537.0),
        (6.0, 180.0, 537.0),
        (2.0, 140.0, 536.0),
        (5.0, 140.0, 536.0),
        (2.0, 180.0, 537.0),
        // A split S: half a roll, half a loop.
        (1.5, 360.0, 537.0),
        (3.5, 360.0, 723.0),
        (5.0, 360.0, 723.0),
        // On its back for a while.
        (1.5, 540.0, 723.0),
        (5.0, 540.0, 723.0),
        (1.5, 720.0, 723.0),
        (4.0, 720.0, 723.0),
        // A tighter loop.
        (4.5, 720.0, 1083.0),
        (9.0, 720.0, 1083.0),
        (13.0, 750.0, 1085.0),
        (8.5, 720.0, 1083.0),
    ];
    again(&cycle, 720, [720.0, 1080.0])
}

/// A cycle so many times, each time further by so much roll and pitch, °, in turbulence.
fn again(cycle: &[Step], times: usize, further_deg: [f64; 2]) -> Flight {
    let mut time_s = 0.0;
    let waypoints = (0..cycle.len() * times).map(|i| {
        let (step_s, roll_deg, pitch_deg) = cycle[i % cycle.len()];
        time_s += step_s;
        let [roll, pitch] = further_deg.map(|deg| deg * (i / cycle.len()) as f64);
        Waypoint { time_s, roll_deg: roll_deg + roll, pitch_deg: pitch_deg + pitch }
    });
    Flight::scripted(waypoints.collect()).with_turbulence(1.3, 0.5, 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aerobatics_go_over_the_top_and_every_cycle_is_as_the_first() {
        let flight = aerobatics();
        let calm = |time_s: f64| {
            let a = flight.attitude(time_s);
            [a.roll, a.pitch].map(f64::to_degrees)
        };
        // s, roll, pitch: a quarter of the loop, its top; level after the Immelmann turn and the split S.
        for (time_s, roll, pitch) in
            [(9.0, 180.0, -3.0), (14.0, 0.0, 3.0), (51.0, 0.0, 3.0), (70.0, 0.0, 3.0), (78.0, 180.0, 3.0)]
        {
            for cycle in [0.0, 120.0, 1200.0] {
                let got = calm(time_s + cycle);
                let off = (got[0] - roll + 540.0).rem_euclid(360.0) - 180.0;
                assert!(off.abs() < 5.0 && (got[1] - pitch).abs() < 2.5, "{time_s} s: {got:?}");
            }
        }
        let steepest =
            (0..1200).map(|i| calm(f64::from(i) * 0.1)[1]).fold([0.0_f64; 2], |m, p| [m[0].min(p), m[1].max(p)]);
        assert!(steepest[0] < -80.0 && steepest[1] > 80.0, "{steepest:?}");
    }
}
