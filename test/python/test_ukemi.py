"""The Python module: it says what the program says, refuses what the program refuses, and lets Ctrl-C through."""
import ast
import inspect
import os
import pathlib
import signal
import threading
import time
from xml.etree import ElementTree

import numpy as np
import pytest

import ukemi
from told import BUILD, program

SEA = ("k_p", "k_d", "k_sea", "c_sea", "i_motor")


def test_simulate_is_the_program_s(scene, actuator, tmp_path):
    landing = ukemi.simulate(scene, actuator, ukemi.hold(-45))
    told = program(tmp_path / "a", "simulate", ukemi.dataset("scenes/paper.toml"), "--actuator",
                   ukemi.dataset("actuators/table2.toml"), "--hold", -45)
    assert landing.peak == told["peak_acceleration"]
    assert landing.t_peak == told["peak_time"]
    assert landing.error_estimate == told["error_estimate"]
    assert [c.point for c in landing.contacts] == [c["point"] for c in told["contacts"]]


def test_a_trajectory_is_views_of_one_landing(scene, actuator):
    landing = ukemi.simulate(scene, actuator, ukemi.hold(-45), rate=2000)
    assert landing.t.shape == landing.acc.shape == landing.f_foot_y.shape
    assert np.all(np.diff(landing.t) >= 0) and landing.t[0] == 0
    assert np.allclose(landing.acc, np.hypot(landing.ddx_0, landing.ddy_0))
    assert landing.acc.max() <= landing.peak * (1 + 1e-12) and landing.acc.max() > 0.99 * landing.peak
    assert landing.f_foot_y.max() > 100 and landing.f_hip_y.min() >= 0
    assert not landing.acc.flags.owndata and not landing.acc.flags.writeable
    acc = ukemi.simulate(scene, actuator, ukemi.hold(-45)).acc  # the landing lives as long as its view
    assert abs(acc.max() - landing.acc.max()) < 0.01 * landing.peak


def test_optimize_is_the_program_s(scene, actuator, tmp_path):
    best = ukemi.optimize(scene, actuator, seed=3, evaluations=500)
    told = program(tmp_path / "a", "optimize", ukemi.dataset("scenes/paper.toml"), "--actuator",
                   ukemi.dataset("actuators/table2.toml"), "--seed", 3, "--evaluations", 500)
    assert best.found and best.peak == told["peak_acceleration"] and best.tolerant_peak == told["tolerant_peak"]
    assert np.degrees(best.motion.phi_i) == pytest.approx(told["motion"]["phi_i_deg"], rel=1e-12)
    assert best.landing.peak == best.peak < best.held.peak == best.held_peak
    again = ukemi.simulate(scene, actuator, best.motion)
    assert again.peak == pytest.approx(best.peak, rel=1e-9)


def test_motions_as_files_and_arrays(scene, actuator, tmp_path):
    motion = ukemi.motion_deg(-30, -80, 0.2, bumps_deg=[3, -1])
    phi, dphi = motion.reference(np.linspace(0, 0.2, 201))
    assert np.degrees(phi[0]) == pytest.approx(-30) and np.degrees(phi[-1]) == pytest.approx(-80)
    assert np.allclose(np.gradient(phi, 1e-3)[2:-2], dphi[2:-2], atol=0.02 * abs(dphi).max())
    motion.save(tmp_path / "m.toml")
    again = ukemi.read_motion(tmp_path / "m.toml")
    assert again.bumps == pytest.approx(motion.bumps) and again.duration == motion.duration
    assert np.allclose(again.reference([0, 0.07])[0], motion.reference([0, 0.07])[0])


def simulated_trial(actuator, rig, name="hit", noise=0.0, seed=1):
    t = np.arange(0, 0.6, 1e-3)
    force = np.where((t > 0.02) & (t < 0.035), 80 * np.sin((t - 0.02) / 0.015 * np.pi), 0)
    phi = ukemi.predict([ukemi.Trial(t, force=force)], rig, actuator).trials[0].phi
    return ukemi.Trial(t, phi=phi + noise * np.random.default_rng(seed).standard_normal(t.size), force=force, name=name)


