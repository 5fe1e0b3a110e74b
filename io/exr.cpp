// The translation unit of tinyexr. It includes the implementation if no library provides it.
#include <tinyexr.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
  if (pixels == 0 || pixels > kMaxPixels) refuse("an image must have between 1 and 2^28 pixels");
  if (channels.empty()) refuse("an image needs at least one channel");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const ExrChannel& channel = channels[i];
    if (channel.name.empty() || channel.name.size() > kMaxNameBytes) {
      refuse("a channel's name must have between 1 and 255 bytes");
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
  if (size == 0) throw Error(ErrorCode::kInternal, "the image cannot be encoded: " + why, path);
  io::Bytes bytes(memory, memory + size);
  std::free(memory);
  return bytes;
}

std::string taken_message(const char* message) {
  std::string text = message == nullptr ? "it is damaged" : message;
  if (message != nullptr) FreeEXRErrorMessage(message);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0)
    text.pop_back();
  return text;
}

/// An OpenEXR file in memory. The destructor frees what tinyexr allocates.
class ExrFile {
 public:
  /// Reads the header. Refuses dimensions that a file of this size cannot have, before allocating
  /// the pixels.
  ExrFile(std::span<const std::uint8_t> file, const std::string& path) : file_(file), path_(path) {
    EXRVersion version;
    if (ParseEXRVersionFromMemory(&version, file.data(), file.size()) != TINYEXR_SUCCESS)
      throw Error(ErrorCode::kInvalidData, "is not an OpenEXR image", path);
    if (version.multipart != 0 || version.non_image != 0)
      throw Error(ErrorCode::kUnsupported, "several parts and deep pixels are not supported", path);
    const char* message = nullptr;
    if (ParseEXRHeaderFromMemory(&owned_.header, &version, file.data(), file.size(), &message) !=
        TINYEXR_SUCCESS)
      refuse(taken_message(message));
    // With zero channels, tinyexr would leak its allocation.
    if (header().num_channels < 1) refuse("it has no channels");
    check_size();
  }

  [[nodiscard]] io::ImageSize size() const { return size_; }

  /// Red, green, blue and alpha of each pixel. A single channel is grey, whatever its name.
  std::vector<float> read_pixels() {
    for (int c = 0; c < header().num_channels; ++c)
      if (header().pixel_types[c] == TINYEXR_PIXELTYPE_HALF)
        header().requested_pixel_types[c] = TINYEXR_PIXELTYPE_FLOAT;
    int channels[4] = {channel("R"), channel("G"), channel("B"), channel("A")};
    if (header().num_channels == 1) {
      std::fill_n(channels, 3, 0);
      channels[3] = -1;
    }
    for (int c = 0; c < 3; ++c)
      if (channels[c] < 0) refuse(std::string("it has no channel ") + "RGB"[c]);
    EXRImage& image = owned_.image;
    image.num_channels = header().num_channels;  // tinyexr frees this many channels on failure
    const char* message = nullptr;
    if (LoadEXRImageFromMemory(&image, &header(), file_.data(), file_.size(), &message) !=
        TINYEXR_SUCCESS) {
      InitEXRImage(&image);  // tinyexr has freed it
      refuse(taken_message(message));
    }
    std::vector<float> pixels(std::size_t{4} * size_.width * size_.height, 1.0f);
    for (std::size_t c = 0; c < 4; ++c)
      if (channels[c] >= 0) copy_channel(channels[c], c, &pixels);
    return pixels;
  }

 private:
  struct Owned {
    EXRHeader header;
    EXRImage image;
    Owned() { InitEXRHeader(&header), InitEXRImage(&image); }
    ~Owned() { FreeEXRImage(&image), FreeEXRHeader(&header); }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;
  };

  EXRHeader& header() { return owned_.header; }

  [[noreturn]] void refuse(const std::string& reason) const {
    throw Error(ErrorCode::kInvalidData, "cannot be read: " + reason, path_);
  }

