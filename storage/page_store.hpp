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

/// Where a page lies: a named table and a position in it. Keys are big-endian, so that the order of bytes
/// is the order of positions.
struct PageKey {
  int table = 0;  ///< 0 to 31: a band; kHeaderTable: the manifest
  std::uint64_t position = 0;
  friend constexpr auto operator<=>(const PageKey&, const PageKey&) = default;
};
inline constexpr int kHeaderTable = -1;

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
  [[nodiscard]] std::uint64_t file_bytes() const;

  struct Environment;

 private:
  friend class ReadTxn;
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

  /// The bytes of a page, checked against its checksum; they live as long as this transaction, at any
  /// alignment. Empty if there is no such page.
  /// fails  corrupt: checksum
  [[nodiscard]] std::optional<std::span<const std::byte>> find(PageKey key) const;

  /// visit(position) for each page of a table in order.
  void for_each(int table, const std::function<void(std::uint64_t position)>& visit) const;
  [[nodiscard]] TableSummary summary(int table) const;
  [[nodiscard]] std::uint64_t file_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Fills a new file page by page, in batches of some MiB. The file is whole only after finish(); whoever made its
/// name removes it if that never comes.
class PageWriter {
 public:
  /// fails  io, full
  explicit PageWriter(std::filesystem::path file);
  ~PageWriter();
  PageWriter(const PageWriter&) = delete;
  PageWriter& operator=(const PageWriter&) = delete;

  /// Positions of one table should rise: the file is then packed full.
  void put(PageKey key, std::span<const std::byte> page);
  /// Everything on disk. The file is whole and closed afterwards. Returns its size.
  std::uint64_t finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Walks the file's trees page by page without LMDB: every pointer inside the file, every node inside its page.
/// Small trees are always walked when a file is opened; this walks any.
/// returns  sentences, empty if sound; fails with not_found, io
[[nodiscard]] std::vector<std::string> check_structure(const std::filesystem::path& file);

}  // namespace talus
