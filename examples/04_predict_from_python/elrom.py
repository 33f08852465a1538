"""ELROM in Python: the C interface (elrom/model/elrom.h) through ctypes, arrays by numpy."""
import ctypes

import numpy as np


class ElromError(RuntimeError):
    pass


def load_library(path="libelrom-c.so"):
    """The library with its functions' types declared; path: where libelrom-c.so is, if the loader does not know."""
    library = ctypes.CDLL(path)
    pointer, text, size = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t
    doubles, floats = (np.ctypeslib.ndpointer(t, flags="C_CONTIGUOUS") for t in (np.float64, np.float32))
    declarations = {
        "elrom_last_error": (text, []),
        "elrom_open": (pointer, [text, text]),
        "elrom_close": (None, [pointer]),
        "elrom_read_case": (ctypes.c_int, [pointer, text, text, doubles]),
        "elrom_cell_centres": (ctypes.c_int, [pointer, doubles]),
        "elrom_predict": (ctypes.c_int, [pointer, doubles, floats, ctypes.c_int]),
        "elrom_validity": (ctypes.c_int, [pointer, doubles, ctypes.POINTER(ctypes.c_int), text, size]),
    }
    for what in ("inputs", "fields", "planes", "columns"):
        declarations[f"elrom_n_{what}"] = (size, [pointer])
    for what in ("input_name", "input_unit", "field_name", "field_unit"):
        declarations[f"elrom_{what}"] = (text, [pointer, size])
    for name, (result, arguments) in declarations.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


class Predictor:
    """All fields of a case, or those named, as an array (fields, planes, columns) in SI."""

    verdicts = ("inside", "edge", "outside")

    def __init__(self, bundle, fields=(), library="libelrom-c.so"):
        self._library = load_library(library)
        self._handle = self._library.elrom_open(str(bundle).encode(), ",".join(fields).encode())
        if not self._handle:
            raise ElromError(self._library.elrom_last_error().decode())
        count = lambda what: getattr(self._library, f"elrom_n_{what}")(self._handle)
        self.shape = (count("fields"), count("planes"), count("columns"))
        self.inputs = self._names("input_name", count("inputs"))
        self.fields = self._names("field_name", self.shape[0])
        self.units = self._names("field_unit", self.shape[0])

    def close(self):
        if self._handle:
            self._library.elrom_close(self._handle)
            self._handle = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _names(self, what, n):
        return [getattr(self._library, f"elrom_{what}")(self._handle, i).decode() for i in range(n)]

    def _check(self, status):
        if status:
            raise ElromError(self._library.elrom_last_error().decode())

    def read_case(self, cases, name):
        """Boundary conditions of one case in a cases file, SI, in the order of `inputs`."""
        values = np.empty(len(self.inputs))
        self._check(self._library.elrom_read_case(self._handle, str(cases).encode(), name.encode(), values))
        return values

    def centres(self):
        """Cell centres [m], (planes, columns, 3)."""
        values = np.empty((*self.shape[1:], 3))
        self._check(self._library.elrom_cell_centres(self._handle, values))
        return values

    def predict(self, inputs, threads=1):
        values = np.empty(self.shape, np.float32)
        inputs = np.ascontiguousarray(inputs, np.float64)
        if inputs.shape != (len(self.inputs),):
            raise ValueError(f"{len(self.inputs)} inputs are needed")
        self._check(self._library.elrom_predict(self._handle, inputs, values, threads))
        return values

    def validity(self, inputs):
        """("inside" | "edge" | "outside", reason)"""
        verdict, reason = ctypes.c_int(), ctypes.create_string_buffer(512)
        inputs = np.ascontiguousarray(inputs, np.float64)
        if inputs.shape != (len(self.inputs),):
            raise ValueError(f"{len(self.inputs)} inputs are needed")
        self._check(self._library.elrom_validity(self._handle, inputs, ctypes.byref(verdict), reason, len(reason)))
        return self.verdicts[verdict.value], reason.value.decode()
