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
