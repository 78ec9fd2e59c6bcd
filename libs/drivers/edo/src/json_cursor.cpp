#include "json_cursor.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

namespace metier::edo_driver {
namespace {

constexpr int kMostLevels = 16;
constexpr std::size_t kMostDigits = 18;

bool isDigit(char c) noexcept {
    return c >= '0' && c <= '9';
}

bool isPlain(char c) noexcept {
    return c >= 0x20 && c < 0x7f && c != '\\' && c != '"';
}

}  // namespace

void JsonCursor::skipSpace() noexcept {
    const auto end = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end);
}

char JsonCursor::peek() noexcept {
    skipSpace();
    return rest_.empty() ? '\0' : rest_.front();
}

bool JsonCursor::take(char expected) noexcept {
    if (!ok_ || peek() != expected || rest_.empty()) {
        return false;
    }
    rest_.remove_prefix(1);
    return true;
}

void JsonCursor::enter(char opening) noexcept {
    if (!take(opening)) {
        fail();
    }
    place_ = Place::first;
}

/// Moves to the next entry, over the comma.
bool JsonCursor::next(char closing) noexcept {
    if (take(closing)) {
        place_ = Place::later;  // in what is around it
        return false;
    }
    if (place_ == Place::later && !take(',')) {
        fail();
    }
    place_ = Place::later;
    return ok_;
}

std::optional<std::string_view> JsonCursor::nextKey() noexcept {
    if (!next('}')) {
        return std::nullopt;
    }
    const auto key = string();
    if (!take(':')) {
        fail();
    }
    return ok_ ? std::optional(key) : std::nullopt;
}

bool JsonCursor::nextElement() noexcept {
    return next(']');
}

std::string_view JsonCursor::string() noexcept {
    if (!take('"')) {
        fail();
        return {};
    }
    const auto* end = std::find_if_not(rest_.begin(), rest_.end(), isPlain);
    if (end == rest_.end() || *end != '"') {
        fail();
        return {};
    }
    const auto text = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(text.size() + 1);
    return text;
}

void JsonCursor::digits() noexcept {
    if (rest_.empty() || !isDigit(rest_.front())) {
        fail();
    }
    while (!rest_.empty() && isDigit(rest_.front())) {
        rest_.remove_prefix(1);
    }
}

std::string_view JsonCursor::number() noexcept {
    skipSpace();
    const auto all = rest_;
    const auto take_here = [this](std::string_view any) {
        const bool found = !rest_.empty() && any.find(rest_.front()) != std::string_view::npos;
        rest_.remove_prefix(found ? 1 : 0);
        return found;
    };
    take_here("-");
    if (!take_here("0")) {
        digits();
    }
    if (take_here(".")) {
        digits();
    }
    if (take_here("eE")) {
        take_here("+-");
        digits();
    }
    return all.substr(0, all.size() - rest_.size());
}

double JsonCursor::numberOrNull() noexcept {
    if (peek() == 'n') {
        literal("null");
        return std::numeric_limits<double>::quiet_NaN();
    }
    const auto text = number();
    double value = 0.0;
    if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc{}) {
        fail();
    }
    return value;
}

std::int64_t JsonCursor::integer() noexcept {
    const auto text = number();
    std::int64_t value = 0;
    if (text.size() > kMostDigits || text.find_first_of(".eE") != std::string_view::npos ||
        std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc{}) {
        fail();
    }
    return value;
}

void JsonCursor::literal(std::string_view word) noexcept {
    if (rest_.substr(0, word.size()) != word) {
        fail();
        return;
    }
    rest_.remove_prefix(word.size());
}

std::string_view JsonCursor::skip() noexcept {
    skipSpace();
    const auto all = rest_;
    skipValue(kMostLevels);
    return all.substr(0, all.size() - rest_.size());
}

void JsonCursor::skipValue(int levels) noexcept {
    if (!ok_ || levels == 0) {
        fail();
        return;
    }
    switch (peek()) {
        case '{':
            enterObject();
            while (nextKey()) {
                skipValue(levels - 1);
            }
            break;
        case '[':
            enterList();
            while (nextElement()) {
                skipValue(levels - 1);
            }
            break;
        case '"':
            string();
            break;
        case 't':
            literal("true");
            break;
        case 'f':
            literal("false");
            break;
        default:
            numberOrNull();
    }
}

bool JsonCursor::atEnd() noexcept {
    skipSpace();
    return rest_.empty();
}

}  // namespace metier::edo_driver
