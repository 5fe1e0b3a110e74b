"""Writes the software bill of materials of a release as CycloneDX JSON: sbom.py VERSION TIME PROGRAM...

Components are Debian's packages of the libraries that the built programs load, those that are
compiled into them, and what is compiled into the Python module. TIME is that of the commit, as in
2026-11-27T10:00:00Z: the same build makes the same file.
"""

import json
import platform
import re
import subprocess
import sys
import uuid
from pathlib import Path
from urllib.parse import quote

ROOT = Path(__file__).resolve().parents[2]
LIST = ROOT / "cmake" / "debian-packages.txt"
# Libraries of [build] that are headers or archives: they are compiled into the programs.
COMPILED_IN = ["nlohmann-json3-dev", "libxxhash-dev", "libstb-dev", "libcli11-dev", "libkainjow-mustache-dev", "libimgui-dev"]


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def loaded_packages(programs):
    """The packages of the shared libraries that the programs load."""
    lines = "".join(output_of("ldd", program) for program in programs)
    paths = re.findall(r"=> (/\S+)", lines) + re.findall(r"^\s*(/\S+) \(", lines, re.M)
    names = {name for path in paths for name in (path, str(Path(path).resolve()))}
    found = subprocess.run(["dpkg-query", "-S", *sorted(names)], capture_output=True, text=True, check=False)
    packages = {line.split(": ")[0] for line in found.stdout.splitlines()}
    return sorted(packages)


def licenses_of(package):
    """The names in the machine-readable part of Debian's copyright file, if it has one."""
    text = Path("/usr/share/doc", package.split(":")[0], "copyright")
    if not text.exists():
        return []
    names = re.findall(r"^License: *(\S[^\n]*)$", text.read_text(encoding="utf-8", errors="replace"), re.M)
    return [{"license": {"name": name}} for name in sorted(set(names))]


def component_of(package, how):
    fields = output_of("dpkg-query", "-W", "-f", "${Package} ${Version} ${Architecture} ${source:Package}", package)
    name, version, architecture, source = fields.split()
    system = platform.freedesktop_os_release()
    purl = f"pkg:deb/{system['ID']}/{name}@{quote(version, safe='')}?arch={architecture}&distro={system['ID']}-{system['VERSION_ID']}"
    return {
        "type": "library", "bom-ref": purl, "name": name, "version": version, "purl": purl,
        "licenses": licenses_of(package),
        "properties": [{"name": "debian:source", "value": source}, {"name": "raysheaf:use", "value": how}],
    }


def nanobind():
    """The Python module contains it, at the version with which tools/wheel builds."""
    pinned = (ROOT / "python" / "requirements-check.txt").read_text(encoding="utf-8")
    version = re.search(r"^nanobind==(\S+)", pinned, re.M).group(1)
    purl = f"pkg:pypi/nanobind@{version}"
    return {
        "type": "library", "bom-ref": purl, "name": "nanobind", "version": version, "purl": purl,
        "licenses": [{"license": {"id": "BSD-3-Clause"}}],
        "properties": [{"name": "raysheaf:use", "value": "compiled into the Python module"}],
    }


def main():
    if len(sys.argv) < 4:
        sys.exit("sbom.py: VERSION, TIME and PROGRAM are expected")
    version, time, *programs = sys.argv[1:]
    listed = LIST.read_text(encoding="utf-8")
    strangers = [name for name in COMPILED_IN if not re.search(rf"^{name}\s", listed, re.M)]
    if strangers:
        sys.exit(f"sbom.py: {LIST.name} does not list {', '.join(strangers)}")
    components = [component_of(p, "loaded") for p in loaded_packages(programs)]
    components += [component_of(p, "compiled in") for p in COMPILED_IN] + [nanobind()]
    this = {
        "type": "application", "bom-ref": f"pkg:generic/raysheaf@{version}", "name": "raysheaf",
        "version": version, "purl": f"pkg:generic/raysheaf@{version}",
        "licenses": [{"license": {"id": "Apache-2.0"}}],
    }
    bill = {
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, json.dumps(components) + version)}",
        "metadata": {"timestamp": time, "component": this},
        "components": components,
        "dependencies": [{"ref": this["bom-ref"], "dependsOn": [c["bom-ref"] for c in components]}],
    }
    print(json.dumps(bill, indent=2))


if __name__ == "__main__":
    main()
