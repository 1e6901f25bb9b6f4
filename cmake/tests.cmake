# How a room's tests become a program.
find_package(GTest REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
include(GoogleTest)

# The folder of real scans; tests that need it are skipped without it, and fail when CI is set.
set(FLATPOSE_REAL_DATA "${PROJECT_SOURCE_DIR}/../shared/data" CACHE PATH "Where the real scans lie")

# Undefined behaviour is looked for in what is tested; in the tests' own code it would add half to the time they take to compile.
# To be linked after flatpose_options, for the last word counts.
add_library(flatpose_test_options INTERFACE)
if(FLATPOSE_SANITIZE MATCHES undefined)
  target_compile_options(flatpose_test_options INTERFACE -fno-sanitize=undefined)
endif()

# flatpose_add_test(NAME SOURCES... ALONE... LIBRARIES... UNDER_SANITIZERS FILTER OPTIMISED): one program a room, its
# cases listed one by one. ALONE are those of its sources whose names get in the way of the others'. With UNDER_SANITIZERS
# those cases alone where sanitizers slow the library down. Tests are many lines that run once: they are OPTIMISED only
# where they work on whole images themselves.
function(flatpose_add_test name)
  cmake_parse_arguments(ARG "OPTIMISED" "UNDER_SANITIZERS" "SOURCES;ALONE;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES} ${ARG_ALONE})
  flatpose_compile_alone(${name} ${ARG_ALONE})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE flatpose flatpose_options flatpose_test_options GTest::gtest_main ${ARG_LIBRARIES})
  target_compile_options(${name} PRIVATE $<IF:$<BOOL:${ARG_OPTIMISED}>,-O1,-O0>)
  target_compile_definitions(${name} PRIVATE FLATPOSE_REAL_DATA_DEFAULT="${FLATPOSE_REAL_DATA}")
  set(filter "")
  if(FLATPOSE_SANITIZE AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")  # the preset rt, which runs all, is for these
    set(filter "${ARG_UNDER_SANITIZERS}")
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 TEST_FILTER "${filter}")
endfunction()
