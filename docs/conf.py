"""The site that scripts/docs.sh builds: Sphinx with MyST. The pages stay Markdown that reads well without it."""
import json
import os
import pathlib
import re

from myst_parser.parsers.sphinx_ import MystParser

DOCS = pathlib.Path(__file__).resolve().parent
ROOT = DOCS.parent

project = "patchlight"
author = "the patchlight authors"
copyright = author  # noqa: A001
release = re.search(r"project\(patchlight VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
extensions = ["myst_parser", "sphinxcontrib.bibtex"]
bibtex_bibfiles = ["theory/bibliography.bib"]
bibtex_default_style = "alpha"
exclude_patterns = ["_build"]
source_suffix = {".md": "markdown", ".ipynb": "notebook"}
myst_enable_extensions = ["dollarmath", "html_image"]
myst_heading_anchors = 4
# A heading may follow one two levels above it, blocks may hold lines that no lexer knows, and old books have no publisher.
suppress_warnings = ["myst.header", "misc.highlighting_failure", "bibtex.missing_field"]
# Debian's MathJax, so that the pages need no network; for a site on the web: sphinx-build -D mathjax_path=ADDRESS.
mathjax_path = "file:///usr/share/javascript/mathjax/MathJax.js?config=TeX-AMS-MML_HTMLorMML"
mathjax2_config = {"tex2jax": {"processClass": "math", "inlineMath": [["\\(", "\\)"]], "displayMath": [["\\[", "\\]"]]}}
myst_update_mathjax = False
html_theme = "furo"
# Debian's furo follows the dark setting of the browser in code blocks alone, and expects normalize.css on the web server.
html_theme_options = {"dark_css_variables": {
    "color-problematic": "#ee5151",
    "color-foreground-primary": "#ffffffcc", "color-foreground-secondary": "#9ca0a5", "color-foreground-muted": "#81868d",
    "color-foreground-border": "#666666", "color-background-primary": "#131416", "color-background-secondary": "#1a1c1e",
    "color-background-hover": "#1e2124ff", "color-background-hover--transparent": "#1e212400", "color-background-border": "#303335",
    "color-background-item": "#444", "color-brand-primary": "#2b8cee", "color-brand-content": "#368ce2",
    "color-highlighted-background": "#083563", "color-highlight-on-target": "#333300"}}
NORMALIZE = pathlib.Path("/usr/share/javascript/normalize.css")
html_static_path = [str(NORMALIZE)] if NORMALIZE.exists() else []
html_title = f"patchlight {release}"
html_show_copyright = False

# The menu: a folder or page each, in this order.
MENU = ["getting-started", "tutorials", "how-to", "concepts", "gallery", "reference", "reference/cli", "reference/formats", "reference/outputs",
        "troubleshooting", "theory", "benchmarks", "developer", "CONTRIBUTING", "SECURITY"]


def titled(name):
    return {"cli": "Command line", "how-to": "How-to guides"}.get(name, name.replace("-", " ").capitalize())


def menu():
    """Hidden tables of contents for the page on top."""
    parts, single = [], []
    for entry in MENU:
        if (DOCS / entry).is_dir():
            pages = sorted(page.stem for page in (DOCS / entry).iterdir() if page.suffix in source_suffix and page.stem != "index")
            index = ["index"] if (DOCS / entry / "index.md").exists() else []
            lines = "\n".join(f"{entry}/{page}" for page in index + pages)
            parts.append(f"```{{toctree}}\n:hidden:\n:caption: {titled(entry.rpartition('/')[2])}\n\n{lines}\n```\n")
        elif (DOCS / f"{entry}.md").exists():
            single.append(entry)
    return "\n".join(parts + ["```{toctree}\n:hidden:\n:caption: More\n\n" + "\n".join(single) + "\n```\n"])


def edit_source(app, name, source):
    """Adds the menu, and turns links to files outside of docs/ into plain text."""
    folder = (DOCS / name).parent

    def plain(match):
        target = match[2].partition("#")[0]
        outside = target and not re.match(r"[a-z]+:", target) and DOCS not in pathlib.Path(os.path.normpath(folder / target)).parents
        return match[1] if outside else match[0]

    source[0] = re.sub(r"(?<!!)\[([^\]\n]*)\]\(([^)\s]+)\)", plain, source[0])
    if name == "index" and "{toctree}" not in source[0]:
        source[0] += "\n\n" + menu()


class NotebookParser(MystParser):
    """Notebooks as Markdown, with their stored outputs."""

    supported = ("notebook",)

    def parse(self, inputstring, document):
        super().parse("\n\n".join(map(cell_text, json.loads(inputstring)["cells"])), document)


def cell_text(cell):
    source = "".join(cell["source"])
    if cell["cell_type"] != "code":
        return source
    parts = [f"```python\n{source}\n```"]
    for output in cell["outputs"]:
        data = output.get("data", {})
        if "image/png" in data:
            parts.append(f'<img alt="output of the cell above" src="data:image/png;base64,{"".join(data["image/png"]).strip()}">')
        else:
            text = "".join(output.get("text", data.get("text/plain", [])))
            parts.append(f"```text\n{text.rstrip()}\n```")
    return "\n\n".join(parts)


def setup(app):
    app.add_source_parser(NotebookParser)
    app.connect("source-read", edit_source)
    if NORMALIZE.exists():
        app.add_css_file("normalize.css", priority=100)  # before that of the theme