def test_identify_from_arrays_finds_what_made_them(actuator):
    rig = ukemi.Rig(0.3, 0.024225, tau_max=20, feedback=ukemi.Feedback.output, errors=ukemi.RigErrors.exact())
    trials = [simulated_trial(actuator, rig, "a", 1e-4, 1), simulated_trial(actuator, rig, "b", 1e-4, 2)]
    fit = ukemi.identify(trials, rig)
    assert fit.converged and fit.rms == pytest.approx(1e-4, rel=0.1)
    assert set(fit.parameters) == set(SEA)
    for name in SEA:
        e = fit.parameters[name]
        assert abs(e.value - getattr(actuator, name)) < 4 * e.std
        assert e.ci95[0] < e.value < e.ci95[1]
    assert fit.covariance.shape == (5, 5) and fit.fitted == list(SEA)
    assert fit.actuator.covariance.shape == (5, 5)
    assert fit.trials[0].phi.shape == trials[0].t.shape
    only = ukemi.identify(trials, rig, start=actuator, free=["k_sea"])
    assert only.fitted == ["k_sea"] and not only.parameters["k_p"].free


def test_the_errors_of_the_rig_count(actuator):
    exact = ukemi.Rig(0.3, 0.024225, tau_max=20, feedback=ukemi.Feedback.output, errors=ukemi.RigErrors.exact())
    stated = ukemi.Rig(0.3, 0.024225, tau_max=20, feedback=ukemi.Feedback.output, errors=ukemi.RigErrors(inertia=0.03))
    assert stated.errors.inertia == 0.03 and stated.errors.delay == 1e-3 and exact.errors.force_gain == 0
    trials = [simulated_trial(actuator, exact, "a", 1e-4, 1), simulated_trial(actuator, exact, "b", 1e-4, 2)]
    a, b = ukemi.identify(trials, exact), ukemi.identify(trials, stated)
    for name in SEA:
        assert a.error_budget[name] == {"noise": 1}
        assert b.parameters[name].std_noise == a.parameters[name].std < b.parameters[name].std
        assert sum(b.error_budget[name].values()) == pytest.approx(1)
    silent = ukemi.identify(trials, ukemi.Rig(0.3, 0.024225, tau_max=20, errors=ukemi.RigErrors.exact()))
    assert silent.feedback == ukemi.Feedback.output
    with pytest.raises(ukemi.InputError, match="inertai"):
        ukemi.RigErrors(inertai=1)
    with pytest.raises(ukemi.InputError, match="delay: -1"):
        ukemi.RigErrors(delay=-1)


def test_identify_is_the_program_s(tmp_path):
    paths = [ukemi.dataset(f"impact/trial_{i}.csv") for i in (1, 2)]
    fit = ukemi.identify([ukemi.read_trial(p) for p in paths], ukemi.read_rig(ukemi.dataset("rigs/paper.toml")))
    told = program(tmp_path / "a", "identify", *paths, "--rig", ukemi.dataset("rigs/paper.toml"))
    assert fit.rms == told["rms"] and fit.cost == told["cost"]
    for name in SEA:
        assert fit.parameters[name].value == told["parameters"][name]["value"]
        assert fit.parameters[name].std == told["parameters"][name]["std"]
    fit.actuator.save(str(tmp_path / "mine.toml"))
    mine, its = (ukemi.read_actuator(str(p)) for p in (tmp_path / "mine.toml", tmp_path / "a/actuator.toml"))
    assert np.array_equal(mine.covariance, its.covariance) and mine.verdicts == its.verdicts


def test_risk_map_and_calibrate(scene, actuator):
    motion = ukemi.motion_deg(-30, -80, 0.2)
    risk = ukemi.risk(scene, actuator, motion, scatter="pitch_deg=1,height=0.01", samples=1000)
    assert risk.peaks.samples == 1000 and float(risk.peaks.median) <= float(risk.peaks.q90) <= risk.peaks.max
    drops, edges = risk.histogram
    assert drops.sum() == 1000 and edges.size == drops.size + 1
    assert set(risk.uncertainties) >= {"height", "pitch"}
    survey = ukemi.map(scene, actuator, grid=[5, 4, 3], polish=2)
    assert survey.peak.shape == (5, 4, 3) and list(survey.axes) == ["phi_i", "phi_f", "duration"]
    axes = [survey.axes[k] for k in survey.axes]
    there = ukemi.Motion(axes[0][1], axes[1][2], axes[2][1])
    assert survey.peak[1, 2, 1] == pytest.approx(ukemi.simulate(scene, actuator, there).peak, rel=1e-3)
    assert survey.basins[0].peak <= np.nanmin(survey.peak) * 1.001


