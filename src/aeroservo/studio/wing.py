"""The wing in three dimensions: the report's own view, fed by the studio."""

from __future__ import annotations

from pathlib import Path

from nicegui import app, ui

from aeroservo import report

#: Where the scripts are served.
ADDRESS = "/aeroservo-assets"
_SCRIPTS = ("three.min.js", "wing3d.js")


def serve_scripts() -> None:
    """Serve three.js and the view from the package."""
    folder = Path(report.__path__[0]) / "assets"
    for name in _SCRIPTS:
        app.add_static_file(local_file=folder / name, url_path=f"{ADDRESS}/{name}", max_cache_age=3600)


def load_scripts() -> None:
    """Let the page load them."""
    ui.add_head_html("".join(f'<script defer src="{ADDRESS}/{name}"></script>' for name in _SCRIPTS))


class WingView:
    """One view; `show` replaces what is drawn."""

    def __init__(self, name: str) -> None:
        self._box = ui.element("div").classes("ae-wing").props(f"data-wing={name}")
        self._box.visible = False
        self._scene = ""

    def show(self, scene: str, *, play: bool = False) -> None:
        """Draw a scene.

        Parameters
        ----------
        scene : str
            JSON of `report.scene.scene_data`; "" hides the view.
        play : bool
            Begin to play.
        """
        if scene == self._scene:
            return
        self._scene = scene
        self._box.visible = bool(scene)
        if scene:
            self._box.client.run_javascript(_DRAW % (self._box.id, scene, "true" if play else "false"))


_DRAW = """(() => {
  const box = getHtmlElement(%d), data = %s, play = %s;
  const draw = () => {
    if (!box || !box.isConnected) return;
    if (!window.createWing || !window.THREE) { setTimeout(draw, 100); return; }
    const camera = box.aeroWing ? box.querySelector("select[aria-label=Camera]").selectedIndex : 0;
    box.aeroWing?.dispose();
    box.aeroWing = createWing(box, data);
    const choice = box.querySelector("select[aria-label=Camera]");
    if (camera > 0) { choice.selectedIndex = camera; choice.dispatchEvent(new Event("change")); }
    if (play) box.aeroWing.play();
  };
  draw();
})()"""
