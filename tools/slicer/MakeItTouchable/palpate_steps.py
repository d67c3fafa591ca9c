# SPDX-License-Identifier: GPL-3.0-or-later
"""What 'Make it touchable' does without Slicer: finds palpate, names files, composes its command lines, reads what it says."""
import re
import shutil
import unicodedata
from pathlib import Path
from typing import NamedTuple

PORT = 18944  # OpenIGTLink's own
LAST_LINES = 12  # of what a failed command said
NOT_STARTED = 127  # as a shell says it
# As in the help of any command, and what is no code of palpate's.
EXIT_CODES = {0: "ok", 1: "failed", 2: "usage", 3: "invalid input", 4: "quality contract not met", 130: "interrupted",
              NOT_STARTED: "could not be started"}


class CaseFiles(NamedTuple):
    """Where the files of one case lie, all in one folder."""
    labels: Path  # .seg.nrrd
    volume: Path  # .nrrd
    case: Path  # .toml
    asset: Path  # .vtkhdf
    report: Path  # .html, which build writes beside the asset
    parts: Path  # folder of intermediate results


def file_stem(name):
    """A segment's name as the beginning of a file's: ASCII letters, digits, '.', '-' and '_', never empty or hidden."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    return re.sub(r"[^A-Za-z0-9.-]+", "_", plain).strip("._-") or "organ"


def case_files(folder, organ):
    """The files in `folder` of a case whose organ is the segment `organ`."""
    folder, stem = Path(folder), file_stem(organ)
    return CaseFiles(folder / f"{stem}.seg.nrrd", folder / f"{stem}.nrrd", folder / f"{stem}.toml", folder / f"{stem}.vtkhdf",
                     folder / f"{stem}.html", folder / f"{stem}.parts")


def files_in_the_way(files, with_volume):
    """What is there of the files that a case writes anew, in the order in which it writes them."""
    written = [files.labels, *([files.volume] if with_volume else []), files.case, files.asset, files.report]
    return [path for path in written if path.exists()]


def find_program(setting, module_folder, search_path=None):
    """The program palpate, as text, or None: `setting` (a file, or a folder with it) where it is given; else on the PATH, as
    `search_path` gives it or the process has it; else where it was installed together with the module's folder."""
    if setting:
        path = Path(setting)
        return shutil.which(str(path / "palpate" if path.is_dir() else path))
    beside = (Path(module_folder) / "../../../../bin/palpate").resolve()  # of PREFIX/share/palpate/slicer/MakeItTouchable
    return shutil.which("palpate", path=search_path) or shutil.which(str(beside))


def missing_program(setting):
    """What to say where find_program() finds nothing."""
    where = f"{setting} is no program" if setting else "palpate is not on the PATH"
    return (f"{where}. Install the packages palpate-runtime and palpate-tools, and palpate-trainer to touch in a window, or build "
            "Palpate from source and choose build/release/bin/palpate above.")


def init_arguments(files, organ, replace):
    """`palpate init`: drafts the case file, in which the segment `organ` gives way."""
    return ["init", str(files.labels), f"--organ={organ}", "-o", str(files.case), *(["--force"] if replace else [])]


def build_arguments(files, with_volume, replace):
    """`palpate build`: case file to asset and report; the scan goes along for the eye `with_volume`."""
    volume = ["--volume", str(files.volume)] if with_volume else []
    return ["build", str(files.case), *volume, "-o", str(files.asset), *(["--force"] if replace else [])]


def train_arguments(asset):
    """`palpate train`: the window in which the asset is touched."""
    return ["train", str(asset)]


def touch_arguments(asset, port, seconds):
    """`palpate touch`: presses the asset for `seconds` without a window, seen over OpenIGTLink at `port` of this machine."""
    return ["touch", str(asset), "--script=press", f"--seconds={seconds}", f"--stream={port}"]


def split_lines(left_over, chunk):
    """Whole lines, as text, of what a process wrote (bytes), and the bytes after the last of them; `left_over` is that of the
    call before."""
    *lines, rest = (left_over + chunk).replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
    return [line.decode("utf-8", "replace") for line in lines], rest


def progress_of(line):
    """What a command is at: "mesh liver" of its line "palpate-build: mesh liver", "mesh: refine" of "palpate-mesh: refine"; None
    of a line of another form."""
    found = re.fullmatch(r"palpate-(?:build: )?(\S.*)", line)
    return found and found[1]


def exit_meaning(code):
    """An exit code of palpate in words."""
    return f"exit code {code}: {EXIT_CODES.get(code, 'none of palpate, it may have crashed')}"


def failure(step, code, lines, files):
    """What to say where `palpate STEP` ended with `code`: that, its last `lines` as they are, and the page on which a build
    shows how far it came."""
    page = files.parts / "failure.html"
    return "\n".join([f"palpate {step}, {exit_meaning(code)}", *[line for line in lines if line.strip()][-LAST_LINES:],
                      *([f"See {page}"] if step == "build" and page.exists() else [])])


def mesh_files(files):
    """Meshes of a finished build, in LPS mm: tetrahedra of the bodies that give way (.vtu), surfaces of the others (.vtp)."""
    return [*sorted(files.parts.glob("*.vtu")), *sorted(files.parts.glob("*.vtp"))]
