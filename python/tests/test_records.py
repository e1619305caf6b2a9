"""Recorded rides: replay through the flashed code, identification of a rider."""

import numpy as np
import pytest
import steer_assist as sa


def test_a_replay(repository, sim_host):
    """Situation: the shipped extract of a real ride. Must hold: the document is the command line's, the rows have units."""
    file = "data/recordings/g2_steer_encoder_spikes_2mps.csv"
    found = sa.replay(repository / file, map="extract")
    there = sim_host("replay", file, "--map", "extract")
    assert sa.document(found)["checks"] == there["checks"]
    assert found.torque.units == "N m" and found.measured_roll_rate.units == "rad s-1"
    assert 0.005 < float(np.median(np.diff(found.time_s))) < 0.02
    causes = sa.causes(found)
    assert list(causes.name) == [cause["name"] for cause in there["causes"]]
    assert {"first_s", "total_s"} <= set(causes.columns)


def test_what_a_replay_lacks(repository, tmp_path):
    with pytest.raises(sa.ScenarioError, match="nothing.csv"):
        sa.replay(tmp_path / "nothing.csv")
    with pytest.raises(sa.ScenarioError, match="mapp"):
        sa.replay(repository / "data/recordings/g2_steer_encoder_spikes_2mps.csv", mapp="extract")
    with pytest.raises(sa.ScenarioError, match="nomap") as raised:
        sa.replay(repository / "data/recordings/g2_steer_encoder_spikes_2mps.csv", map="nomap")
    assert raised.value.key == "map"


def test_what_an_identification_lacks(tmp_path):
    record = tmp_path / "record.csv"
    record.write_text("time_s,steer_rad\n0,0\n0.01,0\n")
    with pytest.raises(sa.ScenarioError, match="record.csv"):
        sa.identify(record)
    with pytest.raises(sa.ScenarioError, match="K_nothing"):
        sa.identify(record, gains=["K_nothing"])
    with pytest.raises(sa.ScenarioError, match="delay_s"):
        sa.identify(record, delay_s=30)
