# CHOLMOD and UMFPACK of SuiteSparse, and OpenBLAS with its own setting for the number of threads.
# Targets: SuiteSparse::CHOLMOD, SuiteSparse::UMFPACK, SuiteSparse::OpenBLAS
include(FindPackageHandleStandardArgs)
find_path(SuiteSparse_INCLUDE_DIR NAMES cholmod.h umfpack.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_CHOLMOD_LIBRARY NAMES cholmod)
find_library(SuiteSparse_UMFPACK_LIBRARY NAMES umfpack)
find_path(SuiteSparse_OPENBLAS_INCLUDE_DIR NAMES cblas-openblas.h cblas.h PATH_SUFFIXES openblas-pthread openblas)
find_library(SuiteSparse_OPENBLAS_LIBRARY NAMES openblas)
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS
  SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_UMFPACK_LIBRARY SuiteSparse_INCLUDE_DIR
  SuiteSparse_OPENBLAS_LIBRARY SuiteSparse_OPENBLAS_INCLUDE_DIR)
mark_as_advanced(SuiteSparse_INCLUDE_DIR SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_UMFPACK_LIBRARY
  SuiteSparse_OPENBLAS_INCLUDE_DIR SuiteSparse_OPENBLAS_LIBRARY)
if(SuiteSparse_FOUND)
  foreach(part CHOLMOD UMFPACK OPENBLAS)
    set(name ${part})
    set(include_dir ${SuiteSparse_INCLUDE_DIR})
    if(part STREQUAL OPENBLAS)
      set(name OpenBLAS)
      set(include_dir ${SuiteSparse_OPENBLAS_INCLUDE_DIR})
    endif()
    if(NOT TARGET SuiteSparse::${name})
      add_library(SuiteSparse::${name} UNKNOWN IMPORTED)
      set_target_properties(SuiteSparse::${name} PROPERTIES
        IMPORTED_LOCATION ${SuiteSparse_${part}_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${include_dir})
    endif()
  endforeach()
endif()
