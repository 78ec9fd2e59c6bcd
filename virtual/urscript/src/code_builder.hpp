#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "code.hpp"

namespace metier::urscript {

/// One argument of a call as it is written: its name is empty if it goes by its place.
struct WrittenArgument {
    std::string_view name;
    Position at;
};

/// Collects the code of a program while it is read, and binds its names.
///
/// Variables: what the program itself (first level) assigns is global; in functions, a name is the
/// function's own if it is a parameter, is declared local, or is assigned without being global
/// by then. Functions may be called before they are defined. Source: script manual, scoping rules.
class CodeBuilder {
public:
    explicit CodeBuilder(ProgramKind kind, std::string_view name);

    /// Begins a function within the one that is being written; ends with endFunction().
    /// Errors: already_exists.
    Result<void> beginFunction(std::string_view name, bool is_thread, Position at);
    Result<void> addParameter(std::string_view name, Position at);
    void endFunction(Position at);
    Function& function() { return code_.functions[open_.back().index]; }

    /// Adds an instruction; returns where, for patch().
    std::size_t emit(Op op, Position at, std::int32_t a = 0, std::size_t n = 0);
    std::size_t here() { return function().instructions.size(); }
    /// The jump at `instruction` goes to the place that is written next.
    void patch(std::size_t instruction);
    void constant(Value value, Position at);

    void load(std::string_view name, Position at);
    void store(std::string_view name, Position at);
    /// Sets an element of a variable; n indices and the value are on the stack.
    void storeElement(std::string_view name, std::size_t n, Position at);
    void declareGlobal(std::string_view name);
    void declareLocal(std::string_view name);
    /// Reports whether a variable of that name is visible now.
    bool isVariable(std::string_view name) const;

    void call(std::string_view name, std::vector<WrittenArgument> arguments, Position at);
    void run(std::string_view name, Position at);

    /// Binds the calls and checks that every name is known. Errors: not_found (a name without a
    /// definition), invalid_argument.
    /// \param end of the program's text
    Result<Code> finish(Position end);

private:
    struct Global {
        std::size_t index = 0;
        bool declared = false;
        Position first_use;
    };
    struct OpenFunction {
        std::size_t index = 0;
        std::map<std::string, std::int32_t, std::less<>> locals;
    };
    struct OpenCall {
        std::size_t function = 0;     // function that contains it
        std::size_t instruction = 0;  // instruction in that function
        std::string_view name;
        std::vector<WrittenArgument> arguments;
        bool is_run = false;
    };

    /// The instructions for a variable of the function and for one of the program.
    struct Access {
        Op local;
        Op global;
    };

    void access(std::string_view name, Access ops, Position at, std::size_t n = 0);
    Global& global(std::string_view name, Position at);
    /// Whether it is declared by now; what was only read may become global further down.
    bool isGlobal(std::string_view name) const;
    /// Its number, or -1 if the function has none of that name.
    std::int32_t local(std::string_view name) const;
    void addLocal(std::string_view name);
    Result<void> bind(const OpenCall& call);
    Result<void> bindRun(const OpenCall& call, Instruction& instruction);
    Result<void> checkGlobals() const;

    Code code_;
    std::vector<OpenFunction> open_;  // functions that are being written, outermost first
    std::map<std::string, Global, std::less<>> globals_;
    std::map<std::string, std::size_t, std::less<>> functions_;
    std::vector<OpenCall> open_calls_;
};

}  // namespace metier::urscript
