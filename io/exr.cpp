// Everything that includes OpenEXR. The library runs in the caller's thread, and its global
// settings stay as the program has set them.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "io/exr_decode.h"
#include "io/file.h"
#include "io/refuse.h"
#include "io/srgb.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf {
namespace {

constexpr std::size_t kMaxNameBytes = 255;
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28;
/// OpenEXR decompresses a tile, or a block of rows, of all channels at once.
constexpr std::uint64_t kMaxBlockBytes = std::uint64_t{1} << 29;

/// The rows of a block, for which OpenEXR allocates memory also if the image has fewer.
std::int64_t rows_of_block(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
      return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    default:
      return 256;
  }
}

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

/// A file in memory that OpenEXR writes.
class WrittenBytes : public Imf::OStream {
 public:
  WrittenBytes() : OStream("") {}
  void write(const char bytes[], int count) override {
    const std::size_t end = at_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + at_, bytes, static_cast<std::size_t>(count));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }
  [[nodiscard]] const io::Bytes& bytes() const { return bytes_; }

 private:
  io::Bytes bytes_;
  std::size_t at_ = 0;
};

io::Bytes encode(std::uint32_t width, std::uint32_t height, const std::vector<ExrChannel>& channels,
                 const std::string& path) {
  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer planes;
  for (const ExrChannel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    planes.insert(channel.name,
                  Imf::Slice::Make(Imf::FLOAT, channel.values.data(), header.dataWindow(),
                                   sizeof(float), sizeof(float) * width));
  }
  WrittenBytes written;
  try {
    Imf::OutputFile file(written, header, 0);
    file.setFrameBuffer(planes);
    file.writePixels(static_cast<int>(height));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorCode::kInternal, std::string("the image cannot be encoded: ") + error.what(),
                path);
  }
  return written.bytes();
}

