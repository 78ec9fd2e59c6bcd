#include "parser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace metier::urscript {
namespace {

using Kind = TokenKind;

constexpr int kDeepest = 100;
constexpr std::size_t kMostParameters = 64;

bool isDefinition(Kind kind) {
    return kind == Kind::word_def || kind == Kind::word_sec;
}

CodeBuilder builderFor(const std::vector<Token>& tokens) {
    const bool secondary = tokens[0].kind == Kind::word_sec;
    const bool named = isDefinition(tokens[0].kind) && tokens[1].kind == Kind::name;
    return CodeBuilder(secondary ? ProgramKind::secondary : ProgramKind::primary,
                       named ? tokens[1].text : std::string_view());
}

bool endsBlock(Kind kind) {
    return kind == Kind::word_end || kind == Kind::word_elif || kind == Kind::word_else ||
           kind == Kind::end_of_text;
}

}  // namespace

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

// A program without a name is a block that the end of the text closes.
Parser::Parser(const std::vector<Token>& tokens)
    : TokenReader(tokens), builder_(builderFor(tokens)) {}

Result<Code> Parser::program() {
    const bool defined = isDefinition(peek().kind);
    if (defined) {
        take();
        for (const auto& [kind, what] :
             {std::pair(Kind::name, "the program's name"), std::pair(Kind::left_paren, "'('"),
              std::pair(Kind::right_paren, "')'"), std::pair(Kind::colon, "':'")}) {
            METIER_TRY(expect(kind, what));
        }
    }
    METIER_TRY(block());
    const Position end = peek().at;
    if (defined) {
        METIER_TRY(expect(Kind::word_end, "'end' of the program"));
    }
    takeLineEnds();
    METIER_TRY(expect(Kind::end_of_text, "the end of the text"));
    return builder_.finish(end);
}

Result<void> Parser::block() {
    while (true) {
        takeLineEnds();
        if (endsBlock(peek().kind)) {
            return {};
        }
        METIER_TRY(nested(&Parser::statement));
        const Kind kind = peek().kind;
        if (kind != Kind::new_line && kind != Kind::semicolon && !endsBlock(kind)) {
            return unexpected("the end of the line");
        }
    }
}

Result<void> Parser::statement() {
    switch (peek().kind) {
        case Kind::word_def:
            return definition(false);
        case Kind::word_thread:
            return definition(true);
        case Kind::word_if:
            return conditional();
        case Kind::word_while:
            return loop();
        default:
            return simpleStatement();
    }
}

Result<void> Parser::simpleStatement() {
    const Position at = peek().at;
    switch (peek().kind) {
        case Kind::name:
            return assignmentOrCall();
        case Kind::word_global:
            return declaration(true);
        case Kind::word_local:
            return declaration(false);
        case Kind::word_return:
            return giveBack();
        case Kind::word_break:
            return leaveLoop(false);
        case Kind::word_continue:
            return leaveLoop(true);
        case Kind::word_kill:
            return handleStatement(Op::kill);
        case Kind::word_join:
            return handleStatement(Op::join);
        case Kind::word_enter_critical:
        case Kind::word_exit_critical:
            return critical();
        case Kind::word_pass:
            take();
            return {};
        case Kind::word_halt:
            take();
            builder_.emit(Op::halt, at);
            return {};
        case Kind::word_run:
            return runThread().map([&] { builder_.emit(Op::pop, at); });
        default:
            return unexpected("a statement");
    }
}

Result<void> Parser::definition(bool is_thread) {
    const Position at = take().at;
    const Token& name = peek();
    METIER_TRY(expect(Kind::name, is_thread ? "the thread's name" : "the function's name"));
    METIER_TRY(builder_.beginFunction(name.text, is_thread, at));
    METIER_TRY(parameters());
    auto outer_loops = std::exchange(loops_, {});
    METIER_TRY(block());
    loops_ = std::move(outer_loops);
    builder_.endFunction(peek().at);
    return expect(Kind::word_end, fmt::format("'end' of '{}'", name.text));
}

Result<void> Parser::parameters() {
    METIER_TRY(expect(Kind::left_paren, "'('"));
    while (!takeIf(Kind::right_paren)) {
        METIER_TRY(parameter());
        METIER_TRY(separator(Kind::right_paren));
    }
    return expect(Kind::colon, "':'");
}

Result<void> Parser::parameter() {
    const Token& name = peek();
    Function& function = builder_.function();
    const std::size_t index = function.parameters.size();
    if (function.is_thread) {
        return failAt(name.at, "a thread has no parameters");
    }
    if (index == kMostParameters) {
        return failAt(name.at, fmt::format("more than {} parameters", kMostParameters));
    }
    METIER_TRY(expect(Kind::name, "a parameter's name"));
    METIER_TRY(builder_.addParameter(name.text, name.at));
    if (!takeIf(Kind::assign)) {
        function.required = index + 1;
        return {};
    }
    const std::size_t given = builder_.emit(Op::jump_if_given, name.at, 0, index);
    METIER_TRY(nested(&Parser::expression));
    builder_.store(name.text, name.at);
    builder_.patch(given);
    return {};
}

