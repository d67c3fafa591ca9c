# SPDX-License-Identifier: GPL-3.0-or-later
"""A page as a browser has it."""
import html
import json
import re
import shutil
import subprocess
import tempfile

CHROMIUM = shutil.which("chromium")
QUIET = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--no-first-run")

# What stands in the page by <img> or by an <image> of a drawing: its width in pixels; 0: it is not there.
JUDGE = """<script>
addEventListener("load", async () => {
  const sources = [...document.querySelectorAll("img")].map(i => i.src)
    .concat([...document.querySelectorAll("svg image")].map(i => i.href.baseVal));
  const widths = await Promise.all(sources.map(async source => {
    const picture = new Image();
    await new Promise(done => { picture.onload = picture.onerror = done; picture.src = source; });
    return picture.naturalWidth;
  }));
  document.body.setAttribute("data-widths", JSON.stringify(widths));
});
</script>"""


def look_at(page):
    """The widths of the page's pictures in pixels, 0 where one is not there, and what the browser's console says of errors.

    The page is looked at where it lies, in a copy with a script of ours at its end, so that its own references count."""
    copy = page.with_name("looked_at_" + page.name)
    copy.write_text(page.read_text(encoding="utf-8") + JUDGE, encoding="utf-8")
    with tempfile.TemporaryDirectory() as profile:
        run = subprocess.run([CHROMIUM, *QUIET, f"--user-data-dir={profile}", "--enable-logging=stderr", "--v=0",
                              "--virtual-time-budget=20000", "--dump-dom", copy.absolute().as_uri()],
                             capture_output=True, text=True, timeout=120, check=True)
    copy.unlink()
    widths = re.search(r'<body[^>]* data-widths="([^"]*)"', run.stdout)
    if not widths:
        raise AssertionError("the page did not load: " + run.stderr)
    console = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
    return json.loads(html.unescape(widths[1])), console