/// A file in memory that OpenEXR reads.
class ReadBytes : public Imf::IStream {
 public:
  explicit ReadBytes(std::span<const std::uint8_t> file) : IStream(""), file_(file) {}
  bool read(char bytes[], int count) override {
    if (count < 0 || at_ > file_.size() || static_cast<std::size_t>(count) > file_.size() - at_)
      throw std::runtime_error("the file ends too early");
    std::memcpy(bytes, file_.data() + at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return at_ < file_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  std::span<const std::uint8_t> file_;
  std::uint64_t at_ = 0;
};

/// The attributes in the headers of a file. OpenEXR allocates what an attribute is said to take
/// before it reads it, and reads attributes of a known type without looking at that number. So
/// every number is checked first: it lies within the file, and is what the type takes.
class Attributes {
 public:
  /// Throws std::runtime_error. A file that is too short is left to OpenEXR.
  static void check(std::span<const std::uint8_t> file) {
    constexpr std::size_t kFirst = 8;
    constexpr std::uint32_t kManyParts = 0x1000;
    if (file.size() < kFirst) return;
    Attributes walk(file.subspan(4));
    const bool has_parts = (walk.number() & kManyParts) != 0;
    while (walk.header() && has_parts) {
    }
  }

 private:
  explicit Attributes(std::span<const std::uint8_t> rest) : rest_(rest) {}

  /// Skips a header; false if it is empty, as behind the last of many parts.
  bool header() {
    for (bool any = false;; any = true) {
      if (text().empty()) return any;
      const std::string type = text();
      const std::uint32_t size = number();
      Attributes value(take(size));
      if (!value.is_of(type, size)) throw std::runtime_error("an attribute has a wrong size");
    }
  }

  /// Whether this value is one of a type, from its begin to its end.
  bool is_of(const std::string& type, std::uint32_t size) {
    static const std::map<std::string_view, std::uint32_t> kSizes = {{"box2i", 16},
                                                                     {"box2f", 16},
                                                                     {"chromaticities", 32},
                                                                     {"compression", 1},
                                                                     {"double", 8},
                                                                     {"envmap", 1},
                                                                     {"float", 4},
                                                                     {"deepImageState", 1},
                                                                     {"int", 4},
                                                                     {"keycode", 28},
                                                                     {"lineOrder", 1},
                                                                     {"m33f", 36},
                                                                     {"m33d", 72},
                                                                     {"m44f", 64},
                                                                     {"m44d", 128},
                                                                     {"rational", 8},
                                                                     {"tiledesc", 9},
                                                                     {"timecode", 8},
                                                                     {"v2i", 8},
                                                                     {"v2f", 8},
                                                                     {"v2d", 16},
                                                                     {"v3i", 12},
                                                                     {"v3f", 12},
                                                                     {"v3d", 24}};
    if (const auto fixed = kSizes.find(type); fixed != kSizes.end()) return size == fixed->second;
    constexpr std::size_t kChannelBytes = 16;
    if (type == "chlist") {
      while (!text().empty()) take(kChannelBytes);
    } else if (type == "stringvector") {
      while (!rest_.empty()) take(number());
    } else if (type == "preview") {
      const std::uint64_t width = number(), height = number();
      return size < 1u << 31 && width * height == rest_.size() / 4 && rest_.size() % 4 == 0;
    } else if (type == "floatvector") {
      return size % sizeof(float) == 0;
    } else {
      return true;
    }
    return rest_.empty();
  }

  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > rest_.size()) throw std::runtime_error("the file ends too early");
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::uint32_t number() {
    const auto b = take(4);
    return b[0] | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 | std::uint32_t{b[3]} << 24;
  }
  std::string text() {
    const auto end = std::find(rest_.begin(), rest_.end(), std::uint8_t{0});
    const auto bytes = take(static_cast<std::size_t>(end - rest_.begin()));
    take(1);
    return {bytes.begin(), bytes.end()};
  }

  std::span<const std::uint8_t> rest_;
};

/// The last sentence of a message, which begins with what OpenEXR was doing with the file "".
std::string last_sentence(std::string text) {
  const std::string name = "\"\". ";
  if (const std::size_t at = text.rfind(name); at != std::string::npos)
    text.erase(0, at + name.size());
  while (!text.empty() && (text.back() == '.' || text.back() == '\n')) text.pop_back();
  const auto letter = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (text.size() > 1 && std::islower(letter(1)) != 0)
    text[0] = static_cast<char>(std::tolower(letter(0)));
  return text;
}

/// The names of the channels that are read as red, green, blue and alpha. Alpha may be empty.
struct ColorNames {
  std::array<std::string, 4> rgba;
  std::string remark;
};

/// From calloc: the system provides zeros where rows arrive, so a header that promises more pixels
/// than follow costs little, and nothing is ever undefined.
struct ExrPixels {
  io::ImageSize size;
  std::unique_ptr<float[], decltype(&std::free)> rgba{nullptr, &std::free};
  explicit ExrPixels(io::ImageSize its_size)
      : size(its_size),
        rgba(static_cast<float*>(std::calloc(value_count(), sizeof(float))), &std::free) {
    if (rgba == nullptr) throw std::bad_alloc();
  }
  [[nodiscard]] std::size_t value_count() const {
    return std::size_t{4} * size.width * size.height;
  }
};

/// An OpenEXR file in memory. The image is its display window; pixels outside of the data window
/// are 0, and transparent.
class ExrFile {
 public:
  /// Reads the header. Refuses dimensions that a file of this size cannot have, before allocating
  /// the pixels.
  ExrFile(std::span<const std::uint8_t> file, std::string path)
      : path_(std::move(path)), file_bytes_(file.size()), stream_(file) {
    naming_damage([&] {
      Attributes::check(file);
      file_ = std::make_unique<Imf::MultiPartInputFile>(stream_, 0, false);
      for (part_ = 0; part_ < file_->parts(); ++part_)
        if (!Imf::isDeepData(header().type())) return check_size();
      refuse("has only deep pixels, which are not supported", ErrorCode::kUnsupported);
    });
  }

  [[nodiscard]] io::ImageSize size() const { return size_of(header().displayWindow()); }

