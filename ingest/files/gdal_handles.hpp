#pragma once
// Owners of what GDAL hands out.

#include <memory>

#include <gdal.h>

namespace talus {

struct CloseDataset {
  void operator()(void* dataset) const { GDALClose(dataset); }
};
using DatasetOwner = std::unique_ptr<void, CloseDataset>;

}  // namespace talus
