# What the libraries link. Used twice: by our own build, and by find_package(Talus), because a static library needs its
# friends again when it is linked. All that is missing is named at once. `talus_components` says what is needed: only
# `ingest` needs GDAL.

set(talus_missing "")
set(talus_missing_packages "")

macro(talus_note_missing what debian)
  list(APPEND talus_missing "  ${what}: Debian package ${debian}")
  list(APPEND talus_missing_packages ${debian})
endmacro()

# A package with CMake files of its own, or a module that comes with CMake.
macro(talus_find_package name debian)
  find_package(${name} QUIET ${ARGN})
  if(NOT ${name}_FOUND)
    talus_note_missing(${name} ${debian})
  endif()
endmacro()

# A package that Debian ships with a pkg-config file only; it becomes the target PkgConfig::<module>.
macro(talus_find_module module debian)
  if(PkgConfig_FOUND AND NOT TARGET PkgConfig::${module})
    pkg_check_modules(${module} QUIET IMPORTED_TARGET ${module})
  endif()
  if(NOT TARGET PkgConfig::${module})
    talus_note_missing(${module} ${debian})
  endif()
endmacro()

function(talus_report_missing)
  if(talus_missing)
    list(REMOVE_DUPLICATES talus_missing_packages)
    list(JOIN talus_missing "\n" lines)
    list(JOIN talus_missing_packages " " packages)
    set(sentence "Talus does not find\n${lines}\nInstall them with 'apt-get install ${packages}'.")
    if(NOT DEFINED CMAKE_FIND_PACKAGE_NAME)
      message(FATAL_ERROR "${sentence}")
    endif()
    set(Talus_FOUND FALSE PARENT_SCOPE)  # find_package(Talus) decides whether this is an error
    set(Talus_NOT_FOUND_MESSAGE "${sentence}" PARENT_SCOPE)
  endif()
endfunction()

talus_find_package(PkgConfig pkg-config)
talus_find_package(fmt libfmt-dev CONFIG)
talus_find_package(nlohmann_json nlohmann-json3-dev CONFIG)
talus_find_module(lmdb liblmdb-dev)
talus_find_module(geographiclib libgeographiclib-dev)
talus_find_module(libzstd libzstd-dev)
talus_find_module(libxxhash libxxhash-dev)
if("ingest" IN_LIST talus_components)
  talus_find_package(GDAL libgdal-dev)
endif()
