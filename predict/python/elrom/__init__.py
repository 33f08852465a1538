"""ELROM: fields of a circulating-fluidised-bed furnace from its boundary conditions, with a trained bundle.

    import elrom

    predictor = elrom.Predictor("model.elrom", fields=["pressure"], level=0.9)
    case = predictor.read_cases("cases.csv")["load_064"]
    prediction = predictor.predict(case)
    prediction["pressure"]                  # float32 (n_planes, n_columns) [Pa]
    prediction.half_width_of("pressure")    # the same shape: half-widths of the 90 % prediction interval
    prediction.assessment.reason            # where the case lies among the training cases
    prediction.write("load_064.hdf")        # for scripts and ParaView, as elrom-predict writes it

Units are SI; arrays are C-ordered, planes from the bottom up. A mistake raises a subclass of elrom.Error whose text is one
line: what, where, found, expected, advice.
"""
from __future__ import annotations

import json
import os
from dataclasses import dataclass, field, replace
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _native

__all__ = ["Assessment", "Case", "Error", "FieldInfo", "InputError", "InputInfo", "NumericalError", "Prediction",
           "Predictor", "SnapshotStore", "StoredField", "StoredPrediction", "SystemFailure", "UsageError",
           "ValidityError", "read_prediction", "__version__"]
__version__: str = _native.version()

Path = Union[str, "os.PathLike[str]"]
Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Sides = Tuple[Optional[float], Optional[float]]


class Error(Exception):
    """Root of what ELROM raises. `status` is the exit status that the programs give for it."""

    status: int = 1


class SystemFailure(Error):
    """A fault of the machine: a full disk, a folder that cannot be written."""

    status = 1


class UsageError(Error):
    """A wrong argument: an unknown field, a plane that is not there, an array of another shape."""

    status = 2


class InputError(Error):
    """A file's shape, format, unit or content is wrong."""

    status = 3


class ValidityError(Error):
    """A case lies outside the trained range, and strict=True forbids that."""

    status = 4


class NumericalError(Error):
    """Arithmetic that cannot end in finite numbers."""

    status = 5


_native.set_error_types({kind.status: kind for kind in (SystemFailure, UsageError, InputError, ValidityError,
                                                        NumericalError)})


@dataclass(frozen=True)
class InputInfo:
    """A boundary condition: its SI unit, and the unit that cases files show."""

    name: str
    unit: str
    display_unit: str


@dataclass(frozen=True)
class FieldInfo:
    """A field: SI unit, meaning, physical bounds in that unit (None: no bound)."""

    name: str
    unit: str
    meaning: str
    lower: Optional[float]
    upper: Optional[float]


@dataclass(frozen=True)
class Case:
    """Boundary conditions of one case. `values`: SI, in the order of the inputs, float64 (n_inputs). `load`: fraction of
    full load, NaN when not known."""

    name: str
    load: float
    values: Doubles = field(repr=False)


@dataclass(frozen=True)
class Neighbour:
    """A training case near the one judged; `distance` in standardised inputs, root mean square over inputs."""

    name: str
    load: float
    distance: float


@dataclass(frozen=True)
class Assessment:
    """The validity guard's judgement. `verdict`: inside, edge or outside of what was trained; `reason`: one sentence;
    `unusual`: inputs that the others make unusual, the most unusual first; `p_value`: share of training cases at least as far from the others; `nearest`: three training cases."""

    verdict: str
    reason: str
    out_of_range: List[str]
    unusual: List[str]
    distance: float
    p_value: float
    nearest: List[Neighbour]


def _assessment(raw: Mapping[str, Any]) -> Assessment:
    return Assessment(**{**raw, "nearest": [Neighbour(*one) for one in raw["nearest"]]})


def _cases(raw: Iterable[Tuple[str, float, Doubles]]) -> Dict[str, Case]:
    return {name: Case(name, load, values) for name, load, values in raw}


