"""Builds the Python package's native module by CMake; CMAKE_ARGS adds options (-DELROM_NATIVE=OFF for other machines)."""
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
ONLY_PYTHON = [f"-DELROM_{name}=OFF" for name in ("TORCH", "MPI", "PAGE", "TESTS", "BENCHMARKS")]


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        build = Path(self.build_temp).resolve() / "cmake"
        configure = ["cmake", "-S", str(ROOT), "-B", str(build), "-DCMAKE_BUILD_TYPE=Release", "-DELROM_PYTHON=ON",
                     f"-DPython3_EXECUTABLE={sys.executable}", *ONLY_PYTHON]
        if shutil.which("ninja"):
            configure += ["-G", "Ninja"]
        subprocess.run([*configure, *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        subprocess.run(["cmake", "--build", str(build), "--target", "elrom-python", "--parallel"], check=True)
        built, = (build / "python" / "elrom").glob("_native*.so")
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(built, target)


# Not setuptools' own "build", which is CMake's here.
scratch = ROOT / "build-python"
scratch.mkdir(exist_ok=True)
version = re.search(r"project\(elrom VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
setup(version=version, ext_modules=[Extension("elrom._native", sources=[])], cmdclass={"build_ext": CMakeBuild},
      options={"build": {"build_base": scratch.name}, "egg_info": {"egg_base": scratch.name}})
