# Only the agreed entries stand at the top of the repository.
#   cmake -DROOT=<source folder> -DGIT=<git> -P check_layout.cmake
cmake_minimum_required(VERSION 3.25)
set(agreed CMakeLists.txt CMakePresets.json README.md LICENSE CHANGELOG.md CONTRIBUTING.md trackbed base dem fem coupling
  meshes tests configs docs .ci .clang-format .gitignore)
# Not a git checkout (a source archive): nothing to look at.
execute_process(COMMAND ${GIT} -c safe.directory=* -C ${ROOT} ls-tree --name-only HEAD
  RESULT_VARIABLE result OUTPUT_VARIABLE entries ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT result EQUAL 0)
  return()
endif()
string(REPLACE "\n" ";" entries "${entries}")
list(REMOVE_ITEM entries ${agreed})
if(entries)
  message(FATAL_ERROR "not agreed at the top level: ${entries}")
endif()