  ExrPixels read_pixels(std::string* remark) {
    const ColorNames names = find_colors();
    *remark = names.remark;
    ExrPixels pixels(size_of(header().dataWindow()));
    naming_damage([&] {
      Imf::InputPart part(*file_, part_);
      for (std::size_t c = 0; c < 4; ++c) {
        if (names.rgba[c].empty()) continue;
        // A channel that is read as several colours is read several times: a frame buffer has one
        // place for each channel.
        const bool repeated = c > 0 && c < 3 && names.rgba[c] == names.rgba[0];
        if (!repeated) planes_.insert(names.rgba[c], slice_of(pixels, c));
      }
      part.setFrameBuffer(planes_);
      part.readPixels(header().dataWindow().min.y, header().dataWindow().max.y);
    });
    const bool is_grey = names.rgba[1] == names.rgba[0], is_opaque = names.rgba[3].empty();
    for (std::size_t i = 0; i < pixels.value_count(); i += 4) {
      if (is_grey) pixels.rgba[i + 1] = pixels.rgba[i + 2] = pixels.rgba[i];
      if (is_opaque) pixels.rgba[i + 3] = 1;
    }
    return header().displayWindow() == header().dataWindow() ? std::move(pixels) : shown(pixels);
  }

 private:
  /// The window is one that `check_size` has accepted.
  [[nodiscard]] static io::ImageSize size_of(const Imath::Box2i& window) {
    return {static_cast<std::uint32_t>(window.max.x - window.min.x + 1),
            static_cast<std::uint32_t>(window.max.y - window.min.y + 1)};
  }

  /// The display window of what the data window contains.
  [[nodiscard]] ExrPixels shown(const ExrPixels& data) const {
    const Imath::Box2i &from = header().dataWindow(), &to = header().displayWindow();
    ExrPixels display(size());
    const int left = std::max(from.min.x, to.min.x), right = std::min(from.max.x, to.max.x);
    const int top = std::max(from.min.y, to.min.y), bottom = std::min(from.max.y, to.max.y);
    const auto value_at = [&](const ExrPixels& pixels, const Imath::Box2i& window, int y) {
      const std::int64_t row = std::int64_t{y} - window.min.y;
      const std::int64_t column = std::int64_t{left} - window.min.x;
      return pixels.rgba.get() + 4 * (row * pixels.size.width + column);
    };
    for (int y = top; left <= right && y <= bottom; ++y)
      std::copy_n(value_at(data, from, y), 4 * (std::int64_t{right} - left + 1),
                  value_at(display, to, y));
    return display;
  }

  /// Returns from `work`, or throws its exceptions as `Error`.
  template <class Work>
  void naming_damage(const Work& work) const {
    try {
      work();
    } catch (const Error&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      refuse("is truncated or damaged: " + last_sentence(error.what()));
    }
  }

  [[nodiscard]] const Imf::Header& header() const { return file_->header(part_); }

  [[noreturn]] void refuse(const std::string& sentence,
                           ErrorCode code = ErrorCode::kInvalidData) const {
    throw Error(code, sentence, path_);
  }

  void check_size() const {
    check_window(header().displayWindow(), false);
    check_window(header().dataWindow(), true);
  }

  void check_window(const Imath::Box2i& window, bool has_blocks) const {
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    // OpenEXR allocates whole tiles, and whole blocks of rows.
    std::int64_t columns = width, rows = height, block_rows = rows_of_block(header().compression());
    if (has_blocks && header().hasTileDescription()) {
      const std::int64_t x = header().tileDescription().xSize;
      const std::int64_t y = header().tileDescription().ySize;
      if (x < 1 || y < 1) refuse("is damaged: its tiles have no size");
      columns = (width + x - 1) / x * x, rows = (height + y - 1) / y * y, block_rows = y;
    }
    const auto most = static_cast<std::int64_t>(
        std::min(io::kMaxImagePixels, io::kFreePixels + io::kPixelsPerByte * file_bytes_));
    std::int64_t pixel_bytes = 0;
    for (auto it = header().channels().begin(); it != header().channels().end(); ++it)
      pixel_bytes += it.channel().type == Imf::HALF ? 2 : 4;
    const std::int64_t block_pixels =
        static_cast<std::int64_t>(kMaxBlockBytes) / std::max<std::int64_t>(pixel_bytes, 1);
    if (width < 1 || height < 1 || columns > most || rows > most / columns ||
        (has_blocks && block_rows > block_pixels / columns))
      refuse("would have " + std::to_string(width) + "x" + std::to_string(height) + " pixels, " +
                 std::to_string(pixel_bytes) + " bytes each, which is too large",
             ErrorCode::kOutOfMemory);
  }

