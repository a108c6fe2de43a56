#include "storage/lmdb_check.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "storage/page_store.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

// The file format of LMDB 0.9 on 64-bit little-endian machines, data version 1.
constexpr std::uint32_t kMagic = 0xBEEFC0DE, kDataVersion = 1;
constexpr std::size_t kPageHeader = 16, kNodeHeader = 8;
constexpr std::uint64_t kNoPage = ~std::uint64_t{0};
enum PageFlag : std::uint16_t { kBranch = 1, kLeaf = 2, kOverflow = 4, kMeta = 8 };
enum NodeFlag : std::uint16_t { kBigData = 1, kSubData = 2 };
constexpr std::uint64_t kSmallTrees = 4096;  // branch and leaf pages to check at every open: some milliseconds

struct Tree {  // MDB_db
  std::uint32_t pad;
  std::uint16_t flags, depth;
  std::uint64_t branch_pages, leaf_pages, overflow_pages, entries, root;
};
static_assert(sizeof(Tree) == 48);
struct Meta {
  std::uint32_t magic, version;
  std::uint64_t address, map_size;
  std::array<Tree, 2> trees;  // free pages, values
  std::uint64_t last_page, transaction;
};

class File {
 public:
  explicit File(const std::filesystem::path& path) : path_(path), handle_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat status {};
    if (handle_ < 0 || ::fstat(handle_, &status) != 0) {
      const int error = errno;
      if (handle_ >= 0) ::close(handle_);
      throw Failure(error == ENOENT ? Cause::not_found : Cause::io,
                    fmt::format("{}: {}", path.string(), std::strerror(error)));
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~File() { ::close(handle_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }
  void read(std::uint64_t at, void* to, std::size_t bytes) const {
    auto* out = static_cast<char*>(to);
    while (bytes > 0) {
      const ssize_t got = ::pread(handle_, out, bytes, static_cast<off_t>(at));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) throw Failure(Cause::io, fmt::format("{}: cannot read at byte {}", path_.string(), at));
      out += got;
      at += static_cast<std::uint64_t>(got);
      bytes -= static_cast<std::size_t>(got);
    }
  }

 private:
  std::filesystem::path path_;
  int handle_;
  std::uint64_t size_ = 0;
};

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

class Walk {
 public:
  explicit Walk(const std::filesystem::path& path) : file_(path) {}

  /// The newer of the two headers; empty after a finding.
  std::optional<Meta> headers() {
    std::optional<Meta> newest;
    if (file_.size() < 2 * 4096) return fail("it is shorter than its two headers");
    Meta first{};
    file_.read(kPageHeader, &first, sizeof first);
    page_bytes_ = first.trees[0].pad;
    if (first.magic != kMagic) return fail("it has no LMDB header");
    if (first.version != kDataVersion) return fail("its LMDB version is unknown");
    if (page_bytes_ < 512 || page_bytes_ > 65536 || (page_bytes_ & (page_bytes_ - 1)) != 0)
      return fail("its page size is impossible");
    if (file_.size() < 2 * page_bytes_) return fail("it is shorter than its two headers");
    for (const std::uint64_t number : {0u, 1u}) {
      std::array<std::byte, kPageHeader + sizeof(Meta)> bytes{};
      file_.read(number * page_bytes_, bytes.data(), bytes.size());
      const auto meta = load<Meta>(bytes.data() + kPageHeader);
      if (load<std::uint64_t>(bytes.data()) != number || (load<std::uint16_t>(bytes.data() + 10) & kMeta) == 0 ||
          meta.magic != kMagic || meta.version != kDataVersion || meta.trees[0].pad != page_bytes_) {
        return fail(fmt::format("header {} is damaged", number));
      }
      if (!newest || meta.transaction > newest->transaction) newest = meta;
    }
    pages_ = newest->last_page + 1;
    if (newest->last_page >= (std::uint64_t{1} << 47) / page_bytes_ || pages_ * page_bytes_ > file_.size()) {
      return fail(
          fmt::format("it is cut short: it has {} bytes and needs {} pages of {}", file_.size(), pages_, page_bytes_));
    }
    if (newest->map_size < pages_ * page_bytes_ || newest->map_size > std::uint64_t{1} << 47)
      return fail("its map size is impossible");
    return newest;
  }

