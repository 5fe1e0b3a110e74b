#include "io/gltf_model.h"

#include <map>
#include <set>

#include "io/data_uri.h"
#include "io/gltf_draco.h"
#include "io/gltf_json.h"
#include "io/gltf_meshopt.h"
#include "io/gltf_rules.h"
#include "io/outer_mesh.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

constexpr std::uint64_t kMostOuterJson = std::uint64_t{1} << 26;

/// Fills a model from its validated JSON.
class ModelReader {
 public:
  ModelReader(GltfModel& model, const GltfParts& parts, const SceneFile& from)
      : model_(model), parts_(parts), from_(from), is_held_(parts.json.is_held()) {}

  void read() {
    const auto buffers = model_.list("buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i)
      buffers_.push_back(has_bytes(buffers[i], i, parts_)
                             ? buffer(buffers[i], element("buffers", i) + ".uri")
                             : GltfBytes());
    const auto views = model_.list("bufferViews");
    for (std::size_t i = 0; i < views.size(); ++i)
      model_.views.push_back(view(views[i], element("bufferViews", i)));
    for (const JsonValue& source : model_.list("accessors"))
      model_.accessors.push_back(accessor(source));
    unpack_primitives();
    const auto images = model_.list("images");
    for (std::size_t i = 0; i < images.size(); ++i)
      model_.images.push_back(image(images[i], element("images", i)));
  }

 private:
  /// A file may be longer than its buffer.
  GltfBytes buffer(const JsonValue& source, const std::string& place) {
    const auto said = source.at("byteLength").get<std::size_t>();
    const auto uri = source.get("uri", std::string_view());
    if (uri.empty()) return parts_.binary.subspan(0, said);
    if (is_data_uri(uri)) {
      std::optional<Bytes> bytes = decode_data_uri(uri);
      if (!bytes)
        refuse("is a data URI without a comma, or with a character that is not a base64 digit",
               place);
      if (bytes->size() < said)
        refuse("has " + std::to_string(bytes->size()) + " bytes, but the buffer needs " +
                   std::to_string(said),
               place);
      return keep(std::move(*bytes)).subspan(0, said);
    }
    const std::string path = resolve(from_, std::string(uri), true, place);
    const auto known = file_of_.find(path);
    const GltfBytes bytes = known != file_of_.end() ? known->second : opened(path);
    file_of_[path] = bytes;
    if (bytes.size() < said) {
      refuse("\"" + path + "\" has " + std::to_string(bytes.size()) +
                 " bytes, but a buffer needs " + std::to_string(said),
             place);
    }
    return bytes.subspan(0, said);
  }
  GltfBytes keep(Bytes bytes) {
    model_.file_bytes += bytes.size();
    return GltfBytes(model_.buffers.emplace_back(std::move(bytes)));
  }
  GltfBytes opened(const std::string& path) {
    if (is_held_) return keep(read_file(path));
    const GltfBytes bytes(*model_.files.emplace_back(std::make_unique<GltfFile>(path, path)));
    model_.file_bytes += bytes.size();
    return bytes;
  }

  GltfView view(const JsonValue& source, const std::string& place) {
    const auto stride = source.get("byteStride", std::size_t{0});
    const MeshoptPacking packing = meshopt_packing(source);
    if (packing.json == nullptr) return {range(source), stride};
    if (!is_held_) throw NeedsWholeFile{};
    Bytes scratch;
    const GltfBytes packed = range(*packing.json);
    return {keep(unpack_meshopt(packing, packed.read(0, packed.size(), scratch), place)), stride};
  }
  /// Decompresses primitives and fills their accessors. If primitives share accessors, the first
  /// one fills them.
  void unpack_primitives() {
    std::set<std::size_t> filled;
    const auto meshes = model_.list("meshes");
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const auto primitives = meshes[m].items("primitives");
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        const JsonValue* const packing = draco_packing(primitives[p]);
        if (packing == nullptr) continue;
        if (!is_held_) throw NeedsWholeFile{};
        Bytes scratch;
        const GltfBytes packed = model_.views[packing->at("bufferView").get<std::size_t>()].bytes;
        for (DracoValues& values :
             unpack_draco(primitives[p], model_.accessors, packed.read(0, packed.size(), scratch),
                          element("meshes", m) + "." + element("primitives", p))) {
          if (filled.insert(values.accessor).second) fill(std::move(values));
        }
      }
    }
  }
  void fill(DracoValues values) {
    GltfAccessor& accessor = model_.accessors[values.accessor];
    accessor.view = static_cast<int>(model_.views.size());
    accessor.offset = 0;
    model_.views.push_back({keep(std::move(values.bytes)), 0});
  }

  /// The bytes of the buffer that a view or its compression extension refers to.
  [[nodiscard]] GltfBytes range(const JsonValue& source) const {
    return buffers_[source.at("buffer").get<std::size_t>()].subspan(
        source.get("byteOffset", std::size_t{0}), source.at("byteLength").get<std::size_t>());
  }

  [[nodiscard]] GltfAccessor accessor(const JsonValue& source) const {
    GltfAccessor result;
    result.view = source.get("bufferView", -1);
    result.offset = source.get("byteOffset", std::size_t{0});
    result.count = source.at("count").get<std::size_t>();
    result.component_type = source.at("componentType").get<int>();
    const auto type = source.at("type").get<std::string_view>();
    result.components = component_count(type);
    result.is_matrix = type.starts_with("MAT");
    result.normalized = source.get("normalized", false);
    if (const JsonValue* sparse = source.find("sparse")) {
      result.sparse = {sparse->at("count").get<std::size_t>(),
                       sparse->at("indices").at("componentType").get<int>(),
                       sparse_bytes(sparse->at("indices")), sparse_bytes(sparse->at("values"))};
    }
    return result;
  }
  [[nodiscard]] GltfBytes sparse_bytes(const JsonValue& part) const {
    return model_.views[part.at("bufferView").get<std::size_t>()].bytes.subspan(
        part.get("byteOffset", std::size_t{0}));
  }

  /// An image that cannot be read does not make the scene invalid.
  [[nodiscard]] EncodedImage image(const JsonValue& source, const std::string& place) const {
    EncodedImage result{source.get("name", std::string()), place, {}};
    if (const JsonValue* number = source.find("bufferView")) {
      const GltfBytes bytes = model_.views[number->get<std::size_t>()].bytes;
      Bytes scratch;
      const auto read = bytes.read(0, bytes.size(), scratch);
      result.bytes.assign(read.begin(), read.end());
      return result;
    }
    const auto uri = source.at("uri").get<std::string>();
    if (is_data_uri(uri)) {
      result.bytes = decode_data_uri(uri).value_or(Bytes{});
      return result;
    }
    if (result.name.empty()) result.name = uri;
    result.place += " \"" + printable(uri) + "\"";
    try {
      result.bytes = read_file(resolve(from_, uri, true, place));
    } catch (const Error&) {
      result.bytes.clear();
    }
    return result;
  }

  GltfModel& model_;
  const GltfParts& parts_;
  const SceneFile& from_;
  bool is_held_;
  std::vector<GltfBytes> buffers_;
  std::map<std::string, GltfBytes> file_of_;  ///< files that have been read
};

}  // namespace

GltfModel parse_gltf(const GltfBytes& file, const SceneFile& from) {
  const GltfParts parts = split_gltf(file, ending_of(from.path) == "glb");
  if (!file.is_held() && parts.json.size() > kMostOuterJson) throw NeedsWholeFile{};
  Bytes text;
  GltfModel model{JsonDocument(parts.json.read(0, parts.json.size(), text)),
                  {},
                  {},
                  {},
                  {},
                  {},
                  {},
                  file.size() + parts.binary.size()};
  model.warnings = check_gltf_json(model.root(), parts, from);
  ModelReader(model, parts, from).read();
  return model;
}

}  // namespace raysheaf::io
