#include "code_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "metier/base/text.hpp"

namespace metier::urscript {
namespace {

/// Signature of a callable function, with the names of a script.
struct Signature {
    std::string_view name;
    std::vector<std::string_view> parameters;
    std::size_t required = 0;
};

/// Finds the parameter of each argument. Errors: invalid_argument.
Result<std::vector<std::uint8_t>> parametersOf(const std::vector<WrittenArgument>& arguments,
                                               const Signature& signature, Position at) {
    const auto& names = signature.parameters;
    std::vector<std::uint8_t> result;
    std::vector<bool> given(names.size());
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const WrittenArgument& argument = arguments[i];
        const auto named = std::find(names.begin(), names.end(), argument.name);
        const std::size_t index =
            argument.name.empty() ? i : static_cast<std::size_t>(named - names.begin());
        if (index >= names.size()) {
            return failAt(
                argument.at,
                argument.name.empty()
                    ? fmt::format("{} takes at most {} arguments", signature.name, names.size())
                    : fmt::format("{} has no parameter '{}'", signature.name, argument.name));
        }
        if (given[index]) {
            return failAt(argument.at, fmt::format("{} gets parameter '{}' twice", signature.name,
                                                   names[index]));
        }
        given[index] = true;
        result.push_back(static_cast<std::uint8_t>(index));
    }
    for (std::size_t i = 0; i < signature.required; ++i) {
        if (!given[i]) {
            return failAt(at,
                          fmt::format("{} needs an argument for '{}'", signature.name, names[i]));
        }
    }
    return result;
}

tl::unexpected<Error> notDefined(Position at, std::string_view what, std::string_view name) {
    return failAt(at, fmt::format("{} '{}' is not defined", what, name), Errc::not_found);
}

}  // namespace

CodeBuilder::CodeBuilder(ProgramKind kind, std::string_view name) : open_(1) {
    code_.kind = kind;
    code_.name = name;
    code_.functions.push_back({code_.name, {}, 0, false, {}, {}});
}

Result<void> CodeBuilder::beginFunction(std::string_view name, bool is_thread, Position at) {
    const std::size_t index = code_.functions.size();
    if (!functions_.emplace(name, index).second) {
        return failAt(at, fmt::format("'{}' is defined twice", name));
    }
    code_.functions.push_back({std::string(name), {}, 0, is_thread, {}, {}});
    open_.push_back({index, {}});
    return {};
}

Result<void> CodeBuilder::addParameter(std::string_view name, Position at) {
    if (local(name) >= 0) {
        return failAt(at, fmt::format("parameter '{}' is there twice", name));
    }
    function().parameters.emplace_back(name);
    addLocal(name);
    return {};
}

void CodeBuilder::endFunction(Position at) {
    constant(Value(), at);
    emit(Op::give_back, at);
    open_.pop_back();
}

std::size_t CodeBuilder::emit(Op op, Position at, std::int32_t a, std::size_t n) {
    function().instructions.push_back({op, static_cast<std::uint8_t>(n), a, at});
    return here() - 1;
}

void CodeBuilder::patch(std::size_t instruction) {
    function().instructions[instruction].a = static_cast<std::int32_t>(here());
}

void CodeBuilder::constant(Value value, Position at) {
    emit(Op::constant, at, static_cast<std::int32_t>(code_.constants.size()));
    code_.constants.push_back(std::move(value));
}

void CodeBuilder::load(std::string_view name, Position at) {
    access(name, {Op::load_local, Op::load_global}, at);
}

void CodeBuilder::store(std::string_view name, Position at) {
    if (open_.size() == 1) {
        declareGlobal(name);
    } else if (local(name) < 0 && !isGlobal(name)) {
        declareLocal(name);
    }
    access(name, {Op::store_local, Op::store_global}, at);
}

void CodeBuilder::storeElement(std::string_view name, std::size_t n, Position at) {
    access(name, {Op::set_local_element, Op::set_global_element}, at, n);
}

void CodeBuilder::access(std::string_view name, Access ops, Position at, std::size_t n) {
    if (const std::int32_t own = local(name); own >= 0) {
        emit(ops.local, at, own, n);
    } else {
        emit(ops.global, at, static_cast<std::int32_t>(global(name, at).index), n);
    }
}

