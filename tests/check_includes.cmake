# The arrows between the folders: who may include what of ours.
#   cmake -DROOT=<source folder> -P check_includes.cmake
# base includes nothing of ours; dem and fem include base and themselves, never each other; coupling includes base,
# itself, and of dem and fem only the façade headers listed here. Our includes are written "folder/file.hpp" from the
# source folder; a quoted include of any other form is an error too, since it could hide an arrow.
cmake_minimum_required(VERSION 3.25)
set(allowed_base base)
set(allowed_dem base dem)
set(allowed_fem base fem)
set(allowed_coupling base coupling)
set(facades dem/dem.hpp dem/company.hpp dem/output.hpp dem/grading.hpp dem/insertion.hpp dem/clump.hpp dem/dimensions.hpp dem/stone.hpp dem/clump_builder.hpp
    dem/stone_library.hpp dem/measure/region.hpp dem/measure/heap.hpp dem/measure/stress.hpp
    dem/measure/contact_numbers.hpp dem/measure/contact_forces.hpp fem/fem.hpp)

set(errors "")
foreach(folder base dem fem coupling)
  file(GLOB_RECURSE sources ${ROOT}/${folder}/*.hpp ${ROOT}/${folder}/*.cpp ${ROOT}/${folder}/*.cu
    ${ROOT}/${folder}/*.cuh ${ROOT}/${folder}/*.h ${ROOT}/${folder}/*.inl ${ROOT}/${folder}/*.ipp ${ROOT}/${folder}/*.in)
  foreach(source ${sources})
    file(RELATIVE_PATH name ${ROOT} ${source})
    file(STRINGS ${source} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"][^<>\"]+[>\"]")
    foreach(line IN LISTS lines)
      string(REGEX MATCH "[<\"]([^<>\"]+)[>\"]" match "${line}")
      set(target ${CMAKE_MATCH_1})
      string(REGEX MATCH "^[^/]+" target_folder "${target}")
      set(ours FALSE)
      if(target_folder MATCHES "^(base|dem|fem|coupling|tests)$" AND target MATCHES "/")
        set(ours TRUE)
      endif()
      if(NOT ours)
        if(match MATCHES "^\"")
          list(APPEND errors "${name} includes \"${target}\": write our headers from the source folder, others in <>")
        endif()
      elseif(target MATCHES "\\.\\.")
        list(APPEND errors "${name} includes ${target}: no .. in an include")
      elseif(NOT target_folder IN_LIST allowed_${folder})
        if(NOT (folder STREQUAL "coupling" AND target IN_LIST facades))
          list(APPEND errors "${name} includes ${target}: not allowed from ${folder}/")
        endif()
      endif()
    endforeach()
  endforeach()
endforeach()

if(errors)
  list(JOIN errors "\n  " text)
  message(FATAL_ERROR "forbidden includes:\n  ${text}")
endif()
