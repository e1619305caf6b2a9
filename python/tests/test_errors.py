"""Bad input: named by key, value and range, and nothing runs."""

import pickle
import warnings
from types import SimpleNamespace

import numpy as np
import pandas
import pytest
import steer_assist as sa

START = {"speed_m_s": 4, "steer_rate_rad_s": 5}


@pytest.mark.parametrize(
    "changes, key, words",
    [
        ({"colour": "red"}, "colour", "unknown field `colour`"),
        ({"plant": {"sensor": []}}, "plant.sensor", "unknown field"),
        ({"time_limit_s": "long"}, "time_limit_s", "string"),
        ({"law": "hh"}, "law", "hh"),
        ({"bicycle": "tricycle"}, "bicycle", "tricycle"),
        ({"rider": "nobody"}, "rider", "nobody"),
        ({"torque_limit_nm": float("nan")}, "torque_limit_nm", "not a finite number"),
        ({"start": {"speed_m_s": np.inf}}, "start.speed_m_s", "not a finite number"),
        ({"taper_m_s": np.ones((2, 2))}, "taper_m_s", r"shape \(2, 2\)"),
        ({"taper_m_s": [1.0, 2.0, 3.0]}, "taper_m_s", "length"),
        ({"bicycle": object()}, "bicycle", "no bicycle"),
        ({"imu": {1, 2}}, "imu", "set is no value"),
    ],
)
def test_the_key_is_named(changes, key, words):
    with pytest.raises(sa.ScenarioError, match=words) as raised:
        sa.ride(**{**START, **changes} if "start" not in changes else changes)
    assert raised.value.key is not None and raised.value.key.startswith(key)


@pytest.mark.parametrize(
    "changes, key, least, most",
    [
        ({"speed_m_s": 31}, "start.speed_m_s", -30, 30),
        ({"torque_limit_nm": -1}, "torque_limit_nm", 0, None),
        ({"time_limit_s": 0}, None, None, 3600),
        ({"speed_m_s": np.nan}, "start.speed_m_s", -30, 30),
        ({"speed_m_s": -np.inf}, "start.speed_m_s", -30, 30),
        ({"time_limit_s": np.float32(np.nan)}, "time_limit_s", 0.001, 3600),
        ({"torque_limit_nm": np.nan}, "torque_limit_nm", 0, 50),
    ],
)
def test_the_range_is_named(changes, key, least, most):
    with pytest.raises(sa.ScenarioError) as raised:
        sa.ride(**{**START, **changes})
    error = raised.value
    assert isinstance(error, ValueError) and error.range is not None
    assert key is None or error.key == key
    assert least is None or error.range[0] == pytest.approx(least, abs=1)
    assert most is None or error.range[1] == most


def test_a_search_out_of_range():
    with pytest.raises(sa.ScenarioError, match="tolerance") as raised:
        sa.basin(tolerance=1e-12)
    assert raised.value.key == "search.tolerance" and raised.value.range[0] == 1e-9


@pytest.fixture
def here(repository):
    """A recorded ride and a record of perturbations."""
    recording = repository / "data/recordings/g2_steer_encoder_spikes_2mps.csv"
    return SimpleNamespace(recording=recording, record=repository / "python/notebooks/perturbed_young_5mps.csv")


