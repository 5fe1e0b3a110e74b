#include "system/process.h"

#include <windows.h>
// After the header that it needs.
#include <psapi.h>

#include <algorithm>

#include "system/child.h"
#include "system/paths.h"

namespace raysheaf::system {

std::uint64_t memory_bytes() {
  MEMORYSTATUSEX status = {};
  status.dwLength = sizeof status;
  return GlobalMemoryStatusEx(&status) != 0 ? status.ullTotalPhys : 0;
}

std::uint64_t peak_memory_bytes() {
  PROCESS_MEMORY_COUNTERS counters = {};
  const BOOL known = GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters);
  return known != 0 ? counters.PeakWorkingSetSize : 0;
}

/// GetVersion reports an old Windows to programs that do not declare a newer one, so the registry.
std::string registry_text(const wchar_t* key, const wchar_t* name) {
  wchar_t text[256];
  DWORD bytes = sizeof text;
  if (RegGetValueW(HKEY_LOCAL_MACHINE, key, name, RRF_RT_REG_SZ, nullptr, text, &bytes) != 0)
    return {};
  return text_of(std::filesystem::path(text));
}

std::string system_name() {
  const std::string build =
      registry_text(L"SOFTWARE\\Microsoft\\Windows NT\\CurrentVersion", L"CurrentBuildNumber");
  return "Windows " + (build.empty() ? "" : "build " + build + " ") + "on x86_64";
}

std::string processor_name() {
  const std::string name =
      registry_text(L"HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0", L"ProcessorNameString");
  return name.empty() ? "x86_64" : name;
}

void advise_large_pages(void* /*memory*/, std::size_t /*bytes*/) {}

std::uint64_t process_number() {
  return GetCurrentProcessId();
}

std::string program_path() {
  std::wstring path(1u << 15, L'\0');  // no path is longer
  path.resize(GetModuleFileNameW(nullptr, path.data(), static_cast<DWORD>(path.size())));
  return text_of(path);
}

void become(const std::string& program, const std::vector<std::string>& words) {
  std::vector<std::string> given = words;
  given.front() = program;
  Child child(given, Child::Input::kShared);
  if (child.failure() == 0) ExitProcess(static_cast<UINT>(child.wait()));
}

void* load_library(const std::string& path, std::string* why) {
  void* const library = LoadLibraryW(path_of(path).c_str());
  if (library == nullptr) *why = "Windows gives error " + std::to_string(GetLastError());
  return library;
}
void* symbol_of(void* library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name));
}
void unload_library(void* library) {
  FreeLibrary(static_cast<HMODULE>(library));
}

void watch_forks(void (* /*before*/)(), void (* /*in_parent*/)(), void (* /*in_child*/)()) {}

}  // namespace raysheaf::system
