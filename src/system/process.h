// This process and the machine that it runs on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace raysheaf::system {

/// Bytes of main memory; 0: unknown.
[[nodiscard]] std::uint64_t memory_bytes();
/// The most bytes of main memory that this process has had.
[[nodiscard]] std::uint64_t peak_memory_bytes();
/// The system and its version, and the architecture of the machine: "Linux 6.1.0 on x86_64".
[[nodiscard]] std::string system_name();
/// The name of the processor's model, or else of its architecture.
[[nodiscard]] std::string processor_name();
/// Asks for large pages. Only a hint: nothing depends on its success.
void advise_large_pages(void* memory, std::size_t bytes);

/// Different in two processes that run at once on one machine, a child of fork among them.
[[nodiscard]] std::uint64_t process_number();
/// The path of the program that runs; empty: unknown.
[[nodiscard]] std::string program_path();
/// Goes on as another program, whose path is known: its words begin with its name. Returns only if
/// that fails.
void become(const std::string& program, const std::vector<std::string>& words);

/// A shared library, loaded until the process ends or it is unloaded; null with a reason in `why`.
/// It sees its own symbols and those of its dependencies before the same names elsewhere.
[[nodiscard]] void* load_library(const std::string& path, std::string* why);
/// Null: it has none of this name.
[[nodiscard]] void* symbol_of(void* library, const char* name);
void unload_library(void* library);

/// Calls these functions at every fork from now on; they may be null. Windows has no fork.
void watch_forks(void (*before)(), void (*in_parent)(), void (*in_child)());

}  // namespace raysheaf::system
