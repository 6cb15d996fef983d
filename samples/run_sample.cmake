# Run by ctest, see CMakeLists.txt: prepares, renders and validates a sample with the command, twice
# where the number of threads could change bytes.
function(run)
  execute_process(COMMAND ${COMMAND} ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output
                  ERROR_VARIABLE messages)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "exit ${status}: meshprep ${ARGN}\n${output}${messages}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_same a b)
  file(SHA256 ${a} hash_a)
  file(SHA256 ${b} hash_b)
  if(NOT hash_a STREQUAL hash_b)
    message(FATAL_ERROR "${a} and ${b} differ")
  endif()
endfunction()

file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT}/one ${OUT}/three)

run(inspect ${SAMPLE})
run(prepare ${SAMPLE} -o ${OUT}/one/${NAME}.glb --threads 1)
run(prepare ${SAMPLE} -o ${OUT}/three/${NAME}.glb --threads 3)
expect_same(${OUT}/one/${NAME}.glb ${OUT}/three/${NAME}.glb)

# What was prepared is drawn like what it was made from, by any number of threads.
run(render ${SAMPLE} -o ${OUT}/one/${NAME}.png --size 320x240 --threads 1)
run(render ${SAMPLE} -o ${OUT}/three/${NAME}.png --size 320x240 --threads 3)
expect_same(${OUT}/one/${NAME}.png ${OUT}/three/${NAME}.png)
run(render ${OUT}/one/${NAME}.glb -o ${OUT}/prepared.png --size 320x240)
run(diff ${OUT}/one/${NAME}.png ${OUT}/prepared.png --tolerance 0.01)

run(validate ${SAMPLE} -o ${OUT}/proof --panel 160)
file(GLOB pages ${OUT}/proof/*.html)
file(GLOB sheets ${OUT}/proof/*.png)
if(NOT pages OR NOT sheets)
  message(FATAL_ERROR "validate left no page or no sheet in ${OUT}/proof")
endif()
file(READ ${pages} page)
if(page MATCHES "(src|href)=\"[^d#\"][^\"]*\\.(png|css|js)\"")
  message(FATAL_ERROR "the page is not self-contained: ${CMAKE_MATCH_0}")
endif()
