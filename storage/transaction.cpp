#include <algorithm>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <lmdb.h>
#include <sys/mman.h>
#include <unistd.h>

#include "storage/checksum.hpp"
#include "storage/environment.hpp"
#include "storage/tile_value.hpp"
#include "talus/failure.hpp"

namespace talus {

struct ReadTxn::Impl {
  std::shared_ptr<PageStore::Environment> environment;
  TxnPtr txn;

  [[nodiscard]] const std::filesystem::path& file() const { return environment->file; }
  [[nodiscard]] Failure in_file(const Failure& f) const {
    const std::string sentence = f.what(), kind = "corrupt: ";
    return {f.cause(),
            sentence.starts_with(kind) ? fmt::format("{}{}: {}", kind, file().string(), sentence.substr(kind.size()))
                                       : fmt::format("{}: {}", file().string(), sentence),
            file()};
  }
  [[nodiscard]] std::optional<std::span<const std::byte>> value(PageKey at) const {
    KeyBytes bytes = key_bytes(at);
    MDB_val key{bytes.size(), bytes.data()}, found{};
    const int code = mdb_get(txn.get(), environment->table, &key, &found);
    environment->require_all_bytes();
    if (code == MDB_NOTFOUND) return std::nullopt;
    check(code, "read a page", file());
    return std::span(static_cast<const std::byte*>(found.mv_data), found.mv_size);
  }

  /// A page as it is stored; empty: there is none.
  [[nodiscard]] std::span<const std::byte> stored(PageKey key) const {
    const auto found = value(value_key(key));
    if (!found) return {};
    if (!is_of_tile(key.table)) return *found;
    try {
      return parts_of_tile(value_key(key).position, *found)[part_of(key)];
    } catch (const Failure& f) {
      environment->require_all_bytes();
      throw in_file(f);
    }
  }

  /// visit(position, value) for each value of a table, in order.
  template <class Visit>
  void for_each_value(int table, Visit&& visit) const {
    MDB_cursor* raw = nullptr;
    check(mdb_cursor_open(txn.get(), environment->table, &raw), "read a table", file());
    const std::unique_ptr<MDB_cursor, decltype(&mdb_cursor_close)> cursor(raw, mdb_cursor_close);
    KeyBytes first = key_bytes({table, 0});
    MDB_val key{first.size(), first.data()}, found{};
    int code = mdb_cursor_get(raw, &key, &found, MDB_SET_RANGE);
    for (; code == MDB_SUCCESS; code = mdb_cursor_get(raw, &key, &found, MDB_NEXT)) {
      environment->require_all_bytes();
      const auto at = key_from({static_cast<const std::byte*>(key.mv_data), key.mv_size});
      if (!at)
        throw Failure(Cause::corrupt, fmt::format("corrupt: {}: a key is not one of a database", file().string()));
      if (at->table != table) return;
      try {
        visit(at->position, std::span(static_cast<const std::byte*>(found.mv_data), found.mv_size));
      } catch (const Failure& f) {
        environment->require_all_bytes();
        throw f.cause() == Cause::corrupt ? in_file(f) : f;
      }
    }
    environment->require_all_bytes();
    if (code != MDB_NOTFOUND) check(code, "read a table", file());
  }
};

ReadTxn::ReadTxn(const PageStore& store) : impl_(std::make_unique<Impl>()) {
  impl_->environment = store.environment_;
  MDB_txn* txn = nullptr;
  check(mdb_txn_begin(impl_->environment->env.get(), nullptr, MDB_RDONLY, &txn), "read it", impl_->file());
  impl_->txn.reset(txn);
  // The first use of the table changes the transaction; afterwards several threads may read.
  MDB_stat ignored{};
  check(mdb_stat(txn, impl_->environment->table, &ignored), "read its table", impl_->file());
  impl_->environment->require_all_bytes();
}

ReadTxn::~ReadTxn() = default;
ReadTxn::ReadTxn(ReadTxn&&) noexcept = default;
ReadTxn& ReadTxn::operator=(ReadTxn&&) noexcept = default;

std::optional<StoredPage> ReadTxn::find(PageKey key) const {
  const auto stored = impl_->stored(key);
  if (stored.empty()) return std::nullopt;
  try {
    return unwrapped(key, stored);
  } catch (const Failure& f) {
    impl_->environment->require_all_bytes();
    throw impl_->in_file(f);
  }
}

bool ReadTxn::has(PageKey key) const { return !impl_->stored(key).empty(); }

std::span<const std::byte> ReadTxn::unchecked(PageKey key) const {
  const auto stored = impl_->stored(key);
  return stored.subspan(std::min(stored.size(), kPagePrefixBytes));
}

void ReadTxn::forget(PageKey key) const {
  const auto value = impl_->value(value_key(key));
  if (!value) return;
  // A large value begins after the header of its first page. The page's number there says how far the map's start is.
  constexpr std::uintptr_t kHeader = 16, kAround = std::uintptr_t{64} << 10;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto at = reinterpret_cast<std::uintptr_t>(value->data());
  if (at % page != kHeader) return;  // a small value, inside a page of the tree
  std::uint64_t number = 0;
  std::memcpy(&number, value->data() - kHeader, sizeof number);
  MDB_stat sizes{};
  MDB_envinfo info{};
  check(mdb_env_stat(impl_->environment->env.get(), &sizes), "read its size", impl_->file());
  check(mdb_env_info(impl_->environment->env.get(), &info), "read its size", impl_->file());
  if (sizes.ms_psize % page != 0 || number > info.me_last_pgno) return;
  const std::uintptr_t begin = at - kHeader - number * sizes.ms_psize, end = begin + info.me_mapsize;
  // The system also loads pages around it. A shared read-only map loses nothing when they are dropped.
  const std::uintptr_t first = std::max(begin, (at - kHeader) / page * page - std::min(at - kHeader, kAround));
  const std::uintptr_t last = std::min(end, (at + value->size() + page - 1) / page * page + kAround);
  if (last > first) ::madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);
}

