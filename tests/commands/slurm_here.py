# SPDX-License-Identifier: GPL-3.0-or-later
"""A Slurm cluster of one node on this machine's loopback, without accounting: for tests that submit jobs."""
import contextlib
import os
import pathlib
import pwd
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "mungekey", "slurmctld", "slurmd", "sbatch", "scontrol")

CONFIGURATION = """ClusterName=here
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=1
SlurmdTimeout=20
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    """Of this machine's loopback; another process may take them before they are used."""
    with contextlib.ExitStack() as sockets:
        opened = [sockets.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in range(count)]
        return [one.getsockname()[1] for one in opened]


def why_not():
    """Why no cluster can be started here; none if one can."""
    missing = [name for name in PROGRAMS if shutil.which(name) is None]
    if missing:
        return f"not installed: {', '.join(missing)}"
    return None if os.geteuid() == 0 else "slurmd needs root"


class Cluster:
    """Daemons in a folder of their own; `environment` makes Slurm's commands speak to them."""

    def __init__(self, folder):
        self.folder, self.daemons = pathlib.Path(folder), {}
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf")}
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        host = os.uname().nodename.split(".")[0]
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20 * 9 // 10
        port, node_port = free_ports(2)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=host, port=port, node_port=node_port, folder=self.folder, user=pwd.getpwuid(os.geteuid()).pw_name,
            cpus=os.cpu_count(), memory=memory))

    def start_daemon(self, name, *command):
        with (self.folder / f"{name}.out").open("ab") as log:
            self.daemons[name] = subprocess.Popen(command, stdout=log, stderr=log, env=self.environment)

    def start(self):
        key, pipe = self.folder / "munge.key", self.folder / "munge.socket"
        subprocess.run(["mungekey", "--create", f"--keyfile={key}"], check=True)
        self.start_daemon("munged", "munged", "--foreground", "--force", f"--key-file={key}", f"--socket={pipe}",
                          f"--pid-file={self.folder / 'munge.pid'}", f"--seed-file={self.folder / 'munge.seed'}")
        self.wait_for("munge.socket", pipe.exists)
        self.start_daemon("slurmctld", "slurmctld", "-D", "-c")
        self.start_node()
        self.wait_for("a node", lambda: "idle" in self.ask("sinfo", "--noheader", "--format=%T"))

    def start_node(self):
        self.start_daemon("slurmd", "slurmd", "-D")

    def ask(self, *command):
        return subprocess.run(command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                              check=False).stdout

    def wait_for(self, what, condition, seconds=60):
        for _ in range(10 * seconds):
            if condition():
                return
            time.sleep(0.1)
        logs = "\n".join(path.read_text()[-2000:] for path in self.folder.glob("*.log"))
        raise TimeoutError(f"waited {seconds} s for {what}\n{logs}")

    def kill(self, name):
        self.daemons[name].kill()
        self.daemons.pop(name).wait()

    def stop(self):
        for process in reversed(self.daemons.values()):
            process.send_signal(signal.SIGTERM)
        for process in self.daemons.values():
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(10)
            process.kill()
            process.wait()
