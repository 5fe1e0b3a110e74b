#include "system/process.h"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <fstream>

#ifdef __APPLE__
#include <mach-o/dyld.h>
#endif

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RAYSHEAF_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RAYSHEAF_SANITIZED
#endif

namespace raysheaf::system {

std::uint64_t memory_bytes() {
  const auto pages = static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PHYS_PAGES)));
  return pages * static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PAGESIZE)));
}

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  constexpr std::uint64_t kUnit = 1;
#else
  constexpr std::uint64_t kUnit = 1024;
#endif
  return static_cast<std::uint64_t>(usage.ru_maxrss) * kUnit;
}

std::string system_name() {
  utsname system{};
  uname(&system);
  return std::string(system.sysname) + " " + system.release + " on " + system.machine;
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  utsname system{};
  uname(&system);
  return system.machine;
}

void advise_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  static_cast<void>(madvise(memory, bytes, MADV_HUGEPAGE));
#endif
}

std::uint64_t process_number() {
  return static_cast<std::uint64_t>(::getpid());
}

std::string program_path() {
  std::string path(PATH_MAX, '\0');
#ifdef __APPLE__
  auto room = static_cast<std::uint32_t>(path.size());
  path.resize(_NSGetExecutablePath(path.data(), &room) == 0 ? path.find('\0') : 0);
#else
  const ssize_t size = ::readlink("/proc/self/exe", path.data(), path.size());
  path.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
#endif
  return path;
}

void become(const std::string& program, const std::vector<std::string>& words) {
  std::vector<char*> given;
  given.reserve(words.size() + 1);
  for (const std::string& word : words) given.push_back(const_cast<char*>(word.c_str()));
  given.push_back(nullptr);
  ::execv(program.c_str(), given.data());
}

void* load_library(const std::string& path, std::string* why) {
  int flags = RTLD_NOW | RTLD_LOCAL;
#if defined(RTLD_DEEPBIND) && !defined(RAYSHEAF_SANITIZED)
  flags |= RTLD_DEEPBIND;  // sanitizers do not support it
#endif
  void* const library = ::dlopen(path.c_str(), flags);
  if (library != nullptr) return library;
  const char* const text = ::dlerror();
  *why = text != nullptr ? text : "the reason is unknown";
  if (why->starts_with(path + ": ")) why->erase(0, path.size() + 2);
  return nullptr;
}
void* symbol_of(void* library, const char* name) {
  return ::dlsym(library, name);
}
void unload_library(void* library) {
  ::dlclose(library);
}

void watch_forks(void (*before)(), void (*in_parent)(), void (*in_child)()) {
  pthread_atfork(before, in_parent, in_child);
}

}  // namespace raysheaf::system
