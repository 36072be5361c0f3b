"""What every test of the Python module has."""
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


@pytest.fixture(scope="session")
def driven(tmp_path_factory):
    """A leg that holds a posture while it lands, and a log of it: what the robot itself would have measured."""
    robot = ukemi.read_driven_robot(ukemi.dataset("scenes/hopper.toml"))
    folder = tmp_path_factory.mktemp("driven")

    def log(name, phi):
        rows = ["t,phi_hip,phi_knee,phi_ref_hip,phi_ref_knee"]
        rows += [f"{0.002 * k},{phi['phi_hip'][k]:.17g},{phi['phi_knee'][k]:.17g},0.6,-1.2" for k in range(150)]
        (folder / name).write_text("\n".join(rows) + "\n")
        return ukemi.read_robot_trials(folder / name, robot)

    still = {"phi_hip": [0.6] * 150, "phi_knee": [-1.2] * 150}
    return robot, log("still.csv", still), log("landed.csv", ukemi.predict_robot(robot, log("s.csv", still)).outputs(0))