@pytest.mark.parametrize(
    "use, key, least, most",
    [
        (lambda here: sa.basin(speeds=[31.0]), "search.speeds", 0, 30),
        (lambda here: sa.basin(speeds="0:31:1"), "search.speeds", 0, 30),
        (lambda here: sa.basin(speeds=[4.0, 3.0]), "search.speeds", None, None),
        (lambda here: sa.basin(max_rate=-1), "search.max_rate", 0.01, 100),
        (lambda here: sa.basin(scan_step=0), "search.scan_step", 1e-3, 30),
        (lambda here: sa.basin(adaptive_speeds=2), "search.adaptive_speeds", 1e-4, 1),
        (lambda here: sa.basin(axis="yaw"), "search.axis", None, None),
        (lambda here: sa.basin(uncertain=1), "uncertain", 2, 10000),
        (lambda here: sa.plane(speed=31), "plane.speed", 0, 30),
        (lambda here: sa.plane(speed=4, rays=1), "plane.rays", 2, 10000),
        (lambda here: sa.plane(speed=4, points=0), "plane.points", 1, 10000),
        (lambda here: sa.plane(speed=4, max_steer_rate=0), "plane.max_steer_rate", 0.01, 100),
        (lambda here: sa.plane(speed=4, max_roll_rate=-1), "plane.max_roll_rate", 0.01, 100),
        (lambda here: sa.plane(speed=4, tolerance=1), "plane.tolerance", 1e-9, 1 / 80),
        (lambda here: sa.ride(time_limit_s=3601, **START), "time_limit_s", 0.001, 3600),
        (lambda here: sa.ride(recovered_below=2, **START), "recovered_below", 1e-6, 1),
        (lambda here: sa.ride(fall={"roll_rad": 3.0}, **START), "fall.roll_rad", np.pi / 180, np.pi / 2),
        (lambda here: sa.ride(sensor_delay_s=2, **START), "sensor_delay_s", 0, 1),
        (lambda here: sa.ride(rider={"table": "young", "delay_s": 2}, **START), "rider.delay_s", 0, 1),
        (lambda here: sa.eigen(speeds=[36.0]), "speeds", -30, 30),
        (lambda here: sa.eigen(law="h", actuator_delay_s=2, speeds=[4.0]), "actuator_delay_s", 0, 1),
        (lambda here: sa.eigen(law="h", actuator_lag_s=11, speeds=[4.0]), "actuator_lag_s", 0, 10),
        (lambda here: sa.eigen(law="h", steer_friction_nm_s_rad=-1, speeds=[4.0]), "steer_friction_nm_s_rad", 0, 100),
        (lambda here: sa.eigen(law="h", steer_inertia_kg_m2=-1, speeds=[4.0]), "steer_inertia_kg_m2", 0, 10),
        (lambda here: sa.eigen(law="h", rider="young", actuator_delay_s=0.01, speeds=[4.0]), "actuator_delay_s", None, None),
        (lambda here: sa.eigen(speeds=["fast"]), "speeds", None, None),
        (lambda here: sa.eigen(speeds=[[1.0], [2.0]]), "speeds", None, None),
        (lambda here: sa.eigen(roots="many"), "roots", 4, 40),
        (lambda here: sa.eigen(capsize="much"), "capsize", None, None),
        (lambda here: sa.sweep(over={"torque_limit_nm": [2000.0]}), "torque_limit_nm", np.float32(0.1), 50),
        (lambda here: sa.sweep(over={"sensor_delay_s": [0.0, 2.0]}), "sensor_delay_s", 0, 1),
        (lambda here: sa.sweep(over={"rider.delay_s": [2.0]}, rider="young"), "rider.delay_s", 0, 1),
        (lambda here: sa.sweep(over={"time_limit_s": [3601]}), "time_limit_s", 0.001, 3600),
        (lambda here: sa.sweep(over={"law": ["hh"]}), "law", None, None),
        (lambda here: sa.sweep(over={"torque_limit_nm": ["much"]}), "torque_limit_nm", None, None),
        (lambda here: sa.sweep(over={"torque_limit_nm": [1, 1]}), "torque_limit_nm", None, None),
        (lambda here: sa.sweep(over={"colour": ["red"]}), "colour", None, None),
        (lambda here: sa.sweep(over={"law": ["h"]}, tolerance=1e-12), "search.tolerance", 1e-9, 0.25),
        (lambda here: sa.replay(here.recording, map="extract", every_s=0), "every_s", 1e-6, 3600),
        (lambda here: sa.replay(here.recording, map="extract", longest_gap_s=-1), "longest_gap_s", 1e-6, 3600),
        (lambda here: sa.replay(here.recording, map="extract", faults=["gyro:shy"]), "faults", None, None),
        (lambda here: sa.replay(here.recording, map="extract", set=["limits.colour=1"]), "set", None, None),
        (lambda here: sa.replay(here.recording, map="extract", preset="best"), "preset", None, None),
        (lambda here: sa.replay(here.recording, map="extract", law="hh"), "law", None, None),
        (lambda here: sa.replay(here.recording, map="nomap"), "map", None, None),
        (lambda here: sa.replay(here.recording, mapp="extract"), "mapp", None, None),
        (lambda here: sa.identify(here.record, delay_s=30), "delay_s", 0, 0.5),
        (lambda here: sa.identify(here.record, delay_profile_s=[0.0, 2.0]), "delay_profile_s", 0, 1),
        (lambda here: sa.identify(here.record, skip_s=-1), "skip_s", 0, 3600),
        (lambda here: sa.identify(here.record, force_at_m=(9, 1)), "force_at_m", -3, 5),
        (lambda here: sa.identify(here.record, neuromuscular=(-1, 0.7)), "neuromuscular", 0.1 / (2 * np.pi), 200 / (2 * np.pi)),
        (lambda here: sa.identify(here.record, gains=["K_nothing"]), "gains", None, None),
        (lambda here: sa.identify(here.record, select="vaf:101"), "select", 0, 100),
        (lambda here: sa.identify(here.record, drift="1Hz"), "drift", 1e-4, 0.5),
        (lambda here: sa.identify(here.record, speed_m_s=99, reduce=False), "speed_m_s", 0.1, 30),
        (lambda here: sa.identify(here.record, threads=0), "threads", 1, 1024),
        (lambda here: sa.identify(here.record, fit=["yaw"]), "fit", None, None),
    ],
)
def test_every_rejected_value_has_its_key_and_range(here, use, key, least, most):
    """Must hold: the exception has the argument's key, and of a number the range in the key's unit."""
    with pytest.raises(sa.ScenarioError) as raised:
        use(here)
    found = raised.value.key
    assert found is not None and found.split("[")[0] == key
    if least is None:
        assert raised.value.range is None
        return
    assert raised.value.range is not None and raised.value.range[0] == pytest.approx(least, abs=1e-12)
    assert most is None or raised.value.range[1] == pytest.approx(most)


