// OpenEXR in memory. OpenEXR reports by exceptions; they end in this file.
#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <functional>
#include <stdexcept>
#include <string>

#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"
#include "luxel/base/share_out.h"
#include "luxel/image/codec.h"

namespace luxel::image {
namespace {

constexpr std::array<const char*, 4> kChannelNames{"R", "G", "B", "A"};
/// A broken header may claim any size: this many pixels (16384 squared) are the most we believe.
constexpr uint64_t kMaxPixels = uint64_t(1) << 28;

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("memory") {}
  void write(const char data[], int size) override {
    const size_t end = position_ + size_t(size);
    if (end > bytes.size()) bytes.resize(end);
    std::memcpy(bytes.data() + position_, data, size_t(size));
    position_ = end;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = size_t(position); }

  std::vector<std::byte> bytes;

 private:
  size_t position_ = 0;
};

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::span<const std::byte> bytes) : Imf::IStream("memory"), bytes_(bytes) {}
  bool read(char data[], int size) override {
    if (size < 0 || position_ > bytes_.size() || size_t(size) > bytes_.size() - position_)
      throw Iex::InputExc("the file ends too early");
    std::memcpy(data, bytes_.data() + position_, size_t(size));
    position_ += size_t(size);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = size_t(position); }

 private:
  std::span<const std::byte> bytes_;
  size_t position_ = 0;
};

/// Rows [begin, end) of an image.
struct Rows {
  int begin = 0, end = 0;
};

template <class Number>
constexpr Imf::PixelType kTypeOf = sizeof(Number) == 4 ? Imf::FLOAT : Imf::HALF;

/// `AnyImage`: Image or HalfImage, here and below.
template <class AnyImage>
Imf::Header make_header(const AnyImage& image, Rows rows) {
  using Number = typename decltype(image.data)::value_type;
  Imf::Header header(image.width, image.height);
  header.dataWindow().min.y = rows.begin, header.dataWindow().max.y = rows.end - 1;
  header.compression() = Imf::ZIP_COMPRESSION;
  for (int c = 0; c < image.channels; ++c)
    header.channels().insert(kChannelNames[size_t(c)], Imf::Channel(kTypeOf<Number>));
  return header;
}

/// Slices over `image` whose pixel (0, 0) is the file's pixel (origin_x, origin_y).
template <class AnyImage>
Imf::FrameBuffer make_frame_buffer(const AnyImage& image, int origin_x, int origin_y) {
  using Number = typename decltype(image.data)::value_type;
  const size_t x_stride = sizeof(Number) * size_t(image.channels);
  const size_t y_stride = x_stride * size_t(image.width);
  Imf::FrameBuffer buffer;
  for (int c = 0; c < image.channels; ++c) {
    // OpenEXR's buffers are not const even where it only reads them.
    char* base = reinterpret_cast<char*>(const_cast<Number*>(image.data.data() + c));
    // Slice::Make moves the base by the data window without overflowing the pointer.
    buffer.insert(
        kChannelNames[size_t(c)],
        Imf::Slice::Make(kTypeOf<Number>, base, Imath::V2i(origin_x, origin_y), image.width,
                         image.height, x_stride, y_stride, 1, 1, c == 3 ? 1.0 : 0.0));
  }
  return buffer;
}

/// The channels asked of a file: 3, or 4 when it has A. Errors name the missing channel.
Result<int> channels_of(const Imf::ChannelList& list, std::string_view name) {
  for (size_t c = 0; c < 4; ++c) {
    const Imf::Channel* channel = list.findChannel(kChannelNames[c]);
    if (!channel && c == 3) return 3;
    if (!channel)
      return fail(ErrorCode::bad_input,
                  "{}: the EXR file has no channel {}; save it with channels R, G and B", name,
                  kChannelNames[c]);
    if (channel->xSampling != 1 || channel->ySampling != 1)
      return fail(ErrorCode::unsupported,
                  "{}: channel {} of the EXR file is subsampled; save it at full resolution", name,
                  kChannelNames[c]);
  }
  return 4;
}

Status check_finite(const Image& image, std::string_view name) {
  for (size_t i = 0; i < image.data.size(); ++i) {
    if (std::isfinite(image.data[i])) continue;
    const size_t pixel = i / size_t(image.channels);
    return fail(ErrorCode::bad_input,
                "{}: pixel ({}, {}) of the EXR file is {}; repair the picture", name,
                pixel % size_t(image.width), pixel / size_t(image.width), image.data[i]);
  }
  return {};
}

/// Bytes of pixels that a byte of the file can stand for, at most. Deflate reaches 1032, run
/// lengths 64 and PIZ's Huffman codes less; DWA keeps blocks of one value in next to nothing.
uint64_t largest_ratio(Imf::Compression compression) {
  const bool dwa = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
  return dwa ? 1 << 14 : 1100;
}

