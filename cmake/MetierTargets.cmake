# How every target of metier is made: warnings are errors, sanitizers come from the preset.

add_library(metier_warnings INTERFACE)
add_library(metier::warnings ALIAS metier_warnings)
target_compile_features(metier_warnings INTERFACE cxx_std_20)
target_compile_options(metier_warnings INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor
    -Woverloaded-virtual -Werror>)

# A unity build includes source files in another one; there g++ warns of members whose types are in
# an anonymous namespace.
if(CMAKE_UNITY_BUILD)
    target_compile_options(metier_warnings INTERFACE
        $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
endif()

# mold links the test programs in a quarter of the time that GNU ld needs.
find_program(METIER_MOLD mold)
if(METIER_MOLD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_link_options(metier_warnings INTERFACE -fuse-ld=mold)
endif()

set(METIER_SANITIZE "" CACHE STRING "Sanitizers for everything, as -fsanitize= takes them")
if(METIER_SANITIZE)
    target_compile_options(metier_warnings INTERFACE
        -fsanitize=${METIER_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(metier_warnings INTERFACE -fsanitize=${METIER_SANITIZE})
    # g++ 12 takes a moved std::variant for uninitialised where its address is checked.
    target_compile_options(metier_warnings INTERFACE
        $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized>)
endif()

option(METIER_PRECOMPILED_HEADERS "Compile the headers that most files include only once" ON)
set(METIER_COMMON_HEADERS
    <algorithm> <array> <atomic> <chrono> <cmath> <condition_variable> <cstdint> <deque> <filesystem>
    <fmt/format.h> <fmt/ranges.h> <fstream> <functional> <future> <map> <memory> <mutex> <numbers>
    <optional> <set> <span> <stdexcept> <string> <string_view> <thread> <tl/expected.hpp>
    <unordered_map> <utility> <variant> <vector> <Eigen/Core> <Eigen/Geometry>)

# metier_make_precompiled_headers(): metier_common_headers for every target, with GoogleMock
# metier_test_headers for the tests. A file still names each header that it uses: the preset `lint`
# builds without this.
function(metier_make_precompiled_headers)
    if(NOT METIER_PRECOMPILED_HEADERS)
        return()
    endif()
    set(empty ${PROJECT_BINARY_DIR}/precompiled.cpp)
    file(CONFIGURE OUTPUT ${empty} CONTENT "")
    add_library(metier_common_headers OBJECT ${empty})
    target_link_libraries(metier_common_headers PRIVATE
        Eigen3::Eigen fmt::fmt tl::expected metier::warnings)
    target_precompile_headers(metier_common_headers PRIVATE ${METIER_COMMON_HEADERS})
    if(METIER_TESTS)
        add_library(metier_test_headers OBJECT ${empty})
        target_link_libraries(metier_test_headers PRIVATE
            Eigen3::Eigen fmt::fmt tl::expected GTest::gmock metier::warnings)
        target_precompile_headers(metier_test_headers PRIVATE ${METIER_COMMON_HEADERS}
            <gmock/gmock.h>)
    endif()
endfunction()

# metier_use_precompiled_headers(<target> REUSE_FROM <metier_common_headers|metier_test_headers>)
# metier_use_precompiled_headers(<target> PRIVATE <headers>): headers for this target alone.
# The target links metier::base: fmt's macros must be the same everywhere.
function(metier_use_precompiled_headers target)
    if(METIER_PRECOMPILED_HEADERS)
        target_precompile_headers(${target} ${ARGN})
        # ccache needs the first to know what a precompiled header was made from, and the presets'
        # CCACHE_SLOPPINESS to take files that use one at all. The others: g++ 12
        # forgets there that a header is the system's, and warns of std::string.
        target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess
            -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread>)
    endif()
endfunction()

# metier_add_library(<name> SOURCES ... [PUBLIC libs] [PRIVATE libs])
# A library of libs/<name>: target metier_<name>, alias metier::<name>. In include/ are the headers that other
# libraries include (tools/lint/public_headers.py), in src/ the others.
# Without SOURCES it is header-only.
function(metier_add_library name)
    cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    set(target metier_${name})
    if(arg_SOURCES)
        add_library(${target} STATIC ${arg_SOURCES})
        target_include_directories(${target} PUBLIC include PRIVATE src)
        target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE} metier::warnings)
        target_compile_features(${target} PUBLIC cxx_std_20)
        metier_use_precompiled_headers(${target} REUSE_FROM metier_common_headers)
    else()
        add_library(${target} INTERFACE)
        target_include_directories(${target} INTERFACE include)
        target_link_libraries(${target} INTERFACE ${arg_PUBLIC})
    endif()
    add_library(metier::${name} ALIAS ${target})
endfunction()

# metier_add_test(<name> SOURCES ... LIBRARIES ... [SEPARATE files] [LABELS ...] [TIMEOUT seconds] [ALONE])
# A GoogleTest program; each of its tests is a ctest of its own, and sees the headers of the library's src/.
# SEPARATE: sources with helpers of the same name as another's, which a unity build (preset ci and those
# of the sanitizers) compiles on their own.
# ALONE: no other test runs beside one of them.
function(metier_add_test name)
    if(NOT METIER_TESTS)
        return()
    endif()
    cmake_parse_arguments(arg "ALONE" "TIMEOUT" "SOURCES;LIBRARIES;SEPARATE;LABELS" ${ARGN})
    if(NOT arg_TIMEOUT)
        set(arg_TIMEOUT 60)
    endif()
    add_executable(${name} ${arg_SOURCES})
    set_source_files_properties(${arg_SEPARATE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} GTest::gmock_main metier::warnings)
    target_include_directories(${name} PRIVATE src)
    metier_use_precompiled_headers(${name} REUSE_FROM metier_test_headers)
    # That of ::testing::TempDir(): two builds may be tested side by side.
    set(folder ${CMAKE_CURRENT_BINARY_DIR}/${name}.tmp/)
    file(MAKE_DIRECTORY ${folder})
    gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
        PROPERTIES ENVIRONMENT TEST_TMPDIR=${folder}
            TIMEOUT ${arg_TIMEOUT} RUN_SERIAL ${arg_ALONE} LABELS "${arg_LABELS}")
