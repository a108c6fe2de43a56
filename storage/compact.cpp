// Writes a copy of a file without the space that updates left unused.

#include <cerrno>
#include <memory>

#include <fcntl.h>
#include <lmdb.h>
#include <unistd.h>

#include "storage/environment.hpp"
#include "storage/page_store.hpp"
#include "storage/seal.hpp"

namespace talus {

std::uint64_t write_compact(const PageStore& store, const std::filesystem::path& to) {
  const int handle = ::open(to.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  if (handle < 0) check(errno, "open it", to);
  const int code = mdb_env_copyfd2(store.environment_->env.get(), handle, MDB_CP_COMPACT);
  ::close(handle);
  check(code, "write it", to);
  put_seal(to);
  return std::filesystem::file_size(to);
}

}  // namespace talus