def test_calibrate_finds_the_floor_of_simulated_drops(scene, actuator, tmp_path):
    motion = ukemi.hold(-45)
    landing = ukemi.simulate(scene, actuator, motion, rate=1000)
    keep = np.concatenate([[True], np.diff(landing.t) > 1e-9]) & (landing.t < 0.45)
    log = ukemi.DropLog(landing.t[keep], acc=landing.acc[keep], phi_0=landing.phi_0[keep])
    found = ukemi.calibrate(scene, actuator, [ukemi.Drop(log, motion)], free=["stiffness"])
    assert found.converged and found.fitted == ["stiffness"]
    assert found.parameters["stiffness"].value == pytest.approx(6880, rel=1e-3)
    assert found.rms["phi_0"] < 1e-4 and set(found.rms) == {"acc", "phi_0"}
    found.save(str(tmp_path / "scene.toml"))
    assert '[verdict]' in (tmp_path / "scene.toml").read_text()
    found.scene.save(str(tmp_path / "scene.toml"))
    known = ukemi.read_scene(str(tmp_path / "scene.toml")).verdicts
    assert known == {name: e.verdict for name, e in found.parameters.items()}
    assert ukemi.read_scene(str(tmp_path / "scene.toml")).pitch == scene.pitch


def test_predict_judges(actuator):
    rig = ukemi.Rig(length=0.3, inertia=0.024225, tau_max=20)
    trial = simulated_trial(actuator, rig, "a", 1e-4, 1)
    assert ukemi.predict([trial], rig, actuator).error_factor <= 1
    shifted = ukemi.predict([trial], rig, actuator, start_angle=0.05)
    assert shifted.error_factor > 1.5
    fitted = ukemi.predict([trial], rig, actuator, start_angle="fit")
    assert fitted.error_factor <= 1 and abs(fitted.nuisance["initial_angle[0]"].value) < 1e-3
    with pytest.raises(ukemi.InputError, match="start_angle"):
        ukemi.predict([trial], rig, actuator, start_angle="rest")


def test_a_planner_answers_by_its_deadline(scene, actuator):
    planner = ukemi.Planner(scene, actuator, objective="peak")
    start = time.perf_counter()
    plan = planner.plan(scene.height, scene.forward_speed, np.degrees(scene.pitch), deadline=0.2)
    assert time.perf_counter() - start < 1
    assert plan.found and plan.value < ukemi.simulate(scene, actuator, ukemi.hold(-45)).peak
    assert plan.value == pytest.approx(ukemi.simulate(scene, actuator, plan.motion).peak, rel=1e-3)


def test_a_planner_never_raises_for_what_is_measured(scene, actuator):
    planner = ukemi.Planner(scene, actuator)
    for wrong in ({"height": -1}, {"height": float("nan")}, {"pitch_deg": 1e3}, {"deadline": float("inf")}):
        plan = planner.plan(**{"height": 0.4, **wrong})
        assert not plan.found and plan.status == "bad_input"
        assert plan.wrong.startswith(list(wrong)[0].removesuffix("_deg"))
    assert planner.plan(0.4, 0.63, 18).status == "found"


def test_a_planner_in_the_air_never_raises_for_what_is_measured(scene, actuator, tmp_path):
    text = scene.toml() + "\n[release]\nphi_deg = -45\n"
    (tmp_path / "falling.toml").write_text(text)
    planner = ukemi.Planner(ukemi.read_scene(str(tmp_path / "falling.toml")), actuator, objective="peak")
    measured = {"height": 0.38, "forward_speed": 0.63, "pitch_deg": 18, "pitch_rate_deg": 0, "phi_deg": -45,
                "rate_deg": 0, "elapsed": 0.06}
    for name in [*measured, "vertical_speed", "deadline"]:
        for wrong in BAD:
            plan = planner.plan_in_air(**{**measured, name: wrong})
            assert not plan.found and plan.status == "bad_input"
            assert plan.wrong.startswith(name.removesuffix("_deg"))
    assert planner.plan_in_air(**measured, deadline=0.1).status == "found"