/// The text that ends with a 0 byte at `at`, which moves on behind it; empty where the file ends.
std::string_view text_at(std::span<const std::byte> bytes, size_t& at) {
  const char* first = reinterpret_cast<const char*>(bytes.data()) + at;
  const size_t length = ::strnlen(first, bytes.size() - at);
  at = std::min(at + length + 1, bytes.size());
  return {first, length};
}

/// OpenEXR makes room for as many bytes as an attribute of a header states before it reads them.
Status check_attributes(std::span<const std::byte> bytes, std::string_view name) {
  constexpr size_t kMagicAndVersion = 8, kSizeBytes = 4;
  constexpr auto kParts = std::byte(0x10);  // in the second byte of the version
  const bool has_parts = bytes.size() > 5 && (bytes[5] & kParts) != std::byte(0);
  for (size_t at = kMagicAndVersion; at < bytes.size();) {
    const std::string_view attribute = text_at(bytes, at);
    if (attribute.empty()) {
      // The headers of several parts follow each other, and a last name without letters.
      if (!has_parts || at == bytes.size() || bytes[at] == std::byte(0)) break;
      continue;
    }
    text_at(bytes, at);                         // its type
    if (bytes.size() - at < kSizeBytes) break;  // OpenEXR says so
    uint32_t size = 0;
    for (size_t k = 0; k < kSizeBytes; ++k) size |= uint32_t(bytes[at + k]) << (8 * k);
    at += kSizeBytes;
    if (size > bytes.size() - at)
      return fail(
          ErrorCode::bad_input,
          "{}: an attribute of the EXR file states {} bytes, and {} are left; save it again", name,
          size, bytes.size() - at);
    at += size;
  }
  return {};
}

Result<Image> read_exr(std::span<const std::byte> bytes, std::string_view name) {
  LUXEL_TRY_STATUS(check_attributes(bytes, name));
  MemoryInput stream(bytes);
  Imf::InputFile file(stream);
  const Imath::Box2i window = file.header().dataWindow();
  const int64_t width = int64_t(window.max.x) - window.min.x + 1;
  const int64_t height = int64_t(window.max.y) - window.min.y + 1;
  if (width <= 0 || height <= 0 || uint64_t(width) > kMaxPixels / uint64_t(height))
    return fail(ErrorCode::bad_input, "{}: the EXR file claims {} x {} pixels; the most is {}",
                name, width, height, kMaxPixels);
  LUXEL_TRY(const int channels, channels_of(file.header().channels(), name));
  // Memory for all pixels is taken before the first is read. A channel has two bytes or four.
  if (uint64_t(width * height) * uint64_t(channels) * 2 /
          largest_ratio(file.header().compression()) >
      bytes.size())
    return fail(ErrorCode::bad_input,
                "{}: the EXR file claims {} x {} pixels, more than its {} bytes can hold", name,
                width, height, bytes.size());
  if (!file.isComplete())
    return fail(ErrorCode::bad_input, "{}: the EXR file ends too early; fetch or save it again",
                name);
  Image image(int(width), int(height), channels);
  file.setFrameBuffer(make_frame_buffer(image, window.min.x, window.min.y));
  file.readPixels(window.min.y, window.max.y);
  LUXEL_TRY_STATUS(check_finite(image, name));
  return image;
}

/// OpenEXR makes its pool of threads, an empty one, with the first lines that it reads or writes.
/// Where there is no memory for it, the file waits for ever for these lines.
void make_threads() { Imf::globalThreadCount(); }

/// Rows that ZIP compresses together, and rows that a thread compresses, whole blocks.
constexpr int kBlockRows = 16, kPartRows = 4 * kBlockRows;
int blocks_of(Rows rows) { return (rows.end - rows.begin + kBlockRows - 1) / kBlockRows; }

enum class Blocks : uint8_t { none, all };

/// A file of some rows: a header, the places of its blocks in it, and the blocks.
template <class AnyImage>
std::vector<std::byte> file_of(const AnyImage& image, Rows rows, Blocks blocks) {
  MemoryOutput stream;
  {
    Imf::OutputFile file(stream, make_header(image, rows), 0);
    file.setFrameBuffer(make_frame_buffer(image, 0, 0));
    if (blocks == Blocks::all) file.writePixels(rows.end - rows.begin);
  }  // the places are written when the file closes
  return std::move(stream.bytes);
}

/// A block's place: 8 bytes, the lowest first.
constexpr size_t kOffsetBytes = 8;

/// A file of some of a picture's rows, or why there is none.
struct Part {
  std::vector<std::byte> file;
  int blocks = 0;
  std::string failed;
};

template <class AnyImage>
Part make_part(const AnyImage& image, int number) {
  const Rows rows{number * kPartRows, std::min(image.height, (number + 1) * kPartRows)};
  Part out;
  out.blocks = blocks_of(rows);
  try {
    out.file = file_of(image, rows, Blocks::all);
  } catch (const std::exception& e) {
    out.failed = e.what();
  }
  return out;
}

