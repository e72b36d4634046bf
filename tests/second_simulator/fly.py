"""A second simulator: a recording on standard output, made by nothing of the daemon's.

fly.py SCENE SEED

Flat world, hand-flown banks to 50 degrees and turbulence, six sensors with a Gaussian field of view of 90 degrees, a first-order
lag of 0.1 s, noise of 0.08 K and steps of 0.02 K; a gyro with a bias, GPS and airspeed five times a second, wind. What a sensor
sees goes by its elevation alone, so tables do. The standard library is enough.
"""

import math
import random
import sys

STEP_S = 0.02
FRAMES = 5500
LAG_S = 0.1
NOISE_K = 0.08
WIDTH = math.radians(90.0)
ROWS = 181
NAMES = ("nose", "tail", "left", "right", "up", "down")
# Forward, right, down.
AXES = ((1, 0, 0), (-1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1))
GROUND_C = 16.0


def exponential(k, deficit):
    """The report's sky: kelvin below the ground by the sine of the elevation."""
    return lambda sine: deficit * (1.0 - math.exp(-k * math.degrees(math.asin(min(sine, 1.0))) / 90.0))


def grey(depth, deficit):
    """A plane-parallel grey atmosphere."""
    return lambda sine: deficit * math.exp(-depth / max(sine, 1e-6))


# Scene: the sky, whether sensors average radiance, how many kelvin warmer one side is in the sky and on the ground.
SCENES = {
    "dry": (grey(0.25, 52.0), True, 0.0, 0.0),
    "report": (exponential(5.5, 40.0), False, 0.0, 0.0),
    "overcast": (grey(0.3, 11.5), False, 0.0, 0.0),
    "warm-sky": (grey(0.25, 52.0), False, 2.5, 0.0),
    "warm-ground": (grey(0.25, 52.0), False, 0.0, 2.5),
}


def tables(sky, radiance):
    """By elevation from -90 to 90 degrees: what a sensor sees; what it sees of the sky's and of the ground's warm side, along
    its own azimuth, each for 1 K."""
    rings, spokes = 40, 48
    rays = []
    for i in range(rings):
        off = (i + 0.5) / rings * math.pi / 2.0
        weight = math.sin(off) * math.exp(-4.0 * math.log(2.0) * (off / WIDTH) ** 2)
        for j in range(spokes):
            round_ = (j + 0.5) / spokes * 2.0 * math.pi
            rays.append((weight, math.cos(off), math.sin(off) * math.cos(round_)))
    whole = sum(ray[0] for ray in rays)
    rows = []
    for row in range(ROWS):
        elevation = math.radians(row - 90.0)
        sine, cosine = math.sin(elevation), math.cos(elevation)
        seen = above = below = 0.0
        for weight, along, across in rays:
            up, level = sine * along + cosine * across, cosine * along - sine * across
            kelvin = GROUND_C + 273.15 - (sky(up) if up > 0.0 else 0.0)
            seen += weight * (kelvin**4 if radiance else kelvin)
            if up > 0.0:
                above += weight * level
            else:
                below += weight * level
        seen /= whole
        rows.append(((seen**0.25 if radiance else seen) - 273.15, above / whole, below / whole))
    return rows


def smooth(values, time_s):
    """A first-order low-pass that begins settled."""
    share, state = 1.0 - math.exp(-STEP_S / time_s), values[0]
    result = []
    for value in values:
        state += share * (value - state)
        result.append(state)
    return result


def flown(dice, angles, rest, times, gust, gust_s):
    """Degrees: one angle after the other, flown as a hand would, and turbulence."""
    commands = []
    while len(commands) < FRAMES:
        commands += [dice.choice(angles)] * int(dice.uniform(4.0, 10.0) / STEP_S)
    commands = [c + rest for c in commands[:FRAMES]]
    for time_s in times:
        commands = smooth(commands, time_s)
    keep, state, air = math.exp(-STEP_S / gust_s), 0.0, []
    for _ in range(FRAMES):
        state = keep * state + gust * math.sqrt(1.0 - keep * keep) * dice.gauss(0.0, 1.0)
        air.append(state)
    return [math.radians(c + a) for c, a in zip(commands, smooth(smooth(air, 0.1), 0.1))]


