"""The shipped case of MPPICFoam (OpenFOAM v1912, data/formats/instants/case) as one that can be run, and its plane profiles.

The files that the shipped case lacks (system, models of the cloud) are written here. Solids cannot leave: v1912 has no model
that returns them to the furnace, as the shipped case did."""
import gzip
import json
import os
import pathlib
import random
import re
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHIPPED = ROOT / "data/formats/instants"
FOAM_FOLDERS = ("/usr/share/openfoam",)
FIELDS = {"pressure": "Pa", "solid_volume_fraction": "1", "gas_velocity_z": "m/s", "solid_velocity_z": "m/s",
          "solid_diameter": "m"}
STEP_S, WRITE_S = 0.03, 0.4
PARCELS, HEIGHT_M, TAPER_M = 10000, 47.0, 47 * 6 / 33
N_PLANES, N_COLUMNS = 33, 210

CONTROL = """application MPPICFoam; startFrom startTime; startTime 0; stopAt endTime; endTime {seconds}; deltaT {step};
writeControl adjustableRunTime; writeInterval {write}; writeFormat ascii; writePrecision 7; timePrecision 6;
runTimeModifiable no; adjustTimeStep no;
"""
SCHEMES = """ddtSchemes {default Euler;} gradSchemes {default Gauss linear;} interpolationSchemes {default linear;}
divSchemes {default none; div(alphaPhi.air,U.air) Gauss upwind;
  div(((alpha.air*nuEff.air)*dev2(T(grad(U.air))))) Gauss linear; div(phiGByA,kinematicCloud:alpha) Gauss linear;}
laplacianSchemes {default Gauss linear corrected;} snGradSchemes {default corrected;}
"""
SOLUTION = """solvers {
  p {solver GAMG; tolerance 1e-5; relTol 0.01; smoother GaussSeidel;} pFinal {$p; relTol 0.001;}
  "(U.air.*|kinematicCloud:alpha)" {solver smoothSolver; smoother symGaussSeidel; tolerance 1e-6; relTol 0.1;} }
PIMPLE {nOuterCorrectors 1; nCorrectors 2; momentumPredictor yes; nNonOrthogonalCorrectors 0;}
relaxationFactors {equations {".*" 1;}}
"""
# Explicit packing with averages between cells and nodes: with cell averages the bed falls into piles and gas passes
# between them; with implicit packing the run diverges within 3 s.
CLOUD = """solution {{active true; coupled true; transient yes; cellValueSourceCorrection off; maxCo 0.5;
  interpolationSchemes {{rho.air cell; U.air cellPoint; mu.air cell; alpha.air cell;}}
  averagingMethod dual; integrationSchemes {{U Euler;}} sourceTerms {{schemes {{U semiImplicit 1;}}}}}}
constantProperties {{rho0 2400; alphaMax 0.9;}}
subModels {{
  particleForces {{ErgunWenYuDrag {{alphac alpha.air;}} gravity;}}
  injectionModels {{{injection}}}
  dispersionModel none; patchInteractionModel localInteraction;
  localInteractionCoeffs {{patches (".*" {{type rebound; e 0.9; mu 0.1;}});}}
  heatTransferModel none; surfaceFilmModel none; stochasticCollisionModel none; radiation off;
  packingModel explicit;
  explicitCoeffs {{particleStressModel {{type HarrisCrighton; alphaPacked 0.6; pSolid 10; beta 2; eps 1e-7;}}
    correctionLimitingMethod {{type absolute; e 0.9;}}}}
  dampingModel none; isotropyModel none;}}
cloudFunctions {{}}
"""
INJECTION = """bed {{type manualInjection; massTotal {inventory}; parcelBasisType mass; SOI 0; positionsFile "positions";
  U0 (0 0 0); sizeDistribution {{type normal; normalDistribution {{expectation {d50}; variance {spread}; minValue {least};
  maxValue {most};}}}}}}"""


def installed_foam():
    """Folder of OpenFOAM's own settings; None: it is not installed."""
    folder = os.environ.get("WM_PROJECT_DIR") or next((path for path in FOAM_FOLDERS if os.path.isdir(path)), None)
    return folder if shutil.which("MPPICFoam") else None


def write(path, class_name, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"FoamFile{{version 2.0;format ascii;class {class_name};object {path.name};}}\n{text}")


def read(path):
    packed = path.with_name(path.name + ".gz")
    return gzip.open(packed, "rt").read() if packed.exists() else path.read_text()


def operating_point(tools):
    """Inputs of the shipped case, name -> (value, unit), as it has them."""
    done = subprocess.run([tools / "elrom-data", "inspect", "--json", SHIPPED / "averages.h5"], capture_output=True,
                          text=True, check=True)
    return {item["name"]: (item["value"], item["unit"]) for item in json.loads(done.stdout)["inputs"]}


def in_si(inputs, name):
    value, unit = inputs[name]
    return value * {"1": 1, "t": 1e3, "kg": 1, "um": 1e-6, "mm": 1e-3, "m": 1}[unit]


