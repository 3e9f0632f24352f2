"""Executes the notebooks, and writes them as pages of the guide.

``python execute.py`` executes each notebook, and checks that its page in docs/python is what it gives today. ``python execute.py
--guide`` writes the pages. The package ``sextant`` must be installed.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
PAGES = REPOSITORY / "docs" / "python"
#: The time that a cell may take (s).
LONGEST_S = 300


def executed(path: Path) -> Any:
    """The notebook with its outputs. An exception in a cell is one here."""
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=LONGEST_S, resources={"metadata": {"path": str(REPOSITORY)}}).execute()
    return notebook


def joined(outputs: list[Any]) -> list[Any]:
    """The outputs, with what was printed in one piece: a kernel sends it in pieces of any size."""
    made: list[Any] = []
    for output in outputs:
        if made and output.get("name") == made[-1].get("name") == "stdout":
            made[-1] = {**made[-1], "text": made[-1]["text"] + output["text"]}
        elif output.get("name") != "stderr":
            made.append(output)
    return made


def page(name: str, notebook: Any) -> dict[str, str]:
    """The files of a page by their names: its Markdown, and its pictures."""
    lines: list[str] = []
    files: dict[str, str] = {}
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            lines += [cell.source, ""]
            continue
        lines += ["```python", cell.source, "```", ""]
        for output in joined(cell.outputs):
            data = output.get("data", {})
            text = output.get("text") or data.get("text/plain")
            if "image/svg+xml" in data:
                picture = f"{name}-{len(files) + 1}.svg"
                files[picture] = data["image/svg+xml"].rstrip() + "\n"
                lines += [f"![{data.get('text/plain', name)}]({picture})", ""]
            elif text and "image/png" not in data:
                # Pictures of matplotlib differ between its versions, and are seen when the notebook runs.
                lines += ["```text", text.rstrip(), "```", ""]
    lines.append(f"This page is the notebook [`{name}.ipynb`](../../python/notebooks/{name}.ipynb).")
    return {f"{name}.md": "\n".join(lines) + "\n", **files}


def main(words: list[str]) -> int:
    """Execute all notebooks. Returns the exit code."""
    writes = words == ["--guide"]
    if words and not writes:
        print("usage: python execute.py [--guide]", file=sys.stderr)
        return 2
    old: list[str] = []
    for path in sorted(HERE.glob("*.ipynb")):
        print(path.name, flush=True)
        for file, text in page(path.stem, executed(path)).items():
            target = PAGES / file
            if writes:
                PAGES.mkdir(exist_ok=True)
                target.write_text(text, encoding="utf-8")
            elif not target.exists() or target.read_text(encoding="utf-8") != text:
                old.append(str(target.relative_to(REPOSITORY)))
                seen = target.with_suffix(target.suffix + ".new")
                seen.write_text(text, encoding="utf-8")
    if old:
        print(f"these pages are old (see FILE.new); write them with --guide: {', '.join(old)}", file=sys.stderr)
    return 1 if old else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
