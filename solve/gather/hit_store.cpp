#include "solve/gather/hit_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

#include "base/check.h"

namespace luxel::gather {
namespace {

/// Reads or writes everything at an offset; returns 0 or an errno.
template <class Call, class Byte>
int transfer_all(Call call, int file, Byte* bytes, size_t count, off_t offset) {
  while (count > 0) {
    const ssize_t n = call(file, bytes, count, offset);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : EIO;
    bytes += n, count -= size_t(n), offset += n;
  }
  return 0;
}

}  // namespace

struct HitStore::Impl {
  std::vector<HitTile> tiles;
  size_t tiles_in_memory = 0;
  /// Where a tile of the file begins: a slot for the most hits it can have. Holes take no space.
  uint64_t slot_bytes = 0;
  std::vector<std::vector<uint32_t>> file_ends;  ///< element ends of the tiles in the file
  std::filesystem::path folder;
  int file = -1;
  std::atomic<uint64_t> memory_bytes{0}, file_bytes{0};

  ~Impl() {
    if (file >= 0) ::close(file);
  }
  off_t offset(size_t tile) const { return off_t((tile - tiles_in_memory) * slot_bytes); }
};

HitStore::HitStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HitStore::HitStore(HitStore&&) noexcept = default;
HitStore& HitStore::operator=(HitStore&&) noexcept = default;
HitStore::~HitStore() = default;

Result<HitStore> HitStore::create(size_t element_count, size_t max_hits_per_element,
                                  uint64_t memory_limit_bytes,
                                  const std::filesystem::path& scratch_folder) {
  auto impl = std::make_unique<Impl>();
  const size_t tiles = (element_count + kTileElements - 1) / kTileElements;
  impl->slot_bytes = uint64_t(kTileElements) * max_hits_per_element * sizeof(StoredHit);
  impl->tiles_in_memory =
      impl->slot_bytes == 0
          ? tiles
          : size_t(std::min<uint64_t>(tiles, memory_limit_bytes / impl->slot_bytes));
  impl->tiles.resize(impl->tiles_in_memory);
  impl->file_ends.resize(tiles - impl->tiles_in_memory);
  impl->folder = scratch_folder.empty() ? "." : scratch_folder;
  if (impl->tiles_in_memory < tiles) {
    // O_TMPFILE needs a file system that supports it; a name that is removed at once does not.
    std::string name = (impl->folder / "luxel-hits-XXXXXX").string();
    impl->file = ::mkstemp(name.data());
    if (impl->file < 0)
      return fail(ErrorCode::io, "cannot make a temporary file in {}: {}", impl->folder.string(),
                  std::strerror(errno));
    ::unlink(name.c_str());
  }
  return HitStore(std::move(impl));
}

size_t HitStore::tile_count() const { return impl_->tiles.size() + impl_->file_ends.size(); }

Status HitStore::put(size_t tile, HitTile hits) {
  LUXEL_CHECK(tile < tile_count());
  const size_t bytes = hits.hits.size() * sizeof(StoredHit);
  if (tile < impl_->tiles_in_memory) {
    hits.hits.shrink_to_fit();
    impl_->tiles[tile] = std::move(hits);
    impl_->memory_bytes += bytes;
    return {};
  }
  LUXEL_CHECK(bytes <= impl_->slot_bytes);
  impl_->file_ends[tile - impl_->tiles_in_memory] = std::move(hits.end);
  const int error =
      transfer_all(::pwrite, impl_->file, reinterpret_cast<const char*>(hits.hits.data()), bytes,
                   impl_->offset(tile));
  if (error != 0)
    return fail(error == ENOSPC ? ErrorCode::out_of_disk : ErrorCode::io,
                "cannot write the temporary ray hits to {}: {}; give more --max-memory or a folder "
                "with more room",
                impl_->folder.string(), std::strerror(error));
  impl_->file_bytes += bytes;
  return {};
}

Result<const HitTile*> HitStore::get(size_t tile, HitTile& buffer) const {
  LUXEL_CHECK(tile < tile_count());
  if (tile < impl_->tiles_in_memory) return &impl_->tiles[tile];
  buffer.end = impl_->file_ends[tile - impl_->tiles_in_memory];
  buffer.hits.resize(buffer.end.empty() ? 0 : buffer.end.back());
  const int error = transfer_all(::pread, impl_->file, reinterpret_cast<char*>(buffer.hits.data()),
                                 buffer.hits.size() * sizeof(StoredHit), impl_->offset(tile));
  if (error != 0)
    return fail(ErrorCode::io, "cannot read the temporary ray hits back from {}: {}",
                impl_->folder.string(), std::strerror(error));
  return &buffer;
}

uint64_t HitStore::bytes_in_memory() const { return impl_->memory_bytes; }
uint64_t HitStore::bytes_in_file() const { return impl_->file_bytes; }

}  // namespace luxel::gather
