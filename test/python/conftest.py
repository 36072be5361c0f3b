"""What every test of the Python module has."""
import math

import pytest

import ukemi


@pytest.fixture(scope="session")
def scene():
    return ukemi.read_scene(ukemi.dataset("scenes/paper.toml"))


@pytest.fixture(scope="session")
def actuator():
    return ukemi.read_actuator(ukemi.dataset("actuators/table2.toml"))


@pytest.fixture(scope="session")
def hopper():
    return ukemi.read_robot_scene(ukemi.dataset("scenes/hopper.toml"))


ROD = """[robot]
gravity = 9.81
base = "pinned"
peak = { link = "rod", at = [0.1, 0] }
[[robot.link]]
name = "rod"
joint = "servo"
mass = 0.5
inertia_com = 2e-4
com = [0.1, 0]
[drive.servo]
kind = "geared"
k_p = 3
k_d = 0.05
i_motor = 0.001
friction = 0.03
"""


@pytest.fixture(scope="session")
def driven(tmp_path_factory):
    """A rod that a servo swings, and a log of it: what the robot itself would have measured."""
    folder = tmp_path_factory.mktemp("driven")
    (folder / "rod.toml").write_text(ROD)
    robot = ukemi.read_driven_robot(folder / "rod.toml")

    def log(name, phi):
        rows = ["t,phi_servo,phi_ref_servo"]
        rows += [f"{0.004 * k},{phi[k]:.17g},{math.sin(0.03 * k)}" for k in range(400)]
        (folder / name).write_text("\n".join(rows) + "\n")
        return ukemi.read_robot_trials(folder / name, robot)

    still = log("still.csv", [1e-4 * k for k in range(400)])
    return robot, still, log("swung.csv", ukemi.predict_robot(robot, still).outputs(0)["phi_servo"])
