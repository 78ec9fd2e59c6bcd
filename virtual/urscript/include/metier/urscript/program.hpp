#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"

namespace metier::urscript {

struct Code;  // private

enum class ProgramKind {
    primary,    ///< `def NAME():`, or statements alone: may move the arm, replaces what runs
    secondary,  ///< `sec NAME():`: runs beside the primary program in one cycle, never moves the
                ///< arm
};

/// A script that was understood: its names are resolved, it is ready to be run any number of times.
///
/// Cheap to copy; copies share what never changes. Threading: any thread.
/// Source: URScript manual; what of it is there, virtual/urscript/README.md.
class Program {
public:
    /// Longest text that is accepted [bytes].
    static constexpr std::size_t kMaxText = 1'000'000;

    /// Understands one `def ... end`, one `sec ... end`, or statements outside of both, which make
    /// an anonymous primary program.
    /// Errors, all with "line L, column C: why" (both count from 1):
    ///         not_found for a function, thread or variable that nobody defines, its name in '',
    ///         invalid_argument for the rest, also wrong argument counts and text beyond the
    ///         limits.
    static Result<Program> parse(std::string_view text);

    /// Empty for an anonymous program.
    const std::string& name() const;
    ProgramKind kind() const;
    /// Of the implementation: what the interpreter runs.
    const std::shared_ptr<const Code>& code() const { return code_; }

private:
    explicit Program(std::shared_ptr<const Code> code) : code_(std::move(code)) {}

    std::shared_ptr<const Code> code_;  // shared by copies and interpreters; never changes
};

}  // namespace metier::urscript
