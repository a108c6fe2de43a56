#include <algorithm>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <lmdb.h>
#include <sys/mman.h>
#include <unistd.h>

#include "storage/environment.hpp"
#include "storage/shelf.hpp"
#include "talus/failure.hpp"

namespace talus {

struct ReadTxn::Impl {
  std::shared_ptr<PageStore::Environment> environment;
  TxnPtr txn;

  [[nodiscard]] const std::filesystem::path& file() const { return environment->file; }
  [[nodiscard]] const std::optional<MDB_dbi>& table(int number) const {
    return environment->tables.at(static_cast<std::size_t>(number - kHeaderTable));
  }
  [[nodiscard]] Failure in_file(const Failure& f) const {
    const std::string sentence = f.what(), kind = "corrupt: ";
    return {f.cause(),
            sentence.starts_with(kind) ? fmt::format("{}{}: {}", kind, file().string(), sentence.substr(kind.size()))
                                       : fmt::format("{}: {}", file().string(), sentence),
            file()};
  }
  [[nodiscard]] std::optional<std::span<const std::byte>> value(int number, std::uint64_t position) const {
    if (!table(number)) return std::nullopt;
    KeyBytes bytes = key_bytes(position);
    MDB_val key{bytes.size(), bytes.data()}, found{};
    const int code = mdb_get(txn.get(), *table(number), &key, &found);
    environment->require_all_bytes();
    if (code == MDB_NOTFOUND) return std::nullopt;
    check(code, "read a page", file());
    return std::span(static_cast<const std::byte*>(found.mv_data), found.mv_size);
  }

  /// visit(position, value) for each value of a table, in order.
  template <class Visit>
  void for_each_value(int number, Visit&& visit) const {
    if (!table(number)) return;
    MDB_cursor* raw = nullptr;
    check(mdb_cursor_open(txn.get(), *table(number), &raw), "read a table", file());
    const std::unique_ptr<MDB_cursor, decltype(&mdb_cursor_close)> cursor(raw, mdb_cursor_close);
    MDB_val key{}, found{};
    int code = mdb_cursor_get(raw, &key, &found, MDB_FIRST);
    for (; code == MDB_SUCCESS; code = mdb_cursor_get(raw, &key, &found, MDB_NEXT)) {
      environment->require_all_bytes();
      if (key.mv_size != sizeof(KeyBytes)) {
        throw Failure(Cause::corrupt, fmt::format("corrupt: {}: table {} has a key of {} bytes", file().string(),
                                                  table_name(number), key.mv_size));
      }
      try {
        visit(position_of(key.mv_data), std::span(static_cast<const std::byte*>(found.mv_data), found.mv_size));
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
  // The first use of a table changes the transaction; afterwards several threads may read.
  for (const auto& table : impl_->environment->tables) {
    MDB_stat ignored{};
    if (table) check(mdb_stat(txn, *table, &ignored), "read a table", impl_->file());
  }
  impl_->environment->require_all_bytes();
}

ReadTxn::~ReadTxn() = default;
ReadTxn::ReadTxn(ReadTxn&&) noexcept = default;
ReadTxn& ReadTxn::operator=(ReadTxn&&) noexcept = default;

std::optional<StoredPage> ReadTxn::find(PageKey key) const {
  const auto value = impl_->value(key.table, value_position(key));
  if (!value) return std::nullopt;
  try {
    if (!is_shelved(key.table)) return unwrapped(key, *value);
    const auto stored = pages_of_shelf(key.table, value_position(key), *value)[key.position % kShelfPages];
    if (stored.empty()) return std::nullopt;
    return unwrapped(key, stored);
  } catch (const Failure& f) {
    impl_->environment->require_all_bytes();
    throw impl_->in_file(f);
  }
}

bool ReadTxn::has(PageKey key) const {
  const auto value = impl_->value(key.table, value_position(key));
  if (!value || !is_shelved(key.table)) return value.has_value();
  try {
    return !pages_of_shelf(key.table, value_position(key), *value)[key.position % kShelfPages].empty();
  } catch (const Failure& f) {
    impl_->environment->require_all_bytes();
    throw impl_->in_file(f);
  }
}

void ReadTxn::forget(PageKey key) const {
  const auto value = impl_->value(key.table, value_position(key));
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
  impl_->for_each_value(table, [&](std::uint64_t position, std::span<const std::byte> value) {
    if (!is_shelved(table)) return visit(position);
    std::array<std::span<const std::byte>, kShelfPages> pages;
    try {
      pages = pages_of_shelf(table, position, value);
    } catch (const Failure& f) {
      if (!damaged) throw;
      return damaged(position << kShelfShift, impl_->in_file(f));
    }
    for (std::size_t i = 0; i < kShelfPages; ++i) {
      if (!pages[i].empty()) visit(position << kShelfShift | i);
    }
  });
}

TableSummary ReadTxn::summary(int table) const {
  TableSummary sum;
  impl_->for_each_value(table, [&](std::uint64_t position, std::span<const std::byte> value) {
    sum.bytes += value.size();
    if (!is_shelved(table)) {
      ++sum.pages;
      return;
    }
    const auto pages = pages_of_shelf(table, position, value);
    sum.pages +=
        static_cast<std::uint64_t>(std::count_if(pages.begin(), pages.end(), [](auto p) { return !p.empty(); }));
  });
  return sum;
}

void ReadTxn::require_all_bytes() const { impl_->environment->require_all_bytes(); }

std::uint64_t ReadTxn::file_bytes() const { return impl_->environment->file_bytes; }

}  // namespace talus
