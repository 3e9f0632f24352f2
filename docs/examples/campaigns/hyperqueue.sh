#!/bin/sh
#HQ --name=study
#HQ --each-line=chunks
#HQ --cpus=1
#HQ --stdout=none
#HQ --stderr=study-%{TASK_ID}.log
# Does the plan `study` with HyperQueue, one line of the file `chunks` a task: hq submit hyperqueue.sh
exec sextant sweep study --cells "$HQ_ENTRY" --threads 1 --quiet
