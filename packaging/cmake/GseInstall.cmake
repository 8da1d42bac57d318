# What is installed where (the program looks for the rest in ../lib/gseditpro and ../share/gseditpro), and the
# Debian package.
install(TARGETS gseditpro RUNTIME DESTINATION bin)
foreach(plugin gse_media gse_neural_plugin gse_remote_plugin)
  if(TARGET ${plugin})
    # A libtorch outside of the system's folders stays where it is; the plug-in goes on finding it.
    set_target_properties(${plugin} PROPERTIES INSTALL_RPATH_USE_LINK_PATH TRUE)
    install(TARGETS ${plugin} LIBRARY DESTINATION lib/gseditpro)
  endif()
endforeach()
install(DIRECTORY ${CMAKE_SOURCE_DIR}/assets/ DESTINATION share/gseditpro
  REGEX "assets/guide$" EXCLUDE    # as HTML: GseGuide.cmake
  PATTERN log EXCLUDE)        # of the bundled model's training
include(GseDesktopFiles)
install(FILES ${CMAKE_BINARY_DIR}/desktop/gseditpro.desktop DESTINATION share/applications)
install(FILES ${CMAKE_SOURCE_DIR}/packaging/gseditpro.svg DESTINATION share/icons/hicolor/scalable/apps)
install(FILES ${CMAKE_BINARY_DIR}/desktop/gseditpro-mime.xml DESTINATION share/mime/packages
  RENAME gseditpro.xml)
install(FILES ${CMAKE_SOURCE_DIR}/packaging/copyright DESTINATION share/doc/gseditpro)

# One changelog of all pages, newest first. Debian wants it packed, with nothing in it that differs from build
# to build.
file(GLOB changelog_pages CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/packaging/changelog/*.md)
list(SORT changelog_pages COMPARE NATURAL ORDER DESCENDING)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${changelog_pages})
file(WRITE ${CMAKE_BINARY_DIR}/generated/changelog "")
foreach(page IN LISTS changelog_pages)
  file(READ ${page} changes)
  file(APPEND ${CMAKE_BINARY_DIR}/generated/changelog "${changes}\n")
endforeach()
find_program(GSE_GZIP gzip)
if(GSE_GZIP)
  execute_process(COMMAND ${GSE_GZIP} -9nc ${CMAKE_BINARY_DIR}/generated/changelog
    OUTPUT_FILE ${CMAKE_BINARY_DIR}/generated/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${CMAKE_BINARY_DIR}/generated/changelog.gz DESTINATION share/doc/gseditpro)
else()
  install(FILES ${CMAKE_BINARY_DIR}/generated/changelog DESTINATION share/doc/gseditpro)
endif()

# packaging/package: cpack -G DEB.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_NAME gseditpro)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The GSEditPro authors <gseditpro@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "text-driven editor of 3D Gaussian Splatting scenes")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"GSEditPro changes a scene of 3D Gaussian splats by one sentence: it finds what
is meant by the attention of a text-to-image model, labels those splats, and
optimizes them while you watch. A small model comes with it; Stable Diffusion
weights of your own are read.
.
It reads and writes the common files of splat scenes, and takes pictures and
turntables.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Not linked, so not found by dpkg-shlibdeps: the window's font and graphics; and what makes it fast or work
# without a GPU.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core, libvulkan1")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libopenblas0-pthread, mesa-vulkan-drivers")
include(CPack)