/// Appends a part's blocks to the file, and writes their places into its table from `table` on,
/// which moves on. Both files' headers have so many bytes.
void append_blocks(const Part& part, size_t header, size_t& table, std::vector<std::byte>& file) {
  const size_t begin = header + size_t(part.blocks) * kOffsetBytes;
  for (int k = 0; k < part.blocks; ++k, table += kOffsetBytes) {
    uint64_t place = 0;
    for (size_t i = 0; i < kOffsetBytes; ++i)
      place |= uint64_t(part.file[header + size_t(k) * kOffsetBytes + i]) << (8 * i);
    place += file.size() - begin;
    for (size_t i = 0; i < kOffsetBytes; ++i) file[table + i] = std::byte(place >> (8 * i));
  }
  file.insert(file.end(), part.file.begin() + long(begin), part.file.end());
}

void put_part(const Part& part, ByteWriter& out) {
  out.put_value(part.blocks), out.put_value(uint64_t(part.file.size()));
  out.put(std::span<const std::byte>(part.file));
  out.put_value(uint64_t(part.failed.size()));
  out.put(std::span<const char>(part.failed));
}

template <class T>
bool take_array(ByteReader& in, T& out) {
  const uint64_t size = in.get_value<uint64_t>();
  if (size > in.bytes.size()) return false;
  out.resize(size);
  in.get(std::span(out.data(), out.size()));
  return in.ok;
}

bool take_part(ByteReader& in, Part& out) {
  out.blocks = in.get_value<int>();
  return take_array(in, out.file) && take_array(in, out.failed);
}

/// The parts' blocks, one part's after the other's, behind the head of the whole file.
template <class AnyImage>
std::vector<std::byte> joined(const AnyImage& image, std::vector<Part> parts) {
  std::vector<std::byte> file = file_of(image, {0, image.height}, Blocks::none);
  const size_t header = file.size() - size_t(blocks_of({0, image.height})) * kOffsetBytes;
  size_t table = header, bytes = file.size();
  for (const Part& part : parts) {
    if (!part.failed.empty()) throw std::runtime_error(part.failed);
    bytes += part.file.size() - header - size_t(part.blocks) * kOffsetBytes;
  }
  file.reserve(bytes);
  for (Part& part : parts) {
    append_blocks(part, header, table, file);
    free_memory(part.file);  // of a large picture there is no room for all twice
  }
  return file;
}

/// `make` makes all parts of the picture, each as a file of its own.
template <class AnyImage>
Result<std::vector<std::byte>> encode_exr_with(const AnyImage& image,
                                               const std::function<Status(std::span<Part>)>& make) {
  LUXEL_CHECK(image.width > 0 && image.height > 0);
  LUXEL_CHECK(image.channels >= 1 && image.channels <= 4);
  try {
    make_threads();
    std::vector<Part> parts(size_t((image.height + kPartRows - 1) / kPartRows));
    LUXEL_TRY_STATUS(make(parts));
    return joined(image, std::move(parts));
  } catch (const std::exception& e) {
    return fail(ErrorCode::io, "an EXR picture of {} x {} pixels cannot be encoded: {}",
                image.width, image.height, e.what());
  }
}

template <class AnyImage>
Result<std::vector<std::byte>> encode_alone(const AnyImage& image) {
  return encode_exr_with(image, [&](std::span<Part> parts) -> Status {
    parallel_for(parts.size(), 1, [&](size_t k, size_t) { parts[k] = make_part(image, int(k)); });
    return {};
  });
}

void check_finite(const Image& image) {
  for (const float v : image.data) LUXEL_CHECK(std::isfinite(v));
}

}  // namespace

Result<std::vector<std::byte>> encode_exr(const Image& image) {
  check_finite(image);
  return encode_alone(image);
}

Result<std::vector<std::byte>> encode_exr(const HalfImage& image) { return encode_alone(image); }

Result<std::vector<std::byte>> encode_exr_together(const Image& image, Team* team,
                                                   Progress& progress) {
  check_finite(image);
  return encode_exr_with(image, [&](std::span<Part> parts) -> Status {
    LUXEL_TRY(const std::vector<uint32_t> own,
              share_out(team, parts.size(), progress,
                        [&](size_t k) { parts[k] = make_part(image, int(k)); }));
    return exchange(team, own,
                    {parts.size(), [&](size_t k, ByteWriter& out) { put_part(parts[k], out); },
                     [&](size_t k, uint32_t, ByteReader& in) { return take_part(in, parts[k]); }},
                    progress);
  });
}

Result<Image> decode_exr(std::span<const std::byte> bytes, std::string_view name) {
  try {
    make_threads();
    return read_exr(bytes, name);
  } catch (const std::exception& e) {
    return fail(ErrorCode::bad_input, "{}: this is not a readable EXR file: {}", name, e.what());
  }
}

}  // namespace luxel::image