Result<void> Parser::conditional() {
    std::vector<std::size_t> ends;
    do {
        take();
        const Position at = peek().at;
        METIER_TRY(condition());
        const std::size_t otherwise = builder_.emit(Op::jump_if_false, at);
        METIER_TRY(block());
        ends.push_back(builder_.emit(Op::jump, peek().at));
        builder_.patch(otherwise);
    } while (peek().kind == Kind::word_elif);
    if (takeIf(Kind::word_else)) {
        METIER_TRY(expect(Kind::colon, "':'"));
        METIER_TRY(block());
    }
    for (const std::size_t end : ends) {
        builder_.patch(end);
    }
    return expect(Kind::word_end, "'end' of 'if'");
}

Result<void> Parser::loop() {
    take();
    const Position at = peek().at;
    const std::size_t begin = builder_.here();
    METIER_TRY(condition());
    loops_.push_back({begin, {builder_.emit(Op::jump_if_false, at)}});
    METIER_TRY(block());
    builder_.emit(Op::jump, at, static_cast<std::int32_t>(begin));
    for (const std::size_t leave : loops_.back().breaks) {
        builder_.patch(leave);
    }
    loops_.pop_back();
    return expect(Kind::word_end, "'end' of 'while'");
}

Result<void> Parser::condition() {
    METIER_TRY(nested(&Parser::expression));
    return expect(Kind::colon, "':'");
}

Result<void> Parser::declaration(bool is_global) {
    take();
    const Token& name = peek();
    METIER_TRY(expect(Kind::name, "a variable's name"));
    const bool has_value = takeIf(Kind::assign);
    if (has_value) {
        METIER_TRY(nested(&Parser::expression));
    }
    if (is_global) {
        builder_.declareGlobal(name.text);
    } else {
        builder_.declareLocal(name.text);
    }
    if (has_value) {
        builder_.store(name.text, name.at);
    }
    return {};
}

Result<void> Parser::assignmentOrCall() {
    const Token& name = take();
    if (takeIf(Kind::assign)) {
        return nested(&Parser::expression).map([&] { builder_.store(name.text, name.at); });
    }
    if (peek().kind == Kind::left_bracket) {
        return elementAssignment(name);
    }
    return call(name).map([&] { builder_.emit(Op::pop, name.at); });
}

Result<void> Parser::elementAssignment(const Token& name) {
    constexpr std::size_t kMostIndices = 8;
    std::size_t indices = 0;
    while (takeIf(Kind::left_bracket)) {
        METIER_ASSIGN(const auto more, expressions(Kind::right_bracket, kMostIndices));
        indices += more;
        if (more == 0) {
            return unexpected("an index");
        }
        if (indices > kMostIndices) {
            return failAt(peek().at, fmt::format("more than {} indices", kMostIndices));
        }
    }
    METIER_TRY(expect(Kind::assign, "'='"));
    METIER_TRY(nested(&Parser::expression));
    builder_.storeElement(name.text, indices, name.at);
    return {};
}

Result<void> Parser::handleStatement(Op op) {
    const Position at = take().at;
    return nested(&Parser::expression).map([&] {
        builder_.emit(op, at);
        builder_.emit(Op::pop, at);
    });
}

Result<void> Parser::giveBack() {
    const Position at = take().at;
    if (peek().kind == Kind::new_line || peek().kind == Kind::semicolon || endsBlock(peek().kind)) {
        builder_.constant(Value(), at);
    } else {
        METIER_TRY(nested(&Parser::expression));
    }
    builder_.emit(Op::give_back, at);
    return {};
}

Result<void> Parser::leaveLoop(bool again) {
    const Token& word = take();
    if (loops_.empty()) {
        return failAt(word.at, fmt::format("'{}' outside of a loop", word.text));
    }
    Loop& inner = loops_.back();
    const std::size_t jump =
        builder_.emit(Op::jump, word.at, static_cast<std::int32_t>(inner.begin));
    if (!again) {
        inner.breaks.push_back(jump);
    }
    return {};
}

// Threads give way only where they wait, so there is nothing to guard.
Result<void> Parser::critical() {
    take();
    return takeIf(Kind::left_paren) ? expect(Kind::right_paren, "')'") : Result<void>();
}

void Parser::takeLineEnds() {
    while (takeIf(Kind::new_line) || takeIf(Kind::semicolon)) {
    }
}

Result<void> Parser::nested(Step step) {
    if (depth_ >= kDeepest) {
        return failAt(peek().at, fmt::format("more than {} levels within each other", kDeepest));
    }
    ++depth_;
    auto done = (this->*step)();
    --depth_;
    return done;
}

}  // namespace metier::urscript
