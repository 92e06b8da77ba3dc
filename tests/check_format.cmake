# Every source file is as clang-format leaves it.
#   cmake -DROOT=<source folder> -DCLANG_FORMAT=<clang-format> -P check_format.cmake
# Another version of clang-format formats differently: the check speaks for Debian 12's (14) only.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${CLANG_FORMAT} --version OUTPUT_VARIABLE version)
if(NOT version MATCHES "version 14\\.")
  message("format not checked: ${CLANG_FORMAT} is not version 14")
  return()
endif()
set(sources "")
foreach(folder base dem fem coupling tests)
  file(GLOB_RECURSE found ${ROOT}/${folder}/*.hpp ${ROOT}/${folder}/*.cpp ${ROOT}/${folder}/*.cu)
  list(APPEND sources ${found})
endforeach()
execute_process(COMMAND ${CLANG_FORMAT} --dry-run --Werror --style=file ${sources}
  WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE result ERROR_VARIABLE text)
if(NOT result EQUAL 0)
  string(REGEX MATCHALL "[^\n:]+:[0-9]+:" places "${text}")
  list(TRANSFORM places REPLACE ":[0-9]+:$" "")
  list(REMOVE_DUPLICATES places)
  list(JOIN places "\n  " text)
  message(FATAL_ERROR "not formatted; run clang-format -i on\n  ${text}")
endif()
