"""The results in the page: speeds with their change, curves, modes, derived numbers."""

from __future__ import annotations

from typing import Any

from nicegui import ui
from nicegui.element import Element

from aeroservo.studio.analysis import Analysis, Speed
from aeroservo.studio.charts import damping_chart, frequency_chart
from aeroservo.studio.wing import WingView


class SpeedCards:
    """Flutter, divergence and reversal, large, with their change against the file's."""

    def __init__(self) -> None:
        with ui.element("div").classes("ae-cards").props("aria-live=polite"):
            self._cards = [self._card(name) for name in ("flutter", "divergence", "reversal")]

    def show(self, now: Analysis | None, before: Analysis | None, *, stale: bool) -> None:
        """Show speeds.

        Parameters
        ----------
        now, before : Analysis or None
            Of the draft and of the file.
        stale : bool
            Whether the draft has changed since.
        """
        speeds: tuple[Speed, ...] = () if now is None else now.speeds
        for i, (card, label, number, remark, delta) in enumerate(self._cards):
            card.visible = now is None or i < len(speeds)
            if i >= len(speeds):
                number.text = "…" if now is None else ""
                continue
            speed = speeds[i]
            old = before.speeds[i] if before is not None and i < len(before.speeds) else None
            label.text = speed.name
            number.text = "none" if speed.value is None else f"{speed.value:#.5g} {speed.unit}"
            remark.text, delta.text = speed.remark, _change(speed, old)
            card.classes(add="ae-stale" if stale else "", remove="" if stale else "ae-stale")

    @staticmethod
    def _card(name: str) -> tuple[Element, ui.label, ui.label, ui.label, ui.label]:
        card = ui.element("div").classes("ae-card").props(f"data-speed={name}")
        with card:
            label = ui.label(name.capitalize()).classes("ae-label")
            number = ui.label("…").classes("ae-number")
            delta = ui.label().classes("ae-delta")
            remark = ui.label().classes("ae-remark")
        return card, label, number, remark, delta


class ResultView:
    """Charts, modes and derived numbers."""

    def __init__(self) -> None:
        self.dark = False
        self._shown: tuple[Any, ...] = ()
        self.heading = ui.label().classes("ae-hint")
        with ui.element("div").classes("ae-charts"):
            self._frequency = ui.echart({}).classes("ae-chart")
            self._damping = ui.echart({}).classes("ae-chart")
        self._hint = ui.label(
            "Grey dashes: the file. Flutter begins where a damping ratio falls below zero. Ctrl and wheel zoom."
        ).classes("ae-hint")
        self._notes = ui.element("div")
        self._wing = WingView("wing-modes")
        self._modes = ui.element("div").classes("ae-tables")

    def show(self, now: Analysis | None, before: Analysis | None) -> None:
        """Show an analysis beside the file's.

        Parameters
        ----------
        now, before : Analysis or None
            Of the draft and of the file.
        """
        key = (now, before, self.dark)
        if now is None or (self._shown and all(a is b for a, b in zip(key, self._shown))):
            return
        old = before if before is not now else None
        self._shown = key
        self.heading.text = now.heading
        for chart, make in ((self._frequency, frequency_chart), (self._damping, damping_chart)):
            chart.visible = now.curves is not None
            if now.curves is not None:
                chart.options.clear()
                chart.options.update(make(now, old, dark=self.dark))
                chart.update()
        self._hint.visible = now.curves is not None
        notes(self._notes, now.notes)
        self._modes.clear()
        with self._modes:
            _tables(now, old)
        self._wing.show(now.scene)


def notes(place: Element, lines: tuple[str, ...]) -> None:
    """What to know before trusting the numbers; what a file merely assumes is folded away.

    Parameters
    ----------
    place : Element
        Where; what is there goes.
    lines : tuple of str
        One sentence each.
    """
    place.clear()
    folded = tuple(line for line in lines if line.startswith(("assumed: ", "elastic wing: ")))
    with place:
        _list(tuple(line for line in lines if line not in folded))
        if folded:
            with ui.expansion(f"What the file assumes ({len(folded)})").props("dense").classes("ae-folded"):
                _list(folded)


def _list(lines: tuple[str, ...]) -> None:
    if lines:
        with ui.element("ul").classes("ae-notes"):
            for line in lines:
                with ui.element("li"):
                    ui.label(line)


def _change(speed: Speed, old: Speed | None) -> str:
    """The change against the file's value, in words."""
    if old is None or old.value == speed.value:
        return ""
    if old.value is None or speed.value is None:
        return f"file: {'none' if old.value is None else f'{old.value:#.5g} {old.unit}'}"
    difference = speed.value - old.value
    return f"file: {old.value:#.5g} ({difference:+.4g}, {100.0 * difference / old.value:+.2f} %)"


def _tables(now: Analysis, before: Analysis | None) -> None:
    """Modes without air, and what follows from the file by arithmetic."""
    if now.modes:
        file = {name: hertz for name, hertz, _ in before.modes} if before is not None else {}
        rows = [(n, f"{f:.5g}", f"{file[n]:.5g}" if n in file else "", f"{z:.3g}") for n, f, z in now.modes]
        _table("Modes without air", ("mode", "frequency, Hz", "file, Hz", "damping ratio"), rows, drop=not file and 2)
    if now.derived:
        file = dict(before.derived) if before is not None else {}
        numbers = [
            (k.replace("_", " "), f"{v + 0.0:.6g}", f"{file[k] + 0.0:.6g}" if k in file else "") for k, v in now.derived
        ]
        _table(
            "Derived numbers (unit at the end of the name, SI)",
            ("quantity", "value", "file"),
            numbers,
            drop=not file and 2,
        )


def _table(title: str, columns: tuple[str, ...], rows: list[Any], *, drop: int | bool) -> None:
    kept = [j for j in range(len(columns)) if not drop or j != drop]
    with ui.element("div").classes("ae-scroll"):
        ui.label(title).classes("ae-name")
        with ui.element("table").classes("ae-table"):
            with ui.element("thead"), ui.element("tr"):
                for j in kept:
                    with ui.element("th"):
                        ui.label(columns[j])
            with ui.element("tbody"):
                for row in rows:
                    with ui.element("tr"):
                        for j in kept:
                            with ui.element("td"):
                                ui.label(row[j])
