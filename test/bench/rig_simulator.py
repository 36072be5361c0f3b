"""Rigs and drives simulated apart from the library, with effects that its model may lack: trust_table.py.

Many actuators at once, each hit a lane of NumPy arrays: the classical Runge-Kutta method; a delay as exact history (a cubic
between nodes), a digital drive that holds its torque, dry friction that sticks. SI units, rad.
"""
import dataclasses
import zlib

import numpy as np

CONSTANTS = ('k_p', 'k_d', 'k_sea', 'c_sea', 'i_motor')
TYPICAL = np.array([30, 0.6, 120, 0.8, 0.03])
LENGTH, INERTIA, HITS = 0.3, 0.024225, 8
SOFT, ORDINARY = (0.03, 0.12), (0.1, 0.45)  # largest angle of a hit [rad]


@dataclasses.dataclass(frozen=True)
class Row:
    """What is true of a rig and its log beyond the model that the rig file tells."""
    delay: float = 0          # s, between what the drive measures and its torque
    period: float = 0         # s, of a digital drive that holds its torque; it acts one period after it measured
    velocity_filter: float = 0  # s, first-order lag of the rate that K_d sees
    motor_feedback: bool = False
    inertia: float = 1        # true over the rig file's
    length: float = 1
    softening: float = 0      # part by which the tangent stiffness falls at the largest deflection met
    tau_max: float = np.inf   # part of the largest spring torque that would be met without a limit
    drive_max: float = np.inf  # limit of the drive's torque, part of k_p times the largest angle
    backlash: float = 0       # rad, of the gear: the spring's play, from end to end
    friction: float = 0       # Nm, dry, on the motor; it sticks
    viscous: float = 0        # Nm/(rad/s), on the motor
    output_viscous: float = 0
    force_filter: float = 0   # s, first-order lag of the load cell
    force_gain: float = 1     # logged force over the true one
    encoder_gain: float = 1   # logged angle over the true one
    time_shift: float = 0     # s, by which the true force comes later than logged
    ripple: tuple = (0, 1)    # rad, periods a turn; the encoder is zeroed at the start
    smooth: bool = False      # the force is a half sine, not linear between its samples
    noise: float = 0.5e-3     # rad, of each logged angle
    quantum: float = 0        # rad, of the encoder
    rate: float = 500         # Hz
    hits: tuple = ()          # range of the largest angles; none: ordinary and soft hits by turns
    rig: str = 'feedback = "output"'  # further lines of the rig file
    alternate: bool = False   # the gains are below 1 by as much in every other draw

    def other_way(self):
        return dataclasses.replace(self, force_gain=2 - self.force_gain, encoder_gain=2 - self.encoder_gain)


def stable(constants, row):
    """Whether each actuator's linear loop is, with a fourth-order Pade delay: its slowest pole left of -2 1/s."""
    out = []
    for k_p, k_d, k, c, motor in constants:
        spring = np.array([c, k])
        link = np.polyadd([INERTIA * row.inertia, row.output_viscous, 0], spring)  # times phi: spring times phi_m
        free = np.polysub(np.polymul(np.polyadd([motor, row.viscous, 0], spring), link), np.polymul(spring, spring))
        lag = np.array([row.velocity_filter, 1])
        gain = np.polyadd([k_d, 0], k_p * lag)
        d = row.delay + 1.5 * row.period
        behind = np.array([d**4 / 1680, d**3 / 84, 3 * d**2 / 28, d / 2, 1])
        ahead = behind * [1, -1, 1, -1, 1]
        fed = np.polymul(gain, link if row.motor_feedback else spring)
        loop = np.polyadd(np.polymul(np.polymul(free, lag), behind), np.polymul(fed, ahead))
        out.append(np.roots(np.trim_zeros(loop, 'f')).real.max() < -2)
    return np.array(out)


