"""`conan create packaging/conan --build=missing`, from the root of a checkout."""

import os

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy
from conan.tools.gnu import PkgConfigDeps

ROOT = os.path.join("..", "..")


class Raysheaf(ConanFile):
    name = "raysheaf"
    version = "0.1.0"
    license = "Apache-2.0"
    description = "Ray tracing through moving geometry with a hierarchy over the rays"
    topics = ("ray-tracing", "rendering", "geometry")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "tools": [True, False]}
    default_options = {"shared": False, "fPIC": True, "tools": False}

    def export_sources(self):
        root = os.path.join(self.recipe_folder, ROOT)
        for pattern in (
            "CMakeLists.txt", "LICENSE", "CHANGELOG.md",
            "cmake/*", "include/*", "src/*", "io/*", "apps/*", "packaging/debian/*",
        ):
            copy(self, pattern, root, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def validate(self):
        check_min_cppstd(self, 20)

    def requirements(self):
        self.requires("highway/1.0.7")
        self.requires("libdeflate/1.19")
        self.requires("libepoxy/1.5.10")
        self.requires("libjpeg-turbo/3.0.2")
        self.requires("libpng/1.6.43")
        self.requires("draco/1.5.6")
        self.requires("meshoptimizer/0.20")
        self.requires("nlohmann_json/3.11.3")
        self.requires("onetbb/2021.12.0")
        self.requires("stb/cci.20230920")
        self.requires("tinyexr/1.0.7")
        self.requires("tinyobjloader/2.0.0-rc10")
        self.requires("xxhash/0.8.2")
        self.requires("zstd/1.5.5")
        if self.options.tools:
            self.requires("cli11/2.4.2")
            self.requires("fmt/10.2.1")
            self.requires("kainjow-mustache/4.1")

    def generate(self):
        CMakeDeps(self).generate()
        PkgConfigDeps(self).generate()  # libepoxy is looked for by pkg-config
        toolchain = CMakeToolchain(self)
        toolchain.variables["RAYSHEAF_APP"] = bool(self.options.tools)
        for part in ("TESTS", "BENCH", "EXAMPLES"):
            toolchain.variables[f"RAYSHEAF_{part}"] = False
        for part in ("CUDA", "MPI", "PYTHON"):
            toolchain.variables[f"RAYSHEAF_{part}"] = "OFF"
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()

    def package_info(self):
        self.cpp_info.libs = ["raysheaf"]
        self.cpp_info.set_property("cmake_file_name", "raysheaf")
        self.cpp_info.set_property("cmake_target_name", "raysheaf::raysheaf")
        self.cpp_info.set_property("pkg_config_name", "raysheaf")
