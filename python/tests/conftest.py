"""What several tests need: the repository, and the command line where it is built."""

import json
import os
import subprocess
from pathlib import Path

import matplotlib
import pytest

matplotlib.use("Agg")

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def repository():
    return REPOSITORY


@pytest.fixture(scope="session")
def sim_host():
    """Runs the command line and returns its document. `cargo xtask test` names the program that it has built."""
    program = os.environ.get("STEER_ASSIST_SIM_HOST")
    if not program:
        pytest.skip("STEER_ASSIST_SIM_HOST does not name the program sim-host")

    def run(*words):
        command = [program, *words, "--json"]
        done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=REPOSITORY)
        return json.loads(done.stdout)

    return run
