#pragma once
// Owners of GDAL's objects.

#include <memory>

#include <gdal.h>

namespace talus {

struct CloseDataset {
  void operator()(void* dataset) const { GDALClose(dataset); }
};
using DatasetOwner = std::unique_ptr<void, CloseDataset>;

}  // namespace talus
