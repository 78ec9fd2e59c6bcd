# Drivers and virtual controllers: one folder each, found by itself. docs/guide/add-a-robot.md.

set(METIER_EXTRA_DEVICES "" CACHE STRING
    "Folders outside of this source tree, each with a driver or a virtual controller of yours")

# metier_add_driver(<name> SOURCES ... [PUBLIC libs] [PRIVATE libs])
# A library metier::<name>_driver, as metier_add_library makes it, that defines
#   metier::device::Driver metier::device::<name>Driver();
function(metier_add_driver name)
    metier_add_library(${name}_driver ${ARGN})
    target_link_libraries(metier_${name}_driver PUBLIC metier::device)
    set_property(GLOBAL APPEND PROPERTY METIER_DRIVERS ${name})
endfunction()

# metier_add_virtual_controller(<name> SOURCES ... [PUBLIC libs] [PRIVATE libs])
# A library metier::virtual_<name> that defines
#   metier::virtual_controller::ControllerType metier::virtual_controller::<name>Controller();
function(metier_add_virtual_controller name)
    metier_add_library(virtual_${name} ${ARGN})
    target_link_libraries(metier_virtual_${name} PUBLIC metier::virtual_controller)
    set_property(GLOBAL APPEND PROPERTY METIER_VIRTUAL_CONTROLLERS ${name})
endfunction()

# _metier_device_table(<target> <property> <prefix> <suffix> <header> <type> <function>)
# The library <target> that links all that was added, with the function that lists them.
function(_metier_device_table target names library header type suffix list)
    set(declarations "")
    set(calls "")
    set(libraries "")
    foreach(name IN LISTS names)
        string(APPEND declarations "${type} ${name}${suffix}();\n")
        string(APPEND calls "        ${name}${suffix}(),\n")
        string(REPLACE "@" ${name} linked ${library})
        list(APPEND libraries ${linked})
    endforeach()
    get_filename_component(namespace ${header} DIRECTORY)
    string(REPLACE "/" "::" namespace ${namespace})
    file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp CONTENT
"// Made by cmake/MetierDevices.cmake.
#include \"${header}\"

namespace ${namespace} {

${declarations}
const std::vector<${type}>& ${list}() {
    static const std::vector<${type}> kAll{
${calls}    };
    return kAll;
}

}  // namespace ${namespace}
")
    metier_add_library(${target} SOURCES ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp
        PUBLIC ${libraries})
endfunction()

# Call after all folders were added.
function(metier_add_device_tables)
    get_property(drivers GLOBAL PROPERTY METIER_DRIVERS)
    _metier_device_table(drivers "${drivers}" metier::@_driver metier/device/driver.hpp
        Driver Driver drivers)
    get_property(controllers GLOBAL PROPERTY METIER_VIRTUAL_CONTROLLERS)
    _metier_device_table(virtual_controllers "${controllers}" metier::virtual_@
        metier/virtual_controller/controller.hpp ControllerType Controller controllerTypes)
endfunction()