def test_a_start_is_needed():
    with pytest.raises(sa.ScenarioError, match="must be given") as raised:
        sa.ride()
    assert (raised.value.key, raised.value.range) == ("start.speed_m_s", (-30.0, 30.0))
    with pytest.raises(sa.ScenarioError) as raised:
        sa.plane()
    assert (raised.value.key, raised.value.range) == ("plane.speed", (0.0, 30.0))


def test_a_parameter_of_a_bicycle():
    parameters = sa.check()["config"]["bicycle"]["parameters"]
    with pytest.raises(sa.ScenarioError, match="mB") as raised:
        sa.ride(bicycle={**parameters, "mB": -3.0}, **START)
    assert raised.value.key == "bicycle.parameters.mB" and raised.value.range[0] > 0
    with pytest.raises(sa.ScenarioError, match="`mX` is no parameter") as raised:
        sa.ride(bicycle={**parameters, "mX": 1.0}, **START)
    assert raised.value.key == "bicycle.mX"
    parameters.pop("zH")
    with pytest.raises(sa.ScenarioError, match="`zH` is missing"):
        sa.ride(bicycle=parameters, **START)


def test_degrees_are_doubted():
    """Situation: 20 degrees/s and 18 degrees given for radians. Must hold: a warning names the key; radians give none."""
    with pytest.warns(sa.UnitsWarning, match="roll_rate_rad_s = 20.*degrees"):
        sa.scenario(start={"speed_m_s": 4, "roll_rate_rad_s": 20})
    with pytest.warns(sa.UnitsWarning, match="fall.roll_rad = 80"):
        sa.scenario(fall={"roll_rad": 80})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sa.scenario(start={"speed_m_s": 4, "roll_rate_rad_s": 2}, fall={"roll_rad": 1.4})


def test_a_missing_file(tmp_path):
    with pytest.raises(sa.ScenarioError, match="nothing.toml"):
        sa.ride(tmp_path / "nothing.toml")
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[search]\nscan = 1\n")
    with pytest.raises(sa.ScenarioError, match="wrong.toml") as raised:
        sa.basin(wrong)
    assert raised.value.key == "search.scan"


def test_an_error_passes_between_processes():
    error = pickle.loads(pickle.dumps(sa.ScenarioError("wrong", "a.b", (0.0, 1.0))))
    assert (str(error), error.key, error.range) == ("wrong", "a.b", (0.0, 1.0))


