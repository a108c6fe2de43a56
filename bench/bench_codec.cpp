// What do pages of real terrain take: bits a sample by part, and the time to write and to read them?
//
//   bench_codec DATABASE...
//
// Reads every page of databases that `talus ingest` made, writes them anew and reads them back.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <vector>

#include "engine/page/page_codec.hpp"
#include "query/pages/stored_pages.hpp"
#include "tests/support/given_page.hpp"

namespace talus {
namespace {

/// Processor time: the machine may be busy with something else.
double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// The least of five runs.
template <class Run>
double time_of(Run&& run) {
  double best = 1e99;
  for (int attempt = 0; attempt < 5; ++attempt) {
    const double start = now();
    run();
    best = std::min(best, now() - start);
  }
  return best;
}

std::vector<Page> pages_of(const StoredPages& stored, int band) {
  std::vector<Page> pages;
  PageDecoder decoder;
  QueryCost unused;
  stored.transaction().for_each(band, [&](std::uint64_t position) {
    pages.push_back(
        support::given_page(stored.get(page_at(band, position), decoder, unused, nullptr), stored.distance()));
  });
  return pages;
}

/// Bits of a sample of the raster, void ones included, as the sizes of other formats are quoted.
void measure(const char* file) {
  const PageStore store = PageStore::open(file);
  const StoredPages stored(store, std::make_shared<PageCache>(0));
  const Manifest& manifest = stored.manifest();
  const GridRect extent = manifest.description.extent;
  const CodeDistance& distance = stored.distance();
  const double samples = static_cast<double>(extent.samples()) / 8;
  double bytes = 0, in_file = 0, above_finest = 0, coded = 0, encoding = 0, decoding = 0, decoding_heights = 0;
  PageEncoder::Parts parts;
  for (int band = 0; band < manifest.bands; ++band) {
    const std::vector<Page> pages = pages_of(stored, band);
    PageEncoder encoder;
    PageDecoder decoder;
    std::vector<std::vector<std::byte>> written(pages.size());
    const auto each = [&](auto&& run) {
      return time_of([&] {
        for (std::size_t i = 0; i < pages.size(); ++i) run(i);
      });
    };
    encoding += each([&](std::size_t i) { written[i] = encoder.encode(pages[i], distance); });
    decoding += each([&](std::size_t i) {
      static_cast<void>(decoder.decode(pages[i].id, extent, manifest.bands, distance, written[i]));
    });
    decoding_heights += each([&](std::size_t i) {
      static_cast<void>(decoder.decode_heights(pages[i].id, extent, manifest.bands, distance, written[i]));
    });
    for (std::size_t i = 0; i < pages.size(); ++i) {
      const auto size = static_cast<double>(written[i].size());
      bytes += size;
      in_file += std::ceil((size + 8 + 16) / 4096) * 4096;  // a checksum and LMDB's head, in pages of LMDB
      if (band > 0) above_finest += size;
      coded += static_cast<double>(pages[i].grid.size());
      static_cast<void>(encoder.encode(pages[i], distance));
      const PageEncoder::Parts of_page = encoder.parts();
      parts.heights += of_page.heights / 8;
      parts.errors += of_page.errors / 8;
      parts.voids += of_page.voids / 8;
    }
  }
  std::printf("%-34s %6.2f %7.2f %6.2f %5.2f %7.2f %7.2f %6.0f %6.0f %7.0f\n", file, bytes / samples,
              parts.heights / samples, parts.errors / samples, parts.voids / samples, above_finest / samples,
              in_file / samples, coded / encoding / 1e6, coded / decoding / 1e6, coded / decoding_heights / 1e6);
}

}  // namespace
}  // namespace talus

int main(int count, char** arguments) {
  std::printf(
      "bits a sample, void ones counted           all heights errors voids band>=1 in LMDB |encode decode heights, "
      "Ms/s\n");
  for (int i = 1; i < count; ++i) talus::measure(arguments[i]);
  return count > 1 ? 0 : 2;
}
