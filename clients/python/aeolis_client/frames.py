# SPDX-License-Identifier: Apache-2.0
"""Recorded samples as a table of pandas, which only this needs."""
from __future__ import annotations

from typing import Any


def frame_of(series: list[Any], entry_sclk: float) -> Any:
    """A pandas.DataFrame: one column a channel, rows by SCLK [s], with `e_s`, seconds from the predicted entry.

    Where a channel has no sample at an instant of another the value is NaN: nothing is interpolated.
    """
    import pandas

    columns = {each.name: pandas.Series(list(each.value), index=list(each.sclk), dtype=float) for each in series}
    frame = pandas.DataFrame({name: column[~column.index.duplicated(keep="last")] for name, column in columns.items()})
    frame.index.name = "sclk"
    frame.insert(0, "e_s", frame.index.to_numpy() - entry_sclk)
    return frame
