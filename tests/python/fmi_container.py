"""Controller and bicycle in FMPy's container, whose master is compiled; as a program, its speed.

    python fmi_container.py bicycle.fmu controller.fmu
"""

import sys
import tempfile
import time
from pathlib import Path

import fmpy
from fmpy.container_fmu.cli import create_container_fmu
from fmpy.container_fmu.config import Component, Configuration, Connection
from fmpy.model_description import CoSimulation, DefaultExperiment, ModelDescription, ModelVariable, Unknown

# What the published laws read.
FEW = ("gyro_x_rad_s", "front_wheel_m_s", "assist_torque_nm")


def container(folder, bicycle, controller, outputs, signals=None):
    """Writes an FMU of both, of FMI 3.0, to the folder; connects all equal names, or only `signals`.

    Its step is 1 ms, whatever the step of the importer.
    """
    parts = [
        Component(name=Path(file).stem, filename=Path(file), modelDescription=fmpy.read_model_description(file))
        for file in (controller, bicycle)
    ]
    known = [{v.name: v for v in part.modelDescription.modelVariables} for part in parts]

    def connection(source, target):
        names = [
            name
            for name, v in known[source].items()
            if v.causality == "output" and v.type == "Float64" and name in known[target]
            and known[target][name].causality == "input" and (signals is None or name in signals)
        ]
        ends = [[known[part][name] for name in names] for part in (source, target)]
        return Connection(startElement=parts[source], startConnectors=ends[0], endElement=parts[target], endConnectors=ends[1])

    # The container numbers its variables after the time, which it has itself.
    instant = ModelVariable(type="Float64", name="time", valueReference=0, causality="independent", variability="continuous")
    shown = {
        ModelVariable(
            type="Float64", name=name, valueReference=i + 1, causality="output", variability="continuous", initial="calculated"
        ): [(parts[1], known[1][name])]
        for i, name in enumerate(outputs)
    }
    description = ModelDescription(
        fmiVersion="3.0",
        modelName="assisted bicycle",
        instantiationToken="assisted-bicycle",
        coSimulation=CoSimulation(
            modelIdentifier="container_fmu", fixedInternalStepSize=0.001, canHandleVariableCommunicationStepSize=True
        ),
        defaultExperiment=DefaultExperiment(startTime="0", stopTime="6"),
        modelVariables=[instant, *shown],
    )
    description.outputs = [Unknown(variable=v, dependencies=[]) for v in shown]
    description.initialUnknowns = [Unknown(variable=v) for v in shown]
    configuration = Configuration(
        parallelDoStep=False,
        modelDescription=description,
        components=parts,
        connections=[connection(1, 0), connection(0, 1)],
        variableMappings=shown,
    )
    work = Path(folder) / "work"
    work.mkdir()
    create_container_fmu(configuration, work, Path(folder) / "assisted.fmu")
    return Path(folder) / "assisted.fmu"


def measured(bicycle, controller):
    """Prints the time of 60 s by signals and by interval of the output, the best of three."""
    for signals in (FEW, None):
        with tempfile.TemporaryDirectory() as folder:
            file = container(folder, bicycle, controller, ["roll_rad", "steer_rad"], signals)
            unpacked = fmpy.extract(str(file), folder + "/unpacked")
            for interval in (0.001, 0.01, 0.1):
                best = float("inf")
                for _ in range(3):
                    begun = time.perf_counter()
                    fmpy.simulate_fmu(unpacked, stop_time=60.0, output_interval=interval, output=["roll_rad"], validate=False)
                    best = min(best, time.perf_counter() - begun)
                what = "what the law reads" if signals else "all signals"
                print(f"{what}, output every {interval} s: 60 s in {best:.3f} s, {60 / best:.0f} times real time")


if __name__ == "__main__":
    measured(*sys.argv[1:3])
