# Desktop file and MIME types in desktop/ of the build folder: templates, filled in with the table of scene
# formats.
add_executable(gse_desktop_files ${CMAKE_SOURCE_DIR}/packaging/desktop_files.cpp)
target_link_libraries(gse_desktop_files PRIVATE gse_io)
foreach(name gseditpro.desktop gseditpro-mime.xml)
  add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/desktop/${name}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/desktop
    COMMAND gse_desktop_files ${CMAKE_SOURCE_DIR}/packaging/${name}.in ${CMAKE_BINARY_DIR}/desktop/${name}
    DEPENDS gse_desktop_files ${CMAKE_SOURCE_DIR}/packaging/${name}.in
    COMMENT "Filling in ${name}" VERBATIM)
  list(APPEND desktop_files ${CMAKE_BINARY_DIR}/desktop/${name})
endforeach()
add_custom_target(gse_desktop ALL DEPENDS ${desktop_files})
add_dependencies(gseditpro gse_desktop)   # the checks of tests/lint read them