def test_a_scene_keeps_what_is_known_of_its_floor(scene, tmp_path):
    (tmp_path / "scene.toml").write_text(scene.toml() + "\n[verdict]\nstiffness = \"weak\"\npitch = \"trusted\"\n")
    known = ukemi.read_scene(str(tmp_path / "scene.toml"))
    known.save(str(tmp_path / "again.toml"))
    assert scene.verdicts == {}
    assert ukemi.read_scene(str(tmp_path / "again.toml")).verdicts == known.verdicts
    assert known.verdicts == {"stiffness": "weak", "pitch": "trusted"}


def test_the_best_posture_to_hold_is_told(scene, actuator):
    best = ukemi.optimize(scene, actuator, evaluations=1000)
    assert best.held_peak < ukemi.simulate(scene, actuator, ukemi.hold(-45)).peak
    assert best.held_peak == pytest.approx(ukemi.simulate(scene, actuator, ukemi.hold(best.held_deg)).peak, rel=1e-6)
    assert best.value <= best.held_peak and set(best.edges) <= {"phi_i", "phi_f", "duration"}


@pytest.mark.parametrize("call, said", [
    (lambda: ukemi.read_scene("nowhere.toml"), "nowhere.toml"),
    (lambda: ukemi.Motion(-0.5, -1.4, 0), "duration: 0: must be above 0"),
    (lambda: ukemi.Motion(-30, -80, 0.2), "phi_i: -30: must be -2 pi to 2 pi rad; math.radians"),
    (lambda: ukemi.motion_deg(-30, -800, 0.2), "phi_f_deg: -800: must be -360 to 360 deg"),
    (lambda: ukemi.RigErrors(delay="late"), "delay: 'late': a number is needed"),
    (lambda: ukemi.Trial([0, 1, 1], force=[0, 1, 0]), r"t\[2\]: 1: time must increase"),
    (lambda: ukemi.Trial([0, 1, 2], force=[0, 1]), "force: 2 values: 3 are needed"),
    (lambda: ukemi.Trial([0, 1, 2], phi=[0, np.nan, 0], force=[0, 1, 0]), r"phi\[1\]: nan: a finite number"),
    (lambda: ukemi.Trial([0, 1, 2], phi=[0, 7, 0], force=[0, 1, 0]), r"phi\[1\]: 7: an angle within 2 pi"),
    (lambda: ukemi.Trial([0, 1, 2], phi=[0, 0, 0]), "at least one excitation"),
    (lambda: ukemi.Rig(length=-0.3, inertia=1), "length: -0.3: must be above 0"),
    (lambda: ukemi.Actuator(1, 1, 1, 1, 0), "i_motor: 0: must be above 0"),
    (lambda: ukemi.Actuator(1, 1, 1, 1, 1, control_delay=-1e-3), "control_delay: -0.001: must be from 0 to 0.1 s"),
    (lambda: ukemi.identify([], ukemi.Rig(0.3, 0.02)), "at least one"),
])
def test_bad_input_is_an_input_error(call, said):
    with pytest.raises(ukemi.InputError, match=said) as e:
        call()
    assert isinstance(e.value, ValueError)


def test_bad_options_are_input_errors(scene, actuator, tmp_path):
    for wrong in ({"solver": "magic"}, {"objective": "pek"}, {"forbid": ["toe"]}, {"robust": "worse"}, {"deadline": 0.0},
                  {"evaluations": 0}, {"samples": 1}):
        with pytest.raises(ukemi.InputError):
            ukemi.optimize(scene, actuator, **wrong)
    by_command = tmp_path / "drive.toml"
    by_command.write_text('[actuator]\nname = "leg"\nk_sea = 65\nc_sea = 1.6\ni_motor = 0.085\nk_t = 1.5\n')
    with pytest.raises(ukemi.InputError, match="actuator: no k_p and k_d"):
        ukemi.optimize(scene, ukemi.read_actuator(str(by_command)))
    with pytest.raises(ukemi.InputError, match="grid"):
        ukemi.map(scene, actuator, grid=[4, 4])


