// The writer: collects pages and writes them in large transactions.

#include <algorithm>
#include <cerrno>
#include <map>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <lmdb.h>

#include "storage/environment.hpp"
#include "storage/seal.hpp"
#include "storage/tile_value.hpp"
#include "talus/failure.hpp"

namespace talus {

struct PageWriter::Impl {
  struct Value {
    PageKey key;
    std::variant<std::vector<std::byte>, TileParts> content;  ///< a page, or all that a tile has

    [[nodiscard]] std::size_t size() const {
      const auto* tile = std::get_if<TileParts>(&content);
      return tile != nullptr ? tile_size(*tile) : std::get<0>(content).size();
    }
    void lay(std::byte* to) const {
      if (const auto* tile = std::get_if<TileParts>(&content)) {
        lay_tile(key.position, *tile, to);
      } else {
        std::copy(std::get<0>(content).begin(), std::get<0>(content).end(), to);
      }
    }
  };
  static constexpr std::size_t kBatchBytes = std::size_t{16} << 20;

  std::shared_ptr<PageStore::Environment> environment = std::make_shared<PageStore::Environment>();
  std::size_t map_bytes = std::size_t{64} << 20;
  std::vector<Value> batch;                    // kept until committed, because it is written again after the map grew
  std::map<std::uint64_t, std::size_t> tiles;  // which of them are tiles
  std::size_t batch_bytes = 0;

  [[nodiscard]] MDB_env* env() const { return environment->env.get(); }
  [[nodiscard]] const std::filesystem::path& file() const { return environment->file; }

  void put(PageKey key, std::vector<std::byte> stored) {
    batch_bytes += stored.size();
    const PageKey at = value_key(key);
    if (!is_of_tile(key.table)) return batch.push_back({at, std::move(stored)});
    const auto [tile, is_new] = tiles.try_emplace(at.position, batch.size());
    if (is_new) batch.push_back({at, TileParts{}});
    std::get<TileParts>(batch[tile->second].content)[part_of(key)] = std::move(stored);
  }

  void write_batch() {
    while (!try_batch()) {
      map_bytes *= 2;
      check(mdb_env_set_mapsize(env(), map_bytes), "enlarge it", file());
    }
    batch.clear();
    tiles.clear();
    batch_bytes = 0;
  }

  /// False if the map is too small; then nothing is written.
  bool try_batch() {
    if (batch.empty()) return true;
    MDB_txn* raw = nullptr;
    check(mdb_txn_begin(env(), nullptr, 0, &raw), "write it", file());
    TxnPtr txn(raw);
    MDB_dbi table = 0;
    check(mdb_dbi_open(raw, nullptr, 0, &table), "write it", file());
    for (const Value& value : batch) {
      MDB_val room{value.size(), nullptr};  // LMDB returns the position in the file, so pages are copied once
      KeyBytes key = key_bytes(value.key);
      MDB_val at{key.size(), key.data()};
      int code = mdb_put(raw, table, &at, &room, MDB_APPEND | MDB_RESERVE);
      if (code == MDB_KEYEXIST) code = mdb_put(raw, table, &at, &room, MDB_RESERVE);  // not the largest key: insert
      if (code == MDB_MAP_FULL) return false;
      check(code, "write a page", file());
      value.lay(static_cast<std::byte*>(room.mv_data));
    }
    int code = mdb_txn_commit(txn.release());
    if (code == MDB_MAP_FULL) return false;
    // LMDB reports an incomplete write as an I/O error; mostly the disk is full.
    if (code == EIO && std::filesystem::space(file()).available < batch_bytes) code = ENOSPC;
    check(code, "write it", file());
    return true;
  }
};

PageWriter::PageWriter(std::filesystem::path file) : impl_(std::make_unique<Impl>()) {
  PageStore::Environment& made = *impl_->environment;
  made.file = std::move(file);
  break_seal(made.file);
  MDB_env* env = nullptr;
  check(mdb_env_create(&env), "create it", made.file);
  made.env.reset(env);
  std::error_code ignored;
  for (const auto there = std::filesystem::file_size(made.file, ignored); !ignored && impl_->map_bytes < 2 * there;)
    impl_->map_bytes *= 2;
  check(mdb_env_set_mapsize(env, impl_->map_bytes), "create it", made.file);
  // No other process uses the file yet, so it needs no lock file.
  check(mdb_env_open(env, made.file.c_str(), MDB_NOSUBDIR | MDB_NOLOCK | MDB_NOTLS | MDB_NORDAHEAD, 0644), "create it",
        made.file);
}

PageWriter::~PageWriter() = default;

void PageWriter::put(PageKey key, std::span<const std::byte> page, std::uint32_t generation) {
  impl_->put(key, wrapped(key, generation, page));
}

void PageWriter::commit(bool now) {
  if (now || impl_->batch_bytes >= Impl::kBatchBytes) impl_->write_batch();
}

ReadTxn PageWriter::view() {
  impl_->write_batch();
  return committed();
}

ReadTxn PageWriter::committed() {
  impl_->environment->open_table();
  return ReadTxn(PageStore(impl_->environment));
}

bool PageWriter::is_finished() const { return impl_->environment == nullptr; }

std::uint64_t PageWriter::finish() {
  impl_->write_batch();
  check(mdb_env_sync(impl_->env(), 1), "write it to the disk", impl_->file());
  const std::filesystem::path file = impl_->file();
  impl_->environment.reset();
  put_seal(file);
  return std::filesystem::file_size(file);
}

}  // namespace talus
