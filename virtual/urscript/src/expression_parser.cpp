#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "parser.hpp"

namespace metier::urscript {
namespace {

using Kind = TokenKind;

constexpr std::size_t kMostElements = 1000;
constexpr std::size_t kMostArguments = 64;
constexpr std::size_t kPoseElements = 6;

/// nullptr if a token is no operator of that precedence.
const BinaryOperator* operatorOf(Kind kind, Precedence precedence) {
    const auto* const known = std::ranges::find(kBinaryOperators, kind, &BinaryOperator::token);
    return known != kBinaryOperators.end() && known->precedence == precedence ? known : nullptr;
}

}  // namespace

Result<void> Parser::expression() {
    return leftToRight(&Parser::orExpression, Precedence::exclusive_or);
}

Result<void> Parser::leftToRight(Step operand, Precedence precedence) {
    METIER_TRY((this->*operand)());
    while (const auto* const known = operatorOf(peek().kind, precedence)) {
        const Position at = take().at;
        METIER_TRY((this->*operand)());
        builder_.emit(known->op, at);
    }
    return {};
}

Result<void> Parser::orExpression() {
    METIER_TRY(andExpression());
    while (peek().kind == Kind::word_or) {
        const Position at = take().at;
        const std::size_t otherwise = builder_.emit(Op::jump_if_false, at);
        builder_.constant(true, at);
        const std::size_t end = builder_.emit(Op::jump, at);
        builder_.patch(otherwise);
        METIER_TRY(andExpression());
        builder_.emit(Op::truth, at);
        builder_.patch(end);
    }
    return {};
}

Result<void> Parser::andExpression() {
    METIER_TRY(notExpression());
    while (peek().kind == Kind::word_and) {
        const Position at = take().at;
        const std::size_t otherwise = builder_.emit(Op::jump_if_false, at);
        METIER_TRY(notExpression());
        builder_.emit(Op::truth, at);
        const std::size_t end = builder_.emit(Op::jump, at);
        builder_.patch(otherwise);
        builder_.constant(false, at);
        builder_.patch(end);
    }
    return {};
}

Result<void> Parser::notExpression() {
    if (peek().kind != Kind::word_not) {
        return comparison();
    }
    const Position at = take().at;
    return nested(&Parser::notExpression).map([&] { builder_.emit(Op::logical_not, at); });
}

Result<void> Parser::comparison() {
    return leftToRight(&Parser::sum, Precedence::comparison);
}
Result<void> Parser::sum() {
    return leftToRight(&Parser::product, Precedence::sum);
}
Result<void> Parser::product() {
    return leftToRight(&Parser::sign, Precedence::product);
}

Result<void> Parser::sign() {
    const Token& token = peek();
    if (takeIf(Kind::minus)) {
        return nested(&Parser::sign).map([&] { builder_.emit(Op::negate, token.at); });
    }
    return takeIf(Kind::plus) ? nested(&Parser::sign) : primary();
}

/// A value and the indices behind it.
Result<void> Parser::primary() {
    METIER_TRY(value());
    while (peek().kind == Kind::left_bracket) {
        const Position at = take().at;
        METIER_ASSIGN(const auto indices, expressions(Kind::right_bracket, 2));
        if (indices == 0) {
            return failAt(at, "an index is missing");
        }
        builder_.emit(Op::element, at, 0, indices);
    }
    return {};
}

Result<void> Parser::value() {
    const Token& token = peek();
    switch (token.kind) {
        case Kind::name:
            return name();
        case Kind::left_bracket:
            return list();
        case Kind::word_run:
            return runThread();
        case Kind::left_paren:
            take();
            METIER_TRY(nested(&Parser::expression));
            return expect(Kind::right_paren, "')'");
        case Kind::integer:
            builder_.constant(static_cast<std::int32_t>(token.number), token.at);
            break;
        case Kind::number:
            builder_.constant(token.number, token.at);
            break;
        case Kind::string:
            builder_.constant(std::string(token.text), token.at);
            break;
        case Kind::word_true:
        case Kind::word_false:
            builder_.constant(token.kind == Kind::word_true, token.at);
            break;
        default:
            return unexpected("a value");
    }
    take();
    return {};
}

Result<void> Parser::name() {
    if (isPose()) {
        return pose();
    }
    const Token& token = take();
    if (peek().kind == Kind::left_paren) {
        return call(token);
    }
    builder_.load(token.text, token.at);
    return {};
}

Result<void> Parser::call(const Token& name) {
    std::vector<WrittenArgument> arguments;
    METIER_TRY(expect(Kind::left_paren, "'=' or '('"));
    while (!takeIf(Kind::right_paren)) {
        METIER_TRY(argument(arguments));
        METIER_TRY(separator(Kind::right_paren));
    }
    builder_.call(name.text, std::move(arguments), name.at);
    return {};
}

Result<void> Parser::argument(std::vector<WrittenArgument>& arguments) {
    WrittenArgument written{{}, peek().at};
    if (peek().kind == Kind::name && peek(1).kind == Kind::assign) {
        written.name = take().text;
        take();
    } else if (!arguments.empty() && !arguments.back().name.empty()) {
        return unexpected("an argument's name");
    }
    arguments.push_back(written);
    if (arguments.size() > kMostArguments) {
        return failAt(written.at, fmt::format("more than {} arguments", kMostArguments));
    }
    return nested(&Parser::expression);
}

/// `p[` begins a pose, unless there is a variable p and fewer values than a pose has.
bool Parser::isPose() const {
    if (peek().text != "p" || peek(1).kind != Kind::left_bracket) {
        return false;
    }
    return !builder_.isVariable("p") || valuesWithin(2) == kPoseElements;
}

/// Number of values in the bracket whose first token is `ahead`.
std::size_t Parser::valuesWithin(std::size_t ahead) const {
    std::size_t values = 1;
    for (int depth = 1; peek(ahead).kind != Kind::end_of_text; ++ahead) {
        const Kind kind = peek(ahead).kind;
        depth += kind == Kind::left_bracket || kind == Kind::left_paren ? 1 : 0;
        depth -= kind == Kind::right_bracket || kind == Kind::right_paren ? 1 : 0;
        if (depth == 0) {
            break;
        }
        values += depth == 1 && kind == Kind::comma ? 1 : 0;
    }
    return values;
}

Result<void> Parser::pose() {
    const Position at = take().at;
    take();
    METIER_ASSIGN(const auto elements, expressions(Kind::right_bracket, kPoseElements));
    if (elements != kPoseElements) {
        return failAt(at, fmt::format("a pose has 6 numbers, not {}", elements));
    }
    builder_.emit(Op::make_pose, at);
    return {};
}

Result<void> Parser::list() {
    const Position at = take().at;
    METIER_ASSIGN(const auto elements, expressions(Kind::right_bracket, kMostElements));
    builder_.emit(Op::make_list, at, static_cast<std::int32_t>(elements));
    return {};
}

Result<void> Parser::runThread() {
    const Position at = take().at;
    const Token& name = peek();
    METIER_TRY(expect(Kind::name, "a thread's name"));
    METIER_TRY(expect(Kind::left_paren, "'('"));
    METIER_TRY(expect(Kind::right_paren, "')'"));
    builder_.run(name.text, at);
    return {};
}

Result<std::size_t> Parser::expressions(Kind end, std::size_t most) {
    std::size_t count = 0;
    while (!takeIf(end)) {
        if (count == most) {
            return failAt(peek().at, fmt::format("more than {} values", most));
        }
        METIER_TRY(nested(&Parser::expression));
        ++count;
        METIER_TRY(separator(end));
    }
    return count;
}

Result<void> Parser::separator(Kind end) {
    if (peek().kind == end) {
        return {};
    }
    return expect(Kind::comma, end == Kind::right_bracket ? "',' or ']'" : "',' or ')'");
}

}  // namespace metier::urscript
