# SPDX-License-Identifier: Apache-2.0
"""A clean Debian 12 in a folder, as bare as debootstrap makes it, in which packages are installed and used."""
import os
import pathlib
import shutil
import subprocess

CACHE = pathlib.Path(os.environ["PALPATE_BUILD"]) / "debian"  # the bare root and what apt fetched, kept from run to run
BARE, FETCHED = CACHE / "bare", CACHE / "fetched"
NEEDED = ("debootstrap", "unshare", "chroot")
# Mounts and processes of its own, which end with the command. The shell stays, for xvfb-run never hears of its server
# where it is process 1.
INSIDE = """root=$1; mount --bind "$2" "$root/var/cache/apt/archives" && mount -t proc proc "$root/proc" || exit 1
shift 2; chroot "$root" "$@"; exit"""
ENVIRONMENT = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root", "LC_ALL": "C.UTF-8",
               "DEBIAN_FRONTEND": "noninteractive"}
# What apt, dpkg and ldconfig keep of themselves, and what is no disk.
NOT_COUNTED = {"proc", "sys", "dev", "run", "tmp", "srv", "root", "var/cache", "var/log", "var/lib/apt",
               "var/lib/dpkg", "etc/ld.so.cache"}


def sources():
    """[(address, suite)] of Debian 12 in this machine's apt."""
    listed = subprocess.run(
        ["apt-get", "indextargets", "--format", "$(LABEL) $(REPO_URI) $(CODENAME)", "Created-By: Packages"],
        capture_output=True, text=True, check=True).stdout
    lines = [line.split() for line in dict.fromkeys(listed.splitlines()) if line.startswith("Debian")]
    return [(address, suite) for _, address, suite in lines if suite.startswith("bookworm")]


def why_not():
    """Why no root can be made here; empty if it can."""
    if os.geteuid() != 0:
        return "PALPATE: a Debian root needs root"
    if missing := [name for name in NEEDED if not shutil.which(name)]:
        return f"PALPATE: {', '.join(missing)} is missing"
    if not sources():
        return "PALPATE: this machine's apt has no Debian 12"
    return ""


def make_bare():
    """The bare root, made once, with all updates. Throws CalledProcessError where there is no network."""
    FETCHED.mkdir(parents=True, exist_ok=True)
    if not BARE.exists():
        address, suite = next(each for each in sources() if each[1] == "bookworm")
        started = CACHE / "started"
        shutil.rmtree(started, ignore_errors=True)
        subprocess.run(["debootstrap", "--variant=minbase", suite, started, address], check=True,
                       stdout=subprocess.DEVNULL)
        lines = (f"deb {address} {suite} main\n" for address, suite in sources())
        (started / "etc/apt/sources.list").write_text("".join(lines))
        (started / "etc/dpkg/dpkg.cfg.d/quick").write_text("force-unsafe-io\n")  # no root outlives its test
        started.rename(BARE)
    bare = DebianRoot(BARE)
    bare.run("apt-get", "update", "-q")
    bare.run("apt-get", "upgrade", "-y", "-q")


class DebianRoot:
    def __init__(self, folder):
        self.folder = folder

    @classmethod
    def in_new(cls, folder):
        """A copy of the bare root."""
        subprocess.run(["cp", "-a", "--reflink=auto", BARE, folder], check=True)
        return cls(folder)

    def run(self, *command):
        """What a command in it prints. Throws CalledProcessError after showing all that it said."""
        inside = ["unshare", "--mount", "--pid", "--fork", "--kill-child",
                  "sh", "-c", INSIDE, "sh", self.folder, FETCHED]
        ran = subprocess.run([*inside, *map(str, command)], env=ENVIRONMENT, text=True, stdin=subprocess.DEVNULL,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=900)
        if ran.returncode != 0:
            print(*command, ran.stdout[-6000:], ran.stderr[-6000:], sep="\n")
            ran.check_returncode()
        return ran.stdout

    def install(self, *packages, recommended=True):
        """Names, or archives of this machine, with what they depend on and, as apt does by itself, recommend."""
        self.take(*(each for each in packages if isinstance(each, pathlib.Path)))
        names = (f"/srv/{each.name}" if isinstance(each, pathlib.Path) else each for each in packages)
        self.run("apt-get", "install", "-y", "-q", "-o", f"APT::Install-Recommends={recommended}", *names)

    def take(self, *files):
        for file in files:
            shutil.copy2(file, self.folder / "srv")

    def purge(self):
        """Ours, and what came for their sake, also where something that was there recommends or suggests it."""
        ours = [name for name in self.packages() if "palpate" in name]
        self.run("apt-get", "purge", "-y", "-q", *ours)
        self.run("apt-get", "autoremove", "--purge", "-y", "-q", "-o", "APT::AutoRemove::RecommendsImportant=0",
                 "-o", "APT::AutoRemove::SuggestsImportant=0")

    def packages(self):
        """{name: KiB that it says it takes} of all that dpkg knows, removed but not purged as well."""
        listed = self.run("dpkg-query", "-W", "-f", "${Package} ${Installed-Size}\n")
        return {name: int(size) for name, size in map(str.split, listed.splitlines())}

    def files(self):
        """{path: bytes} of its files, but for NOT_COUNTED."""
        found = {}
        for folder, folders, names in os.walk(self.folder):
            here = pathlib.Path(folder).relative_to(self.folder)
            folders[:] = [name for name in folders if str(here / name) not in NOT_COUNTED]
            paths = (here / name for name in (*names, *folders) if str(here / name) not in NOT_COUNTED)
            found |= {str(path): (self.folder / path).lstat() for path in paths}
        return {path: stat.st_blocks * 512 for path, stat in found.items()}
