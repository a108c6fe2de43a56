#include "tests/support/older_database.hpp"

#include <stdexcept>

#include <lmdb.h>

namespace talus::support {

void write_older_database(const std::filesystem::path& file, const char* name) {
  const auto check = [](int code) {
    if (code != MDB_SUCCESS) throw std::runtime_error(mdb_strerror(code));
  };
  MDB_env* env = nullptr;
  MDB_txn* txn = nullptr;
  MDB_dbi table = 0;
  check(mdb_env_create(&env));
  check(mdb_env_set_maxdbs(env, 1));
  check(mdb_env_open(env, file.c_str(), MDB_NOSUBDIR | MDB_NOLOCK, 0644));
  check(mdb_txn_begin(env, nullptr, 0, &txn));
  check(mdb_dbi_open(txn, name, MDB_CREATE, &table));
  char key[] = "12345678", bytes[] = "a manifest";
  MDB_val at{8, key}, value{sizeof bytes, bytes};
  check(mdb_put(txn, table, &at, &value, 0));
  check(mdb_txn_commit(txn));
  mdb_env_close(env);
}

}  // namespace talus::support