void CodeBuilder::declareGlobal(std::string_view name) {
    global(name, {}).declared = true;
}

void CodeBuilder::declareLocal(std::string_view name) {
    if (open_.size() == 1) {
        declareGlobal(name);
    } else if (local(name) < 0) {
        addLocal(name);
    }
}

bool CodeBuilder::isGlobal(std::string_view name) const {
    const auto found = globals_.find(name);
    return found != globals_.end() && found->second.declared;
}

bool CodeBuilder::isVariable(std::string_view name) const {
    return local(name) >= 0 || globals_.find(name) != globals_.end();
}

void CodeBuilder::call(std::string_view name, std::vector<WrittenArgument> arguments, Position at) {
    const std::size_t instruction = emit(Op::call, at);
    open_calls_.push_back({open_.back().index, instruction, name, std::move(arguments), false});
}

void CodeBuilder::run(std::string_view name, Position at) {
    const std::size_t instruction = emit(Op::run, at);
    open_calls_.push_back({open_.back().index, instruction, name, {}, true});
}

Result<Code> CodeBuilder::finish(Position end) {
    endFunction(end);
    for (const OpenCall& open_call : open_calls_) {
        METIER_TRY(bind(open_call));
    }
    METIER_TRY(checkGlobals());
    return std::move(code_);
}

CodeBuilder::Global& CodeBuilder::global(std::string_view name, Position at) {
    auto found = globals_.find(name);
    if (found == globals_.end()) {
        found = globals_.emplace(name, Global{code_.globals.size(), false, at}).first;
        code_.globals.emplace_back(name);
    }
    return found->second;
}

std::int32_t CodeBuilder::local(std::string_view name) const {
    const auto& locals = open_.back().locals;
    const auto found = locals.find(name);
    return found == locals.end() ? -1 : found->second;
}

void CodeBuilder::addLocal(std::string_view name) {
    open_.back().locals.emplace(name, static_cast<std::int32_t>(function().locals.size()));
    function().locals.emplace_back(name);
}

Result<void> CodeBuilder::bind(const OpenCall& call) {
    Instruction& instruction = code_.functions[call.function].instructions[call.instruction];
    if (call.is_run) {
        return bindRun(call, instruction);
    }
    const auto found = functions_.find(call.name);
    const Builtin* builtin = found == functions_.end() ? findBuiltin(call.name) : nullptr;
    Signature signature{call.name, {}, 0};
    if (found != functions_.end()) {
        const Function& function = code_.functions[found->second];
        if (function.is_thread) {
            return failAt(instruction.at,
                          fmt::format("thread '{}' has to be started by run", call.name));
        }
        signature.parameters.assign(function.parameters.begin(), function.parameters.end());
        signature.required = function.required;
    } else if (builtin != nullptr) {
        signature.parameters = split(builtin->parameters, ' ');
        signature.required = builtin->required;
    } else {
        return notDefined(instruction.at, "function", call.name);
    }
    METIER_ASSIGN(auto parameters, parametersOf(call.arguments, signature, instruction.at));
    if (builtin == nullptr) {
        instruction.a = static_cast<std::int32_t>(code_.calls.size());
        code_.calls.push_back({found->second, std::move(parameters)});
    } else {
        instruction.op = Op::call_builtin;
        instruction.a = static_cast<std::int32_t>(code_.builtin_calls.size());
        code_.builtin_calls.push_back(
            {builtin, signature.parameters.size(), std::move(parameters)});
    }
    return {};
}

Result<void> CodeBuilder::bindRun(const OpenCall& call, Instruction& instruction) {
    const auto found = functions_.find(call.name);
    if (found == functions_.end() || !code_.functions[found->second].is_thread) {
        return notDefined(instruction.at, "thread", call.name);
    }
    instruction.a = static_cast<std::int32_t>(found->second);
    return {};
}

Result<void> CodeBuilder::checkGlobals() const {
    for (const std::string& name : code_.globals) {
        const Global& global = globals_.find(name)->second;
        if (!global.declared) {
            return notDefined(global.first_use, "variable", name);
        }
    }
    return {};
}

}  // namespace metier::urscript
