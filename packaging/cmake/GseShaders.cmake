# gse_shaders(TARGET files...): compiles GLSL to SPIR-V and adds it to the target as C++ arrays: name.comp
# becomes gse::shaders::name_comp in "shaders/name_comp.h" of the build folder. NAME:file.comp:-DX=1 makes a
# variant NAME_comp.
find_program(GSE_GLSLANG glslangValidator REQUIRED)
function(gse_shaders target)
  set(folder ${CMAKE_BINARY_DIR}/generated/shaders)
  file(MAKE_DIRECTORY ${folder})
  file(GLOB includes CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/shaders/*.h ${CMAKE_SOURCE_DIR}/shaders/*.glsl)
  foreach(entry ${ARGN})
    string(REPLACE ":" ";" parts ${entry})
    list(LENGTH parts count)
    if(count EQUAL 1)
      set(file ${entry})
      set(defines "")
      string(REPLACE "." "_" symbol ${file})
    else()
      list(GET parts 0 name)
      list(GET parts 1 file)
      set(defines "")
      if(count GREATER 2)
        list(SUBLIST parts 2 -1 defines)
      endif()
      get_filename_component(stage ${file} LAST_EXT)
      string(REPLACE "." "_" symbol ${name}${stage})
    endif()
    set(output ${folder}/${symbol}.h)
    add_custom_command(OUTPUT ${output}
      COMMAND ${GSE_GLSLANG} --quiet --target-env vulkan1.2 -I${CMAKE_SOURCE_DIR}/shaders ${defines} --vn
        ${symbol}
              -o ${output}.raw ${CMAKE_SOURCE_DIR}/shaders/${file}
      COMMAND ${CMAKE_COMMAND} -DINPUT=${output}.raw -DOUTPUT=${output} -DFILE=${file}
              -P ${CMAKE_SOURCE_DIR}/packaging/cmake/WrapShader.cmake
      DEPENDS ${CMAKE_SOURCE_DIR}/shaders/${file} ${includes}
        ${CMAKE_SOURCE_DIR}/packaging/cmake/WrapShader.cmake
      COMMENT "Shader ${symbol}" VERBATIM)
    target_sources(${target} PRIVATE ${output})
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_BINARY_DIR}/generated)
endfunction()