  void trees(const Meta& meta) {
    used_.assign(pages_, false);
    if (meta.trees[1].flags != 0) fail("its table has the wrong kind");
    for (const Tree& tree : meta.trees) {
      lists_free_ = &tree == &meta.trees[0];
      walk(tree);
    }
    if (visited_ >= limit_ || !findings_.empty()) return;
    for (std::uint64_t page = 2; page < pages_; ++page) {
      if (!used_[page]) leave(page * page_bytes_, (page + 1) * page_bytes_);
    }
    free_pages();
  }
  /// Stops the walk after this many branch and leaf pages.
  void limit(std::uint64_t pages) { limit_ = pages; }
  [[nodiscard]] const std::vector<std::string>& findings() const { return findings_; }

  /// Whether the file has several tables with the names of those of our files before version 3.
  [[nodiscard]] bool is_older() const { return is_older_; }

  /// After trees() without a limit.
  [[nodiscard]] const std::vector<FileRange>& unused() const { return unused_; }

 private:
  std::nullopt_t fail(const std::string& what) {
    if (findings_.size() < 20) findings_.push_back(what);
    return std::nullopt;
  }

  void leave(std::uint64_t first, std::uint64_t end) {
    if (first < end) unused_.push_back({first, end - first});
  }

  void walk(const Tree& tree) {
    if (tree.root == kNoPage) {
      if (tree.entries != 0) fail("a tree has entries but no root");
      return;
    }
    if (tree.depth == 0 || tree.depth > 32) {
      fail("the depth of a tree is impossible");
      return;
    }
    node_page(tree.root, tree.depth);
  }

  void node_page(std::uint64_t number, int depth) {
    if (visited_ >= limit_ || findings_.size() >= 20) return;
    if (number < 2 || number >= pages_) {
      fail(fmt::format("a pointer leads to LMDB page {} of {}", number, pages_));
      return;
    }
    ++visited_;
    if (!use(number, 1)) return;
    std::vector<std::byte> page(page_bytes_);
    file_.read(number * page_bytes_, page.data(), page.size());
    const auto flags = load<std::uint16_t>(&page[10]), lower = load<std::uint16_t>(&page[12]),
               upper = load<std::uint16_t>(&page[14]);
    const bool leaf = depth == 1;
    if (load<std::uint64_t>(page.data()) != number || flags != (leaf ? kLeaf : kBranch)) {
      fail(fmt::format("LMDB page {} differs from what its parent says", number));
      return;
    }
    // LMDB expects at least one node in a leaf and two in a branch; an empty tree has no root.
    if (lower < kPageHeader || lower > upper || upper > page_bytes_ || (lower & 1) != 0 ||
        lower < kPageHeader + (leaf ? 2 : 4)) {
      fail(fmt::format("LMDB page {}: its fill is impossible", number));
      return;
    }
    leave(number * page_bytes_ + lower, number * page_bytes_ + upper);
    for (std::size_t slot = kPageHeader; slot < lower; slot += 2) {
      const std::size_t at = load<std::uint16_t>(&page[slot]);
      if (at < upper || at + kNodeHeader > page_bytes_ || (at & 1) != 0) {
        fail(fmt::format("LMDB page {}: a node lies outside", number));
        return;
      }
      const auto low = load<std::uint16_t>(&page[at]), high = load<std::uint16_t>(&page[at + 2]),
                 node_flags = load<std::uint16_t>(&page[at + 4]), key_bytes = load<std::uint16_t>(&page[at + 6]);
      if (at + kNodeHeader + key_bytes > page_bytes_) {
        fail(fmt::format("LMDB page {}: a key is longer than the page", number));
        return;
      }
      if (!leaf) {
        node_page(low | std::uint64_t{high} << 16 | std::uint64_t{node_flags} << 32, depth - 1);
        continue;
      }
      if (node_flags == kSubData) {
        const std::string_view name(reinterpret_cast<const char*>(&page[at + kNodeHeader]), key_bytes);
        is_older_ = is_older_ || name == "header";
        fail(fmt::format("LMDB page {}: a table in the table", number));
        continue;
      }
      leaf_node(number, page, at + kNodeHeader + key_bytes, low | std::uint64_t{high} << 16, node_flags);
    }
  }