@pytest.mark.parametrize("call, said", [
    (lambda s, a: s.dropped(height=np.nan), "height: nan"),
    (lambda s, a: s.dropped(forward_speed=np.inf), "forward_speed: inf"),
    (lambda s, a: s.dropped(pitch=np.nan), "pitch: nan"),
    (lambda s, a: s.dropped(pitch=18), "pitch: 18: must be -2 pi to 2 pi rad"),
    (lambda s, a: ukemi.motion_deg(-30, -80, 0.2, bumps_deg=[np.nan]), "bumps_deg: nan"),
    (lambda s, a: ukemi.Motion(-0.5, -1.4, 0.2, gain_p=-1), "gain_p: -1"),
    (lambda s, a: ukemi.simulate(s, a, ukemi.hold(-45), rate=np.nan), "rate: nan"),
    (lambda s, a: ukemi.simulate(s, a, ukemi.hold(-45), accuracy=np.nan), "accuracy: nan"),
    (lambda s, a: ukemi.simulate(s, a, ukemi.hold(-45), accuracy=1e3), "accuracy: 1000"),
    (lambda s, a: ukemi.risk(s, a, ukemi.hold(-45), samples=-1), "samples: -1"),
    (lambda s, a: ukemi.risk(s, a, ukemi.hold(-45), inflate=np.nan), "inflate: nan"),
    (lambda s, a: ukemi.risk(s, a, ukemi.hold(-45), scatter="pitch_deg=nan"), "scatter"),
    (lambda s, a: ukemi.map(s, a, grid=[0, 4, 4]), "grid: 0"),
])
def test_numbers_of_a_landing_that_are_none_are_input_errors(scene, actuator, call, said):
    with pytest.raises(ukemi.InputError, match=said):
        call(scene, actuator)


def test_what_was_not_checked_or_lost_says_so(scene, actuator):
    landing = ukemi.simulate(scene, actuator, ukemi.hold(-45))
    assert landing.sensitive is False and landing.joint_lost is False
    assert ukemi.optimize(scene, actuator, evaluations=50).landing.sensitive is None
    on_floor = ukemi.risk(scene.dropped(height=0.001), actuator, ukemi.hold(-45), scatter="height=0.01", samples=256)
    assert on_floor.peaks.samples == 256 and on_floor.failed == 0 and 64 < on_floor.from_floor < 192


def drops_of(hopper):
    return [ukemi.RobotDrop(ukemi.read_drop(ukemi.dataset(f"drops/hopper_{i}.csv"), hopper),
                            ukemi.read_motions(ukemi.dataset(f"drops/hopper_hold_{i}.toml"), hopper), height=height)
            for i, height in ((1, 0.3), (2, 0.2), (3, 0.15), (4, 0.25))]


@pytest.mark.parametrize("call", [
    lambda s, a, h: ukemi.optimize(s, a, evaluations=50_000_000),
    lambda s, a, h: ukemi.map(h, {"phi_i_hip": 1000, "phi_f_knee": 1000}),
    lambda s, a, h: ukemi.ratings(h, np.linspace(2, 12, 100), evaluations=1_000_000),
    lambda s, a, h: ukemi.compare(h, h, evaluations=50_000_000),
    lambda s, a, h: ukemi.calibrate(h, drops_of(h)),
])
def test_ctrl_c_ends_a_long_call_soon(scene, actuator, hopper, call):
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))  # runs: the interpreter is free
    timer.start()
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        call(scene, actuator, hopper)
    assert time.perf_counter() - start < 10
    assert ukemi.simulate(scene, actuator, ukemi.hold(-45)).peak > 0


def test_figures_are_svg(scene, actuator, tmp_path):
    landing = ukemi.simulate(scene, actuator, ukemi.hold(-45))
    assert landing._repr_svg_() == landing.figure().svg
    drawn = ElementTree.fromstring(landing.figure().svg.encode())
    assert drawn.tag == "{http://www.w3.org/2000/svg}svg" and drawn.find(".//{http://www.w3.org/2000/svg}path") is not None
    landing.figure().save(str(tmp_path / "a.svg"))
    assert (tmp_path / "a.svg").read_text() == landing.figure().svg


def public():
    for name, value in vars(ukemi).items():
        if not name.startswith("_"):
            yield name, value
            if inspect.isclass(value) and not hasattr(value, "__members__"):
                for key, member in vars(value).items():
                    if not key.startswith("_") and (isinstance(member, property) or callable(member)):
                        yield f"{name}.{key}", member