endfunction()

# metier_add_benchmark(<name> SOURCES ... LIBRARIES ...): a program of the target `benchmarks`.
function(metier_add_benchmark name)
    if(NOT METIER_BENCHMARKS)
        return()
    endif()
    cmake_parse_arguments(arg "" "" "SOURCES;LIBRARIES" ${ARGN})
    add_executable(${name} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} benchmark::benchmark metier::warnings)
    target_include_directories(${name} PRIVATE src)
    # Helpers of two files may have one name.
    set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
endfunction()

option(METIER_FUZZ "Build the fuzz targets as libFuzzer programs; needs clang" OFF)
if(METIER_FUZZ)
    # Which edges an input takes guides the search. To note the operands of comparisons as well takes a
    # third of the time, and finds no more: 8,393 features instead of 8,428 after 150,000 inputs of
    # edo_session_fuzz, 16,075 instead of 15,930 of urscript_run_fuzz.
    target_compile_options(metier_warnings INTERFACE -fno-sanitize-coverage=trace-cmp
        -fsanitize-coverage-ignorelist=${PROJECT_SOURCE_DIR}/tests/fuzz/without_coverage.txt)
endif()

# metier_add_fuzz_target(<name> SOURCES ... LIBRARIES ... [SEEDS files] [LONGEST bytes] [ONE_IN n])
# Defines LLVMFuzzerTestOneInput. SEEDS are inputs to begin with, LONGEST is that of an input (512).
# ONE_IN: it moves a robot besides parsing, and gets one of n inputs that others get.
# With METIER_FUZZ a libFuzzer program for scripts/fuzz; else a test that gives it some thousand
# random inputs.
function(metier_add_fuzz_target name)
    if(NOT METIER_TESTS)
        return()
    endif()
    cmake_parse_arguments(arg "" "LONGEST;ONE_IN" "SOURCES;LIBRARIES;SEEDS" ${ARGN})
    if(NOT arg_LONGEST)
        set(arg_LONGEST 512)
    endif()
    if(NOT arg_ONE_IN)
        set(arg_ONE_IN 1)
    endif()
    list(TRANSFORM arg_SEEDS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
    add_executable(${name} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} metier::warnings)
    target_include_directories(${name} PRIVATE src ${PROJECT_SOURCE_DIR}/tests/fuzz)
    target_compile_definitions(${name} PRIVATE METIER_MODELS_DIR="${PROJECT_SOURCE_DIR}/models")
    set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
    if(NOT TARGET fuzzers)
        add_custom_target(fuzzers)
    endif()
    add_dependencies(fuzzers ${name})
    if(METIER_FUZZ)
        target_link_options(${name} PRIVATE -fsanitize=fuzzer)
        list(JOIN arg_SEEDS "' '" seeds)
        file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/fuzz_targets/${name}
            CONTENT "program='$<TARGET_FILE:${name}>'\nlongest=${arg_LONGEST}\none_in=${arg_ONE_IN}
seeds=('${seeds}')\n")
    else()
        target_sources(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests/fuzz/random_inputs.cpp)
        add_test(NAME Fuzz.${name} COMMAND ${name} ${arg_SEEDS})
        set(timeout 120)
        if(METIER_SANITIZE)
            set(timeout 400)
        endif()
        set_tests_properties(Fuzz.${name} PROPERTIES TIMEOUT ${timeout} LABELS fuzz)
    endif()
endfunction()
