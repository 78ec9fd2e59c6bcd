#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace metier::edo_driver {

/// Reads a JSON text from front to back without allocating.
///
/// It accepts less than JSON: no escapes, only ASCII, at most 16 levels, no number that a double or
/// 18 digits cannot hold. What it does not accept ends it: from then on ok() is false and every
/// function returns nothing.
///
/// Threading: one thread.
class JsonCursor {
public:
    explicit JsonCursor(std::string_view text) noexcept : rest_(text) {}

    bool ok() const noexcept { return ok_; }

    /// Steps into an object or a list, or fails if the next value is none.
    void enterObject() noexcept { enter('{'); }
    void enterList() noexcept { enter('['); }
    /// The next key of the object that was entered, with the cursor at its value; nothing at the
    /// end, which leaves the object.
    std::optional<std::string_view> nextKey() noexcept;
    /// Moves to the next value of the entered list; false at the end, where it leaves the list.
    bool nextElement() noexcept;

    std::string_view string() noexcept;
    /// null is NaN.
    double numberOrNull() noexcept;
    /// A number without fraction and exponent.
    std::int64_t integer() noexcept;
    /// The text of any value.
    std::string_view skip() noexcept;
    /// Reports whether only white space is left.
    bool atEnd() noexcept;

private:
    enum class Place : std::uint8_t { first, later };

    void fail() noexcept { ok_ = false; }
    void skipSpace() noexcept;
    char peek() noexcept;
    bool take(char expected) noexcept;
    void enter(char opening) noexcept;
    bool next(char closing) noexcept;
    std::string_view number() noexcept;
    void digits() noexcept;
    void literal(std::string_view word) noexcept;
    void skipValue(int levels) noexcept;

    std::string_view rest_;
    bool ok_ = true;
    Place place_ = Place::first;  // place in the innermost object or list
};

}  // namespace metier::edo_driver