  void check_size() {
    const EXRBox2i& window = header().data_window;
    const std::int64_t width = std::int64_t{window.max_x} - window.min_x + 1;
    const std::int64_t height = std::int64_t{window.max_y} - window.min_y + 1;
    // tinyexr allocates whole tiles.
    std::int64_t columns = width, rows = height;
    if (header().tiled != 0) {
      const std::int64_t x = header().tile_size_x, y = header().tile_size_y;
      if (x < 1 || y < 1) refuse("its tiles have no size");
      columns = (width + x - 1) / x * x, rows = (height + y - 1) / y * y;
    }
    const auto most = static_cast<std::int64_t>(
        std::min(io::kMaxImagePixels, io::kFreePixels + io::kPixelsPerByte * file_.size()));
    if (width < 1 || height < 1 || columns > most || rows > most / columns)
      throw Error(ErrorCode::kOutOfMemory,
                  "the image would have " + std::to_string(width) + "x" + std::to_string(height) +
                      " pixels",
                  path_);
    size_ = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  }

  /// -1 if there is no such channel.
  int channel(const char* name) {
    for (int c = 0; c < header().num_channels; ++c)
      if (std::strcmp(header().channels[c].name, name) == 0) return c;
    return -1;
  }

  void copy_channel(int channel, std::size_t to, std::vector<float>* pixels) {
    const bool whole = header().pixel_types[channel] == TINYEXR_PIXELTYPE_UINT;
    const auto value = [&](unsigned char** images, std::size_t i) {
      return whole ? static_cast<float>(reinterpret_cast<std::uint32_t**>(images)[channel][i])
                   : reinterpret_cast<float**>(images)[channel][i];
    };
    const EXRImage& image = owned_.image;
    if (header().tiled == 0) {
      for (std::size_t i = 0; 4 * i < pixels->size(); ++i)
        (*pixels)[4 * i + to] = value(image.images, i);
      return;
    }
    const auto columns = static_cast<std::size_t>(header().tile_size_x);
    const auto rows = static_cast<std::size_t>(header().tile_size_y);
    for (int k = 0; k < image.num_tiles; ++k) {
      const EXRTile& tile = image.tiles[k];
      const std::size_t x0 = static_cast<std::size_t>(tile.offset_x) * columns;
      const std::size_t y0 = static_cast<std::size_t>(tile.offset_y) * rows;
      for (std::size_t y = 0; y < rows && y0 + y < size_.height; ++y)
        for (std::size_t x = 0; x < columns && x0 + x < size_.width; ++x)
          (*pixels)[4 * ((y0 + y) * size_.width + x0 + x) + to] =
              value(tile.images, y * columns + x);
    }
  }

  std::span<const std::uint8_t> file_;
  std::string path_;
  io::ImageSize size_;
  Owned owned_;
};

Environment decode_exr(const io::Bytes& file, const std::string& path) {
  ExrFile exr(file, path);
  const std::vector<float> pixels = exr.read_pixels();
  Environment map;
  map.width = exr.size().width;
  map.height = exr.size().height;
  for (std::size_t i = 0; i < std::size_t{map.width} * map.height; ++i)
    map.radiance.push_back({pixels[4 * i], pixels[4 * i + 1], pixels[4 * i + 2]});
  return map;
}

/// Clamps to [0, 1]. NaN and infinity become 0.
float part_of_texel(float x, bool* exceeds_one) {
  if (!std::isfinite(x) || x <= 0) return 0;
  *exceeds_one = *exceeds_one || x > io::kMostUnitColor;
  return std::min(x, 1.0f);
}
std::uint8_t code_of(double x) {
  return static_cast<std::uint8_t>(std::lround(255 * x));
}

/// Checks what `validate` would check, and names the file as the place.
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
    return ExrFile(encoded, {}).size();
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<io::ExrImage> io::decode_exr_image(std::span<const std::uint8_t> encoded,
                                                 bool is_data) {
  ImageSize size;
  std::vector<float> pixels;
  try {
    ExrFile file(encoded, {});
    size = file.size();
    pixels = file.read_pixels();
  } catch (const Error&) {
    return std::nullopt;
  }
  ExrImage result;
  PixelBuffer texels(size);
  const std::span<std::uint8_t> rgba = texels.rgba();
  bool ignored = false;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const float* from = pixels.data() + i;
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
    throw Error(ErrorCode::kUnsupported, "an environment must be a .hdr or .exr file", path);
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
