# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the lines of blocks that are marked as examples, each by itself in a folder with the files that it names."""
import contextlib
import pathlib
import re
import shutil
import sys
import tempfile
from graphlib import TopologicalSorter

from example_files import FILES, HOW, NAMED_IN, WINDOWS
from page_blocks import Block, blocks_of
from page_runner import SOURCE, Pages, Wrong

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import slurm_here  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
SLURM, SAMPLES = "--profile slurm", "build/sample_data"  # in lines that need them
# Options whose value is a file or folder that a line makes.
MAKES = re.compile(r" (?:-o|--json|--log|--curve|--screenshot|--video) ([\w.-]*\w)")
TAKES = re.compile(r"(?<=^palpate report )(.*) --curve \S+")  # the one command that takes what another makes by the same option


class NotRun(Exception):
    """Why a line cannot run here."""


def first_of(table, line, otherwise):
    """What a table says of the first beginning that is a line's."""
    return next((said for start, said in table.items() if line.startswith(start)), otherwise)


class Examples(Pages):
    """Every line runs once; another that names what it makes gets a copy of that."""

    def __init__(self, page, files=FILES, root=SOURCE):
        self.files = files
        self.examples = {}  # line -> its block
        for block in blocks_of(page, (root / page).read_text()):
            for n, line in enumerate(block.code.splitlines() if block.remark == "examples" else []):
                code = first_of(HOW, line, "{}").format(line) + "\n"
                self.examples[line] = Block(page, block.line + 1 + n, "sh", code, remark=first_of(WINDOWS, line, ""))
        self.blocks = self.examples | {line: Block(f"what makes {names}", 0, "sh", f"{line}\n") for names, line in files.items()}
        self.makers = {}  # name -> the line that makes it
        for line in (*files.values(), *self.examples):
            for name in self.made_by(line):
                self.makers.setdefault(name, line)
        needed = {line: {self.makers[name] for name in self.taken_by(line)} for line in self.blocks}
        TopologicalSorter(needed).prepare()  # throws CycleError where lines would wait for each other
        super().__init__(root)

    def environment(self):
        kept = super().environment()
        return kept | {"PATH": f"{HERE}:{kept['PATH']}"}

    def made_by(self, line):
        return [name for names, maker in self.files.items() if maker == line for name in names.split()] or MAKES.findall(TAKES.sub(r"\1", line))

    def taken_by(self, line):
        """The names in a line, and in what they name, that it does not make itself."""
        words = [f"{word}/" for word in re.findall(r"[\w./-]*\w", line)]
        names = {name for name in self.makers if any(word.startswith(f"{name}/") for word in words)} - set(self.made_by(line))
        return names.union(*(self.taken_by(NAMED_IN[name]) for name in names & NAMED_IN.keys()))

    def reason_against(self, block):
        if SLURM in block.code and slurm_here.why_not():
            return slurm_here.why_not()
        if SAMPLES in block.code and not (SOURCE / SAMPLES).is_dir():
            return "the sample volumes are absent; run sample_data/unpack.py"
        return super().reason_against(block)

    @contextlib.contextmanager
    def cluster_for(self, block):
        """A Slurm cluster while a line runs that asks for one."""
        if SLURM not in block.code:
            yield
            return
        cluster = slurm_here.Cluster(tempfile.mkdtemp(dir=self.home))
        try:
            cluster.start()
            block.code = f"SLURM_CONF={cluster.environment['SLURM_CONF']} CI=true {block.code}"  # Snakemake asks every second
            yield
        finally:
            cluster.stop()

    def unused(self):
        """What stands in the tables and is needed by no example."""
        taken = set().union(*map(self.taken_by, self.blocks))
        return [names for names in self.files if not taken & set(names.split())] + [name for name in NAMED_IN if name not in taken] + \
            [start for start in (*HOW, *WINDOWS) if not any(line.startswith(start) for line in self.examples)]

    def run_page(self, line):
        block = self.blocks[line]
        if reason := self.reason_against(block):
            raise NotRun(reason)
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.home))
        for name in self.taken_by(line):
            made = self.folder_of(self.makers[name]) / name
            (folder / name).parent.mkdir(exist_ok=True)
            (shutil.copytree if made.is_dir() else shutil.copy2)(made, folder / name)
        with self.cluster_for(block):
            self.run(block, folder)
        for name in self.made_by(line):
            if not (folder / name).exists():
                raise Wrong(f"{block}: does not make {name}:\n{line}")
        self.done[line] = folder
