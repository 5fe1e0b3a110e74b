#include "io/texture_files.h"

#include "io/image.h"
#include "io/named_file.h"
#include "io/refuse.h"

namespace raysheaf::io {

void TextureFiles::warn_once(const std::string& sentence) {
  if (warned_.insert(sentence).second) scene_.warnings.push_back(sentence);
}

std::uint32_t TextureFiles::add(const std::string& name, Use use, const std::string& named_in,
                                const std::string& place) {
  NamedFile file;
  try {
    file = find_named(from_, name, named_in, place);
  } catch (const Error& error) {
    warn_once("The texture " + error.sentence() + "; it is left out.");
    return kInvalidId;
  }
  if (!file.remark.empty()) warn_once(file.remark);
  // For 8-bit images, data and colours have the same values.
  const Shown shown{file.path, use.is_data && ending_of(file.path) == "exr"};
  const auto [it, fresh] = texture_of_.try_emplace((use.clamped ? "c" : "r") + shown.key(),
                                                   static_cast<std::uint32_t>(shown_.size()));
  if (fresh) {
    const Wrap wrap = use.clamped ? Wrap::kClampToEdge : Wrap::kRepeat;
    scene_.textures.push_back({kInvalidId, wrap, wrap, Filter::kLinear});
    shown_.push_back(shown);
  }
  return it->second;
}

std::map<TextureFiles::Key, std::uint32_t> TextureFiles::read_images() {
  ImageCache own;
  ImageCache& cache = from_.images != nullptr ? *from_.images : own;
  std::vector<EncodedImage> encoded;
  std::vector<Key> fresh;
  std::set<Key> seen;
  for (const Shown& shown : shown_) {
    if (!seen.insert(shown.key()).second || cache.count(shown.key()) > 0) continue;
    const std::string name = shown.path.substr(shown.path.rfind('/') + 1);
    encoded.push_back({name, "The image \"" + printable(name) + "\"", {}, shown.is_data});
    if (file_exists(shown.path)) encoded.back().bytes = read_file(shown.path);
    fresh.push_back(shown.key());
  }
  DecodedImages decoded = decode_images(encoded, scene_.warnings);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    const std::uint32_t image = decoded.index_of[i];
    cache[fresh[i]] = image == kInvalidId ? Image{} : std::move(decoded.images[image]);
  }
  std::map<Key, std::uint32_t> index_of;
  for (const Shown& shown : shown_) {
    Image& image = cache[shown.key()];
    if (image.rgba.empty() || index_of.count(shown.key()) > 0) continue;
    index_of[shown.key()] = static_cast<std::uint32_t>(scene_.images.size());
    if (from_.images == nullptr) {
      scene_.images.push_back(std::move(image));
    } else {
      scene_.images.push_back(image);
    }
  }
  return index_of;
}

std::vector<std::uint32_t> TextureFiles::finish() {
  const std::map<Key, std::uint32_t> image_of = read_images();
  std::vector<std::uint32_t> index_of;
  std::vector<Texture> kept;
  for (std::size_t t = 0; t < shown_.size(); ++t) {
    const auto found = image_of.find(shown_[t].key());
    const bool is_there = found != image_of.end();
    index_of.push_back(is_there ? static_cast<std::uint32_t>(kept.size()) : kInvalidId);
    if (!is_there) continue;
    kept.push_back(scene_.textures[t]);
    kept.back().image = found->second;
  }
  scene_.textures = std::move(kept);
  return index_of;
}

}  // namespace raysheaf::io
