#include "metier/urscript/program.hpp"

#include <fmt/format.h>

#include <utility>

#include "code.hpp"
#include "parser.hpp"

namespace metier::urscript {

Result<Program> Program::parse(std::string_view text) {
    if (text.size() > kMaxText) {
        return fail(Errc::invalid_argument,
                    fmt::format("line 1, column 1: the script has {} bytes, more than {}",
                                text.size(), kMaxText));
    }
    METIER_ASSIGN(const auto tokens, tokenize(text));
    METIER_ASSIGN(auto code, Parser(tokens).program());
    return Program(std::make_shared<const Code>(std::move(code)));
}

const std::string& Program::name() const {
    return code_->name;
}
ProgramKind Program::kind() const {
    return code_->kind;
}

}  // namespace metier::urscript
