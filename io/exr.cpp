// The translation unit of tinyexr; with its implementation where there is no library of it.
#include <tinyexr.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <span>

#include "io/exr_decode.h"
#include "io/file.h"
#include "io/radiance_hdr.h"
#include "io/srgb.h"
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

/// Frees what tinyexr allocated.
struct Freed {
  void operator()(void* memory) const { std::free(memory); }
};

std::string taken_message(const char* message) {
  std::string text = message == nullptr ? "it is damaged" : message;
  if (message != nullptr) FreeEXRErrorMessage(message);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0)
    text.pop_back();
  return text;
}

/// Before anything is allocated: sides that a picture of so many bytes can have.
io::ImageSize check_exr(std::span<const std::uint8_t> file, const std::string& path) {
  EXRVersion version;
  if (ParseEXRVersionFromMemory(&version, file.data(), file.size()) != TINYEXR_SUCCESS)
    throw Error(ErrorCode::kInvalidData, "is no OpenEXR picture", path);
  if (version.multipart != 0 || version.non_image != 0)
    throw Error(ErrorCode::kUnsupported, "several parts or deep pixels are not read", path);
  EXRHeader header;
  InitEXRHeader(&header);
  const std::unique_ptr<EXRHeader, decltype(&FreeEXRHeader)> owner(&header, &FreeEXRHeader);
  const char* message = nullptr;
  if (ParseEXRHeaderFromMemory(&header, &version, file.data(), file.size(), &message) !=
      TINYEXR_SUCCESS)
    throw Error(ErrorCode::kInvalidData, "cannot be read: " + taken_message(message), path);
  // tinyexr would lose what it allocates for none.
  if (header.num_channels < 1)
    throw Error(ErrorCode::kInvalidData, "cannot be read: it has no channels", path);
  const std::int64_t width = std::int64_t{header.data_window.max_x} - header.data_window.min_x + 1;
  const std::int64_t height = std::int64_t{header.data_window.max_y} - header.data_window.min_y + 1;
  const auto most = static_cast<std::int64_t>(
      std::min(io::kMaxImagePixels, io::kFreePixels + io::kPixelsPerByte * file.size()));
  if (width < 1 || height < 1 || width > most || height > most / width)
    throw Error(ErrorCode::kOutOfMemory,
                "the picture would have " + std::to_string(width) + "x" + std::to_string(height) +
                    " pixels",
                path);
  return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

using ExrPixels = std::unique_ptr<float, Freed>;

/// Red, green, blue and alpha of each pixel.
ExrPixels read_exr(std::span<const std::uint8_t> file, const std::string& path,
                   io::ImageSize* size) {
  *size = check_exr(file, path);
  float* pixels = nullptr;
  int width = 0, height = 0;
  const char* message = nullptr;
  const int status =
      LoadEXRFromMemory(&pixels, &width, &height, file.data(), file.size(), &message);
  ExrPixels owner(pixels);
  if (status != TINYEXR_SUCCESS || pixels == nullptr)
    throw Error(ErrorCode::kInvalidData, "cannot be read: " + taken_message(message), path);
  *size = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  return owner;
}

Environment decode_exr(const io::Bytes& file, const std::string& path) {
  io::ImageSize size;
  const ExrPixels owner = read_exr(file, path, &size);
  const float* pixels = owner.get();
  Environment map;
  map.width = size.width;
  map.height = size.height;
  for (std::size_t i = 0; i < std::size_t{map.width} * map.height; ++i)
    map.radiance.push_back({pixels[4 * i], pixels[4 * i + 1], pixels[4 * i + 2]});
  return map;
}

/// From 0 to 1; what is not finite is 0.
float part_of_texel(float x, bool* exceeds_one) {
  if (!std::isfinite(x) || x <= 0) return 0;
  *exceeds_one = *exceeds_one || x > io::kMostUnitColor;
  return std::min(x, 1.0f);
}
std::uint8_t code_of(double x) {
  return static_cast<std::uint8_t>(std::lround(255 * x));
}

/// The loader's own: the place is the file.
void check_radiance(const Environment& map, const std::string& path) {
  for (std::size_t i = 0; i < map.radiance.size(); ++i) {
    const Vec3& v = map.radiance[i];
    const bool finite = std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    if (finite && v.x >= 0 && v.y >= 0 && v.z >= 0) continue;
    throw Error(ErrorCode::kInvalidData,
                "pixel (" + std::to_string(i % map.width) + ", " + std::to_string(i / map.width) +
                    ") is " + (finite ? "negative" : "not finite"),
                path);
  }
}

}  // namespace

bool io::is_exr(std::span<const std::uint8_t> encoded) {
  constexpr std::uint8_t kMagic[] = {'v', '/', '1', 1};
  return encoded.size() > std::size(kMagic) &&
         std::equal(std::begin(kMagic), std::end(kMagic), encoded.begin());
}

std::optional<io::ImageSize> io::exr_size(std::span<const std::uint8_t> encoded) {
  try {
    return check_exr(encoded, {});
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<io::ExrImage> io::decode_exr_image(std::span<const std::uint8_t> encoded,
                                                 bool is_data) {
  ImageSize size;
  ExrPixels pixels;
  try {
    pixels = read_exr(encoded, {}, &size);
  } catch (const Error&) {
    return std::nullopt;
  }
  ExrImage result;
  PixelBuffer texels(size);
  const std::span<std::uint8_t> rgba = texels.rgba();
  bool ignored = false;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const float* from = pixels.get() + i;
    const float alpha = part_of_texel(from[3], &ignored);
    const float divisor = is_data || alpha == 0 ? 1 : alpha;
    for (std::size_t c = 0; c < 3; ++c) {
      const float part = part_of_texel(from[c] / divisor, &result.exceeds_one);
      rgba[i + c] = code_of(is_data ? part : srgb_of_linear(part));
    }
    rgba[i + 3] = code_of(alpha);
  }
  result.image = texels.image();
  return result;
}

Environment load_environment(const std::string& path) {
  const io::Bytes file = io::read_file(path);
  const std::string ending = io::ending_of(path);
  if (ending != "hdr" && ending != "exr")
    throw Error(ErrorCode::kUnsupported, "an environment is a .hdr or an .exr file", path);
  Environment map = ending == "hdr" ? io::decode_radiance_hdr(file, path) : decode_exr(file, path);
  check_radiance(map, path);
  map.name = path.substr(path.find_last_of('/') + 1);
  return map;
}

void write_exr(std::uint32_t width, std::uint32_t height, std::vector<ExrChannel> channels,
               const std::string& path) {
  std::sort(channels.begin(), channels.end(),
            [](const ExrChannel& a, const ExrChannel& b) { return a.name < b.name; });
  check(width, height, channels, path);
  io::write_file(path, encode(width, height, channels, path));
}

}  // namespace raysheaf
