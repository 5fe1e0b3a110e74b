#include "io/gltf_model.h"

#include <cstring>
#include <limits>

#include "io/gltf_json.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

/// What the parser's callbacks share. An `Error` must not pass through the parser, so the first one
/// is kept here and thrown afterwards.
struct Session {
  const GltfFacts& facts;
  std::vector<EncodedImage>& images;
  const std::string& folder;
  std::string failure;
};

/// The parser also looks in the working directory; only the file's own folder counts.
bool exists(const std::string& path, void* user) {
  return path.starts_with(static_cast<Session*>(user)->folder) && file_exists(path);
}
std::string expand_nothing(const std::string& path, void*) {
  return path;
}

/// The parser wants a buffer's file to have exactly `byteLength` bytes; glTF allows more.
bool read_whole(std::vector<unsigned char>* out, std::string* message, const std::string& path,
                void* user) {
  auto& session = *static_cast<Session*>(user);
  try {
    *out = read_file(path);
  } catch (const std::exception& error) {
    *message = error.what();
    return false;
  }
  const auto buffer = session.facts.buffer_files.find(path);
  if (buffer == session.facts.buffer_files.end()) return true;
  if (out->size() < buffer->second) {
    session.failure = "\"" + path + "\" has " + std::to_string(out->size()) +
                      " bytes, but a buffer needs " + std::to_string(buffer->second);
    return false;
  }
  out->resize(buffer->second);
  return true;
}

bool keep_image(tinygltf::Image*, const int index, std::string*, std::string*, int, int,
                const unsigned char* bytes, int size, void* user) {
  auto& images = static_cast<Session*>(user)->images;
  const auto i = static_cast<std::size_t>(index);
  if (images.size() <= i) images.resize(i + 1);
  if (size > 0) images[i].bytes.assign(bytes, bytes + size);
  return true;
}

/// The GLB as the parser takes it: an empty BIN chunk and chunks of unknown kinds, which glTF
/// allows, are cut off.
Bytes without_odd_chunks(const Bytes& file, const GltfParts& parts) {
  const std::size_t end =
      static_cast<std::size_t>(parts.json.data() - file.data()) + parts.json.size();
  Bytes glb(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(end));
  for (std::size_t i = 0; i < 4; ++i) glb[8 + i] = static_cast<std::uint8_t>(end >> (8 * i));
  return glb;
}

bool run_parser(tinygltf::TinyGLTF& parser, tinygltf::Model& model, std::string& error,
                const Bytes& file, const GltfParts& parts, const std::string& folder) {
  std::string warning;
  const unsigned check = tinygltf::REQUIRE_VERSION;
  if (!parts.is_glb) {
    return parser.LoadASCIIFromString(&model, &error, &warning,
                                      reinterpret_cast<const char*>(parts.json.data()),
                                      static_cast<unsigned>(parts.json.size()), folder, check);
  }
  const Bytes shortened = parts.binary.empty() ? without_odd_chunks(file, parts) : Bytes{};
  const Bytes& glb = parts.binary.empty() ? shortened : file;
  return parser.LoadBinaryFromMemory(&model, &error, &warning, glb.data(),
                                     static_cast<unsigned>(glb.size()), folder, check);
}

std::string first_line(const std::string& text) {
  const std::string line = text.substr(0, std::min(text.find('\n'), std::size_t{200}));
  return line.empty() ? "the file cannot be parsed" : line;
}

/// tinygltf must have kept what was checked; its own buffers are what is read from now on.
void check_buffers(const tinygltf::Model& model) {
  for (std::size_t i = 0; i < model.bufferViews.size(); ++i) {
    const tinygltf::BufferView& view = model.bufferViews[i];
    const std::size_t bytes = model.buffers.at(static_cast<std::size_t>(view.buffer)).data.size();
    if (view.byteOffset <= bytes && view.byteLength <= bytes - view.byteOffset) continue;
    throw Error(ErrorCode::kInvalidData, "its buffer has only " + std::to_string(bytes) + " bytes",
                "bufferViews[" + std::to_string(i) + "]");
  }
}

}  // namespace

GltfModel parse_gltf(const Bytes& file, const SceneFile& from) {
  const GltfParts parts = split_gltf(file);
  GltfFacts facts = check_gltf_json(parts, from);
  const std::string folder = folder_of(from.path);
  GltfModel result;
  Session session{facts, result.images, folder, {}};
  tinygltf::TinyGLTF parser;
  parser.SetFsCallbacks({exists, expand_nothing, read_whole, nullptr, &session});
  parser.SetImageLoader(keep_image, &session);
  std::string error;
  if (!run_parser(parser, result.model, error, file, parts, folder)) {
    throw Error(ErrorCode::kInvalidData,
                session.failure.empty() ? first_line(error) : session.failure, "glTF");
  }
  check_buffers(result.model);
  result.warnings = std::move(facts.warnings);
  result.images.resize(result.model.images.size());
  for (std::size_t i = 0; i < result.images.size(); ++i) {
    const tinygltf::Image& image = result.model.images[i];
    result.images[i].name = image.name.empty() ? image.uri : image.name;
    result.images[i].place = "images[" + std::to_string(i) + "]";
  }
  result.file_bytes = file.size();
  for (const tinygltf::Buffer& buffer : result.model.buffers) {
    result.file_bytes += buffer.data.size();
  }
  return result;
}

}  // namespace raysheaf::io
