# SPDX-License-Identifier: GPL-3.0-or-later
"""A real archive, Orthanc, on this machine's loopback in a folder of its own: for tests that send to one."""
import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time
import urllib.request

sys.path.insert(0, f"{os.environ['PALPATE_SOURCE']}/tests/commands")
from slurm_here import free_ports  # noqa: E402


def program():
    """Debian keeps it where only root's PATH looks."""
    return shutil.which("Orthanc", path="/usr/sbin:/usr/bin") or shutil.which("Orthanc")


def why_not():
    """Why no archive can be started here; none if one can."""
    return None if program() else "not installed: orthanc"


class Archive:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.port, dicom_port = free_ports(2)
        (self.folder / "orthanc.json").write_text(json.dumps({
            "Name": "here", "StorageDirectory": str(self.folder / "storage"), "IndexDirectory": str(self.folder / "storage"),
            "HttpPort": self.port, "DicomPort": dicom_port, "RemoteAccessAllowed": False, "AuthenticationEnabled": False,
            "SslEnabled": False, "Plugins": []}))

    def start(self):
        with (self.folder / "orthanc.log").open("wb") as log:
            self.process = subprocess.Popen([program(), str(self.folder / "orthanc.json")], stdout=log, stderr=log)
        for _ in range(300):
            with contextlib.suppress(OSError):
                self.ask("/system")
                return
            if self.process.poll() is not None:
                break
            time.sleep(0.1)
        self.stop()
        raise TimeoutError((self.folder / "orthanc.log").read_text()[-2000:])

    def request(self, path, data=None):
        with urllib.request.urlopen(urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", data=data), timeout=60) as reply:
            return reply.read()

    def ask(self, path, data=None):
        return json.loads(self.request(path, data))

    def stop(self):
        self.process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(20)
        self.process.kill()
        self.process.wait()
