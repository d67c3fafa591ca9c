# SPDX-License-Identifier: Apache-2.0
"""Tells palpate batch, a line of JSON at a time, what becomes of Snakemake's jobs."""
import json


def log_handler(message):
    if message["level"] in ("job_info", "job_finished", "job_error"):
        wildcards = message.get("wildcards") or {}
        event = {"level": message["level"], "jobid": message["jobid"], "patient": wildcards.get("patient", ""), "stage": wildcards.get("stage", "")}
        print(json.dumps(event), flush=True)
