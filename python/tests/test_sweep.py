"""Sweeps: cells, axes, and the same bytes on a Dask cluster whose worker is killed."""

import os
import signal

import numpy as np
import pytest
import steer_assist as sa

SEARCH = {"speeds": [3.0, 4.0], "tolerance": 0.1, "max_rate": 15}
OVER = {"torque_limit_nm": [1, 4.0, None], "sensor_delay_s": [0.0, 0.02]}


@pytest.fixture(scope="module")
def alone():
    return sa.sweep(over=OVER, progress=False, **SEARCH)


def test_axes_and_units(alone):
    assert alone.height.dims == ("torque_limit", "sensor_delay", "speed_m_s")
    assert alone.sizes == {"torque_limit": 3, "sensor_delay": 2, "speed_m_s": 2}
    assert alone.sensor_delay.values.tolist() == [0.0, 0.02] and alone.sensor_delay.units == "s"
    assert alone.sensor_delay.long_name == "delay of the sensors" and alone.torque_limit.units == "N m"
    assert alone.torque_limit.values.tolist() == ["1", "4.0", "none"]
    assert alone.area.units == "rad m s-2" and alone.complete == 1
    assert bool((alone.height.sel(torque_limit="1") < alone.height.sel(torque_limit="none")).all())


@pytest.mark.parametrize(
    "axis, values, dim, units, coordinate",
    [
        ("torque_limit_nm", [1, 4.0], "torque_limit", "N m", [1.0, 4.0]),
        ("rate_limit_nm_s", [10, 100], "rate_limit", "N m s-1", [10.0, 100.0]),
        ("sensor_delay_s", ["0ms", "20ms"], "sensor_delay", "ms", [0.0, 20.0]),
        ("time_limit_s", [3, 6], "time_limit", "s", [3.0, 6.0]),
        ("recovered_below", [0.1, 0.2], "recovered_below", "1", [0.1, 0.2]),
        ("taper_m_s", ["0.5:1.5", "1:2"], "taper", "m s-1", ["0.5:1.5", "1:2"]),
        ("law", ["h", "f"], "law", "1", ["h", "f"]),
    ],
)
def test_an_axis_has_its_keys_unit_and_name(axis, values, dim, units, coordinate):
    """Must hold: the dimension of the option's name, numbers or words as given, the key's unit, and words about it."""
    found = sa.sweep(over={axis: values}, speeds=[4.0], tolerance=0.2, max_rate=2, progress=False)
    assert found.area.dims == (dim,) and found[dim].values.tolist() == coordinate
    assert found[dim].units == units and found[dim].long_name


def test_a_rider_axis_is_a_delay():
    found = sa.sweep(over={"rider.delay_s": [0.03, 0.06]}, rider="young", speeds=[4.0], tolerance=0.2, max_rate=2, progress=False)
    assert found.delay.units == "s" and found.delay.long_name == "neural delay of the rider"


def test_a_cell_is_its_basin(alone):
    cell = sa.basin(torque_limit_nm=4, sensor_delay_s=0.02, progress=False, **SEARCH)
    np.testing.assert_array_equal(alone.height.sel(torque_limit="4.0", sensor_delay=0.02), cell.height)


def test_a_cell_is_the_command_lines(alone, sim_host, tmp_path):
    words = "sweep --over torque-limit=1,4.0,none --over sensor-delay=0.0s,0.02s --speeds 3:4:1 --tolerance 0.1 --max-rate 15 -q"
    there = sim_host(*words.split(), "--out", str(tmp_path / "out"))
    here = sa.document(alone)
    assert [cell["found"] for cell in here["cells"]] == [cell["found"] for cell in there["cells"]]
    assert here["axes"] == there["axes"]


def test_a_wrong_axis():
    with pytest.raises(sa.ScenarioError, match="colour"):
        sa.sweep(over={"colour": ["red"]})
    with pytest.raises(sa.ScenarioError, match="sequence"):
        sa.sweep(over={"law": "h"})
    with pytest.raises(sa.ScenarioError, match="torque-limit=-1"):
        sa.sweep(over={"torque_limit_nm": [-1, 2]})
    with pytest.raises(sa.ScenarioError, match="finite"):
        sa.sweep(over={"torque_limit_nm": [np.nan]})


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed", reason="dask.distributed is not installed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        yield cluster


def test_a_killed_worker_changes_no_byte(alone, cluster):
    """Situation: two workers. Action: kill one when the first cell is done. Must hold: its cell is computed again, and the document
    has the bytes of the sweep without a client."""
    from distributed import Client

    killed = []

    def kill(done, all):
        if not killed:
            worker = next(iter(cluster.workers.values()))
            os.kill(worker.process.pid, signal.SIGKILL)
            killed.append(worker.process.pid)

    with Client(cluster) as client:
        result = sa.sweep(over=OVER, client=client, progress=kill, **SEARCH)
    assert killed and result.attrs["document"] == alone.attrs["document"]


def test_an_error_of_a_cell_reaches_the_caller(cluster):
    from distributed import Client

    with Client(cluster) as client, pytest.raises(sa.ScenarioError, match="torque-limit"):
        sa.sweep(over={"torque_limit_nm": [-1, 2]}, client=client, progress=False, **SEARCH)


def test_a_closed_client_is_named(cluster):
    from distributed import Client

    client = Client(cluster)
    client.close()
    with pytest.raises(sa.ClientError, match="closed"):
        sa.sweep(over=OVER, client=client, **SEARCH)
    with pytest.raises(sa.ClientError, match="no dask.distributed.Client"):
        sa.sweep(over=OVER, client="tcp://127.0.0.1:8786", **SEARCH)
