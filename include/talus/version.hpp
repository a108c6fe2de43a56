#pragma once
// The version of Talus that a program is compiled with.

#define TALUS_VERSION_MAJOR 0
#define TALUS_VERSION_MINOR 1
#define TALUS_VERSION_PATCH 0
/// The version as one number for the preprocessor: 1002003 is 1.2.3.
#define TALUS_VERSION_NUMBER (TALUS_VERSION_MAJOR * 1000000 + TALUS_VERSION_MINOR * 1000 + TALUS_VERSION_PATCH)
