"""The report of one run."""

from __future__ import annotations

import hashlib
import platform
from datetime import UTC, datetime
from typing import Any

import h5py
import numpy as np

from coupling.metrics.response import weight_of
from coupling.report.bernoulli_tables import bernoulli_table, impulse_sentence, split_table
from coupling.report.carrier_section import carrier_section
from coupling.report.energy_section import energy_section
from coupling.report.expulsion_section import expulsion_section
from coupling.report.figures import (
    coupling_figure,
    mesh_figure,
    motion_figure,
    node_pressure_figure,
    pressure_figure,
    strain_figure,
    volume_figure,
)
from coupling.report.files import RunFiles
from coupling.report.fold_section import fold_section
from coupling.report.instants import sections, shown_instants, views
from coupling.report.page import Page, Picture, Section, number
from coupling.report.record_section import record_sections
from coupling.report.rub_section import rub_section
from coupling.report.run_tables import (
    cost_table,
    motion_table,
    quality_table,
    rubber_table,
    transfer_table,
)
from coupling.report.scene_tables import scene_tables
from coupling.report.terms import TERMS
from coupling.report.verdict import bernoulli_keys, verdict
from coupling.report.viewer import run_viewer


def run_page(run: RunFiles) -> Page:
    """Everything there is to say of a run."""
    headline, explanation = verdict(run)
    summary = run.summary
    alarm = ""
    if summary["status"] != "completed":
        reached = f"{number(summary['simulated_s'], 's')} of {number(run.scene.time.duration, 's')}"
        alarm = f"Not completed ({summary['status']}): {reached}. {summary['error'] or ''}"
    return Page(
        title=run.scene.title or run.folder.resolve().name,
        subtitle=f"{run.model} · {_extent(summary)} · diaphragm tank, fluid and diaphragm coupled",
        verdict=headline,
        explanation=explanation,
        alarm=alarm,
        figures=bernoulli_keys(run),
        sections=_sections(run),
        footer=provenance(run),
    )


def _extent(summary: dict[str, Any]) -> str:
    """How much was simulated, in which time."""
    wall = number(summary["wall_s"], "s")
    if not summary["steps"]:
        return f"no step was completed in {wall}"
    return f"{number(summary['simulated_s'], 's')} simulated in {wall}"


def _sections(run: RunFiles) -> list[Section]:
    sections = [_shape(run)] if len(run.results.time) else []
    drawn = expulsion_section(run)
    sections += [drawn] if drawn else []
    if drawn:
        energy = energy_section(run)
        sections += [energy] if energy else []
    elif len(run.results.time) > 1:
        energy = energy_section(run)
        by_record = run.summary.get("record") is not None
        moved = record_sections(run) if by_record else [_motion(run)]
        extra = [section for section in (carrier_section(run), energy) if section]
        sections += [pressure_section(run), *moved, *extra]
    else:
        sections.append(
            Section(title="What hydrostatics leaves out", tables=[bernoulli_table(run)])
        )
    if len(run.results.time) and run.scene.cloth.grid != "thesis":  # which knows no tension
        sections.append(_rubber(run))
        own = {"rubs": rub_section(run), "folds": fold_section(run)}
        lead = own.pop(run.scene.report.lead, None)
        sections = [section for section in (lead, *sections, *own.values()) if section]
    return [
        *sections,
        quality_section(run),
        Section(title="Scene", tables=scene_tables(run), source=run.results.scene_toml),
        TERMS,
    ]


def _shape(run: RunFiles) -> Section:
    pictures, scale = views(run)
    return Section(
        title="Diaphragm",
        text="The tank frame, seen across the direction of shaking, at instants "
        f"{shown_instants(run)}. Below: cut in the plane of shaking; liquid shaded, its centre of "
        "gravity a cross.",
        pictures=[*pictures, *sections(run)],
        columns=4,
        scale=scale,
        viewer=run_viewer(run),
    )


def pressure_section(run: RunFiles) -> Section:
    """The Bernoulli figures, and p* beside the hydrostatic pressure over time."""
    return Section(
        title="What hydrostatics leaves out",
        tables=[table for table in (bernoulli_table(run), split_table(run)) if table],
        pictures=[pressure_figure(run), node_pressure_figure(run)],
    )


def _motion(run: RunFiles) -> Section:
    steps, scene = run.results.steps, run.scene
    weight = weight_of(steps, scene)
    middle = steps.liquid_cg.mean(axis=0)
    return Section(
        title="Centre of gravity and force",
        text=impulse_sentence(run),
        tables=[table for table in (motion_table(run), transfer_table(run)) if table],
        pictures=[
            motion_figure(
                run,
                1e3 * (steps.liquid_cg - middle),
                "CG in tank (mm)",
                "Tank, and the liquid’s centre of gravity in it about its mean.",
            ),
            motion_figure(
                run,
                steps.force - weight,
                "force less weight (N)",
                "Force of the liquid on tank and diaphragm, without the liquid’s weight.",
            ),
        ],
    )


def _rubber(run: RunFiles) -> Section:
    return Section(title="How hard the rubber is pulled", tables=[rubber_table(run)])


def quality_section(run: RunFiles) -> Section:
    """Iterations, strain, volume and mesh over time, and the wall time by part."""
    pictures: list[Picture] = []
    if len(run.iterations):
        pictures.append(coupling_figure(run))
    if len(run.results.time) > 1:
        mesh = mesh_figure(run)
        pictures += [strain_figure(run), volume_figure(run)]
        pictures += [mesh] if mesh else []
    return Section(
        title="How well it was solved, and what it cost",
        tables=[quality_table(run), cost_table(run)],
        pictures=pictures,
    )


def provenance(run: RunFiles) -> str:
    """Where the figures come from: versions, scene, time."""
    digest = hashlib.sha256(run.results.scene_toml.encode()).hexdigest()[:12]
    written = datetime.fromtimestamp((run.folder / "results.h5").stat().st_mtime, UTC)
    return (
        f"diaphragm-tank {run.results.version} · model {run.model} · scene sha256 {digest} · "
        f"results.h5 written {written:%Y-%m-%d %H:%M} UTC · report built with Python "
        f"{platform.python_version()}, NumPy {np.__version__}, h5py {h5py.__version__}"
    )
