"""Commands that re-run the thesis: `study thesis`, and `demo`, which is the same with a folder of its own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aeroservo.cli.options import Json, checked_output
from aeroservo.cli.output import complain, print_json, write

if TYPE_CHECKING:
    from aeroservo.studies.thesis_study import ThesisBook

STUDIES = ("thesis",)
Name = Annotated[str, typer.Argument(metavar="NAME", help="thesis: chapters 8 and 9, from the presets alone.")]
Where = Annotated[
    Path, typer.Option("-o", "--out", metavar="PATH", help="A folder for page and results, or a file ending in .html.")
]
Folder = Annotated[Path, typer.Option("--out", metavar="FOLDER", help="Where page and results go.")]
Figures = Annotated[bool, typer.Option("--figures", help="Write every figure as PNG and PDF as well.")]
Markdown = Annotated[
    Path | None, typer.Option("--markdown", metavar="FILE", help="Write the page of the documentation (.md) as well.")
]


def study(
    name: Name,
    *,
    out: Where = Path("thesis-study"),
    figures: Figures = False,
    markdown: Markdown = None,
    as_json: Json = False,
) -> None:
    """Re-run a study; print its tables and where its page lies.

    Parameters
    ----------
    name : str
        Which.
    out : Path
        Folder or page.
    figures : bool
        PNG and PDF as well.
    markdown : Path, optional
        Page of the documentation.
    as_json : bool
        As JSON, in place of the tables.

    Raises
    ------
    ValueError
        If there is no such study, or something cannot be written.
    """
    if name not in STUDIES:
        raise ValueError(f"no study named {name[:60]!r}; there is {', '.join(STUDIES)}")
    _rerun(out, figures=figures, markdown=markdown, as_json=as_json, option="-o")


def demo(*, out: Folder = Path("aeroservo-demo"), as_json: Json = False) -> None:
    """Re-run the thesis; print its tables and where its page lies.

    Parameters
    ----------
    out : Path
        Folder, made if it is not there.
    as_json : bool
        As JSON, in place of the tables.

    Raises
    ------
    ValueError
        If the folder cannot be used.
    """
    _rerun(out, figures=False, markdown=None, as_json=as_json, option="--out")


def _rerun(out: Path, *, figures: bool, markdown: Path | None, as_json: bool, option: str) -> None:
    """Check where everything goes, compute, write, print."""
    from aeroservo.report import thesis_folder
    from aeroservo.studies import thesis_study

    page_only = out.suffix.lower() in (".html", ".htm")
    if page_only and figures:
        raise ValueError(f"--figures needs a folder: {option} {out} is a page")
    checked_output(markdown, (".md",), "--markdown")
    if page_only:
        checked_output(out, (".html", ".htm"), option)
    elif thesis_folder.prepare_folder(out, option):
        complain(f"replacing the earlier study in {out}")
    book: ThesisBook = thesis_study.thesis_book(progress=complain)
    if page_only:
        write(out, thesis_folder.study_page(book).encode())
        page = out
    else:
        page = thesis_folder.write_study(book, out, figures=figures, progress=complain)
    if markdown is not None:
        thesis_folder.write_docs(book, markdown)
    if as_json:
        print_json(thesis_folder.book_json(book) | {"page": str(page.resolve())})
        return
    from rich.console import Console

    from aeroservo.report.thesis_text import print_tables

    print_tables(book, Console(highlight=False))
    typer.echo(f"\nEvery figure, table and claim is in one page; open\n{page.resolve()}")
