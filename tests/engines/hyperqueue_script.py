"""Does a script with `#HQ --each-line=FILE` on HyperQueue in this process, as `hq submit` would."""

import sys
from pathlib import Path

from hyperqueue import Job, LocalCluster
from hyperqueue.cluster import WorkerConfig

script = Path(sys.argv[1])
options = [line.removeprefix("#HQ ") for line in script.read_text().splitlines() if line.startswith("#HQ ")]
(file,) = [option.removeprefix("--each-line=") for option in options if option.startswith("--each-line=")]
with LocalCluster() as cluster:
    cluster.start_worker(WorkerConfig(cores=2))
    client = cluster.client()
    job = Job()
    for line in Path(file).read_text().splitlines():
        job.program(["sh", str(script)], env={"HQ_ENTRY": line})
    client.wait_for_jobs([client.submit(job)])
