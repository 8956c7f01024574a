// Rows of a large sparse matrix, one per element, made once and read in every sweep.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/part_store.h"
#include "luxel/base/scratch_file.h"

namespace luxel {

/// The rows of neighbouring elements.
template <class Entry>
struct RowTile {
  std::vector<uint32_t> end;   ///< per element: one past its last entry
  std::vector<Entry> entries;  ///< element after element
};

/// Where the bytes of a tile's entries stand already: in a part, from an offset on.
struct KeptEntries {
  const PartStore* store = nullptr;  ///< null: nowhere
  RecordKey part;
  uint64_t offset = 0;
};

/// Tiles that stay in memory where not all fit.
enum class TilesInMemory : uint8_t {
  first_numbers,
  first_come  ///< for processes that have some of the tiles each, and do not know which
};

/// Keeps tiles in memory up to a limit and the rest in a temporary file, or where they are kept
/// anyway.
template <class Entry>
class RowStore {
  static_assert(std::is_trivially_copyable_v<Entry>);

 public:
  /// Tiles hold `tile_elements` rows each, the last one maybe fewer. `max_entries_per_element` and
  /// `memory_limit_bytes` decide beforehand which tiles go to the file, so that the choice does not
  /// depend on threads; with TilesInMemory::first_come those that come when memory is full. Errors:
  /// no file can be made in `scratch_folder`.
  static Result<RowStore> create(size_t element_count, size_t tile_elements,
                                 size_t max_entries_per_element, uint64_t memory_limit_bytes,
                                 const std::filesystem::path& scratch_folder,
                                 TilesInMemory in_memory = TilesInMemory::first_numbers) {
    RowStore store;
    const size_t tiles = (element_count + tile_elements - 1) / tile_elements;
    store.slot_bytes_ = uint64_t(tile_elements) * max_entries_per_element * sizeof(Entry);
    const size_t fit =
        store.slot_bytes_ == 0
            ? tiles
            : size_t(std::min<uint64_t>(tiles, memory_limit_bytes / store.slot_bytes_));
    store.tiles_.resize(tiles);
    if (fit < tiles) {
      store.kept_.resize(tiles), store.is_in_file_.resize(tiles);
      if (in_memory == TilesInMemory::first_come)
        store.bytes_->still_fit.emplace(int64_t(fit));
      else
        std::fill(store.is_in_file_.begin() + std::ptrdiff_t(fit), store.is_in_file_.end(), 1);
      auto file = ScratchFile::create(scratch_folder);
      if (!file) return Failure{file.error()};
      store.file_ = std::move(*file);
    }
    return store;
  }

  size_t tile_count() const { return tiles_.size(); }

  /// Thread-safe for different tiles. The store of `kept` outlives this. Errors: the disk is full.
  Status put(size_t tile, RowTile<Entry> rows, const KeptEntries& kept = {}) {
    LUXEL_CHECK(tile < tile_count());
    const size_t bytes = rows.entries.size() * sizeof(Entry);
    if (file_ && bytes_->still_fit && (*bytes_->still_fit)-- <= 0) is_in_file_[tile] = 1;
    if (is_in_file(tile)) {
      LUXEL_CHECK(bytes <= slot_bytes_);
      kept_[tile] = kept;
      if (kept.store == nullptr)
        LUXEL_TRY_STATUS(file_->write(offset(tile), rows.entries.data(), bytes));
      rows.entries = {};
    }
    rows.entries.shrink_to_fit();
    tiles_[tile] = std::move(rows);
    (is_in_file(tile) ? bytes_->in_file : bytes_->in_memory) += bytes;
    return {};
  }

  /// The tile itself, or, when it lies in the file, a copy read into `buffer`. Thread-safe.
  Result<const RowTile<Entry>*> get(size_t tile, RowTile<Entry>& buffer) const {
    LUXEL_CHECK(tile < tile_count());
    if (!is_in_file(tile)) return &tiles_[tile];
    buffer.end = tiles_[tile].end;
    buffer.entries.resize(buffer.end.empty() ? 0 : buffer.end.back());
    const KeptEntries& kept = kept_[tile];
    const std::span<std::byte> bytes = std::as_writable_bytes(std::span(buffer.entries));
    if (kept.store == nullptr)
      LUXEL_TRY_STATUS(file_->read(offset(tile), bytes.data(), bytes.size()));
    else if (!kept.store->read(kept.part, kept.offset, bytes))
      return fail(ErrorCode::io, "cannot read {} back: the disk has failed",
                  kept.store->file().string());
    return &buffer;
  }

  uint64_t bytes_in_memory() const { return bytes_->in_memory; }
  uint64_t bytes_in_file() const { return bytes_->in_file; }

 private:
  struct Bytes {
    std::atomic<uint64_t> in_memory{0}, in_file{0};
    std::optional<std::atomic<int64_t>> still_fit{};  ///< first_come: so many tiles more
  };

  bool is_in_file(size_t tile) const { return !is_in_file_.empty() && is_in_file_[tile] != 0; }
  /// A slot for the most that a tile can hold. Holes take no space.
  uint64_t offset(size_t tile) const { return tile * slot_bytes_; }

  std::vector<RowTile<Entry>> tiles_;  ///< without entries where those lie in the file
  // Per tile, where some do not fit into memory: where its entries are kept, and whether in a file.
  std::vector<KeptEntries> kept_;
  std::vector<uint8_t> is_in_file_;
  uint64_t slot_bytes_ = 0;
  std::optional<ScratchFile> file_;
  std::unique_ptr<Bytes> bytes_ = std::make_unique<Bytes>();
};

}  // namespace luxel
