"""Makes a wheel of the built package. Nothing is compiled here: tools/python_wheel.sh calls it.

LUXEL_PYTHON is the folder that holds the built package, and LUXEL_SOURCE that of luxel's source. The wheel works where
the libraries are installed that luxel uses; tools/setup.sh names their packages.
"""
import os
import pathlib
import re
import shutil
import sysconfig

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = pathlib.Path(os.environ["LUXEL_SOURCE"])


class TakeBuilt(build_ext):
    def build_extension(self, extension):
        suffix = sysconfig.get_config_var("EXT_SUFFIX")  # a module is for one version of Python
        built = list(pathlib.Path(os.environ["LUXEL_PYTHON"]).glob("luxel/_luxel" + suffix))
        if len(built) != 1:
            raise SystemExit("LUXEL_PYTHON has no luxel/_luxel" + suffix + "; `make python` builds it for the Python that CMake finds")
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(built[0], target.parent / built[0].name)


setup(
    version=re.search(r"project\(luxel VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())[1],
    packages=["luxel"],
    package_data={"luxel": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("luxel._luxel", sources=[])],
    cmdclass={"build_ext": TakeBuilt},
)
