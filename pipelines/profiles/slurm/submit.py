#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Submits one of Snakemake's jobs with its memory, time and threads, and prints its id. The job runs the stage's own command line and
not Snakemake once more, which saves a second each."""
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

MARK = "# properties = "  # a line of Snakemake's job script
properties = next(json.loads(line[len(MARK):]) for line in Path(sys.argv[1]).read_text().splitlines() if line.startswith(MARK))
parameters, resources = properties["params"], properties["resources"]
stamp, log = Path(properties["output"][0]).absolute(), Path(parameters["log"])
log.parent.mkdir(parents=True, exist_ok=True)
stamp.parent.mkdir(parents=True, exist_ok=True)
command = shlex.join([*parameters["job"], "--threads", str(properties["threads"]), "--force"])
time_limit = [] if "SBATCH_TIMELIMIT" in os.environ else [f"--time={resources['minutes']}"]  # the site's own goes before ours
submitted = subprocess.run(
    ["sbatch", "--parsable", f"--job-name=palpate {properties['wildcards']['patient']} {properties['wildcards']['stage']}",
     *time_limit, f"--mem={resources['mem_mb']}M", f"--cpus-per-task={properties['threads']}", f"--chdir={parameters['folder']}",
     f"--output={log}", f"--wrap={command} && touch {shlex.quote(str(stamp))}"],
    stdout=subprocess.PIPE, text=True, check=True)
print(submitted.stdout.strip().split(";")[0])
