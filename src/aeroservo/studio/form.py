"""The form of a model file in the page: one widget for each value, errors beside the field that caused them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from nicegui import ui
from nicegui.element import Element

from aeroservo.aircraft.file_errors import dotted
from aeroservo.aircraft.schema import kinds
from aeroservo.studio.draft import Draft, Finding, Place, held, put, shown, typed
from aeroservo.studio.fields import Entry, Form, Group, form_of

#: Most rows of a list that the form shows, and most fields that one message about a whole table is put beside.
MOST_ROWS, MOST_MARKED = 60, 6


@dataclass(kw_only=True, eq=False)
class _Box:
    """A value on the page."""

    entry: Entry
    place: Element
    input: Any
    error: ui.label | None = None
    changed: ui.label | None = None

    def say(self, error: str, changed: str) -> None:
        """An error, and what the file has instead; labels are made when there is something to say."""
        self.input.props["error"] = bool(error)
        with self.place:
            if error and self.error is None:
                self.error = _message()
            if changed and self.changed is None:
                self.changed = ui.label().classes("ae-before")
        for label, text in ((self.error, error), (self.changed, changed)):
            if label is not None:
                _say(label, text)


class FormView:
    """The form of one draft; `changed` hears every edit with the new draft."""

    def __init__(self, container: Element, changed: Callable[[Draft], None]) -> None:
        self._container, self._tell = container, changed
        self._boxes: dict[Place, _Box] = {}
        self._banners: dict[Place, ui.label] = {}
        self._open: dict[str, bool] = {}
        self.draft: Draft = {}
        self._file: Draft = {}

    def show(self, kind: str, draft: Draft, file: Draft) -> None:
        """Build the form of a draft anew.

        Parameters
        ----------
        kind : str
            Kind of model.
        draft, file : dict
            What is edited, and what the file says.
        """
        self._kind, self.draft, self._file = kind, draft, file
        self._boxes, self._banners = {}, {}
        self._container.clear()
        with self._container:
            self._banners[()] = _message()
            self._table(form_of(kinds()[kind]), ())

    def mark(self, findings: tuple[Finding, ...]) -> None:
        """Put every finding beside the field that it is about, and take away the others.

        Parameters
        ----------
        findings : tuple of Finding
            What is wrong with the draft.
        """
        words: dict[Place, list[str]] = {}
        for finding in findings:
            for place in self._places(finding):
                words.setdefault(place, []).append(finding.message)
        for place, box in self._boxes.items():
            said = "; ".join(words.get(place, ()))
            value = held(self._file, place)
            now = held(self.draft, place)
            old = (
                ""
                if now == value
                else "file: " + (shown(box.entry.kind, value).replace("\n", "; ")[:60] or "not given")
            )
            box.say(said, old)
        for place, banner in self._banners.items():
            _say(banner, "; ".join(words.get(place, ())))

    def _places(self, finding: Finding) -> list[Place]:
        """Where to show a finding: its field, the fields of its table that it names, or the table."""
        place = finding.place
        if place in self._boxes:
            return [place]
        at = place
        while at and at not in self._boxes and at not in self._banners:
            at = at[:-1]
        if at in self._boxes:
            return [at]
        named = [p for p in self._boxes if p[: len(at)] == at and _names(finding.message, str(p[-1]))]
        return named if 0 < len(named) <= MOST_MARKED else [at if at in self._banners else ()]

    def _table(self, form: Form, place: Place) -> None:
        with ui.element("div").classes("ae-fields"):
            for entry in form.entries:
                self._field(entry, (*place, entry.name))
        for group in form.groups:
            self._group(group, (*place, group.name))

    def _group(self, group: Group, place: Place) -> None:
        value = held(self.draft, place)
        if value is None and not group.required:
            with ui.row().classes("ae-absent"):
                start: Any = [_blank(group.table)] if group.rows else {}
                add = ui.button(f"add [{dotted(place)}]", icon="add", on_click=lambda: self._rebuilt(place, start))
                add.props("flat dense no-caps size=sm").classes("ae-key")
                ui.label(group.text).classes("ae-hint")
            return
        with ui.element("section").classes("ae-group"):
            with ui.row().classes("ae-title"):
                ui.label(f"[{dotted(place)}]").classes("ae-key ae-name")
                ui.label(group.text).classes("ae-hint")
                if not group.required:
                    drop = ui.button(icon="delete", on_click=lambda: self._rebuilt(place, None))
                    drop.props(f'flat dense round size=sm aria-label="remove {dotted(place)}"')
            self._banners[place] = _message()
            if not group.rows:
                self._table(group.table, place)
            elif group.table.flat:
                self._grid(group, place, value if isinstance(value, list) else [])
            else:
                self._cards(group, place, value if isinstance(value, list) else [])

    def _grid(self, group: Group, place: Place, rows: list[Any]) -> None:
        """Rows of a list of tables, one line for each."""
        entries = group.table.entries
        with ui.element("div").classes("ae-scroll"), ui.element("table").classes("ae-grid"):
            with ui.element("thead"), ui.element("tr"):
                with ui.element("th"):
                    ui.label("#")
                for entry in entries:
                    with ui.element("th"):
                        ui.label(entry.name).classes("ae-key")
                        ui.label(entry.unit).classes("ae-hint")
                        ui.tooltip(_meaning(entry))
                        if entry.kind == "number" and len(rows) > 1:
                            self._scaling(entry, place, len(rows))
            with ui.element("tbody"):
                for i in range(min(len(rows), MOST_ROWS)):
                    self._row(entries, (*place, i))
        self._more(group, place, rows)

    def _row(self, entries: tuple[Entry, ...], place: Place) -> None:
        with ui.element("tr"):
            with ui.element("td").classes("ae-index"):
                ui.label(str(place[-1]))
                drop = ui.button(icon="close", on_click=lambda: self._rebuilt(place, None))
                drop.props(f'flat dense round size=xs aria-label="remove {dotted(place)}"')
            for entry in entries:
                with ui.element("td"):
                    self._widget(entry, (*place, entry.name), narrow=True)
        with ui.element("tr"), ui.element("td").props(f"colspan={len(entries) + 1}"):
            self._banners[place] = _message()

    def _cards(self, group: Group, place: Place, rows: list[Any]) -> None:
        """Rows of a list of tables that hold more tables, one card for each."""
        for i in range(min(len(rows), MOST_ROWS)):
            here = (*place, i)
            with ui.element("section").classes("ae-group"):
                with ui.row().classes("ae-title"):
                    ui.label(f"[{dotted(here)}]").classes("ae-key ae-name")
                    drop = ui.button(icon="delete", on_click=lambda here=here: self._rebuilt(here, None))
                    drop.props(f'flat dense round size=sm aria-label="remove {dotted(here)}"')
                self._banners[here] = _message()
                self._table(group.table, here)
        self._more(group, place, rows)

    def _more(self, group: Group, place: Place, rows: list[Any]) -> None:
        if len(rows) > MOST_ROWS:
            ui.label(f"{len(rows) - MOST_ROWS} more rows: edit them in the file").classes("ae-hint")
            return
        last = rows[-1] if rows and isinstance(rows[-1], dict) else _blank(group.table)
        add = ui.button(
            "row like the last", icon="add", on_click=lambda: self._rebuilt((*place, len(rows)), dict(last))
        )
        add.props(f'flat dense no-caps size=sm aria-label="add a row to {dotted(place)}"')

    def _scaling(self, entry: Entry, place: Place, rows: int) -> None:
        """A button that multiplies a column."""
        button = ui.button(icon="percent").props(
            f'flat dense round size=xs aria-label="scale {dotted(place)} {entry.name}"'
        )
        with button, ui.menu().props("no-parent-event") as menu, ui.column().classes("ae-menu"):
            ui.label(f"Multiply {entry.name} of all {rows} rows by")
            factor = ui.input(value="1.1").props('dense outlined aria-label="factor"')

            def apply() -> None:
                by = typed("number", factor.value or "")
                if not isinstance(by, float):
                    factor.props["error"] = True
                    return
                menu.close()
                draft = self.draft
                for i in range(rows):
                    old = held(draft, (*place, i, entry.name))
                    if isinstance(old, int | float) and not isinstance(old, bool):
                        draft = put(draft, (*place, i, entry.name), float(f"{old * by:.12g}"))
                self._new(draft, rebuild=False)
                for i in range(rows):
                    here = (*place, i, entry.name)
                    if here in self._boxes:
                        self._boxes[here].input.value = shown(entry.kind, held(draft, here))

            ui.button("Multiply", on_click=apply).props("dense no-caps")
        button.on("click", menu.open)

    def _field(self, entry: Entry, place: Place) -> None:
        with ui.element("div").classes("ae-field"):
            with ui.element("div").classes("ae-text"):
                ui.label(entry.text).classes("ae-meaning")
                ui.label(entry.name).classes("ae-key")
            self._widget(entry, place, narrow=False)

    def _widget(self, entry: Entry, place: Place, *, narrow: bool) -> None:
        """The input of a value with its error and the file's value."""
        value = held(self.draft, place)
        with ui.element("div").classes("ae-value") as around:
            field: Any
            if entry.kind == "choice":
                options = list(entry.choices)
                field = ui.select(options, value=value if value in options else entry.default)
            elif entry.kind == "flag":
                field = ui.switch(value=bool(entry.default if value is None else value))
            elif entry.kind in ("strings", "matrix"):
                field = ui.textarea(value=shown(entry.kind, value)).props("autogrow")
            else:
                field = ui.input(value=shown(entry.kind, value))
            if entry.kind not in ("choice", "flag"):
                field.props("debounce=120")
                default = shown(entry.kind, entry.default)
                field.props["placeholder"] = default[:12]
                if entry.unit and not narrow:
                    field.props["suffix"] = entry.unit
            field.props("dense outlined hide-bottom-space no-error-icon")
            field.props["aria-label"] = f"{dotted(place)}: {entry.text}"
            field.props["data-field"] = dotted(place)
            if not narrow:
                with field:
                    ui.tooltip(_meaning(entry)).props("delay=600")
        self._boxes[place] = _Box(entry=entry, place=around, input=field)
        field.on_value_change(lambda event: self._edited(entry, place, event.value))

    def _edited(self, entry: Entry, place: Place, value: Any) -> None:
        if entry.kind not in ("choice", "flag"):
            value = typed(entry.kind, value or "")
        if held(self.draft, place) == value and type(held(self.draft, place)) is type(value):
            return
        self._new(put(self.draft, place, value), rebuild=False)

    def _rebuilt(self, place: Place, value: Any) -> None:
        """A change that adds or takes away fields."""
        self._new(put(self.draft, place, value), rebuild=True)

    def _new(self, draft: Draft, *, rebuild: bool) -> None:
        self.draft = draft
        if rebuild:
            self.show(self._kind, draft, self._file)
        self._tell(draft)


def _blank(form: Form) -> dict[str, Any]:
    """A row with nothing in it but what must be chosen."""
    return {entry.name: entry.choices[0] for entry in form.entries if entry.kind == "choice" and entry.required}


def _names(message: str, key: str) -> bool:
    """Whether a message names a field."""
    return len(key) > 2 and re.search(rf"(?<![A-Za-z0-9_]){re.escape(key)}(?![A-Za-z0-9_])", message) is not None


def _meaning(entry: Entry) -> str:
    """What a field means, with unit and range."""
    parts = [entry.text + (f" [{entry.unit}]" if entry.unit else ""), entry.allowed]
    if not entry.required:
        parts.append(f"default {shown(entry.kind, entry.default)}" if entry.default not in (None, "") else "optional")
    return "; ".join(part for part in parts if part)


def _message() -> ui.label:
    label = ui.label().classes("ae-error").props("role=alert")
    label.visible = False
    return label


def _say(label: ui.label, text: str) -> None:
    if label.text != text:
        label.text = text
    label.visible = bool(text)
