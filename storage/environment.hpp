#pragma once
// LMDB's environments and its error numbers; only storage/*.cpp includes this.

#include <lmdb.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "storage/page_store.hpp"

namespace talus {

/// Throws what an LMDB return code means; MDB_SUCCESS passes.
void check(int code, const char* doing, const std::filesystem::path& file);

struct CloseEnv {
  void operator()(MDB_env* env) const { mdb_env_close(env); }
};
using EnvPtr = std::unique_ptr<MDB_env, CloseEnv>;

struct AbortTxn {
  void operator()(MDB_txn* txn) const { mdb_txn_abort(txn); }
};
using TxnPtr = std::unique_ptr<MDB_txn, AbortTxn>;

inline constexpr unsigned kMaxTables = 33;  ///< the header's and 32 bands'

/// "header" or "band/07".
[[nodiscard]] std::string table_name(int table);

struct PageStore::Environment {
  EnvPtr env;
  std::filesystem::path file;
  std::uint64_t file_bytes = 0;
};

}  // namespace talus
