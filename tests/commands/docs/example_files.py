# SPDX-License-Identifier: GPL-3.0-or-later
"""What the examples of docs/commands.md, which are those of --help, name and need.

What an example makes, by -o and the like, is what the others take that name it, of several the first. Here stands what none makes.
"""

# Files and folders -> the line that makes them, where those are that it names.
FILES = {
    "ct.nrrd abdomen.seg.nrrd": "phantom abdomen ct.nrrd abdomen.seg.nrrd",
    "head.nrrd head.seg.nrrd": "phantom head head.nrrd head.seg.nrrd",
    "patient7.nrrd": "phantom head patient7.nrrd truth.seg.nrrd --noise 10 --seed 7",
    "head_ct.nrrd": "cp head.nrrd head_ct.nrrd",
    "liver.seg.nrrd": "cp abdomen.seg.nrrd liver.seg.nrrd",
    "prior.seg.nrrd": "cp abdomen.seg.nrrd prior.seg.nrrd",
    "ct_series": "dicom_series.py ct.nrrd ct_series",
    "totalseg.nii.gz": "made_up.py named abdomen.seg.nrrd totalseg.nii.gz",
    "seg.nii.gz": "made_up.py organs abdomen.seg.nrrd seg.nii.gz",
    "mri.nii.gz": "made_up.py mri head.nrrd mri.nii.gz",
    "bids": "made_up.py bids ct.nrrd abdomen.seg.nrrd bids",
    "skull.stl": "made_up.py ball 7,9,8 240 skull.stl",
    "prostate.stl": "made_up.py ball 24,17,20 40 prostate.stl",
    "liver.msh": "made_up.py bar liver.msh",
    "tumour.mrk.json": """cat >tumour.mrk.json <<<'{"markups": [{"coordinateSystem": "LPS", "controlPoints":
                          [{"label": "tumour", "position": [-22, -10, 4]}]}]}'""",
    "hand.txt": "seq 0 2999 | awk '{print -14, -40 + 12 * sin($1 / 955), 2}' >hand.txt",
    "patients.tsv": r"printf '%s\t%s\t%s\n' patient case labels first liver.toml '' second liver.toml labels.seg.nrrd >patients.tsv",
    "pipelines": 'cp -r "$PALPATE_SOURCE/pipelines" .',
    "build/sample_data": 'mkdir build && cp -r "$PALPATE_SOURCE/build/sample_data" build',
    "our_lab.pem our_lab.pub.pem": "openssl genpkey -algorithm ed25519 -out our_lab.pem && openssl pkey -in our_lab.pem -pubout -out our_lab.pub.pem",
    "liver.vtkhdf liver.html liver.parts": "palpate build liver.toml --labels labels.seg.nrrd --sign our_lab.pem -o liver.vtkhdf",
    "nasopharynx.vtkhdf": "palpate build nasopharynx.toml --volume head_ct.nrrd -o nasopharynx.vtkhdf",
    "case.vtkhdf": "cp liver.vtkhdf case.vtkhdf",
    "stats.json force.svg": "palpate touch head.vtkhdf --seconds 2 --virtual-clock --json stats.json --curve force.svg",
    "probe.stl": "tools.py .",
    "run.h5": "palpate touch case.vtkhdf --seconds 3 --virtual-clock --record run.h5",
}

# A file -> what it names itself and cannot be without.
NAMED_IN = {"liver.toml": "totalseg.nii.gz", "patients.tsv": "liver.toml labels.seg.nrrd", "pipelines": "build/sample_data"}

# How lines begin that are not run as they stand, and how they are; of several the first.
HOW = {
    "palpate doctor case.vtkhdf": "{} || test $? = 4  # a machine that is not ready for a device",
    "palpate train case.vtkhdf --": "xvfb-run -a {}  # closes by itself",
}

# How lines begin that open a window, and what is done there (page_blocks.py); of several the first.
WINDOWS = {"palpate train case.vtkhdf --": "", "palpate train case.vtkhdf": "window", "palpate seeds": "clicks", "palpate init mri.nii.gz": "clicks"}
