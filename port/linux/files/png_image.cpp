#include "port/linux/files/png_image.hpp"

#include <spng.h>

#include <algorithm>
#include <memory>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
// The last chunk, which is the same in every PNG: length, name and checksum.
constexpr std::string_view kEnd{"\0\0\0\0IEND\xae\x42\x60\x82", 12};
constexpr std::uint64_t kDeflateGrowthMax = 1032;  // what zlib can pack at best
constexpr std::size_t kTextChunkBytesMax = 8 * 1024 * 1024;

struct ContextDeleter {
  void operator()(spng_ctx* context) const noexcept { spng_ctx_free(context); }
};

class PngReader {
 public:
  PngReader(const std::string& path, std::span<const std::byte> bytes, const ReadLimits& limits)
      : path_(path), size_bytes_(bytes.size()), context_(spng_ctx_new(0)) {
    if (!context_) throw std::bad_alloc();
    spng_ctx* context = context_.get();
    check(spng_set_image_limits(context, kDimensionMax_px, kDimensionMax_px));
    // No chunk is longer than the file; unpacked texts have a bound of their own.
    check(spng_set_chunk_limits(context, std::max(size_bytes_, kTextChunkBytesMax),
                                std::max(size_bytes_, kTextChunkBytesMax)));
    check(spng_set_png_buffer(context, bytes.data(), bytes.size()));
    // libspng does not read the last checksum, so it would not miss it.
    if (as_text(bytes).rfind(kEnd) == std::string_view::npos)
      throw InputError(path, "damaged PNG: it does not end as one",
                       "copy the file again: it is damaged or cut off");
    check(spng_get_ihdr(context, &header_));
    check_shape(path, header_.width, header_.height, limits,
                "save it as an image of rows and columns");
  }

  [[nodiscard]] const spng_ihdr& header() const noexcept { return header_; }

  void decode(void* pixels, std::size_t size_bytes, int format, int flags) {
    check(spng_decode_image(context_.get(), pixels, size_bytes, format, flags));
    check(spng_decode_chunks(context_.get()));  // what follows the pixels, up to the last chunk
  }

  // A few bytes cannot hold a large image: memory is only taken for what can be there.
  void check_fill() const {
    static constexpr std::uint64_t kChannels[] = {1, 0, 3, 1, 2, 0, 4};
    const std::uint64_t pixel_bits = kChannels[header_.color_type % 7] * header_.bit_depth;
    const std::uint64_t plain_bytes =
        header_.height * ((header_.width * pixel_bits + 7) / 8);  // 2^20 x 2^20 x 8 at most
    if (plain_bytes / kDeflateGrowthMax <= size_bytes_) return;
    throw InputError(path_,
                     std::to_string(size_bytes_) + " bytes cannot hold " +
                         std::to_string(header_.width) + " x " + std::to_string(header_.height) +
                         " pixels",
                     "copy the file again: it is damaged or cut off");
  }

 private:
  void check(int error) const {
    if (error == SPNG_OK) return;
    if (error == SPNG_EMEM) throw std::bad_alloc();
    if (error == SPNG_EUSER_WIDTH || error == SPNG_EUSER_HEIGHT)
      throw InputError(
          path_, "more than " + std::to_string(kDimensionMax_px) + " pixels in a row or column",
          "check the file or crop the scan");
    throw InputError(path_, std::string("damaged PNG: ") + spng_strerror(error),
                     "copy the file again: it is damaged or cut off");
  }

  const std::string& path_;
  std::size_t size_bytes_;
  std::unique_ptr<spng_ctx, ContextDeleter> context_;
  spng_ihdr header_{};
};

std::string kind_of(const spng_ihdr& header) {
  const char* colour = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE         ? "grey"
                       : header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA ? "grey with alpha"
                       : header.color_type == SPNG_COLOR_TYPE_INDEXED         ? "palette"
                       : header.color_type == SPNG_COLOR_TYPE_TRUECOLOR       ? "RGB"
                                                                              : "RGBA";
  return "it is " + std::to_string(header.bit_depth) + "-bit " + colour;
}

}  // namespace

bool is_png(std::span<const std::byte> bytes) noexcept {
  return as_text(bytes).starts_with(kSignature);
}

PngImage read_png(const std::string& path, std::span<const std::byte> bytes, PngKind kind,
                  const ReadLimits& limits) {
  PngReader reader(path, bytes, limits);
  const spng_ihdr& header = reader.header();
  PngImage image;
  image.width_px = static_cast<int>(header.width);
  image.height_px = static_cast<int>(header.height);
  const std::size_t count = std::size_t{header.width} * header.height;
  if (kind == PngKind::kGrey16) {
    if (header.color_type != SPNG_COLOR_TYPE_GRAYSCALE || header.bit_depth != 16)
      throw InputError(path, kind_of(header) + ", not 16-bit grey",
                       "save the depth as 16-bit grey PNG");
    reader.check_fill();
    image.grey.resize(count);
    reader.decode(image.grey.data(), count * sizeof(std::uint16_t), SPNG_FMT_PNG, 0);
    return image;
  }
  const bool coloured = header.color_type == SPNG_COLOR_TYPE_TRUECOLOR ||
                        header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
                        header.color_type == SPNG_COLOR_TYPE_INDEXED;
  if (!coloured || header.bit_depth > 8)
    throw InputError(path, kind_of(header) + ", not 8-bit colour",
                     "save it as 8-bit RGB, RGBA or palette PNG");
  reader.check_fill();
  image.rgba.resize(4 * count);
  reader.decode(image.rgba.data(), image.rgba.size(), SPNG_FMT_RGBA8, SPNG_DECODE_TRNS);
  return image;
}

}  // namespace flatpose::port
