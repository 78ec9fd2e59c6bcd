#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::urscript {

/// Place in the text, both numbers from 1.
struct Position {
    std::int32_t line = 1;
    std::int32_t column = 1;
};

enum class TokenKind : std::uint8_t {
    end_of_text,
    new_line,
    integer,
    number,
    string,
    name,
    // words
    word_and,
    word_break,
    word_continue,
    word_def,
    word_elif,
    word_else,
    word_end,
    word_enter_critical,
    word_exit_critical,
    word_false,
    word_global,
    word_halt,
    word_if,
    word_join,
    word_kill,
    word_local,
    word_not,
    word_or,
    word_pass,
    word_return,
    word_run,
    word_sec,
    word_thread,
    word_true,
    word_while,
    word_xor,
    // symbols
    assign,
    colon,
    comma,
    dot,
    equal,
    greater,
    greater_equal,
    left_bracket,
    left_paren,
    less,
    less_equal,
    minus,
    not_equal,
    percent,
    plus,
    right_bracket,
    right_paren,
    semicolon,
    slash,
    star
};

struct Token {
    TokenKind kind = TokenKind::end_of_text;
    std::string_view text;  ///< text in the script; a string is without its quotes
    double number = 0.0;    ///< value of an integer or a number
    Position at;
};

/// Cuts a script into tokens; the last one is end_of_text. Comments are dropped, and line ends
/// within brackets or behind an operator: there, a statement goes on in the next line.
/// Errors: invalid_argument, "line L, column C: why".
Result<std::vector<Token>> tokenize(std::string_view text);

/// Number of blocks that a line opens minus those that it closes, and whether the line has any
/// token. For text that comes line by line; never fails.
struct LineBlocks {
    int opened = 0;
    bool empty = true;
};
LineBlocks blocksOf(std::string_view line);

tl::unexpected<Error> failAt(Position at, std::string_view why, Errc code = Errc::invalid_argument);

}  // namespace metier::urscript
