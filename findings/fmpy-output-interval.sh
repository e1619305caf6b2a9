#!/usr/bin/env bash
# FMPy 0.3.32: `simulate_fmu` steps an FMU with a fixed step of 1 ms in steps of 8 ms, and ends early, without a word.
#
# Without `output_interval` the FMU's step is doubled until there are at most 1,000 steps, also where the FMU declares a fixed internal
# step, and that interval is the communication step, too (`simulation.py`, "output_interval *= 2"). Inputs are then held eight
# times as long as the FMU samples them. A last step that would pass the end is left out: of 60 s the last 32 ms are not simulated.
# Seen with: FMPy 0.3.32: 750 steps of 8 ms for 6 s; 937 of 64 ms, up to 59.968 s, for 60 s; 6000 of 1 ms with output_interval=0.001.
# Fails when it says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
python3 -m venv venv
venv/bin/pip install --quiet fmpy==0.3.32
cat >make.py <<'PY'
import pathlib, subprocess, fmpy
from fmpy.fmi3 import FMU3Slave
special = {"fmi3GetVersion": 'const char *fmi3GetVersion(void) { return "3.0"; }',
           "fmi3InstantiateCoSimulation": "void *fmi3InstantiateCoSimulation(void) { return special; }"}
names = [name for name in dir(FMU3Slave) if name.startswith("fmi3")]
code = "static char special[1];\n" + "\n".join(special.get(name, f"int {name}(void) {{ return 0; }}") for name in names)
folder = pathlib.Path("fmu/binaries") / fmpy.platform_tuple
folder.mkdir(parents=True)
pathlib.Path("empty.c").write_text(code)
subprocess.run(["cc", "-w", "-shared", "-fPIC", "-o", folder / ("empty" + fmpy.sharedLibraryExtension), "empty.c"], check=True)
pathlib.Path("fmu/modelDescription.xml").write_text("""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="empty" instantiationToken="empty">
  <CoSimulation modelIdentifier="empty" fixedInternalStepSize="0.001"/>
  <ModelVariables><Float64 name="time" valueReference="0" causality="independent" variability="continuous"/></ModelVariables>
  <ModelStructure/>
</fmiModelDescription>""")
for duration, interval in ((6.0, None), (60.0, None), (6.0, 0.001)):
    times = fmpy.simulate_fmu(str(pathlib.Path("fmu").resolve()), stop_time=duration, output_interval=interval)["time"]
    print(f"{duration:.0f} s: {len(times) - 1} steps, to {times[-1]:.3f} s")
PY
seen=$(venv/bin/python make.py | tr '\n' ';')
echo "$seen"
[ "$seen" = "6 s: 750 steps, to 6.000 s;60 s: 937 steps, to 59.968 s;6 s: 6000 steps, to 6.000 s;" ] || { echo "changed" >&2; exit 1; }
