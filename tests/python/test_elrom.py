"""The package elrom against the programs: what elrom-predict writes is the oracle."""
import inspect
import os
import pathlib
import subprocess
import threading

import numpy as np
import pytest

import elrom

BUILD = pathlib.Path(os.environ["ELROM_BUILD"])
SAMPLE = BUILD / "tests" / "fields" / "sample"
BUNDLE, CASES = SAMPLE / "model.elrom", SAMPLE / "cases.csv"


def program(name, *arguments):
    subprocess.run([BUILD / "bin" / name, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def predict(folder, *options, case="case_7"):
    program("elrom-predict", "--bundle", BUNDLE, "--cases", CASES, "--case", case, "--output", folder, *options)
    return folder / f"{case}.hdf"


@pytest.fixture(scope="module")
def predictor():
    return elrom.Predictor(BUNDLE)


@pytest.fixture(scope="module")
def case(predictor):
    return predictor.read_cases(CASES)["case_7"]


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    path = tmp_path_factory.mktemp("store") / "snapshots.h5"
    program("elrom-data", "generate", "--cases", 5, "--held-out", 1, "--planes", 4, "--columns", 12, "--fields", 3,
            "--store", path)
    return elrom.SnapshotStore(path)


def test_a_predictor_says_what_it_knows(predictor):
    assert predictor.shape == (9, 5, 12)
    assert predictor.fields[6].name == "pressure" and predictor.fields[6].unit == "Pa"
    assert [info.unit for info in predictor.inputs] == ["kg/s"] * 4
    assert predictor.inputs[0].display_unit == "t/h"
    assert predictor.info["method"] == "networks" and len(predictor.info["digest"]) == 64
    assert predictor.info["n_planes"] == 5 and len(predictor.info["cases"]) == 12
    assert predictor.planes.tolist() == [0, 1, 2, 3, 4]
    assert predictor.coordinates.shape == (5, 12, 3)


OPTIONS = {
    "all": ({}, [], (9, 5, 12)),
    "fields": ({"fields": ["pressure", "solid_velocity_y"]}, ["--fields", "pressure,solid_velocity_y"], (2, 5, 12)),
    "planes": ({"planes": [1, 2, 4]}, ["--planes", "1:3,4"], (9, 3, 12)),
    "slice": ({"planes": slice(3, None)}, ["--planes", "3:"], (9, 2, 12)),
    "region": ({"region": ((0, 5.3), (None, None), (None, 20))}, ["--region", "0:5.3,:,:20"], (9, 12)),
    "profile": ({"profile": True}, ["--profile"], (9, 5)),
    "profile of a region": ({"profile": True, "region": ":,:,20:"}, ["--profile", "--region", ":,:,20:"], (9, 3)),
    "best": ({"builds": "best"}, ["--builds", "best"], (9, 5, 12)),
    "level": ({"level": 0.8}, ["--uncertainty", "0.8"], (9, 5, 12)),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_arrays_and_files_are_those_of_the_program(name, tmp_path, case):
    arguments, options, shape = OPTIONS[name]
    written = predict(tmp_path / "program", *options)
    predictor = elrom.Predictor(BUNDLE, threads=1, **arguments)

    prediction = predictor.predict(case)

    assert predictor.shape == prediction.values.shape == shape
    assert prediction.values.dtype == np.float32
    stored = elrom.read_prediction(written)
    assert set(stored.fields) == {info.name for info in prediction.fields}
    for info in prediction.fields:
        assert np.array_equal(prediction[info.name], stored[info.name])
        if predictor.shape == shape and "level" in arguments:
            assert np.array_equal(prediction.half_width_of(info.name), stored.fields[info.name].half_width)
    if not stored.profiles:
        assert np.array_equal(predictor.coordinates.reshape(-1, 3), stored.centre)
    else:
        assert np.array_equal(predictor.coordinates, stored.heights)
    prediction.write(tmp_path / "python.hdf")
    assert (tmp_path / "python.hdf").read_bytes() == written.read_bytes()


@pytest.mark.parametrize("format", ["csv", "txt", "ip"])
def test_text_exports_are_those_of_the_program(format, tmp_path, predictor, case):
    predict(tmp_path, "--format", format)

    predictor.predict(case).write(tmp_path / f"python.{format}")

    assert (tmp_path / f"python.{format}").read_bytes() == (tmp_path / f"case_7.{format}").read_bytes()


def test_values_do_not_move_when_the_file_is_written_later(tmp_path, predictor, case):
    prediction = predictor.predict(case)
    prediction.values[:] = 0
    prediction.write(tmp_path / "a.hdf")
    assert elrom.read_prediction(tmp_path / "a.hdf")["pressure"].any()


def test_a_prediction_file_says_where_it_is_from(tmp_path, predictor, case):
    stored = elrom.read_prediction(predict(tmp_path))
    assert stored.case == "case_7" and stored.load == pytest.approx(case.load)
    assert stored.bundle_digest == predictor.info["digest"]
    assert stored.inputs == dict(zip((info.name for info in predictor.inputs), case.values))
    assert stored.validity == predictor.assess(case).verdict
    assert stored.planes.tolist() == [0, 1, 2, 3, 4] and stored.cells.size == 0


def test_the_guard_judges(predictor, case):
    inside = predictor.assess(case)
    assert inside.verdict == "inside" and inside.reason and len(inside.nearest) == 3
    assert inside.nearest[0].distance <= inside.nearest[1].distance
    outside = predictor.assess(case.values * 10)
    assert outside.verdict == "outside" and outside.out_of_range
    moved = case.values.copy()
    moved[0] *= 10
    assert inside.unusual == [] and "is usual with these other inputs" in predictor.assess(moved).unusual[0]
    with pytest.raises(elrom.ValidityError, match="outside the trained range"):
        predictor.predict(case.values * 10, strict=True)


def test_settings_have_units(predictor, case):
    changed = predictor.with_settings(case, "flow_0=36", "flow_1=7200 kg/h")
    assert changed.values[:2] == pytest.approx([10, 2])  # t/h is what cases files show
    assert changed.values[2] == case.values[2] and case.values[0] != 10


def test_audit_and_repair_are_those_of_the_program(tmp_path):
    inputs = {"primary_air": 7, "burner_left": 14, "solids_inventory": 60000, "gas_temperature": 1100}
    settings = ["primary_air=7", "burner_left=14", "solids_inventory=60 t", "gas_temperature=1100"]
    program("elrom-predict", "--bundle", SAMPLE / "furnace.elrom", *(f"--set={one}" for one in settings), "--audit",
            "--conserve", "--output", tmp_path)
    predictor = elrom.Predictor(SAMPLE / "furnace.elrom")
    assert [info.name for info in predictor.inputs] == list(inputs)

    plain = predictor.predict(list(inputs.values()))
    repaired = predictor.predict(list(inputs.values()), audit=True, conserve=True)

    assert plain.audit is None and plain.change is None
    assert repaired.change["solids_kg"] != 0
    assert repaired.audit["solids_kg"] == pytest.approx(60000, rel=1e-5)
    assert not np.array_equal(repaired["solid_volume_fraction"], plain["solid_volume_fraction"])
    assert np.array_equal(repaired["pressure"], plain["pressure"])
    assert "solids added" in repaired.physics_text() and "net solid flow" in repaired.physics_text()
    repaired.write(tmp_path / "python.hdf")
    assert (tmp_path / "python.hdf").read_bytes() == (tmp_path / "case.hdf").read_bytes()


def test_audit_and_repair_are_refused_with_the_reason(predictor, case):
    with pytest.raises(elrom.UsageError, match="--conserve needs input 'solids_inventory'"):
        predictor.predict(case, conserve=True)
    with pytest.raises(elrom.UsageError, match="needs all cells"):
        elrom.Predictor(BUNDLE, planes="0:2").predict(case, audit=True)


@pytest.mark.parametrize("make, kind, text", [
    (lambda: elrom.Predictor("/nowhere/model.elrom"), elrom.InputError, "/nowhere/model.elrom"),
    (lambda: elrom.Predictor(CASES), elrom.InputError, "cases.csv"),
    (lambda: elrom.Predictor(BUNDLE, ["presure"]), elrom.UsageError, "did you mean 'pressure'"),
    (lambda: elrom.Predictor(BUNDLE, planes=[5]), elrom.UsageError, "plane 5 cannot be asked for"),
    (lambda: elrom.Predictor(BUNDLE, planes="a"), elrom.UsageError, "cannot be read"),
    (lambda: elrom.Predictor(BUNDLE, region=((1, 2),)), elrom.UsageError, "three pairs"),
    (lambda: elrom.Predictor(BUNDLE, region=((2, 1), (None, None), (None, None))), elrom.UsageError, "below"),
    (lambda: elrom.Predictor(BUNDLE, level=2), elrom.UsageError, "between 0 and 1"),
    (lambda: elrom.Predictor(BUNDLE, builds="worst"), elrom.UsageError, "mean or best"),
    (lambda: elrom.Predictor(BUNDLE).predict([1, 2]), elrom.UsageError, "expected an array of 4 values"),
    (lambda: elrom.Predictor(BUNDLE).predict("air"), elrom.UsageError, "no numbers"),
    (lambda: elrom.Predictor(BUNDLE).predict([np.nan] * 4), elrom.NumericalError, "not a finite number"),
    (lambda: elrom.Predictor(BUNDLE).predict([1, 2, 3, 4])["presure"], elrom.UsageError, "no field"),
    (lambda: elrom.Predictor(BUNDLE).predict([1, 2, 3, 4]).half_width_of("pressure"), elrom.UsageError, "level"),
    (lambda: elrom.Predictor(BUNDLE).predict([1, 2, 3, 4]).write("/nowhere/a.hdf"), elrom.SystemFailure, "/nowhere"),
    (lambda: elrom.Predictor(BUNDLE).predict([1, 2, 3, 4]).write("a.xyz"), elrom.UsageError, "no format 'xyz'"),
    (lambda: elrom.read_prediction(BUNDLE), elrom.InputError, "model.elrom"),
    (lambda: elrom.SnapshotStore("/nowhere/s.h5"), elrom.InputError, "/nowhere/s.h5"),
])
def test_a_mistake_is_one_line_of_its_kind(make, kind, text):
    with pytest.raises(kind, match=text) as caught:
        make()
    assert isinstance(caught.value, elrom.Error) and "\n" not in str(caught.value)


def test_stores_are_read(store):
    assert len(store) == 6 and store.shape == (6, 4, 12)
    assert store.find("train_*") == [f"train_{i:03}" for i in range(5)]
    values = store.read(store.fields[0].name, ["train_001", "train_003"])
    assert values.shape == (2, 4, 12) and values.dtype == np.float32
    assert np.array_equal(values[1], store.read(store.fields[0].name)[list(store).index("train_003")])
    assert store.input_values(["train_001"]).shape == (1, len(store.inputs))
    assert np.array_equal(store.input_values()[0], store.cases[next(iter(store))].values)
    assert store.centres.shape == (4, 12, 3) and store.volumes.min() > 0
    with pytest.raises(elrom.UsageError, match="no case 'nobody'"):
        store.read(store.fields[0].name, ["nobody"])
    with pytest.raises(elrom.InputError):
        store.read("no_such_field")


def test_many_threads_share_one_predictor(predictor, case):
    expected, found = predictor.predict(case).values, [None] * 8

    def work(i):
        found[i] = predictor.predict(case).values

    threads = [threading.Thread(target=work, args=(i,)) for i in range(len(found))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(values, expected) for values in found)


def test_everything_public_is_typed_and_explained():
    assert (pathlib.Path(elrom.__file__).parent / "py.typed").exists()
    for name in elrom.__all__:
        item = getattr(elrom, name)
        if name == "__version__":
            continue
        assert item.__doc__, name
        members = inspect.getmembers(item, inspect.isfunction) if inspect.isclass(item) else [(name, item)]
        for member, function in members:
            if member.startswith("_") and member != "__init__":
                continue
            if issubclass(item, Exception) if inspect.isclass(item) else False:
                continue
            assert "return" in function.__annotations__, f"{name}.{member}"


def test_the_programs_and_the_package_are_of_one_version():
    said = subprocess.run([BUILD / "bin" / "elrom-predict", "--version"], stdout=subprocess.PIPE, text=True).stdout
    assert f"ELROM {elrom.__version__} " in said