  [[nodiscard]] ColorNames find_colors() const {
    const Imf::ChannelList& all = header().channels();
    std::set<std::string> layers;  // each with the dot that ends its name
    std::string list, alone;
    int count = 0;
    bool has_alpha = false;
    for (auto it = all.begin(); it != all.end(); ++it) {
      const std::string name = it.name();
      const std::string layer = name.substr(0, name.rfind('.') + 1);
      const auto has = [&](const char* color) {
        return all.findChannel((layer + color).c_str()) != nullptr;
      };
      if (has("R") && has("G") && has("B")) layers.insert(layer);
      if (++count <= 8) list += (list.empty() ? "" : ", ") + io::printable(name);
      if (name == "A" && count == 1) has_alpha = true;  // names are sorted
      if (name != "A" || alone.empty()) alone = name;
    }
    if (count > 8) list += ", ...";
    ColorNames names;
    if (layers.empty()) {
      if (count != (has_alpha ? 2 : 1) && count != 1)
        refuse("has the channels " + list + ", but R, G and B are read, or one channel and A",
               ErrorCode::kUnsupported);
      if (count > 0) names.rgba = {alone, alone, alone, count == 2 ? "A" : ""};
    } else {
      const std::string& layer = *layers.begin();
      names.rgba = {layer + "R", layer + "G", layer + "B", layer + "A"};
      if (!layer.empty() && layers.size() > 1)
        names.remark = "has " + std::to_string(layers.size()) + " layers with colours; \"" +
                       io::printable(layer.substr(0, layer.size() - 1)) + "\" is read.";
      if (all.findChannel(names.rgba[3].c_str()) == nullptr) names.rgba[3].clear();
    }
    if (count == 0) refuse("has no channels");
    for (const std::string& name : names.rgba) {
      if (name.empty()) continue;
      const Imf::Channel& channel = all[name.c_str()];
      if (channel.xSampling != 1 || channel.ySampling != 1)
        refuse(
            "has channel " + io::printable(name) + " at a lower resolution, which is not supported",
            ErrorCode::kUnsupported);
    }
    return names;
  }

  /// The place of the data window's values of one colour.
  [[nodiscard]] Imf::Slice slice_of(const ExrPixels& pixels, std::size_t color) const {
    const std::size_t pixel_bytes = 4 * sizeof(float);
    return Imf::Slice::Make(Imf::FLOAT, pixels.rgba.get() + color, header().dataWindow(),
                            pixel_bytes, pixel_bytes * pixels.size.width);
  }

  std::string path_;
  std::uint64_t file_bytes_;
  ReadBytes stream_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  int part_ = 0;
  Imf::FrameBuffer planes_;
};

/// Clamps to [0, 1]. NaN and infinity become 0.
float part_of_texel(float x, bool* exceeds_one) {
  if (!std::isfinite(x) || x <= 0) return 0;
  *exceeds_one = *exceeds_one || x > io::kMostUnitColor;
  return std::min(x, 1.0f);
}
std::uint8_t code_of(double x) {
  return static_cast<std::uint8_t>(std::lround(255 * x));
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

io::ExrImage io::decode_exr_image(std::span<const std::uint8_t> encoded, bool is_data) {
  ExrFile file(encoded, {});
  ExrImage result;
  const ExrPixels pixels = file.read_pixels(&result.remark);
  PixelBuffer texels(pixels.size);
  const std::span<std::uint8_t> rgba = texels.rgba();
  bool ignored = false;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const float* from = pixels.rgba.get() + i;
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

Environment io::decode_exr_environment(std::span<const std::uint8_t> file,
                                       const std::string& path) {
  ExrFile exr(file, path);
  std::string remark;
  const ExrPixels pixels = exr.read_pixels(&remark);
  Environment map;
  map.width = pixels.size.width;
  map.height = pixels.size.height;
  if (!remark.empty()) map.warnings.push_back(path + " " + remark);
  map.radiance.reserve(pixels.value_count() / 4);
  for (std::size_t i = 0; i < pixels.value_count(); i += 4)
    map.radiance.push_back({pixels.rgba[i], pixels.rgba[i + 1], pixels.rgba[i + 2]});
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