class Plant:
    """Both inertias of some lanes, the spring and the drive's law: state phi, phi_m, their rates, the filtered rate."""

    def __init__(self, constants, row, cubic=0.0, limit=np.inf, drive_limit=np.inf):
        self.k_p, self.k_d, self.k_sea, self.c_sea, self.motor = constants.T
        self.row, self.cubic, self.limit, self.drive_limit = row, cubic, limit, drive_limit
        self.link, self.arm = INERTIA * row.inertia, LENGTH * row.length
        self.slip = np.zeros(len(constants))  # sign of the motor's motion where it rubs; 0: stuck

    def spring(self, y):
        d = y[1] - y[0]
        d = d - np.clip(d, -self.row.backlash / 2, self.row.backlash / 2)
        return np.clip(self.k_sea * d + self.cubic * d**3 + self.c_sea * (y[3] - y[2]), -self.limit, self.limit)

    def drive(self, y):
        """The torque that the drive works out of what it measures."""
        side = 1 if self.row.motor_feedback else 0
        torque = -self.k_p * y[side] - self.k_d * (y[4] if self.row.velocity_filter else y[side + 2])
        return np.clip(torque, -self.drive_limit, self.drive_limit)

    def field(self, y, force, torque):
        row, spring = self.row, self.spring(y)
        free = self.slip != 0 if row.friction else 1
        d = np.zeros_like(y)
        d[0], d[1] = y[2], free * y[3]
        d[2] = (spring + self.arm * np.cos(y[0]) * force - row.output_viscous * y[2]) / self.link
        d[3] = free * (torque - spring - row.viscous * y[3] - self.slip * row.friction) / self.motor
        if row.velocity_filter:
            d[4] = (y[3 if row.motor_feedback else 2] - y[4]) / row.velocity_filter
        return d

    def leave(self, y, torque):
        """Who was stuck slips where more pulls than friction holds."""
        pull = torque - self.spring(y)
        self.slip = np.where((self.slip == 0) & (np.abs(pull) > self.row.friction), np.sign(pull), self.slip)

    def step(self, y, h, force, torque):
        """The classical Runge-Kutta method; `force` and `torque` (of a state) at the step's start, middle and end."""
        one = self.field(y, force[0], torque(y, 0))
        s = y + h / 2 * one
        two = self.field(s, force[1], torque(s, 1))
        s = y + h / 2 * two
        three = self.field(s, force[1], torque(s, 1))
        s = y + h * three
        return y + h / 6 * (one + 2 * two + 2 * three + self.field(s, force[2], torque(s, 2)))

    def rubbed(self, y, h, force, torque):
        """A step with dry friction: until the motor stops, which is found by secants, and on from there."""
        self.leave(y, torque(y, 0))
        end = self.step(y, h, force, torque)
        stops = self.slip * end[3] < 0
        if not stops.any():
            return end
        part, after = np.ones(len(self.slip)), end
        for _ in range(2):
            part = np.where(stops, part * y[3] / np.where(stops, y[3] - after[3], 1), 1)
            before = [force[0] + share * part * (force[2] - force[0]) for share in (0, 0.5, 1)]
            after = self.step(y, part * h, before, torque)
        after[3, stops] = 0
        self.slip = np.where(stops, 0, self.slip)
        self.leave(after, torque(after, 2))
        rest = [before[2] + share * (force[2] - before[2]) for share in (0, 0.5, 1)]
        return np.where(stops, self.step(after, (1 - part) * h, rest, torque), end)


