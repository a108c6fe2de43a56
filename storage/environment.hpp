#pragma once
// The LMDB environment that the files of this folder share.

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

/// Throws a Failure for an LMDB return code, "FILE: cannot DOING: …". MDB_SUCCESS passes.
void check(int code, const char* doing, const std::filesystem::path& file);

struct CloseEnv {
  void operator()(MDB_env* env) const;
};
using EnvPtr = std::unique_ptr<MDB_env, CloseEnv>;

struct AbortTxn {
  void operator()(MDB_txn* txn) const;
};
using TxnPtr = std::unique_ptr<MDB_txn, AbortTxn>;

/// "header", "band/07" or "records".
[[nodiscard]] std::string table_name(int table);
struct PageStore::Environment {
  EnvPtr env;
  MapGuard guard;      ///< destroyed before the map, whose addresses others may use afterwards
  unsigned table = 0;  ///< LMDB's handle of its only table
  std::filesystem::path file;
  std::uint64_t file_bytes = 0;
  std::pair<std::uint64_t, std::uint64_t> place;  ///< device and inode
  /// When a file that is only read was last changed before it was opened, in seconds and nanoseconds.
  std::optional<std::pair<std::int64_t, std::int64_t>> changed_before;

  void open_table();
  /// Finds LMDB's map by any of its pages and has the guard watch it.
  void watch_map(MDB_txn* txn);
  /// Whether another program has written into a file that is only read. Costs one system call.
  [[nodiscard]] bool has_changed() const;
  /// fails  io: the file became shorter, was written into or cannot be read; what was read since then may be wrong
  void require_all_bytes() const;
};

}  // namespace talus
