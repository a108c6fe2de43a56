#include "ingest/files/gdal_scope.hpp"

#include <cstdio>
#include <mutex>

#include <cpl_conv.h>
#include <dlfcn.h>
#include <gdal.h>

namespace talus {

GdalScope::GdalScope() {
  static std::once_flag registered;
  std::call_once(registered, [] { GDALAllRegister(); });
  for (std::size_t i = 0; i < kSettings.size(); ++i) {
    if (const char* old = CPLGetThreadLocalConfigOption(kSettings[i].name, nullptr)) before_[i] = old;
    CPLSetThreadLocalConfigOption(kSettings[i].name, kSettings[i].value);
  }
  CPLPushErrorHandlerEx(&GdalScope::remember, words_.data());
}

GdalScope::~GdalScope() {
  CPLPopErrorHandler();
  for (std::size_t i = 0; i < kSettings.size(); ++i) {
    CPLSetThreadLocalConfigOption(kSettings[i].name, before_[i] ? before_[i]->c_str() : nullptr);
  }
}

std::string GdalScope::reason() const { return words_[0] == '\0' ? std::string{} : ": " + std::string{words_.data()}; }

void GdalScope::remember(CPLErr severity, CPLErrorNum, const char* words) {
  if (severity < CE_Failure) return;
  auto* buffer = static_cast<char*>(CPLGetErrorHandlerUserData());
  std::snprintf(buffer, std::tuple_size_v<decltype(words_)>, "%s", words);
  for (char* c = buffer; *c != '\0'; ++c) {
    if (*c == '\n' || *c == '\r') *c = ' ';  // a message is one line
  }
}

void quiet_hdf5() {
  // GDAL brings this library in any version. Declaring the one function avoids its header.
  using SetAuto = int (*)(std::int64_t stack, void* function, void* data);
  static const auto set_auto = reinterpret_cast<SetAuto>(::dlsym(RTLD_DEFAULT, "H5Eset_auto2"));
  if (set_auto != nullptr) set_auto(0, nullptr, nullptr);
}

RasterCache::RasterCache(std::uint64_t bytes) : before_(GDALGetCacheMax64()) {
  GDALSetCacheMax64(static_cast<GIntBig>(bytes));
}
RasterCache::~RasterCache() { GDALSetCacheMax64(before_); }

}  // namespace talus
