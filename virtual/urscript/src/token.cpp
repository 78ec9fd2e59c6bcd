#include "token.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

namespace metier::urscript {
namespace {

using Kind = TokenKind;

constexpr std::array<std::pair<std::string_view, Kind>, 26> kWords{{
    {"and", Kind::word_and},
    {"break", Kind::word_break},
    {"continue", Kind::word_continue},
    {"def", Kind::word_def},
    {"elif", Kind::word_elif},
    {"else", Kind::word_else},
    {"end", Kind::word_end},
    {"enter_critical", Kind::word_enter_critical},
    {"exit_critical", Kind::word_exit_critical},
    {"False", Kind::word_false},
    {"global", Kind::word_global},
    {"halt", Kind::word_halt},
    {"if", Kind::word_if},
    {"join", Kind::word_join},
    {"kill", Kind::word_kill},
    {"local", Kind::word_local},
    {"not", Kind::word_not},
    {"or", Kind::word_or},
    {"pass", Kind::word_pass},
    {"return", Kind::word_return},
    {"run", Kind::word_run},
    {"sec", Kind::word_sec},
    {"thread", Kind::word_thread},
    {"True", Kind::word_true},
    {"while", Kind::word_while},
    {"xor", Kind::word_xor},
}};

// Longer symbols come first.
constexpr std::array<std::pair<std::string_view, Kind>, 20> kSymbols{{
    {"==", Kind::equal},        {"!=", Kind::not_equal},
    {"<=", Kind::less_equal},   {">=", Kind::greater_equal},
    {"=", Kind::assign},        {"<", Kind::less},
    {">", Kind::greater},       {"(", Kind::left_paren},
    {")", Kind::right_paren},   {"[", Kind::left_bracket},
    {"]", Kind::right_bracket}, {"+", Kind::plus},
    {"-", Kind::minus},         {"*", Kind::star},
    {"/", Kind::slash},         {"%", Kind::percent},
    {",", Kind::comma},         {":", Kind::colon},
    {".", Kind::dot},           {";", Kind::semicolon},
}};

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}
bool isNameStart(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool isNamePart(char c) {
    return isNameStart(c) || isDigit(c);
}

// Tokens behind which a statement cannot end.
constexpr std::array kUnfinished{
    Kind::word_and, Kind::word_or,       Kind::word_xor,  Kind::word_not, Kind::assign,
    Kind::comma,    Kind::equal,         Kind::not_equal, Kind::less,     Kind::less_equal,
    Kind::greater,  Kind::greater_equal, Kind::plus,      Kind::minus,    Kind::star,
    Kind::slash,    Kind::percent};

bool goesOn(Kind kind) {
    return std::ranges::find(kUnfinished, kind) != kUnfinished.end();
}

class Tokenizer {
public:
    explicit Tokenizer(std::string_view text) : text_(text) {}

    Result<Token> next() {
        skipBlanks();
        if (offset_ == text_.size()) {
            return take(Kind::end_of_text, 0);
        }
        const char c = text_[offset_];
        if (c == '\n') {
            return lineEnd();
        }
        if (isNameStart(c)) {
            return word();
        }
        if (isDigit(c) || (c == '.' && offset_ + 1 < text_.size() && isDigit(text_[offset_ + 1]))) {
            return number();
        }
        return c == '"' ? string() : symbol();
    }

private:
    Position here() const { return {line_, static_cast<std::int32_t>(offset_ - line_start_) + 1}; }

    Token take(Kind kind, std::size_t length) {
        const Token token{kind, text_.substr(offset_, length), 0.0, here()};
        offset_ += length;
        return token;
    }

    void skipBlanks() {
        while (offset_ < text_.size()) {
            const char c = text_[offset_];
            if (c == '#') {
                offset_ = std::min(text_.find('\n', offset_), text_.size());
            } else if (c == ' ' || c == '\t' || c == '\r') {
                ++offset_;
            } else {
                return;
            }
        }
    }

    Token lineEnd() {
        const Token token = take(Kind::new_line, 1);
        ++line_;
        line_start_ = offset_;
        return token;
    }

    Token word() {
        std::size_t end = offset_;
        while (end < text_.size() && isNamePart(text_[end])) {
            ++end;
        }
        const auto text = text_.substr(offset_, end - offset_);
        const auto* word = std::find_if(kWords.begin(), kWords.end(),
                                        [&](const auto& known) { return known.first == text; });
        return take(word == kWords.end() ? Kind::name : word->second, text.size());
    }

    Result<Token> number() {
        double value = 0.0;
        const char* const begin = text_.data() + offset_;
        const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
        if (error != std::errc{}) {
            return failAt(here(), "this number cannot be represented");
        }
        const auto length = static_cast<std::size_t>(end - begin);
        const bool whole = text_.substr(offset_, length).find_first_of(".eE") == text_.npos;
        const bool fits = value <= std::numeric_limits<std::int32_t>::max();
        Token token = take(whole && fits ? Kind::integer : Kind::number, length);
        token.number = value;
        if (offset_ < text_.size() && isNamePart(text_[offset_])) {
            return failAt(token.at, "a number and a name need a blank between them");
        }
        return token;
    }

    Result<Token> string() {
        const std::size_t end = text_.find_first_of("\"\n", offset_ + 1);
        if (end == text_.npos || text_[end] == '\n') {
            return failAt(here(), "the string has no end");
        }
        Token token = take(Kind::string, end + 1 - offset_);
        token.text = token.text.substr(1, token.text.size() - 2);
        return token;
    }

    Result<Token> symbol() {
        for (const auto& [text, kind] : kSymbols) {
            if (text_.substr(offset_, text.size()) == text) {
                return take(kind, text.size());
            }
        }
        return failAt(here(), "a character that has no meaning here");
    }

    std::string_view text_;
    std::size_t offset_ = 0;
    std::size_t line_start_ = 0;
    std::int32_t line_ = 1;
};

}  // namespace

tl::unexpected<Error> failAt(Position at, std::string_view why, Errc code) {
    return fail(code, fmt::format("line {}, column {}: {}", at.line, at.column, why));
}

Result<std::vector<Token>> tokenize(std::string_view text) {
    Tokenizer tokenizer(text);
    std::vector<Token> tokens;
    int brackets = 0;
    while (tokens.empty() || tokens.back().kind != Kind::end_of_text) {
        METIER_ASSIGN(const auto token, tokenizer.next());
        brackets += token.kind == Kind::left_paren || token.kind == Kind::left_bracket ? 1 : 0;
        brackets -= token.kind == Kind::right_paren || token.kind == Kind::right_bracket ? 1 : 0;
        const bool dropped = token.kind == Kind::new_line &&
                             (brackets > 0 || tokens.empty() || goesOn(tokens.back().kind));
        if (!dropped) {
            tokens.push_back(token);
        }
    }
    return tokens;
}

LineBlocks blocksOf(std::string_view line) {
    Tokenizer tokenizer(line);
    LineBlocks blocks;
    while (true) {
        const auto token = tokenizer.next();
        if (!token || token->kind == Kind::end_of_text) {
            blocks.empty = blocks.empty && token.has_value();
            return blocks;
        }
        blocks.empty = blocks.empty && token->kind == Kind::new_line;
        switch (token->kind) {
            case Kind::word_def:
            case Kind::word_sec:
            case Kind::word_thread:
            case Kind::word_if:
            case Kind::word_while:
                ++blocks.opened;
                break;
            case Kind::word_end:
                --blocks.opened;
                break;
            default:
                break;
        }
    }
}

}  // namespace metier::urscript
