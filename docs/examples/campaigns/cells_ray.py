"""Does a plan with Ray, one line of the file of chunks a task: python cells_ray.py PLAN CHUNKS [ADDRESS]"""

import subprocess
import sys

import ray

plan, chunks, *address = sys.argv[1:]


@ray.remote(num_cpus=1, max_retries=3, retry_exceptions=True)
def cells(part):
    subprocess.run(["sextant", "sweep", plan, "--cells", part, "--threads", "1", "--quiet"], check=True)


# Without an address, Ray uses the cores of this machine.
ray.init(*address)
with open(chunks) as lines:
    tasks = [cells.remote(line.strip()) for line in lines]
ray.get(tasks)
