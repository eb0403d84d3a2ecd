"""Installs the package by setuptools, as colcon does with packages of ROS 2; pip builds it by ``../pyproject.toml``."""

import shutil
from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ElementTree.parse(Path(__file__).with_name("package.xml")).getroot()


class WithCollection(build_py):
    """Also copies files that are no modules, the robots and the schemas to where the wheel has them."""

    def run(self) -> None:
        """Copy the modules, then those files."""
        super().run()
        package, collection = Path(self.build_lib, "eurdf"), Path(self.build_lib, "eurdf", "collection")
        reference = ROOT / "reference" / "eurdf"
        files = [(path, package / path.relative_to(reference)) for path in reference.rglob("*.*")]
        patterns = "robots/collection.json", "robots/*/robot*.urdf", "robots/*/robot*.yaml", "robots/*/README.md"
        for pattern in (*patterns, "schema/*.schema.json"):
            files += [(path, collection / path.relative_to(ROOT)) for path in ROOT.glob(pattern)]
        for source, target in files:
            if source.is_file() and source.suffix not in (".py", ".pyc"):
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target)


setup(
    name=PACKAGE.findtext("name"),
    version=PACKAGE.findtext("version"),
    description=PACKAGE.findtext("description"),
    license=PACKAGE.findtext("license"),
    author=PACKAGE.findtext("author"),
    package_dir={"": "../reference"},
    packages=find_packages("../reference", include=["eurdf", "eurdf.*"]),
    entry_points={"console_scripts": ["eurdf = eurdf.__main__:start"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/eurdf"]),
        ("share/eurdf", ["package.xml"]),
    ],
    cmdclass={"build_py": WithCollection},
    zip_safe=False,
)
