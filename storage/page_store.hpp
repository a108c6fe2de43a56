#pragma once
// Pages under keys in one LMDB file. It does not know what a page contains.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace talus {

class Failure;

/// The key of a page: a table and a position in it. Keys are big endian, so they sort by position.
struct PageKey {
  int table = 0;  ///< 0 to 31: a band; kHeaderTable: the manifest; kRecordTable: tile records; kSliceTable: slices
  std::uint64_t position = 0;
  friend constexpr auto operator<=>(const PageKey&, const PageKey&) = default;
};
inline constexpr int kHeaderTable = -1, kRecordTable = 32, kSliceTable = 33;

/// In LMDB each large value takes whole pages of the file. So all that belongs to a tile is one value: the page of band 1
/// at its position, that page's 64 child pages, its slice and its record. Each of these is still read and checked alone.
inline constexpr int kTileTable = 0, kLastBandTable = 31;  ///< in LMDB, the first one is that of tiles
inline constexpr std::size_t kTilePages = 64;              ///< of band 0
inline constexpr std::size_t kTileDirectoryBytes = 8 + 4 * (kTilePages + 3);
[[nodiscard]] constexpr bool is_of_tile(int table) {
  return table == 0 || table == 1 || table == kRecordTable || table == kSliceTable;
}

/// A page in the mapped file, at any alignment; valid as long as the transaction.
struct StoredPage {
  std::span<const std::byte> content;
  std::uint32_t generation = 0;  ///< the update that wrote it
};

struct TableSummary {
  std::uint64_t pages = 0, bytes = 0;  ///< stored bytes; those of directories count for table 1
};

/// An open file. A process has one LMDB environment a file: opening it again returns the same one.
class PageStore {
 public:
  /// Opens a file for reading. It checks the sizes, and the trees if they are small (see check_structure), so that LMDB
  /// never follows a pointer out of the file.
  /// fails  not_found, corrupt, io
  [[nodiscard]] static PageStore open(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const;
  /// Whether a name leads to the open file.
  [[nodiscard]] bool is_file(const std::filesystem::path& name) const;
  [[nodiscard]] std::uint64_t file_bytes() const;

  struct Environment;

 private:
  friend class ReadTxn;
  friend class PageWriter;
  friend std::uint64_t write_compact(const PageStore& store, const std::filesystem::path& to);
  explicit PageStore(std::shared_ptr<Environment> environment) : environment_(std::move(environment)) {}
  std::shared_ptr<Environment> environment_;
};

/// One consistent view. It may move between threads, and several may read at once.
class ReadTxn {
 public:
  explicit ReadTxn(const PageStore& store);
  ~ReadTxn();
  ReadTxn(ReadTxn&&) noexcept;
  ReadTxn& operator=(ReadTxn&&) noexcept;

  /// A page whose checksum is right; empty: there is none.
  /// fails  corrupt: its checksum is wrong; io: the file became shorter, or its disk fails
  [[nodiscard]] std::optional<StoredPage> find(PageKey key) const;

  /// A page's content without a look at its checksum, to decide whether to read the page; empty: there is none.
  /// fails  corrupt: a damaged tile; io
  [[nodiscard]] std::span<const std::byte> unchecked(PageKey key) const;

  /// visit(position) for each page of a table, in order.
  ///
  /// damaged  called for a damaged tile with the first position that it has in the table, and the walk continues; empty:
  ///          it fails
  /// fails    corrupt: a damaged tree, or a damaged tile without `damaged`
  void for_each(int table, const std::function<void(std::uint64_t position)>& visit,
                const std::function<void(std::uint64_t first, const Failure&)>& damaged = {}) const;
  /// Whether a table has a page at a position. Reads no content.
  /// fails  corrupt: a damaged tile
  [[nodiscard]] bool has(PageKey key) const;
  /// Removes a page, or its whole tile, from this process's memory; otherwise what was read counts as used. Spans to
  /// it stay valid and are read again when needed.
  void forget(PageKey key) const;
  [[nodiscard]] TableSummary summary(int table) const;
  /// Call it before using the result of reading pages: if the file became shorter after find(), its bytes are zeros.
  /// fails  io: bytes were lost
  void require_all_bytes() const;
  [[nodiscard]] std::uint64_t file_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes pages into a new file in transactions of some MiB. Committed pages survive a crash.
class PageWriter {
 public:
  /// Opens a file, or makes an empty one.
  /// fails  io, full, corrupt
  explicit PageWriter(std::filesystem::path file);
  ~PageWriter();
  PageWriter(const PageWriter&) = delete;
  PageWriter& operator=(const PageWriter&) = delete;

  /// Sets a page. Put all that a tile has in one group: it is written as a whole.
  void put(PageKey key, std::span<const std::byte> page, std::uint32_t generation = 0);
  /// Ends a group of puts; the file has whole groups only. Writes when enough has gathered, or at once.
  void commit(bool now = false);
  /// The file's content after a commit.
  [[nodiscard]] ReadTxn view();
  /// The file's content at the last commit.
  [[nodiscard]] ReadTxn committed();
  /// Writes everything to disk, appends the seal (a digest over every byte of the file) and closes the file. Returns
  /// its size.
  std::uint64_t finish();
  /// Whether finish() closed the file, perhaps without a seal. Then call nothing else.
  [[nodiscard]] bool is_finished() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes the same pages with their generations into a file without unused space, and seals it. Replaces the content of
/// `to`, which must exist. Returns its size. fails  io, full
std::uint64_t write_compact(const PageStore& store, const std::filesystem::path& to);

/// Checks every byte of a file against its seal, see PageWriter::finish.
/// returns  a sentence about what is wrong, or empty. fails  not_found, io
[[nodiscard]] std::string check_seal(const std::filesystem::path& file);

/// Checks the file's trees without LMDB: every pointer stays in the file, every node in its page. open() checks only
/// small trees.
/// returns  sentences about what is wrong, or none. fails  not_found, io
[[nodiscard]] std::vector<std::string> check_structure(const std::filesystem::path& file);

}  // namespace talus
