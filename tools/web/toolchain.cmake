# Emscripten's toolchain, as Debian's package has it. Where it is absent the configuration goes through without it, and
# tools/web says so.
find_program(UKEMI_EMCC em++)
if(UKEMI_EMCC)
  get_filename_component(emscripten ${UKEMI_EMCC} REALPATH)
  get_filename_component(emscripten ${emscripten} DIRECTORY)
  include(${emscripten}/cmake/Modules/Platform/Emscripten.cmake)
endif()
