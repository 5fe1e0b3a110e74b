// The translation unit of tinyexr.
#include <tinyexr.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "io/file.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf {
namespace {

constexpr std::size_t kMaxNameBytes = 255;
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28;

void check(std::uint32_t width, std::uint32_t height, const std::vector<ExrChannel>& channels,
           const std::string& path) {
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::kInvalidArgument, sentence, path);
  };
  const std::uint64_t pixels = std::uint64_t{width} * height;
  if (pixels == 0 || pixels > kMaxPixels) refuse("a picture has between 1 and 2^28 pixels");
  if (channels.empty()) refuse("a picture needs a channel");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const ExrChannel& channel = channels[i];
    if (channel.name.empty() || channel.name.size() > kMaxNameBytes) {
      refuse("a channel's name has between 1 and 255 bytes");
    }
    if (channel.values.size() != pixels) {
      refuse("channel \"" + channel.name + "\" has " + std::to_string(channel.values.size()) +
             " values for " + std::to_string(pixels) + " pixels");
    }
    if (i > 0 && channels[i - 1].name == channel.name) {
      refuse("two channels are called \"" + channel.name + "\"");
    }
  }
}

io::Bytes encode(std::uint32_t width, std::uint32_t height, std::vector<ExrChannel>& channels,
                 const std::string& path) {
  const std::size_t count = channels.size();
  std::vector<EXRChannelInfo> infos(count);
  std::vector<int> types(count, TINYEXR_PIXELTYPE_FLOAT);
  std::vector<unsigned char*> planes(count);
  for (std::size_t c = 0; c < count; ++c) {
    std::memset(&infos[c], 0, sizeof infos[c]);
    std::memcpy(infos[c].name, channels[c].name.data(), channels[c].name.size());
    planes[c] = reinterpret_cast<unsigned char*>(channels[c].values.data());
  }
  EXRHeader header;
  InitEXRHeader(&header);
  header.num_channels = static_cast<int>(count);
  header.channels = infos.data();
  header.pixel_types = types.data();
  header.requested_pixel_types = types.data();
  header.compression_type = TINYEXR_COMPRESSIONTYPE_ZIP;
  EXRImage image;
  InitEXRImage(&image);
  image.num_channels = static_cast<int>(count);
  image.images = planes.data();
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  unsigned char* memory = nullptr;
  const char* message = nullptr;
  const std::size_t size = SaveEXRImageToMemory(&image, &header, &memory, &message);
  const std::string why = message == nullptr ? "" : message;
  if (message != nullptr) FreeEXRErrorMessage(message);
  if (size == 0) throw Error(ErrorCode::kInternal, "the picture cannot be encoded: " + why, path);
  io::Bytes bytes(memory, memory + size);
  std::free(memory);
  return bytes;
}

}  // namespace

void write_exr(std::uint32_t width, std::uint32_t height, std::vector<ExrChannel> channels,
               const std::string& path) {
  std::sort(channels.begin(), channels.end(),
            [](const ExrChannel& a, const ExrChannel& b) { return a.name < b.name; });
  check(width, height, channels, path);
  io::write_file(path, encode(width, height, channels, path));
}

}  // namespace raysheaf
