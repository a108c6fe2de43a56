#pragma once
// What the files of this folder share of LMDB.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "storage/map_guard.hpp"
#include "storage/page_store.hpp"

struct MDB_env;
struct MDB_txn;

namespace talus {

/// Throws what an LMDB return code means; MDB_SUCCESS passes.
void check(int code, const char* doing, const std::filesystem::path& file);

struct CloseEnv {
  void operator()(MDB_env* env) const;
};
using EnvPtr = std::unique_ptr<MDB_env, CloseEnv>;

struct AbortTxn {
  void operator()(MDB_txn* txn) const;
};
using TxnPtr = std::unique_ptr<MDB_txn, AbortTxn>;

inline constexpr unsigned kMaxTables = 34;  ///< the header's, 32 bands', the records'

/// "header", "band/07" or "records".
[[nodiscard]] std::string table_name(int table);

struct PageStore::Environment {
  EnvPtr env;
  MapGuard guard;  ///< ends before the map does: its range is free for others then
  /// LMDB's handles of the tables, the header's first. Opened once: two transactions that open tables at a time
  /// share a slot and spoil each other.
  std::array<std::optional<unsigned>, kMaxTables> tables{};
  std::filesystem::path file;
  std::uint64_t file_bytes = 0;
  std::pair<std::uint64_t, std::uint64_t> place;  ///< device and inode: the file itself, whatever its name

  /// Opens those tables that are there and not open yet.
  void open_tables();
  /// Tells the guard where LMDB's map lies, which follows from any page of it.
  void watch_map(MDB_txn* txn);
  /// fails  io: the file has become shorter, or cannot be read any more; what was read since may be zeros
  void require_all_bytes() const;
};

}  // namespace talus