def _planes(planes: Union[None, int, str, slice, Iterable[int]]) -> Union[None, str, List[int]]:
    if isinstance(planes, slice):
        if planes.step not in (None, 1):
            raise UsageError("a slice of planes has no step; give a range")
        return f"{'' if planes.start is None else planes.start}:{'' if planes.stop is None else planes.stop}"
    if isinstance(planes, (int, np.integer)):
        return [int(planes)]
    if planes is None or isinstance(planes, str):
        return planes
    return [int(plane) for plane in planes]


class Prediction:
    """Fields of one case. Index it by a field's name."""

    def __init__(self, predictor: "Predictor", raw: Any) -> None:
        self._raw = raw
        self.fields: List[FieldInfo] = predictor.fields
        self._index = {info.name: i for i, info in enumerate(self.fields)}
        #: SI, float32 (n_fields, n_planes, n_columns); of a region (n_fields, n_cells); of a profile (n_fields, n_planes)
        self.values: Floats = raw.values()
        #: half-widths of the prediction intervals in the shape of `values`, None without a level
        self.half_width: Optional[Floats] = raw.half_width()
        self.case: Case = Case(*raw.inputs())
        self.assessment: Assessment = _assessment(raw.assessment())
        text = raw.audit_json()
        #: physics audit of all cells, as in elrom-report's JSON (solids, gas balance, planes, bounds); None: not asked for
        self.audit: Optional[Dict[str, Any]] = None if text is None else json.loads(text)
        #: size of the change that conserve=True made; None: not asked for
        self.change: Optional[Dict[str, Any]] = raw.change()

    def _at(self, name: str) -> int:
        if name not in self._index:
            raise UsageError(f"no field '{name}' in the prediction; there are: {', '.join(self._index)}")
        return self._index[name]

    def __getitem__(self, name: str) -> Floats:
        """One field, SI: float32 (n_planes, n_columns), or (n_cells) of a region, or (n_planes) of a profile."""
        return self.values[self._at(name)]

    def half_width_of(self, name: str) -> Floats:
        """Half-widths of the prediction intervals of one field, in its shape and unit."""
        if self.half_width is None:
            raise UsageError("no prediction intervals; open the predictor with a level, such as 0.9")
        return self.half_width[self._at(name)]

    def physics_text(self) -> str:
        """Audit and change in the words that elrom-predict prints."""
        return "\n".join(line.strip() for line in self._raw.physics_text().splitlines() if line.strip())

    def write(self, path: Path, format: Optional[str] = None) -> None:
        """Writes the file that elrom-predict would write; it appears whole or not at all.

        format: hdf (HDF5 for scripts and ParaView), csv, txt (columns for SFW3D), ip (Fluent); None: the path's ending.
        Written are the values as predicted, whatever was done to `values` since.
        """
        self._raw.write(os.fspath(path), os.path.splitext(os.fspath(path))[1][1:] if format is None else format)


