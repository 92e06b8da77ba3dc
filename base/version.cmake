# Fills in base/version.cpp.in; leaves the output alone when nothing changed.
#   cmake -DROOT=<source folder> -DGIT=<git> -DVERSION=<x.y.z> -DOUTPUT=<file> -P version.cmake
set(COMMIT "")
if(GIT AND EXISTS ${ROOT}/.git)
  execute_process(COMMAND ${GIT} -c safe.directory=* -C ${ROOT} describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE COMMIT ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
if(NOT COMMIT)
  set(COMMIT unknown)
endif()
configure_file(${ROOT}/base/version.cpp.in ${OUTPUT} @ONLY)
