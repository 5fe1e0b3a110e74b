#include "lab/commands/compare/embree_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "raysheaf/error.h"
#include "system/process.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "RAYSHEAF_EMBREE";

class Symbols {
 public:
  explicit Symbols(void* library) : library_(library) {}

  template <class Function>
  void find(Function& function, const std::string& name) {
    void* const symbol = system::symbol_of(library_, name.c_str());
    if (symbol == nullptr) complete_ = false;
    function = reinterpret_cast<Function>(symbol);
  }
  /// Looks up a symbol that one of the versions does not have.
  template <class Function>
  void find_if_any(Function& function, const std::string& name) {
    function = reinterpret_cast<Function>(system::symbol_of(library_, name.c_str()));
  }
  [[nodiscard]] bool complete() const { return complete_; }

 private:
  void* library_;
  bool complete_ = true;
};

template <template <std::size_t> class Query>
void find_queries(Symbols& symbols, const std::string& verb, embree::Queries<Query>& queries) {
  symbols.find(queries.one_3, verb + "1");
  symbols.find(queries.eight_3, verb + "8");
  symbols.find(queries.sixteen_3, verb + "16");
  symbols.find_if_any(queries.stream_3, verb + "NM");
  symbols.find(queries.one_4, verb + "1");
  symbols.find(queries.eight_4, verb + "8");
  symbols.find(queries.sixteen_4, verb + "16");
}

/// Whether the library has all required symbols.
bool find_api(void* library, embree::Api& api) {
  Symbols symbols(library);
  symbols.find(api.new_device, "rtcNewDevice");
  symbols.find(api.release_device, "rtcReleaseDevice");
  symbols.find(api.device_property, "rtcGetDeviceProperty");
  symbols.find(api.set_error_function, "rtcSetDeviceErrorFunction");
  symbols.find(api.set_memory_function, "rtcSetDeviceMemoryMonitorFunction");
  symbols.find(api.new_scene, "rtcNewScene");
  symbols.find(api.release_scene, "rtcReleaseScene");
  symbols.find(api.set_scene_quality, "rtcSetSceneBuildQuality");
  symbols.find(api.set_scene_flags, "rtcSetSceneFlags");
  symbols.find(api.attach, "rtcAttachGeometryByID");
  symbols.find(api.commit_scene, "rtcCommitScene");
  symbols.find(api.new_geometry, "rtcNewGeometry");
  symbols.find(api.release_geometry, "rtcReleaseGeometry");
  symbols.find(api.set_geometry_quality, "rtcSetGeometryBuildQuality");
  symbols.find(api.share_buffer, "rtcSetSharedGeometryBuffer");
  symbols.find(api.set_instanced_scene, "rtcSetGeometryInstancedScene");
  symbols.find(api.set_transform, "rtcSetGeometryTransform");
  symbols.find(api.commit_geometry, "rtcCommitGeometry");
  find_queries(symbols, "rtcIntersect", api.intersect);
  find_queries(symbols, "rtcOccluded", api.occluded);
  return symbols.complete();
}

/// Empty if the file cannot be loaded or is not Embree; `why` is then a clause with the reason.
std::optional<EmbreeLibrary> load(const std::string& file, std::string* why) {
  std::string reason;
  void* const handle = system::load_library(file, &reason);
  if (handle == nullptr) {
    *why = "cannot be loaded: " + reason;
    return std::nullopt;
  }
  EmbreeLibrary library{file, {}};
  if (find_api(handle, library.api)) return library;
  system::unload_library(handle);
  *why = "is not Embree 3 or 4: it lacks some of their functions";
  return std::nullopt;
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::vector<EmbreeLibrary> named(const std::string& files) {
  std::vector<EmbreeLibrary> all;
  for (const std::string& file : parts_of(files)) {
    std::string why;
    std::optional<EmbreeLibrary> library = load(file, &why);
    if (!library) throw Error(ErrorCode::kIo, fmt::format("'{}' {}", file, why), kVariable);
    all.push_back(std::move(*library));
  }
  return all;
}

/// The entries of `folder`, sorted; empty if it does not exist.
std::vector<fs::path> content_of(const fs::path& folder) {
  std::vector<fs::path> all;
  std::error_code error;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error))
    all.push_back(i->path());
  std::sort(all.begin(), all.end());
  return all;
}

/// PREFIX/lib/python3*/{site,dist}-packages/embreex.libs/libembree4*
void add_wheels(const fs::path& prefix, std::vector<std::string>& files) {
  for (const fs::path& python : content_of(prefix / "lib")) {
    if (!python.filename().string().starts_with("python3")) continue;
    for (const char* packages : {"site-packages", "dist-packages"})
      for (const fs::path& file : content_of(python / packages / "embreex.libs"))
        if (file.filename().string().starts_with("libembree4")) files.push_back(file.string());
  }
}

std::vector<std::string> files_of_embree_4() {
  std::vector<std::string> files{"libembree4.so.4"};
  if (const char* environment = std::getenv("VIRTUAL_ENV")) add_wheels(environment, files);
  if (const char* home = std::getenv("HOME")) add_wheels(fs::path(home) / ".local", files);
  add_wheels("/usr/local", files);
  add_wheels("/usr", files);
  return files;
}

void add_first(const std::vector<std::string>& files, std::vector<EmbreeLibrary>* all) {
  for (const std::string& file : files) {
    std::string ignored;
    std::optional<EmbreeLibrary> library = load(file, &ignored);
    if (library) return all->push_back(std::move(*library));
  }
}

}  // namespace

std::vector<EmbreeLibrary> find_embree() {
  std::vector<EmbreeLibrary> all;
  if (const char* const files = std::getenv(kVariable)) {
    all = named(files);
  } else {
    add_first(files_of_embree_4(), &all);
    add_first({"libembree3.so.3"}, &all);
  }
  if (all.empty())
    throw Error(ErrorCode::kUnsupported,
                "no Embree is installed for the comparison: install Embree 4 or 3 or the Python "
                "wheel embreex, or name the library's file in RAYSHEAF_EMBREE",
                "bench compare");
  return all;
}

}  // namespace raysheaf::app
