#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "builtin.hpp"
#include "metier/urscript/program.hpp"
#include "metier/urscript/value.hpp"
#include "token.hpp"

namespace metier::urscript {

/// Instructions of the machine that runs a thread. `a` and `n` are operands of the instruction;
/// "pops" and "pushes" mean the thread's stack of values.
enum class Op : std::uint8_t {
    constant,            ///< pushes constants[a]
    load_global,         ///< pushes globals[a]
    load_local,          ///< pushes local a
    store_global,        ///< pops into globals[a]
    store_local,         ///< pops into local a
    element,             ///< pops n indices and what they are of, pushes the element
    set_global_element,  ///< pops the value and n indices of globals[a]
    set_local_element,   ///< pops the value and n indices of local a
    make_list,           ///< pops a values, pushes their list
    make_pose,           ///< pops 6 values, pushes their pose
    negate,
    logical_not,
    truth,  ///< pops a value, pushes whether it is true
    add,
    subtract,
    multiply,
    divide,
    remainder,
    equal,
    not_equal,
    less,
    less_equal,
    greater,
    greater_equal,
    logical_xor,
    jump,           ///< jumps to a
    jump_if_false,  ///< pops a value; jumps to a if it is false
    jump_if_given,  ///< jumps to a if parameter n has a value
    call,           ///< pops the arguments of calls[a], pushes what the function returns
    call_builtin,   ///< as call, for builtin_calls[a]
    run,            ///< starts functions[a] as a thread, pushes its handle
    kill,           ///< pops a handle, pushes none
    join,           ///< pops a handle, pushes none when that thread has ended
    pop,
    give_back,  ///< returns the popped value
    halt,
};

struct Instruction {
    Op op = Op::halt;
    std::uint8_t n = 0;
    std::int32_t a = 0;
    Position at;
};

struct Function {
    std::string name;
    std::vector<std::string> parameters;
    std::size_t required = 0;  ///< number of parameters without a default value
    bool is_thread = false;
    std::vector<std::string> locals;  ///< parameters first
    std::vector<Instruction> instructions;
};

/// A call of a function of the script: arguments come as they are written.
struct FunctionCall {
    std::size_t function = 0;
    std::vector<std::uint8_t> parameter;  ///< parameter of each argument
};

struct BuiltinCall {
    const Builtin* builtin = nullptr;
    std::size_t total = 0;  ///< number of its parameters
    std::vector<std::uint8_t> parameter;
};

/// A program after it was understood.
struct Code {
    std::string name;
    ProgramKind kind = ProgramKind::primary;
    std::vector<Function> functions;  ///< the first one is the program itself
    std::vector<std::string> globals;
    std::vector<Value> constants;
    std::vector<FunctionCall> calls;
    std::vector<BuiltinCall> builtin_calls;
};

}  // namespace metier::urscript
