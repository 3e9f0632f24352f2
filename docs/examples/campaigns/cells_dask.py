"""Does a plan with Dask, one line of the file of chunks a task: python cells_dask.py PLAN CHUNKS [ADDRESS]"""

import subprocess
import sys

from dask.distributed import Client


def cells(part, plan):
    subprocess.run(["sextant", "sweep", plan, "--cells", part, "--threads", "1", "--quiet"], check=True)


if __name__ == "__main__":
    plan, chunks, *address = sys.argv[1:]
    # Without an address, Dask uses the cores of this machine.
    with Client(*address) as client, open(chunks) as lines:
        parts = [line.strip() for line in lines]
        client.gather(client.map(cells, parts, plan=plan, pure=False, retries=3))
