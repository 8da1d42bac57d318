# The artist's guide as HTML, in guide/ of the build folder: Help opens it there, or where it is installed.
find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  file(GLOB guide_pages CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/assets/guide/*.md
    ${CMAKE_SOURCE_DIR}/assets/guide/pictures/*)
  file(GLOB_RECURSE key_table ${CMAKE_SOURCE_DIR}/ui/keys.h)
  add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/guide/index.html
    COMMAND Python3::Interpreter ${CMAKE_SOURCE_DIR}/packaging/guide $<TARGET_FILE:gseditpro> ${key_table}
      ${CMAKE_BINARY_DIR}/guide
    DEPENDS gseditpro ${guide_pages} ${CMAKE_SOURCE_DIR}/packaging/guide ${key_table}
    COMMENT "Making the artist's guide" VERBATIM)
  add_custom_target(gse_guide ALL DEPENDS ${CMAKE_BINARY_DIR}/guide/index.html)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/guide/ DESTINATION share/gseditpro/guide)
endif()
