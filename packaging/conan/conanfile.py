"""`conan create packaging/conan --build=missing`, from the root of a checkout."""

import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir
from conan.tools.gnu import PkgConfigDeps

ROOT = os.path.join("..", "..")


class Raysheaf(ConanFile):
    name = "raysheaf"
    license = "Apache-2.0"
    description = "Exact ray queries and rendering for triangles that move"
    topics = ("ray-tracing", "rendering", "geometry")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "tools": [True, False]}
    # The library needs only EGL of OpenGL, without a window system.
    default_options = {
        "shared": False, "fPIC": True, "tools": False,
        "libepoxy/*:glx": False, "libepoxy/*:x11": False,
    }
    implements = ["auto_shared_fpic"]

    def set_version(self):
        project = load(self, os.path.join(self.recipe_folder, ROOT, "CMakeLists.txt"))
        self.version = re.search(r"project\(raysheaf VERSION ([0-9.]+)", project)[1]

    def export_sources(self):
        root = os.path.join(self.recipe_folder, ROOT)
        unused = (".*", "bench/*", "build/*", "docs/*", "examples/*", "out/*", "python/*", "tests/*", "tools/*")
        copy(self, "*", root, self.export_sources_folder, excludes=unused)

    def layout(self):
        cmake_layout(self)

    def validate(self):
        check_min_cppstd(self, 20)

    def requirements(self):
        self.requires("highway/[>=1.0.7 <2]")
        self.requires("libdeflate/[>=1.14 <2]")
        self.requires("libepoxy/1.5.10")
        self.requires("libjpeg-turbo/[>=3.0 <4]")
        self.requires("libpng/[>=1.6.39 <2]")
        self.requires("libwebp/[>=1.2 <2]")
        self.requires("draco/[>=1.5.6 <2]")
        self.requires("meshoptimizer/[>=0.18 <2]")
        self.requires("nlohmann_json/[>=3.11.2 <4]")
        self.requires("onetbb/[>=2021.8]")
        self.requires("openexr/[>=3.1.5 <4]")
        self.requires("stb/cci.20240531")
        self.requires("xxhash/[>=0.8.1 <1]")
        self.requires("zstd/[>=1.5 <2]")
        if self.options.tools:
            self.requires("cli11/[>=2.3 <3]")
            self.requires("fmt/[>=9.1 <13]")
            self.requires("kainjow-mustache/4.1")

    def build_requirements(self):
        self.tool_requires("pkgconf/[>=2.0 <3]")

    def generate(self):
        names = CMakeDeps(self)
        names.set_property("highway", "cmake_file_name", "hwy")
        names.set_property("highway::hwy", "cmake_target_name", "hwy::hwy")
        names.set_property("highway::hwy_contrib", "cmake_target_name", "hwy::hwy_contrib")
        names.generate()
        PkgConfigDeps(self).generate()  # pkg-config finds libepoxy, libdeflate, libwebp and zstd
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["RAYSHEAF_APP"] = bool(self.options.tools)
        for part in ("TESTS", "BENCH", "EXAMPLES", "VIEWER"):
            toolchain.cache_variables[f"RAYSHEAF_{part}"] = False
        for part in ("CUDA", "MPI", "PYTHON"):
            toolchain.cache_variables[f"RAYSHEAF_{part}"] = "OFF"
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        for folder in ("cmake", "pkgconfig"):  # Conan generates its own
            rmdir(self, os.path.join(self.package_folder, "lib", folder))

    def package_info(self):
        self.cpp_info.libs = ["raysheaf_lab", "raysheaf_paper", "raysheaf_render", "raysheaf_scenes", "raysheaf"]
        if self.settings.os == "Linux":
            self.cpp_info.system_libs = ["dl", "m", "pthread"]
        self.cpp_info.set_property("cmake_file_name", "raysheaf")
        self.cpp_info.set_property("cmake_target_name", "raysheaf::raysheaf")
        self.cpp_info.set_property("pkg_config_name", "raysheaf")
