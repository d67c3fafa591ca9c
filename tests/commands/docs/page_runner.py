# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the blocks of a page in order, in one folder, with the built programs on the PATH."""
import collections
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, f"{os.environ['PALPATE_SOURCE']}/tests/commands")
from page_blocks import blocks_of, missing_line, page_it_starts_from  # noqa: E402
from x_server import XServer  # noqa: E402

SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
BIN = pathlib.Path(os.environ["PALPATE_BIN"])
BUILD = pathlib.Path(os.environ["PALPATE_BUILD"])
LONGEST_S = 280  # of a block
WINDOW_S = 60  # until a window opens, and closes
STATUS_PIXELS = 30  # high is the line below the slices
WINDOWS = ("window", "clicks")  # remarks of blocks that open one
# What a block needs besides palpate, by a word of it.
NEEDS = {"palpate batch": ["snakemake"], "sbatch": ["sbatch"], "xvfb-run": ["xvfb-run"]}


class Wrong(Exception):
    pass


class Pages:
    """Every page runs once; one that starts from another gets a copy of what that left behind."""

    def __init__(self, root=SOURCE, slow=False):
        self.root, self.slow = root, slow
        self.home = pathlib.Path(tempfile.mkdtemp(prefix="pages."))
        self.done = {}  # page -> its folder
        self.wrong = {}  # page -> what was thrown
        self.locks = collections.defaultdict(threading.Lock)  # page -> held while it runs
        self.ran, self.not_run, self.elsewhere = [], [], []  # blocks; (block, reason); blocks of examples

    def close(self):
        shutil.rmtree(self.home, ignore_errors=True)

    def environment(self):
        path = [BIN, BUILD / "tests", SOURCE / "sample_data", os.environ["PATH"]]
        kept = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "PYTHONPATH")}
        return kept | {"PATH": ":".join(map(str, path)), "HOME": str(self.home), "LC_ALL": "C.UTF-8", "LANGUAGE": "en",
                       "XDG_DATA_HOME": str(self.home / ".local/share")}

    def folder_of(self, page):
        """Where the page `page` (a path below the source) has run, perhaps by another thread. Throws Wrong."""
        with self.locks[page]:
            if page not in self.done and page not in self.wrong:
                try:
                    self.run_page(page)
                except Exception as error:
                    self.wrong[page] = error
            if page in self.wrong:
                raise self.wrong[page]
            return self.done[page]

    def run_page(self, page):
        text = (self.root / page).read_text()
        folder = self.home / page.replace("/", "_").removesuffix(".md")
        if start := page_it_starts_from(text):
            shutil.copytree(self.folder_of(os.path.normpath(os.path.join(os.path.dirname(page), start))), folder)
        else:
            folder.mkdir()
        for block in blocks_of(page, text):
            reason = self.reason_against(block)
            if block.remark == "examples":
                self.elsewhere.append(block)
            elif reason:
                self.not_run.append((block, reason))
            else:
                self.run(block, folder)
                self.ran.append(block)
        self.done[page] = folder

    def reason_against(self, block):
        if block.remark == "not run" or block.remark == "slow" and not self.slow:
            return block.reason
        needed = [tool for word, tools in NEEDS.items() if word in block.code for tool in tools]
        needed += ["Xvfb", "xdotool"] if block.remark in WINDOWS else []
        missing = [tool for tool in needed if not shutil.which(tool)]
        return f"not installed here: {', '.join(missing)}" if missing else ""

    def run(self, block, folder):
        if block.remark in WINDOWS:
            for line in block.code.replace("\\\n", " ").splitlines():
                self.open_and_close(block, line, folder)
            return
        command = ["bash", "-euo", "pipefail", "-c", block.code] if block.language == "sh" else \
            [sys.executable, "-c", block.code, *self.argument_of(block, folder)]
        started = time.monotonic()
        try:
            ended = subprocess.run(command, cwd=folder, env=self.environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, timeout=LONGEST_S)
        except subprocess.TimeoutExpired as error:
            raise Wrong(f"{block}: not done after {LONGEST_S} s:\n{block.code}") from error
        block.seconds = time.monotonic() - started
        wanted = int(block.remark.split()[1]) if block.remark.startswith("exit") else 0
        if ended.returncode != wanted:
            raise Wrong(f"{block}: exit code {ended.returncode}, expected {wanted}, of\n{block.code}which printed\n{ended.stdout[-4000:]}")
        if block.output is not None and (line := missing_line(block.output, ended.stdout)) is not None:
            raise Wrong(f"{block}: the page says\n  {line}\nbut\n{block.code}printed\n{ended.stdout[-4000:]}")

    @staticmethod
    def argument_of(block, folder):
        """A script that takes an asset gets the page's."""
        return [str(folder / "case.vtkhdf")] if "sys.argv[1]" in block.code else []

    def click_and_save(self, window, display):
        """Places a seed in the middle of the axial slice, which a cube's volume has in the upper left quarter above the status line."""
        said = subprocess.run(["xdotool", "getwindowgeometry", "--shell", window], env=self.environment() | display, capture_output=True, text=True)
        shape = dict(line.split("=") for line in said.stdout.split())
        place = [str(int(shape["WIDTH"]) // 4), str((int(shape["HEIGHT"]) - STATUS_PIXELS) // 4)]
        subprocess.run(["xdotool", "windowfocus", window, "mousemove", "--window", window, *place, "click", "1", "sleep", "1", "key", "s"],
                       env=self.environment() | display, check=True)

    def open_and_close(self, block, line, folder):
        if not line.partition("#")[0].strip():
            return
        started = time.monotonic()
        with XServer("1280x720") as server:
            display = {"DISPLAY": server.environment["DISPLAY"]}
            with open(f"{folder}.window.log", "w") as log:
                process = subprocess.Popen(["bash", "-euc", line], cwd=folder, env=self.environment() | display, stdin=subprocess.DEVNULL,
                                           stdout=log, stderr=subprocess.STDOUT, start_new_session=True)
                try:
                    window, until = "", time.monotonic() + WINDOW_S
                    while not window and process.poll() is None and time.monotonic() < until:
                        time.sleep(0.3)
                        window = subprocess.run(["xdotool", "search", "--onlyvisible", "--name", "[Pp]alpate"], env=self.environment() | display,
                                                capture_output=True, text=True).stdout.partition("\n")[0]
                    if not window:
                        raise Wrong(f"{block}: no window opens:\n{line}\n{pathlib.Path(log.name).read_text()[-2000:]}")
                    time.sleep(2)
                    if block.remark == "clicks":
                        self.click_and_save(window, display)
                    until = time.monotonic() + WINDOW_S
                    while process.poll() is None and time.monotonic() < until:
                        subprocess.run(["xdotool", "windowfocus", window, "key", "q"], env=self.environment() | display, capture_output=True)
                        time.sleep(1)
                    if process.poll() != 0:
                        raise Wrong(f"{block}: exit code {process.poll()} at Q of\n{line}\n{pathlib.Path(log.name).read_text()[-2000:]}")
                finally:
                    if process.poll() is None:
                        os.killpg(process.pid, signal.SIGKILL)
                        process.wait()
        block.seconds = getattr(block, "seconds", 0) + time.monotonic() - started
