# What is installed: each public header and the sources' headers that it is made of, in the order of their includes.
set(UKEMI_PUBLIC_HEADERS
    "actuator: common/sea_parameters common/uncertainty common/verdict common/actuator"
    "error: common/error"
    "monitor: common/monitor"
    "identify/rig: identify/rig/rig"
    "identify/trial: identify/logs/trial"
    "identify/estimate: identify/estimate/choice identify/estimate/estimate"
    "identify/fit: identify/rollout/nuisance identify/fit/start_options identify/fit/fit"
    "identify/prediction: identify/trust/prediction"
    "landing/motion: landing/model/motion_data landing/model/variables"
    "landing/scene: landing/model/constants landing/model/scatter landing/model/scene"
    "landing/scene_file: landing/model/files"
    "landing/player: landing/model/player"
    "landing/simulate: common/integrate/counters landing/run/landing"
    "landing/batch: landing/lanes/batch"
    "landing/goal: landing/scatter/measure landing/search/goal"
    "landing/optimize: landing/search/optimize"
    "landing/planner: landing/search/planner"
    "landing/drops: landing/scatter/drop_model landing/search/robust"
    "landing/risk: landing/judge/sobol_indices landing/judge/risk"
    "landing/map: landing/judge/map"
    "landing/atlas_reader: landing/atlas/atlas_reader"
    "landing/robot: landing/body/robot"
    "landing/body_scene: landing/body/body_scene"
    "landing/body_run: landing/body/body_run"
    "landing/body_planner: landing/plan/body_plan landing/plan/body_planner landing/atlas/body_atlas_reader")

# Calls NAME(header parts...) for each.
macro(ukemi_for_each_public_header function)
  foreach(entry IN LISTS UKEMI_PUBLIC_HEADERS)
    string(REPLACE ":" "" entry "${entry}")
    string(REPLACE " " ";" entry "${entry}")
    list(POP_FRONT entry header)
    cmake_language(CALL ${function} ${header} ${entry})
  endforeach()
endmacro()

# In the build tree a public header names the sources', which stay in their rooms.
function(ukemi_forward header)
  set(text "#pragma once\n")
  foreach(part IN LISTS ARGN)
    string(APPEND text "#include \"${part}.hpp\"\n")
  endforeach()
  file(CONFIGURE OUTPUT ${UKEMI_FORWARDED}/ukemi/${header}.hpp CONTENT "${text}" @ONLY)
endfunction()

# Installed it holds their text: what they say of themselves, what they include, and what stands in their namespaces.
function(ukemi_remember_parts header)
  foreach(part IN LISTS ARGN)
    set_property(GLOBAL PROPERTY "ukemi ${part}.hpp" ${header})
  endforeach()
endfunction()
function(ukemi_join header)
  set(heads "")
  set(includes "")
  set(bodies "")
  foreach(part IN LISTS ARGN)
    file(READ ${UKEMI_SOURCE}/${part}.hpp text)
    string(FIND "${text}" "#pragma once\n" at)
    string(SUBSTRING "${text}" 0 ${at} head)
    string(APPEND heads "${head}")
    string(SUBSTRING "${text}" ${at} -1 text)
    string(REGEX MATCHALL "#include [<\"][^>\"]+[>\"]\n" lines "${text}")
    string(REGEX REPLACE "#include [<\"][^>\"]+[>\"]\n" "" text "${text}")
    foreach(line IN LISTS lines)
      if(line MATCHES "\"([^\"]+)\"")
        get_property(home GLOBAL PROPERTY "ukemi ${CMAKE_MATCH_1}")
        if(NOT home)
          message(FATAL_ERROR "${part}.hpp is public and includes ${CMAKE_MATCH_1}, which is not")
        endif()
        set(line "#include <ukemi/${home}.hpp>\n")
      endif()
      if(NOT line STREQUAL "#include <ukemi/${header}.hpp>\n")
        list(APPEND includes "${line}")
      endif()
    endforeach()
    string(REGEX REPLACE "^#pragma once\n+" "\n" text "${text}")
    string(APPEND bodies "${text}")
  endforeach()
  list(REMOVE_DUPLICATES includes)
  list(SORT includes)
  list(JOIN includes "" includes)
  # One namespace goes on where the next part begins in it.
  string(REGEX REPLACE "\n}  // namespace ([a-z:]+)\n\nnamespace ([a-z:]+) {\n" "\n}\\1{\\2\n" bodies "${bodies}")
  foreach(space ukemi ukemi::identify ukemi::landing ukemi::integrate)
    string(REPLACE "\n}${space}{${space}\n" "" bodies "${bodies}")
  endforeach()
  string(REGEX REPLACE "\n}([a-z:]+){([a-z:]+)\n" "\n}  // namespace \\1\n\nnamespace \\2 {\n" bodies "${bodies}")
  file(WRITE ${UKEMI_JOINED}/ukemi/${header}.hpp "${heads}#pragma once\n\n${includes}${bodies}")
endfunction()

# As a script, `cmake -DUKEMI_SOURCE=... -DUKEMI_JOINED=... -P public_headers.cmake`: the headers as they are installed.
if(CMAKE_SCRIPT_MODE_FILE)
  ukemi_for_each_public_header(ukemi_remember_parts)
  ukemi_for_each_public_header(ukemi_join)
endif()
