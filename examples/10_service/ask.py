#!/usr/bin/env python3
"""ask.py URL FOLDER: what an engineer asks of a served ELROM, by REST. Ends with a table of what became of it."""
import csv
import hashlib
import json
import pathlib
import random
import shutil
import subprocess
import sys
import time
import urllib.error
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
URL, OUT = sys.argv[1], pathlib.Path(sys.argv[2])
TOKEN = (OUT / "me.token").read_text().strip()


def call(method, path, body=None, media="application/json", accept="*/*"):
    """Status and what was answered: JSON, or bytes."""
    data = body if isinstance(body, bytes) else None if body is None else json.dumps(body).encode()
    headers = {"Authorization": "Bearer " + TOKEN, "Accept": accept, "Content-Type": media,
               "Idempotency-Key": f"{random.getrandbits(64):x}"}
    try:
        answer = urllib.request.urlopen(urllib.request.Request(URL + path, data, headers, method=method))
    except urllib.error.HTTPError as problem:
        answer = problem
    content = answer.read()
    return answer.status, json.loads(content) if "json" in answer.headers["Content-Type"] else content


def shipped_case(name, factor=1.0):
    """Boundary conditions of a shipped case; `factor`: of all gas flows."""
    with open(ROOT / "data/cases/cases.csv") as table:
        row = next(row for row in csv.DictReader(table) if row["case"] == name)
    inputs = {key: float(value) * (factor if key.endswith("[kg/s]") else 1) for key, value in row.items() if "[" in key}
    return {"name": name, "boiler": "furnace of the shipped cases", "load": float(row["load"]) * factor, "inputs": inputs}


def ask(scenario, name, note):
    """Keeps the operating point and asks ELROM about it. @return the run's number"""
    status, kept = call("POST", "/scenarios", {**scenario, "name": name, "note": note})
    assert status == 201, kept
    status, run = call("POST", "/runs", {"scenario": kept["id"], "model": "elrom"})
    assert status == 201, run
    return run["id"]


def ended(run, patience_s):
    """The run once no master works on it any more, or as it is when patience ends."""
    end = time.monotonic() + patience_s
    while True:
        now = call("GET", f"/runs/{run}")[1]
        if now["state"] not in ("waiting", "running") or time.monotonic() > end:
            return now
        time.sleep(0.2)


def result_of(run):
    items = call("GET", f"/scenarios/{run['scenario']}/results")[1]["items"]
    return next(item for item in items if item["run"] == run["id"])


def told(what, words):
    print(f"{what:<34}{words}", flush=True)


def inside():
    run = ended(ask(shipped_case("load_064"), "64 % load", "not trained on"), 60)
    result = result_of(run)
    told("64 % load", f"{result['verdict']}: ELROM answered, fields {result['fields'][:12]}")
    return result


def much_primary_air():
    """The operating point of the shipped OpenFOAM case with a third more primary air than its others make usual."""
    shipped = ROOT / "data/formats/instants/averages.h5"
    told_of = json.loads(subprocess.run(["elrom-data", "inspect", "--json", shipped], capture_output=True, check=True).stdout)
    inputs = {f"{one['name']} [{one['unit']}]": one["value"] for one in told_of["inputs"]}
    return {"boiler": "furnace of the shipped cases", "load": 0.7, "inputs": {**inputs, "primary_air [kg/s]": 235}}


def outside():
    """ELROM does not answer: EL3D is asked, and what it finds is learned."""
    what = "70 % load, much primary air"
    run = ended(ask(much_primary_air(), what, "the shipped OpenFOAM case, but for its primary air"), 60)
    result = result_of(run)
    told(what, f"{result['verdict']}: {result['reason']}")
    el3d = call("GET", f"/runs/{result['followed_by'][0]}")[1]
    if not shutil.which("MPPICFoam"):
        told("  EL3D", f"run {el3d['id']} is {el3d['state']}: install MPPICFoam (Debian: apt install openfoam), then start its master")
        return
    print("  EL3D works, some 15 s of processor time ...", flush=True)
    el3d = ended(el3d["id"], 1800)
    told("  EL3D", el3d["state"] + (f": {el3d['reason']}" if el3d["reason"] else ""))
    if el3d["state"] == "done":
        learned(result_of(el3d))


def learned(simulated):
    told("  its fields", f"{simulated['version']}, fields {simulated['fields'][:12]}")
    build = ended(simulated["followed_by"][0], 600)
    told("  elrom-build", build["reason"] or result_of(build)["reason"])


def corrupted(file):
    """A file of fields as a broken disk returns it: some bytes of the pressure are erased."""
    inputs = shipped_case("load_064")["inputs"]
    answer = call("POST", "/predictions", {"inputs": inputs, "fields": ["pressure"]}, accept="application/octet-stream")[1]
    begin = 8 + int.from_bytes(answer[:8], "little")  # behind the header: float32, as in the file
    at = file.index(answer[begin:begin + 64])
    return file[:at] + b"\xff" * 64 + file[at + 64:]


def mistakes(good):
    point = shipped_case("load_064")
    point["inputs"]["primary_air [kg/s]"] = -168.4
    status, problem = call("POST", "/scenarios", {**point, "name": "sensor"})
    told("a wrong sensor", f"stopped ({status}): {problem['detail']}; {problem['quarantine']}")

    status, kept = call("POST", "/scenarios", {**shipped_case("load_098", 1.4), "name": "140 % load"})
    told("a load out of range", f"marked ({status}): {kept['verdict']}, {kept['reason']}")

    fields = corrupted(call("GET", "/fields/" + good["fields"])[1])
    digest = hashlib.sha256(fields).hexdigest()
    status, problem = call("PUT", "/fields/" + digest, fields, "application/x-hdf5")
    told("a corrupt file of fields", f"stopped ({status}): {problem['detail']}; {problem['quarantine']}")


def main():
    good = inside()
    mistakes(good)
    outside()
    counts = [line for line in call("GET", "/metrics")[1].decode().splitlines() if line.startswith("elrom_runs_")]
    told("runs", ", ".join(line.removeprefix("elrom_runs_") for line in counts if not line.endswith(" 0")))
    told("quarantine", ", ".join(one["kind"] for one in call("GET", "/quarantine")[1]["items"]))


main()