def slopes(values):
    """Of a second, midway between neighbours."""
    last = len(values) - 1
    between = [(max(i - 1, 0), min(i + 1, last)) for i in range(last + 1)]
    return [(values[b] - values[a]) / (STEP_S * (b - a)) for a, b in between]


def main(scene, seed):
    sky, radiance, warm_sky, warm_ground = SCENES[scene]
    dice = random.Random(f"{scene} {seed}")
    table = tables(sky, radiance)
    roll = flown(dice, (0, 0, 20, -20, 35, -35, 50, -50), 0.0, (0.5, 0.4), 4.0, 0.6)
    pitch = flown(dice, (0, 0, 5, -5, 10), 0.0, (0.7, 0.5), 2.5, 0.8)
    speed, heading, yaw = dice.uniform(14.0, 25.0), dice.uniform(0.0, 2.0 * math.pi), []
    for angle in roll:
        heading += 9.80665 * math.tan(angle) / speed * STEP_S
        yaw.append(heading)
    warm = dice.uniform(0.0, 2.0 * math.pi)
    seen = [[] for _ in NAMES]
    for phi, theta, psi in zip(roll, pitch, yaw):
        (sp, cp), (st, ct), (sy, cy) = ((math.sin(a), math.cos(a)) for a in (phi, theta, psi))
        north = (ct * cy, sp * st * cy - cp * sy, cp * st * cy + sp * sy)
        east = (ct * sy, sp * st * sy + cp * cy, cp * st * sy - sp * cy)
        down = (-st, sp * ct, cp * ct)
        for axis, values in zip(AXES, seen):
            n, e, d = (sum(a * b for a, b in zip(axis, way)) for way in (north, east, down))
            place = math.degrees(math.asin(max(-1.0, min(1.0, -d)))) + 90.0
            low = min(int(place), ROWS - 2)
            part = place - low
            kelvin, above, below = (a + part * (b - a) for a, b in zip(table[low], table[low + 1]))
            side = math.cos(math.atan2(e, n) - warm)
            values.append(kelvin + side * (warm_sky * above + warm_ground * below))
    seen = [[round((v + dice.gauss(0.0, NOISE_K)) / 0.02) * 0.02 for v in smooth(values, LAG_S)] for values in seen]
    rates = ([], [], [])
    for phi, theta, dphi, dtheta, dpsi in zip(roll, pitch, slopes(roll), slopes(pitch), slopes(yaw)):
        rates[0].append(dphi - dpsi * math.sin(theta))
        rates[1].append(dtheta * math.cos(phi) + dpsi * math.sin(phi) * math.cos(theta))
        rates[2].append(-dtheta * math.sin(phi) + dpsi * math.cos(phi) * math.cos(theta))
    biases = [dice.gauss(0.0, 0.5) for _ in rates]
    gyro = [[math.degrees(r) + bias + dice.gauss(0.0, 0.15) for r in axis] for axis, bias in zip(rates, biases)]
    wind = (dice.gauss(0.0, 3.0), dice.gauss(0.0, 3.0))
    columns = ["time_s", *(f"{name}_obj_c" for name in NAMES), "gyro_x_deg_s", "gyro_y_deg_s", "gyro_z_deg_s"]
    columns += ["airspeed_m_s", "ground_speed_m_s", "course_deg", "climb_m_s", "ref_roll_deg", "ref_pitch_deg", "ref_yaw_deg"]
    print(",".join(columns))
    for i in range(FRAMES):
        row = [f"{i * STEP_S:.2f}", *(f"{values[i]:.2f}" for values in seen), *(f"{axis[i]:.3f}" for axis in gyro)]
        if i % 10 == 0:
            over = [speed * math.cos(pitch[i]) * way(yaw[i]) + w for way, w in zip((math.cos, math.sin), wind)]
            said = (speed + dice.gauss(0.0, 0.3), math.hypot(*over) + dice.gauss(0.0, 0.1))
            course = (math.degrees(math.atan2(over[1], over[0])) + dice.gauss(0.0, 0.4)) % 360.0
            row += [f"{v:.2f}" for v in (*said, course, speed * math.sin(pitch[i]) + dice.gauss(0.0, 0.15))]
        else:
            row += [""] * 4
        truth = (math.degrees(roll[i]), math.degrees(pitch[i]), math.degrees(yaw[i]) % 360.0)
        print(",".join(row + [f"{v:.3f}" for v in truth]))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
