"""Basins: the published one, equal to the command line's in every bit; coordinates, draws, planes."""

import numpy as np
import pytest
import steer_assist as sa
import xarray as xr

WITHOUT = ("seconds",)  # The computing time.


@pytest.fixture(scope="module")
def published():
    return sa.basin(progress=False)


def test_the_readmes_basin(published, sim_host):
    """Situation: all defaults. Must hold: the numbers of the README; the whole document is the command line's."""
    assert 72.683 < published.area < 72.685 and 7.249 < published.mean_height < 7.251
    here, there = sa.document(published), sim_host("basin")
    for document in (here, there):
        document.pop("seconds")
        document["tool"].pop("commit")
    assert here == there


def test_coordinates_and_units(published, tmp_path):
    """Must hold: units, and a NetCDF file gives the same arrays again."""
    assert published.sizes == {"speed_m_s": 101, "rate": 120}
    assert published.height.units == "rad s-1" and published.time_to_fall_s.units == "s"
    fallen = published.outcome == "fallen"
    assert 0.2 < float(fallen.mean()) < 0.95
    assert bool((fallen == published.time_to_fall_s.notnull()).all())
    inside = published.rate <= published.height
    assert not bool((inside & fallen).any())
    published.to_netcdf(tmp_path / "basin.nc", engine="h5netcdf")
    again = xr.open_dataset(tmp_path / "basin.nc", engine="h5netcdf")
    np.testing.assert_array_equal(again.height, published.height)
    assert again.time_to_fall_s.dtype == float
    assert sa.scenario(again) == sa.scenario(published)


def test_a_result_is_a_scenario():
    """Action: run the scenario in a result again, with one change. Must hold: it is the change alone."""
    first = sa.basin(speeds=[3.0, 4.0], law="f", tolerance=0.1, progress=False)
    again = sa.basin(first, progress=False)
    xr.testing.assert_equal(first, again)
    limited = sa.basin(first, torque_limit_nm=3, progress=False)
    assert limited.speed_m_s.values.tolist() == [3.0, 4.0]
    assert bool((limited.height < first.height).all())
    assert sa.document(limited)["config"]["torque_limit_nm"] == 3.0


def test_threads_change_no_bit():
    one = sa.basin(speeds=np.arange(2, 8), threads=1, progress=False)
    two = sa.basin(speeds=np.arange(2, 8), threads=2, progress=False)
    xr.testing.assert_identical(one.drop_attrs(), two.drop_attrs())


def test_progress_is_told():
    calls = []
    sa.basin(speeds=[3, 4, 5], progress=lambda done, all: calls.append((done, all)))
    assert calls[-1] == (3, 3)


def test_draws_have_a_band():
    """Situation: a bicycle with uncertainties. Must hold: quantiles rise and the drawn heights lie around the height."""
    values = sa.check(bicycle="rigid_jason")["config"]["bicycle"]["parameters"]
    uncertain = pytest.importorskip("uncertainties")
    own = {**values, "mB": uncertain.ufloat(values["mB"], 2.0)}
    result = sa.basin(bicycle=own, uncertain=6, speeds=[4.0, 5.0], tolerance=0.1, progress=False)
    assert result.sizes["draw"] == 6
    low, middle, high = result.drawn_quantile.transpose("quantile", "speed_m_s").values
    assert (low <= middle).all() and (middle <= high).all() and (low < high).any()


def test_plane(sim_host):
    """Must hold: the outline is closed, has the document's area, and the document is the command line's."""
    found = sa.plane(speed=4, rays=8, points=20, tolerance=0.005, progress=False)
    x, y = found.steer_rate_rad_s.values, found.roll_rate_rad_s.values
    assert (x[0], y[0]) == (x[-1], y[-1]) and len(x) == 17
    area = 0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])
    assert found.area == pytest.approx(area, rel=1e-12) and area > 1
    there = sim_host(*"basin plane --speed 4 --rays 8 --points 20 --ray-tolerance 0.005".split())
    assert sa.document(found)["outline"] == there["outline"]


def test_a_function_replaces_the_law_of_a_result():
    """Situation: a basin of law h. Action: the same again with a function, as a result and as a dictionary. Must hold: that of the
    function; its own result can be used again with it."""
    short = {"speeds": [4.0, 5.0]}
    of_h = sa.basin(law="h", **short)
    law = lambda roll_rate_rad_s, speed_m_s: 3.0 * roll_rate_rad_s
    alone = sa.basin(law=law, **short).height
    assert not alone.equals(of_h.height)
    assert sa.basin(of_h, law=law).height.equals(alone)
    assert sa.basin({"law": "h", "search": short}, law=law).height.equals(alone)
    assert sa.basin(sa.basin(law=law, **short), law=law).height.equals(alone)


def test_laws_that_are_odd_at_some_rates_only():
    """Situation: functions that are not odd beyond 0.5 rad/s, or at another speed. Must hold: refused with the place."""
    for law, place in (
        (lambda r, v: 12.0 * r if abs(r) <= 0.5 else 12.0 * r + 5.0, "1.0 rad/s"),
        (lambda r, v: 12.0 * r if v > 3.5 else 12.0 * abs(r), "2.0 m/s"),
    ):
        with pytest.raises(sa.ScenarioError, match="not odd") as raised:
            sa.basin(law=law, speeds=[4.0])
        assert place in str(raised.value)


def test_a_single_speed_has_no_area():
    assert np.isnan(sa.basin(speeds=[4.0], max_rate=0.5).area)
