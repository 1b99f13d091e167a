"""The scene of a run, written into its folder."""

from __future__ import annotations

from pathlib import Path

import tomli_w

from coupling.scene.scene import SCENE_FILE, TABLE_FILES, Scene, plain_values, tables_of
from coupling.store.atomic import replacing, write_text


def write_scene(scene: Scene, folder: Path) -> Path:
    """Write ``scene.toml`` into ``folder``, with copies of the files it names; returns its path.

    The folder can be moved and the scene run again from there: the files are named relative to it.
    Each file appears whole or not at all, the scene last. ``RunFailed`` where the folder cannot be
    written.
    """
    data = plain_values(scene)
    contents = {place: path.read_bytes() for place, path in tables_of(scene).items()}
    for (section, key), content in contents.items():
        copy = folder / TABLE_FILES[section, key]
        if not copy.is_file() or copy.read_bytes() != content:
            with replacing(copy) as beside:
                beside.write_bytes(content)
        data[section][key] = copy.name
    file = folder / SCENE_FILE
    write_text(file, tomli_w.dumps(data))
    return file
