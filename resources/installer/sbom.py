"""Write the bill of materials of the program: its libraries, with versions and licences, as CycloneDX.

    python resources/installer/sbom.py FILE.json

It is that of the environment which runs this; tools for development are left out.
"""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path

import contents
import licences
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.model.license import DisjunctiveLicense, LicenseExpression
from cyclonedx.output.json import JsonV1Dot6
from packageurl import PackageURL


def bill_of_materials() -> Bom:
    """Bill of the program, of Python, and of each library that the program needs."""
    program = Component(
        name="apd-viewer",
        version=contents.version(),
        type=ComponentType.APPLICATION,
        licenses=[LicenseExpression("MIT")],
    )
    python = Component(
        name="CPython",
        version=".".join(map(str, sys.version_info[:3])),
        type=ComponentType.PLATFORM,
        licenses=[LicenseExpression("PSF-2.0")],
    )
    libraries = [_component(library) for library in licences.libraries()]
    bill = Bom(components=[python, *libraries])
    bill.metadata.component = program
    bill.register_dependency(program, [python, *libraries])
    return bill


def _component(library: metadata.Distribution) -> Component:
    name = library.metadata["Name"]
    expression = library.metadata.get("License-Expression")
    licence = (
        LicenseExpression(expression) if expression else DisjunctiveLicense(name=licences.licence(library))
    )
    url = PackageURL("pypi", None, name.lower().replace("_", "-"), library.version)
    return Component(name=name, version=library.version, purl=url, bom_ref=str(url), licenses=[licence])


def write(path: Path) -> None:
    """Write the bill as JSON."""
    path.write_text(JsonV1Dot6(bill_of_materials()).output_as_string(indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
