# Compiles NodeSets to C code at build time, with the NodeSet compiler of the Debian package.

find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)

set(METIER_NODESET_TOOLS ${PROJECT_SOURCE_DIR}/tools/nodesets)
file(GLOB METIER_NODESET_TOOL_FILES CONFIGURE_DEPENDS ${METIER_NODESET_TOOLS}/*.py)

# The official NodeSets: a checkout of UA-Nodeset if UA_NODESET_DIR says so, else the npm package.
set(UA_NODESET_DIR "$ENV{UA_NODESET_DIR}" CACHE PATH
    "Checkout of the OPC Foundation's UA-Nodeset to use instead of the pinned npm package")

# metier_official_nodeset(<variable> <file in the npm package> <file in UA-Nodeset>)
function(metier_official_nodeset variable npm_file checkout_file)
    set(npm_dir ${PROJECT_SOURCE_DIR}/nodesets/node_modules/node-opcua-nodesets/nodesets)
    if(UA_NODESET_DIR)
        set(path ${UA_NODESET_DIR}/${checkout_file})
    else()
        set(path ${npm_dir}/${npm_file})
    endif()
    if(NOT EXISTS ${path})
        message(FATAL_ERROR "The NodeSet ${path} is not there: run scripts/setup, or set UA_NODESET_DIR")
    endif()
    set(${variable} ${path} PARENT_SCOPE)
endfunction()

# metier_compile_nodeset(<name> FILE NodeSet2.xml [DEPENDS names...])
# Generates namespace_<name>_generated.c/.h, and types_<name>_generated.c/.h if the NodeSet has data
# types; appends them to METIER_NODESET_SOURCES. DEPENDS: all NodeSets it needs, in load order.
function(metier_compile_nodeset name)
    cmake_parse_arguments(arg "" "FILE" "DEPENDS" ${ARGN})
    string(TOUPPER UA_TYPES_${name} types_array)
    set(out ${CMAKE_CURRENT_BINARY_DIR}/generated)
    file(MAKE_DIRECTORY ${out})
    file(STRINGS ${arg_FILE} data_types REGEX "<UADataType" LIMIT_COUNT 1)

    set(existing --existing=${UA_SCHEMA_DIR}/Opc.Ua.NodeSet2.xml)
    set(arrays --types-array=UA_TYPES)
    set(files ${UA_SCHEMA_DIR}/Opc.Ua.NodeSet2.xml ${arg_FILE})
    foreach(depend IN LISTS arg_DEPENDS)
        get_property(depend_file GLOBAL PROPERTY METIER_NODESET_FILE_${depend})
        get_property(depend_array GLOBAL PROPERTY METIER_NODESET_TYPES_${depend})
        list(APPEND existing --existing=${depend_file})
        list(APPEND files ${depend_file})
        if(depend_array)
            list(APPEND arrays --types-array=${depend_array})
        endif()
    endforeach()

    set(sources ${out}/namespace_${name}_generated.c)
    set(inputs ${out}/${name}.csv ${out}/${name}.bsd)
    if(data_types)
        list(APPEND arrays --types-array=${types_array})
        list(APPEND sources ${out}/types_${name}_generated.c)
        metier_generate_data_types(${name} ${arg_FILE} ${out})
        set_property(GLOBAL PROPERTY METIER_NODESET_TYPES_${name} ${types_array})
    endif()
    set_property(GLOBAL PROPERTY METIER_NODESET_FILE_${name} ${arg_FILE})

    add_custom_command(
        OUTPUT ${out}/namespace_${name}_generated.c ${out}/namespace_${name}_generated.h
        COMMAND ${Python3_EXECUTABLE} ${METIER_NODESET_TOOLS}/compile_nodeset.py
                --cache ${PROJECT_SOURCE_DIR}/build/nodesets --out ${out}/namespace_${name}_generated
                --compiler ${open62541_TOOLS_DIR}/nodeset_compiler --inputs ${files}
                -- ${existing} --xml=${arg_FILE} ${arrays}
        DEPENDS ${files} ${METIER_NODESET_TOOLS}/compile_nodeset.py
                ${open62541_TOOLS_DIR}/nodeset_compiler/nodeset_compiler.py
        COMMENT "Compiling the NodeSet ${name} (log: ${out}/namespace_${name}_generated.log)" VERBATIM)
    set(METIER_NODESET_SOURCES ${METIER_NODESET_SOURCES} ${sources} PARENT_SCOPE)
endfunction()

# The C types of a NodeSet's data types, from the CSV and the BSD that its nodes hold.
function(metier_generate_data_types name file out)
    add_custom_command(
        OUTPUT ${out}/${name}.csv ${out}/${name}.bsd
        COMMAND ${Python3_EXECUTABLE} ${METIER_NODESET_TOOLS}/nodeset_inputs.py ${file}
                --csv ${out}/${name}.csv --bsd ${out}/${name}.bsd
        DEPENDS ${file} ${METIER_NODESET_TOOL_FILES} VERBATIM)
    add_custom_command(
        OUTPUT ${out}/types_${name}_generated.c ${out}/types_${name}_generated.h
        COMMAND ${Python3_EXECUTABLE} ${open62541_TOOLS_DIR}/generate_datatypes.py
                --type-bsd=${out}/${name}.bsd --type-csv=${out}/${name}.csv --xml=${file} --no-builtin
                --import=UA_TYPES\#${UA_SCHEMA_DIR}/Opc.Ua.Types.bsd ${out}/types_${name}
        DEPENDS ${out}/${name}.csv ${out}/${name}.bsd ${file} VERBATIM)
endfunction()