def simulate(plant, force_at, samples, h):
    """Angle of the link and deflection of the spring at every sample: [lanes, samples] each. From rest.

    `force_at(time)` is each lane's force [N], smooth within a step of h [s]; h divides delay, period and sampling time.
    """
    row, lanes = plant.row, len(plant.slip)
    sub, hold, late = (round(span / h) for span in (1 / row.rate, row.period, row.delay))
    y = np.zeros((5, lanes))
    told = np.zeros((late + 1, 2, lanes))  # the drive's torque and its slope at each of the last steps
    held = waiting = np.zeros(lanes)
    out = np.zeros((2, samples, lanes))
    for n in range(sub * (samples - 1)):
        torque = lambda s, _: plant.drive(s)
        force = [force_at((n + part) * h) for part in (0, 0.5, 1)]
        if hold:
            if n % hold == 0:
                held, waiting = waiting, plant.drive(y)
            torque = lambda _, part: held
        elif late:  # a cubic between the nodes of `late` steps ago and one step later
            then, soon = told[(n + 1) % (late + 1)], told[(n + 2) % (late + 1)]
            told[n % (late + 1)] = plant.drive(y), plant.drive(plant.field(y, force[0], then[0]))  # which is linear
            known = then[0].copy(), (then[0] + soon[0]) / 2 + h / 8 * (then[1] - soon[1]), soon[0]
            torque = lambda _, part: known[part]
        y = (plant.rubbed if row.friction else plant.step)(y, h, force, torque)
        if (n + 1) % sub == 0:
            out[:, (n + 1) // sub] = y[0], y[1] - y[0]
    return out[0].T, out[1].T


class Hits:
    """A half sine a lane: `newton` high, `seconds` long, from 0.05 s on."""

    def __init__(self, row, newton, seconds):
        self.row, self.newton, self.seconds = row, newton, seconds
        self.t = np.arange(round(row.rate) + 1) / row.rate
        self.logged = self.curve(self.t[:, None])

    def curve(self, t):
        s = np.clip((t - 0.05) / self.seconds, 0, 1)
        return self.newton * np.sin(np.pi * s)

    def measured(self):
        """The load cell's answer at the samples."""
        lag, out = self.row.force_filter, self.logged.copy()
        if lag:
            dt = self.t[1]
            for i, (low, high) in enumerate(zip(self.logged, self.logged[1:])):
                ramp = (high - low) / dt * lag
                out[i + 1] = high - ramp + (out[i] - low + ramp) * np.exp(-dt / lag)
        return out

    def __call__(self, t):
        """The force of each lane [N]; the log's clock is ahead by the row's time shift."""
        t = max(t - self.row.time_shift, 0)
        if self.row.smooth:
            return self.curve(t)
        i = min(int(t * self.row.rate + 1e-9), len(self.t) - 2)
        part = t * self.row.rate - i
        return (1 - part) * self.logged[i] + part * self.logged[i + 1]


@dataclasses.dataclass
class Draw:
    row: Row
    truth: np.ndarray
    t: np.ndarray
    force: np.ndarray  # as logged, a column a hit
    phi: np.ndarray    # the link's, a row a hit


def lanes_of(truths):
    return np.repeat(truths, HITS, axis=0)


def draws_of(name, row, count, h):
    """Actuators, and the hits on each: their heights are such that the linear rig would reach an angle that is drawn."""
    random = np.random.default_rng(zlib.crc32(name.encode()))
    truths = np.zeros((0, 5))
    while len(truths) < count:
        some = TYPICAL * np.exp(random.uniform(np.log(0.6), np.log(1.6), (count, 5)))
        truths = np.concatenate([truths, some[stable(some, row)]])[:count]
    lanes, n = lanes_of(truths), round(row.rate) + 1
    ranges = np.log([row.hits or (SOFT if d % 2 else ORDINARY) for d in range(count) for _ in range(HITS)])
    wanted = np.exp(random.uniform(ranges[:, 0], ranges[:, 1]))
    seconds, sign = random.uniform(0.010, 0.030, len(lanes)), random.choice([-1, 1], len(lanes))
    plain = dataclasses.replace(row, friction=0, smooth=False, backlash=0, force_filter=0)
    unit, bent = simulate(Plant(lanes, plain), Hits(plain, 1e-3 * sign, seconds), n, 5e-4)
    newton = sign * 1e-3 * wanted / np.abs(unit).max(axis=1)
    met = (np.abs(bent).max(axis=1) * np.abs(newton) / 1e-3).reshape(-1, HITS).max(axis=1).repeat(HITS)
    cubic = -row.softening * lanes[:, 2] / (3 * met**2)  # the tangent is k + 3 cubic d^2
    hits = Hits(row, newton, seconds)
    largest = wanted.reshape(-1, HITS).max(axis=1).repeat(HITS)
    plant = Plant(lanes, row, cubic, row.tau_max * lanes[:, 2] * met, row.drive_max * lanes[:, 0] * largest)
    phi, _ = simulate(plant, hits, n, h)
    force = hits.measured()
    assert np.abs(phi).max() < 1, name
    return [Draw(row.other_way() if row.alternate and d % 2 else row, truths[d], hits.t,
                 force[:, d * HITS:(d + 1) * HITS], phi[d * HITS:(d + 1) * HITS]) for d in range(count)]


def step_of(row):
    """A step [s] at which the angles are right to 1 urad."""
    return 5e-5 if row.friction or row.backlash or min(row.tau_max, row.drive_max) < np.inf else 2.5e-4
