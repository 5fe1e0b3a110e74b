# Cross-compiles for Linux on aarch64 with Debian's g++-aarch64-linux-gnu: the preset `aarch64`. The
# libraries of that architecture are in build/aarch64-root, where `tools/aarch64` unpacks Debian's
# packages; without that folder, those that `dpkg --add-architecture arm64` installs are used.
# Programs that the build or a test starts run under qemu-user, if it is installed.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

get_filename_component(root ${CMAKE_CURRENT_LIST_DIR}/../build/aarch64-root ABSOLUTE)
set(packages /usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig)
set(emulator_options "")
if(EXISTS ${root}/usr/include)
  set(CMAKE_SYSROOT ${root})
  string(REPLACE "/usr" "${root}/usr" packages ${packages})
  set(ENV{PKG_CONFIG_SYSROOT_DIR} ${root})
  set(emulator_options -L ${root})
endif()
set(ENV{PKG_CONFIG_LIBDIR} ${packages})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

find_program(RAYSHEAF_QEMU NAMES qemu-aarch64-static qemu-aarch64)
if(RAYSHEAF_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${RAYSHEAF_QEMU} ${emulator_options})
endif()
