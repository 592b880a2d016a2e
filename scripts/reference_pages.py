"""A hook of mkdocs: the API reference, one page per folder of the package, made from the docstrings while building."""

from __future__ import annotations

from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

PACKAGE = Path(__file__).resolve().parents[1] / "src" / "aeroservo"
TOP = "top"
LEFT_OUT = ("cli", "studio", "cases")


def pages() -> dict[str, list[str]]:
    """Modules on each page of the reference."""
    found: dict[str, list[str]] = {TOP: []}
    for path in sorted(PACKAGE.rglob("*.py")):
        inside = path.relative_to(PACKAGE)
        if inside.parts[0] in LEFT_OUT or path.stem.startswith("_") or path.stem.endswith("_kernels"):
            continue
        page = inside.parts[0] if len(inside.parts) > 1 else TOP
        found.setdefault(page, []).append(".".join(["aeroservo", *inside.with_suffix("").parts]))
    return found


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages."""
    for page, modules in pages().items():
        title = "aeroservo" if page == TOP else f"aeroservo.{page}"
        content = f"# {title}\n\n" + "\n\n".join(f"::: {module}" for module in modules) + "\n"
        files.append(File.generated(config, f"reference/{page}.md", content=content))
    return files


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Give them a place in the navigation."""
    config.nav = [*(config.nav or []), {"Reference": [f"reference/{page}.md" for page in pages()]}]
    return config
