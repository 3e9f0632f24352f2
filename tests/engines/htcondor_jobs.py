"""Does the jobs of a submit file, one after the other: HTCondor reads the file and says which they are, but starts none."""

import subprocess
import sys
from pathlib import Path

import htcondor2

submit = htcondor2.Submit(Path(sys.argv[1]).read_text())
items = list(submit.itemdata())
assert items, "the file has jobs"
for item in items:
    arguments = submit["arguments"]
    for name, value in item.items():
        arguments = arguments.replace(f"$({name})", value)
    subprocess.run([submit["executable"], *arguments.split()], check=True)
