# At the end of a CMakeLists.txt whose tests draw. Mesa's llvmpipe frees a fence while one of its threads
# is about to unlock the fence's mutex, which now and then corrupts the heap of the program that draws
# (Documentation/dev/memory.md). Without threads of its own it does not; other drivers do not look.
function (chi_rasterize_in_one_thread)
  get_property(tests DIRECTORY PROPERTY TESTS)
  set_property(TEST ${tests} APPEND PROPERTY ENVIRONMENT LP_NUM_THREADS=0)
endfunction ()
