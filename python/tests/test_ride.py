"""Rides: the command line's numbers, columns, laws of one's own."""

import math

import numpy as np
import pytest
import steer_assist as sa

START = {"speed_m_s": 4, "steer_rate_rad_s": 5}


def test_a_ride_is_the_command_lines(sim_host):
    ride = sa.ride(**START)
    here, there = sa.document(ride), sim_host("ride", "--speed", "4", "--steer-rate", "5")
    for document in (here, there):
        document["tool"].pop("commit")
    assert here == there
    assert ride.attrs["peak_torque_nm"] == there["effort"]["peak_torque_nm"]


def test_the_record():
    """Situation: the flashed code after a knock. Must hold: the record begins with the disturbance, in units, and every
    period has a point."""
    ride = sa.ride(preset="product", rider="smart", speed_m_s=4, steer_rate_rad_s=3)
    assert ride.outcome == "recovered"
    assert ride.time_s[0] == 0 and 5999 <= ride.sizes["time_s"] <= 6001
    assert float(ride.steer_rate_rad_s[0]) == pytest.approx(3.0)
    assert ride.torque_nm.units == "N m"
    assert ride.cause_active.dims == ("time_s", "cause") and ride.cause_active.dtype == np.int8
    assert ride.mode.flag_meanings.split()[int(ride.mode[-1])] == "engaged"
    assert float(abs(ride.torque_nm).max()) == pytest.approx(ride.attrs["peak_torque_nm"])
    assert 0 < ride.attrs["peak_torque_nm"] <= 7


def test_a_scenario_file(repository):
    file = repository / "data/scenarios/product.toml"
    ride = sa.ride(file, **START)
    assert sa.document(ride)["config"]["preset"] == "product"


def h(roll_rate_rad_s, speed_m_s):
    """Law h of Kuipers 2020."""
    v = speed_m_s
    return (30 - 4 * v) * math.exp(-0.03 * v * v) * roll_rate_rad_s


def test_a_function_is_the_ideal_law():
    """Situation: law h as a Python function. Must hold: the ride of the built-in ideal law, but for the rounding of the
    formula."""
    own, built_in = sa.ride(law=h, **START), sa.ride(law="h", assist="ideal", **START)
    assert own.outcome == built_in.outcome
    for name in ("roll_rad", "steer_rad", "torque_nm"):
        np.testing.assert_allclose(own[name], built_in[name], atol=1e-5)
    config = sa.document(own)["config"]
    assert config["law"]["name"] == "python:h" and config["assist"] == "ideal"
    gain = sa.ride(law=lambda p, v: 20.0 * p, **START)
    assert abs(gain.torque_nm - built_in.torque_nm).max() > 0.1


def test_a_functions_basin_is_the_ideal_laws():
    speeds = [3.0, 5.0]
    own = sa.basin(law=h, speeds=speeds, progress=False)
    built_in = sa.basin(law="h", assist="ideal", speeds=speeds, progress=False)
    np.testing.assert_allclose(own.height, built_in.height, atol=0.011)
    assert (own.height > 3).all()


def test_an_error_of_a_function_is_raised():
    def broken(roll_rate_rad_s, speed_m_s):
        if abs(roll_rate_rad_s) > 0.51:
            raise ZeroDivisionError("my own")
        return 0.0

    for run in (lambda: sa.ride(law=broken, **START), lambda: sa.basin(law=broken, speeds=[4], progress=False)):
        with pytest.raises(ZeroDivisionError, match="my own"):
            run()


@pytest.mark.parametrize(
    "law, words",
    [
        (lambda p, v: float("nan"), "nan"),
        (lambda p, v: "much", "'much'.*one finite number"),
        (lambda p, v: 3.0, "not odd"),
        (lambda p, v: np.array([1.0, 2.0]), "one finite number"),
    ],
)
def test_a_function_that_is_no_law(law, words):
    with pytest.raises(sa.ScenarioError, match=words) as raised:
        sa.basin(law=law, speeds=[4], progress=False)
    assert raised.value.key == "law"


def test_a_function_goes_without_limits():
    with pytest.raises(sa.ScenarioError, match="ideal"):
        sa.ride(law=h, torque_limit_nm=3, **START)
    with pytest.raises(sa.ScenarioError, match="function"):
        sa.sweep(law=h, over={"torque_limit_nm": [1, 2]})


def test_a_table_as_a_law():
    """Situation: a gain table as a dictionary and as a DataFrame. Must hold: both are the same ride, in f32."""
    table = {"speed_m_s": np.array([0.0, 7.5]), "gain_nm_s_rad": [30.0, 0.0]}
    frame = pytest.importorskip("pandas").DataFrame(table)
    one, two = sa.ride(law=table, **START), sa.ride(law=frame, **START)
    np.testing.assert_array_equal(one.roll_rad, two.roll_rad)
    assert float(abs(one.torque_nm).max()) > 1
