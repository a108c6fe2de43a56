#pragma once
// Keyed pages in one LMDB file. What a page means is nobody's business here.

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

/// Where a page lies: a named table and a position in it. Keys are big-endian, so that the order of bytes
/// is the order of positions.
struct PageKey {
  int table = 0;  ///< 0 to 31: a band; kHeaderTable: the manifest; kRecordTable: what the levels above a tile must know
  std::uint64_t position = 0;
  friend constexpr auto operator<=>(const PageKey&, const PageKey&) = default;
};
inline constexpr int kHeaderTable = -1, kRecordTable = 32;

/// LMDB gives every value whole pages of the file. The many small pages of table 0 share values, "shelves": those
/// of 64 positions that follow a multiple of 64. A page is still read, and checked, alone.
inline constexpr int kShelfShift = 6;
inline constexpr std::size_t kShelfPages = std::size_t{1} << kShelfShift;
[[nodiscard]] constexpr bool is_shelved(int table) { return table == 0; }

/// The bytes of a page in the file; they live as long as the transaction, at any alignment.
struct StoredPage {
  std::span<const std::byte> content;
  std::uint32_t generation = 0;  ///< which update of the database wrote it
};

struct TableSummary {
  std::uint64_t pages = 0, bytes = 0;  ///< bytes of the pages themselves
};

/// An open file. One LMDB environment per file and process: opening a file twice gives the same one.
class PageStore {
 public:
  /// For reading. The file's outer structure is checked first, so that LMDB never follows a pointer out
  /// of it: sizes always, its trees while they are small (see check_structure).
  /// fails  not_found, corrupt, io
  [[nodiscard]] static PageStore open(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const;
  /// Whether a name leads to the file that is open.
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

/// One consistent view. May move between threads; find() may be called from several at once.
class ReadTxn {
 public:
  explicit ReadTxn(const PageStore& store);
  ~ReadTxn();
  ReadTxn(ReadTxn&&) noexcept;
  ReadTxn& operator=(ReadTxn&&) noexcept;

  /// A page, checked against its checksum. Empty if there is none.
  /// fails  corrupt: checksum; io: the file has become shorter since it was opened, or its disk fails
  [[nodiscard]] std::optional<StoredPage> find(PageKey key) const;

  /// visit(position) for each page of a table in order.
  ///
  /// damaged  if given, told of a shelf that cannot be read, by the position of its first page, and the walk goes on
  /// fails    corrupt: a damaged tree, or shelf without `damaged`
  void for_each(int table, const std::function<void(std::uint64_t position)>& visit,
                const std::function<void(std::uint64_t first, const Failure&)>& damaged = {}) const;
  /// Whether a table has a page at a position. Reads no content.
  /// fails  corrupt: a shelf that is damaged
  [[nodiscard]] bool has(PageKey key) const;
  /// Takes a page, or the shelf it stands on, out of this process's memory: what was read stays counted as the
  /// process's otherwise. Bytes found there before are read anew when they are looked at again.
  void forget(PageKey key) const;
  [[nodiscard]] TableSummary summary(int table) const;
  /// To be asked when what was made of a page's bytes is to be used. A file that has become shorter since find() has
  /// zeros there; they are no failure of find().
  /// fails  io: so it is
  void require_all_bytes() const;
  [[nodiscard]] std::uint64_t file_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes pages into a file that nobody else knows yet, in transactions of some MiB. What was committed survives a
/// crash and is there when the file is opened again.
class PageWriter {
 public:
  /// Begins an empty file or goes on with one.
  /// fails  io, full, corrupt
  explicit PageWriter(std::filesystem::path file);
  ~PageWriter();
  PageWriter(const PageWriter&) = delete;
  PageWriter& operator=(const PageWriter&) = delete;

  /// Replaces a page. Those of one shelf come in a row, in order, all of them: a shelf is written as a whole.
  void put(PageKey key, std::span<const std::byte> page, std::uint32_t generation = 0);
  /// Between commits only whole groups of puts are in the file: call it where what was put makes sense on its own.
  /// Writes when enough has gathered, or at once.
  void commit(bool now = false);
  /// What is in the file. Commits first.
  [[nodiscard]] ReadTxn view();
  /// What was in the file at the last commit.
  [[nodiscard]] ReadTxn committed();
  /// Everything on disk and sealed: a digest over every byte of the file, unused ones too, stands at its end. The
  /// file is whole and closed afterwards. Returns its size.
  std::uint64_t finish();
  /// finish() has closed the file, if it did not get as far as the seal: nothing else may be asked.
  [[nodiscard]] bool is_finished() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes the same pages, generations included, into a file without unused room, and seals it. `to` exists; what it
/// holds is replaced. Fails with io, full. Returns its size.
std::uint64_t write_compact(const PageStore& store, const std::filesystem::path& to);

/// What is wrong with a file's seal, see PageWriter::finish: any byte that has changed since. Reads the whole file.
/// returns  a sentence, empty if every byte is as it was; fails with not_found, io
[[nodiscard]] std::string check_seal(const std::filesystem::path& file);

/// Walks the file's trees page by page without LMDB: every pointer inside the file, every node inside its page.
/// Small trees are always walked when a file is opened; this walks any.
/// returns  sentences, empty if sound; fails with not_found, io
[[nodiscard]] std::vector<std::string> check_structure(const std::filesystem::path& file);

}  // namespace talus