  void leaf_node(std::uint64_t number, const std::vector<std::byte>& page, std::size_t at, std::uint64_t bytes,
                 std::uint16_t flags) {
    if (flags != 0 && flags != kBigData) {
      fail(fmt::format("LMDB page {}: the kind of a node is unknown", number));
      return;
    }
    if (flags == kBigData) {
      if (at + 8 > page_bytes_) {
        fail(fmt::format("LMDB page {}: a node lies outside", number));
        return;
      }
      const auto first = load<std::uint64_t>(&page[at]);
      const std::uint64_t count = (bytes + kPageHeader + page_bytes_ - 1) / page_bytes_;
      if (first < 2 || first >= pages_ || count > pages_ - first) {
        fail(fmt::format("LMDB page {}: a value lies outside the file", number));
        return;
      }
      std::array<std::byte, kPageHeader> header{};
      file_.read(first * page_bytes_, header.data(), header.size());
      if (load<std::uint64_t>(header.data()) != first || load<std::uint16_t>(&header[10]) != kOverflow ||
          load<std::uint32_t>(&header[12]) != count) {
        fail(fmt::format("LMDB page {} differs from what its leaf says", first));
        return;
      }
      leave(first * page_bytes_ + kPageHeader + bytes, (first + count) * page_bytes_);
      if (!use(first, count) || !lists_free_) return;
      std::vector<std::byte> list(bytes);
      file_.read(first * page_bytes_ + kPageHeader, list.data(), list.size());
      note_free(number, list);
      return;
    }
    if (at + bytes > page_bytes_) {
      fail(fmt::format("LMDB page {}: a value is longer than the page", number));
      return;
    }
    const std::uint64_t end = number * page_bytes_ + at + bytes;
    leave(end, end + end % 2);  // nodes begin at even places
    if (lists_free_) note_free(number, std::span(page).subspan(at, bytes));
  }

  /// Marks pages as used; false if one was used before.
  bool use(std::uint64_t first, std::uint64_t count) {
    for (std::uint64_t page = first; page < first + count; ++page) {
      if (used_[page]) {
        fail(fmt::format("LMDB page {} is used twice", page));
        return false;
      }
      used_[page] = true;
    }
    return true;
  }

  /// Reads a list of free pages: the count, then the numbers.
  void note_free(std::uint64_t number, std::span<const std::byte> list) {
    const std::uint64_t count = list.size() < 8 ? 0 : load<std::uint64_t>(list.data());
    if (list.size() < 8 || count > list.size() / 8 - 1) {
      fail(fmt::format("LMDB page {}: its list of free pages is wrong", number));
      return;
    }
    for (std::uint64_t i = 1; i <= count; ++i) free_.push_back(load<std::uint64_t>(&list[8 * i]));
  }

  /// Free pages must not be in use, because a writer overwrites them.
  void free_pages() {
    for (const std::uint64_t page : free_) {
      if (page < 2 || page >= pages_) {
        fail(fmt::format("a free LMDB page has number {} of {}", page, pages_));
      } else if (!use(page, 1)) {
        return;
      }
    }
  }

  File file_;
  std::uint64_t page_bytes_ = 4096, pages_ = 0, limit_ = ~std::uint64_t{0};
  std::uint64_t visited_ = 0;  // branch and leaf pages
  std::vector<bool> used_;     // pages of the file
  std::vector<std::uint64_t> free_;
  std::vector<FileRange> unused_;
  bool lists_free_ = false;  // whether the present tree lists free pages
  bool is_older_ = false;
  std::vector<std::string> findings_;
};

void refuse_findings(const Walk& walk, const std::filesystem::path& file) {
  if (walk.findings().empty()) return;
  if (walk.is_older()) {
    throw Failure(
        Cause::unsupported,
        fmt::format("{}: it is a database of an older version of Talus; ingest its rasters again", file.string()),
        file);
  }
  throw Failure(Cause::corrupt, fmt::format("corrupt: {}: it is not a database, or it is damaged: {}", file.string(),
                                            walk.findings().front()));
}

}  // namespace

void refuse_unsound(const std::filesystem::path& file) {
  Walk walk(file);
  if (const auto meta = walk.headers()) {
    walk.limit(kSmallTrees);
    walk.trees(*meta);
  }
  refuse_findings(walk, file);
}

std::vector<FileRange> unused_ranges(const std::filesystem::path& file) {
  Walk walk(file);
  if (const auto meta = walk.headers()) walk.trees(*meta);
  refuse_findings(walk, file);
  return walk.unused();
}

std::vector<std::string> check_structure(const std::filesystem::path& file) {
  Walk walk(file);
  if (const auto meta = walk.headers()) walk.trees(*meta);
  return walk.findings();
}

}  // namespace talus
