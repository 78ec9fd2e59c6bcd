#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "token.hpp"

namespace metier::urscript {

/// The tokens of a program, read one by one.
class TokenReader {
public:
    /// \param tokens as tokenize() gives them; outlive the reader
    explicit TokenReader(const std::vector<Token>& tokens) : tokens_(tokens) {}

    /// Beyond the end: end_of_text.
    const Token& peek(std::size_t ahead = 0) const;
    const Token& take();
    bool takeIf(TokenKind kind);
    /// Takes it, or fails with "`what` is missing".
    Result<void> expect(TokenKind kind, std::string_view what);
    /// The failure that `wanted` should be where the next token is.
    tl::unexpected<Error> unexpected(std::string_view wanted) const;

private:
    const std::vector<Token>& tokens_;
    std::size_t next_ = 0;
};

}  // namespace metier::urscript
