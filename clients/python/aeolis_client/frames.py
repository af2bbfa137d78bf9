# SPDX-License-Identifier: Apache-2.0
"""Recorded samples as a table of pandas, which only this needs."""
from __future__ import annotations

from typing import Any


def frame_of(series: list[Any], entry_sclk: float) -> Any:
    """A pandas.DataFrame: one column a channel, rows by SCLK [s], with `e_s`, seconds from the predicted entry.

    Where a channel has no sample at an instant of another, or it is undefined on board, the value is NaN: nothing is
    interpolated. Channels of texts and of whole numbers of more than 53 bits are texts, None where undefined.
    """
    import pandas

    def column_of(each: Any) -> Any:
        if each.text:
            texts = [text.text if text.HasField("text") else None for text in each.text]
            return pandas.Series(texts, index=list(each.sclk), dtype=object)
        return pandas.Series(list(each.value), index=list(each.sclk), dtype=float)

    columns = {each.name: column_of(each) for each in series}
    frame = pandas.DataFrame({name: column[~column.index.duplicated(keep="last")] for name, column in columns.items()})
    frame.index.name = "sclk"
    frame.insert(0, "e_s", frame.index.to_numpy() - entry_sclk)
    return frame
