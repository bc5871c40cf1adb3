# CHOLMOD and UMFPACK of SuiteSparse, with the METIS and OpenBLAS that they use.
# Targets: SuiteSparse::CHOLMOD, SuiteSparse::UMFPACK, SuiteSparse::METIS, SuiteSparse::OpenBLAS
include(FindPackageHandleStandardArgs)
find_path(SuiteSparse_INCLUDE_DIR NAMES cholmod.h umfpack.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_CHOLMOD_LIBRARY NAMES cholmod)
find_library(SuiteSparse_UMFPACK_LIBRARY NAMES umfpack)
find_path(SuiteSparse_METIS_INCLUDE_DIR NAMES metis.h)
find_library(SuiteSparse_METIS_LIBRARY NAMES metis)
find_path(SuiteSparse_OPENBLAS_INCLUDE_DIR NAMES cblas-openblas.h cblas.h PATH_SUFFIXES openblas-pthread openblas)
find_library(SuiteSparse_OPENBLAS_LIBRARY NAMES openblas)
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS
  SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_UMFPACK_LIBRARY SuiteSparse_INCLUDE_DIR
  SuiteSparse_METIS_LIBRARY SuiteSparse_METIS_INCLUDE_DIR
  SuiteSparse_OPENBLAS_LIBRARY SuiteSparse_OPENBLAS_INCLUDE_DIR)
mark_as_advanced(SuiteSparse_INCLUDE_DIR SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_UMFPACK_LIBRARY
  SuiteSparse_METIS_INCLUDE_DIR SuiteSparse_METIS_LIBRARY
  SuiteSparse_OPENBLAS_INCLUDE_DIR SuiteSparse_OPENBLAS_LIBRARY)
if(SuiteSparse_FOUND)
  set(SuiteSparse_CHOLMOD_INCLUDE_DIR ${SuiteSparse_INCLUDE_DIR})
  set(SuiteSparse_UMFPACK_INCLUDE_DIR ${SuiteSparse_INCLUDE_DIR})
  foreach(part CHOLMOD UMFPACK METIS OPENBLAS)
    string(REPLACE OPENBLAS OpenBLAS name ${part})
    if(NOT TARGET SuiteSparse::${name})
      add_library(SuiteSparse::${name} UNKNOWN IMPORTED)
      set_target_properties(SuiteSparse::${name} PROPERTIES
        IMPORTED_LOCATION ${SuiteSparse_${part}_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${SuiteSparse_${part}_INCLUDE_DIR})
    endif()
  endforeach()
endif()