class Predictor:
    """Opens a bundle and predicts cases. Thread rule: any number of threads may predict with one; Python's lock is free
    meanwhile.

    bundle: model.elrom that elrom-train wrote.
    fields: names; None: all.
    planes: a number, a range or list, a slice, or a text such as "0:10,20"; None: all.
    region: only cells with centres in ((x0, x1), (y0, y1), (z0, z1)) [m], None for an open side; or "x0:x1,y0:y1,z0:z1".
    profile: plane averages, weighted by volume, instead of cells.
    builds: "mean" combines a network's builds as trained; "best" takes the best alone and is faster.
    level: of prediction intervals, such as 0.9; None: no half-widths.
    threads: of one prediction; 0: all processors.
    verify: compare what is read of the bundle with its digests.
    """

    def __init__(self, bundle: Path, fields: Optional[Sequence[str]] = None, *,
                 planes: Union[None, int, str, slice, Iterable[int]] = None,
                 region: Union[None, str, Sequence[Sides]] = None, profile: bool = False, builds: str = "mean",
                 level: Optional[float] = None, threads: int = 0, verify: bool = True) -> None:
        if builds not in ("mean", "best"):
            raise UsageError(f"builds: found '{builds}', expected mean or best")
        if level is not None and not 0 < level < 1:
            raise UsageError(f"level: found {level}, expected a level between 0 and 1")
        names = [fields] if isinstance(fields, str) else list(fields or [])
        self._raw = _native.Predictor(os.fspath(bundle), names, _planes(planes), region, profile, builds == "best",
                                      level, threads, verify)
        self.inputs: List[InputInfo] = [InputInfo(*one) for one in self._raw.inputs()]
        self.fields: List[FieldInfo] = [FieldInfo(*one) for one in self._raw.fields()]
        #: shape of a prediction's values: (n_fields, n_planes, n_columns), (n_fields, n_cells) or (n_fields, n_planes)
        self.shape: Tuple[int, ...] = self._raw.shape()
        #: numbers of the planes predicted, ascending, int32
        self.planes: npt.NDArray[np.int32] = self._raw.planes()
        #: of the bundle: method, digest, mesh_digest, program, cases (trained on), provenance, n_planes, n_columns
        self.info: Dict[str, Any] = self._raw.info()
        #: cross-validated errors by field, as training found them
        self.accuracy: Dict[str, Any] = json.loads(self.info.pop("accuracy_json"))

    @property
    def cells(self) -> npt.NDArray[np.int32]:
        """Numbers of the cells predicted or averaged: plane * n_columns + column, int32 (n_cells)."""
        return self._raw.cells()

    @property
    def coordinates(self) -> Floats:
        """Where the values lie [m]: float32 (n_planes, n_columns, 3) or (n_cells, 3) of a region: x, y, z; of a profile
        (n_planes): z."""
        return self._raw.coordinates()

    def read_cases(self, path: Path) -> Dict[str, Case]:
        """Cases of a table (.csv, .json, .toml) by name, in its order; units are converted to SI."""
        return _cases(self._raw.read_cases(os.fspath(path)))

    def with_settings(self, case: Case, *settings: str) -> Case:
        """The case with inputs changed as by --set: "primary_air=180 kg/s"; without a unit, the one that cases files show."""
        return replace(case, values=self._raw.apply_settings(case.values, list(settings)))

    def assess(self, case: Union[Case, npt.ArrayLike]) -> Assessment:
        """Where a case lies among the training cases. case: a Case, or its inputs in SI (n_inputs)."""
        return _assessment(self._raw.assess(self._values(case)))

    def predict(self, case: Union[Case, npt.ArrayLike], *, name: Optional[str] = None, load: float = float("nan"),
                strict: bool = False, audit: bool = False, conserve: bool = False) -> Prediction:
        """Predicts one case.

        case: a Case, or its inputs in SI and in the order of `inputs`, (n_inputs); then `name` and `load` go into files.
        strict: raise ValidityError for a case outside the trained range.
        audit: compare the fields with the boundary conditions (Prediction.audit). conserve: bring solids and gas flow to
        the inputs' by the smallest change (Prediction.change). Both need all cells.
        """
        values = self._values(case)
        if isinstance(case, Case):
            name, load = name or case.name, case.load if np.isnan(load) else load
        if strict:
            judged = self.assess(values)
            if judged.verdict == "outside":
                raise ValidityError(f"case {name or 'case'} lies outside the trained range: {judged.reason}")
        return Prediction(self, self._raw.predict(values, name or "case", load, audit, conserve))

    @staticmethod
    def _values(case: Union[Case, npt.ArrayLike]) -> Doubles:
        try:
            return np.ascontiguousarray(case.values if isinstance(case, Case) else case, np.float64)
        except (TypeError, ValueError) as error:
            raise UsageError(f"boundary conditions are no numbers: {error}") from None


