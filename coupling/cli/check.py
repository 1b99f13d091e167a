"""The verb ``edt check``."""

from __future__ import annotations

from coupling.cli.exit_status import guarded
from coupling.cli.json_output import print_json
from coupling.cli.options import AllowCommand, AsJson, Changes, OpenFoamPrefix, ScenePath


@guarded("coupling.cli.tables", "coupling.api.start")
def check(
    scene_path: ScenePath,
    changes: Changes = None,
    allow_command: AllowCommand = False,
    openfoam: OpenFoamPrefix = None,
    as_json: AsJson = False,
) -> None:
    """Check a scene; say how good each fluid model is for it and what it costs."""
    from coupling import load_scene
    from coupling.api.start import check_installed
    from coupling.cli.tables import model_estimates, print_check
    from coupling.estimate.model_errors import choose
    from coupling.estimate.numbers import numbers_of
    from coupling.finite_volume.mesh_sizes import cells_made
    from coupling.motion.record_summary import record_summary

    scene = load_scene(scene_path, changes or ())
    check_installed(scene, [scene.model.fluid], start=False)
    numbers, choice, record = numbers_of(scene), choose(scene), record_summary(scene)
    if as_json:
        print_json(
            {
                "title": scene.title,
                "numbers": numbers.to_dict(),
                "record": None if record is None else record.to_dict(),
                "models": model_estimates(scene),
                "cells": cells_made(*scene.half_ball),
                "advised": choice.fluid,
                "reason": choice.reason,
            }
        )
    else:
        print_check(scene, numbers, choice, record)
