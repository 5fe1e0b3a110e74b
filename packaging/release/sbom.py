"""Writes the software bill of materials of a release as CycloneDX JSON.

sbom.py [--linked FOLDER] VERSION TIME PROGRAM...

Components are Debian's packages of the libraries that the built programs load, those that are
compiled into them, and what is compiled into the Python module. FOLDER has Debian's source packages,
unpacked, whose libraries are linked into wheels (packaging/wheel/libraries.sh). TIME is that of the
commit, as in 2026-11-27T10:00:00Z: the same build makes the same file.
"""

import argparse
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


def licenses_in(file):
    """The names in the machine-readable part of a copyright file of Debian, or else its whole text."""
    text = file.read_text(encoding="utf-8", errors="replace")
    names = re.findall(r"^License: *(\S[^\n]*)$", text, re.M)
    if names:
        return [{"license": {"name": name}} for name in sorted(set(names))]
    return [{"license": {"name": f"as in {file.name}", "text": {"content": text}}}]


def component(purl, name, version, licenses, **properties):
    return {
        "type": "library", "bom-ref": purl, "name": name, "version": version, "purl": purl, "licenses": licenses,
        "properties": [{"name": key.replace("_", ":"), "value": value} for key, value in properties.items()],
    }


def debian_purl(name, version, architecture):
    system = platform.freedesktop_os_release()
    distro = f"{system['ID']}-{system['VERSION_ID']}"
    return f"pkg:deb/{system['ID']}/{name}@{quote(version, safe='')}?arch={architecture}&distro={distro}"


def installed_package(package, use):
    fields = output_of("dpkg-query", "-W", "-f", "${Package} ${Version} ${Architecture} ${source:Package}", package)
    name, version, architecture, source = fields.split()
    licenses = licenses_in(Path("/usr/share/doc", name, "copyright"))
    return component(debian_purl(name, version, architecture), name, version, licenses,
                     debian_source=source, raysheaf_use=use)


def source_package(dsc):
    fields = dict(re.findall(r"^(Source|Version): (\S+)$", dsc.read_text(encoding="utf-8"), re.M))
    name, version = fields["Source"], fields["Version"]
    copyrights = [*dsc.parent.glob(f"{name}-*/debian/copyright"), *dsc.parent.glob(f"{name}-*/COPYING")]
    return component(debian_purl(name, version, "source"), name, version, licenses_in(copyrights[0]),
                     raysheaf_use="linked into wheels")


def python_package(list, package, name, license, use):
    """The part of a Python package that raysheaf contains, at the version in a list of requirements."""
    version = re.search(rf"^{package}==(\S+)", (ROOT / list).read_text(encoding="utf-8"), re.M).group(1)
    purl = f"pkg:pypi/{package}@{version}"
    return component(purl, name, version, [{"expression": license}], raysheaf_use=use)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--linked", type=Path)
    for name in ("version", "time"):
        parser.add_argument(name)
    parser.add_argument("programs", nargs="+")
    given = parser.parse_args()
    version = given.version
    listed = LIST.read_text(encoding="utf-8")
    strangers = [name for name in COMPILED_IN if not re.search(rf"^{name}\s", listed, re.M)]
    if strangers:
        sys.exit(f"sbom.py: {LIST.name} does not list {', '.join(strangers)}")
    components = [installed_package(p, "loaded") for p in loaded_packages(given.programs)]
    components += [installed_package(p, "compiled in") for p in COMPILED_IN]
    components.append(python_package("python/requirements-check.txt", "nanobind", "nanobind", "BSD-3-Clause",
                                     "compiled into the Python module"))
    if given.linked:
        components += [source_package(dsc) for dsc in sorted(given.linked.glob("*.dsc"))]
        components.append(python_package("packaging/wheel/requirements-target.txt", "ziglang", "libcxx",
                                         "Apache-2.0 WITH LLVM-exception", "linked into wheels"))
    this = {
        "type": "application", "bom-ref": f"pkg:generic/raysheaf@{version}", "name": "raysheaf",
        "version": version, "purl": f"pkg:generic/raysheaf@{version}",
        "licenses": [{"license": {"id": "Apache-2.0"}}],
    }
    bill = {
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, json.dumps(components) + version)}",
        "metadata": {"timestamp": given.time, "component": this},
        "components": components,
        "dependencies": [{"ref": this["bom-ref"], "dependsOn": [c["bom-ref"] for c in components]}],
    }
    print(json.dumps(bill, indent=2))


if __name__ == "__main__":
    main()