def test_everything_has_a_docstring_and_numbers_have_units():
    seen = 0
    for name, value in public():
        words = value.__doc__ or ""
        assert len(words.strip().split("\n")[-1]) > 5 or name == "InputError", name
        getter = getattr(value, "fget", None)
        if getter is not None and ("float" in getter.__doc__ or "ndarray" in getter.__doc__):
            if name not in ("Motion.gain_p", "Motion.gain_d"):
                assert "[" in words, name
            seen += 1
    assert seen > 60


def test_the_stubs_name_what_there_is():
    tree = ast.parse((BUILD / "ukemi-stubs/__init__.pyi").read_text())
    told = set()
    for node in tree.body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            told.add(node.name)
        if isinstance(node, ast.ClassDef):
            told |= {f"{node.name}.{n.name}" for n in node.body if isinstance(n, ast.FunctionDef)}
    assert {name for name, _ in public()} <= told


BAD = [float("nan"), float("inf"), float("-inf")]


def test_every_constant_of_an_actuator_is_an_argument(tmp_path):
    constants = dict(k_p=50, k_d=1, k_sea=65, c_sea=1.6, i_motor=0.085, tau_max=40, k_t=2, friction=0.1, friction_asymmetry=0.2, viscous_friction=0.3,
                     output_friction=0.4, output_friction_asymmetry=-0.1, output_viscous=0.05, breakaway=0.5, stribeck_speed=0.06, spring_loss=0.07,
                     k_sea_cubic=-1, control_delay=1e-3, velocity_filter=2e-3)
    actuator = ukemi.Actuator(**constants, speed_max=20, motor_torque_max=30, feedback=ukemi.Feedback.motor, name="all")
    assert {n: getattr(actuator, n) for n in constants} == constants
    actuator.save(tmp_path / "actuator.toml")
    assert ukemi.read_actuator(tmp_path / "actuator.toml") == actuator


@pytest.mark.parametrize("bad", BAD)
def test_what_cannot_be_is_refused(actuator, bad):
    rig = ukemi.Rig(length=0.3, inertia=0.024225, tau_max=20)
    t = np.arange(0, 0.1, 2e-3)
    force = np.where((t > 0.01) & (t < 0.026), 60 * np.sin((t - 0.01) / 0.016 * np.pi), 0)
    phi = ukemi.predict([ukemi.Trial(t, force=force)], rig, actuator).trials[0].phi
    trial = ukemi.Trial(t, phi=phi, force=force)
    for name in ("length", "inertia", "tau_max", "gear_ratio", "speed_max", "motor_torque_max"):
        with pytest.raises(ukemi.InputError, match=name):
            ukemi.Rig(**{"length": 0.3, "inertia": 0.02, name: bad})
    for name in SEA + ("speed_max", "motor_torque_max", "friction", "viscous_friction", "k_sea_cubic"):
        with pytest.raises(ukemi.InputError, match=name):
            ukemi.Actuator(**{**dict(k_p=50, k_d=1, k_sea=65, c_sea=1.6, i_motor=0.085), name: bad})
    for name in ("t", "phi", "force", "phi_ref", "phi_motor", "torque", "command"):
        column = t.copy()
        column[7] = bad
        with pytest.raises(ukemi.InputError, match=name):
            ukemi.Trial(**{"t": t, "phi": phi, "force": force, name: column})
        with pytest.raises(ukemi.InputError, match=name if name != "t" else "values"):
            ukemi.Trial(**{"t": t, "phi": phi, "force": force, name: t[:-1]})
    for options in (dict(priors={"k_sea": (bad, 1)}), dict(priors={"k_sea": (65, bad)}), dict(huber=bad),
                    dict(accuracy=bad), dict(force_noise=bad), dict(lower={"k_p": float("nan")}),
                    dict(upper={"k_p": float("nan")}), dict(threads=-1), dict(starts=-1)):
        with pytest.raises(ukemi.InputError):
            ukemi.identify([trial], rig, start=actuator, **options)
    with pytest.raises(ukemi.InputError):
        ukemi.predict([trial], rig, actuator, accuracy=bad)
    with pytest.raises(ukemi.InputError):
        ukemi.predict([], rig, actuator)
    with pytest.raises(ukemi.InputError):
        ukemi.identify([], rig)


