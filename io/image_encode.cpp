// PNG (W3C, "Portable Network Graphics Specification", third edition, 2023), 8 bits a channel.
#include <array>
#include <cstdlib>

#include "io/deflate.h"
#include "io/file.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf {
namespace {

using io::Bytes;

bool is_opaque(const Image& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
    if (image.rgba[i] != 255) return false;
  }
  return true;
}

/// A row of a picture, less what a neighbour foretells: one of the five filters of section 9.
struct FilteredRow {
  Bytes bytes;             ///< the filter's number, then the row
  std::uint64_t size = 0;  ///< sum of magnitudes, as signed bytes: what is small compresses well
};

std::uint8_t paeth(int left, int up, int corner) {
  const int to_left = std::abs(up - corner), to_up = std::abs(left - corner);
  const int to_corner = std::abs(left + up - 2 * corner);
  const int rest = to_up <= to_corner ? up : corner;
  return static_cast<std::uint8_t>(to_left <= to_up && to_left <= to_corner ? left : rest);
}

/// `foretell(left, up, corner)`; `row` and `above` have `channels` zeros before their first byte.
template <class Foretell>
void filter_row(const std::uint8_t* row, const std::uint8_t* above, std::size_t channels,
                const Foretell& foretell, FilteredRow* out) {
  const std::size_t size = out->bytes.size() - 1;
  std::uint8_t* const to = out->bytes.data() + 1;
  const std::uint8_t *left = row - channels, *corner = above - channels;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const auto rest = static_cast<std::uint8_t>(row[i] - foretell(left[i], above[i], corner[i]));
    to[i] = rest;
    sum += static_cast<unsigned>(std::abs(static_cast<std::int8_t>(rest)));
  }
  out->size = sum;
}

/// Every row by the filter that leaves least of it.
class Filters {
 public:
  Filters(std::size_t row_bytes, std::size_t channels) : channels_(channels) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      rows_[i].bytes.resize(row_bytes + 1);
      rows_[i].bytes[0] = static_cast<std::uint8_t>(i);
    }
  }

  const Bytes& best(const std::uint8_t* row, const std::uint8_t* above) {
    const auto filter = [&](std::size_t i, const auto& foretell) {
      filter_row(row, above, channels_, foretell, &rows_[i]);
    };
    filter(0, [](int /*left*/, int /*up*/, int /*corner*/) { return 0; });
    filter(1, [](int left, int /*up*/, int /*corner*/) { return left; });
    filter(2, [](int /*left*/, int up, int /*corner*/) { return up; });
    filter(3, [](int left, int up, int /*corner*/) { return (left + up) / 2; });
    filter(4, paeth);
    std::size_t best = 0;
    for (std::size_t i = 1; i < rows_.size(); ++i)
      if (rows_[i].size < rows_[best].size) best = i;
    return rows_[best].bytes;
  }

 private:
  std::size_t channels_;
  std::array<FilteredRow, 5> rows_;
};

/// Filtered rows, one after the other. Alpha is left out of opaque pictures.
Bytes filtered(const Image& image, std::size_t channels) {
  const std::size_t width = image.width, row_bytes = width * channels;
  Filters filters(row_bytes, channels);
  Bytes all, row(channels + row_bytes), above(channels + row_bytes);
  all.reserve((row_bytes + 1) * image.height);
  for (std::size_t y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.rgba.data() + 4 * width * y;
    std::uint8_t* to = row.data() + channels;
    for (std::size_t x = 0; x < width; ++x, from += 4)
      for (std::size_t c = 0; c < channels; ++c) *to++ = from[c];
    const Bytes& best = filters.best(row.data() + channels, above.data() + channels);
    all.insert(all.end(), best.begin(), best.end());
    row.swap(above);
  }
  return all;
}

/// CRC-32 of section D, four bytes a step (M. Kounavis, F. Berry, "A Systematic Approach to
/// Building High Performance Software-Based CRC Generators", ISCC 2005).
std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  static const auto kTables = [] {
    std::array<std::array<std::uint32_t, 256>, 4> tables{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
      tables[0][i] = c;
    }
    for (std::size_t t = 1; t < 4; ++t)
      for (std::size_t i = 0; i < 256; ++i)
        tables[t][i] = tables[0][tables[t - 1][i] & 255] ^ (tables[t - 1][i] >> 8);
    return tables;
  }();
  std::uint32_t c = 0xffffffffu;
  std::size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4)
    c = kTables[3][(c ^ bytes[i]) & 255] ^ kTables[2][(c >> 8 ^ bytes[i + 1]) & 255] ^
        kTables[1][(c >> 16 ^ bytes[i + 2]) & 255] ^ kTables[0][c >> 24 ^ bytes[i + 3]];
  for (; i < bytes.size(); ++i) c = kTables[0][(c ^ bytes[i]) & 255] ^ (c >> 8);
  return ~c;
}

void append_number(Bytes* out, std::uint32_t number) {
  for (const int shift : {24, 16, 8, 0}) out->push_back(static_cast<std::uint8_t>(number >> shift));
}

void append_chunk(Bytes* out, const char (&name)[5], std::span<const std::uint8_t> data) {
  append_number(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = out->size();
  out->insert(out->end(), name, name + 4);
  out->insert(out->end(), data.begin(), data.end());
  append_number(out, crc32(std::span(*out).subspan(begin)));
}

}  // namespace

Bytes encode_png(const Image& image) {
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  if (pixels == 0 || image.rgba.size() != 4 * pixels) {
    throw Error(ErrorCode::kInvalidArgument,
                "an image of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                    " pixels cannot have " + std::to_string(image.rgba.size()) + " bytes",
                "image \"" + image.name + "\"");
  }
  // A chunk has fewer bytes than 2^31.
  if (pixels * 4 + image.height > 0x7fffffff) {
    throw Error(ErrorCode::kUnsupported, "a PNG of more than 2^29 pixels is not written",
                "image \"" + image.name + "\"");
  }
  const bool opaque = is_opaque(image);
  Bytes header;
  append_number(&header, image.width);
  append_number(&header, image.height);
  const std::uint8_t kind = opaque ? 2 : 6;  // truecolour, with alpha or without
  header.insert(header.end(), {8, kind, 0, 0, 0});
  Bytes png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(&png, "IHDR", header);
  append_chunk(&png, "IDAT", io::zlib_compressed(filtered(image, opaque ? 3 : 4)));
  append_chunk(&png, "IEND", {});
  return png;
}

void write_png(const Image& image, const std::string& path) {
  Bytes png;
  try {
    png = encode_png(image);
  } catch (const Error& error) {
    throw Error(error.code(), error.sentence(), path);
  }
  io::write_file(path, png);
}

}  // namespace raysheaf
