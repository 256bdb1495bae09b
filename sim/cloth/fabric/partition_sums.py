"""Sums on the device in a fixed order, whatever the number of threads."""

from sim.cloth.fabric.layout import PARTITIONS
from sim.device.compiler import ti


@ti.func
def partition_start(partition: ti.i32, count: ti.i32) -> ti.i32:
    """Where one of PARTITIONS ranges of so many terms begins."""
    return ti.min(partition * ((count + PARTITIONS - 1) // PARTITIONS), count)


@ti.func
def sum_partition(partition: ti.i32, count: ti.i32, total: ti.template(), term: ti.template()):
    """Add one of PARTITIONS ranges of so many terms to `total`, into a place behind them."""
    whole = total
    for k in range(partition_start(partition, count), partition_start(partition + 1, count)):
        whole += term[k]
    term[count + partition] = whole


@ti.func
def sum_partitions(count: ti.i32, total: ti.template(), term: ti.template()):
    """Add what `sum_partition` left to `total`."""
    whole = total
    for partition in range(PARTITIONS):
        whole += term[count + partition]
    return whole
