"""``results.xdmf``: how ParaView and meshio see ``results.h5`` as a moving surface.

XDMF names whole datasets, and meshio reads no slices. Every instant therefore has its own names in
the group ``instants`` of ``results.h5``: virtual datasets, views of 1 kB onto the rows of
``diaphragm/...``, which hold the numbers once.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from coupling.ports import Array

_VECTORS = ("velocity", "contact_force")
_AT_NODES = (
    "pressure", "dynamic_pressure", "shell_pressure", "self_pressure", "shell_slip", "self_slip",
    "shell_work", "self_work",
)  # fmt: skip
_AT_TRIANGLES = ("strain", "tension")
_END = "</Grid>\n</Domain>\n</Xdmf>\n"
_ROW = re.compile(rb"/instants/(\d+)/")
_LONGEST = 16384  # bytes at the end of a document that hold an instant whole; one takes 2 kB
_VIEWS = ("position", *_VECTORS, *_AT_NODES, *_AT_TRIANGLES)


def link_instants(file: Any, start: int, stop: int) -> None:
    """Add the views of rows ``start`` to ``stop`` of the diaphragm's datasets.

    With HDF5's low-level calls: h5py's own views take three times as long.
    """
    scalar = h5py.h5s.create(h5py.h5s.SCALAR)
    rows = [file.require_group(f"instants/{row:06d}") for row in range(start, stop)]
    for name in _VIEWS:
        dataset = file[f"diaphragm/{name}"]
        one_row = h5py.h5s.create_simple(dataset.shape[1:])
        source = dataset.id.get_space()
        kind, origin = dataset.id.get_type(), (0,) * (dataset.ndim - 1)
        text = np.array(str(dataset.attrs["unit"]), h5py.string_dtype())
        words = h5py.h5t.py_create(text.dtype, logical=True)
        for row, group in enumerate(rows, start):
            source.select_hyperslab((row, *origin), (1, *dataset.shape[1:]))
            layout = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            layout.set_virtual(one_row, b".", dataset.name.encode(), source)
            view = h5py.h5d.create(group.id, name.encode(), kind, one_row, layout)
            h5py.h5a.create(view, b"unit", words, scalar).write(text)


def unlink_instants(file: Any, keep: int) -> None:
    """Remove the views from row ``keep`` on."""
    for name in [key for key in file.get("instants", ()) if int(key) >= keep]:
        del file[f"instants/{name}"]


def document(data_file: str, times: Array, nodes: int, triangles: int) -> str:
    """The XDMF text: a temporal collection with the geometry of every instant.

    ``times`` (T,) [s]. The position is a point vector too, for readers such as meshio's
    ``TimeSeriesReader`` that read the geometry once. Without any instant the collection is empty,
    which meshio refuses to open.
    """
    return (
        '<?xml version="1.0"?>\n<Xdmf Version="3.0">\n<Domain>\n'
        '<Grid Name="diaphragm" GridType="Collection" CollectionType="Temporal">\n'
        f"{_instants(data_file, 0, times, nodes, triangles)}{_END}"
    )


def extend(
    path: Path, data_file: str, first: int, times: Sequence[float], nodes: int, triangles: int
) -> None:
    """Add to a document at ``path`` those of the rows from ``first`` on that it lacks.

    ``times`` [s] are those of all these rows.
    """
    with path.open("r+b") as file:
        file.seek(max(0, path.stat().st_size - _LONGEST))
        named = _ROW.findall(file.read())
        listed = int(named[-1]) + 1 if named else 0
        file.seek(-len(_END), os.SEEK_END)
        text = _instants(data_file, listed, times[listed - first :], nodes, triangles) + _END
        file.write(text.encode())


def _instants(
    data_file: str, first: int, times: Iterable[float], nodes: int, triangles: int
) -> str:
    return "".join(
        _instant(f"{data_file}:/instants/{row:06d}", data_file, float(time), nodes, triangles)
        for row, time in enumerate(times, first)
    )


def _instant(view: str, data_file: str, time: float, nodes: int, triangles: int) -> str:
    return (
        f'<Grid Name="diaphragm" GridType="Uniform">\n<Time Value="{time!r}"/>\n'
        f'<Topology TopologyType="Triangle" NumberOfElements="{triangles}">'
        f"{_item(f'{data_file}:/diaphragm/triangles', f'{triangles} 3', 'Int')}</Topology>\n"
        f'<Geometry GeometryType="XYZ">{_item(f"{view}/position", f"{nodes} 3")}</Geometry>\n'
        + "".join(
            _attribute(name, "Vector", "Node", _item(f"{view}/{name}", f"{nodes} 3"))
            for name in ("position", *_VECTORS)
        )
        + "".join(
            _attribute(name, "Scalar", "Node", _item(f"{view}/{name}", f"{nodes}"))
            for name in _AT_NODES
        )
        + "".join(
            _attribute(name, "Scalar", "Cell", _item(f"{view}/{name}", f"{triangles}"))
            for name in _AT_TRIANGLES
        )
        + "</Grid>\n"
    )


def _attribute(name: str, kind: str, centre: str, item: str) -> str:
    return f'<Attribute Name="{name}" AttributeType="{kind}" Center="{centre}">{item}</Attribute>\n'


def _item(place: str, dimensions: str, kind: str = "Float") -> str:
    return (
        f'<DataItem Dimensions="{dimensions}" NumberType="{kind}" Precision="8" Format="HDF">'
        f"{place}</DataItem>"
    )
