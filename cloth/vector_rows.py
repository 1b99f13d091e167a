"""Rows of four numbers held in one vector register: what the compiler does not find by itself."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic


def _subtract_products(
    context: Any, work: Any, targets: Any, sources: Any, values: Any, place: Any, steps: Any
) -> Any:
    """``work[t] -= sum_n values[q + i a + n b] work[sources[n]]`` for the i-th t of ``targets``.

    ``work`` (n, 4), contiguous; ``targets``: a tuple of rows; ``sources`` (k,): rows that are no
    targets; ``values`` (j,), contiguous; ``place``: q; ``steps``: (a, b). All sums advance together
    and stay in registers, so that none waits for another. No index is checked.
    """
    count = len(targets)

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        """The loop over ``sources``, a product and a difference a target in its body."""
        row = ir.VectorType(ir.DoubleType(), 4)
        arrays = [
            context.make_array(signature.args[i])(context, builder, arguments[i]) for i in (0, 2, 3)
        ]
        rows = builder.bitcast(arrays[0].data, row.as_pointer())
        places = [
            builder.gep(rows, [index]) for index in cgutils.unpack_tuple(builder, arguments[1])
        ]
        between, stride = cgutils.unpack_tuple(builder, arguments[5])
        sums = [cgutils.alloca_once_value(builder, builder.load(p, align=8)) for p in places]
        number = builder.extract_value(arrays[1].shape, 0)
        with cgutils.for_range(builder, number, intp=number.type) as loop:
            source = builder.load(builder.gep(arrays[1].data, [loop.index]))
            other = builder.load(builder.gep(rows, [source]), align=8)
            at = builder.add(arguments[4], builder.mul(loop.index, stride))
            for total in sums:
                value = builder.load(builder.gep(arrays[2].data, [at]))
                same = builder.insert_element(
                    ir.Constant(row, ir.Undefined), value, ir.IntType(32)(0)
                )
                mask = ir.Constant(ir.VectorType(ir.IntType(32), 4), [0] * 4)
                same = builder.shuffle_vector(same, ir.Constant(row, ir.Undefined), mask)
                product = builder.fmul(same, other, flags=("contract",))
                builder.store(
                    builder.fsub(builder.load(total), product, flags=("contract",)), total
                )
                at = builder.add(at, between)
        for total, target in zip(sums, places, strict=True):
            builder.store(builder.load(total), target, align=8)
        return context.get_dummy_value()

    pair = types.UniTuple(types.int64, 2)
    return (
        types.void(work, types.UniTuple(types.int64, count), sources, values, types.int64, pair),
        build,
    )


subtract_products: Any = intrinsic(_subtract_products)
