"""What a run's report says of the scene."""

from __future__ import annotations

from pathlib import Path

from coupling.estimate.numbers import numbers_of
from coupling.fluids import FLUIDS
from coupling.motion import MOTIONS
from coupling.report.files import RunFiles
from coupling.report.page import Table, number, percent
from coupling.scene.carrier import Carrier
from coupling.scene.scene import Scene
from coupling.scene.tank import Tank


def scene_tables(run: RunFiles) -> list[Table]:
    """What was simulated, and the numbers that follow from it."""
    scene = run.scene
    motion, liquid, rubber, time = scene.motion, scene.liquid, scene.diaphragm, scene.time
    uneven = rubber.thickness_range[0] < rubber.thickness_range[1]
    facts = MOTIONS[motion.kind].facts(motion)
    shaking = ", ".join(fact if isinstance(fact, str) else number(*fact) for fact in facts)
    sizes = FLUIDS[scene.model.fluid].size(scene).values()
    flow = ", ".join(str(size) for size in sizes) or "none"
    rows = [
        *_tank_rows(scene.tank),
        ["Fill fraction", number(liquid.fill_fraction)],
        ["Liquid", f"{liquid.name or ''} {number(liquid.density, 'kg/m³', 4)}".strip()],
        ["Kinematic viscosity", number(liquid.viscosity, "m²/s")],
        [
            "Diaphragm’s thickness" + (", mean" if uneven else ""),
            number(1e3 * scene.mean_thickness, "mm", 4),
        ],
        *_mould_row(scene),
        *_ridge_row(scene),
        ["Diaphragm’s density", number(rubber.density, "kg/m³", 4)],
        ["Young’s modulus", number(rubber.youngs_modulus / 1e6, "MPa")],
        ["Ground’s motion" if scene.carrier.free else "Shaking", shaking],
        *_carrier_rows(scene.carrier),
        ["Step, duration", f"{number(1e3 * time.step, 'ms')}, {number(time.duration, 's')}"],
        ["Fluid model", scene.model.fluid],
        ["Cloth rings; flow cells", f"{scene.cloth.resolution}; {flow}"],
    ]
    numbers = numbers_of(scene)
    derived = [
        ["First slosh frequency f₁", number(numbers.slosh_frequency, "Hz")],
        *(
            [["Highest tenth of the record’s power from, over f₁", number(numbers.frequency_ratio)]]
            if run.summary.get("record")
            else [
                ["f/f₁", number(numbers.frequency_ratio)],
                ["Neglected term by the rule (f/f₁)²", percent(numbers.hydrostatic_error)],
            ]
        ),
        ["Bond number", number(numbers.bond)],
        ["Weber number", number(numbers.weber)],
        ["ρbR²/(Et), b the largest body force", number(numbers.membrane_parameter)],
        ["Wrinkle wavelength", number(1e3 * numbers.elasto_gravity_wavelength, "mm")],
        ["Added over rubber mass", number(numbers.added_mass_ratio)],
    ]
    return [Table(rows=rows, numbers=True), Table(rows=derived, numbers=True)]


def _tank_rows(tank: Tank) -> list[list[str]]:
    """The tank's sizes, of a sphere clamped at its equator the radius alone."""
    sizes = {
        "Tank radius": tank.radius, "Length of the cylindrical part": tank.cylinder_length,
        "Semi-axis along z": tank.semi_axis,
    }  # fmt: skip
    rows = [[name, number(1e3 * size, "mm", 4)] for name, size in sizes.items() if size is not None]
    if tank.shape == "sphere" and tank.clamp_height == 0.0:
        return rows
    return [
        ["Tank’s shape", tank.shape],
        *rows,
        ["Radius of the clamped circle", number(1e3 * tank.shell.size, "mm", 4)],
        ["Its height above the middle", number(1e3 * tank.clamp_height, "mm", 4)],
        ["Tank’s volume", number(1e3 * tank.volume, "l", 4)],
    ]


def _carrier_rows(carrier: Carrier) -> list[list[str]]:
    """What holds a free tank; nothing of one whose motion is prescribed."""
    if not carrier.free:
        return []
    held = {"Springs along x, y, z (N/m)": carrier.springs,
            "Dampers along x, y, z (N s/m)": carrier.dampers,
            "Moments of inertia of it (kg m²)": carrier.inertia or (),
            "Springs about x, y, z (N m/rad)": carrier.rotational_springs,
            "Dampers about x, y, z (N m s/rad)": carrier.rotational_dampers}  # fmt: skip
    return [
        ["Free tank’s mass", number(carrier.mass, "kg")],
        *(
            [head, ", ".join(number(value, digits=4) for value in values)]
            for head, values in held.items()
            if any(values)
        ),
    ]


def _mould_row(scene: Scene) -> list[list[str]]:
    """A row that says to what the diaphragm is moulded; none for the shell above the rim."""
    rubber = scene.diaphragm
    side = "above" if rubber.mould == "upper" else "below"
    if rubber.mould_profile is not None:
        return [["Moulded to", f"{Path(rubber.mould_profile).name}, {side} the rim"]]
    return [] if side == "above" else [["Moulded to", "the shell below the rim"]]


def _ridge_row(scene: Scene) -> list[list[str]]:
    """A row that says which ridges there are; none without."""
    rubber = scene.diaphragm
    if rubber.ridge_number is None or rubber.ridge_width is None or rubber.ridge_height is None:
        return []
    width, height = (number(1e3 * one, "mm") for one in (rubber.ridge_width, rubber.ridge_height))
    said = f"{rubber.ridge_number} {rubber.ridge_direction}, {width} wide, {height} high"
    return [["Ridges", said]]