void ReadTxn::for_each(int table, const std::function<void(std::uint64_t)>& visit,
                       const std::function<void(std::uint64_t, const Failure&)>& damaged) const {
  if (!is_of_tile(table)) return impl_->for_each_value(table, [&](std::uint64_t position, auto&&) { visit(position); });
  impl_->for_each_value(kTileTable, [&](std::uint64_t tile, std::span<const std::byte> value) {
    std::array<std::span<const std::byte>, kTileParts> parts;
    try {
      parts = parts_of_tile(tile, value);
    } catch (const Failure& f) {
      if (!damaged) throw;
      return damaged(position_in_tile(table, tile, 0), impl_->in_file(f));
    }
    for (std::size_t i = 0; i < pages_in_tile(table); ++i) {
      const std::uint64_t position = position_in_tile(table, tile, i);
      if (!parts[part_of({table, position})].empty()) visit(position);
    }
  });
}

TableSummary ReadTxn::summary(int table) const {
  TableSummary sum;
  const auto add = [&](std::span<const std::byte> stored) {
    sum.pages += stored.empty() ? 0 : 1;
    sum.bytes += stored.size();
  };
  if (!is_of_tile(table)) {
    impl_->for_each_value(table, [&](std::uint64_t, std::span<const std::byte> value) { add(value); });
    return sum;
  }
  impl_->for_each_value(kTileTable, [&](std::uint64_t tile, std::span<const std::byte> value) {
    const auto parts = parts_of_tile(tile, value);
    for (std::size_t i = 0; i < pages_in_tile(table); ++i)
      add(parts[part_of({table, position_in_tile(table, tile, i)})]);
    sum.bytes += table == 1 ? kTileDirectoryBytes : 0;
  });
  return sum;
}

void ReadTxn::require_all_bytes() const { impl_->environment->require_all_bytes(); }

std::uint64_t ReadTxn::file_bytes() const { return impl_->environment->file_bytes; }

}  // namespace talus
