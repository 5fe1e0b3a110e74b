// Chooses the loader by a file's extension, and adds the file's name to its errors.
#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "io/file.h"
#include "io/file_kind.h"
#include "io/file_parts.h"
#include "io/float_spacing.h"
#include "io/gltf.h"
#include "io/load.h"
#include "io/obj.h"
#include "io/ply.h"
#include "io/refuse.h"
#include "io/sequence.h"
#include "io/stl.h"
#include "raysheaf/animation.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// Loads a format without animation.
template <SceneDescription (*kLoad)(const io::Bytes&, const io::SceneFile&)>
io::GltfScene load_still(const io::Bytes& file, const io::SceneFile& from) {
  io::GltfScene loaded;
  loaded.scene = kLoad(file, from);
  return loaded;
}

/// The list of all formats, by the extension of the file name.
struct Format {
  std::string_view ending;
  io::GltfScene (*load)(const io::Bytes& file, const io::SceneFile& from);
};
constexpr std::array kFormats{Format{".gltf", io::load_gltf}, Format{".glb", io::load_gltf},
                              Format{".obj", load_still<io::load_obj>},
                              Format{".ply", load_still<io::load_ply>},
                              Format{".stl", load_still<io::load_stl>}};

/// `ending`: without its dot. Null if no format has it.
const Format* format_of(const std::string& ending) {
  const auto* const at = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) {
    return format.ending.substr(1) == ending;
  });
  return at == kFormats.end() ? nullptr : at;
}

/// Why a file with this extension is not a static scene.
std::string why_not(const std::string& path, const std::string& ending) {
  if (ending == "rsb") return "block files are for streaming and cannot be loaded whole";
  if (ending == "json") return "a sequence of files is not a static scene";
  const io::FileReader file(path);
  io::Bytes head(std::min<std::uint64_t>(file.size(), io::kKindBytes));
  file.read(0, head, path);
  if (const io::FileKind* kind = io::kind_of(head, ending)) return "is " + described(*kind);
  return "the ending is none of " + scene_file_endings_text() +
         ", nor .rsb (blocks) or .json (a sequence)";
}

/// Throws if a file's first bytes belong to another format than its extension. A binary STL may
/// begin with any bytes and is recognised by its length.
void check_kind(const io::Bytes& file, const std::string& ending, const std::string& path) {
  const io::FileKind* kind = io::kind_by_content(file);
  if (kind == nullptr || (ending == "stl" && io::may_be_stl(file))) return;
  if (ending == "ply" && std::string_view(kind->name) == "a PLY file") return;
  std::string upper = ending;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  throw Error(ErrorCode::kInvalidData, "is not " + upper + ", but " + described(*kind), path);
}

io::GltfScene load_any(const std::string& path, const LoadOptions& options,
                       io::ImageCache* images = nullptr) {
  const std::string ending = io::ending_of(path);
  // Before the whole file is read, but not before it is known to be there.
  const Format* const format = format_of(ending);
  if (format == nullptr) {
    if (!io::file_exists(path)) static_cast<void>(io::read_file(path));  // which reports it missing
    throw Error(ErrorCode::kUnsupported, why_not(path, ending), path);
  }
  const io::Bytes file = io::read_file(path);
  if (file.empty()) throw Error(ErrorCode::kInvalidData, "the file is empty", path);
  std::set<std::string> names;
  const io::SceneFile from{path, options.allow_external, images, &names};
  if (format->load != io::load_gltf) check_kind(file, ending, path);
  io::GltfScene loaded = format->load(file, from);
  loaded.scene.files = io::files_of(from);
  for (std::string& sentence : loaded.scene.warnings) sentence = io::whole_utf8(sentence);
  return loaded;
}

SceneDescription load_at_rest(const std::string& path, const LoadOptions& options) {
  SceneDescription scene = io::at_rest(load_any(path, options));
  validate(scene);
  io::warn_of_spacing(world_bounds(scene), &scene);
  return scene;
}

/// Whether the name is a pattern rather than the name of a file.
bool is_pattern(const std::string& path) {
  return path.find_first_of("*?", path.rfind('/') + 1) != path.npos && !io::file_exists(path);
}

std::unique_ptr<Animation> load_moving(const std::string& path, const LoadOptions& options) {
  if (is_pattern(path)) {
    SequenceFiles files;
    files.frames = files_like(path);
    return load_sequence(files, options);
  }
  if (io::ending_of(path) == "json") {
    const io::Bytes file = io::read_file(path);
    auto sequence =
        load_sequence(io::read_sequence_json(file, {path, options.allow_external}), options);
    std::vector<std::string>& files = sequence->scene().files;
    files.insert(files.begin(), path);
    return sequence;
  }
  io::GltfScene loaded = load_any(path, options);
  if (loaded.rig.nodes.empty()) return animate(std::move(loaded.scene));
  return animate(std::move(loaded.scene), std::move(loaded.rig));
}

}  // namespace

std::span<const std::string_view> scene_file_endings() {
  static const auto endings = [] {
    std::array<std::string_view, kFormats.size()> all;
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = kFormats[i].ending;
    return all;
  }();
  return endings;
}

std::string scene_file_endings_text() {
  std::string text;
  for (const Format& format : kFormats)
    text += (text.empty() ? "" : ", ") + std::string(format.ending);
  return text;
}

SceneDescription io::load_part(const std::string& path, const LoadOptions& options,
                               ImageCache* images) {
  return naming(path, [&] {
    SceneDescription scene = at_rest(load_any(path, options, images));
    if (scene.triangle_count() > 0) validate(scene);
    return scene;
  });
}

SceneDescription load_scene(const std::string& path, const LoadOptions& options) {
  return io::naming(path, [&] { return load_at_rest(path, options); });
}

std::unique_ptr<Animation> load_animation(const std::string& path, const LoadOptions& options) {
  return io::naming(path, [&] {
    auto animation = load_moving(path, options);
    io::warn_of_spacing(world_bounds(animation->scene()), &animation->scene());
    return animation;
  });
}

}  // namespace raysheaf
