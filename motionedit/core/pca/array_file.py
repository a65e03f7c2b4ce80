"""Named arrays in one .npz file as numpy reads it, without pickles: the same bytes for the same arrays.

Read back as they are written, and in no other way: members are stored, not packed, and each is as large as its shape
says, so that no file takes more memory than its size. Nothing in it is evaluated.
"""

from __future__ import annotations

import io
import math
import re
import zipfile
from struct import error as struct_error
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

# Zip entries carry a time; this one, the earliest that zip knows, keeps the bytes the same.
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)
_ENCRYPTED = 1
_HEADER = re.compile(
    rb"\x93NUMPY\x01\x00..\{'descr': '(<f8|<i8|\|u1)', 'fortran_order': False, 'shape': \(([0-9, ]{0,99})\), \} *\n",
    re.DOTALL,
)


def array_bytes(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Return the file of arrays of float64, int64 or uint8."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            values = np.ascontiguousarray(array)
            head = _head_of(values)
            member = zipfile.ZipInfo(f"{name}.npy", _ZIP_TIME)
            member.file_size = len(head) + values.nbytes  # asked for beforehand: a large one has another entry
            with archive.open(member, "w") as entry:
                entry.write(head)
                entry.write(values.reshape(-1).view(np.uint8).data)
    return buffer.getvalue()


def _head_of(array: NDArray[Any]) -> bytes:
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, np.lib.format.header_data_from_array_1_0(array))
    return head.getvalue()


def read_arrays(data: bytes, *, names: Sequence[str], more: Sequence[str] = ()) -> dict[str, NDArray[Any]]:
    """Return the arrays of a file, which are those of `names`, all of `more` or none of it, and no others.

    Raises
    ------
    ValueError
        The file is none that `array_bytes` writes: what is wrong, in a few words.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            found = sorted(member.filename for member in members)
            if found not in (sorted(f"{name}.npy" for name in some) for some in (names, (*names, *more))):
                raise ValueError("other arrays than a model has")
            for member in members:
                if member.flag_bits & _ENCRYPTED or member.compress_type != zipfile.ZIP_STORED:
                    raise ValueError("an array that is packed or encrypted")
                if member.file_size > len(data):
                    raise ValueError("an array that is larger than the file")
            return {member.filename.removesuffix(".npy"): _array(archive.read(member)) for member in members}
    # Of a damaged directory zipfile raises more than its own error.
    except (zipfile.BadZipFile, EOFError, OSError, RuntimeError, struct_error, OverflowError) as error:
        raise ValueError("no whole .npz file") from error


def _array(entry: bytes) -> NDArray[Any]:
    head = _HEADER.match(entry)
    if head is None:
        raise ValueError("an array of another kind")
    kind = np.dtype(head[1].decode())
    shape = tuple(int(size) for size in head[2].decode().replace(" ", "").split(",") if size)
    if math.prod(shape) * kind.itemsize != len(entry) - head.end():
        raise ValueError("an array that is not as large as it says")
    return np.frombuffer(entry, kind, offset=head.end()).reshape(shape)
