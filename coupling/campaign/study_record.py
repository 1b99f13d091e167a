"""What ``study.json`` says: made of the summaries and results of a study's runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.campaign.bernoulli_errors import with_errors
from coupling.campaign.error_sources import UNKNOWN, coarsening_of
from coupling.campaign.record_study import record_study
from coupling.campaign.study_plan import AS_RUN, STRETCH, THESIS, Entry
from coupling.campaign.theory_checks import check_rows
from coupling.fluids import FLUIDS, by_rank
from coupling.metrics.advice import advice, verdict
from coupling.metrics.comparison import Errors, compare
from coupling.metrics.pareto import pareto_front
from coupling.metrics.record import follows_record
from coupling.metrics.record_verdict import by_range
from coupling.metrics.uncertainty import below, error_bars, observed_orders, shares
from coupling.store.results import open_results, read_results
from coupling.store.step_series import StepSeries

Summary = Mapping[str, Any]
FIGURES_WITH_FRONT = ("shape_rms", "cg_amplitude", "force_amplitude", "pressure_rms")


class StudyRecord:
    """The runs of a study so far; ``folder`` is the study's, ``models`` those of the ladder."""

    def __init__(self, folder: Path, models: Sequence[str]) -> None:
        self.folder = folder
        self.models = by_rank(models)
        self._done: list[tuple[Entry, Summary]] = []
        self._failed: dict[str, Summary] = {}
        self._errors: dict[tuple[Path, str], Errors] = {}

    def add(self, entry: Entry, summary: Summary) -> None:
        """Record a run that has ended, whether it completed or failed."""
        self._done.append((entry, summary))

    def add_impossible(self, row: str, reason: str) -> None:
        """Record a row as failed for which no scene can be made, with the ``reason``."""
        self._failed[row] = {"status": "failed", "error": reason}

    @property
    def reference(self) -> str | None:
        """The highest rung that has not failed, done or still to come."""
        alive = [m for m in self.models if self._status(m) in (None, "completed")]
        return alive[-1] if alive else None

    def completed(self) -> list[Entry]:
        """The rows that have ended well as run, the stretching one left out."""
        return [
            entry
            for entry, summary in self._done
            if entry.resolution == AS_RUN
            and entry.row not in STRETCH.values()
            and summary.get("status") == "completed"
        ]

    def to_dict(self) -> dict[str, Any]:
        """Return what ``study.json`` holds."""
        best = self.reference
        own = {
            entry.resolution: self._error(entry, summary, best)
            for entry, summary in self._of_reference(best)
        }
        bars = error_bars(own, self._coarsening(best))
        rows = {entry.row: self._row(entry, summary, bars) for entry, summary in self._as_run()}
        rows |= {row: _no_row(summary) for row, summary in self._failed.items()}
        record = self._record(best)
        said = str if record is None else by_range
        return {
            "reference": best,
            "models": rows,
            "discretisation": own,
            "uncertainty": bars,
            "sources": self._sources(best, own),
            "observed_order": observed_orders(own, self._coarsening(best)),
            "bernoulli": self._bernoulli(best),
            "checks": check_rows(self._done, self._completed()),
            "points": self._points(),
            "record": record,
            "verdict": said(verdict(best, rows, bars)),
            "advice": said(advice(best, rows, bars)),
        }

    def _completed(self) -> dict[str, Summary]:
        """Summaries of the rows that have ended well as run."""
        return {
            e.row: summary for e, summary in self._as_run() if summary.get("status") == "completed"
        }

    def _as_run(self) -> list[tuple[Entry, Summary]]:
        return [(entry, summary) for entry, summary in self._done if entry.resolution == AS_RUN]

    def _of_reference(self, best: str | None) -> list[tuple[Entry, Summary]]:
        """The runs of the reference ``best`` with a numerical source of error enlarged."""
        return [
            (entry, summary)
            for entry, summary in self._done
            if entry.row == best and entry.resolution not in (AS_RUN, *UNKNOWN)
        ]

    def _sources(self, best: str | None, own: Mapping[str, Errors]) -> list[dict[str, Any]]:
        """What each source is worth in every figure, the largest in the CG's amplitude first.

        Numerical ones are the reference's estimated errors; of what the diaphragm is not known by
        it is the whole change, on the row that was run with it.
        """
        found: list[dict[str, Any]] = [
            {"source": name, "kind": "numerical", "row": best, "share": share}
            for name, share in shares(own, self._coarsening(best)).items()
        ]
        for entry, summary in self._done:
            if entry.resolution in UNKNOWN:
                share = self._error(entry, summary, entry.row)
                name = entry.resolution
            elif entry.row in STRETCH.values() and entry.resolution == AS_RUN:
                share = self._error(entry, summary, entry.scene.model.fluid)
                name = entry.row
            else:
                continue
            row = entry.scene.model.fluid
            found.append({"source": name, "kind": "unknown", "row": row, "share": share})
        return sorted(found, key=lambda one: -(one["share"].get("cg_amplitude") or 0.0))

    def _found(self, row: str | None) -> tuple[Entry, Summary] | None:
        return next((item for item in self._as_run() if item[0].row == row), None)

    def _status(self, row: str) -> str | None:
        found = self._found(row)
        return None if found is None else str(found[1].get("status"))

    def _coarsening(self, best: str | None) -> dict[str, tuple[float, float]]:
        found = self._found(best)
        return {} if found is None else coarsening_of(found[0].scene)

    def _bernoulli(self, best: str | None) -> dict[str, dict[str, float | None]]:
        """The reference's ratios, each with its own estimated error."""
        found = self._found(best)
        coarser = {entry.resolution: summary for entry, summary in self._of_reference(best)}
        return with_errors(found[1] if found else {}, coarser, self._coarsening(best))

    def _record(self, best: str | None) -> dict[str, Any] | None:
        """What a study by a record says by bands of frequency; None for any other."""
        found = self._found(best)
        if found is None or found[1].get("status") != "completed":
            return None
        if not follows_record(found[0].scene):
            return None
        models = {entry.row: (self._steps(entry), summary) for entry, summary in self._whole()}
        own = {
            entry.resolution: self._steps(entry)
            for entry, summary in self._of_reference(best)
            if summary.get("status") == "completed"
        }
        return record_study(found[0].scene, found[0].row, models, own, self._coarsening(best))

    def _whole(self) -> list[tuple[Entry, Summary]]:
        """The rows as run that have ended well."""
        return [one for one in self._as_run() if one[1].get("status") == "completed"]

    def _steps(self, entry: Entry) -> StepSeries:
        return open_results(self.folder / entry.place).steps

    def _row(self, entry: Entry, summary: Summary, bars: Errors) -> dict[str, Any]:
        best = self.reference
        errors = self._error(entry, summary, best)
        reference = self._found(best)
        row = {
            "status": summary.get("status"),
            "failure": summary.get("error"),
            "model": entry.scene.model.fluid,
            "wall_s": summary.get("wall_s"),
            "cpu_s": summary.get("cpu_s"),
            "error": errors,
            "speedup": _speedup(reference and reference[1], summary),
            "below_reference_error": [] if entry.row == best else below(errors, bars),
            "bernoulli": summary.get("bernoulli"),
            "drift": (summary.get("cg") or {}).get("drift"),
            "transient": (summary.get("cg") or {}).get("transient"),
        }
        if entry.row in STRETCH.values():
            row["against_same_model"] = self._error(entry, summary, entry.scene.model.fluid)
        return row

    def _points(self) -> list[dict[str, Any]]:
        """Speed against error of every run that is on the ladder, and of the thesis' algorithm."""
        points: list[dict[str, Any]] = [
            {
                "model": entry.row,
                "resolution": entry.resolution,
                "status": summary.get("status"),
                "failure": summary.get("error"),
                "wall_s": summary.get("wall_s"),
                "cpu_s": summary.get("cpu_s"),
                "error": self._error(entry, summary, self.reference),
                "on_front": [],
            }
            for entry, summary in self._done
            if entry.row in (*FLUIDS, THESIS) and entry.resolution not in UNKNOWN
        ]
        for figure in FIGURES_WITH_FRONT:
            known = [p for p in points if p["wall_s"] and p["error"].get(figure) is not None]
            for index in pareto_front([(p["wall_s"], p["error"][figure]) for p in known]):
                known[index]["on_front"].append(figure)
        return points

    def _error(self, entry: Entry, summary: Summary, against: str | None) -> Errors:
        """Errors against the row ``against``; empty where either is not complete."""
        found = self._found(against)
        if found is None or {found[1].get("status"), summary.get("status")} != {"completed"}:
            return {}
        key = (entry.place, found[0].row)
        if key not in self._errors:
            self._errors[key] = compare(
                read_results(self.folder / entry.place),
                summary,
                read_results(self.folder / found[0].place),
                found[1],
                entry.scene.tank.shell.size,
            )
        return self._errors[key]


def _no_row(summary: Summary) -> dict[str, Any]:
    return {
        "status": summary["status"],
        "failure": summary["error"],
        "wall_s": None,
        "cpu_s": None,
        "error": {},
        "speedup": None,
        "below_reference_error": [],
        "bernoulli": None,
    }


def _speedup(best: Summary | None, summary: Summary) -> float | None:
    if not best or summary.get("status") != "completed" or not summary.get("wall_s"):
        return None
    return float(best["wall_s"]) / float(summary["wall_s"]) if best.get("wall_s") else None