@pytest.mark.parametrize("threads", [0, -1, 1025, 2.0, True])
def test_threads_out_of_range(threads):
    for search in (lambda: sa.basin(threads=threads), lambda: sa.plane(speed=4, threads=threads), lambda: sa.sweep(over={"law": ["h"]}, threads=threads)):
        with pytest.raises(sa.ScenarioError, match="threads") as raised:
            search()
        assert raised.value.key == "threads" and raised.value.range == (1.0, 1024.0)


def test_speeds_of_eigenvalues_out_of_range():
    """Situation: km/h for m/s, and none. Must hold: refused with the key, not computed."""
    for speeds in ([36.0], [-31.0], [1e9], []):
        with pytest.raises(sa.ScenarioError, match="speeds") as raised:
            sa.eigen(speeds=speeds)
        assert raised.value.key == "speeds"


def test_a_duration_of_pandas_is_no_number():
    with pytest.raises(sa.ScenarioError, match="Timedelta") as raised:
        sa.ride(time_limit_s=pandas.Timedelta("3s"), **START)
    assert raised.value.key == "time_limit_s"


def test_doubts_are_warnings():
    """Situation: a frame whose inertias no rigid body has. Action: every computation. Must hold: each warns, the given one not."""
    parameters = sa.check()["config"]["bicycle"]["parameters"]
    doubtful = {**parameters, "IBxx": 40.0}
    for compute in (
        lambda: sa.ride(bicycle=doubtful, **START),
        lambda: sa.basin(bicycle=doubtful, speeds=[4.0], max_rate=0.5),
        lambda: sa.plane(bicycle=doubtful, speed=4, rays=4, method="fast"),
        lambda: sa.eigen(bicycle=doubtful, speeds=[4.0]),
        lambda: sa.sweep(over={"law": ["h"]}, bicycle=doubtful, speeds=[4.0], max_rate=0.5),
    ):
        with pytest.warns(sa.ScenarioWarning, match="IB"):
            compute()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sa.ride(bicycle=parameters, **START)


def test_the_caller_s_words():
    """Arguments that are wrong together or in kind are named as they were given."""
    with pytest.raises(sa.ScenarioError, match="torque_limit_nm: acts on the flashed code only") as raised:
        sa.ride(law=lambda rate, speed: 5.0 * rate, torque_limit_nm=3, **START)
    assert raised.value.key == "torque_limit_nm"
    with pytest.raises(sa.ScenarioError, match="'foo' is no axis; expected one of .*torque_limit_nm") as raised:
        sa.sweep(over={"foo": [1]})
    assert raised.value.key == "foo"
    with pytest.raises(sa.ScenarioError, match="limits.rise_nm_s=abc") as raised:
        sa.check(parameters={"limits.rise_nm_s": "abc"})
    assert raised.value.key == "parameters.limits.rise_nm_s" and raised.value.range is None
    with pytest.raises(sa.ScenarioError) as raised:
        sa.check(torque_limit_nm=500)
    assert raised.value.range == (0.1, 50.0)
    with pytest.raises(sa.ScenarioError, match="roots") as raised:
        sa.eigen(roots=8, speeds=[4])
    assert raised.value.key == "roots"
    with pytest.raises(sa.ScenarioError, match="an int is no scenario"):
        sa.ride(3)
    with pytest.raises(sa.ScenarioError, match="progress = 3") as raised:
        sa.basin(speeds=[4], progress=3)
    assert raised.value.key == "progress"
    with pytest.raises(sa.ScenarioError, match="must be given") as raised:
        sa.ride(speed_m_s=None, steer_rate_rad_s=1)
    assert "NaN" not in str(raised.value)
    with pytest.raises(sa.ScenarioError, match="an int is no axis of matplotlib") as raised:
        sa.plot.eigen(sa.eigen(speeds=[4]), ax=3)
    assert raised.value.key == "ax"


def test_a_law_of_a_ride_is_tried_at_its_speed():
    """The first calls of a function, before the ride, are at the ride's speed."""
    speeds = []

    def law(roll_rate_rad_s, speed_m_s):
        speeds.append(speed_m_s)
        return 5.0 * roll_rate_rad_s

    sa.ride(law=law, speed_m_s=5, steer_rate_rad_s=1, time_limit_s=0.1)
    assert speeds[0] == 5.0 and all(4.0 < speed < 6.0 for speed in speeds)
