#include <array>
#include <cerrno>

#include <fmt/format.h>
#include <lmdb.h>

#include "storage/checksum.hpp"
#include "storage/environment.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

using KeyBytes = std::array<std::uint8_t, 8>;

KeyBytes key_bytes(std::uint64_t position) {
  KeyBytes bytes{};
  for (std::size_t i = 0; i < 8; ++i) bytes[i] = static_cast<std::uint8_t>(position >> (56 - 8 * i));
  return bytes;
}

std::uint64_t get_big_endian(const void* from) {
  const auto* bytes = static_cast<const std::uint8_t*>(from);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = value << 8 | bytes[i];
  return value;
}

}  // namespace

struct ReadTxn::Impl {
  std::shared_ptr<PageStore::Environment> environment;
  TxnPtr txn;

  [[nodiscard]] const std::filesystem::path& file() const { return environment->file; }
  [[nodiscard]] const std::optional<MDB_dbi>& table(int number) const {
    return environment->tables.at(static_cast<std::size_t>(number - kHeaderTable));
  }
};

ReadTxn::ReadTxn(const PageStore& store) : impl_(std::make_unique<Impl>()) {
  impl_->environment = store.environment_;
  MDB_txn* txn = nullptr;
  check(mdb_txn_begin(impl_->environment->env.get(), nullptr, MDB_RDONLY, &txn), "begin", impl_->file());
  impl_->txn.reset(txn);
  // The first look at a table changes the transaction; after it, several threads may look.
  for (const auto& table : impl_->environment->tables) {
    MDB_stat ignored{};
    if (table) check(mdb_stat(txn, *table, &ignored), "look at a table", impl_->file());
  }
}

ReadTxn::~ReadTxn() = default;
ReadTxn::ReadTxn(ReadTxn&&) noexcept = default;
ReadTxn& ReadTxn::operator=(ReadTxn&&) noexcept = default;

std::optional<std::span<const std::byte>> ReadTxn::find(PageKey key) const {
  const auto& table = impl_->table(key.table);
  if (!table) return std::nullopt;
  KeyBytes bytes = key_bytes(key.position);
  MDB_val at{bytes.size(), bytes.data()}, value{};
  const int code = mdb_get(impl_->txn.get(), *table, &at, &value);
  if (code == MDB_NOTFOUND) return std::nullopt;
  check(code, "read", impl_->file());
  const auto corrupt = [&](const char* what) {
    return Failure(Cause::corrupt, fmt::format("corrupt: {}: page {:#x} of {}: {}", impl_->file().string(),
                                               key.position, table_name(key.table), what));
  };
  if (value.mv_size < kChecksumBytes) throw corrupt("shorter than its checksum");
  const std::span stored(static_cast<const std::byte*>(value.mv_data), value.mv_size);
  const auto content = stored.subspan(kChecksumBytes);
  if (get_big_endian(stored.data()) != page_checksum(key, content)) throw corrupt("checksum");
  return content;
}

void ReadTxn::for_each(int table, const std::function<void(std::uint64_t)>& visit) const {
  const auto& dbi = impl_->table(table);
  if (!dbi) return;
  MDB_cursor* raw = nullptr;
  check(mdb_cursor_open(impl_->txn.get(), *dbi, &raw), "open cursor", impl_->file());
  const std::unique_ptr<MDB_cursor, decltype(&mdb_cursor_close)> cursor(raw, mdb_cursor_close);
  MDB_val key{}, value{};
  int code = mdb_cursor_get(raw, &key, &value, MDB_FIRST);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(raw, &key, &value, MDB_NEXT)) {
    if (key.mv_size != sizeof(KeyBytes)) {
      throw Failure(Cause::corrupt, fmt::format("corrupt: {}: {} has a key of {} bytes", impl_->file().string(),
                                                table_name(table), key.mv_size));
    }
    visit(get_big_endian(key.mv_data));
  }
  if (code != MDB_NOTFOUND) check(code, "walk table", impl_->file());
}