class SnapshotStore:
    """Snapshots that elrom-data imported: cases x fields on the reduced mesh. The whole file is checked when opened."""

    def __init__(self, path: Path) -> None:
        self._raw = _native.SnapshotStore(os.fspath(path))
        self.cases: Dict[str, Case] = _cases(self._raw.cases())
        self.inputs: List[InputInfo] = [InputInfo(*one) for one in self._raw.inputs()]
        self.fields: List[FieldInfo] = [FieldInfo(*one) for one in self._raw.fields()]
        #: (n_cases, n_planes, n_columns)
        self.shape: Tuple[int, int, int] = self._raw.shape()

    @property
    def centres(self) -> Doubles:
        """Cell centres [m], float64 (n_planes, n_columns, 3)."""
        return self._raw.centres()

    @property
    def volumes(self) -> Doubles:
        """Cell volumes [m3], float64 (n_planes, n_columns)."""
        return self._raw.volumes()

    def find(self, pattern: str) -> List[str]:
        """Names of the cases that match, shell style ("load_*"), in the store's order."""
        names = list(self.cases)
        return [names[i] for i in self._raw.find(pattern)]

    def input_values(self, cases: Optional[Sequence[str]] = None) -> Doubles:
        """Boundary conditions, SI, float64 (n_cases, n_inputs). cases: names; None: all."""
        return np.array([self.cases[name].values for name in self._names(cases)])

    def read(self, field: str, cases: Optional[Sequence[str]] = None) -> Floats:
        """One field, SI, float32 (n_cases, n_planes, n_columns). cases: names; None: all."""
        numbers = {name: i for i, name in enumerate(self.cases)}
        return self._raw.read(field, [numbers[name] for name in self._names(cases)])

    def _names(self, cases: Optional[Sequence[str]]) -> List[str]:
        wanted = [cases] if isinstance(cases, str) else list(self.cases if cases is None else cases)
        for name in wanted:
            if name not in self.cases:
                raise UsageError(f"no case '{name}' in the store")
        return wanted

    def __len__(self) -> int:
        return len(self.cases)

    def __iter__(self) -> Iterator[str]:
        return iter(self.cases)


@dataclass(frozen=True)
class StoredField:
    """A field in a prediction file. `values`, `half_width` (None: no intervals): SI, float32 (n_planes, n_columns), of a
    region (n_cells), of profiles (n_planes)."""

    unit: str
    values: Floats = field(repr=False)
    half_width: Optional[Floats] = field(repr=False)


@dataclass(frozen=True)
class StoredPrediction:
    """A prediction file, read whole. `inputs`: SI by name. `planes`: int32. `cells`: of a region, int32 (n_cells): plane *
    n_columns + column, else empty. `centre` [m]: float32 (n_cells, 3), and `heights` [m] (n_planes) of profiles; the other
    is empty."""

    case: str
    load: Optional[float]
    validity: str
    validity_reason: str
    nearest_cases: List[str]
    interval_level: Optional[float]
    bundle_digest: str
    mesh_digest: str
    bundle_program: str
    method: str
    builds: str
    inputs: Dict[str, float]
    input_units: Dict[str, str]
    profiles: bool
    planes: npt.NDArray[np.int32] = field(repr=False)
    cells: npt.NDArray[np.int32] = field(repr=False)
    centre: Floats = field(repr=False)
    heights: Floats = field(repr=False)
    fields: Dict[str, StoredField] = field(repr=False)

    def __getitem__(self, name: str) -> Floats:
        """One field's values, SI."""
        if name not in self.fields:
            raise UsageError(f"no field '{name}' in the prediction; there are: {', '.join(self.fields)}")
        return self.fields[name].values


def read_prediction(path: Path) -> StoredPrediction:
    """Reads a .hdf file of elrom-predict, Prediction.write() or the C and C++ libraries."""
    raw = _native.read_prediction(os.fspath(path))
    names = raw.pop("input_names")
    raw["inputs"] = {name: float(value) for name, value in zip(names, raw["inputs"])}
    raw["input_units"] = dict(zip(names, raw["input_units"]))
    raw["centre"] = raw["centre"].reshape(-1, 3)
    raw["fields"] = {name: StoredField(unit, values, half_width) for name, unit, values, half_width in raw["fields"]}
    return StoredPrediction(**raw)
