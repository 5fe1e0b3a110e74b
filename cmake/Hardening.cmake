# Options that make undetected mistakes harder to exploit: bounds of C functions and of containers
# are checked where the compiler can, stacks are guarded, addresses are randomised, and relocations
# are read-only before main() begins. Tests check them in the binary.
include(CheckPIESupported)
check_pie_supported()
add_library(raysheaf_hardening INTERFACE)
target_compile_options(raysheaf_hardening INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2 -D_GLIBCXX_ASSERTIONS
    -fstack-protector-strong -fstack-clash-protection
    $<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},x86_64>:-fcf-protection>>)
target_link_options(raysheaf_hardening INTERFACE LINKER:-z,relro,-z,now,-z,noexecstack)
if(RAYSHEAF_HARDENING)
  target_link_libraries(raysheaf_options INTERFACE raysheaf_hardening)
endif()