def test_masked_values_are_no_numbers(actuator):
    t = np.arange(0, 0.1, 1e-3)
    whole = np.ma.masked_array(np.sin(20 * t), mask=np.zeros(t.size, bool))
    assert np.array_equal(ukemi.Trial(t, phi_ref=whole).phi_ref, whole.data)
    holed = np.ma.masked_array(np.sin(20 * t), mask=t < 0.01)
    for columns in (dict(t=t, phi_ref=holed), dict(t=holed, phi_ref=t), dict(t=t, phi=holed, force=t)):
        with pytest.raises(ukemi.InputError, match="masked"):
            ukemi.Trial(**columns)


def test_times_of_any_origin(actuator):
    rig = ukemi.Rig(length=0.3, inertia=0.024225, tau_max=20)
    here = simulated_trial(actuator, rig)
    there = ukemi.Trial(here.t + 1.7e9, phi=here.phi, force=here.force)
    assert there.t_origin == 1.7e9 and there.t[0] == 0 and np.allclose(there.t, here.t, atol=3e-7)
    assert ukemi.predict([there], rig, actuator).rms < 1e-5
    with pytest.raises(ukemi.InputError, match="less than 100000 s"):
        ukemi.Trial([0, 1, 2e5], phi_ref=[0, 0, 1])


def test_player_sends_what_was_planned():
    motion = ukemi.motion_deg(phi_i_deg=-20, phi_f_deg=-80, duration=0.3, gain_p=0.5)
    player = ukemi.Player(motion)
    assert player.joints == 1 and not player.landing
    assert player.released(10.0) and not player.released(float("nan"))
    assert player.at(10.1)[0] == [motion.phi_i, 0, 1, 1]
    assert player.touchdown(10.25) and not player.touchdown(10.3)
    phi, dphi = motion.reference(np.array([0.1]))
    assert player.at(10.35)[0][:2] == pytest.approx([phi[0], dphi[0]], rel=1e-12)
    assert player.at(10.35)[0][2] == 0.5
    assert player.end == pytest.approx(10.55)
    assert player.at(99)[0][0] == motion.phi_f


def test_player_of_several_joints():
    motions = ukemi.read_motions(str(pathlib.Path(__file__).parent.parent / "data/hopper_motion.toml"),
                                 ukemi.dataset("scenes/hopper.toml"))
    assert list(motions) == ["hip", "knee"]
    player = ukemi.Player(list(motions.values()))
    assert player.joints == 2 and player.released(0) and player.touchdown(0.25)
    assert [c[0] for c in player.at(5)] == pytest.approx([motions["hip"].phi_f, motions["knee"].phi_f])
    with pytest.raises(ukemi.InputError):
        ukemi.Player([])


def test_robot_planner_answers_in_the_air(hopper):
    scene = hopper
    planner = ukemi.RobotPlanner(scene, forbid=["slider"])
    at_rest = planner.plan(0.3, deadline=0.3)
    assert at_rest["found"] and at_rest["value"] <= at_rest["held_value"]
    assert sorted(at_rest["motions"]) == ["hip", "knee"]
    joints = {"hip": (0.6, 0.0), "knee": (-1.2, 0.0)}
    falling = planner.plan_in_air(0.29, joints, elapsed=0.04, deadline=0.1)
    assert falling["status"] == "found", falling["wrong"]
    assert falling["value"] <= falling["held_value"]
    assert planner.plan_in_air(1e-4, joints, elapsed=0.2)["status"] == "floor_first"
    assert planner.plan_in_air(float("nan"), joints)["status"] == "bad_input"
    with pytest.raises(ukemi.InputError, match="knee"):
        planner.plan_in_air(0.2, {"hip": (0.6, 0.0)})
    with pytest.raises(ukemi.InputError, match="no joint of this robot"):
        planner.plan_in_air(0.2, joints | {"ankle": (0, 0)})
    with pytest.raises(ukemi.InputError, match="forbid"):
        ukemi.RobotPlanner(scene, forbid=["sledge"])
    kept = ukemi.optimize(scene, evaluations=600, forbid=["knee"])
    assert kept.found
