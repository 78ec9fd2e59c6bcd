#include "token_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace metier::urscript {

using Kind = TokenKind;

const Token& TokenReader::peek(std::size_t ahead) const {
    return tokens_[std::min(next_ + ahead, tokens_.size() - 1)];
}

const Token& TokenReader::take() {
    const Token& token = peek();
    ++next_;
    return token;
}

bool TokenReader::takeIf(Kind kind) {
    const bool found = peek().kind == kind;
    next_ += found ? 1 : 0;
    return found;
}

Result<void> TokenReader::expect(Kind kind, std::string_view what) {
    return takeIf(kind) ? Result<void>() : unexpected(what);
}

tl::unexpected<Error> TokenReader::unexpected(std::string_view wanted) const {
    const Token& token = peek();
    if (token.kind == Kind::end_of_text || token.kind == Kind::new_line) {
        return failAt(token.at, fmt::format("{} is missing", wanted));
    }
    constexpr std::size_t kMostShown = 40;
    return failAt(token.at, fmt::format("{} is missing before '{}'", wanted,
                                        token.text.substr(0, kMostShown)));
}

}  // namespace metier::urscript