def make_case(case, inputs, seconds, bed_m=None, seed=1):
    """The shipped case with gas at rest and all that a run needs. `bed_m`: solids lie at random below this height;
    None: they are to come from a time folder."""
    for packed in (SHIPPED / "case/constant").rglob("*.gz"):
        target = case / "constant" / packed.relative_to(SHIPPED / "case/constant").with_suffix("")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(gzip.decompress(packed.read_bytes()))
    for name, text in (("controlDict", CONTROL.format(seconds=seconds, step=STEP_S, write=WRITE_S)),
                       ("fvSchemes", SCHEMES), ("fvSolution", SOLUTION)):
        write(case / "system" / name, "dictionary", text)
    write(case / "constant/turbulenceProperties.air", "dictionary", "simulationType laminar;\n")
    injection = ""
    if bed_m:
        d50 = in_si(inputs, "solids_d50")
        injection = INJECTION.format(inventory=in_si(inputs, "solids_inventory"), d50=d50, least=0.35 * d50, most=2 * d50,
                                     spread=in_si(inputs, "solids_spread") * d50)
        write(case / "constant/positions", "vectorField", places(random.Random(seed), bed_m))
    write(case / "constant/kinematicCloudProperties", "dictionary", CLOUD.format(injection=injection))
    make_gas_at_rest(case)


def make_gas_at_rest(case):
    patches = read(SHIPPED / "case/13/U.air")
    patches = patches[patches.index("boundaryField"):]
    patches = re.sub(r"value\s+nonuniform List<vector>\s*\d+\s*\((\s*\([^)]*\))*\s*\)", "value uniform (0 0 0)", patches)
    write(case / "0/U.air", "volVectorField", "dimensions [0 1 -1 0 0 0 0];\ninternalField uniform (0 0 0);\n" + patches)
    write(case / "0/p", "volScalarField",
          'dimensions [0 2 -2 0 0 0 0];\ninternalField uniform 0;\nboundaryField {".*" {type fixedFluxPressure; '
          "gradient uniform 0; value uniform 0;} outlet {type fixedValue; value uniform 0;}}\n")


def places(dice, bed_m):
    """Uniform in the volume below `bed_m`: heights are kept as often as the furnace is wide there."""
    lines, edge = [], 0.02
    while len(lines) < PARCELS:
        z = dice.uniform(edge, bed_m - edge)
        half = 2.65 * (1 + min(1, z / TAPER_M))
        if dice.uniform(0, 5.3) < half:
            lines.append(f"({dice.uniform(5.3 - half + edge, 5.3 + half - edge):.5f} {dice.uniform(edge, 27.6 - edge):.5f} {z:.5f})")
    return f"{PARCELS}\n(\n" + "\n".join(lines) + "\n)\n"


def simulate(case, foam):
    """Runs MPPICFoam. @return processor seconds"""
    with open(case / "log", "w") as log:
        done = subprocess.run(["MPPICFoam", "-case", case], stdout=log, stderr=subprocess.STDOUT,
                              env={**os.environ, "WM_PROJECT_DIR": foam})
    text = (case / "log").read_text()
    if done.returncode != 0 or not text.rstrip().endswith("End"):
        raise SystemExit(f"MPPICFoam failed in {case}, see log there")
    return float(re.findall(r"ExecutionTime = ([\d.]+) s", text)[-1])


def entries(path):
    """Lines of a file's list, one an entry."""
    text = read(path)
    at = text.find("internalField")
    text = text[at if at >= 0 else text.index("// * *"):]
    return text[text.index("\n(\n") + 3:text.index("\n)\n")].split("\n")


def time_folders(case):
    """Those of a running case, without its start, in order."""
    found = [folder for folder in case.iterdir() if re.fullmatch(r"\d+(\.\d+)?", folder.name) and float(folder.name) > 0]
    return sorted(found, key=lambda folder: float(folder.name))


def profiles(case):
    """[(time, {field: (sums by plane, weights by plane)})] of all instants but the start: a mean is their ratio."""
    density = float(re.search(r"rho\.air ([\d.]+);", read(SHIPPED / "case/constant/transportProperties"))[1])
    return [(float(folder.name), {**gas_sums(folder, density), **solids_sums(folder / "lagrangian/kinematicCloud")})
            for folder in time_folders(case)]


def gas_sums(folder, density):
    values = {"pressure": [density * float(v) for v in entries(folder / "p")],
              "solid_volume_fraction": [1 - float(v) for v in entries(folder / "alpha.air")],
              "gas_velocity_z": [float(v[:-1].split()[2]) for v in entries(folder / "U.air")]}
    return {name: ([sum(cells[k * N_COLUMNS:(k + 1) * N_COLUMNS]) for k in range(N_PLANES)], [N_COLUMNS] * N_PLANES)
            for name, cells in values.items()}


def solids_sums(cloud):
    """Weighted by the parcels' mass over the material's density."""
    mass, upward, diameter = ([0.0] * N_PLANES for _ in range(3))
    columns = (entries(cloud / name) for name in ("coordinates", "U", "d", "nParticle"))
    for place, velocity, d, count in zip(*columns, strict=True):
        plane, size = int(place.split(")")[1].split()[0]) // N_COLUMNS, float(d)
        m = float(count) * size ** 3
        mass[plane] += m
        upward[plane] += m * float(velocity[:-1].split()[2])
        diameter[plane] += m * size
    return {"solid_velocity_z": (upward, mass), "solid_diameter": (diameter, mass)}