TableSummary ReadTxn::summary(int table) const {
  TableSummary sum;
  for_each(table, [&](std::uint64_t position) {
    KeyBytes bytes = key_bytes(position);
    MDB_val key{bytes.size(), bytes.data()}, value{};
    check(mdb_get(impl_->txn.get(), *impl_->table(table), &key, &value), "read", impl_->file());
    ++sum.pages;
    sum.bytes += value.mv_size;
  });
  return sum;
}

std::uint64_t ReadTxn::file_bytes() const { return impl_->environment->file_bytes; }

// ---- writing -------------------------------------------------------------------------------------

struct PageWriter::Impl {
  std::filesystem::path file;
  EnvPtr env;
  std::size_t map_bytes = std::size_t{64} << 20;
  std::size_t batch_bytes = 0;
  std::vector<std::pair<PageKey, std::vector<std::byte>>> batch;  // kept until committed: a full map replays it

  void write_batch() {
    while (!try_batch()) {
      map_bytes *= 2;
      check(mdb_env_set_mapsize(env.get(), map_bytes), "grow the map", file);
    }
    batch.clear();
    batch_bytes = 0;
  }

  /// False if the map is too small for it; nothing is written then.
  bool try_batch() {
    MDB_txn* raw = nullptr;
    check(mdb_txn_begin(env.get(), nullptr, 0, &raw), "begin", file);
    TxnPtr txn(raw);
    for (const auto& [key, value] : batch) {
      MDB_dbi dbi = 0;
      int code = mdb_dbi_open(raw, table_name(key.table).c_str(), MDB_CREATE, &dbi);
      if (code == MDB_SUCCESS) {
        KeyBytes bytes = key_bytes(key.position);
        MDB_val at{bytes.size(), bytes.data()};
        MDB_val content{value.size(), const_cast<std::byte*>(value.data())};
        code = mdb_put(raw, dbi, &at, &content, MDB_APPEND);
        if (code == MDB_KEYEXIST) code = mdb_put(raw, dbi, &at, &content, 0);  // out of order: found its place
      }
      if (code == MDB_MAP_FULL) return false;
      check(code, "write", file);
    }
    int code = mdb_txn_commit(txn.release());
    if (code == MDB_MAP_FULL) return false;
    // LMDB calls a write that came up short an I/O error; mostly the disk is full.
    if (code == EIO && std::filesystem::space(file).available < batch_bytes) code = ENOSPC;
    check(code, "commit", file);
    return true;
  }
};

PageWriter::PageWriter(std::filesystem::path file) : impl_(std::make_unique<Impl>()) {
  impl_->file = std::move(file);
  MDB_env* env = nullptr;
  check(mdb_env_create(&env), "create environment", impl_->file);
  impl_->env.reset(env);
  check(mdb_env_set_maxdbs(env, kMaxTables), "set tables", impl_->file);
  check(mdb_env_set_mapsize(env, impl_->map_bytes), "set map size", impl_->file);
  // Nobody else knows the file yet: no lock file.
  check(mdb_env_open(env, impl_->file.c_str(), MDB_NOSUBDIR | MDB_NOLOCK | MDB_NOTLS | MDB_NORDAHEAD, 0644), "create",
        impl_->file);
}

PageWriter::~PageWriter() = default;

void PageWriter::put(PageKey key, std::span<const std::byte> page) {
  constexpr std::size_t kBatchBytes = std::size_t{16} << 20;
  std::vector<std::byte> value(kChecksumBytes + page.size());
  const std::uint64_t sum = page_checksum(key, page);
  for (std::size_t i = 0; i < kChecksumBytes; ++i) value[i] = static_cast<std::byte>(sum >> (56 - 8 * i) & 0xff);
  std::copy(page.begin(), page.end(), value.begin() + kChecksumBytes);
  impl_->batch_bytes += value.size();
  impl_->batch.emplace_back(key, std::move(value));
  if (impl_->batch_bytes >= kBatchBytes) impl_->write_batch();
}

std::uint64_t PageWriter::finish() {
  impl_->write_batch();
  check(mdb_env_sync(impl_->env.get(), 1), "sync", impl_->file);
  impl_->env.reset();
  return std::filesystem::file_size(impl_->file);
}

}  // namespace talus
