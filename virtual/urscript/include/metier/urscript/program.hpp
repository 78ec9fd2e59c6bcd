#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"

namespace metier::urscript {

struct Code;  // private

/// Kind of a program.
enum class ProgramKind {
    /// `def NAME():`, or statements alone: may move the arm, replaces the running program.
    primary,
    /// `sec NAME():`: runs beside the primary program in one cycle, never moves the arm.
    secondary,
};

/// A parsed script with resolved names; it can be run any number of times.
///
/// Cheap to copy: copies share immutable code. Threading: any thread.
/// Source: URScript manual; virtual/urscript/README.md lists the supported part.
class Program {
public:
    /// Longest text that is accepted [bytes].
    static constexpr std::size_t kMaxText = 1'000'000;

    /// Parses one `def ... end`, one `sec ... end`, or statements outside of both, which make an
    /// anonymous primary program. Errors, all with "line L, column C: why" (both count from 1):
    ///         not_found for a function, thread or variable without a definition, its name in '',
    ///         invalid_argument for the rest, also wrong argument counts and text beyond the
    ///         limits.
    /// Nothing runs yet, so a wrong script has no effect.
    static Result<Program> parse(std::string_view text);

    /// Name of the program; empty for an anonymous one.
    const std::string& name() const;
    /// Kind by its first line.
    ProgramKind kind() const;
    /// Internal form for the interpreter; not for other callers.
    const std::shared_ptr<const Code>& code() const { return code_; }

private:
    explicit Program(std::shared_ptr<const Code> code) : code_(std::move(code)) {}

    std::shared_ptr<const Code> code_;  // shared by copies and interpreters; never changes
};

}  // namespace metier::urscript
