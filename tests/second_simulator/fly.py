"""A second simulator: a recording on standard output, made by nothing of the daemon's.

fly.py SCENE SEED

Flat world, hand-flown banks to 50 degrees and turbulence, six sensors with a Gaussian field of view of 90 degrees, a first-order
lag, noise of 0.08 K and steps of 0.02 K; a gyro with a bias, GPS and airspeed five times a second, wind. What a sensor sees goes
by its elevation, and by how far off its axis each cloud is, so tables do. How lively the flights are and how thick the clouds was
settled by what peers' schemes have in them: see the test. The standard library is enough.
"""

import math
import random
import sys
from typing import Callable, NamedTuple

STEP_S = 0.02
FRAMES = 5500
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


class Scene(NamedTuple):
    sky: Callable[[float], float]
    radiance: bool = False
    """Sensors average the fourth power."""
    warm_sky: float = 0.0
    """Kelvin either way from the mean, from one side to the other; so of the ground."""
    warm_ground: float = 0.0
    clouds: int = 0
    cloud_left: float = 1.0
    """The share of contrast left after 1.5 s of flying into cloud, after a third of the flight."""
    lag_s: float = 0.1


SCENES = {
    "dry": Scene(grey(0.25, 52.0), radiance=True),
    "humid": Scene(grey(0.8, 75.0)),
    "report": Scene(exponential(5.5, 40.0)),
    "overcast": Scene(grey(1.4, 32.0)),
    "clouds": Scene(grey(0.25, 52.0), clouds=20),
    "warm-sky": Scene(grey(0.25, 52.0), warm_sky=2.8),
    "warm-ground": Scene(grey(0.25, 52.0), warm_ground=2.5),
    "into-cloud": Scene(grey(0.25, 52.0), cloud_left=0.25),
    "lag": Scene(grey(0.25, 52.0), lag_s=0.3),
}


def bell(off):
    """How well a sensor sees what lies so far off its axis."""
    return math.exp(-4.0 * math.log(2.0) * (off / WIDTH) ** 2)


def tables(sky, radiance):
    """By elevation from -90 to 90 degrees: what a sensor sees; what it sees of the sky's and of the ground's warm side, along
    its own azimuth, each for 1 K."""
    rings, spokes = 40, 48
    rays = []
    for i in range(rings):
        off = (i + 0.5) / rings * math.pi / 2.0
        weight = math.sin(off) * bell(off)
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


def flown(dice, angles, times, gust, gust_s):
    """Degrees: one angle after the other, flown as a hand would, and turbulence."""
    commands = []
    while len(commands) < FRAMES:
        commands += [dice.choice(angles)] * int(dice.uniform(4.0, 10.0) / STEP_S)
    commands = commands[:FRAMES]
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


def cumulus(dice, scene):
    """Small clouds: where each stands (north, east, up), and how many kelvin warmer one looks that is straight ahead."""
    offs = [(i + 0.5) / 1000 * math.pi / 2.0 for i in range(1000)]
    whole = sum(2.0 * math.pi * math.sin(off) * bell(off) for off in offs) * math.pi / 2000
    result = []
    for _ in range(scene.clouds):
        elevation, azimuth = math.radians(dice.uniform(10.0, 60.0)), dice.uniform(0.0, 2.0 * math.pi)
        up, level = math.sin(elevation), math.cos(elevation)
        large = math.pi * math.radians(dice.uniform(5.0, 11.0)) ** 2
        result.append((level * math.cos(azimuth), level * math.sin(azimuth), up, 0.5 * scene.sky(up) * large / whole))
    return result


def main(name, seed):
    scene = SCENES[name]
    dice = random.Random(f"{name} {seed}")
    table = tables(scene.sky, scene.radiance)
    roll = flown(dice, (0, 0, 0, 0, 15, -15, 30, -30, 45, -45), (0.7, 0.6), 2.3, 1.0)
    pitch = flown(dice, (0, 0, 5, -5), (0.7, 0.5), 1.2, 1.0)
    speed, heading, yaw = dice.uniform(14.0, 25.0), dice.uniform(0.0, 2.0 * math.pi), []
    for angle in roll:
        heading += 9.80665 * math.tan(angle) / speed * STEP_S
        yaw.append(heading)
    warm = dice.uniform(0.0, 2.0 * math.pi)
    clouds = cumulus(dice, scene)
    seen = [[] for _ in NAMES]
    for i, (phi, theta, psi) in enumerate(zip(roll, pitch, yaw)):
        left = 1.0 + (scene.cloud_left - 1.0) * max(0.0, min(1.0, (i - FRAMES / 3) * STEP_S / 1.5))
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
            kelvin += side * (scene.warm_sky * above + scene.warm_ground * below)
            for to_north, to_east, up, ahead in clouds:
                kelvin += ahead * bell(math.acos(max(-1.0, min(1.0, n * to_north + e * to_east - d * up))))
            values.append(GROUND_C + left * (kelvin - GROUND_C))
    seen = [[round((v + dice.gauss(0.0, NOISE_K)) / 0.02) * 0.02 for v in smooth(values, scene.lag_s)] for values in seen]
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
