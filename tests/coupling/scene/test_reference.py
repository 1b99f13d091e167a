"""The list of a scene's keys says of each what the section itself says."""

import tomllib

from coupling.scene.reference import keys, unit_of_key
from coupling.scene.scene import Scene, plain_values, scene_from


def test_every_key_of_every_section_is_listed_with_its_meaning() -> None:
    found = {key.dotted: key for key in keys()}
    for name, field in Scene.model_fields.items():
        inner = getattr(field.annotation, "model_fields", None)
        for key in [f"{name}.{part}" for part in inner] if inner else [name]:
            assert found[key].meaning, key
            assert "<" not in found[key].values.replace("< ", "").replace("<= ", ""), key


def test_defaults_and_units_are_those_of_the_scene() -> None:
    needed = {
        "tank": {"radius": 1.0}, "time": {"duration": 1.0},
        "diaphragm": {"thickness": 1e-3, "material": "AF-E-332"},
        "liquid": {"name": "water", "fill_fraction": 0.5},
    }  # fmt: skip
    values = plain_values(scene_from(needed))
    for key in keys():
        if key.default and key.section not in needed:
            value = values[key.section][key.name] if key.section else values[key.name]
            value = list(value) if isinstance(value, tuple) else value
            assert tomllib.loads(f"default = {key.default}")["default"] == value, key
    assert unit_of_key("motion.frequency") == "Hz"
    assert unit_of_key("gravity") == "m/s^2"
    assert unit_of_key("nothing") == ""
