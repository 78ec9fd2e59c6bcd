#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "code_builder.hpp"
#include "metier/base/error.hpp"
#include "operators.hpp"

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

/// Reads the tokens of one program and writes its code in the same pass.
/// Errors of all: invalid_argument, "line L, column C: why"; program() also those of
/// CodeBuilder::finish().
class Parser : private TokenReader {
public:
    /// \param tokens as tokenize() gives them; outlive the parser
    explicit Parser(const std::vector<Token>& tokens);

    Result<Code> program();

private:
    using Step = Result<void> (Parser::*)();
    struct Loop {
        std::size_t begin = 0;
        std::vector<std::size_t> breaks;  // jumps to its end
    };

    // parser.cpp: statements
    Result<void> block();
    Result<void> statement();
    Result<void> simpleStatement();
    Result<void> definition(bool is_thread);
    Result<void> parameters();
    Result<void> parameter();
    Result<void> conditional();
    Result<void> loop();
    Result<void> condition();
    Result<void> declaration(bool is_global);
    Result<void> assignmentOrCall();
    Result<void> elementAssignment(const Token& name);
    Result<void> handleStatement(Op op);
    Result<void> giveBack();
    Result<void> leaveLoop(bool again);
    Result<void> critical();
    void takeLineEnds();

    // expression_parser.cpp
    Result<void> expression();
    Result<void> orExpression();
    Result<void> andExpression();
    Result<void> notExpression();
    Result<void> leftToRight(Step operand, Precedence precedence);
    Result<void> comparison();
    Result<void> sum();
    Result<void> product();
    Result<void> sign();
    Result<void> primary();
    Result<void> value();
    Result<void> name();
    Result<void> call(const Token& name);
    Result<void> argument(std::vector<WrittenArgument>& arguments);
    Result<void> pose();
    Result<void> list();
    Result<void> runThread();
    /// The comma behind a value, or `end`, which is not taken.
    Result<void> separator(TokenKind end);
    /// Expressions up to `end`, separated by commas; how many there were.
    Result<std::size_t> expressions(TokenKind end, std::size_t most);
    bool isPose() const;
    std::size_t valuesWithin(std::size_t ahead) const;

    Result<void> nested(Step step);

    int depth_ = 0;  // depth of nested blocks and expressions
    std::vector<Loop> loops_;
    CodeBuilder builder_;
};

}  // namespace metier::urscript
