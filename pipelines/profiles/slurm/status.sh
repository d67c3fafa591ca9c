#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Says what became of a Slurm job: running, success or failed. Asks the controller, which needs no accounting; a controller that
# does not answer means that the job runs. It forgets a job some minutes after its end (MinJobAge).
if answer=$(scontrol --oneliner show job "$1" 2>&1); then
    state=$(printf '%s\n' "$answer" | sed -n 's/.* JobState=\([A-Z_]*\).*/\1/p')
    case $state in
        COMPLETED) echo success ;;
        BOOT_FAIL | CANCELLED | DEADLINE | FAILED | NODE_FAIL | OUT_OF_MEMORY | PREEMPTED | TIMEOUT) echo failed ;;
        *) echo running ;;
    esac
else
    case $answer in
        *"Invalid job id"*) echo failed ;;
        *) echo running ;;
    esac
fi
